"""The main job on a real DEM: GeoTIFF in, wavelet pyramid out, a table and a picture.

Run it as ``make demo``, or ``python examples/demo.py FOLDER``. The terrain is SRTM elevation of
the Jacksboro fault in Tennessee, which comes with matplotlib.
"""

import math
import sys
from itertools import pairwise
from pathlib import Path
from time import perf_counter

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cbook import get_sample_data
from matplotlib.colors import LightSource, LinearSegmentedColormap, LogNorm
from pyproj import CRS
from scipy.ndimage import gaussian_filter

from wavelet_gis.cli.main import main as terrain_wavelets
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid
from wavelet_gis.io.raster import read_dem, write_dem
from wavelet_gis.model.dem import Dem, GridGeometry
from wavelet_gis.products.rasterise import rasterise

#: Vertices of the coarsest level; shares of the input's vertices that the picture shows beside it.
TARGET_VERTICES = 2000
SHARES_SHOWN = (0.25, 0.06)

LAND = LinearSegmentedColormap.from_list(
    "land", ["#5d7f6a", "#93a77c", "#cfc79a", "#d9bd8e", "#b98d67", "#8f6a55", "#efe9e2"]
)
DETAIL = LinearSegmentedColormap.from_list(
    "detail", ["#fbfaf5", "#f6e3b4", "#f0b46a", "#dd7350", "#b03a5b", "#6d1f68", "#2c1247"]
)
INK = "#2b2a28"
FAINT = "#8a8680"


def write_input(path):
    """Write matplotlib's sample DEM as a GeoTIFF in EPSG:4326."""
    with get_sample_data("jacksboro_fault_dem.npz") as sample:
        elevation = sample["elevation"]
        west, north = float(sample["xmin"]), float(sample["ymin"])  # its y axis runs downwards
        width, height = float(sample["dx"]), float(sample["dy"])
    geometry = GridGeometry(elevation.shape, (width, 0.0, west, 0.0, -height, north))
    dem = Dem(elevation, np.ones(elevation.shape, dtype=bool), geometry)
    write_dem(path, dem, CRS.from_epsg(4326).to_wkt())


def rebuild(geo):
    """Return the meshes of all levels, in file coordinates, and the seconds each took."""
    meshes, seconds = {}, {}
    start = perf_counter()
    for level, mesh in enumerate(geo.pyramid):
        seconds[level] = perf_counter() - start
        meshes[level] = geo.file_mesh(mesh)
    return meshes, seconds


def print_table(geo, seconds):
    """Print size, errors and the time to rebuild each level, the finest first."""
    header = (
        f"{'level':>5} {'vertices':>9} {'triangles':>10} {'rmse_coefficients':>18}"
        f" {'rmse_surface':>13} {'max_error_surface':>18} {'seconds':>8}"
    )
    print(header)
    for row in reversed(geo.errors):
        print(
            f"{row.level:>5} {row.n_vertices:>9,} {row.n_faces:>10,}"
            f" {row.rmse_coefficients:>18.6f} {row.rmse_surface:>11.2f} m"
            f" {row.max_error_surface:>16.1f} m {seconds[row.level]:>8.3f}"
        )
    print(
        "rmse_coefficients: over channels divided by their range; surface errors: vertical, at all "
        "input cells;\nseconds: to rebuild the level from the coarsest one."
    )


def shaded(elevation, cell, tint):
    """Return a hillshade in colour, ``(n_rows, n_columns, 3)``; ``cell`` is (dx, dy) in metres."""
    light = LightSource(azdeg=315, altdeg=42)
    filled = np.where(np.isnan(elevation), np.nanmin(elevation), elevation)
    relief = light.hillshade(filled, vert_exag=2.2, dx=cell[0], dy=cell[1])
    if not tint:
        return np.repeat((0.80 + 0.20 * relief)[..., None], 3, axis=2)
    low, high = np.nanpercentile(elevation, [1, 99.7])
    colour = LAND(np.clip((filled - low) / (high - low), 0, 1))[..., :3]
    return np.clip(colour * (0.35 + 0.85 * relief[..., None]), 0, 1)


def draw(path, dem, geo, meshes):
    """Draw the input and three levels, and where how much detail goes between them."""
    pyramid, frame = geo.pyramid, geo.frame
    finest = pyramid.n_levels
    shown = [finest, *levels_near(pyramid, SHARES_SHOWN), 0]
    n_rows, n_columns = dem.geometry.shape
    a, _, west, _, e, north = dem.geometry.transform
    extent = (west, west + a * n_columns, north + e * n_rows, north)
    cell = (a * frame.x_scale, -e * frame.y_scale)
    aspect = frame.y_scale / frame.x_scale

    plt.rcParams.update(
        {
            "font.family": "DejaVu Sans",
            "text.color": INK,
            "axes.edgecolor": FAINT,
            "axes.labelcolor": INK,
            "xtick.color": FAINT,
            "ytick.color": FAINT,
            "axes.linewidth": 0.6,
        }
    )
    figure = plt.figure(figsize=(16, 9.3), facecolor="white")
    grid = figure.add_gridspec(
        2, 4, left=0.03, right=0.94, top=0.86, bottom=0.055, hspace=0.20, wspace=0.06
    )
    figure.text(0.03, 0.955, "Jacksboro fault, Tennessee", fontsize=19, weight="bold")
    figure.text(
        0.03,
        0.922,
        "One DEM as a reversible pyramid of TINs: every level is rebuilt from the coarsest and "
        "the details between, the finest bit for bit.",
        fontsize=11.5,
        color="#5c5954",
    )

    errors = {row.level: row for row in geo.errors}
    for column, level in enumerate(shown):
        axes = figure.add_subplot(grid[0, column])
        surface = (
            dem.values.astype(float) if level == finest else rasterise(meshes[level], dem.geometry)
        )
        axes.imshow(shaded(surface, cell, tint=True), extent=extent, interpolation="bilinear")
        row = errors[level]
        name = f"Input  =  level {level}" if level == finest else f"Level {level}"
        note = f"{row.n_vertices:,} vertices"
        if level != finest:
            share = 100 * row.n_vertices / errors[finest].n_vertices
            note += f" ({share:.1f} %),  RMSE {row.rmse_surface:.1f} m"
        label(axes, name, note, extent, aspect)

    signature(figure.add_subplot(grid[1, 0]), geo)
    relief = shaded(dem.values.astype(float), cell, tint=False)
    layers = dict(pyramid.details())
    groups = [[layers[level] for level in range(coarse, fine)] for fine, coarse in pairwise(shown)]
    maps = [strength(group, frame, dem.geometry) for group in groups]
    norm = LogNorm(vmin=np.percentile(maps[0], 5), vmax=np.percentile(maps[-1], 99.5))
    for column, (group, rms) in enumerate(zip(groups, maps, strict=True), start=1):
        fine, coarse = shown[column - 1], shown[column]
        axes = figure.add_subplot(grid[1, column])
        colour = DETAIL(norm(rms))[..., :3]
        axes.imshow(np.clip(colour * relief, 0, 1), extent=extent, interpolation="bilinear")
        size = np.concatenate([detail.magnitude for detail in group])
        note = f"{len(size):,} details, rms {np.sqrt(np.mean(size**2)):.1f} m"
        label(axes, f"What goes from level {fine} to {coarse}", note, extent, aspect)
    bar = figure.add_axes([0.952, 0.075, 0.008, 0.325])
    figure.colorbar(mpl.cm.ScalarMappable(norm, DETAIL), cax=bar, extend="both")
    bar.set_title("rms\n(m)", fontsize=9, color=INK, pad=6)
    bar.tick_params(labelsize=8.5)
    bar.yaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    bar.yaxis.set_minor_formatter(mpl.ticker.NullFormatter())
    bar.set_yticks([tick for tick in (1, 2, 5, 10, 20, 50) if norm.vmin <= tick <= norm.vmax])
    figure.savefig(path, dpi=130)
    plt.close(figure)


def strength(group, frame, geometry):
    """Return the local root mean square of some layers' details, ``(n_rows, n_columns)``."""
    places = frame.to_file(np.concatenate([detail.positions for detail in group]))
    squared = np.concatenate([detail.magnitude for detail in group]) ** 2
    columns, rows = geometry.cells(places[:, 0], places[:, 1])
    n_rows, n_columns = geometry.shape
    cells = np.rint(rows).astype(int) * n_columns + np.rint(columns).astype(int)
    # As wide as a few details lie apart.
    width = 1.6 * math.sqrt(n_rows * n_columns / len(squared))
    sums, counts = (
        gaussian_filter(
            np.bincount(cells, weights, minlength=n_rows * n_columns).reshape(geometry.shape),
            width,
            mode="nearest",
        )
        for weights in (squared, np.ones(len(squared)))
    )
    return np.sqrt(sums / np.maximum(counts, 1e-9))


def levels_near(pyramid, shares):
    """Return the levels whose share of the input's vertices is nearest to each of ``shares``."""
    counts = np.array([pyramid.n_vertices(level) for level in range(pyramid.n_levels)])
    wanted = np.log(np.array(shares) * pyramid.n_vertices(pyramid.n_levels))
    return [int(np.argmin(np.abs(np.log(counts) - count))) for count in wanted]


def label(axes, name, note, extent, aspect):
    """Give a map its name and a note, and take its ticks away."""
    axes.set(xlim=extent[:2], ylim=extent[2:], xticks=[], yticks=[])
    axes.set_aspect(aspect)
    axes.set_title(name, fontsize=12.5, weight="bold", loc="left", pad=20)
    axes.text(0, 1.018, note, transform=axes.transAxes, fontsize=10, color="#5c5954")


def signature(axes, geo):
    """Draw how much relief lives at each scale: rms detail against the spacing of vertices."""
    pyramid = geo.pyramid
    mesh = pyramid.mesh(pyramid.n_levels)
    area = np.prod(np.ptp(mesh.vertices[:, :2], axis=0))
    counts = np.array([pyramid.n_vertices(level) for level in range(pyramid.n_levels + 1)])
    # Steps that take next to nothing (what lies on a plane already, the rest to the target) say
    # little about their scale.
    levels = np.flatnonzero(counts[:-1] < 0.95 * counts[1:])[::-1]
    spacing = np.sqrt(area / counts[levels])
    layers = dict(pyramid.details())
    rms = np.array([np.sqrt(np.mean(layers[level].magnitude ** 2)) for level in levels])
    colours = DETAIL(0.3 + 0.65 * np.arange(len(levels)) / len(levels))
    axes.plot(spacing, rms, color="#c9c4bb", linewidth=1.5, zorder=1)
    axes.scatter(spacing, rms, c=colours, s=52, zorder=2, edgecolors="white", linewidths=0.8)
    labelled = range(len(levels) - 1, -1, -math.ceil(len(levels) / 10))
    for level, x, y in ((levels[k], spacing[k], rms[k]) for k in labelled):
        axes.annotate(str(level), (x, y), (0, 8), textcoords="offset points", ha="center",
                      fontsize=8.5, color="#5c5954")  # fmt: skip
    axes.set(xscale="log", ylim=(0, 1.18 * rms.max()), xlim=(0.85 * spacing[0], 1.2 * spacing[-1]))
    axes.set_title("Where the relief lives", fontsize=12.5, weight="bold", loc="left", pad=20)
    axes.text(
        0, 1.018, "rms detail (m) of the step to each level", transform=axes.transAxes,
        fontsize=10, color="#5c5954",
    )  # fmt: skip
    axes.set_xlabel("mean spacing of the vertices (m)", fontsize=9.5)
    ticks = [tick for tick in (100, 200, 400, 800) if spacing[0] <= tick <= spacing[-1]]
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.minorticks_off()
    axes.tick_params(labelsize=8.5, length=3)
    axes.spines[["top", "right"]].set_visible(False)
    axes.yaxis.grid(True, color="#eeebe6", linewidth=0.8)
    axes.set_axisbelow(True)


def main(folder):
    """Make the demonstration in ``folder``; return the exit code."""
    folder.mkdir(parents=True, exist_ok=True)
    raster, pyramid_file = folder / "jacksboro.tif", folder / "jacksboro.gpkg"
    picture = folder / "jacksboro.png"
    write_input(raster)
    print(f"{raster}: SRTM elevation of the Jacksboro fault (matplotlib's sample data), EPSG:4326")

    start = perf_counter()
    options = ["--target-vertices", str(TARGET_VERTICES), "--overwrite", "--quiet"]
    failed = terrain_wavelets(["analyse", str(raster), str(pyramid_file), *options])
    if failed:
        return failed
    seconds = perf_counter() - start
    megabytes = pyramid_file.stat().st_size / 1e6
    print(f"{pyramid_file}: written in {seconds:.1f} s, compiling included; {megabytes:.1f} MB")

    geo = read_pyramid(pyramid_file)
    meshes, seconds_of_level = rebuild(geo)
    print_table(geo, seconds_of_level)
    dem, _ = read_dem(raster)
    identical = np.array_equal(geo.restore().values, dem.values)
    print(f"reconstruction: {'identical to the input, bit for bit' if identical else 'DIFFERS'}")

    draw(picture, dem, geo, meshes)
    print(f"{picture}: the input beside three levels, and the size of the details between them")
    return 0 if identical else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else "demo_output")))
