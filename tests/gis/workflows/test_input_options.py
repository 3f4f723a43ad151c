"""Options that an input has no use for are refused, whatever kind it is; points of one place."""

import numpy as np
import pytest
import shapely
from gis.samples import hills, write_las, write_tif

import wavelet_gis
from wavelet_core import TriangleMesh
from wavelet_gis.errors import InputFileError, PointCloudWarning, TerrainWarning

WGS = "EPSG:32632"


def _points(n_points=300):
    rng = np.random.default_rng(3)
    plan = rng.uniform(0, 100, (n_points, 2)) + np.array([500000.0, 5100000.0])
    return np.column_stack([plan, 300 + 5 * np.sin(plan[:, 0] / 20)])


@pytest.fixture
def table(tmp_path):
    """Return a table of scattered points."""
    path = tmp_path / "points.csv"
    np.savetxt(path, _points(), delimiter=",", header="x,y,z", comments="", fmt="%.3f")
    return path


@pytest.fixture
def layer(tmp_path):
    """Return a function that writes shapes as the one layer of a GeoPackage."""
    import pyogrio

    def write(shapes, kind):
        path = tmp_path / "layer.gpkg"
        pyogrio.raw.write(
            path,
            shapely.to_wkb(np.array(shapes, dtype=object)),
            [],
            [],
            geometry_type=kind,
            crs=WGS,
            layer="it",
        )
        return path

    return write


CLOUD_ONLY = [
    {"keep_noise": True},
    {"keep_withheld": True},
    {"duplicates": "highest"},
    {"max_edge": 5.0},
    {"concave": True},
    {"class_channels": True},
    {"classes": (2,)},
]


@pytest.mark.parametrize("option", CLOUD_ONLY, ids=lambda option: next(iter(option)))
def test_options_of_clouds_are_for_clouds(option, table, layer, tmp_path):
    shapes = shapely.points(_points())
    triangle = shapely.Polygon([(5e5, 0, 1), (5e5 + 9, 0, 2), (5e5, 9, 3)])
    for path, kind in (
        (table, "a table of points"),
        (layer(shapes, "Point Z"), "a layer of points"),
        (write_tif(tmp_path / "a.tif", hills()), "a raster"),
    ):
        with pytest.raises(InputFileError, match=f"this is {kind}, and .* for a point cloud"):
            wavelet_gis.open(path, **option)
    (tmp_path / "layer.gpkg").unlink()
    with pytest.raises(InputFileError, match="this is a layer of triangles"):
        wavelet_gis.open(layer([triangle], "Polygon Z"), **option)
    mesh = TriangleMesh.from_points(_points())
    with pytest.raises(InputFileError, match="this is a layer of triangles"):
        wavelet_gis.open(mesh, **option)


@pytest.mark.parametrize(
    ("option", "name"),
    [({"layer": "a"}, "layer"), ({"z_field": "h"}, "z_field")],
)
def test_options_of_layers_are_for_layers(option, name, table, tmp_path):
    for path in (
        table,
        write_tif(tmp_path / "a.tif", hills()),
        write_las(tmp_path / "a.las"),
    ):
        with pytest.raises(InputFileError, match=f"and {name} is for a layer of"):
            wavelet_gis.open(path, **option)


@pytest.mark.parametrize("option", [{"band": 1}, {"nodata": 0.0}])
def test_options_of_rasters_are_for_rasters(option, table, tmp_path):
    for path in (table, write_las(tmp_path / "a.las")):
        with pytest.raises(InputFileError, match="for a raster; leave it out"):
            wavelet_gis.open(path, **option)


@pytest.mark.filterwarnings("ignore:.*there is no CRS")
def test_points_of_one_place_in_a_table_count_in_the_error(tmp_path):
    """Fifty of them 12 m above: they are told of, and no error leaves them out."""
    points = _points()
    raised = points[:50] + np.array([0.0, 0.0, 12.0])
    path = tmp_path / "facade.csv"
    np.savetxt(path, np.concatenate([raised, points]), delimiter=",", fmt="%.3f")
    with pytest.warns(PointCloudWarning, match="50 points share x and y .* up to 12 off"):
        terrain = wavelet_gis.open(path)
    assert terrain.mesh.n_vertices == 300
    with pytest.warns(TerrainWarning, match="max_error 0.5 holds at the vertices"):
        tin = wavelet_gis.simplify(terrain, max_error=0.5)
    assert 12.0 <= tin.errors.max_error <= 12.5
    analysis = wavelet_gis.analyse(terrain, levels=2)
    assert all(level.max_error_surface >= 12.0 - 1e-6 for level in analysis.geo.errors)


@pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")
@pytest.mark.parametrize("rule", ["lowest", "highest", "mean", "first"])
def test_errors_of_levels_count_merged_points(rule, tmp_path):
    """Against an interpolation of all stored points that shares nothing with the package."""
    import laspy
    from matplotlib.tri import LinearTriInterpolator, Triangulation

    path = write_las(tmp_path / "a.las")
    analysis = wavelet_gis.analyse(wavelet_gis.open(path, duplicates=rule), levels=3)
    stored = laspy.read(path)
    for row in analysis.geo.errors:
        mesh = analysis.geo.file_mesh(analysis.geo.pyramid.mesh(row.level))
        x, y, z = (mesh.vertices - mesh.vertices.min(axis=0) * (1, 1, 0)).T
        surface = LinearTriInterpolator(Triangulation(x, y, mesh.faces), z)
        low = mesh.vertices.min(axis=0)
        found = surface(np.asarray(stored.x) - low[0], np.asarray(stored.y) - low[1])
        off = np.abs(np.ma.compressed(found - np.asarray(stored.z)))
        assert len(off) > 0.97 * len(stored.points)
        assert row.max_error_surface == pytest.approx(off.max(), rel=1e-6)


def test_a_table_that_is_no_text_is_not_called_a_raster(tmp_path):
    path = tmp_path / "random.csv"
    path.write_bytes(np.random.default_rng(1).bytes(2000))
    with pytest.raises(InputFileError, match="it is not text") as caught:
        wavelet_gis.open(path)
    assert "raster" not in str(caught.value)
