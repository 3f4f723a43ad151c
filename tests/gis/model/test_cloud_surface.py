"""Which points of a cloud make the surface, and what is said of the others."""

import re

import numpy as np
import pytest
from gis.io.las.test_las_round_trip import las_bytes, through_a_file
from gis.samples import write_las
from hypothesis import given
from hypothesis import strategies as st

from wavelet_core import OptionError, TriangleMesh, analyse
from wavelet_core.mesh.location import surface_errors
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.errors import CrsError, InputFileError, PointCloudWarning
from wavelet_gis.io.las import read_cloud, write_cloud
from wavelet_gis.model.points.cloud import PointAttribute, PointCloud
from wavelet_gis.model.points.mesh import cloud_mesh
from wavelet_gis.model.points.origin import CloudOrigin
from wavelet_gis.model.terrain import terrain_of_cloud
from wavelet_gis.products.level_raster import surface_dem
from wavelet_gis.workflows.open import open_terrain

RULES = ["lowest", "highest", "mean", "first"]


def cloud_of(integers, aside=None, values=None):
    return PointCloud(
        integers=np.asarray(integers, np.int32),
        scales=np.array([0.01, 0.01, 0.01]),
        offsets=np.array([100.0, 200.0, 0.0]),
        attributes=() if values is None else (PointAttribute("a", "a", np.asarray(values)),),
        n_in_file=len(integers),
        aside=aside,
    )


@st.composite
def clouds(draw):
    """Return points, most of them at few places, some set aside."""
    seed = draw(st.integers(0, 10_000))
    n_places = draw(st.integers(3, 30))
    rng = np.random.default_rng(seed)
    places = rng.integers(-3000, 3000, (n_places, 2))
    places[:3] = [[0, 0], [3000, 0], [0, 3000]]
    which = np.concatenate([np.arange(n_places), rng.integers(0, n_places, 40)])
    rng.shuffle(which)
    integers = np.column_stack([places[which], rng.integers(-500, 500, len(which))])
    aside = np.zeros(len(which), bool)
    repeated = np.flatnonzero(np.bincount(which)[which] > 1)
    aside[rng.permutation(repeated)[: draw(st.integers(0, 5))]] = True
    lost = np.setdiff1d(np.arange(n_places), which[~aside])
    aside[np.isin(which, lost)] = False
    return cloud_of(integers, aside if aside.any() else None, rng.normal(size=len(which)))


@pytest.mark.filterwarnings("ignore::wavelet_gis.errors.PointCloudWarning")
@given(cloud=clouds(), rule=st.sampled_from(RULES))
def test_any_duplicates_come_back_and_count_in_the_errors(cloud, rule):
    mesh, source = cloud_mesh(cloud, LocalFrame(), duplicates=rule)
    finest = analyse(mesh, levels=2).synthesise()
    source = source.with_corrections(cloud, finest, LocalFrame())
    source = CloudOrigin.from_parts(*source.to_parts())
    back = source.restore(finest, LocalFrame())
    assert (back.integers == cloud.integers).all()
    assert (back.attributes[0].values == cloud.attributes[0].values).all()

    used = np.ones(cloud.n_points, bool) if cloud.aside is None else ~cloud.aside
    coordinates = cloud.coordinates()[used]
    counted = source.points_for_errors(mesh, LocalFrame())
    places = [np.rint(points * 100).astype(int) for points in (counted, coordinates)]
    assert sorted(map(tuple, places[0])) == sorted(map(tuple, places[1]))

    # the height of each vertex, worked out place by place
    plan = cloud.integers[used, :2]
    z = cloud.integers[used, 2] * 0.01
    pick = {"lowest": min, "highest": max, "first": lambda v: v[0], "mean": np.mean}[rule]
    expected = {
        tuple(place): pick(z[(plan == place).all(axis=1)]) for place in np.unique(plan, axis=0)
    }
    assert mesh.n_vertices == len(expected)
    for x, y, height in mesh.vertices:
        place = round((x - 100) * 100), round((y - 200) * 100)
        assert height == pytest.approx(expected[place], abs=0.0051)
    apart = np.abs(surface_errors(mesh, coordinates))
    merged = source.merged_heights()
    assert merged.largest == pytest.approx(np.nanmax(apart), abs=1e-6)
    assert merged.n_points == used.sum() - mesh.n_vertices


@pytest.mark.parametrize("rule", RULES)
def test_merging_is_told_with_its_error(rule):
    points = [[0, 0, 0], [900, 0, 0], [0, 900, 0], [900, 900, 0], [0, 0, 1200], [0, 0, 600]]
    words = rf"2 points share x and y with others; the {rule} of each place .* off"
    with pytest.warns(PointCloudWarning, match=words) as told:
        cloud_mesh(cloud_of(points), LocalFrame(), duplicates=rule, name="here.las")
    largest = {"lowest": 12.0, "highest": 12.0, "mean": 6.0, "first": 12.0}[rule]
    text = str(told[0].message)
    assert text.startswith("here.las: ")
    assert float(re.search(r"up to ([\d.]+) off", text)[1]) == largest


def test_a_rule_that_no_table_holds():
    with pytest.raises(OptionError, match="lowest, highest, mean, first"):
        cloud_mesh(cloud_of([[0, 0, 0], [9, 0, 0], [0, 9, 0]]), LocalFrame(), duplicates="any")


def test_points_set_aside_stay_where_they_are_when_the_surface_moves():
    aside = np.array([False] * 4 + [True])
    cloud = cloud_of([[0, 0, 0], [900, 0, 0], [0, 900, 0], [900, 900, 0], [5, 5, -9000]], aside)
    mesh, source = cloud_mesh(cloud, LocalFrame())
    raised = TriangleMesh(mesh.vertices + np.array([0, 0, 1.0]), mesh.faces)
    back = source.altered().restore(raised, LocalFrame())
    assert back.integers[:, 2].tolist() == [100, 100, 100, 100, -9000]
    assert back.is_altered


@pytest.mark.parametrize(
    "damage",
    [
        {"source/aside": np.array([4, 5])},
        {"source/aside": np.array([-1])},
        {"source/aside": np.array([4.0])},
        {"source/aside_0": np.zeros(1)},
        {"source/aside_2": np.zeros(2, np.int32)},
        {"source/shifts": np.array([[0, 1, 2]])},
        {"source/shifts": np.array([[9, 1]])},
        {"source/shifts": np.array([[0.0, 1.0]])},
    ],
)
def test_damaged_descriptions_are_refused(damage):
    from wavelet_core.errors import PyramidError

    aside = np.array([False] * 4 + [True])
    cloud = cloud_of([[0, 0, 0], [900, 0, 0], [0, 900, 0], [900, 900, 0], [5, 5, -9000]], aside)
    mesh, source = cloud_mesh(cloud, LocalFrame())
    fields, arrays = source.with_corrections(cloud, mesh, LocalFrame()).to_parts()
    assert CloudOrigin.from_parts(fields, arrays).n_vertices == 4
    with pytest.raises(PyramidError):
        CloudOrigin.from_parts(fields, {**arrays, **damage})


def test_pyramids_of_before_are_read():
    """They know nothing of points set aside, rules, spacings and offsets."""
    cloud = cloud_of([[0, 0, 0], [900, 0, 0], [0, 900, 0], [900, 900, 0], [0, 0, 7]])
    mesh, source = cloud_mesh(cloud, LocalFrame())
    fields, arrays = source.with_corrections(cloud, mesh, LocalFrame()).to_parts()
    for key in ("duplicates", "spacing", "evlrs_at"):
        del fields[key]
    back = CloudOrigin.from_parts(fields, arrays).restore(mesh, LocalFrame())
    assert (back.integers == cloud.integers).all()


# --- noise and withheld points -------------------------------------------------------------------


def las_with(tmp_path, point_format, *, withheld=(), classes=()):
    """Return a file some of whose points are withheld or of a class."""
    minor = 4 if point_format >= 6 else 2
    content = bytearray(las_bytes(minor, point_format, n=100))
    start = len(content) - 100 * (len(content) - {4: 375, 2: 227}[minor]) // 100
    records = np.frombuffer(content, np.uint8)[start:].reshape(100, -1).copy()
    flag, number = ((15, 4), 16) if point_format >= 6 else ((15, 0x80), 15)
    for rows in withheld:
        records[rows, flag[0]] |= flag[1]
    for rows, value in classes:
        records[rows, number] = records[rows, number] & (0 if number == 16 else 0xE0) | value
    content[start:] = records.tobytes()
    path = tmp_path / "a.las"
    path.write_bytes(content)
    return path


@pytest.mark.filterwarnings("ignore:.*there is no CRS")
@pytest.mark.parametrize("point_format", [1, 3, 6, 7])
def test_noise_and_withheld_points_are_carried_and_come_back(tmp_path, point_format):
    path = las_with(
        tmp_path, point_format, withheld=[slice(20, 23)], classes=[(slice(22, 27), 7), (30, 18)]
    )
    with pytest.warns(PointCloudWarning, match=r"8 of 100 .*3 with the withheld .* 5 of the noise"):
        cloud, _ = read_cloud(path)
    assert np.flatnonzero(cloud.aside).tolist() == [*range(20, 27), 30]
    with pytest.warns(PointCloudWarning):
        geo = through_a_file(path, tmp_path)
    write_cloud(tmp_path / "b.las", geo.restore())
    assert (tmp_path / "b.las").read_bytes() == path.read_bytes()
    kept, _ = read_cloud(path, keep_noise=True, keep_withheld=True)
    assert kept.aside is None


def test_a_class_asked_for_is_kept(tmp_path):
    path = las_with(tmp_path, 6, classes=[(slice(0, 40), 7)])
    cloud, _ = read_cloud(path, classes=[7])
    assert cloud.aside is None
    assert cloud.n_points == 40


def test_nothing_but_noise_is_refused_with_the_way_out(tmp_path):
    path = las_with(tmp_path, 6, classes=[(slice(0, 100), 18)])
    with pytest.raises(InputFileError, match=r"all points .* keep them with keep_noise"):
        read_cloud(path)


@pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")
def test_noise_does_not_place_the_working_frame(tmp_path):
    """A stray point half a world away, in degrees, must not decide the metres of a degree."""
    import laspy

    path = write_las(tmp_path / "a.las", crs="EPSG:4326", degrees=True)
    las = laspy.read(path)
    las.X[7], las.Y[7] = 1_000_000_000, -900_000_000
    las.classification[7] = 7
    las.write(path)
    assert open_terrain(path).frame.y_origin == pytest.approx(46.0005, abs=0.001)


# --- gaps ----------------------------------------------------------------------------------------


def two_fields(n=600):
    """Return points of two fields 100 m wide, 300 m apart."""
    rng = np.random.default_rng(5)
    x = rng.uniform(0, 10_000, n) + np.where(np.arange(n) % 2, 40_000, 0)
    return cloud_of(np.column_stack([x, rng.uniform(0, 10_000, n), rng.uniform(0, 99, n)]))


def test_a_gap_is_told_of_and_left_out_when_asked():
    cloud = two_fields()
    with pytest.warns(PointCloudWarning, match=r"gaps .* take 6\d% .* max_edge auto"):
        closed = terrain_of_cloud("a", cloud, projected())
    with pytest.warns(PointCloudWarning, match=r"triangles have an edge longer than"):
        opened = terrain_of_cloud("a", cloud, projected(), max_edge="auto")
    with pytest.warns(PointCloudWarning, match=r"triangles have an edge longer than"):
        concave = terrain_of_cloud("a", cloud, projected(), concave=True)
    assert opened.mesh.n_vertices == closed.mesh.n_vertices == 600
    assert opened.mesh.n_faces < closed.mesh.n_faces
    assert concave.mesh.n_faces >= opened.mesh.n_faces
    middle = np.array([[350.0, 250.0, 0.0]])
    assert np.isfinite(surface_errors(closed.mesh, middle)).all()
    for terrain in (opened, concave):
        assert np.isnan(surface_errors(terrain.mesh, middle)).all()
        pyramid = analyse(terrain.mesh, target_vertices=100)
        assert np.isnan(surface_errors(pyramid.mesh(0), middle)).all()
        geo = terrain.geo_pyramid(pyramid)
        assert (geo.restore().integers == cloud.integers).all()


def test_the_cells_of_a_raster_come_from_the_points():
    """Not from the hull, of which the points fill 40 %: spacing 100 x 100 / 300 points a field."""
    cloud = two_fields()
    with pytest.warns(PointCloudWarning):
        terrain = terrain_of_cloud("a", cloud, projected(), max_edge="auto")
    geo = terrain.geo_pyramid(analyse(terrain.mesh, target_vertices=60))
    for mesh in (geo.pyramid.mesh(0), geo.pyramid.synthesise()):
        dem = surface_dem(geo, mesh)
        assert dem.geometry.transform[0] == pytest.approx(np.sqrt(10_000 / 300), rel=0.1)


def projected():
    return CoordinateSystem(wkt="PROJCRS[]", kind="projected", vertical_unit="metre")


# --- earth-centred coordinates -------------------------------------------------------------------


@pytest.mark.parametrize("code", ["EPSG:4978", "EPSG:4936"])
def test_geocentric_coordinates_are_refused_with_a_way_out(code):
    from wavelet_gis.crs.lookup import coordinate_system

    rng = np.random.default_rng(2)
    cloud = PointCloud(
        integers=rng.integers(-9000, 9000, (50, 3)).astype(np.int32),
        scales=np.full(3, 0.01),
        offsets=np.array([4_150_000.0, 670_000.0, 4_780_000.0]),
        n_in_file=50,
    )
    with pytest.raises(CrsError, match=r"geocentric.*reproject"):
        terrain_of_cloud("a.las", cloud, coordinate_system(code))
