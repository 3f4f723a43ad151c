"""Every error that is told of a tile set, against a search that shares no code with the package.

Rasters with holes over the lines between tiles, single cells and strips; clouds with points that
share x and y 12 m apart, a gap, and tiles of too few points for a surface.
"""

import sqlite3
from contextlib import closing

import laspy
import numpy as np
import pyogrio
import pytest
import rasterio
import shapely
from gis.samples import UTM, hills, write_tif
from tools.random_terrain import compare
from tools.second_opinion import errors_of, read_ply, second_opinion

pytestmark = pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")

RELIEF = 130.0

#: A box, and a polygon that is none, that cut through tiles, holes and single cells.
BOX = (500301.0, 5098700.0, 501203.0, 5099406.0)
POLYGON = shapely.Polygon([(500100, 5099900), (501500, 5099500), (500700, 5098300)])


@pytest.fixture(scope="module")
def raster(tmp_path_factory):
    """Return a DEM with holes, single cells and strips, and its cells as points."""
    values = np.full((60, 80), -9999.0)
    values[:34, :36] = hills(34, 36)
    values[18:23, 8:12] = -9999.0
    values[40, 50], values[50, 10], values[45, 52:60], values[20, 41] = 300, 222, 280, 333
    values[36:58, 70], values[36, 62:76] = np.arange(22) + 290.0, 310
    side = 33.3652
    place = rasterio.Affine(side, 0.0, 5e5, 0.0, -side, 5.1e6)
    path = tmp_path_factory.mktemp("raster") / "a.tif"
    write_tif(path, values, nodata=-9999.0, transform=place)
    rows, columns = np.nonzero(values != -9999.0)
    x, y = 5e5 + side * (columns + 0.5), 5.1e6 - side * (rows + 0.5)
    return path, np.column_stack([x, y, values[rows, columns]])


@pytest.fixture(scope="module")
def cloud(tmp_path_factory):
    """Return a cloud with everything, with tiles of a point or two, and its points."""
    rng = np.random.default_rng(8)
    plan = rng.uniform(0, 700, (12000, 2))
    plan[6000:, 0] += 800
    plan[:200] = plan[200:400]
    plan[-40:] = np.round(plan[-40:] / 50) * 50  # some of them on the lines between tiles
    plan[-5:] = [[90, 1700], [1400, 1690], [1410, 1700], [700, 1650], [710, 1650]]
    las = laspy.LasData(laspy.LasHeader(version="1.4", point_format=6))
    las.header.scales, las.header.offsets = [0.01] * 3, [5e5, 5.0985e6, 0.0]
    las.x, las.y = 5e5 + plan[:, 0], 5.0985e6 + plan[:, 1]
    las.z = 100 + 5 * np.sin(plan[:, 0] / 60) * np.cos(plan[:, 1] / 90)
    las.z[:200] += 12.0
    path = tmp_path_factory.mktemp("cloud") / "a.las"
    las.write(path)
    return path, np.column_stack([las.x, las.y, las.z])


@pytest.fixture(scope="module", params=["raster", "cloud lowest", "cloud mean", "cloud first"])
def tiled(request, tmp_path_factory):
    """Return the index of a tile set and the input's points."""
    from wavelet_gis.cli.main import main

    kind, _, rule = request.param.partition(" ")
    path, points = request.getfixturevalue(kind)
    folder = tmp_path_factory.mktemp("tiles") / "t"
    options = ["--tile", "20"] if kind == "raster" else ["--tile", "500", "--duplicates", rule]
    given = ["tile", str(path), str(folder), "--levels", "4", "--workers", "1", "--quiet"]
    if kind == "cloud":
        options += ["--crs", UTM]
    assert main([*given, *options]) == 0
    return folder / "index.gpkg", points


@pytest.mark.parametrize("limit", [0.01, 0.5, 3.0, 12.5, 40.0])
def test_a_tile_set_within_a_tolerance(tiled, tmp_path, done, limit):
    index, points = tiled
    output = tmp_path / "a.ply"
    figures = done("extract", index, output, "--max-error", limit, "--json").figures
    opinion = second_opinion(*read_ply(output), points)
    compare(f"extract --max-error {limit}", figures, opinion, RELIEF)
    is_cloud = points[0, 1] < 5.0999e6  # has tiles without a surface
    assert (opinion.n_uncovered > 0) == is_cloud


@pytest.mark.parametrize("limit", [0.5, 12.5])
@pytest.mark.parametrize("way", ["bbox", "polygon"])
def test_a_region_of_a_tile_set_within_a_tolerance(tiled, tmp_path, done, way, limit):
    """Its points are those in the region, and those beside it under its triangles."""
    index, points = tiled
    where, shape = ",".join(map(str, BOX)), shapely.box(*BOX)
    if way == "polygon":
        where, shape = tmp_path / "p.geojson", POLYGON
        wkb = np.array([shapely.to_wkb(POLYGON)])
        pyogrio.raw.write(where, wkb, [], [], geometry_type="Polygon", crs=UTM)
    output = tmp_path / "a.ply"
    rule = ("--max-error", limit, f"--{way}", where)
    figures = done("extract", index, output, *rule, "--json").figures
    mesh = read_ply(output)
    is_there = np.isfinite(errors_of(*mesh, points))
    is_inside = shapely.intersects_xy(shape, points[:, 0], points[:, 1])
    assert 0 < is_inside.sum() < len(points)
    opinion = second_opinion(*mesh, points[is_there | is_inside])
    compare(f"extract {rule}", figures, opinion, RELIEF)


def test_the_errors_in_the_index(tiled, tmp_path, done):
    """Of a tile at the input's points; of a group at its tiles' vertices, or some of them."""
    index, points = tiled
    vertices_of_tiles = {}
    with closing(sqlite3.connect(index)) as database:
        rows = database.execute(
            "SELECT stage, file, rmse, max_error FROM tiles WHERE status = 'whole'"
        ).fetchall()
    assert {stage for stage, *_ in rows} == {0, 1, 2}
    for k, (stage, file, rmse, max_error) in enumerate(rows):
        piece = index.parent / file
        levels = done("info", piece, "--json").figures["levels"]
        for level in {0, len(levels) - 1}:
            done("extract", piece, tmp_path / f"{k}_{level}.ply", "--level", level)
        at = read_ply(tmp_path / f"{k}_{len(levels) - 1}.ply")[0]
        row, column = (int(number) for number in piece.stem.split("_"))
        vertices_of_tiles[stage, row, column] = at
        if stage == 0:  # with the points that share x and y with a vertex
            keys = np.round(at[:, :2], 4)
            wanted = np.round(points[:, :2], 4)
            at = points[np.isin(wanted @ [1, 1j], keys @ [1, 1j])]
        else:
            at = np.concatenate([
                vertices
                for (of, in_row, in_column), vertices in vertices_of_tiles.items()
                if (of, in_row >> stage, in_column >> stage) == (0, row, column)
            ])  # fmt: skip
            at = np.unique(at.round(6), axis=0)  # those on lines between tiles are there twice
        opinion = second_opinion(*read_ply(tmp_path / f"{k}_0.ply"), at)
        assert opinion.n_uncovered == 0
        if stage < 2:
            compare(file, {"rmse": rmse, "max_error": max_error}, opinion, RELIEF)
        else:  # a quarter of the points
            assert rmse == pytest.approx(opinion.rmse, rel=0.1)
            assert 0.5 * opinion.largest <= max_error <= opinion.largest * (1 + 1e-9)
