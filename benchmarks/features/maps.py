"""Maps by scale beside the published ones on the same DEMs: rank correlations, and the picture.

    python benchmarks/features/maps.py [DATA] [--dems NAME...]
        [--output benchmarks/features/maps.json] [--picture docs/images/feature-maps.png]
    python benchmarks/features/maps.py --write docs/topics/maps.md

Theirs are by windows of a number of cells, ours by the spacing of a level. How many spacings a
window is, is chosen for each map on the first DEM, by the mean over its windows, and kept on the
others. Ours are made by one random pyramid ("ours") and as the mean of four ("mean of four"); "of
itself" is the correlation of two single ones. Cells near the outline are left out. Landforms have
no order: their figure is Cohen's kappa.

Last comes a cloud: ours are straight from its points, theirs of a raster of them (heights of the
triangulation at the centres of cells that hold one point in the mean).

Shape is taken over windows, as ``details`` does, and of the surface of the level (``--fit
surface``); the latter stands in rows of its own.

Needs ``whitebox-workflows``, ``pytopocomplexity`` and GRASS (its program ``grass``); what lacks is
left out and told. The picture is of matplotlib's sample DEM.
"""

import argparse
import json
import subprocess
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from tempfile import TemporaryDirectory

import laspy
import numpy as np
import rasterio
from scipy import ndimage
from scipy.stats import spearmanr

from wavelet_core import (
    TriangleMesh,
    analyse,
    band_components,
    band_energies,
    deviation_by_scale,
    heights_above_means,
    landforms,
    level_at_distance,
    level_spacings,
    roughness_by_scale,
    surface_shape,
    window_shape,
)
from wavelet_core.features.shape import SurfaceShape, sample_at
from wavelet_core.features.window_shape import level_between

#: File, upper and left cell of the window, size of a cell in metres.
DEMS = (
    ("lidar_dem_400.tif", 0, 0, 1.0),
    ("TM1_564_146_1m.tif", 300, 300, 1.0),
    ("tasmania_33m_f64.tif", 0, 0, 33.3652),
    ("jacksboro_tn_4326.tif", 0, 0, 83.0),
)
#: File, class of its points, size of a cell in metres.
CLOUDS = (("ign_semis_2023_0292_6833_289k.laz", 2, 2.5),)
#: Side of the windows of DEMs, and of the moving windows, in cells; Whitebox's largest half window.
SIDE, WINDOWS, LARGEST_HALF = 400, (9, 17, 33), 20
#: Cells along the outline that are not compared, and levels and number of our pyramids.
MARGIN, LEVELS, N_PYRAMIDS = 40, 22, 4
#: Windows in spacings, from which one is chosen; wavelengths in spacings of the band that has them.
RATIOS = (1.5, 2.0, 2.5, 3.0, 4.0, 5.0)
#: Of GRASS at most, until two agree.
MAX_RUNS = 6
RESULTS = Path(__file__).with_suffix(".json")
SLOPE_TOLERANCE = 1.0
#: GRASS's features and geomorphons as places in ``wavelet_core.LANDFORMS``; slopes, shoulders and
#: footslopes count as planar.
FEATURES = np.array([-1, 0, 1, 2, 3, 4, 5])
GEOMORPHONS = np.array([-1, 0, 5, 4, 0, 4, 0, 2, 0, 2, 1])
OVER_ALL = "all"


#: Ends the names of shapes of the surface of a level.
OF_SURFACE = ", surface"
#: Our names of GRASS's.
NAMES = {"slope": "slope", "across": "tangential", "along": "profile"}


class Theirs:
    """The published maps of one DEM, by name and window."""

    def __init__(self, z, cell, folder):
        self.z, self.cell, self.path = z, cell, f"{folder}/z.tif"
        self.folder = folder
        grid = {"height": z.shape[0], "width": z.shape[1], "count": 1, "dtype": "float64"}
        transform = rasterio.transform.from_origin(500_000, 4_000_000, cell, cell)
        with rasterio.open(self.path, "w", "GTiff", transform=transform, crs=32631, **grid) as file:
            file.write(z, 1)

    def whitebox(self):
        """Return roughness, deviation and residuals, and where the first two are strongest."""
        from whitebox_workflows import WbEnvironment

        environment = WbEnvironment()
        raster = environment.read_raster(self.path)
        maps = {}
        for window in WINDOWS:
            half, size = window // 2, {"filter_size_x": window, "filter_size_y": window}
            rough, _ = environment.multiscale_roughness(raster, half, half + 1, 2)
            maps["roughness", window] = rough
            maps["deviation", window] = environment.deviation_from_mean_elevation(raster, **size)
            maps["residual", window] = environment.difference_from_mean_elevation(raster, **size)
        strongest, scale = environment.multiscale_roughness(raster, 1, LARGEST_HALF, 1)
        maps["roughness", OVER_ALL], maps["scale of roughness", OVER_ALL] = strongest, scale
        strongest, scale = environment.max_elevation_deviation(raster, 1, LARGEST_HALF, 1)
        maps["deviation", OVER_ALL], maps["scale of deviation", OVER_ALL] = strongest, scale
        return {key: found.to_numpy().astype(float) for key, found in maps.items()}

    def grass(self):
        """Return slope, curvatures and features, and geomorphons."""
        lines, maps = ["r.in.gdal -o input=z.tif output=z", "g.region raster=z"], {}
        by_name = {"slope": "slope", "across": "crosc", "along": "longc"}
        for window in WINDOWS:
            for name, method in by_name.items():
                lines.append(_param_scale(f"{name}_{window}", method, window, 1e-4))
        found = self._steady(lines, [f"{name}_{w}" for name in by_name for w in WINDOWS])
        for window in WINDOWS:
            maps.update({(name, window): found[f"{name}_{window}"] for name in by_name})
            bend = np.nanquantile(np.abs(maps["across", window]), 1 / 3)
            again = [*lines[:2], _param_scale("forms", "feature", window, bend)]
            search = f"search={window // 2} flat={SLOPE_TOLERANCE}"
            again.append(f"r.geomorphon elevation=z forms=geomorphon {search}")
            classes = self._steady(again, ["forms", "geomorphon"])
            maps["bend", window] = bend
            for name in by_name:
                maps[name + OF_SURFACE, window] = maps[name, window]
            maps["landforms", window] = _recoded(classes["forms"], FEATURES)
            maps["geomorphons", window] = _recoded(classes["geomorphon"], GEOMORPHONS)
        return maps

    def wavelets(self):
        """Return the Mexican hat's coefficients without their sign."""
        from pytopocomplexity import CWTMexHat

        maps = {}
        for window in WINDOWS:
            hat = CWTMexHat(Lambda=window * self.cell)
            _, found = hat.analyze(self.path, chunk_processing=False)
            maps["wavelet", window] = found
            size = window
            known = np.isfinite(found)
            filled = ndimage.uniform_filter(np.where(known, found, 0.0), size)
            share = ndimage.uniform_filter(known.astype(float), size)
            maps["wavelet, smoothed", window] = np.where(
                known, filled / np.maximum(share, 1e-9), np.nan
            )
        return maps

    def _steady(self, lines, names):
        """Return the maps that GRASS makes, once two runs agree.

        r.param.scale gives other values for the same input in one run out of twenty or thirty.
        """
        before = {}
        for _ in range(MAX_RUNS):
            self._run([*lines, *(_export(name) for name in names)])
            found = {name: self._read(name) for name in names}
            if before and all(_same(found[name], before[name]) for name in names):
                return found
            before = found
        raise SystemExit(f"GRASS: no two of {MAX_RUNS} runs agree on {', '.join(names)}.")

    def _run(self, lines):
        script = Path(self.folder, "run.sh")
        script.write_text("set -e\n" + "\n".join(lines) + "\n", encoding="utf-8")
        command = ["grass", "--tmp-location", "XY", "--exec", "bash", str(script)]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(f"GRASS: {done.stderr[-2000:]}")

    def _read(self, name):
        with rasterio.open(f"{self.folder}/{name}.tif") as file:
            return file.read(1, masked=True).astype(float).filled(np.nan)


def _same(one, other):
    """Return whether maps are equal but for rounding, in all but a thousandth of the cells."""
    close = np.isclose(one, other, rtol=1e-6, atol=1e-9 * np.nanstd(one), equal_nan=True)
    return close.mean() > 0.999


def _param_scale(name, method, window, bend):
    bounds = f"slope_tolerance={SLOPE_TOLERANCE} curvature_tolerance={bend:.12f}"
    return f"r.param.scale input=z output={name} method={method} size={window} {bounds}"


def _export(name):
    return f"r.out.gdal --overwrite -f -c input={name} output={name}.tif type=Float64 nodata=-9999"


def _recoded(codes, table):
    """Return places in ``LANDFORMS``; -1 where there is none."""
    return table[np.nan_to_num(codes).astype(int)]


class Terrain:
    """A mesh, and heights of it on a grid of cells: of a DEM the same."""

    def __init__(self, z, cell, mesh=None, corner=(0.0, 0.0)):
        self.z, self.cell = z, cell
        x = corner[0] + cell * np.arange(z.shape[1])
        y = corner[1] - cell * np.arange(z.shape[0])
        self.mesh = TriangleMesh.from_grid(z, x=x, y=y) if mesh is None else mesh
        self.is_grid = mesh is None
        columns, rows = np.meshgrid(x, y)
        self.plan = np.column_stack([columns.ravel(), rows.ravel()])

    def on_cells(self, found, mesh=None):
        """Return values at the vertices of a mesh, by default the finest, at the cells."""
        if mesh is None and self.is_grid:
            return found
        return sample_at(self.mesh if mesh is None else mesh, found, self.plan)


def terrains(data, wanted):
    """Yield the DEMs and the clouds by name."""
    for name, top, left, cell in DEMS:
        if any(part in name for part in wanted):
            with rasterio.open(data / "dems" / name) as file:
                z = file.read(1).astype(float)[top : top + SIDE, left : left + SIDE]
            yield name, Terrain(z, cell)
    for name, kind, cell in CLOUDS:
        if any(part in name for part in wanted):
            yield name, of_cloud(data / "clouds" / name, kind, cell)


def of_cloud(path, kind, cell):
    """Return the points of a class as a mesh, and their raster."""
    cloud = laspy.read(path)
    points = cloud.xyz[np.asarray(cloud.classification) == kind]
    points = points - points.min(axis=0)
    _, first = np.unique(points[:, :2], axis=0, return_index=True)
    mesh = TriangleMesh.from_points(points[np.sort(first)])
    width, height = points[:, :2].max(axis=0)
    shape = int(height / cell), int(width / cell)
    corner = (cell / 2, (shape[0] - 0.5) * cell)
    empty = Terrain(np.zeros(shape), cell, mesh, corner)
    z = empty.on_cells(mesh.vertices[:, 2]).reshape(shape)
    if np.isnan(z).any():  # outside the hull, in the margin that is not compared
        known = ndimage.distance_transform_edt(
            np.isnan(z), return_distances=False, return_indices=True
        )
        z = z[tuple(known)]
    return Terrain(z, cell, mesh, corner)


class Ours:
    """Our maps of one terrain by one pyramid, by name and ground distance."""

    def __init__(self, terrain, seed):
        self.terrain, self.shape, self.cell = terrain, terrain.z.shape, terrain.cell
        mesh = terrain.mesh
        options = {"partition": "random", "prediction": "plane"}
        self.pyramid = analyse(mesh, levels=LEVELS, seed=seed, **options)
        self.spacings = level_spacings(self.pyramid)
        self.components = band_components(self.pyramid)
        self.energies = band_energies(self.pyramid)
        self.by_scale = {
            "roughness": roughness_by_scale(self.pyramid),
            "deviation": deviation_by_scale(self.pyramid),
        }
        self.shapes: dict[tuple[float, bool], SurfaceShape] = {}

    def at(self, name, distance):
        """Return the map of a ground distance, or over all of them where that is ``all``."""
        if distance == OVER_ALL:
            maps = self.by_scale[name.removeprefix("scale of ")]
            reached = maps.distances <= LARGEST_HALF * self.cell
            maps = type(maps)(maps.levels, maps.distances[reached], maps.values[:, reached])
            found = maps.strongest_distance if "scale" in name else maps.strongest
        elif name in self.by_scale:
            maps = self.by_scale[name]
            found = maps.values[:, np.abs(np.log(maps.distances / distance)).argmin()]
        elif name.startswith("wavelet"):
            # Half an octave of levels around the distance: what one Mexican hat takes together.
            near = np.abs(np.log2(self.spacings[1:] / distance)) <= 0.5
            if "smoothed" in name:
                found = np.sqrt(self.energies[:, near].sum(axis=1))
            else:
                found = np.abs(self.components.bands[:, near].sum(axis=1))
        elif name == "residual":
            level = level_at_distance(self.pyramid, distance)
            found = heights_above_means(self.pyramid, [level])
        else:
            shape = self.shape_at(distance, OF_SURFACE in name)
            return shape.named(NAMES[name.removesuffix(OF_SURFACE)]).reshape(self.shape)
        return self.terrain.on_cells(found).reshape(self.shape)

    def shape_at(self, distance, of_surface):
        """Return the shape of a ground distance at the cells, as the command ``details`` has it."""
        if (distance, of_surface) not in self.shapes:
            if of_surface:
                mesh = self.pyramid.mesh(level_at_distance(self.pyramid, distance))
                shape = surface_shape(mesh)
            else:
                at = level_between(self.pyramid, distance)
                mesh, shape = self.pyramid.mesh(at), window_shape(self.pyramid, distance, at=at)
            columns = np.column_stack([shape.gradient, shape.hessian])
            cells = self.terrain.on_cells(columns, mesh)
            self.shapes[distance, of_surface] = SurfaceShape(cells[:, :2], cells[:, 2:])
        return self.shapes[distance, of_surface]

    def forms(self, distance, bend, of_surface=False):
        """Return the landforms of a ground distance."""
        shape = self.shape_at(distance, of_surface)
        classes = landforms(shape, flat_slope=SLOPE_TOLERANCE, flat_curvature=bend)
        return classes.reshape(self.shape)


def inner(field):
    """Return the cells that are compared."""
    return field[MARGIN:-MARGIN, MARGIN:-MARGIN].ravel()


def rank(one, other):
    """Return Spearman's correlation of two maps."""
    one, other = inner(one), inner(other)
    both = np.isfinite(one) & np.isfinite(other)
    return float(spearmanr(one[both], other[both])[0])


def kappa(one, other):
    """Return Cohen's kappa of two maps of classes, and the share of cells where they are equal."""
    one, other = inner(one), inner(other)
    both = (one >= 0) & (other >= 0)
    one, other = one[both], other[both]
    table = np.zeros((6, 6))
    np.add.at(table, (one, other), 1)
    table /= table.sum()
    equal, chance = np.trace(table), float(table.sum(axis=1) @ table.sum(axis=0))
    return float((equal - chance) / (1 - chance)), float(equal)


#: Map, its name in the table, counterpart.
MAPS = {
    "roughness": ("roughness", "Whitebox `multiscale_roughness`"),
    "deviation": (
        "deviation",
        "Whitebox `deviation_from_mean_elevation`, `max_elevation_deviation`",
    ),
    "scale of roughness": ("spacing of the strongest roughness", "its scale"),
    "scale of deviation": ("spacing of the strongest deviation", "its scale"),
    "residual": ("residual", "Whitebox `difference_from_mean_elevation`"),
    "slope": ("slope", "GRASS `r.param.scale` slope"),
    "across": ("tangential curvature", "GRASS `r.param.scale` crosc"),
    "along": ("profile curvature", "GRASS `r.param.scale` longc"),
    "slope, surface": ("slope of the level's surface", "the same"),
    "across, surface": ("tangential curvature of the level's surface", "the same"),
    "along, surface": ("profile curvature of the level's surface", "the same"),
    "wavelet": ("component of a band, absolute", "`pytopocomplexity` `CWTMexHat`"),
    "wavelet, smoothed": ("energy of a band", "the same, mean over a wavelength"),
}


#: Landforms over windows, and of the surface of the level.
FORMS = {"landforms": False, "landforms, surface": True}


def chosen_ratios(theirs, ours, cell):
    """Return for each map the window in spacings at which the two agree best in the mean."""
    ratios = {}
    for name in MAPS:
        windows = [w for w in WINDOWS if (name, w) in theirs]
        if windows:
            means = [
                np.mean([rank(theirs[name, w], ours.at(name, w * cell / r)) for w in windows])
                for r in RATIOS
            ]
            ratios[name] = RATIOS[int(np.argmax(means))]
    windows = [w for w in WINDOWS if ("landforms", w) in theirs]
    for name, of_surface in FORMS.items() if windows else ():
        means = [
            np.mean(
                [
                    kappa(
                        theirs["landforms", w],
                        ours.forms(w * cell / r, theirs["bend", w], of_surface),
                    )[0]
                    for w in windows
                ]
            )
            for r in RATIOS
        ]
        ratios[name] = RATIOS[int(np.argmax(means))]
    return ratios


def compared(theirs, several, ratios, cell):
    """Return the figures of one DEM: those of each map by window."""
    figures = {}
    for (name, window), published in theirs.items():
        if name not in MAPS:
            continue
        distance = OVER_ALL if window == OVER_ALL else window * cell / ratios[name]
        maps = [ours.at(name, distance) for ours in several]
        figures.setdefault(name, {})[str(window)] = {
            "ours": rank(maps[0], published),
            "mean of four": rank(np.mean(maps, axis=0), published),
            "of itself": rank(maps[0], maps[1]),
        }
    for window in WINDOWS:
        if ("landforms", window) not in theirs:
            continue
        bend, published = theirs["bend", window], theirs["landforms", window]
        geomorphons = theirs["geomorphons", window]
        for name, of_surface in FORMS.items():
            distance = window * cell / ratios[name]
            one, other = (ours.forms(distance, bend, of_surface) for ours in several[:2])
            pairs = {
                "ours": (one, published),
                "of itself": (one, other),
                "ours and geomorphons": (one, geomorphons),
                "features and geomorphons": (published, geomorphons),
            }
            figures.setdefault(name, {})[str(window)] = {
                key: kappa(*pair)[0] for key, pair in pairs.items()
            } | {"equal": kappa(*pairs["ours"])[1]}
    return figures


def published_maps(z, cell, folder):
    """Return the published maps of a DEM, of those programs that are there."""
    theirs, maps = Theirs(z, cell, folder), {}
    if find_spec("whitebox_workflows"):
        maps.update(theirs.whitebox())
    if which("grass"):
        maps.update(theirs.grass())
    if find_spec("pytopocomplexity"):
        maps.update(theirs.wavelets())
    return maps


def as_markdown(results):
    """Return the table of the results: the mean over windows, ours and the mean of four."""
    dems = [name for name in results if name != "ratios"]
    header = [
        "ours",
        "published",
        "window / spacing",
        *(f"`{name.split('.')[0]}`" for name in dems),
    ]
    lines = ["| " + " | ".join(header) + " |", "| --- | --- | ---: |" + " ---: |" * len(dems)]
    rows = [(name, window) for name in MAPS for window in ("windows", OVER_ALL)]
    for name, kind in rows:
        cells = []
        for dem in dems:
            by_window = results[dem].get(name, {})
            found = [v for w, v in by_window.items() if (w == OVER_ALL) == (kind == OVER_ALL)]
            if found:
                keys = ("ours", "mean of four", "of itself")
                cells.append(" / ".join(f"{np.mean([f[key] for f in found]):.2f}" for key in keys))
        if cells:
            title, published = MAPS[name]
            title = f"strongest {title}" if kind == OVER_ALL and "scale" not in name else title
            ratio = "" if kind == OVER_ALL else f"{results['ratios'][name]:g}"
            lines.append(f"| {title} | {published} | {ratio} | " + " | ".join(cells) + " |")
    feature = "GRASS `r.param.scale` feature"
    for name, key, title, published in (
        ("landforms", "ours", "landforms (kappa)", feature),
        ("landforms, surface", "ours", "landforms of the level's surface (kappa)", "the same"),
        ("landforms", "ours and geomorphons", "landforms (kappa)", "GRASS `r.geomorphon`"),
        ("landforms", "features and geomorphons", f"{feature[6:]} (kappa)", "GRASS `r.geomorphon`"),
    ):
        cells = []
        for dem in dems:
            found = list(results[dem].get(name, {}).values())
            if found:
                text = f"{np.mean([f[key] for f in found]):.2f}"
                if key == "ours":
                    text += f" / – / {np.mean([f['of itself'] for f in found]):.2f}"
                cells.append(text)
        if cells:
            ratio = "" if key == "features and geomorphons" else f"{results['ratios'][name]:g}"
            lines.append(f"| {title} | {published} | {ratio} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def draw(path, ratios):
    """Draw ours over the published ones, on matplotlib's sample DEM."""
    import matplotlib as mpl

    mpl.use("agg")
    import matplotlib.pyplot as plt
    from matplotlib import cbook, colors
    from PIL import Image

    sample = cbook.get_sample_data("jacksboro_fault_dem.npz")
    z, cell = sample["elevation"].astype(float), 83.0
    with TemporaryDirectory() as folder:
        theirs = published_maps(z, cell, folder)
    ours, window = Ours(Terrain(z, cell), 0), 17
    forms = colors.ListedColormap(
        ["#ebe6d7", "#08306b", "#4292c6", "#78b478", "#d98c46", "#a50f15"]
    )
    columns = [
        ("roughness", "Roughness", "magma", window),
        ("deviation", "Strongest deviation", "RdBu_r", OVER_ALL),
        ("across", "Curvature across the slope", "RdBu_r", window),
        ("landforms", "Landforms", forms, window),
    ]
    figure, axes = plt.subplots(2, 4, figsize=(13, 5.9), layout="constrained")
    for column, (name, title, colours, size) in zip(axes.T, columns, strict=True):
        distance = OVER_ALL if size == OVER_ALL else size * cell / ratios[name]
        if name == "landforms":
            pair = [ours.forms(distance, theirs["bend", size]), theirs[name, size]]
        else:
            pair = [ours.at(name, distance), theirs[name, size]]
        for axis, field in zip(column, pair, strict=True):
            low, high = np.nanquantile(inner(field.astype(float)), [0.02, 0.98])
            if colours == "RdBu_r":
                low, high = -max(-low, high), max(-low, high)
            if name == "landforms":
                low, high = -0.5, 5.5
            axis.imshow(field, cmap=colours, vmin=low, vmax=high, interpolation="nearest")
            axis.set_xticks([])
            axis.set_yticks([])
        column[0].set_title(title)
    axes[0, 0].set_ylabel("ours")
    axes[1, 0].set_ylabel("published")
    figure.savefig(path, dpi=100)
    Image.open(path).convert("RGB").quantize(128).save(path, optimize=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", nargs="?", default="../shared/data", type=Path)
    parser.add_argument(
        "--dems", nargs="+", metavar="NAME", help="parts of names of files, clouds too"
    )
    parser.add_argument("--output", type=Path, help="keep the results")
    parser.add_argument("--picture", type=Path, help="draw the maps of matplotlib's sample DEM")
    parser.add_argument("--write", type=Path, metavar="PAGE", help="put kept results into a page")
    arguments = parser.parse_args()
    if arguments.write:
        page = arguments.write.read_text(encoding="utf-8")
        before, mark, rest = page.partition("<!-- maps: results -->\n")
        if not mark:
            parser.error(f"{arguments.write} has no line <!-- maps: results -->; add it.")
        table = as_markdown(json.loads(RESULTS.read_text(encoding="utf-8")))
        after = rest[rest.index("<!-- end -->") :]
        arguments.write.write_text(f"{before}{mark}{table}\n{after}", encoding="utf-8")
        return
    for package in ("whitebox_workflows", "pytopocomplexity"):
        if not find_spec(package):
            print(f"{package} is left out: it is not installed.", flush=True)
    if not which("grass"):
        print("GRASS is left out: there is no program grass.", flush=True)
    results: dict[str, dict] = {}
    for name, terrain in terrains(arguments.data, arguments.dems or [""]):
        cell = terrain.cell
        with TemporaryDirectory() as folder:
            theirs = published_maps(terrain.z, cell, folder)
        several = [Ours(terrain, seed) for seed in range(N_PYRAMIDS)]
        if not results:
            results["ratios"] = chosen_ratios(theirs, several[0], cell)
        results[name] = compared(theirs, several, results["ratios"], cell)
        print(name, json.dumps(results[name]), flush=True)
        if arguments.output:
            text = json.dumps(results, indent=1) + "\n"
            arguments.output.write_text(text, encoding="utf-8")
    if arguments.picture:
        kept = results or json.loads(RESULTS.read_text(encoding="utf-8"))
        draw(arguments.picture, kept["ratios"])
    print(as_markdown(results))


if __name__ == "__main__":
    main()
