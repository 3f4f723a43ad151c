"""Lines without heights lie on the terrain at all of their points."""

import numpy as np
import pytest

from wavelet_core import TriangleMesh
from wavelet_core.mesh.location import surface_errors
from wavelet_gis.model.drape import drape


@pytest.fixture(scope="module")
def hills():
    """Return a TIN of 400 points in uneven distances over some relief."""
    generator = np.random.default_rng(3)
    plan = generator.uniform(0, 100, (400, 2)) ** 1.3
    z = 20 * np.sin(plan[:, 0] / 40) * np.cos(plan[:, 1] / 55)
    return TriangleMesh.from_points(np.column_stack([plan, z]))


def samples_of(line, n=2000):
    """Return points at equal distances along a line in space."""
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(line[:, :2], axis=0).T))])
    at = np.linspace(0, along[-1], n)
    return np.column_stack([np.interp(at, along, column) for column in line.T])


CORNERS = np.array([[30.0, 40.0, np.nan], [310.0, 120.0, np.nan], [120.0, 330.0, np.nan]])


@pytest.mark.parametrize("tolerance", [0.0, 0.1, 2.0])
def test_a_line_is_within_the_tolerance_at_all_of_its_points(hills, tolerance):
    (line,), _ = drape([CORNERS], hills, tolerance)
    distance = surface_errors(hills, samples_of(line))
    assert np.abs(distance).max() <= tolerance + 1e-9


def test_a_larger_tolerance_needs_fewer_vertices(hills):
    sizes = [len(drape([CORNERS], hills, t).lines[0]) for t in (0.0, 0.1, 2.0, 1000.0)]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-1] == 3
    assert sizes[0] > 30


def test_the_profile_is_the_terrain_however_much_the_line_is_thinned(hills):
    (line,), profile = drape([CORNERS], hills, 1000.0)
    assert len(line) == 3
    assert np.abs(surface_errors(hills, profile)).max() < 1e-9
    assert len(profile) > 30


def test_corners_in_plan_stay_where_they_are(hills):
    (line,), _ = drape([CORNERS], hills, 0.1)
    for corner in CORNERS[:, :2]:
        assert (line[:, :2] == corner).all(axis=1).any()


def test_heights_that_are_known_stay(hills):
    known = np.array([[30.0, 40.0, 500.0], [310.0, 120.0, 400.0], [120.0, 330.0, np.nan]])
    (line,), _ = drape([known], hills, 0.1)
    assert line[:2].tolist() == known[:2].tolist()
    assert len(line) > 3
    of_its_own = np.array([[0.0, 0, 7], [9, 9, 8]])
    assert drape([of_its_own], hills, 0.1).lines[0].tolist() == of_its_own.tolist()


def test_along_the_edges_of_a_grid_each_vertex_counts():
    z = np.array([[0.0, 1, 0, 3], [0, 0, 0, 0], [5, 0, 5, 0]])
    mesh = TriangleMesh.from_grid(z, np.arange(4.0), -np.arange(3.0))
    x, y = mesh.vertices[:, 0], mesh.vertices[:, 1]
    row = np.flatnonzero(y == y[0])
    ends = mesh.vertices[row[[x[row].argmin(), x[row].argmax()]]].copy()
    heights = mesh.vertices[row[np.argsort(x[row])], 2]
    ends[:, 2] = np.nan
    (line,), _ = drape([ends], mesh, 0.0)
    assert line[:, 2].tolist() == heights.tolist()


def test_a_corner_beyond_the_terrain_has_the_height_of_the_nearest_vertex(hills):
    far = np.array([[-50.0, -50.0, np.nan], [30.0, 40.0, np.nan]])
    (line,), _ = drape([far], hills, 0.1)
    nearest = np.hypot(*(hills.vertices[:, :2] + 50).T).argmin()
    assert line[0, 2] == hills.vertices[nearest, 2]
    assert np.isfinite(line).all()


def test_one_short_edge_does_not_cut_a_long_line_into_steps_of_its_length():
    """Two points a nanometre apart, and ten kilometres of line asked for 95 TiB."""
    corners = [
        [0, 0, 0],
        [1e4, 0, 1],
        [1e4, 1e4, 2],
        [0, 1e4, 3],
        [5e3, 5e3, 4],
        [5e3 + 1e-9, 5e3, 4],
    ]
    mesh = TriangleMesh.from_points(np.array(corners))
    draped = drape([np.array([[10, 20, np.nan], [9e3, 9.5e3, np.nan]])], mesh, 0.0)
    assert 3 <= len(draped.profile) <= 6
    assert np.abs(surface_errors(mesh, draped.profile)).max() < 1e-9
