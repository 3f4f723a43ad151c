"""Denoising of nine kinds of noise on four DEMs and two clouds, against other filters.

    python benchmarks/quality/denoise_kinds.py [DATA] [--kinds NAME...] [--terrains NAME...]
        [--only-ours] [--output benchmarks/quality/denoise_kinds.json]
    python benchmarks/quality/denoise_kinds.py --write docs/topics/filtering.md

Noise is added to what then counts as clean. The settings of each of the others, listed in
``PEERS``, are all run, and the best by the error to the clean terrain is taken, on each terrain and
for each noise anew. They are also given the deviation of the noise, where they take one. Ours is
run once, given only what ``KINDS`` says beside each kind.

Windows of 200 x 200 cells of the DEMs; ground points of the clouds in windows of some 40,000. On
points ours works on their TIN. The others see grids, linear between the points, of cells as large
as the points are apart and of half of that, and go back to the points by a bilinear look-up;
Gaussian and median are also taken over the points themselves. The best of all these counts.
Striped: ours is told the line of each value, which the table's others have no use for; one that has
stands below it, line means levelled before a Gaussian.
Voids: 25 discs are cut out; the others get them filled linearly, ours gets the holes. Errors are
taken where there are data.

Needs scikit-image and PyWavelets (the extra ``bench``); ``whitebox-workflows`` joins in where it is
installed. ``--write`` puts the table of the kept results into a page, between its marks.
"""

import argparse
import json
import warnings
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import NamedTuple

import laspy
import numpy as np
import rasterio
from denoise import (
    DEMS,
    bayes_shrink,
    best,
    bilateral,
    gaussian,
    median,
    median_and_gaussian,
    mesh_of,
    rmse,
)
from scipy import ndimage
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator
from scipy.spatial import cKDTree

from wavelet_core import TriangleMesh, denoise

#: Side of the windows of DEMs, in cells.
WINDOW = 200
#: The same DEMs elsewhere, and others: no setting was chosen on them. Row and column, cell, noise.
HELD_OUT = (
    ("lidar_dem_400.tif", 200, 0, 1.0, 0.3),
    ("TM1_564_146_1m.tif", 100, 700, 1.0, 0.3),
    ("tasmania_33m_f64.tif", 300, 300, 33.3652, 10.0),
    ("jacksboro_tn_4326.tif", 0, 200, 83.0, 10.0),
    ("co_elevation_roi_4269.tif", 400, 700, 9.0, 3.0),
    ("pysheds_dem_4326.tif", 150, 150, 90.0, 10.0),
)
#: File, left and lower corner, and sides of the window in the unit of the file; ground points only.
CLOUDS = (
    ("mountain_utm42_38k.las", None, 0.3),
    ("ign_semis_2023_0292_6833_289k.laz", (292_250.0, 6_832_250.0, 500.0), 0.3),
)
GROUND = 2
N_VOIDS, WIDTHS_OF_VOIDS = 25, (2.0, 8.0)
RESULTS = Path(__file__).with_suffix(".json")


class Terrain(NamedTuple):
    """Clean elevations of a grid, ``(n_rows, n_columns)``, or of points, ``(n_points,)``."""

    clean: np.ndarray
    plan: np.ndarray
    cell: float
    sigma: float
    is_grid: bool

    def mesh(self, values: np.ndarray) -> TriangleMesh:
        """Return values as a mesh."""
        if self.is_grid:
            return mesh_of(values, self.cell)
        return TriangleMesh.from_points(np.column_stack([self.plan, values]))

    def slope(self) -> np.ndarray:
        """Return the tangent of the smoothed slope at each value."""
        grid = self.clean if self.is_grid else self.gridded(self.clean, 1.0)
        down, right = np.gradient(ndimage.gaussian_filter(grid, 3), self.cell)
        steep = np.hypot(down, right)
        return steep if self.is_grid else self.at_points(steep, 1.0)

    def gridded(self, values: np.ndarray, share: float) -> np.ndarray:
        """Return values of points on a grid, linear between them, of cells a share of theirs.

        Also those of a grid with voids, filled.
        """
        known = np.isfinite(values.ravel())
        plan = self.plan[known]
        x, y = (
            np.arange(low, high + self.cell * share, self.cell * share)
            for low, high in zip(self.plan.min(axis=0), self.plan.max(axis=0), strict=True)
        )
        at = np.stack(np.meshgrid(x, y), axis=-1)
        if self.is_grid:
            at = self.plan.reshape(*self.clean.shape, 2)
        grid = LinearNDInterpolator(plan, values.ravel()[known])(at)
        outside = ~np.isfinite(grid)
        grid[outside] = NearestNDInterpolator(plan, values.ravel()[known])(at[outside])
        return grid

    def at_points(self, grid: np.ndarray, share: float) -> np.ndarray:
        """Return the values of a grid at the points."""
        at = (self.plan - self.plan.min(axis=0)) / (self.cell * share)
        return ndimage.map_coordinates(grid, at[:, ::-1].T, order=1, mode="nearest")


def white(terrain, rng):
    noisy = terrain.clean + rng.normal(0, terrain.sigma, terrain.clean.shape)
    return noisy, {"sigma": terrain.sigma}


def correlated(terrain, rng):
    """Noise of 1.5 cells' width, whose correlation has fallen to 1/e at three."""
    if terrain.is_grid:
        noise = ndimage.gaussian_filter(rng.normal(size=terrain.clean.shape), 1.5, mode="wrap")
    else:
        cells = tuple((np.ptp(terrain.plan, axis=0)[::-1] / terrain.cell).astype(int) * 2 + 4)
        fine = ndimage.gaussian_filter(rng.normal(size=cells), 3.0, mode="wrap")
        noise = terrain.at_points(fine, 0.5)
    noisy = terrain.clean + terrain.sigma * noise / noise.std()
    return noisy, {"sigma": terrain.sigma, "noise_range": 3.0 * terrain.cell}


def correlated_estimated(terrain, rng):
    return correlated(terrain, rng)[0], {"noise_range": "estimate"}


def by_slope(terrain, rng):
    """Noise that grows tenfold with the slope."""
    steep = terrain.slope()
    local = terrain.sigma * (0.2 + 2.0 * steep / np.quantile(steep, 0.95))
    return terrain.clean + local * rng.normal(size=terrain.clean.shape), {"local_noise": True}


def striped(terrain, rng):
    """Offsets of each line of cells along x, and half as much white noise."""
    line = np.round((terrain.plan[:, 1] - terrain.plan[:, 1].min()) / terrain.cell).astype(int)
    offset = rng.normal(0, terrain.sigma, line.max() + 1)[line].reshape(terrain.clean.shape)
    noise = 0.5 * rng.normal(0, terrain.sigma, terrain.clean.shape)
    return terrain.clean + offset + noise, {"lines": line}


def with_outliers(terrain, rng):
    """White noise, and 1 % of the values off by 10 to 50 times that."""
    noisy, _ = white(terrain, rng)
    off = rng.random(noisy.shape) < 0.01
    signs = rng.choice([-1, 1], noisy.shape)
    return noisy + off * signs * rng.uniform(10, 50, noisy.shape) * terrain.sigma, {
        "outliers": True
    }


def rounded(terrain, rng):
    """Values rounded to 3.5 sigma, whose noise is sigma, and nothing else."""
    step = np.sqrt(12) * terrain.sigma
    return np.round(terrain.clean / step) * step, {}


def weak(terrain, rng):
    """White noise of a tenth of sigma, which is not given: rough relief is far above it."""
    return white(terrain._replace(sigma=terrain.sigma / 10), rng)[0], {}


def with_voids(terrain, rng):
    """White noise, and discs without values."""
    noisy, options = white(terrain, rng)
    centres = terrain.plan[rng.choice(len(terrain.plan), N_VOIDS, replace=False)]
    radii = terrain.cell * rng.uniform(*WIDTHS_OF_VOIDS, N_VOIDS)
    apart = np.linalg.norm(terrain.plan[:, None] - centres, axis=2)
    noisy[(apart < radii).any(axis=1).reshape(noisy.shape)] = np.nan
    return noisy, options


KINDS = {
    "white": white,
    "correlated": correlated,
    "correlated, range estimated": correlated_estimated,
    "by slope": by_slope,
    "striped": striped,
    "outliers": with_outliers,
    "rounded": rounded,
    "voids": with_voids,
    "weak": weak,
}


def non_local_means(noisy, sigma):
    from skimage.restoration import denoise_nl_means

    for patch, reach, strength in product((5, 7, 9), (6, 11), (0.5, 0.7, 0.9, 1.3, 2, 3)):
        options = {"h": strength * sigma, "sigma": sigma, "fast_mode": True}
        result = denoise_nl_means(noisy, patch_size=patch, patch_distance=reach, **options)
        yield f"patch {patch}, reach {reach}, h {strength} sigma", result


def total_variation(noisy, sigma):
    from skimage.restoration import denoise_tv_chambolle

    span = float(np.ptp(noisy))
    # Where it stops early, slopes are not yet steps, which is better for most terrain.
    for stop, weight in product((1e-3, 2e-4, 1e-6), np.geomspace(0.3, 20, 14)):
        options = {"weight": weight * sigma / span, "eps": stop, "max_num_iter": 300}
        result = denoise_tv_chambolle(noisy / span, **options)
        yield f"weight {weight:.2g} sigma, stop {stop}", result * span


def cycle_spun(noisy, sigma):
    for share in (0.7, 1.0, 1.5, 2.5, 4.0, 6.0):
        spun = bayes_shrink(noisy, share * sigma, (0, 3, 6, 13), ("db2", "sym8", "bior4.4"), (3, 4))
        yield from ((f"{share} sigma, {setting}", result) for setting, result in spun)


def feature_preserving(noisy, cell):
    """Yield results of Whitebox's smoothing of normals (Lindsay et al. 2019)."""
    from whitebox_workflows import WbEnvironment

    environment = WbEnvironment()
    with TemporaryDirectory() as folder:
        path = f"{folder}/noisy.tif"
        grid = {"height": noisy.shape[0], "width": noisy.shape[1], "count": 1, "dtype": "float64"}
        transform = rasterio.transform.from_origin(0, 0, cell, cell)
        with rasterio.open(path, "w", "GTiff", transform=transform, crs=32631, **grid) as file:
            file.write(noisy, 1)
        raster = environment.read_raster(path)
        for size, limit, rounds in product((5, 11, 21, 31), (8.0, 20.0, 45.0, 70.0), (1, 3, 10)):
            result = environment.feature_preserving_smoothing(
                raster, filter_size=size, normal_diff_threshold=limit, iterations=rounds
            )
            yield f"{size} cells, {limit:g} degrees, {rounds} rounds", result.to_numpy()


#: Name, filter and the package it needs.
PEERS: tuple[tuple[str, Callable[..., Iterator[tuple[object, np.ndarray]]], str], ...] = (
    ("Gaussian", gaussian, "scipy"),
    ("median", median, "scipy"),
    ("median, Gaussian", median_and_gaussian, "scipy"),
    ("bilateral", bilateral, "scipy"),
    ("NLM", non_local_means, "skimage"),
    ("BayesShrink, 16 shifts", cycle_spun, "pywt"),
    ("total variation", total_variation, "skimage"),
    ("Whitebox", feature_preserving, "whitebox_workflows"),
)


def gaussian_of_points(terrain, noisy):
    """Yield weighted means over neighbouring points."""
    known = np.isfinite(noisy)
    plan, tree = terrain.plan, cKDTree(terrain.plan[known])
    for width in np.geomspace(0.4, 2.5, 8):
        reach = width * terrain.cell
        near = cKDTree(plan).sparse_distance_matrix(tree, 3 * reach, output_type="coo_matrix")
        weights = np.exp(-0.5 * (near.data / reach) ** 2)
        total = np.bincount(near.row, weights * noisy[known][near.col], len(plan))
        weight = np.bincount(near.row, weights, len(plan))
        yield f"{width:.2f} of points", total / np.maximum(weight, 1e-300)


def median_of_points(terrain, noisy):
    """Yield medians of the nearest points."""
    known = np.isfinite(noisy)
    tree = cKDTree(terrain.plan[known])
    for count in (7, 13, 21, 37, 61):
        _, nearest = tree.query(terrain.plan, count)
        yield f"{count} points", np.median(noisy[known][nearest], axis=1)


ON_POINTS = {"Gaussian": gaussian_of_points, "median": median_of_points}


def destriped_gaussian(terrain, noisy, lines):
    """Yield Gaussians of what is left when each line's mean is brought to those around it."""
    means = np.bincount(lines, noisy.ravel()) / np.bincount(lines)
    for lines_wide in (1, 2, 3, 4, 6, 9, 13, 20, 30, 1e9):
        smooth = ndimage.gaussian_filter1d(means, lines_wide) if lines_wide < 1e9 else means.mean()
        level = noisy - (means - smooth)[lines].reshape(noisy.shape)
        if terrain.is_grid:
            results = gaussian(level, terrain.sigma)
        else:
            results = gaussian_of_points(terrain, level)
        yield from ((f"{lines_wide:g} lines, {setting}", result) for setting, result in results)


def grids_of(terrain, noisy):
    """Return what the filters for grids see: shares of the spacing, and grids without holes."""
    if terrain.is_grid:
        return {1.0: noisy if np.isfinite(noisy).all() else terrain.gridded(noisy, 1.0)}
    return {share: terrain.gridded(noisy, share) for share in (1.0, 0.5)}


def peer_results(name, method, terrain, noisy, grids):
    """Yield the results of a filter, as the values are, at every setting."""
    for share, grid in grids.items():
        scale = terrain.cell * share if method is feature_preserving else terrain.sigma
        for setting, result in method(grid, scale):
            if terrain.is_grid:
                yield setting, result
            else:
                yield f"cells of {share}: {setting}", terrain.at_points(result, share)
    if name in ON_POINTS and not terrain.is_grid:
        yield from ON_POINTS[name](terrain, noisy)


def cell_of(terrain, kind, only_ours):
    """Return the errors of one terrain and one kind of noise."""
    noisy, options = KINDS[kind](terrain, np.random.default_rng(0))
    has = np.isfinite(noisy)
    figures = {"noisy": rmse(noisy[has], terrain.clean[has]), "peers": {}}
    grids = {} if only_ours else grids_of(terrain, noisy)
    for name, method, package in PEERS:
        if only_ours or not find_spec(package):
            continue
        begin = process_time()
        tried = peer_results(name, method, terrain, noisy, grids)
        error, setting = best(((s, r[has]) for s, r in tried), terrain.clean[has])
        seconds = round(process_time() - begin, 2)
        figures["peers"][name] = {"rmse": error, "setting": setting, "seconds": seconds}
    if "lines" in options:
        error, setting = best(destriped_gaussian(terrain, noisy, options["lines"]), terrain.clean)
        figures["told the lines"] = {"rmse": error, "setting": setting}
    begin = process_time()
    if terrain.is_grid:
        mesh = terrain.mesh(noisy)
    else:
        mesh = TriangleMesh.from_points(np.column_stack([terrain.plan, noisy])[has])
    result = denoise(mesh, **options).vertices[:, 2]
    figures["ours"] = rmse(result, terrain.clean[has])
    figures["seconds"] = round(process_time() - begin, 2)
    return figures


def terrains(data, held_out):
    """Yield names and terrains."""
    for name, top, left, cell, sigma in HELD_OUT if held_out else DEMS:
        with rasterio.open(data / "dems" / name) as file:
            clean = file.read(1).astype(float)[top : top + WINDOW, left : left + WINDOW]
        x, y = (cell * np.arange(float(n)) for n in clean.shape[::-1])
        plan = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        yield name, Terrain(clean, plan, cell, sigma, True)
    for name, window, sigma in () if held_out else CLOUDS:
        cloud = laspy.read(data / "clouds" / name)
        points = np.asarray(cloud.xyz)[np.asarray(cloud.classification) == GROUND]
        if window is not None:
            low = np.array(window[:2])
            points = points[
                ((points[:, :2] >= low) & (points[:, :2] < low + window[2])).all(axis=1)
            ]
        _, first = np.unique(points[:, :2], axis=0, return_index=True)
        points = points[np.sort(first)]
        plan = points[:, :2] - points[:, :2].min(axis=0)
        spacing = float(np.sqrt(np.ptp(plan, axis=0).prod() / len(plan)))
        yield name, Terrain(points[:, 2].copy(), plan, spacing, sigma, False)


def as_markdown(results):
    """Return the table of the results: ours over the best of the others in the last column."""
    peers = [name for name, _, _ in PEERS]
    header = ["terrain", "noise", "noisy", *peers, "ours", "ours / best"]
    lines = ["| " + " | ".join(header) + " |", "| --- | --- |" + " ---: |" * (len(header) - 2)]
    lowest, others = 0, []
    for terrain, kinds in results.items():
        for kind, cell in kinds.items():
            errors = [cell["noisy"]]
            errors += [cell["peers"].get(name, {"rmse": np.inf})["rmse"] for name in peers]
            errors.append(cell["ours"])
            least = min(errors)
            words = [f"**{e:.3g}**" if e == least else f"{e:.3g}" for e in errors]
            words = ["–" if word == "inf" else word for word in words]
            ratio = cell["ours"] / min(errors[:-1])
            lines.append(f"| `{terrain}` | {kind} | " + " | ".join(words) + f" | {ratio:.3f} |")
            lowest += cell["ours"] == least
            if cell["ours"] > least:
                others.append(f"{kind} on `{terrain}` ({100 * ratio - 100:.1f} % above)")
    n_cells = sum(len(kinds) for kinds in results.values())
    others = "; the others: " + ", ".join(others) if others else ""
    lines += ["", f"Ours is lowest in {lowest} of {n_cells} cells{others}."]
    pairs = {
        terrain: (cell["told the lines"]["rmse"], cell["ours"])
        for terrain, kinds in results.items()
        for cell in kinds.values()
        if "told the lines" in cell
    }
    if pairs:
        told = [f"`{name}` {other:.3g} ({ours:.3g})" for name, (other, ours) in pairs.items()]
        lower = sum(ours < other for other, ours in pairs.values())
        words = "Striped, a Gaussian after each line's mean is brought to the blurred mean of those"
        lines += ["", f"{words} around it, both of the best width (ours): {', '.join(told)}."]
        lines[-1] += f" Ours is lower in {lower} of {len(pairs)}."
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", nargs="?", default="../shared/data", type=Path)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS), metavar="NAME")
    parser.add_argument("--terrains", nargs="+", metavar="NAME", help="parts of names of files")
    parser.add_argument("--held-out", action="store_true", help="windows that nothing was set on")
    parser.add_argument("--only-ours", action="store_true", help="leave the others out")
    parser.add_argument("--output", type=Path, help="keep the results; those there are replaced")
    parser.add_argument("--write", type=Path, metavar="PAGE", help="put kept results into a page")
    arguments = parser.parse_args()
    if arguments.write:
        page = arguments.write.read_text(encoding="utf-8")
        before, mark, rest = page.partition("<!-- kinds: results -->\n")
        if not mark:
            parser.error(f"{arguments.write} has no line <!-- kinds: results -->; add it.")
        table = as_markdown(json.loads(RESULTS.read_text(encoding="utf-8")))
        after = rest[rest.index("<!-- end -->") :]
        arguments.write.write_text(f"{before}{mark}{table}\n{after}", encoding="utf-8")
        return
    warnings.filterwarnings("ignore", category=UserWarning)  # of levels and wavelets tried
    for name, _, package in PEERS:
        if not find_spec(package):
            print(f"{name} is left out: {package} is not installed.", flush=True)
    results: dict[str, dict] = {}
    if arguments.output and arguments.output.exists():
        results = json.loads(arguments.output.read_text(encoding="utf-8"))
    for name, terrain in terrains(arguments.data, arguments.held_out):
        if arguments.terrains and not any(part in name for part in arguments.terrains):
            continue
        for kind in arguments.kinds:
            cell = cell_of(terrain, kind, arguments.only_ours)
            old = results.setdefault(name, {}).get(kind)
            if arguments.only_ours and old:
                cell["peers"] = old["peers"]
            results[name][kind] = cell
            others = [cell["noisy"], *(p["rmse"] for p in cell["peers"].values())]
            ratio = cell["ours"] / min(others)
            print(f"{name}, {kind}: {cell['ours']:.4g}, over the best {ratio:.3f}", flush=True)
            if arguments.output:
                text = json.dumps(results, indent=1) + "\n"
                arguments.output.write_text(text, encoding="utf-8")
    print(as_markdown(results))


if __name__ == "__main__":
    main()
