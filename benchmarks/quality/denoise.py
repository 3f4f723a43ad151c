"""Denoising against the usual filters, each at its best: the table, and a profile of LiDAR ground.

    python benchmarks/quality/denoise.py [DATA] [--pyramids 32]
        [--pictures docs/images] [--only-ours]

Normal noise of known standard deviation is added to DEMs, which then count as clean. The others
are given that deviation and every one of their settings is chosen with the clean DEM at hand, on
each DEM anew, to the advantage of all of them; ours is given the deviation, and nothing else.
Needs scikit-image and PyWavelets. Other kinds of noise are in denoise_kinds.py.
"""

import argparse
import warnings
from itertools import product
from pathlib import Path
from time import process_time

import numpy as np
import rasterio
from scipy import ndimage

from wavelet_core import TriangleMesh, analyse, denoise
from wavelet_core.filtering.denoise import N_PYRAMIDS
from wavelet_core.filtering.noise.white import estimate_noise

#: file, first row and column of a window of 400 x 400 cells, cell size and noise in metres
DEMS = (
    ("lidar_dem_400.tif", 0, 0, 1.0, 0.3),
    ("TM1_564_146_1m.tif", 300, 300, 1.0, 0.3),
    ("tasmania_33m_f64.tif", 0, 0, 33.3652, 10.0),
    ("jacksboro_tn_4326.tif", 0, 0, 83.0, 10.0),
)
WINDOW = 400
WAVELETS = ("haar", "db2", "db4", "sym8", "coif2", "bior4.4")
LEVELS = (3, 4, 5)


def rmse(a, b):
    return float(np.sqrt(np.mean((a - b) ** 2)))


def best(candidates, truth):
    """Return the least error of ``(setting, result)`` pairs, and its setting."""
    return min((rmse(result, truth), str(setting)) for setting, result in candidates)


def gaussian(noisy, sigma):
    for width in np.geomspace(0.5, 6, 25):
        yield f"{width:.2f}", ndimage.gaussian_filter(noisy, width, mode="nearest")


def median(noisy, sigma):
    for size in range(3, 16, 2):
        yield size, ndimage.median_filter(noisy, size, mode="nearest")


def median_and_gaussian(noisy, sigma):
    for size, width in product((3, 5), np.geomspace(0.5, 4, 12)):
        first = ndimage.median_filter(noisy, size, mode="nearest")
        yield f"{size}, {width:.2f}", ndimage.gaussian_filter(first, width, mode="nearest")


def bilateral(noisy, sigma):
    for width, strength in product((1.0, 1.5, 2.5, 4.0), (1.5, 2.5, 4.0, 8.0, 16.0)):
        reach = int(np.ceil(2 * width))
        padded = np.pad(noisy, reach, mode="reflect")
        total, weights = np.zeros_like(noisy), np.zeros_like(noisy)
        for down, right in product(range(2 * reach + 1), repeat=2):
            other = padded[down : down + noisy.shape[0], right : right + noisy.shape[1]]
            far = ((down - reach) ** 2 + (right - reach) ** 2) / width**2
            apart = ((other - noisy) / (strength * sigma)) ** 2
            weight = np.exp(-0.5 * (far + apart))
            total += weight * other
            weights += weight
        yield f"{width}, {strength} sigma", total / weights


def non_local_means(noisy, sigma):
    from skimage.restoration import denoise_nl_means

    for patch, reach, strength in product((5, 7, 9), (6, 11), (0.5, 0.7, 0.9)):
        yield (
            f"patch {patch}, reach {reach}, h {strength} sigma",
            denoise_nl_means(
                noisy,
                patch_size=patch,
                patch_distance=reach,
                h=strength * sigma,
                sigma=sigma,
                fast_mode=True,
            ),
        )


def bayes_shrink(noisy, sigma, shifts=(0,), wavelets=WAVELETS, depths=LEVELS):
    """Yield results of PyWavelets' transforms with BayesShrink, averaged over ``shifts``.

    Terrain is no torus: a shift cuts its window from the DEM mirrored beyond its edges, since the
    seam of a cyclic one would lower BayesShrink's thresholds everywhere.
    """
    from skimage.restoration import denoise_wavelet

    margin = max(shifts)
    low, span = noisy.min(), np.ptp(noisy)
    image = 0.25 + 0.5 * (noisy - low) / span  # denoise_wavelet clips to [0, 1]
    image = np.pad(image, ((margin, margin), (margin, margin)), mode="reflect")
    n_rows, n_columns = (n + margin for n in noisy.shape)
    for wavelet, levels in product(wavelets, depths):
        total = np.zeros_like(noisy)
        for down, right in product(shifts, shifts):
            part = denoise_wavelet(
                image[down : down + n_rows, right : right + n_columns],
                sigma=0.5 * sigma / span,
                wavelet=wavelet,
                wavelet_levels=levels,
                method="BayesShrink",
                rescale_sigma=False,
            )
            top, left = margin - down, margin - right
            total += part[top : top + noisy.shape[0], left : left + noisy.shape[1]]
        result = low + (total / len(shifts) ** 2 - 0.25) * span / 0.5
        yield f"{wavelet}, {levels} levels", result


def cycle_spun(noisy, sigma):
    return bayes_shrink(noisy, sigma, shifts=(0, 3, 6, 13))


def mesh_of(elevation, cell):
    x, y = (cell * np.arange(n) for n in elevation.shape[::-1])
    return TriangleMesh.from_grid(elevation, x=x, y=y)


def row(path, top, left, cell, sigma, n_pyramids, only_ours):
    with rasterio.open(path) as file:
        clean = file.read(1).astype(float)[top : top + WINDOW, left : left + WINDOW]
    noisy = clean + np.random.default_rng(0).normal(0, sigma, clean.shape)
    figures = {"noisy": (rmse(noisy, clean), "")}
    for name, method in (
        ("Gaussian", gaussian),
        ("median", median),
        ("non-local means", non_local_means),
        ("BayesShrink", bayes_shrink),
        ("BayesShrink, 16 shifts", cycle_spun),
    ):
        if not only_ours:
            figures[name] = best(method(noisy, sigma), clean)
    mesh = mesh_of(noisy, cell)
    one = analyse(mesh, partition="random", prediction="plane").denoised(sigma).synthesise()
    figures["one pyramid, BayesShrink"] = rmse(one.vertices[:, 2], clean.ravel()), ""
    for count in sorted({N_PYRAMIDS, n_pyramids}):
        begin = process_time()
        result = denoise(mesh, sigma, n_pyramids=count)
        seconds = process_time() - begin
        error = rmse(result.vertices[:, 2], clean.ravel())
        figures[f"{count} pyramids"] = error, f"{seconds:.0f} s of CPU"
    figures["noise estimated"] = estimate_noise(mesh), ""
    return figures


def lidar_profile(data, pictures):
    """Tell roughness, breaklines and movement of LiDAR points, and draw a profile with a house."""
    from wavelet_gis.workflows.open import open_terrain

    path = data / "clouds" / "ign_tiles_77055_627755.laz"
    for title, classes in (("ground", (2,)), ("ground and roofs", (2, 6))):
        mesh = open_terrain(path, classes=classes, carry=False).mesh
        sigma = estimate_noise(mesh)
        clean = denoise(mesh, sigma)
        slope_before, slope_after = (plane_slopes(m) for m in (mesh, clean))
        # Flat and steep are told on the heavily smoothed surface, which neither of the two is.
        smooth = plane_slopes(denoise(mesh, 4 * sigma))
        moved = np.abs(clean.vertices[:, 2] - mesh.vertices[:, 2])
        print(f"\n{path.name}: {mesh.n_vertices:,} points, {title}")
        print(f"  noise estimated {sigma:.4f} m, afterwards {estimate_noise(clean):.4f} m")
        print(f"  moved by {rmse(moved, 0):.3f} m rms, {moved.max():.3f} m at most")
        for name, where in (
            ("flat faces", smooth < np.tan(np.radians(8))),
            ("steep faces", smooth > np.tan(np.radians(60))),
        ):
            print(
                f"  {name} ({where.sum():,}): median slope "
                f"{np.median(slope_before[where]):.3f} -> {np.median(slope_after[where]):.3f}",
                flush=True,
            )
    if pictures is not None:
        draw_profile(pictures / "denoise-lidar.png", mesh, clean)


def plane_slopes(mesh):
    """Return the tangent of every face's slope."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return np.hypot(normal[:, 0], normal[:, 1]) / normal[:, 2]


def draw_profile(path, before, after):
    import matplotlib.pyplot as plt
    from matplotlib.tri import LinearTriInterpolator, Triangulation

    x, y = before.vertices[:, :2].T - before.vertices[:, :2].min(axis=0)[:, None]
    tin = Triangulation(x, y, before.faces)
    along = np.linspace(1, x.max() - 1, 900)
    heights = [LinearTriInterpolator(tin, m.vertices[:, 2]) for m in (before, after)]
    # The row with the highest step between neighbouring samples: a wall.
    rows = np.linspace(2, y.max() - 2, 60)
    steps = [np.nanmax(np.abs(np.diff(heights[1](along, np.full(900, r))))) for r in rows]
    across = np.full(900, rows[int(np.argmax(steps))])
    z = [interpolate(along, across).filled(np.nan) for interpolate in heights]
    # Beside the whole, its longest stretch without a step, where the noise can be seen.
    steps = np.flatnonzero(~(np.abs(np.diff(z[1])) < 0.5))
    ends = np.concatenate([[0], steps + 1, [len(along)]])
    k = int(np.argmax(np.diff(ends)))
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.2), constrained_layout=True)
    for axis, window in zip(axes, (slice(None), slice(ends[k], ends[k + 1])), strict=True):
        axis.plot(along[window], z[0][window], color="0.6", lw=0.8, label="LiDAR points")
        axis.plot(along[window], z[1][window], color="C3", lw=1.1, label="denoised")
        axis.set(xlabel="m along the profile", ylabel="elevation, m")
    axes[0].legend()
    figure.savefig(path, dpi=100)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", nargs="?", default="../shared/data", type=Path)
    parser.add_argument("--pyramids", type=int, default=32)
    parser.add_argument("--pictures", type=Path)
    parser.add_argument("--only-ours", action="store_true", help="leave the others out")
    arguments = parser.parse_args()
    warnings.filterwarnings("ignore", category=UserWarning)  # of levels and wavelets tried
    lidar_profile(arguments.data, arguments.pictures)
    for name, top, left, cell, sigma in DEMS:
        figures = row(
            arguments.data / "dems" / name,
            top,
            left,
            cell,
            sigma,
            arguments.pyramids,
            arguments.only_ours,
        )
        print(f"\n{name}: noise of {sigma} m", flush=True)
        for method, (error, setting) in figures.items():
            print(f"  {method:26}{error:9.4f}  {setting}", flush=True)


if __name__ == "__main__":
    main()
