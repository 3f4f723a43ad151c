"""A raster becomes a mesh in the right place, and the mesh the raster again."""

import numpy as np
import pytest
import rasterio
from gis.samples import hills
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from wavelet_core import analyse
from wavelet_core.errors import PyramidError
from wavelet_gis.crs.frame import LocalFrame, working_frame
from wavelet_gis.crs.lookup import coordinate_system
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.raster import write_dem
from wavelet_gis.model.dem import Dem, GridGeometry, dem_mesh, grid_bounds, taken_for_nodata
from wavelet_gis.model.raster_origin import RasterOrigin
from wavelet_gis.products.level_raster import tag_without_clash

NORTH_UP = (2.0, 0.0, 100.0, 0.0, -3.0, 60.0)
SOUTH_UP = (2.0, 0.0, 100.0, 0.0, 3.0, 0.0)
ROTATED = (1.6, -1.2, 100.0, -1.2, -1.6, 60.0)


def dem_of(values, transform=NORTH_UP, **fields):
    values = np.asarray(values)
    valid = np.isfinite(values) if values.dtype.kind == "f" else np.ones(values.shape, bool)
    fields = {"valid": valid} | fields
    return Dem(values, geometry=GridGeometry(values.shape, transform), **fields)


def source_with_corrections(dem, frame=None, levels=3):
    frame = frame or LocalFrame()
    mesh = dem_mesh(dem, frame)
    pyramid = analyse(mesh, levels=levels)
    return RasterOrigin.from_dem(dem).with_corrections(dem, pyramid.synthesise(), frame), pyramid


@pytest.mark.parametrize("transform", [NORTH_UP, SOUTH_UP, ROTATED])
def test_vertices_lie_at_the_cell_centres(transform):
    dem = dem_of(hills(5, 4), transform)
    mesh = dem_mesh(dem, LocalFrame())
    a, b, c, d, e, f = transform
    for vertex, (row, column) in zip(mesh.vertices, np.ndindex(5, 4), strict=True):
        x = a * (column + 0.5) + b * (row + 0.5) + c
        y = d * (column + 0.5) + e * (row + 0.5) + f
        assert vertex == pytest.approx((x, y, dem.values[row, column]), abs=1e-12)
    assert (mesh.plan_areas > 0).all()
    assert mesh.plan_areas.sum() == pytest.approx(abs(a * e - b * d) * 4 * 3)


@pytest.mark.parametrize("transform", [NORTH_UP, SOUTH_UP, ROTATED])
def test_cells_undo_centres(transform, rng):
    geometry = GridGeometry((7, 9), transform)
    columns, rows = rng.uniform(0, 9, 20), rng.uniform(0, 7, 20)
    back = geometry.cells(*geometry.centres(columns, rows))
    np.testing.assert_allclose(back, (columns, rows), atol=1e-12)


def test_bounds_hold_the_corners():
    assert grid_bounds(GridGeometry((20, 10), NORTH_UP)) == (100, 0, 120, 60)
    assert grid_bounds(GridGeometry((20, 10), SOUTH_UP)) == (100, 0, 120, 60)


def test_degrees_are_metres_in_the_mesh():
    dem = dem_of(hills(10, 10), (0.001, 0.0, 7.0, 0.0, -0.001, 44.0))
    frame = working_frame(coordinate_system("EPSG:4326"), grid_bounds(dem.geometry))
    mesh = dem_mesh(dem, frame)
    assert np.ptp(mesh.vertices[:, 0]) == pytest.approx(0.009 * 80213, rel=1e-3)
    assert np.ptp(mesh.vertices[:, 1]) == pytest.approx(0.009 * 111111, rel=1e-3)
    back = frame.to_file(mesh.vertices)
    columns, rows = dem.geometry.cells(back[:, 0], back[:, 1])
    np.testing.assert_allclose(columns, np.rint(columns), atol=1e-8)
    np.testing.assert_allclose(rows, np.rint(rows), atol=1e-8)


CELLS = st.sampled_from(["i2", "u1", "i4", "f4", "f8"]).flatmap(
    lambda code: hnp.arrays(
        code,
        hnp.array_shapes(min_dims=2, max_dims=2, min_side=2, max_side=9),
        elements=(
            st.floats(-1e6, 1e6, width=8 * np.dtype(code).itemsize, allow_subnormal=False)
            if code[0] == "f"
            else None
        ),
    )
)


@given(CELLS, st.data(), st.sampled_from([NORTH_UP, SOUTH_UP, ROTATED]))
def test_any_raster_with_any_holes_comes_back_bit_for_bit(values, data, transform):
    valid = data.draw(hnp.arrays(bool, values.shape))
    valid[:2, :2] = True
    dem = dem_of(values, transform, valid=valid)
    source, pyramid = source_with_corrections(dem)
    back = source.restore(pyramid.synthesise(), LocalFrame())
    assert back.values.tobytes() == values.tobytes()
    assert (back.valid == valid).all()


def test_holes_keep_whatever_they_held():
    values = hills(6, 6)
    values[1, 1], values[2, 2], values[3, 3] = np.nan, np.inf, -np.inf
    values[4, 4] = np.frombuffer(b"\x01\0\0\0\0\0\xf8\x7f")[0]  # another NaN
    dem = dem_of(values)
    source, pyramid = source_with_corrections(dem)
    assert source.restore(pyramid.synthesise(), LocalFrame()).values.tobytes() == values.tobytes()


@pytest.mark.parametrize("unit", ["metre", "foot", "us_survey_foot"])
def test_scale_offset_and_vertical_unit_are_undone(unit):
    stored = np.rint(hills() * 10).astype("i2")
    frame = LocalFrame(z_scale={"metre": 1.0, "foot": 0.3048}.get(unit, 1200 / 3937))
    dem = dem_of(stored, scale=0.1, offset=-7.0)
    mesh = dem_mesh(dem, frame)
    np.testing.assert_allclose(
        mesh.vertices[:, 2], (stored.ravel() * 0.1 - 7.0) * frame.z_scale, rtol=1e-14
    )
    source, pyramid = source_with_corrections(dem, frame)
    assert source.restore(pyramid.synthesise(), frame).values.tobytes() == stored.tobytes()


def test_an_altered_pyramid_gives_altered_cells_that_stay_data():
    values = np.rint(hills()).astype("i2")
    dem = dem_of(values, nodata=int(values[0, 0]) + 1)
    source, pyramid = source_with_corrections(dem)
    finest = pyramid.synthesise()
    raised = type(finest)(finest.vertices + np.array([0, 0, 1.0]), finest.faces)
    back = source.altered().restore(raised, LocalFrame())
    assert not source.altered().is_exact
    expected = values + 1
    expected[expected == dem.nodata] += 1  # never the nodata value by accident
    assert (back.values == expected).all()


@pytest.mark.parametrize("tag", [0.0, 300.0, -9999.0])
@pytest.mark.parametrize("dtype", ["f4", "f8"])
def test_altered_cells_near_the_nodata_value_stay_data_to_gdal(tmp_path, tag, dtype):
    """0 stayed 0 where that is nodata, and to GDAL the next few floats are the nodata value too."""
    source = RasterOrigin.from_dem(dem_of(hills().astype(dtype), nodata=tag)).altered()
    near = tag + np.array([0.0, 1e-9, -1e-7, 4e-7]) * tag
    mesh = dem_mesh(dem_of(np.resize(near, (40, 50))), LocalFrame())
    back = source.restore(mesh, LocalFrame())
    write_dem(tmp_path / "back.tif", back, None)
    with rasterio.open(tmp_path / "back.tif") as dataset:
        assert dataset.read_masks(1).all()
    assert np.abs(back.values - tag).max() <= 2e-6 * abs(tag) + 1e-40


def test_a_surface_that_comes_near_the_nodata_value_has_another():
    """To GDAL a cell of 300.00001 was nodata, as one of 300 is."""
    values = np.array([[300.00001, 310.0]])
    covered = np.ones((1, 2), dtype=bool)
    assert np.isnan(tag_without_clash(values, covered, 300.0))
    assert tag_without_clash(values, covered, 0.0) == 0.0
    assert tag_without_clash(values, covered, 300.001) == 300.001


@pytest.mark.parametrize("tag", [np.inf, -np.inf, -1.7976931348623157e308, -3.4028234663852886e38])
def test_no_elevation_is_near_a_nodata_value_beyond_all_measure(tag):
    values = np.array([-1e29, 0.0, 300.0, tag], dtype="f8")
    assert taken_for_nodata(values, tag).tolist() == [False, False, False, True]
    assert not taken_for_nodata(values[:3].astype("f4"), tag).any()


def test_another_mesh_is_no_original():
    dem = dem_of(hills())
    source, pyramid = source_with_corrections(dem)
    with pytest.raises(PyramidError, match="finest"):
        source.restore(pyramid.mesh(0), LocalFrame())
    finest = pyramid.synthesise()
    raised = type(finest)(finest.vertices + np.array([0, 0, 1.0]), finest.faces)
    with pytest.raises(PyramidError, match="bit for bit"):
        source.restore(raised, LocalFrame())


def test_nothing_but_nodata_is_refused():
    with pytest.raises(InputFileError, match="nodata"):
        dem_mesh(dem_of(np.full((4, 4), np.nan)), LocalFrame())


def parts_of(dem):
    source, _ = source_with_corrections(dem)
    return source.to_parts()


@pytest.mark.parametrize("nodata", [None, -9999, -9999.5, float("nan"), 2**62])
def test_parts_survive(nodata):
    fields, arrays = parts_of(dem_of(hills(), nodata=nodata))
    back = RasterOrigin.from_parts(fields, arrays)
    assert repr(back.nodata) == repr(nodata)
    assert back.geometry.transform == NORTH_UP


@pytest.mark.parametrize(
    "damage",
    [
        {"shape": [40]},
        {"shape": [0, 0]},
        {"shape": [1 << 40, 50]},
        {"shape": ["a", "b"]},
        {"transform": [1, 2]},
        {"transform": [0.0] * 6},
        {"transform": [1.0, 0.0, float("nan"), 0.0, 1.0, 0.0]},
        {"dtype": "O"},
        {"dtype": "i2"},  # not that of the holes
        {"nodata": "none of your business"},
        {"scale": 0.0},
        {"profile": 7},
        {"ledger": {}},
        {"ledger": {"dtype": "<f4", "quantum": 1.0}},
    ],
)
def test_damaged_fields_are_refused(damage):
    fields, arrays = parts_of(dem_of(hills()))
    with pytest.raises(PyramidError):
        RasterOrigin.from_parts(fields | damage, arrays)


@pytest.mark.parametrize(
    "damage",
    [
        {"source/valid": np.zeros(3, np.uint8)},
        {"source/valid": np.zeros(250, np.int32)},
        {"source/holes": np.zeros(5)},
        {"source/ledger/values": np.zeros((2, 2))},
    ],
)
def test_damaged_arrays_are_refused(damage):
    fields, arrays = parts_of(dem_of(hills()))
    with pytest.raises(PyramidError):
        RasterOrigin.from_parts(fields, arrays | damage)
    with pytest.raises(PyramidError, match="damaged"):
        RasterOrigin.from_parts(fields, {})
