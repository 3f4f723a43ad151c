"""Point clouds in memory: what is stored of them, and damage to it."""

import numpy as np
import pytest

from wavelet_core import TriangleMesh, analyse
from wavelet_core.errors import MeshError, PyramidError
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.points.cloud import PointAttribute, PointCloud, cloud_bounds
from wavelet_gis.model.points.mesh import cloud_mesh
from wavelet_gis.model.points.origin import CloudOrigin


def cloud_of(integers, *attributes, scales=(0.01, 0.01, 0.01)):
    return PointCloud(
        integers=np.asarray(integers, np.int32),
        scales=np.array(scales),
        offsets=np.array([100.0, 200.0, 0.0]),
        attributes=tuple(
            PointAttribute(f"a{k}", f"a{k}", values) for k, values in enumerate(attributes)
        ),
        n_in_file=len(integers),
    )


@pytest.fixture
def cloud(rng):
    integers = rng.integers(-5000, 5000, (300, 3))
    integers[250:, :2] = integers[:50, :2]
    return cloud_of(integers, rng.integers(0, 9, 300).astype("u1"), rng.normal(size=300))


@pytest.fixture
def parts(cloud):
    mesh, source = cloud_mesh(cloud, LocalFrame())
    return source.with_corrections(
        cloud, analyse(mesh, levels=2).synthesise(), LocalFrame()
    ).to_parts()


def test_the_largest_integers_come_back(rng):
    limits = np.iinfo(np.int32)
    integers = rng.integers(limits.min, limits.max, (100, 3), endpoint=True, dtype=np.int64)
    integers[:2] = [[limits.min] * 3, [limits.max] * 3]
    cloud = cloud_of(integers, scales=(1e-7, 1e-7, 1e-7))
    mesh, source = cloud_mesh(cloud, LocalFrame())
    finest = analyse(mesh, levels=2).synthesise()
    back = source.with_corrections(cloud, finest, LocalFrame()).restore(finest, LocalFrame())
    assert (back.integers == cloud.integers).all()


def test_negative_scales_are_coordinates_too(rng):
    cloud = cloud_of(rng.integers(-5000, 5000, (100, 3)), scales=(-0.01, 0.01, -0.5))
    west, south, east, north = cloud_bounds(cloud)
    assert west < east
    assert south < north
    mesh, source = cloud_mesh(cloud, LocalFrame())
    back = source.with_corrections(cloud, mesh, LocalFrame()).restore(mesh, LocalFrame())
    assert (back.integers == cloud.integers).all()


def test_an_altered_pyramid_moves_duplicates_with_their_vertex(cloud):
    mesh, source = cloud_mesh(cloud, LocalFrame())
    source = source.with_corrections(cloud, mesh, LocalFrame()).altered()
    raised = TriangleMesh(
        mesh.vertices + np.array([0, 0, 3.0]), mesh.faces, mesh.attributes, mesh.attribute_names
    )
    back = source.restore(raised, LocalFrame())
    assert not source.is_exact
    assert (back.integers - cloud.integers == [0, 0, 300]).all()


def test_altered_attributes_stay_in_their_range(cloud):
    mesh, source = cloud_mesh(cloud, LocalFrame())
    wild = mesh.attributes + np.array([300.0, 0.0])
    altered = TriangleMesh(mesh.vertices, mesh.faces, wild, mesh.attribute_names)
    back = source.altered().restore(altered, LocalFrame())
    is_vertex = np.delete(np.arange(300), source.dropped)
    assert (back.attributes[0].values[is_vertex] == 255).all()
    unchanged = cloud.attributes[0].values[source.dropped]
    assert (back.attributes[0].values[source.dropped] == unchanged).all()


def test_another_mesh_is_no_original(cloud):
    mesh, source = cloud_mesh(cloud, LocalFrame())
    source = source.with_corrections(cloud, mesh, LocalFrame())
    raised = TriangleMesh(
        mesh.vertices + np.array([0, 0, 3.0]), mesh.faces, mesh.attributes, mesh.attribute_names
    )
    with pytest.raises(PyramidError, match="bit for bit"):
        source.restore(raised, LocalFrame())
    with pytest.raises(PyramidError, match="finest"):
        source.restore(TriangleMesh(mesh.vertices, mesh.faces), LocalFrame())


@pytest.mark.parametrize(
    "integers",
    [
        [[0, 0, 0], [5, 5, 1], [10, 10, 2], [15, 15, 9]],  # on a line
        [[0, 0, 0], [0, 0, 1], [0, 0, 2], [7, 7, 7]],  # two places only
    ],
)
def test_points_without_a_surface(integers):
    with pytest.raises(MeshError):
        cloud_mesh(cloud_of(integers), LocalFrame())


def test_an_attribute_that_is_no_number(rng):
    values = np.full(50, np.nan)
    cloud = cloud_of(rng.integers(0, 999, (50, 3)), values)
    with pytest.raises(InputFileError, match="a0"):
        cloud_mesh(cloud, LocalFrame())


def test_parts_survive(parts):
    source = CloudOrigin.from_parts(*parts)
    assert source.n_points == 300
    assert source.n_vertices == 250
    assert [a.name for a in source.cloud.attributes] == ["a0", "a1"]


@pytest.mark.parametrize(
    "damage",
    [
        {"n_points": 3},
        {"n_points": -1},
        {"n_points": "many"},
        {"scales": [1.0]},
        {"scales": [0.0, 1.0, 1.0]},
        {"offsets": [0.0, float("inf"), 0.0]},
        {"attributes": []},
        {"attributes": 5},
        {"attributes": [{"name": "a"}]},
        {"carried": ["intensity"]},
        {"classes": "ground"},
        {"ledger": []},
        {"ledger": None},
    ],
)
def test_damaged_fields_are_refused(parts, damage):
    fields, arrays = parts
    with pytest.raises(PyramidError):
        CloudOrigin.from_parts(fields | damage, arrays)


@pytest.mark.parametrize(
    "damage",
    [
        {"source/dropped": np.arange(50, dtype=np.int64) + 290},
        {"source/dropped": np.zeros(50, dtype=np.int64)},
        {"source/dropped": np.arange(50, dtype=np.float64)},
        {"source/representative": np.full(50, 250, dtype=np.int64)},
        {"source/representative": np.full(50, -1, dtype=np.int64)},
        {"source/differences": np.zeros((50, 2), dtype=np.int64)},
        {"source/dropped_attribute_0": np.zeros(50)},
        {"source/header": np.zeros((2, 2), np.uint8)},
        {"source/evlrs": np.zeros(3)},
    ],
)
def test_damaged_arrays_are_refused(parts, damage):
    fields, arrays = parts
    with pytest.raises(PyramidError):
        CloudOrigin.from_parts(fields, arrays | damage)
    with pytest.raises(PyramidError):
        CloudOrigin.from_parts(fields, {})
