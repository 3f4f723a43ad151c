"""Points on a surface, beside it by rounding, and where it has a hole."""

import numpy as np
import pytest

from wavelet_core import TriangleMesh, synthetic
from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core.mesh.location import errors_with_border, surface_errors


@pytest.fixture
def holed():
    """Return hills with a hole of four faces, and a vertex by itself in it."""
    mesh = synthetic.hills(12, 10)
    middle = 5 * 10 + 4
    is_hole = (mesh.faces == middle).any(axis=1)
    assert is_hole.sum() > 3
    return TriangleMesh(mesh.vertices, mesh.faces[~is_hole]), middle


def test_a_point_that_no_face_covers_stays_without_an_error(holed):
    mesh, middle = holed
    near = mesh.vertices[[middle, middle]] + [[0.3, 0.1, 7.0], [0.0, 0.0, 7.0]]
    errors = errors_with_border(mesh, near, 1e-6)
    assert np.isnan(errors[0])
    assert errors[1] == 7.0  # at the vertex by itself


def test_points_beside_the_border_by_rounding_are_measured_at_its_nearest_place(holed):
    mesh, middle = holed
    rng = np.random.default_rng(4)
    corners = mesh.vertices[:, :2]
    low, high = corners.min(axis=0), corners.max(axis=0)
    x = rng.uniform(low[0], high[0], 200)
    beside = np.column_stack([x, np.full(200, low[1]), np.zeros(200)])
    on_border = -surface_errors(mesh, beside)
    assert np.isfinite(on_border).all()
    beside[:, 1] -= 1e-5
    assert np.isnan(surface_errors(mesh, beside)).all()
    np.testing.assert_allclose(-errors_with_border(mesh, beside, 2e-5), on_border, atol=1e-12)
    assert np.isnan(errors_with_border(mesh, beside, 0.9e-5)).all()
    corner = np.array([[low[0] - 1e-6, low[1] - 1e-6, 0.0]])
    first = mesh.vertices[(corners == low).all(axis=1), 2]
    np.testing.assert_allclose(-errors_with_border(mesh, corner, 1e-5), first, atol=1e-12)
    lone = mesh.vertices[[middle]] + [[1e-6, -1e-6, 2.0]]
    np.testing.assert_allclose(errors_with_border(mesh, lone, 1e-5), [2.0])


def test_a_mesh_without_faces_is_its_vertices():
    mesh = TriangleMesh([[0, 0, 1.0], [5, 5, 2.0]], np.empty((0, 3), dtype=int))
    errors = errors_with_border(
        mesh, np.array([[0, 0, 3.0], [5, 5 + 1e-9, 3.0], [1, 1, 1.0]]), 1e-6
    )
    np.testing.assert_array_equal(errors, [2.0, 1.0, np.nan])


@pytest.mark.parametrize("beyond", [np.nan, np.inf, -np.inf])
def test_a_place_that_is_no_number_is_covered_by_nothing(beyond):
    """One of them was a ValueError for all points."""
    mesh = synthetic.hills(12, 10)
    errors = surface_errors(mesh, [[1.0, 2.0, 3.0], [beyond, 2.0, 3.0], [1.0, beyond, 3.0]])
    assert np.isnan(errors).tolist() == [False, True, True]
    assert errors[0] == surface_errors(mesh, np.array([[1.0, 2.0, 3.0]]))[0]


@pytest.mark.parametrize("name", ["loops", "arrays", *(["compiled"] if HAS_NUMBA else [])])
def test_a_face_beyond_64_bits_of_cells_covers_what_lies_in_it(name):
    """Its rows of cells wrapped round, and points in the middle of it had no surface."""
    far = 1e22
    mesh = TriangleMesh([[-far, -far, 7.0], [far, -far, 7.0], [0.0, far, 7.0]], [[0, 1, 2]])
    with engine(name):
        errors = surface_errors(mesh, np.array([[1.0, 1.0, 8.0], [2.0, 3.0, 9.0]]))
    assert errors.tolist() == [1.0, 2.0]


def test_the_border_of_a_vertical_face_has_a_height():
    """Its edge without length in plan made all places near the border NaN."""
    vertices = [[0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4], [4, 4, 9]]
    mesh = TriangleMesh(vertices, [[0, 1, 2], [1, 3, 2], [1, 4, 3]])
    beside = np.array([[4.0 + 1e-7, 2.0, 0.0], [1.0, -1e-7, 3.0], [4 + 1e-7, 4 + 1e-7, 0.0]])
    errors = errors_with_border(mesh, beside, 1e-6)
    assert errors[1] == 2.0
    assert np.isfinite(errors).all()
