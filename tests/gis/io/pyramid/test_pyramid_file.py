"""A pyramid file holds all of a pyramid, and writes the same bytes for the same input."""

import contextlib
import sqlite3
import subprocess
import sys

import numpy as np
import pytest
from gis import samples
from gis.samples import write_las, write_tif
from helpers import ForecastWriter
from helpers_meshes import random_delaunay

from wavelet_core import Cancelled, TriangleMesh, WaveletError, analyse
from wavelet_core.lifting import recorded
from wavelet_core.partition.questions import Writer
from wavelet_core.synthetic import hills
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.io.pyramid.pyramid_file import (
    read_input,
    read_levels,
    read_pyramid,
    read_summary,
    write_pyramid,
)
from wavelet_gis.model.dem import Dem
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.mesh_origin import MeshOrigin
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.workflows.open import open_terrain


def assert_same_pyramid(actual, expected):
    assert actual.channels == expected.channels
    assert (actual.signal, actual.update) == (expected.signal, expected.update)
    assert dict(actual.parameters) == dict(expected.parameters)
    for name in ("faces", "horizontal", "coarse", "locked"):
        a, b = getattr(actual, name), getattr(expected, name)
        assert (a is None) == (b is None), name
        if a is not None:
            assert a.dtype == b.dtype
            assert a.tobytes() == b.tobytes(), name
    assert actual.n_levels == expected.n_levels
    for step, other in zip(actual.steps, expected.steps, strict=True):
        for name in ("odd", "target", "indptr", "indices", "weights", "details"):
            a, b = getattr(step, name), getattr(other, name)
            assert a.dtype == b.dtype
            assert a.tobytes() == b.tobytes(), name


def record_of(mesh, **options):
    return GeoPyramid(
        pyramid=analyse(mesh, **options),
        system=CoordinateSystem(),
        frame=LocalFrame(),
        vertical_unit="metre",
        origin=MeshOrigin(),
        source_name="hills",
    )


@pytest.mark.parametrize("name", ["raster", "cloud"])
def test_all_of_it_is_read_again(name, request):
    geo = request.getfixturevalue(f"{name}_record")
    back = read_pyramid(request.getfixturevalue(f"{name}_pyramid"))
    assert_same_pyramid(back.pyramid, geo.pyramid)
    assert back.system == geo.system
    assert back.frame == geo.frame
    assert back.errors == geo.errors
    assert back.origin.checksum == geo.origin.checksum
    assert isinstance(back.restore(), Dem if name == "raster" else PointCloud)


@pytest.mark.parametrize("design", ["GLMN", "ULMO", "NNLSORMP", "CLMN"])
@pytest.mark.parametrize("signal", ["z", "xyz"])
def test_every_filter_and_signal(tmp_path, signal, design):
    design = design.replace("ULMO", "UGMO")
    geo = record_of(hills(12, 15), levels=3, prediction=design, signal=signal)
    write_pyramid(tmp_path / "a.gpkg", geo)
    back = read_pyramid(tmp_path / "a.gpkg")
    assert_same_pyramid(back.pyramid, geo.pyramid)
    restored = back.restore()
    assert isinstance(restored, TriangleMesh)
    np.testing.assert_allclose(restored.vertices, hills(12, 15).vertices, atol=1e-9)


def test_locked_vertices_and_no_levels(tmp_path):
    mesh = hills(10, 10)
    locked = np.arange(mesh.n_vertices) % 3 == 0
    for k, geo in enumerate([record_of(mesh, locked=locked), record_of(mesh, levels=0)]):
        write_pyramid(tmp_path / f"{k}.gpkg", geo)
        assert_same_pyramid(read_pyramid(tmp_path / f"{k}.gpkg").pyramid, geo.pyramid)


def test_vertices_of_no_face(tmp_path):
    grid = np.zeros((6, 6))
    valid = np.ones((6, 6), bool)
    valid[:2, 1] = valid[1, 0] = False  # the corner cell stands alone
    mesh = TriangleMesh.from_grid(grid, np.arange(6.0), np.arange(6.0), valid=valid)
    geo = record_of(mesh, levels=2)
    write_pyramid(tmp_path / "a.gpkg", geo)
    assert read_pyramid(tmp_path / "a.gpkg").restore().n_vertices == 33


def test_an_altered_pyramid_is_stored_as_such(raster_record, tmp_path):
    pyramid = raster_record.pyramid
    flattened = pyramid.with_parts(coarse=pyramid.coarse * 0 + 250.0)
    altered = raster_record.with_pyramid(flattened, "coarse heights set to 250")
    write_pyramid(tmp_path / "a.gpkg", altered)
    back = read_pyramid(tmp_path / "a.gpkg")
    assert back.history == ("coarse heights set to 250",)
    assert not back.origin.is_exact
    assert back.errors is None
    values = back.restore().values
    assert values.dtype == np.float32
    assert np.abs(values[values > -9000] - 250).max() < 50


def test_an_altered_pyramid_lists_but_what_does_not_follow(raster_record, tmp_path):
    """Filters follow from the collapses, x and y from the cells; what is read is the same."""
    pyramid = raster_record.pyramid.with_gains({2: 0.5, 1: 2.0})
    write_pyramid(tmp_path / "a.gpkg", raster_record.with_pyramid(pyramid, "gains"))
    back = read_pyramid(tmp_path / "a.gpkg")
    assert back.pyramid == pyramid
    summary = read_summary(tmp_path / "a.gpkg")
    assert summary["format"]["version"] == 3
    assert (summary["pyramid"]["steps"], summary["pyramid"]["plan"]) == ("places", "cells")
    names = array_names(tmp_path / "a.gpkg")
    assert {"steps/0002/odd", "steps/0002/places", "steps/0002/details"} <= names
    assert not {"horizontal", "steps/0002/target", "steps/0002/weights"} & names


@pytest.mark.parametrize(
    "options",
    [{}, {"locked": True}, {"outline_tolerance": 3.0, "target_vertices": 60}, {"max_error": 0.5}],
)
def test_a_tin_of_the_default_design_lists_but_what_does_not_follow(options, tmp_path):
    mesh = random_delaunay(300, n_attributes=1, seed=5)
    if options.pop("locked", False):
        options = {"locked": np.random.default_rng(0).random(mesh.n_vertices) < 0.5}
    geo = record_of(mesh, **options)
    write_pyramid(tmp_path / "a.gpkg", geo)
    assert read_pyramid(tmp_path / "a.gpkg").pyramid == geo.pyramid
    assert "steps/0000/places" in array_names(tmp_path / "a.gpkg")
    assert "steps/0000/weights" not in array_names(tmp_path / "a.gpkg")


def test_other_designs_list_their_filters(tmp_path):
    geo = record_of(random_delaunay(200, seed=5), levels=3, prediction="GLMN")
    write_pyramid(tmp_path / "a.gpkg", geo)
    assert read_pyramid(tmp_path / "a.gpkg").pyramid == geo.pyramid
    assert "steps/0000/weights" in array_names(tmp_path / "a.gpkg")
    assert read_summary(tmp_path / "a.gpkg")["format"]["version"] == 2


@pytest.mark.parametrize(("levels", "has_index"), [(3, False), (12, True)])
def test_chunks_of_many_arrays_have_an_index(levels, has_index, tmp_path):
    geo = record_of(random_delaunay(200, seed=5), levels=levels, prediction="GLMN")
    write_pyramid(tmp_path / "a.gpkg", geo, is_alone=True)
    assert read_pyramid(tmp_path / "a.gpkg").pyramid == geo.pyramid
    with contextlib.closing(sqlite3.connect(tmp_path / "a.gpkg")) as connection:
        indices = connection.execute("PRAGMA index_list(wavelet_chunks)").fetchall()
    assert len(indices) == has_index
    assert (len(array_names(tmp_path / "a.gpkg")) > 64) == has_index


def test_means_that_repeat_come_back_from_a_palette(tmp_path):
    terrain = samples.hills(40, 50)
    thirds = np.rint(100 * terrain / np.ptp(terrain)) / 3.0
    thirds[3:6, 7:9] = -9999
    terrain = open_terrain(write_tif(tmp_path / "thirds.tif", thirds, nodata=-9999))
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=3))
    write_pyramid(tmp_path / "a.gpkg", geo)
    assert "source/palette" in array_names(tmp_path / "a.gpkg")
    assert read_summary(tmp_path / "a.gpkg")["format"]["version"] == 4
    assert read_pyramid(tmp_path / "a.gpkg").pyramid == geo.pyramid
    assert read_input(tmp_path / "a.gpkg").restore().values.tobytes() == thirds.tobytes()


@pytest.mark.parametrize("part_share", [0.0, 0.25])
def test_a_file_that_asks_by_forecasts_is_of_format_2_and_read(part_share, tmp_path, monkeypatch):
    """As all records were before format 4, in one part and in several."""
    monkeypatch.setattr(recorded, "LEAST_IN_PARTS", 1000)
    monkeypatch.setattr(recorded, "LEAST_IN_PART", 10)
    monkeypatch.setattr(recorded, "PART_SHARE", part_share)
    terrain = open_terrain(write_las(tmp_path / "a.laz", 3000))
    sizes = {}
    for name, writer in (("now", Writer), ("before", ForecastWriter)):
        monkeypatch.setattr(recorded, "Writer", writer)
        geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=20, record=True))
        write_pyramid(tmp_path / f"{name}.gpkg", geo)
        assert read_pyramid(tmp_path / f"{name}.gpkg").pyramid == geo.pyramid
        for level in (0, 10):
            part = read_levels(tmp_path / f"{name}.gpkg", level)
            assert part.pyramid.mesh(level) == geo.pyramid.mesh(level)
        sizes[name] = sum(len(data) for _, data in chunks_of(tmp_path / f"{name}.gpkg"))
    assert read_summary(tmp_path / "before.gpkg")["format"]["version"] == 2
    assert sizes["now"] < 0.98 * sizes["before"]


def chunks_of(path):
    with contextlib.closing(sqlite3.connect(path)) as connection:
        return connection.execute(
            "SELECT name, data FROM wavelet_arrays AS a JOIN wavelet_chunks ON array_id = a.id "
            "WHERE name LIKE 'parts/%/going' OR name LIKE 'parts/%/targets'"
        ).fetchall()


def array_names(path):
    with contextlib.closing(sqlite3.connect(path)) as connection:
        return {name for (name,) in connection.execute("SELECT name FROM wavelet_arrays")}


def test_the_summary_needs_no_arrays(raster_pyramid, raster_record):
    summary = read_summary(raster_pyramid)
    assert summary["format"]["version"] == 4
    assert summary["pyramid"]["n_vertices"] == raster_record.origin.n_vertices
    assert summary["source"]["shape"] == [40, 50]
    assert [level["level"] for level in summary["levels"]] == [4, 3, 2, 1, 0]
    assert summary["levels"][-1]["rmse_surface"] > 0


def test_it_is_valid_without_layers(cloud_pyramid, validate_gpkg):
    validate_gpkg(cloud_pyramid)


def test_the_same_input_gives_the_same_bytes(raster_record, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    from wavelet_gis.io.vector.vector_writer import add_layers
    from wavelet_gis.products.layers import coarse_layers, detail_layers

    for name in ("a.gpkg", "b.gpkg"):
        write_pyramid(tmp_path / name, raster_record)
        layers = [*coarse_layers(raster_record), *detail_layers(raster_record)]
        add_layers(tmp_path / name, layers, raster_record.system)
    assert (tmp_path / "a.gpkg").read_bytes() == (tmp_path / "b.gpkg").read_bytes()


def test_progress_rises_and_stops(raster_record, tmp_path):
    seen = []
    write_pyramid(tmp_path / "a.gpkg", raster_record, seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1)
    with pytest.raises(Cancelled):
        write_pyramid(tmp_path / "b.gpkg", raster_record, lambda fraction: fraction < 0.5)


def test_numbers_of_a_raster_that_do_not_come_back_are_not_kept(
    raster_record, tmp_path, monkeypatch
):
    """Reading back compared the arrays, not what follows from them."""
    from wavelet_gis.io.pyramid import source_parts

    def wrong(*arguments):
        return decode_grid(*arguments) + 1

    decode_grid = source_parts.decode_grid
    monkeypatch.setattr(source_parts, "decode_grid", wrong)
    with pytest.raises(WaveletError, match="come back as others"):
        write_pyramid(tmp_path / "a.gpkg", raster_record)


LIGHT = [
    "crs.frame",
    "model.dem",
    "model.points.cloud",
    "model.points.origin",
    "model.exact_restore",
    "io.pyramid.codecs.array_codec",
    "io.pyramid.array_tables",
    "io.geopackage",
    "model.geo_pyramid",
    "io.pyramid.pyramid_file",
    "products.layers",
    "products.styles",
    "products.wkb",
    "products.rasterise",
    "io.mesh.meshes",
    "io.atomic",
    "cli.console",
    "errors",
    "model.attributes.ground",
]


HEAVY = {"rasterio", "pyogrio", "pyproj", "laspy", "lazrs", "shapely", "tqdm"}


def test_what_qgis_uses_needs_numpy_and_scipy_only(raster_pyramid):
    code = f"""
import sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {HEAVY!r}:
            raise ImportError(name + " is absent")

sys.meta_path.insert(0, Absent())
for name in {LIGHT!r}:
    __import__("wavelet_gis." + name)
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid
from wavelet_gis.products.layers import coarse_layers
geo = read_pyramid({str(raster_pyramid)!r})
assert len(list(coarse_layers(geo))) == 2
print(geo.restore().values.shape)
"""
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.stdout.strip() == "(40, 50)", result.stderr


@pytest.mark.parametrize("name", ["raster", "cloud"])
def test_reading_reports_every_level(name, request):
    geo, path = (
        request.getfixturevalue(f"{name}_record"),
        request.getfixturevalue(f"{name}_pyramid"),
    )
    seen = []
    assert_same_pyramid(read_pyramid(path, seen.append).pyramid, geo.pyramid)
    assert len(seen) >= geo.pyramid.n_levels
    assert seen == sorted(seen)
    assert 0 <= seen[0] <= seen[-1] <= 1


@pytest.mark.parametrize("read", [read_pyramid, lambda path, go: read_levels(path, 0, go)])
@pytest.mark.parametrize("name", ["raster", "cloud"])
def test_reading_that_is_cancelled_is_no_damaged_file(name, read, request):
    with pytest.raises(Cancelled):
        read(request.getfixturevalue(f"{name}_pyramid"), lambda fraction: fraction < 0.2)


@pytest.mark.parametrize("design", [{}, {"prediction": "geometric", "partition": "quadric"}])
def test_listed_and_placed_levels_are_reported_too(design, tmp_path):
    mesh = random_delaunay(400, seed=3)
    geo = record_of(mesh, levels=4, **design)
    written = []
    write_pyramid(tmp_path / "p.gpkg", geo, written.append)
    assert written == sorted(written)
    assert len([fraction for fraction in written if fraction > 0.8]) > 4  # read back
    seen = []
    assert_same_pyramid(read_pyramid(tmp_path / "p.gpkg", seen.append).pyramid, geo.pyramid)
    assert len(seen) >= 4
    assert seen == sorted(seen)
