"""Heights fitted by least squares: against a dense solver, and what they may not change."""

import numpy as np
import pytest

from wavelet_core import OptionError, TriangleMesh, analyse
from wavelet_core.accuracy.fitted_heights import fitted
from wavelet_core.mesh.location import surface_errors


def rough_grid(n_rows, n_columns, n_attributes=0, seed=0):
    rng = np.random.default_rng(seed)
    shape = (n_rows, n_columns, n_attributes) if n_attributes else None
    return TriangleMesh.from_grid(
        rng.normal(size=(n_rows, n_columns)),
        x=np.arange(n_columns),
        y=np.arange(n_rows),
        attributes=rng.normal(size=shape) if shape else None,
        attribute_names=tuple("abc"[:n_attributes]),
    )


def coarse_and_original(n_attributes=0, seed=3):
    original = rough_grid(24, 20, n_attributes=n_attributes, seed=seed)
    return analyse(original, target_vertices=60).mesh(0), original


def hat_functions(mesh, plan):
    """Return each vertex's linear hat function at the points, by brute force."""
    values = np.zeros((len(plan), mesh.n_vertices))
    for p, (x, y) in enumerate(plan):
        for face in mesh.faces:
            corners = np.vstack([mesh.vertices[face, :2].T, np.ones(3)])
            weights = np.linalg.solve(corners, [x, y, 1.0])
            if weights.min() >= -1e-9:
                values[p, face] = weights
                break
    return values


def test_the_heights_are_those_of_a_dense_solver():
    mesh, original = coarse_and_original()
    hats = hat_functions(mesh, original.vertices[:, :2])
    best = np.linalg.lstsq(hats, original.vertices[:, 2], rcond=None)[0]
    np.testing.assert_allclose(fitted(mesh, original).vertices[:, 2], best, atol=1e-5)


def test_the_error_falls_and_the_plan_stays():
    mesh, original = coarse_and_original()
    result = fitted(mesh, original)
    before = np.sum(surface_errors(mesh, original.vertices) ** 2)
    assert np.sum(surface_errors(result, original.vertices) ** 2) < 0.95 * before
    np.testing.assert_array_equal(result.vertices[:, :2], mesh.vertices[:, :2])
    np.testing.assert_array_equal(result.faces, mesh.faces)


def attribute_as_height(mesh, k):
    vertices = np.column_stack([mesh.vertices[:, :2], mesh.attributes[:, k]])
    return TriangleMesh(vertices, mesh.faces)


def test_each_channel_is_fitted_by_itself():
    mesh, original = coarse_and_original(n_attributes=2)
    result = fitted(mesh, original)
    for k in range(2):
        alone = fitted(attribute_as_height(mesh, k), attribute_as_height(original, k))
        np.testing.assert_allclose(result.attributes[:, k], alone.vertices[:, 2], atol=1e-9)


def test_locked_vertices_keep_their_height():
    mesh, original = coarse_and_original()
    locked = np.arange(mesh.n_vertices) % 3 == 0
    result = fitted(mesh, original, locked)
    np.testing.assert_array_equal(result.vertices[locked], mesh.vertices[locked])
    hats = hat_functions(mesh, original.vertices[:, :2])
    error = original.vertices[:, 2] - hats @ result.vertices[:, 2]
    gradient = hats.T @ error
    assert np.abs(gradient[~locked]).max() < 1e-4 * np.abs(gradient[locked]).max()


def test_a_plane_is_fitted_exactly():
    original = rough_grid(12, 12)
    heights = 3.0 + 0.5 * original.vertices[:, 0] - 0.2 * original.vertices[:, 1]
    plane = TriangleMesh(np.column_stack([original.vertices[:, :2], heights]), original.faces)
    mesh = analyse(plane, target_vertices=10).mesh(0)
    bent = mesh.vertices.copy()
    bent[:, 2] += np.arange(len(bent))
    result = fitted(TriangleMesh(bent, mesh.faces), plane)
    np.testing.assert_allclose(surface_errors(result, plane.vertices), 0.0, atol=1e-4)


def test_vertices_without_a_face_stay_as_they_are():
    mesh, original = coarse_and_original()
    alone = TriangleMesh(np.vstack([mesh.vertices, [1e3, 1e3, 7.0]]), mesh.faces)
    assert fitted(alone, original).vertices[-1, 2] == 7.0


def test_other_attributes_are_refused():
    mesh, _ = coarse_and_original()
    _, original = coarse_and_original(n_attributes=1)
    with pytest.raises(OptionError, match="attributes"):
        fitted(mesh, original)


def test_a_mask_of_another_size_is_refused():
    mesh, original = coarse_and_original()
    with pytest.raises(OptionError, match="locked"):
        fitted(mesh, original, np.zeros(3, dtype=bool))
