"""Points of a cloud that carry its surface, and how far all others are from their triangles."""

import laspy
import numpy as np
import pytest
from gis.samples import write_las, write_tif

import wavelet_gis as wg
from wavelet_core import Cancelled, OptionError, TriangleMesh
from wavelet_core.metrics import surface_errors
from wavelet_gis.io.las import write_cloud

pytestmark = pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")


@pytest.fixture
def terrain(tmp_path):
    return wg.open(write_las(tmp_path / "cloud.las", 1500))


def delaunay_errors(cloud, terrain):
    """Return how far each vertex of the terrain is from the thinned points' own triangles."""
    places = terrain.frame.to_local(cloud.coordinates())
    return surface_errors(TriangleMesh.from_points(places), terrain.mesh.vertices)


def test_they_are_the_vertices_of_the_tin_with_all_that_the_points_had(terrain, tmp_path):
    tin = wg.simplify(terrain, vertices=120)
    cloud, errors = tin.thinned()
    assert cloud.n_points == 120
    write_cloud(tmp_path / "thin.las", cloud)
    before, after = laspy.read(tmp_path / "cloud.las"), laspy.read(tmp_path / "thin.las")
    stored = {tuple(point.tolist()) for point in before.points.array}
    assert {tuple(point.tolist()) for point in after.points.array} <= stored
    rows = {tuple(row) for row in terrain.original.coordinates().tolist()}
    assert {tuple(row) for row in cloud.coordinates().tolist()} <= rows
    assert errors.rmse > 0


def test_a_tolerance_holds_on_the_triangles_of_whoever_triangulates_them(terrain):
    tin = wg.simplify(terrain, max_error=1.0)
    cloud, errors = tin.thinned(max_error=1.0)
    off = delaunay_errors(cloud, terrain)
    assert np.nanmax(np.abs(off)) <= 1.0 + 1e-9
    assert errors.max_error > 1.0, "those that share x and y with another point count too"
    assert cloud.n_points < terrain.mesh.n_vertices


def test_a_tolerance_by_vertex_is_kept_at_each(terrain):
    tin = wg.simplify(terrain, vertices=60)
    limits = np.where(terrain.mesh.vertices[:, 0] > terrain.mesh.vertices[:, 0].mean(), 0.5, 5.0)
    cloud, _ = tin.thinned(max_error=limits)
    off = np.abs(delaunay_errors(cloud, terrain))
    assert (off[np.isfinite(off)] <= limits[np.isfinite(off)] + 1e-9).all()


def test_it_can_be_stopped(terrain):
    tin = wg.simplify(terrain, vertices=60)
    with pytest.raises(Cancelled):
        tin.thinned(max_error=0.1, progress=lambda fraction: False)


def test_a_dem_has_no_points_to_thin(tmp_path):
    z = np.random.default_rng(0).random((20, 30)).astype("f4")
    tin = wg.simplify(wg.open(write_tif(tmp_path / "dem.tif", z)), vertices=50)
    with pytest.raises(OptionError, match="no point cloud"):
        tin.thinned()


def test_mean_heights_are_of_no_point(tmp_path):
    path = write_las(tmp_path / "cloud.las", 800)
    tin = wg.simplify(wg.open(path, duplicates="mean"), vertices=50)
    with pytest.raises(OptionError, match="heights that no point has"):
        tin.thinned()
