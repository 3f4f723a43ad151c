"""Errors between surfaces, where the answer is known."""

import numpy as np
import pytest
from helpers import columns_of
from helpers_meshes import grid_with_holes, random_delaunay

from wavelet_core import TriangleMesh, analyse, synthetic
from wavelet_core.accuracy.level_errors import level_errors
from wavelet_core.mesh.location import surface_errors


def test_points_on_the_surface_have_no_error():
    mesh = random_delaunay(100, seed=1, offset=1e6)
    np.testing.assert_allclose(surface_errors(mesh, mesh.vertices), 0, atol=1e-8)
    centres = mesh.vertices[mesh.faces].mean(axis=1)
    np.testing.assert_allclose(surface_errors(mesh, centres), 0, atol=1e-8)


def test_the_error_is_point_minus_surface_along_z():
    mesh = synthetic.plane(slope=(0.5, 0.25))
    points = np.array([[1.3, 2.4, 0.0], [0.0, 0.0, 5.0], [14.0, 11.0, 0.0]])
    expected = points[:, 2] - (5 + 0.5 * points[:, 0] + 0.25 * points[:, 1])
    np.testing.assert_allclose(surface_errors(mesh, points), expected, atol=1e-12)


def test_points_outside_and_over_holes_have_none():
    mesh = TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    points = np.array([[0.2, 0.2, 7.0], [0.8, 0.8, 7.0], [-1e-3, 0.5, 7.0], [50.0, 0.1, 7.0]])
    errors = surface_errors(mesh, points)
    np.testing.assert_array_equal(np.isnan(errors), [False, True, True, True])
    assert errors[0] == 7.0


@pytest.mark.parametrize("seed", range(3))
def test_every_point_agrees_with_a_search_through_all_faces(seed):
    rng = np.random.default_rng(seed)
    mesh = random_delaunay(40, seed=seed)
    points = np.column_stack([rng.random((300, 2)) * 1.2 - 0.1, rng.random(300)])
    errors = surface_errors(mesh, points)
    for point, error in zip(points, errors, strict=True):
        expected = np.nan
        for a, b, c in mesh.vertices[mesh.faces]:
            weights = np.linalg.solve(
                np.vstack([np.column_stack([a, b, c])[:2], np.ones(3)]), [*point[:2], 1.0]
            )
            if weights.min() >= 0:
                expected = point[2] - weights @ [a[2], b[2], c[2]]
        assert error == pytest.approx(expected, abs=1e-9, nan_ok=True)


def test_a_vertex_without_a_face_is_surface_at_its_own_place():
    """Single cells among holes were left out of the errors of the levels."""
    values = np.full((6, 7), np.nan)
    values[:3, :3] = np.arange(9.0).reshape(3, 3) ** 2
    values[5, 1], values[4, 5], values[5, 6] = 40.0, 50.0, 60.0
    mesh = TriangleMesh.from_grid(values, x=np.arange(7.0), y=-np.arange(6.0))
    points = np.vstack([mesh.vertices, mesh.vertices[-3:] + np.array([0.0, 0.0, 3.0])])
    errors = surface_errors(mesh, points)
    assert np.abs(errors[:-3]).max() < 1e-12
    assert errors[-3:].tolist() == [3.0, 3.0, 3.0]
    for row in level_errors(analyse(mesh)):
        assert row.n_uncovered == 0


def test_no_faces_and_no_points():
    lonely = TriangleMesh([[0, 0, 0], [1, 1, 1]], np.empty((0, 3), dtype=int))
    beside = lonely.vertices + np.array([0.0, 0.5, 0.0])
    assert np.isnan(surface_errors(lonely, beside)).all()
    assert len(surface_errors(synthetic.plane(), np.empty((0, 3)))) == 0


@pytest.mark.parametrize("signal", ["z", "xyz"])
def test_level_errors(signal):
    mesh = random_delaunay(300, n_attributes=2, seed=2)
    pyramid = analyse(mesh, levels=5, partition="quadric", prediction="GLMN", signal=signal)
    rows = level_errors(pyramid)
    assert [row.level for row in rows] == [0, 1, 2, 3, 4, 5]
    assert rows[-1].rmse_coefficients == 0
    assert rows[-1].rmse_surface == pytest.approx(0, abs=1e-12)
    names = ("x", "y", "z", *mesh.attribute_names)
    wanted = columns_of(mesh, names)
    for row in rows:
        level_mesh = pyramid.mesh(row.level)
        assert (row.n_vertices, row.n_faces) == (level_mesh.n_vertices, level_mesh.n_faces)
        moved = columns_of(level_mesh, names) - wanted[pyramid.vertex_ids(row.level)]
        moved /= np.ptp(wanted, axis=0)
        assert row.rmse_coefficients == pytest.approx(np.sqrt((moved**2).sum() / len(moved)))
        errors = surface_errors(level_mesh, mesh.vertices)
        assert row.n_uncovered == np.isnan(errors).sum()
        assert row.max_error_surface == pytest.approx(np.nanmax(np.abs(errors)), abs=1e-12)
        assert row.rmse_surface == pytest.approx(np.sqrt(np.nanmean(errors**2)), abs=1e-12)


def test_with_signal_z_every_input_point_stays_covered():
    mesh = grid_with_holes(20, 20, seed=1, hole_share=0.1)
    isolated = mesh.n_vertices - len(np.unique(mesh.faces))
    for row in level_errors(analyse(mesh, levels=12, partition="quadric", signal="z")):
        assert row.n_uncovered == isolated


def test_plain_subsampling_has_no_error_of_coefficients():
    pyramid = analyse(random_delaunay(200, seed=2), levels=4, update="none")
    assert all(row.rmse_coefficients < 1e-12 for row in level_errors(pyramid))
    assert level_errors(pyramid)[0].rmse_surface > 0


# --- measured by the analysis itself ----------------------------------------------------------


def rasterised(mesh, x, y):
    """Return the heights of a TIN at places, triangle by triangle: nothing of ours is used."""
    heights = np.full(len(x), np.nan)
    for face in mesh.faces:
        a, b, c = mesh.vertices[face]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        at_b = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
        at_c = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
        inside = (at_b >= -1e-9) & (at_c >= -1e-9) & (at_b + at_c <= 1 + 1e-9)
        height = a[2] + at_b * (b[2] - a[2]) + at_c * (c[2] - a[2])
        heights[inside] = height[inside]
    return heights


@pytest.mark.parametrize("norm", ["rms", "max"])
def test_what_the_analysis_measured_is_what_a_rasteriser_finds(norm):
    rng = np.random.default_rng(3)
    z = 20 * np.sin(np.arange(18) / 3)[:, None] + rng.normal(0, 1, (18, 25))
    valid = np.ones(z.shape, dtype=bool)
    valid[5:8, 9:14] = False
    valid[:2, 1] = valid[1, 0] = False  # the corner cell stands alone
    mesh = TriangleMesh.from_grid(z, np.arange(25.0), np.arange(18.0), valid=valid)
    pyramid = analyse(mesh, norm=norm, levels=8)
    assert pyramid.measured is not None
    x, y, true = mesh.vertices.T
    for errors, level in zip(pyramid.errors(), pyramid, strict=True):
        apart = rasterised(level, x, y) - true
        assert np.isnan(apart).sum() == 1
        apart[0] = 0.0  # the cell that stands alone keeps its height
        assert errors.n_uncovered == 0
        assert errors.rmse_surface == pytest.approx(np.sqrt(np.mean(apart**2)), abs=1e-9)
        assert errors.max_error_surface == pytest.approx(np.abs(apart).max(), abs=1e-9)
        assert (errors.n_vertices, errors.n_faces) == (level.n_vertices, level.n_faces)


def test_the_analysis_measures_what_is_measured_without_it():
    mesh = TriangleMesh.from_grid(
        np.random.default_rng(1).normal(0, 3, (20, 20)), np.arange(20.0), np.arange(20.0),
        attributes=np.random.default_rng(2).uniform(0, 255, (20, 20, 2)),
        attribute_names=("a", "b"),
    )  # fmt: skip
    pyramid = analyse(mesh, levels=9)
    merged = mesh.vertices[::7] + np.array([0.0, 0.0, 2.5])
    points = np.concatenate([mesh.vertices, merged])
    for given in (None, points):
        quick = level_errors(pyramid, points=given)
        slow = level_errors(pyramid.with_parts(), points=given)
        for one, other in zip(quick, slow, strict=True):
            assert one == pytest.approx(other, abs=1e-9)
