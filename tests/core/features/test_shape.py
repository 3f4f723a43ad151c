"""Slope, aspect and curvature against surfaces whose derivatives are known in closed form."""

import numpy as np
import pytest

from wavelet_core import OptionError, TriangleMesh, analyse, synthetic
from wavelet_core.features.shape import SHAPE_NAMES, detail_shape, sample_at, surface_shape


def quadratic(plan, p=0.3, q=-0.2, r=0.05, s=0.02, t=-0.03):
    """Return height, gradient and Hessian of a quadratic surface at positions in plan."""
    x, y = plan.T
    z = p * x + q * y + 0.5 * r * x * x + s * x * y + 0.5 * t * y * y
    return z, np.column_stack([p + r * x + s * y, q + s * x + t * y]), (r, s, t)


@pytest.mark.parametrize("offset", [0.0, 4e6])
def test_a_quadratic_surface_comes_out_exactly(offset):
    plan = np.random.default_rng(1).uniform(-10, 10, (600, 2))
    z, gradient, hessian = quadratic(plan)
    mesh = TriangleMesh.from_points(np.column_stack([plan + offset, z]))
    shape = surface_shape(mesh)
    tolerance = 1e-7 if offset == 0 else 1e-4
    np.testing.assert_allclose(shape.gradient, gradient, rtol=0, atol=tolerance)
    np.testing.assert_allclose(shape.hessian - hessian, 0, rtol=0, atol=tolerance * 100)


def test_a_quadratic_on_a_grid_comes_out_exactly_even_in_the_corners():
    axis = np.arange(8.0)
    x, y = np.meshgrid(axis, axis)
    z, gradient, hessian = quadratic(np.column_stack([x.ravel(), y.ravel()]))
    shape = surface_shape(TriangleMesh.from_grid(z.reshape(x.shape), x=axis, y=axis))
    np.testing.assert_allclose(shape.gradient, gradient, rtol=0, atol=1e-9)
    np.testing.assert_allclose(shape.hessian - hessian, 0, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("slope", "aspect"), [((1, 0), 270), ((-1, 0), 90), ((0, 1), 180), ((0, -1), 0)]
)
def test_slope_and_aspect_of_planes(slope, aspect):
    shape = surface_shape(synthetic.plane(slope=slope))
    np.testing.assert_allclose(shape.slope, 45.0, atol=1e-9)
    turn = (shape.aspect - aspect + 180) % 360 - 180
    np.testing.assert_allclose(turn, 0.0, atol=1e-6)
    for name in ("profile", "tangential", "mean", "gaussian"):
        np.testing.assert_allclose(shape.named(name), 0.0, atol=1e-9)


def test_flat_ground_has_no_aspect_and_no_curvature():
    shape = surface_shape(synthetic.plane(slope=(0.0, 0.0)))
    assert (shape.slope == 0).all()
    assert np.isnan(shape.aspect).all()
    assert (shape.profile == 0).all()
    assert (shape.tangential == 0).all()


def sphere(radius=50.0, n=41):
    axis = np.linspace(-10, 10, n)
    x, y = np.meshgrid(axis, axis)
    return TriangleMesh.from_grid(np.sqrt(radius**2 - x * x - y * y), x=axis, y=axis)


def test_a_sphere_has_one_over_r_everywhere_and_a_hill_is_convex():
    shape = surface_shape(sphere())
    for name in ("mean", "profile", "tangential"):
        values = shape.named(name).reshape(41, 41)[2:-2, 2:-2].ravel()
        values = np.delete(values, len(values) // 2) if name != "mean" else values  # flat top
        np.testing.assert_allclose(values, 1 / 50, rtol=3e-3, err_msg=name)
    gaussian = shape.gaussian.reshape(41, 41)[2:-2, 2:-2]
    np.testing.assert_allclose(gaussian, 1 / 50**2, rtol=6e-3)


def test_a_valley_is_concave_across_and_straight_along():
    axis = np.arange(-5.0, 6.0)
    x, y = np.meshgrid(axis, axis)
    shape = surface_shape(TriangleMesh.from_grid(0.1 * x * x + 0.3 * y, x=axis, y=axis))
    middle = np.flatnonzero(np.isclose(x.ravel(), 0))
    assert (shape.tangential[middle] < -0.1).all()
    np.testing.assert_allclose(shape.profile[middle], 0, atol=1e-9)


def test_vertices_without_faces_have_no_shape():
    mesh = TriangleMesh([[0, 0, 0], [1, 0, 1], [0, 1, 0], [9, 9, 9]], [[0, 1, 2]])
    shape = surface_shape(mesh)
    np.testing.assert_allclose(shape.gradient[:3], [[1, 0]] * 3)
    assert np.isnan(shape.gradient[3]).all()
    assert np.isnan(shape.slope[3])


def test_a_shape_has_six_names_and_no_others():
    shape = surface_shape(synthetic.plane())
    assert all(len(shape.named(name)) == 180 for name in SHAPE_NAMES)
    with pytest.raises(OptionError, match="no shape 'roughness'; choose one of slope"):
        shape.named("roughness")


@pytest.mark.parametrize("prediction", ["uniform", "geometric", "barycentric"])
def test_details_carry_the_curvature_of_a_paraboloid(prediction):
    axis = np.arange(-15.0, 16.0)
    x, y = np.meshgrid(axis, axis)
    mesh = TriangleMesh.from_grid(-0.005 * (x * x + y * y) + 0.1 * x, x=axis, y=axis)
    pyramid = analyse(mesh, levels=3, partition="colouring", prediction=prediction, update="none")
    for level in range(3):
        shape = detail_shape(pyramid, level)
        np.testing.assert_allclose(shape.curvature, 0.01, rtol=1e-6)


def test_details_of_a_one_moment_filter_carry_the_gradient_along_their_lean():
    slope = np.array([0.3, -0.2])
    plan = np.random.default_rng(5).uniform(0, 20, (300, 2))
    mesh = TriangleMesh.from_points(np.column_stack([plan, plan @ slope]))
    pyramid = analyse(mesh, levels=2, partition="colouring", prediction="uniform", update="none")
    shape = detail_shape(pyramid, 1)
    carried = shape.gradient[np.isfinite(shape.gradient).all(axis=1)]
    assert len(carried) > 20
    along = carried / np.linalg.norm(carried, axis=1)[:, None]
    # the part of the slope along each lean, found from the detail alone
    np.testing.assert_allclose((along @ slope), np.linalg.norm(carried, axis=1), atol=1e-9)
    np.testing.assert_allclose(shape.curvature, 0, atol=1e-9)


def test_details_of_a_plane_reproducing_filter_carry_no_gradient():
    pyramid = analyse(synthetic.plane(), levels=2, partition="colouring", prediction="barycentric")
    assert np.isnan(detail_shape(pyramid, 0).gradient).all()


def test_sampling_is_linear_on_faces_and_nan_beside_them():
    mesh = synthetic.scattered(200)
    inside = mesh.vertices[mesh.faces[::7]].mean(axis=1)[:, :2]
    columns = np.column_stack([mesh.vertices[:, 0], 2 * mesh.vertices[:, 1] + 1])
    sampled = sample_at(mesh, columns, np.vstack([inside, [[-1e3, 0.0]]]))
    np.testing.assert_allclose(sampled[:-1, 0], inside[:, 0], atol=1e-9)
    np.testing.assert_allclose(sampled[:-1, 1], 2 * inside[:, 1] + 1, atol=1e-9)
    assert np.isnan(sampled[-1]).all()


def test_slope_falls_as_the_surface_is_smoothed():
    pyramid = analyse(synthetic.scattered(800, seed=2), levels=6, partition="quadric")
    steep = [
        np.nanmedian(surface_shape(pyramid.mesh(level)).slope) for level in (pyramid.n_levels, 0)
    ]
    assert steep[1] < steep[0]


def test_neighbours_near_a_conic_give_no_wall():
    # They hardly determine the quadratic; it was taken all the same, and twelve times as steep as
    # the steepest face around.
    rng = np.random.default_rng(0)
    plan = rng.uniform(0, 100, (4000, 2))
    mesh = TriangleMesh.from_points(np.column_stack([plan, rng.normal(0, 0.1, 4000)]))
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    steepest = np.zeros(4000)
    of_faces = np.hypot(normals[:, 0], normals[:, 1]) / normals[:, 2]
    np.maximum.at(steepest, mesh.faces.ravel(), np.repeat(of_faces, 3))
    inner = np.abs(plan - 50).max(axis=1) < 48
    slope = np.tan(np.radians(surface_shape(mesh).slope))
    assert (slope[inner] < 4 * steepest[inner]).all()
