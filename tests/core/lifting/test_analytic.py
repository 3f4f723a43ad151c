"""Cases with an answer that is known in closed form."""

import helpers
import numpy as np
import pytest
from helpers_meshes import random_delaunay

from wavelet_core import TriangleMesh, analyse, synthetic
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.mesh.curvature import bending_energy, squared_curvature_sums

# --- filters on one fan -----------------------------------------------------------------------


def one_step(mesh, prediction, update="none", signal="z"):
    """Return the filters and the details of the one step that removes vertex 0."""
    pyramid = analyse(
        mesh, levels=1, partition="quadric", prediction=prediction, update=update, signal=signal
    )
    pair = pyramid.filters(0)
    np.testing.assert_array_equal(pair.odd, [0])
    return pair, pyramid


@pytest.mark.parametrize("prediction", ["uniform", "plane"])
def test_a_regular_hexagon_is_predicted_by_its_mean(prediction):
    pair, pyramid = one_step(synthetic.fan(n_sides=6, apex=1.0), prediction)
    np.testing.assert_allclose(pair.prediction.toarray(), np.full((1, 6), 1 / 6), atol=1e-14)
    np.testing.assert_allclose(pyramid.detail(0).vectors, [[1.0]], atol=1e-14)


@pytest.mark.parametrize(
    ("update", "raised_ring"),
    [
        ("martinez_ortega", 0.5),  # 0.5 p / p for a single odd neighbour
        ("one_ring_mean", 1 / 7),  # 1 / (N + 1)
        ("minimum_norm", 1 / 7),  # ζ = 7/6 all round: 7/6 / (6 (7/6)²)
        ("none", 0.0),
    ],
)
def test_updates_of_a_regular_hexagon(update, raised_ring):
    mesh = synthetic.fan(n_sides=6, apex=1.0)
    _, pyramid = one_step(mesh, "uniform", update)
    np.testing.assert_allclose(pyramid.mesh(0).vertices[:, 2], np.full(6, raised_ring), atol=1e-15)
    np.testing.assert_allclose(pyramid.integrals(0), np.full(6, 7 / 6))
    np.testing.assert_array_equal(pyramid.integrals(1), np.ones(7))


def kite():
    """Return vertex 0 at the origin with neighbours at distances 1, 2, 3, 4 along the axes."""
    ring = [(1, 0, 0), (0, 2, 0), (-3, 0, 0), (0, -4, 0)]
    return TriangleMesh([(0, 0, 0), *ring], [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)])


def test_geometric_weights_are_inverse_lengths_in_normalised_space():
    pair, _ = one_step(kite(), "geometric")
    lengths = np.array([1 / 4, 2 / 6, 3 / 4, 4 / 6])  # the ranges are 4 in x and 6 in y
    np.testing.assert_allclose(
        pair.prediction.toarray()[0], (1 / lengths) / (1 / lengths).sum(), rtol=1e-12
    )


def test_cotangent_weights_of_a_kite():
    pair, _ = one_step(kite(), "cotangent")
    east, north, west, south = 1 / 4, 2 / 6, 3 / 4, 4 / 6
    # The angle opposite 0-east at north has the cotangent |0 north| / |0 east|, and so on.
    weights = np.array([north + south, east + west, north + south, east + west]) / np.array(
        [east, north, west, south]
    )
    np.testing.assert_allclose(pair.prediction.toarray()[0], weights / weights.sum(), rtol=1e-12)


def test_nnls_finds_the_point_where_it_lies_among_its_neighbours():
    pair, pyramid = one_step(kite(), "nnls")
    weights = pair.prediction.toarray()[0]
    assert (weights >= 0).all()
    assert weights @ kite().vertices[1:, 0] == pytest.approx(0, abs=1e-7)
    assert weights @ kite().vertices[1:, 1] == pytest.approx(0, abs=1e-7)
    assert pyramid.detail(0).magnitude == pytest.approx(0, abs=1e-12)


def test_nnls_uses_no_neighbour_that_lies_behind():
    """A vertex outside the hull of its ring in R^n is predicted from the nearest part of it."""
    mesh = TriangleMesh(
        [(0.9, 0.9, 0), (0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)],
        [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)],
        [[9.0], [0.0], [0.0], [10.0], [0.0]],
    )
    pair, _ = one_step(mesh, "nnls")
    weights = pair.prediction.toarray()[0]
    # In normalised space (0.45, 0.45, 0.9) from (0, 0, 0), (1, 0, 0), (1, 1, 1) and (0, 1, 0).
    np.testing.assert_allclose(weights, [0.4, 0.0, 0.6, 0.0], atol=1e-7)
    assert weights[1] == weights[3] == 0.0


# --- what the filters reproduce ---------------------------------------------------------------


@pytest.mark.parametrize("signal", ["z", "xyz"])
@helpers.UNSTABLE_TOO
@pytest.mark.parametrize(("prediction", "update"), helpers.PAIRS)
def test_a_constant_attribute_has_no_detail_and_stays(prediction, update, signal):
    mesh = random_delaunay(80, n_attributes=4, seed=4)
    assert np.ptp(mesh.attributes[:, 3]) == 0
    pyramid = analyse(
        mesh, levels=6, partition="quadric", prediction=prediction, update=update, signal=signal
    )
    # What rounding leaves in a detail reaches the coarser levels times the weights of the update,
    # which are below one but in the unstable designs: there sums that nearly vanish divide them.
    rounding = 1e-13 * 7
    for level in reversed(range(pyramid.n_levels)):
        filters = pyramid.filters(level)
        largest = np.abs(filters.prediction.data).max()
        assert np.abs(pyramid.detail(level).vectors[:, -1]).max() <= rounding * largest
        rounding *= max(1.0, np.abs(filters.update.data).max(initial=0.0))
    np.testing.assert_allclose(pyramid.mesh(0).attributes[:, 3], 7.0, rtol=1e-9)


@pytest.mark.parametrize(
    ("prediction", "update"),
    [
        (prediction, update)
        for prediction, update in helpers.PAIRS
        if prediction in ("barycentric", "plane") and update != "one_ring_mean"
    ],
)
def test_a_tilted_plane_has_no_detail(prediction, update):
    mesh = random_delaunay(200, seed=4)
    x, y = mesh.vertices[:, 0], mesh.vertices[:, 1]
    plane = TriangleMesh(np.column_stack([x, y, 3 * x - 2 * y + 1]), mesh.faces)
    pyramid = analyse(plane, levels=9, partition="colouring", prediction=prediction, update=update)
    assert pyramid.n_levels == 9
    for level in range(pyramid.n_levels):
        assert pyramid.detail(level).magnitude.max() <= 1e-12


@pytest.mark.parametrize("prediction", ["nnls", "least_squares"])
def test_fitted_weights_reproduce_a_plane_to_their_damping(prediction):
    mesh = random_delaunay(200, seed=4)
    x, y = mesh.vertices[:, 0], mesh.vertices[:, 1]
    plane = TriangleMesh(np.column_stack([x, y, 3 * x - 2 * y + 1]), mesh.faces)
    pyramid = analyse(plane, levels=1, partition="quadric", prediction=prediction, update="none")
    assert pyramid.detail(0).magnitude.max() <= 1e-6


@pytest.mark.parametrize("prediction", helpers.ALL_PREDICTIONS)
def test_the_minimum_norm_update_keeps_the_sum_of_the_input(prediction):
    mesh = random_delaunay(150, n_attributes=2, seed=6)
    pyramid = analyse(
        mesh, levels=8, partition="quadric", prediction=prediction, update="minimum_norm"
    )
    coarse = pyramid.mesh(0)
    total = pyramid.integrals(0) @ np.column_stack([coarse.vertices[:, 2], coarse.attributes])
    np.testing.assert_allclose(
        total, np.column_stack([mesh.vertices[:, 2], mesh.attributes]).sum(axis=0), rtol=1e-9
    )


# --- curvature and bending energy -------------------------------------------------------------


def lattice(height, n=41, half_width=0.3):
    """Return the surface ``height(x, y)`` over a lattice of nearly equilateral triangles."""
    step = 2 * half_width / (n - 1)
    rows = []
    for row in range(n):
        x = np.arange(n) * step + (step / 2 if row % 2 else 0.0) - half_width
        y = np.full(n, row * step * np.sqrt(3) / 2) - half_width
        rows.append(np.column_stack([x, y]))
    plan = np.concatenate(rows)
    faces = []
    for row in range(n - 1):
        for k in range(n - 1):
            a, b, d, e = row * n + k, row * n + k + 1, (row + 1) * n + k, (row + 1) * n + k + 1
            faces += [(a, b, e), (a, e, d)] if row % 2 else [(a, b, d), (b, e, d)]
    return TriangleMesh(np.column_stack([plan, height(*plan.T)]), faces)


SURFACES = {
    "plane": (lambda x, y: 0.4 * x - 0.7 * y, 0.0),
    "sphere": (lambda x, y: np.sqrt(4.0 - x**2 - y**2), 2 / 2.0**2),
    "cylinder": (lambda x, y: np.sqrt(4.0 - x**2), 1 / 2.0**2),
}


def faces_and_connectivity(mesh):
    faces = mesh.faces.astype(np.int32)
    return faces, build_connectivity(faces, mesh.n_vertices)


@pytest.mark.parametrize("surface", SURFACES)
def test_squared_curvatures(surface):
    """κ1² + κ2² is 0 on a plane, 2/R² on a sphere, 1/R² on a cylinder."""
    height, expected = SURFACES[surface]
    mesh = lattice(height)
    faces, connectivity = faces_and_connectivity(mesh)
    curvature = squared_curvature_sums(mesh.vertices, faces, connectivity)
    n_faces_of = np.bincount(mesh.faces.ravel())
    inside = n_faces_of == 6
    np.testing.assert_allclose(curvature[inside], expected, rtol=0.03, atol=1e-9)
    outline = helpers.edges_of(mesh.faces)
    is_outline = np.zeros(mesh.n_vertices, dtype=bool)
    codes = set(map(tuple, outline.tolist()))
    is_outline[[a for a, b in codes if (b, a) not in codes]] = True
    assert (curvature[is_outline] == 0).all()


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_bending_energy_does_not_depend_on_the_unit(scale):
    """On the sphere, every star far from the outline holds 2/R² times its area."""
    mesh = lattice(SURFACES["sphere"][0])
    faces, connectivity = faces_and_connectivity(mesh)
    energy = bending_energy(scale * mesh.vertices, faces, connectivity)
    centre = int(np.argmin(np.abs(mesh.vertices[:, :2]).sum(axis=1)))
    star = mesh.vertices[mesh.faces[(mesh.faces == centre).any(axis=1)]]
    sides = star[:, 1:] - star[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum()
    assert energy[centre] == pytest.approx(0.5 * area, rel=0.03)


def test_flat_terrain_goes_before_a_ridge():
    """On a roof the cost is 0 but for the ridge and the rows beside it, which come last."""
    mesh = synthetic.ridge(n_rows=21, n_columns=31)
    pyramid = analyse(mesh, levels=1, partition="quadric", signal="z")
    rows = pyramid.steps[0].odd // 31
    is_ridge = np.abs(rows - 10) <= 1
    assert is_ridge.any()
    assert not is_ridge[: len(rows) - np.count_nonzero(np.abs(rows - 10) <= 2)].any()


@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.1, 0.2), (1 / 3, -0.7)])
def test_the_papers_partition_takes_a_plane_in_order_of_index(slope):
    """Eq. 36 came out at 2e-15 instead of 0, and rounding decided the order."""
    x, y = np.meshgrid(np.arange(12.0), np.arange(9.0))
    z = slope[0] * x + slope[1] * y + 512.3
    mesh = TriangleMesh.from_grid(z, x=x[0], y=y[:, 0])
    step = analyse(mesh, levels=1, partition="quadric", prediction="GL").steps[0]
    assert (np.diff(step.odd) > 0).all()
