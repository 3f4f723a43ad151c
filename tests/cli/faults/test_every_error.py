"""Every error that any command tells is held against another way to find it.

`HELD` lists them all, by command and place in the JSON figures, with the test that does so. A
command or an error that is not in it fails a test here.
"""

import csv
import pkgutil
import re
from pathlib import Path

import laspy
import numpy as np
import pyogrio
import pytest
import rasterio
import shapely
from gis.samples import UTM, hills, write_tif
from tools.random_terrain import compare
from tools.second_opinion import errors_of, read_ply, second_opinion

from wavelet_gis.cli import commands

pytestmark = pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")

FAULTS = Path(__file__).parent
TESTS = FAULTS.parents[1]

RANDOM = "cli/faults/test_second_opinion.py::test_random_terrain_comes_back_and_its_errors_are_true"
CLOUD = "cli/faults/test_second_opinion.py::test_a_cloud_with_everything"
TILES = "cli/faults/test_second_opinion_tiles.py::test_a_tile_set_within_a_tolerance"
GLOBE = "cli/faults/test_second_opinion_globe.py::test_the_errors_of_every_zoom"
HERE = "cli/faults/test_every_error.py::"
LEVELS = HERE + "test_levels_as_analysed_reported_and_shown"
ZONES = HERE + "test_errors_by_zone"
DETAILS = "no error: sizes of details, and of scales"

#: Where a figure is by its name an error: of a surface, or between two.
ERROR = re.compile(
    r"error|rmse|rms$|rms_|bias|difference|change|uncovered|quantile|mean|lowest|highest|sigma|largest$"
)

#: What holds such figures.
HOLDERS = {"sigma", "quantiles"}

_OF_LEVEL = {"rmse_surface": LEVELS, "max_error_surface": LEVELS, "n_uncovered": LEVELS}
_OF_SURFACE = {"rmse": CLOUD, "max_error": CLOUD, "n_points_uncovered": TILES}
_OF_ZONES = {"zones[].rmse": ZONES, "zones[].max_error": ZONES}
_OF_MERGED = {
    "notes[].figures.largest": HERE + "test_how_far_merged_points_are_from_their_vertex",
    "notes[].figures.rms": HERE + "test_how_far_merged_points_are_from_their_vertex",
}

#: By command: place of an error in its figures, and the test that finds it in another way.
HELD = {
    "analyse": {
        **{f"levels[].{name}": test for name, test in _OF_LEVEL.items()},
        "levels[].rmse_coefficients": HERE + "test_errors_of_coefficients",
        "along_lines.rmse": HERE + "test_errors_along_lines",
        "along_lines.max_error": HERE + "test_errors_along_lines",
        "along_lines.n_uncovered": HERE + "test_errors_along_lines",
        **_OF_MERGED,
    },
    "info": {
        **{f"levels[].{name}": test for name, test in _OF_LEVEL.items()},
        "levels[].rmse_coefficients": HERE + "test_errors_of_coefficients",
        **_OF_MERGED,
    },
    "extract": {**_OF_SURFACE, **_OF_ZONES, "n_uncovered": "no error: cells without data"},
    "simplify": {
        **_OF_SURFACE,
        **_OF_ZONES,
        "rounds[].rmse": HERE + "test_errors_of_the_rounds_of_a_refinement",
        "rounds[].max_error": HERE + "test_errors_of_the_rounds_of_a_refinement",
        "along_lines.rmse": HERE + "test_errors_along_lines",
        "along_lines.max_error": HERE + "test_errors_along_lines",
        "along_lines.n_uncovered": HERE + "test_errors_along_lines",
        **_OF_MERGED,
    },
    "filter": {
        "rms_change": HERE + "test_what_a_filter_changes",
        "largest_change": HERE + "test_what_a_filter_changes",
        "sigma.z": "core/filtering/test_noise_model.py::",
    },
    "difference": {
        **dict.fromkeys(("mean", "rms", "lowest", "highest"), HERE + "test_differences_of_levels"),
        **dict.fromkeys(
            ("bands[].rms", "bands[].lowest", "bands[].highest"),
            "cli/commands/test_read_off.py::test_change_since_an_earlier_survey",
        ),
    },
    "profile": dict.fromkeys(
        (f"profiles[].{n}" for n in ("lowest", "highest", "rms_difference", "max_difference")),
        HERE + "test_profiles",
    ),
    "report": {
        **{f"levels[].{name}": test for name, test in _OF_LEVEL.items()},
        "levels[].error_90": LEVELS,
        "levels[].rmse_coefficients": HERE + "test_errors_of_coefficients",
        "details.levels[].largest": DETAILS,
        "details.levels[].rms": DETAILS,
        "shown[].bias": LEVELS,
        "shown[].by_slope[].rmse_surface": LEVELS,
        "shown[].by_slope[].squared_error_share": LEVELS,
        **{f"shown[].quantiles.{q}": LEVELS for q in ("0.5", "0.9", "0.99", "1.0")},
        "shown[].worst[].error": LEVELS,
        **_OF_MERGED,
    },
    "view": {"shown[].rmse": LEVELS, "shown[].max_error": LEVELS},
    "terrain": {"zooms[].max_error": GLOBE, "zooms[].n_uncovered": GLOBE, **_OF_MERGED},
    "details": {"levels[].largest": DETAILS, "levels[].rms": DETAILS},
    "cluster": {"clusters[].rms": DETAILS},
    "classify": {},
    "contours": {},
    "reconstruct": {},
    "tile": {},  # what its index tells: test_second_opinion_tiles.py::test_the_errors_in_the_index
}


def test_every_command_is_listed():
    names = {row.name for row in pkgutil.iter_modules(commands.__path__) if row.name[0] != "_"}
    assert set(HELD) == names


def test_the_tests_that_are_named_are_there():
    named = {test for errors in HELD.values() for test in errors.values()}
    for test in named:
        if test.startswith("no error: "):
            continue
        path, _, name = test.partition("::")
        assert f"def {name or 'test_'}" in (TESTS / path).read_text("utf-8"), test


def places_of_errors(figures, place=""):
    """Yield the places of figures that are by their name errors."""
    if isinstance(figures, dict):
        for name, value in figures.items():
            if name not in ("parameters", "seconds") and not (place == "" and name == "pyramid"):
                yield from places_of_errors(value, f"{place}.{name}" if place else name)
    elif isinstance(figures, list):
        for value in figures:
            yield from places_of_errors(value, place if place.endswith("[]") else f"{place}[]")
    elif ERROR.search(place.rsplit(".", 1)[-1].removesuffix("[]")) or HOLDERS & {
        *re.split(r"\W+", place)
    }:
        yield place.removesuffix("[]")


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    """Return a DEM and a cloud with all that errors can hide in, their points, lines and zones."""
    from wavelet_gis.cli.main import main

    folder = tmp_path_factory.mktemp("every")
    values = np.full((40, 50), -9999.0)
    values[:28, :34] = hills(28, 34)
    values[8:12, 5:9] = -9999.0
    values[30, 5:40], values[35, 45], values[5:20, 44] = 310.0, 280.0, np.arange(15) + 290.0
    dem = write_tif(folder / "dem.tif", values, nodata=-9999.0)
    rows, columns = np.nonzero(values != -9999.0)
    x, y = 5e5 + 10 * (columns + 0.5), 5.1e6 - 10 * (rows + 0.5)
    of_dem = np.column_stack([x, y, values[rows, columns]])

    rng = np.random.default_rng(8)
    plan = rng.uniform(0, 60, (900, 2))
    plan[450:, 0] += 140
    plan[:60] = plan[60:120]
    las = laspy.LasData(laspy.LasHeader(version="1.4", point_format=6))
    las.header.scales, las.header.offsets = [0.01] * 3, [5e5, 5.1e6, 0.0]
    las.x, las.y = 5e5 + plan[:, 0], 5.1e6 + plan[:, 1]
    las.z = 100 + 5 * np.sin(plan[:, 0] / 9) + rng.normal(0, 0.1, 900)
    las.z[:60] += 12.0
    las.write(folder / "cloud.las")
    of_cloud = np.column_stack([las.x, las.y, las.z])

    corners = np.array([[500003, 5100005, 104], [500030, 5100031, 99], [500055, 5100020, 101.5]])
    shapes = {
        "breakline": shapely.linestrings(corners),
        "line": shapely.linestrings([[500012, 5099702], [500233, 5099951], [500471, 5099621]]),
    }
    for name, shape in shapes.items():
        kind = "LineString Z" if shape.has_z else "LineString"
        wkb = np.array([shapely.to_wkb(shape)])
        pyogrio.raw.write(folder / f"{name}.gpkg", wkb, [], [], geometry_type=kind, crs=UTM)
    box = shapely.box(500000, 5099600, 500123, 5100000)
    wkb = np.array([shapely.to_wkb(box)])
    fields = ([np.array([0.5])], ["max_error"])
    pyogrio.raw.write(folder / "zones.gpkg", wkb, *fields, geometry_type="Polygon", crs=UTM)
    for name, source, *options in (
        ("dem", dem), ("cloud", folder / "cloud.las", "--crs", UTM, "--duplicates", "mean"),
    ):  # fmt: skip
        line = ["analyse", source, folder / f"{name}.gpkg", "--levels", 4, *options, "--quiet"]
        assert main([str(word) for word in line]) == 0
    return folder, of_dem, of_cloud, corners, box


def test_every_error_that_is_told_is_listed(inputs, tmp_path, done):
    """Of each command, on input that has it tell all that it can."""
    folder, *_ = inputs
    dem, cloud, lines = folder / "dem.tif", folder / "cloud.las", folder / "breakline.gpkg"
    of_dem, of_cloud, zones = folder / "dem.gpkg", folder / "cloud.gpkg", folder / "zones.gpkg"
    of_lines = ("--breaklines", lines, "--crs", UTM)
    jobs = [
        ("analyse", dem, "a.gpkg"),
        ("analyse", cloud, "b.gpkg", *of_lines),
        ("extract", of_dem, "a.ply", "--level", 1),
        ("extract", of_dem, "b.ply", "--max-error", 3, "--zones", zones),
        ("extract", of_dem, "a.tif"),
        ("simplify", dem, "c.ply", "--max-error", 3, "--zones", zones),
        ("simplify", cloud, "d.ply", "--vertices", 200, *of_lines),
        ("filter", of_dem, "c.tif", "--gain", "0=0"),
        ("filter", of_dem, "d.tif", "--denoise"),
        ("reconstruct", of_dem, "e.tif"),
        ("details", of_dem, "f.tif"),
        ("cluster", of_dem, "g.tif", "--count", 2),
        ("contours", of_dem, "c.gpkg"),
        ("difference", of_dem, "h.tif"),
        ("difference", of_dem, "i.tif", "--since", dem),
        ("classify", cloud, "a.las", "--ground", "--crs", UTM),
        ("profile", of_dem, folder / "line.gpkg", "a.csv"),
        ("report", of_cloud, "a.html"),
        ("view", of_dem, "b.html"),
        ("tile", dem, "t", "--tile", 20, "--levels", 3, "--workers", 1),
        ("terrain", cloud, "g", "--max-error", 1, "--crs", UTM),
    ]
    told = {command: set() for command in HELD}
    told["info"] = set(places_of_errors(done("info", of_cloud, "--json").figures))
    for command, *words in jobs:
        names = [
            tmp_path / word
            if isinstance(word, str) and re.fullmatch(r"[a-z](\.\w+)?", word)
            else word
            for word in words
        ]
        told[command] |= set(places_of_errors(done(command, *names, "--json").figures))
    for command, places in told.items():
        unlisted = places - set(HELD[command])
        assert not unlisted, f"{command}: {sorted(unlisted)}"
        untold = set(HELD[command]) - places - set(_OF_MERGED)
        assert not untold, f"{command} does not tell {sorted(untold)}"


@pytest.mark.parametrize("source", ["dem", "cloud"])
def test_levels_as_analysed_reported_and_shown(inputs, tmp_path, done, source):
    folder, of_dem, of_cloud, *_ = inputs
    pyramid, points = folder / f"{source}.gpkg", of_dem if source == "dem" else of_cloud
    meshes, opinions = [], []
    for level in range(5):
        done("extract", pyramid, tmp_path / f"{level}.ply", "--level", level)
        meshes.append(read_ply(tmp_path / f"{level}.ply"))
        opinions.append(second_opinion(*meshes[-1], points))
    again = ["--crs", UTM, "--duplicates", "mean"] if source == "cloud" else []
    given = folder / ("dem.tif" if source == "dem" else "cloud.las")
    analysed = done("analyse", given, tmp_path / "p.gpkg", "--levels", 4, *again, "--json").figures
    report = done("report", pyramid, tmp_path / "a.html", "--json").figures
    rows = [*analysed["levels"], *done("info", pyramid, "--json").figures["levels"]]
    for row in [*rows, *report["levels"]]:
        compare(f"level {row['level']}", row, opinions[row["level"]], 130.0)
    for row in done("view", pyramid, tmp_path / "b.html", "--json").figures["shown"]:
        compare(f"shown {row['level']}", row, opinions[row["level"]], 130.0)
    for row in report["levels"]:
        errors = np.abs(errors_of(*meshes[row["level"]], points))
        assert row["error_90"] == pytest.approx(np.nanquantile(errors, 0.9), abs=1e-6)
    for shown in report["shown"]:
        errors = errors_of(*meshes[shown["level"]], points)
        # places by themselves have no slope, and are in no class of it
        has_slope = ~np.isin(points[:, :2] @ [1, 1j], lone_places(*meshes[-1]))
        slope_errors = errors[has_slope & np.isfinite(errors)]
        for q, value in shown["quantiles"].items():
            assert value == pytest.approx(np.quantile(np.abs(slope_errors), float(q)), abs=1e-6)
        assert shown["bias"] == pytest.approx(slope_errors.mean(), abs=1e-6)
        mean_square = sum(
            row["vertex_share"] * row["rmse_surface"] ** 2
            for row in shown["by_slope"]
            if row["vertex_share"]
        )
        assert mean_square == pytest.approx((slope_errors**2).mean(), abs=1e-6)
        if mean_square:
            assert sum(r["squared_error_share"] for r in shown["by_slope"]) == pytest.approx(1.0)
        for worst in shown["worst"]:
            here = np.abs(points - [worst["x"], worst["y"], worst["z"]]).max(axis=1) < 1e-6
            assert worst["error"] == pytest.approx(errors[here][0], abs=1e-6)
        if shown["worst"]:
            largest = np.abs(slope_errors).max()
            assert abs(shown["worst"][0]["error"]) == pytest.approx(largest, abs=1e-6)


def lone_places(vertices, faces):
    """Return the places, as complex numbers, of vertices that no face uses."""
    return np.delete(vertices, np.unique(faces), axis=0)[:, :2] @ [1, 1j]


def test_errors_of_coefficients(inputs, tmp_path, done):
    """Heights at the vertices of a level against those of the input there, over the relief."""
    folder, of_dem, *_ = inputs
    height = dict(zip(map(tuple, np.round(of_dem[:, :2], 3)), of_dem[:, 2], strict=True))
    relief = float(np.ptp(of_dem[:, 2]))
    rows = done("info", folder / "dem.gpkg", "--json").figures["levels"]
    rows += done("report", folder / "dem.gpkg", tmp_path / "a.html", "--json").figures["levels"]
    for k, row in enumerate(rows):
        done("extract", folder / "dem.gpkg", tmp_path / f"{k}.ply", "--level", row["level"])
        at = read_ply(tmp_path / f"{k}.ply")[0]
        off = [
            z - height[place]
            for place, z in zip(map(tuple, np.round(at[:, :2], 3)), at[:, 2], strict=True)
        ]
        expected = np.sqrt(np.mean(np.square(off))) / relief
        assert row["rmse_coefficients"] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("rule", [("--vertices", 200), ("--max-error", 1.5), ("--rmse", 0.8)])
@pytest.mark.parametrize("source", ["dem", "cloud"])
def test_errors_of_the_rounds_of_a_refinement(inputs, tmp_path, done, rule, source):
    """The first row is the level as analysed, the last the TIN that is written."""
    folder, of_dem, of_cloud, *_ = inputs
    given, points = (folder / "dem.tif", of_dem)
    if source == "cloud":  # rounds look at the vertices, here the lowest of each place
        given, points = folder / "cloud.las", of_cloud[np.lexsort((of_cloud[:, 2],))]
        first = np.unique(np.round(points[:, :2], 3), axis=0, return_index=True)[1]
        points = points[first]
    options = [*rule, "--json", *(["--crs", UTM] if source == "cloud" else [])]
    rounds = done("simplify", given, tmp_path / "a.ply", *options).figures["rounds"]
    last = second_opinion(*read_ply(tmp_path / "a.ply"), points)
    compare("the last round", rounds[-1], last, 130.0)
    done("simplify", given, tmp_path / "b.ply", *options, "--no-refine", "--no-fit")
    first = second_opinion(*read_ply(tmp_path / "b.ply"), points)
    compare("as analysed", rounds[0], first, 130.0)


@pytest.mark.parametrize("way", ["simplify", "extract"])
def test_errors_by_zone(inputs, tmp_path, done, way):
    folder, points, _, _, box = inputs
    given = folder / ("dem.tif" if way == "simplify" else "dem.gpkg")
    rule = ("--max-error", 3, "--zones", folder / "zones.gpkg")
    figures = done(way, given, tmp_path / "a.ply", *rule, "--json").figures
    mesh = read_ply(tmp_path / "a.ply")
    is_inside = shapely.intersects_xy(box, points[:, 0], points[:, 1])
    assert [zone["most"] for zone in figures["zones"]] == [0.5, 3.0]
    for zone, inside in zip(figures["zones"], (is_inside, ~is_inside), strict=True):
        opinion = second_opinion(*mesh, points[inside])
        compare("a zone", zone, opinion, 130.0)
        assert zone["n_points"] == inside.sum()
        assert opinion.largest <= zone["most"] * (1 + 1e-9)
    compare(way, figures, second_opinion(*mesh, points), 130.0)


@pytest.mark.parametrize("way", ["simplify", "analyse"])
def test_errors_along_lines(inputs, tmp_path, done, way):
    folder, _, _, corners, _ = inputs
    options = ["--breaklines", folder / "breakline.gpkg", "--crs", UTM, "--json"]
    if way == "simplify":
        given = folder / "cloud.las"
        figures = done(way, given, tmp_path / "a.ply", "--vertices", 150, *options).figures
    else:
        figures = done(way, folder / "cloud.las", tmp_path / "a.gpkg", *options).figures
        done("extract", tmp_path / "a.gpkg", tmp_path / "a.ply")
    told = figures["along_lines"]
    opinion = second_opinion(*read_ply(tmp_path / "a.ply"), corners)
    compare("along lines", told, opinion, 24.0)
    assert told["n_uncovered"] == opinion.n_uncovered == 0


def test_errors_of_a_mesh_for_a_solver(inputs, tmp_path, done):
    pytest.importorskip("CGAL")
    folder, of_dem, *_ = inputs
    rule = ("--max-error", 2, "--min-angle", 20)
    figures = done("simplify", folder / "dem.tif", tmp_path / "a.ply", *rule, "--json").figures
    compare(
        "a solver's mesh", figures, second_opinion(*read_ply(tmp_path / "a.ply"), of_dem), 130.0
    )


def test_how_far_merged_points_are_from_their_vertex(inputs, tmp_path, done):
    folder, _, of_cloud, *_ = inputs
    given = ("analyse", folder / "cloud.las", tmp_path / "a.gpkg", "--levels", 1, "--crs", UTM)
    _, place = np.unique(np.round(of_cloud[:, :2], 3), axis=0, return_inverse=True)
    place = place.ravel()
    lowest = np.full(place.max() + 1, np.inf)
    np.minimum.at(lowest, place, of_cloud[:, 2])
    off = of_cloud[:, 2] - lowest[place]
    off = off[off > 0]
    notes = done(*given, "--json").figures["notes"]
    note = next(note["figures"] for note in notes if "rms" in note["figures"])
    assert note["n_points"] == len(off)
    assert note["largest"] == pytest.approx(off.max(), abs=1e-9)
    assert note["rms"] == pytest.approx(np.sqrt((off**2).mean()), abs=1e-9)


def test_what_a_filter_changes(inputs, tmp_path, done):
    folder, *_ = inputs
    for k, how in enumerate((["--gain", "0=0", "--gain", "1=2"], ["--denoise", 2.0])):
        output = tmp_path / f"{k}.tif"
        figures = done("filter", folder / "dem.gpkg", output, *how, "--json").figures
        with rasterio.open(output) as after, rasterio.open(folder / "dem.tif") as before:
            known = before.read_masks(1) != 0
            assert (after.read_masks(1)[known] != 0).all()
            change = (after.read(1) - before.read(1))[known]
        assert figures["largest_change"] == pytest.approx(np.abs(change).max(), abs=1e-9) != 0
        assert figures["rms_change"] == pytest.approx(np.sqrt((change**2).mean()), abs=1e-9)


@pytest.mark.parametrize(("level", "less"), [(0, None), (1, 3), (3, 1)])
def test_differences_of_levels(inputs, tmp_path, done, level, less):
    """At the centres of all cells that both cover, and at no other."""
    folder, *_ = inputs
    options = ["--level", level] + ([] if less is None else ["--less-level", less])
    pyramid, output = folder / "dem.gpkg", tmp_path / "a.tif"
    figures = done("difference", pyramid, output, *options, "--json").figures
    with rasterio.open(output) as dataset:
        shown, is_shown = dataset.read(1), dataset.read_masks(1) != 0
        rows, columns = np.mgrid[: dataset.height, : dataset.width]
        x, y = dataset.transform @ (columns.ravel() + 0.5, rows.ravel() + 0.5)
    heights = []
    for k in (level, 4 if less is None else less):
        done("extract", pyramid, tmp_path / f"{k}.ply", "--level", k)
        places = np.column_stack([x, y, np.zeros(len(x))])
        heights.append(-errors_of(*read_ply(tmp_path / f"{k}.ply"), places))
    expected = heights[0] - heights[1]
    is_known = np.isfinite(expected)
    assert (is_shown.ravel() == is_known).all()
    np.testing.assert_allclose(shown.ravel()[is_known], expected[is_known], atol=1e-5)
    known = expected[is_known]
    assert figures["n_cells"] == len(known)
    for name, value in (
        ("mean", known.mean()),
        ("rms", np.sqrt((known**2).mean())),
        ("lowest", known.min()),
        ("highest", known.max()),
    ):
        assert figures[name] == pytest.approx(value, abs=1e-5), name


def test_profiles(inputs, tmp_path, done):
    folder, *_ = inputs
    pyramid = folder / "dem.gpkg"
    given = ("profile", pyramid, folder / "line.gpkg", tmp_path / "a.csv", "--levels", "0,2,4")
    figures = done(*given, "--json").figures
    with open(tmp_path / "a.csv", encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    places = np.array([[float(row["x"]), float(row["y"]), 0.0] for row in rows])
    heights = {}
    for level in (0, 2, 4):
        done("extract", pyramid, tmp_path / f"{level}.ply", "--level", level)
        heights[level] = -errors_of(*read_ply(tmp_path / f"{level}.ply"), places)
        told = np.array([float(row[f"z_{level:02d}"] or "nan") for row in rows])
        np.testing.assert_allclose(told, heights[level], atol=1e-6)
    assert 0 < np.isnan(heights[4]).sum() < len(places)
    for row in figures["profiles"]:
        z = heights[row["level"]]
        off = np.abs(z - heights[4])
        assert row["lowest"] == pytest.approx(np.nanmin(z), abs=1e-6)
        assert row["highest"] == pytest.approx(np.nanmax(z), abs=1e-6)
        assert row["max_difference"] == pytest.approx(np.nanmax(off), abs=1e-6)
        assert row["rms_difference"] == pytest.approx(np.sqrt(np.nanmean(off**2)), abs=1e-6)
