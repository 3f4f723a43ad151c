"""Any pyramid that is written is read back equal: every option of the analysis, every source."""

import tempfile
from dataclasses import fields, replace
from pathlib import Path

import laspy
import numpy as np
from gis.samples import write_tif
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from pyproj import CRS

from wavelet_core import TriangleMesh, analyse
from wavelet_core.synthetic import hills
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid, write_pyramid
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.mesh_origin import MeshOrigin
from wavelet_gis.notes import Note
from wavelet_gis.workflows.open import open_terrain

#: Each example writes a file; compilation makes the first one slow.
SETTINGS = settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)

TEXTS = st.text(max_size=20)
FINITE = st.floats(-1e9, 1e9)
SCALES = st.floats(1e-9, 1e9)

OPTIONS = st.fixed_dictionaries(
    {
        "levels": st.integers(0, 4),
        "partition": st.sampled_from(["surface", "quadric", "colouring"]),
        "prediction": st.sampled_from(
            ["uniform", "cotangent", "geometric", "nnls", "least_squares", "barycentric"]
        ),
        "update": st.sampled_from(["none", "minimum_norm", "one_ring_mean"]),
        "signal": st.sampled_from(["z", "xyz"]),
    }
)

SYSTEMS = st.builds(
    CoordinateSystem,
    wkt=st.none() | TEXTS,
    name=TEXTS,
    kind=st.sampled_from(["geographic", "projected", "unknown"]),
    horizontal_unit=FINITE,
    vertical_unit=st.sampled_from([None, "metre", "foot", "us_survey_foot"]),
    semi_major=FINITE,
    inverse_flattening=FINITE,
)
FRAMES = st.builds(
    LocalFrame, x_origin=FINITE, y_origin=FINITE, x_scale=SCALES, y_scale=SCALES, z_scale=SCALES
)


def assert_equal(a, b, where="pyramid"):
    """Assert that two values are the same, arrays bit for bit, objects field by field."""
    if isinstance(a, np.ndarray):
        assert a.dtype.newbyteorder("<") == b.dtype.newbyteorder("<"), where
        assert a.shape == b.shape, where
        assert a.astype(b.dtype).tobytes() == b.tobytes(), where
    elif isinstance(a, np.dtype):
        assert a == b, where  # '<i2' and 'int16' are the same
    elif isinstance(a, Note):
        assert a.to_dict() == b.to_dict(), where
    elif hasattr(a, "__dataclass_fields__"):
        assert type(a) is type(b), where
        for field in fields(a):
            if field.name in ("measured", "coarse_faces"):  # of the analysis, to save work
                continue
            assert_equal(getattr(a, field.name), getattr(b, field.name), f"{where}.{field.name}")
    elif isinstance(a, dict):
        assert a.keys() == b.keys(), where
        for key in a:
            assert_equal(a[key], b[key], f"{where}[{key}]")
    elif isinstance(a, list | tuple):
        assert len(a) == len(b), where
        for k, (one, other) in enumerate(zip(a, b, strict=True)):
            assert_equal(one, other, f"{where}[{k}]")
    else:
        assert repr(a) == repr(b), where  # nodata may be NaN


def assert_read_back(geo):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.gpkg"
        write_pyramid(path, geo)
        # Where the input lay is nobody's business but the writer's.
        assert_equal(read_pyramid(path), replace(geo, source_name=Path(geo.source_name).name))


@SETTINGS
@given(
    shape=st.tuples(st.integers(2, 9), st.integers(2, 9)),
    options=OPTIONS,
    n_attributes=st.integers(0, 2),
    is_locked=st.booleans(),
    system=SYSTEMS,
    frame=FRAMES,
    texts=st.lists(TEXTS, max_size=3),
)
def test_tins(shape, options, n_attributes, is_locked, system, frame, texts):
    mesh = hills(*shape)
    rng = np.random.default_rng(sum(shape))
    names = ("a", "ß\n")[:n_attributes]
    attributes = rng.normal(size=(mesh.n_vertices, n_attributes))
    mesh = TriangleMesh(mesh.vertices, mesh.faces, attributes, names)
    locked = rng.random(mesh.n_vertices) < 0.3 if is_locked else None
    pyramid = analyse(mesh, locked=locked, **options)
    name = "".join(texts).replace("/", "")
    assert_read_back(
        GeoPyramid(pyramid, system, frame, "metre", MeshOrigin(), name, None, tuple(texts))
    )


@SETTINGS
@given(
    shape=st.tuples(st.integers(2, 12), st.integers(2, 12)),
    dtype=st.sampled_from(["u1", "i1", "i2", "u2", "i4", "u4", "f4", "f8"]),
    holes=st.floats(0, 0.5),
    levels=st.integers(0, 4),
    with_errors=st.booleans(),
    is_altered=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)
def test_rasters(shape, dtype, holes, levels, with_errors, is_altered, seed):
    rng = np.random.default_rng(seed)
    values = rng.integers(1, 100, shape).astype(dtype)
    values[rng.random(shape) < holes] = 0
    values[:2, :2] = 7  # some triangles
    with tempfile.TemporaryDirectory() as folder:
        terrain = open_terrain(write_tif(Path(folder) / "a.tif", values, nodata=0))
    pyramid = analyse(terrain.mesh, levels=levels)
    assume(all(step.n_odd for step in pyramid.steps))  # the partition's matter
    geo = terrain.geo_pyramid(pyramid)
    if is_altered:
        geo = geo.with_pyramid(pyramid.with_parts(coarse=pyramid.coarse + 1), "raised")
    assert_read_back(geo.with_errors() if with_errors else geo)


@SETTINGS
@given(
    n_points=st.integers(4, 60),
    version=st.sampled_from([("1.2", 0), ("1.2", 3), ("1.4", 6), ("1.4", 7)]),
    attributes=st.lists(
        st.sampled_from(["intensity", "classification", "gps_time"]), unique=True, max_size=2
    ),
    levels=st.integers(0, 3),
    seed=st.integers(0, 2**32 - 1),
)
def test_clouds(n_points, version, attributes, levels, seed):
    rng = np.random.default_rng(seed)
    header = laspy.LasHeader(version=version[0], point_format=version[1])
    header.scales, header.offsets = [0.01, 0.01, 0.001], [500000.0, 5100000.0, 100.0]
    header.add_crs(CRS.from_epsg(32632))
    las = laspy.LasData(header)
    corners = np.array([[0, 0], [20, 0], [0, 20], [20, 20]], float)
    xy = np.vstack([corners, rng.integers(0, 20, (n_points, 2))])  # many share x and y
    las.x, las.y = 500000.0 + xy[:, 0], 5100000.0 + xy[:, 1]
    las.z = 100 + rng.normal(0, 3, len(xy))
    las.intensity = rng.integers(0, 65536, len(xy))
    las.classification = rng.integers(1, 7, len(xy))
    names = [name for name in attributes if name in las.point_format.dimension_names]
    with tempfile.TemporaryDirectory() as folder:
        las.write(Path(folder) / "a.las")
        terrain = open_terrain(Path(folder) / "a.las", attributes=names)
    assert_read_back(terrain.geo_pyramid(analyse(terrain.mesh, levels=levels)))
