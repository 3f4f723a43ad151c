"""A TIN on a grid, against planes and against the core's own point location."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wavelet_core import TriangleMesh
from wavelet_core.mesh.location import surface_errors
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.dem import GridGeometry
from wavelet_gis.products import rasterise as module
from wavelet_gis.products.rasterise import geometry_over, rasterise


def grid_points(geometry):
    rows, columns = np.indices(geometry.shape)
    return geometry.centres(columns.ravel(), rows.ravel())


def second_opinion(mesh, geometry):
    x, y = grid_points(geometry)
    return -surface_errors(mesh, np.column_stack([x, y, np.zeros(len(x))])).reshape(geometry.shape)


@given(st.integers(0, 10_000), st.integers(4, 60), st.floats(-3.1, 3.1))
def test_it_agrees_with_point_location(seed, n, angle):
    rng = np.random.default_rng(seed)
    mesh = TriangleMesh.from_points(
        np.column_stack([rng.uniform(0, 30, (n, 2)), rng.normal(size=n)])
    )
    cosine, sine = np.cos(angle), np.sin(angle)
    geometry = GridGeometry((37, 41), (cosine, -sine, -5.0, sine, cosine, -4.0))
    ours, theirs = rasterise(mesh, geometry), second_opinion(mesh, geometry)
    on_outline = np.isnan(ours) != np.isnan(theirs)
    assert on_outline.sum() <= 1  # a centre on the outline to the last bit
    both = ~np.isnan(ours) & ~np.isnan(theirs)
    np.testing.assert_allclose(ours[both], theirs[both], atol=1e-6)


def test_a_plane_is_reproduced_and_its_outside_left_out():
    corners = np.array([[0, 0, 0], [10, 0, 10], [10, 10, 30], [0, 10, 20.0]])
    mesh = TriangleMesh(corners, [[0, 1, 2], [0, 2, 3]])
    geometry = GridGeometry((14, 14), (1.0, 0.0, -2.0, 0.0, -1.0, 12.0))
    grid = rasterise(mesh, geometry)
    x, y = (values.reshape(14, 14) for values in grid_points(geometry))
    inside = (x > 0) & (x < 10) & (y > 0) & (y < 10)
    assert (np.isfinite(grid) == inside).all()
    np.testing.assert_allclose(grid[inside], (x + 2 * y)[inside], atol=1e-12)


def test_slivers_across_the_whole_grid_cost_what_they_cover():
    n = 2000
    t = np.linspace(0, 2000, n)
    upper, lower = np.column_stack([t, t + 1e-3, t]), np.column_stack([t, t - 1e-3, t])
    vertices = np.vstack([upper, lower])
    k = np.arange(n - 1)
    faces = np.vstack(
        [np.column_stack([k + n, k + 1, k]), np.column_stack([k + n, k + n + 1, k + 1])]
    )
    long = [[0, 2000, 5], [2000, 0, 5], [2000, 1e-3, 5]]
    mesh = TriangleMesh.from_triangles(
        np.vstack([vertices, long]), np.vstack([faces, [[2 * n, 2 * n + 1, 2 * n + 2]]])
    )
    grid = rasterise(mesh, GridGeometry((2000, 2000), (1.0, 0, 0, 0, 1.0, 0)))
    assert np.isfinite(np.diagonal(grid)).all()


def test_batches_change_nothing(monkeypatch, rng):
    points = np.column_stack([rng.uniform(0, 50, (200, 2)), rng.normal(size=200)])
    mesh, geometry = TriangleMesh.from_points(points), GridGeometry((50, 50), (1, 0, 0, 0, 1, 0))
    whole = rasterise(mesh, geometry)
    monkeypatch.setattr(module, "_CELLS_AT_ONCE", 11)
    assert rasterise(mesh, geometry).tobytes() == whole.tobytes()


def test_other_values_than_z():
    mesh = TriangleMesh([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    grid = rasterise(mesh, GridGeometry((2, 2), (2, 0, 0, 0, 2, 0)), np.array([1.0, 5.0, 9.0]))
    assert grid[0, 0] == pytest.approx(1 + 0.25 * 4 + 0.25 * 8)


def test_a_grid_over_bounds():
    geometry = geometry_over((10.0, 20.0, 35.0, 29.9), 10.0)
    assert geometry.shape == (1, 3)
    assert geometry.transform == (10.0, 0.0, 10.0, 0.0, -10.0, 29.9)
    for size in (0.0, -1.0, float("nan")):
        with pytest.raises(InputFileError, match="length"):
            geometry_over((0, 0, 1, 1), size)
    with pytest.raises(InputFileError, match="larger"):
        geometry_over((0, 0, 1, 1), 1e-9)
