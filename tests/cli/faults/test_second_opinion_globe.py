"""The errors that `terrain` tells of each zoom, against tiles read by a decoder of the tests' own.

At all points of the input: single cells, strips, rims of holes, points that share x and y.
"""

import laspy
import numpy as np
import pytest
from gis.samples import UTM, hills, write_tif
from pyproj import Transformer
from tools.quantized_mesh_reader import STEPS, bounds_of, decode
from tools.random_terrain import SLACK
from tools.second_opinion import second_opinion

from wavelet_gis.cli.main import main

pytestmark = pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")


def dem_with_everything(folder):
    """Write a DEM with holes, strips one cell wide and single cells; return its cells."""
    values = np.full((90, 110), -9999.0)
    values[:50, :60] = hills(50, 60)
    values[20:27, 10:24] = -9999.0
    values[22, 15], values[70, 90], values[80, 20], values[60:88, 70] = 350, 222, 280, 310
    values[55, 5:40], values[75, 40:43] = np.arange(35) + 290.0, 305
    rows, columns = np.nonzero(values != -9999.0)
    x, y = 5e5 + 10 * (columns + 0.5), 5.1e6 - 10 * (rows + 0.5)
    path = write_tif(folder / "a.tif", values, nodata=-9999.0)
    return path, np.column_stack([x, y, values[rows, columns]])


def cloud_with_everything(folder):
    """Write a cloud with points that share x and y 12 m apart, a gap, and points far off."""
    rng = np.random.default_rng(8)
    plan = rng.uniform(0, 300, (3000, 2))
    plan[1500:, 0] += 500
    plan[:60] = plan[60:120]
    plan[-3:] = [[400, 900], [900, 950], [420, 890]]
    las = laspy.LasData(laspy.LasHeader(version="1.4", point_format=6))
    las.header.scales, las.header.offsets = [0.01] * 3, [5e5, 5.1e6, 0.0]
    las.x, las.y = 5e5 + plan[:, 0], 5.1e6 + plan[:, 1]
    las.z = 100 + 5 * np.sin(plan[:, 0] / 30) * np.cos(plan[:, 1] / 40)
    las.z[:60] += 12.0
    las.write(folder / "a.las")
    return folder / "a.las", np.column_stack([las.x, las.y, las.z])


def errors_at_zoom(folder, zoom, points):
    """Return what the second opinion has on the tiles of a zoom: the largest, and uncovered."""
    largest, n_uncovered, n_measured = 0.0, 0, 0
    for path in (folder / str(zoom)).rglob("*.terrain"):
        tile = decode(path.read_bytes())
        west, south, east, north = bounds_of(zoom, int(path.parent.name), int(path.stem))
        inside = (points[:, 0] >= west) & (points[:, 0] < east)
        inside &= (points[:, 1] >= south) & (points[:, 1] < north)
        if not inside.any():
            continue
        mine = points[inside]
        across = (mine[:, 0] - west) / (east - west) * STEPS
        up = (mine[:, 1] - south) / (north - south) * STEPS
        vertices = np.column_stack([tile.u, tile.v, tile.heights()]).astype(float)
        at = np.column_stack([across, up, mine[:, 2]])
        opinion = second_opinion(vertices, tile.triangles, at)
        largest = max(largest, opinion.largest)
        n_uncovered += opinion.n_uncovered
        n_measured += len(mine)
    assert n_measured == len(points)
    return largest, n_uncovered


@pytest.mark.parametrize(
    "source", ["dem", "pyramid", "lowest", "mean", "cloud pyramid", "lowest tiles", "mean tiles"]
)
def test_the_errors_of_every_zoom(source, tmp_path, done):
    if source in ("dem", "pyramid"):
        path, points = dem_with_everything(tmp_path)
        options = []
    else:
        path, points = cloud_with_everything(tmp_path)
        options = ["--crs", UTM]
    if source.startswith(("lowest", "mean")):
        options += ["--duplicates", source.split()[0]]
    if source.endswith("pyramid"):
        pyramid = tmp_path / "p.gpkg"
        assert main(["analyse", str(path), str(pyramid), *options, "--levels", "3", "--quiet"]) == 0
        path, options = pyramid, []
    if source.endswith("tiles"):
        folder = tmp_path / "t"
        size = ["--tile", "820", "--levels", "3", "--workers", "1", "--quiet"]
        assert main(["tile", str(path), str(folder), *options, *size]) == 0
        path, options = folder / "index.gpkg", []
    limits = ("--max-error", "1", "--max-zoom", "16")
    told = done("terrain", path, tmp_path / "out", *limits, *options, "--json").figures
    to_degrees = Transformer.from_crs(UTM, "EPSG:4326", always_xy=True)
    longitude, latitude = to_degrees.transform(points[:, 0], points[:, 1])
    on_earth = np.column_stack([longitude, latitude, points[:, 2]])
    is_kept = True
    for zoom in told["zooms"]:
        largest, n_uncovered = errors_at_zoom(tmp_path / "out", zoom["zoom"], on_earth)
        # heights are stored in float32; positions of some steps of the finest zoom are rounded
        assert zoom["max_error"] == pytest.approx(largest, abs=SLACK * 1e3), zoom
        assert zoom["n_uncovered"] == n_uncovered == 0
        is_kept &= largest <= zoom["promised"]
        if source not in ("dem", "pyramid"):
            assert largest > 6 - 0.01  # points of one place are 12 apart
    codes = [note["code"] for note in told["notes"]]
    if source in ("dem", "pyramid"):  # whose single cells are spikes of 300 m
        assert ("zoom_error_exceeded" in codes) == (not is_kept)
    assert ("error_above_what_was_asked" in codes) == (source not in ("dem", "pyramid"))
