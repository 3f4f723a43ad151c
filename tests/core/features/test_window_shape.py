"""Shape over windows against surfaces whose derivatives are known, on grids and irregular TINs."""

import numpy as np
import pytest

from wavelet_core import (
    Cancelled,
    OptionError,
    PyramidError,
    TriangleMesh,
    analyse,
    landforms,
    level_spacings,
    surface_shape,
    synthetic,
    window_shape,
)
from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core.features.window_shape import level_between

BY_SIZE = {"partition": "random", "prediction": "plane"}


def scattered(height, n=3000, side=60.0, offset=0.0, seed=0):
    """Return a surface on points of uneven density, its pyramid and its vertices in plan."""
    rng = np.random.default_rng(seed)
    plan = side * np.vstack([rng.random((n, 2)), 0.4 + 0.2 * rng.random((n // 3, 2))])
    mesh = TriangleMesh.from_points(np.column_stack([plan + offset, height(*plan.T)]))
    return analyse(mesh, levels=12, seed=seed, **BY_SIZE), mesh.vertices[:, :2] - offset


def on_grid(z):
    """Return the pyramid of a DEM of cells of one unit."""
    x, y = np.arange(z.shape[1]) * 1.0, np.arange(z.shape[0]) * 1.0
    return analyse(TriangleMesh.from_grid(z, x=x, y=y), levels=12, **BY_SIZE)


@pytest.mark.parametrize("distance", [1.0, 3.0, 9.0])
def test_a_plane_has_its_slope_and_no_curvature(distance):
    pyramid, _ = scattered(lambda x, y: 0.3 * x - 0.4 * y)
    shape = window_shape(pyramid, distance)
    np.testing.assert_allclose(shape.gradient, [[0.3, -0.4]] * len(shape.gradient), atol=1e-9)
    np.testing.assert_allclose(shape.hessian, 0, atol=1e-8)


@pytest.mark.parametrize("offset", [0.0, 4e6])
@pytest.mark.parametrize("distance", [1.0, 4.0, 12.0])
def test_a_quadratic_on_an_irregular_tin_comes_out_exactly_to_the_outline(distance, offset):
    pyramid, plan = scattered(
        lambda x, y: 0.3 * x - 0.2 * y + 0.025 * x * x + 0.02 * x * y - 0.015 * y * y,
        offset=offset,
    )
    gradient = np.array([0.3, -0.2]) + plan @ np.array([[0.05, 0.02], [0.02, -0.03]])
    tolerance = 1e-8 if offset == 0 else 1e-4
    shape = window_shape(pyramid, distance)
    np.testing.assert_allclose(shape.gradient, gradient, atol=tolerance)
    np.testing.assert_allclose(shape.hessian - (0.05, 0.02, -0.03), 0, atol=tolerance)


def test_a_bowl_has_its_curvature_at_the_vertices_of_every_level():
    pyramid, _ = scattered(lambda x, y: 0.01 * ((x - 30) ** 2 + (y - 30) ** 2))
    for level in (0, 5, 12):
        shape = window_shape(pyramid, 6.0, at=level)
        assert len(shape.gradient) == pyramid.n_vertices(level)
        np.testing.assert_allclose(shape.hessian - (0.02, 0.0, 0.02), 0, atol=1e-9)


def test_a_sinusoid_is_flattened_by_what_the_window_takes_in():
    """By 4 % as the quadratic that is fitted to it point by point: means flatten it further."""
    wavelength, distance = 40.0, 8.0
    k, radius = 2 * np.pi / wavelength, 1.75 * distance
    x, y = np.meshgrid(np.arange(100.0), np.arange(100.0))
    shape = window_shape(on_grid(np.sin(k * x)), distance)
    u, v = np.meshgrid(*[np.linspace(-radius, radius, 401)] * 2)
    inside = u * u + v * v < radius**2
    u, v = u[inside], v[inside]
    root = np.sqrt(1 - (u * u + v * v) / radius**2)
    terms = np.column_stack([np.ones(len(u)), u, v, u * u / 2, u * v, v * v / 2])
    slope, bend = (
        np.linalg.lstsq(root[:, None] * terms, root * rise, rcond=None)[0][place]
        for rise, place in ((np.sin(k * u), 1), (np.cos(k * u), 3))
    )
    inner = ((x > 20) & (x < 79) & (y > 20) & (y < 79)).ravel()
    phase = k * x.ravel()[inner]
    np.testing.assert_allclose(
        shape.gradient[inner, 0], slope * np.cos(phase), atol=0.04 * abs(slope)
    )
    np.testing.assert_allclose(shape.hessian[inner, 0], bend * np.sin(phase), atol=0.05 * abs(bend))
    np.testing.assert_allclose(shape.gradient[inner, 1], 0, atol=0.04 * abs(slope))


def test_on_the_cells_of_a_grid_the_window_is_that_of_three_by_three():
    z = np.random.default_rng(0).normal(size=(12, 15))
    shape = window_shape(on_grid(z), 1.0)
    u, v = np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0])
    u, v = u.ravel(), v.ravel()
    root = np.sqrt(1 - (u * u + v * v) / 1.75**2)
    terms = np.column_stack([np.ones(9), u, v, u * u / 2, u * v, v * v / 2])
    found = np.column_stack([shape.gradient, shape.hessian]).reshape(12, 15, 5)
    for row, column in ((2, 2), (5, 7), (9, 12)):
        rise = z[row - 1 : row + 2, column - 1 : column + 2].ravel()
        fitted = np.linalg.lstsq(root[:, None] * terms, root * rise, rcond=None)[0][1:]
        np.testing.assert_allclose(found[row, column], fitted, atol=1e-9)


def test_two_pyramids_of_one_terrain_have_one_map():
    """Over single rings they had little in common: 0.40 here."""
    rng = np.random.default_rng(1)
    z = np.cumsum(np.cumsum(rng.normal(size=(80, 80)), axis=0), axis=1) / 20 + rng.normal(
        size=(80, 80)
    )
    mesh = TriangleMesh.from_grid(z, x=np.arange(80.0), y=np.arange(80.0))
    one, other = (analyse(mesh, levels=12, seed=seed, **BY_SIZE) for seed in (0, 1))

    def alike(shapes):
        return np.corrcoef(*(shape.mean for shape in shapes))[0, 1]

    distance = level_spacings(one)[4]
    assert alike([window_shape(pyramid, distance) for pyramid in (one, other)]) > 0.99
    both = np.intersect1d(one.vertex_ids(4), other.vertex_ids(4))
    rings = []
    for pyramid in (one, other):
        hessian = surface_shape(pyramid.mesh(4)).hessian
        rings.append(hessian[np.searchsorted(pyramid.vertex_ids(4), both)].sum(axis=1))
    assert np.corrcoef(*rings)[0, 1] < 0.9


def test_outlines_and_corners_of_rough_ground_have_no_walls():
    pyramid, plan = scattered(lambda x, y: np.random.default_rng(3).normal(0, 0.2, len(x)))
    steep = np.hypot(*window_shape(pyramid, 4.0).gradient.T)
    near = np.abs(plan - 30).max(axis=1) > 27
    assert np.isfinite(steep).all()
    assert np.median(steep[near]) < 5 * np.median(steep[~near])  # half the window
    assert steep.max() < 1.0  # 45 degrees; a single ring has steeper ones in the middle
    assert np.hypot(*surface_shape(pyramid.synthesise()).gradient.T).max() > 1.0


def test_points_count_with_the_area_around_them():
    """A strip that was flown twice, a little too low, counted four times what its area is."""
    rng = np.random.default_rng(0)
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(40.0), np.arange(40.0)))
    ridge = np.abs(x - 20)
    mesh = TriangleMesh.from_points(np.column_stack([x, y, -ridge]))
    shape = window_shape(analyse(mesh, levels=8, **BY_SIZE), 4.0)
    often = rng.uniform([21, 0], [39, 39], (6000, 2))
    dense = np.column_stack([often, -np.abs(often[:, 0] - 20)])
    doubled = TriangleMesh.from_points(np.vstack([mesh.vertices, dense]))
    again = window_shape(analyse(doubled, levels=8, **BY_SIZE), 4.0)
    top = np.flatnonzero((x == 20) & (y > 10) & (y < 30))
    np.testing.assert_allclose(again.gradient[top, 0], shape.gradient[top, 0], atol=0.12)


def test_few_vertices_and_loose_ones_have_what_there_is():
    lone = TriangleMesh([[0, 0, 0], [1, 0, 1], [0, 1, 0], [9, 9, 9]], [[0, 1, 2]])
    shape = window_shape(analyse(lone, levels=1, **BY_SIZE), 1.0)
    np.testing.assert_allclose(shape.gradient[:3], [[1, 0]] * 3, atol=1e-12)
    assert np.isnan(shape.gradient[3]).all()
    assert landforms(shape)[3] == -1


def test_a_small_window_in_a_sparse_corner_grows():
    rng = np.random.default_rng(2)
    plan = np.vstack([10 * rng.random((900, 2)), [20, 20] + 30 * rng.random((40, 2))])
    z = 0.5 * plan[:, 0] + 0.02 * plan[:, 1] ** 2
    pyramid = analyse(TriangleMesh.from_points(np.column_stack([plan, z])), levels=4, **BY_SIZE)
    shape = window_shape(pyramid, 1.0)
    sparse = plan.min(axis=1) > 22
    np.testing.assert_allclose(shape.hessian[sparse, 2], 0.04, atol=0.01)


@pytest.mark.parametrize("make", ["grid", "tin", "holes"])
def test_both_engines_have_the_same_bytes(make):
    if make == "tin":
        pyramid, _ = scattered(lambda x, y: np.sin(x / 3) * np.cos(y / 4), n=900)
    else:
        z = np.random.default_rng(0).normal(size=(30, 40))
        valid = np.random.default_rng(1).random(z.shape) > (0.1 if make == "holes" else 0.0)
        axes = {"x": np.arange(40.0), "y": np.arange(30.0)}
        pyramid = analyse(TriangleMesh.from_grid(z, valid=valid, **axes), levels=8, **BY_SIZE)
    for distance in (1.0, 2.5, 8.0):
        shapes = []
        for name in ("compiled" if HAS_NUMBA else "loops", "arrays"):
            with engine(name):
                shapes.append(window_shape(pyramid, distance))
        assert shapes[0].gradient.tobytes() == shapes[1].gradient.tobytes()
        assert shapes[0].hessian.tobytes() == shapes[1].hessian.tobytes()


def test_wrong_distances_and_levels_are_refused_and_work_is_cancelled():
    pyramid = analyse(synthetic.hills(12, 14), levels=3, **BY_SIZE)
    for distance in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(OptionError, match="give one above 0"):
            window_shape(pyramid, distance)
    with pytest.raises(PyramidError):
        window_shape(pyramid, 1.0, at=4)
    with pytest.raises(Cancelled, match="nothing was kept"):
        window_shape(pyramid, 1.0, progress=lambda _: False)
    seen = []
    window_shape(pyramid, 1.0, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_the_level_between_has_a_third_of_the_distance():
    pyramid = on_grid(np.zeros((60, 60)))
    spacings = level_spacings(pyramid)
    at = level_between(pyramid, 9.0)
    assert spacings[at] == pytest.approx(3.0, rel=0.2)
    assert level_between(pyramid, 1e-3) == pyramid.n_levels
