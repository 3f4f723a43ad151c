"""Small meshes worked by hand, each named for the rule of collapse that it pins (Fig. 3).

The vertices under test are the only candidates, in the order given, and each would go onto its
nearest neighbour, so that a rule alone decides. The target that a rule forbids is the nearest.
"""

import numpy as np
import pytest
from helpers_meshes import grid_with_holes, random_delaunay, tube

from wavelet_core import TriangleMesh, analyse
from wavelet_core.lifting.signal import Normalisation, height_weights
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.partition.orderings import LevelView, _label

BOTH_SIGNALS = pytest.mark.parametrize("signal", ["z", "xyz"])


def collapses(mesh, candidates, signal, locked=()):
    """Return {odd: target} of one pass over ``candidates``."""
    is_locked = np.zeros(mesh.n_vertices, dtype=bool)
    is_locked[list(locked)] = True
    faces = mesh.faces.astype(np.int32)
    view = LevelView(
        faces=faces,
        points=mesh.vertices,
        plan=mesh.vertices[:, :2].copy(),
        connectivity=build_connectivity(faces, mesh.n_vertices),
        locked=is_locked,
        in_plan=signal == "z",
    )
    order = np.array(candidates, dtype=np.int64)
    split = _label(view, order, mesh.vertices, np.empty((0, 0)), mesh.n_vertices)
    return dict(zip(split.odd.tolist(), split.target.tolist(), strict=True))


def flat(plan, faces):
    """Return a mesh at z = 0."""
    plan = np.asarray(plan, dtype=float)
    return TriangleMesh(np.column_stack([plan, np.zeros(len(plan))]), faces)


def ring_around(centre, ring):
    """Return the mesh of vertex 0 at ``centre`` and a closed ring, vertices 1 to n, around it."""
    n = len(ring)
    return flat([centre, *ring], [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)])


# --- flip -------------------------------------------------------------------------------------


@BOTH_SIGNALS
@pytest.mark.parametrize("turn", range(4))
def test_flip_a_dart_closes_from_its_notch_not_from_a_wing(signal, turn):
    r"""From the near wing the new face over the notch would be upside down.

    ::

        tip .
            |\  .
            | \     .
            |  v  notch  .
            | / .    .     .
          wing           .    . wing
    """
    ring = [(-2.0, 3.0), (-0.4, -0.2), (0.0, 0.0), (2.0, -1.0)]
    names = ["tip", "near wing", "notch", "far wing"]
    mesh = ring_around((-0.7, 0.6), ring[turn:] + ring[:turn])
    nearest = np.argsort(np.linalg.norm(mesh.vertices[1:] - mesh.vertices[0], axis=1))
    names = names[turn:] + names[:turn]
    assert [names[k] for k in nearest[:2]] == ["near wing", "notch"]
    assert names[collapses(mesh, [0], signal)[0] - 1] == "notch"


def pinwheel(twist):
    """Return three blades around vertex 0; the notches lag the tips by ``twist`` degrees."""
    ring = []
    for k in range(3):
        tip, notch = np.radians(120 * k), np.radians(120 * k + twist)
        ring += [(3 * np.cos(tip), 3 * np.sin(tip)), (0.5 * np.cos(notch), 0.5 * np.sin(notch))]
    return ring_around((0.0, 0.0), ring)


@BOTH_SIGNALS
def test_flip_a_ring_that_none_of_its_corners_overlooks_stays(signal):
    assert collapses(pinwheel(twist=20), [0], signal) == {}
    assert collapses(pinwheel(twist=40), [0], signal)[0] in (2, 4, 6)


@BOTH_SIGNALS
def test_flip_a_new_face_without_area_counts_as_flipped(signal):
    r"""Onto 1, vertex 0 would leave the face 1-3-4, whose corners lie on one line.

    ::

        3 .
        |\   .
        4 \     .
        | \ \      2
        |  0   .
        | / .
        1
    """
    mesh = ring_around((-0.7, -0.8), [(-1, -1), (2, 0), (-1, 1), (-1, 0)])
    assert collapses(mesh, [0], signal) == {0: 4}


# --- boundary ---------------------------------------------------------------------------------


def strip(bend=0.0):
    r"""Return two rows of three vertices; ``bend`` lowers vertex 1 out of the straight outline.

    ::

        3---4---5
        | / | / |
        0---1---2
    """
    plan = [(0, 0), (1, -bend), (2, 0), (0, 1), (1, 1), (2, 1)]
    return flat(plan, [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)])


@BOTH_SIGNALS
def test_boundary_goes_along_the_outline_never_onto_the_interior(signal):
    r"""Vertex 4 is ten times nearer to 1 than 0 and 2 are.

    ::

        6---7---8
        3---4---5
        0---1---2
    """
    x, y = np.arange(3.0), 0.1 * np.arange(3.0)
    mesh = TriangleMesh.from_grid(np.zeros((3, 3)), x=x, y=y)
    assert collapses(mesh, [1], signal) == {1: 0}


@pytest.mark.parametrize("bend", [0.5, -0.5, 1e-4, -1e-4])
def test_boundary_a_bend_of_the_outline_stays_in_a_tin(bend):
    assert collapses(strip(bend), [1], "z") == {}
    assert collapses(strip(bend), [1], "xyz") == {1: 0}


def test_boundary_a_crack_is_not_straight():
    r"""1, 2 and 0 lie on one line, but the outline turns back at 0.

    ::

            3
          / | \ \
        5---0---1  \       0 is joined to 2 along the lower lip of the crack, to 1 along the upper
          \ | \______2
            4-----'
    """
    plan = [(0, 0), (1, 0), (2, 0), (0, 1), (0, -1), (-1, 0)]
    mesh = flat(plan, [(0, 1, 3), (0, 3, 5), (0, 5, 4), (0, 4, 2)])
    assert collapses(mesh, [0], "z") == {}


@BOTH_SIGNALS
def test_boundary_an_interior_vertex_may_go_onto_the_outline(signal):
    mesh = ring_around((0.1, 0.0), [(1, 0), (0, 1), (-1, 0), (0, -1)])
    assert collapses(mesh, [0], signal) == {0: 1}


def test_boundary_of_holes_and_outline_stay_as_they_are():
    mesh = grid_with_holes(14, 16, seed=4, hole_share=0.08)
    area = mesh.plan_areas.sum()
    pyramid = analyse(mesh, levels=24, partition="quadric", signal="z")
    assert pyramid.n_levels > 3
    for level in range(pyramid.n_levels):
        assert pyramid.mesh(level).plan_areas.sum() == pytest.approx(area, rel=1e-12)


# --- corner -----------------------------------------------------------------------------------


@BOTH_SIGNALS
def test_corner_a_vertex_with_one_face_stays(signal):
    mesh = strip()
    corners = [v for v in range(6) if (mesh.faces == v).sum() == 1]
    assert corners == [2, 3]
    assert collapses(mesh, corners, signal) == {}


@BOTH_SIGNALS
def test_corner_a_single_triangle_has_no_level(signal):
    mesh = flat([(0, 0), (1, 0), (0, 1)], [(0, 1, 2)])
    assert collapses(mesh, [0, 1, 2], signal) == {}
    assert analyse(mesh, levels=3, signal=signal).n_levels == 0


# --- lock -------------------------------------------------------------------------------------


@BOTH_SIGNALS
def test_lock_a_locked_vertex_stays_and_may_be_a_target(signal):
    assert collapses(strip(), [1, 4], signal) == {1: 0}
    assert collapses(strip(), [1, 4], signal, locked=[1]) == {4: 3}
    assert collapses(strip(), [1, 4], signal, locked=[0, 4]) == {1: 0}


@BOTH_SIGNALS
def test_lock_a_vertex_among_locked_ones_stays(signal):
    """Its detail would have nowhere to go, and the integral of the signal would change."""
    assert collapses(strip(), [1], signal, locked=[0, 2, 4, 5]) == {}
    assert collapses(strip(), [1], signal, locked=[0, 2, 4]) == {1: 0}


# --- one ring ---------------------------------------------------------------------------------


@BOTH_SIGNALS
def test_one_ring_neighbours_of_an_odd_vertex_become_even(signal):
    assert collapses(strip(), [1, 4], signal) == {1: 0}
    assert collapses(strip(), [4, 1], signal) == {4: 3}


# --- pinch, isolated --------------------------------------------------------------------------


@BOTH_SIGNALS
def test_pinch_where_two_fans_touch_stays(signal):
    r"""Vertex 0 lies straight on the outline of both fans.

    ::

        1---0---4
         \ / \ /
          2   3
    """
    mesh = flat([(0, 0), (-2, 0), (-1, -1), (1, -1), (2, 0)], [(0, 1, 2), (0, 3, 4)])
    assert collapses(mesh, range(5), signal) == {}


@BOTH_SIGNALS
def test_isolated_vertices_stay_on_all_levels(signal):
    x, y = np.meshgrid(np.arange(5.0), np.arange(5.0))
    grid = TriangleMesh.from_grid(x * y, x=np.arange(5.0), y=np.arange(5.0))
    vertices = np.vstack([grid.vertices, [[2.5, 9.0, 3.0]]])
    mesh = TriangleMesh(vertices, grid.faces)
    pyramid = analyse(mesh, levels=9, partition="quadric", signal=signal)
    assert pyramid.n_levels > 0
    assert pyramid.vertex_ids(0)[-1] == 25
    np.testing.assert_array_equal(pyramid.mesh(0).vertices[-1], [2.5, 9.0, 3.0])


# --- link -------------------------------------------------------------------------------------


def test_link_a_triangular_mouth_is_not_closed():
    """Two vertices of the mouth share the third, and no face joins them: a weld, back to back."""
    assert collapses(tube(n_sides=3, n_rings=2), [0], "xyz") == {}
    assert collapses(tube(n_sides=4, n_rings=2), [0], "xyz")[0] in (1, 3)


def test_link_edges_made_earlier_in_the_pass_count():
    """Once 0 has gone, 1, 2 and 3 are a triangular mouth; the star of 2 does not tell."""
    mesh = tube(n_sides=4, n_rings=2)
    assert collapses(mesh, [2], "xyz")[2] in (1, 3)
    assert collapses(mesh, [0, 2], "xyz").keys() == {0}


@pytest.mark.parametrize("side", range(3))
def test_link_the_waist_of_a_triangular_tube_is_not_pinched(side):
    """An interior vertex may slide along the tube, not round its waist, which bounds no face."""
    waist = 3 + side
    mesh = tube(n_sides=3, n_rings=3, radius=0.2)
    assert collapses(mesh, [waist], "xyz")[waist] not in {3, 4, 5}


def test_link_a_tetrahedron_is_not_flattened():
    """The one face left over the hole would lie back to back on the face that is there."""
    vertices = [(0.1, 0.1, 1), (0, 0, 0), (1, 0, 0), (0, 1, 0)]
    mesh = TriangleMesh(vertices, [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)])
    assert collapses(mesh, [0], "xyz") == {}


def test_link_two_apexes_of_a_bipyramid_do_not_both_go():
    """The first collapse leaves a tetrahedron, which the second one would flatten."""
    vertices = [(0.1, 0.1, 1), (0.1, 0.1, -1), (0, 0, 0), (1, 0, 0), (0, 1, 0)]
    upper = [(0, 2, 3), (0, 3, 4), (0, 4, 2)]
    lower = [(1, 3, 2), (1, 4, 3), (1, 2, 4)]
    mesh = TriangleMesh(vertices, upper + lower)
    assert collapses(mesh, [0, 1], "xyz").keys() == {0}


def test_columns_count_by_their_range_and_weight():
    """Ranges of 10, 20, 5 and of an attribute 4, which counts for three times as much."""
    vertices = [[0.0, 0.0, 1.0], [10.0, 0.0, 6.0], [0.0, 20.0, 1.0]]
    mesh = TriangleMesh(vertices, [[0, 1, 2]], [[2.0], [2.0], [6.0]], ["a"])
    normal = Normalisation(mesh, [3.0])
    points, plan = normal.points(np.column_stack([mesh.vertices, mesh.attributes]), None)
    assert plan.tolist() == [[-5.0, -10.0], [5.0, -10.0], [-5.0, 10.0]]
    assert points.tolist() == [
        [-0.5, -0.5, -0.5, -1.5], [0.5, -0.5, 0.5, -1.5], [-0.5, 0.5, -0.5, 1.5],
    ]  # fmt: skip
    assert normal.height_weights().tolist() == [1.0, 3.75]  # an error of 4 as one of z of 15
    assert height_weights(np.array([0.0, 4.0]), [3.0]).tolist() == [1.0, 0.75]


@pytest.mark.parametrize("partition", ["surface", "colouring"])
def test_where_all_three_corners_are_locked_the_free_ring_takes_the_update(partition):
    """Else the detail would reach nobody, and the mean of the level would change."""
    mesh = random_delaunay(300, seed=6)
    locked = np.random.default_rng(1).random(mesh.n_vertices) < 0.6
    pyramid = analyse(mesh, levels=1, locked=locked, partition=partition, prediction="barycentric")
    step, ids = pyramid.steps[0], pyramid.vertex_ids(0)
    faces, prediction = pyramid.mesh(1).faces, pyramid.filters(0).prediction
    n_stuck = 0
    for row, odd in enumerate(step.odd):
        columns = prediction.indices[slice(*prediction.indptr[row : row + 2])]
        ring = np.setdiff1d(faces[(faces == odd).any(axis=1)], [odd])
        free = set(ring[~locked[ring]].tolist())
        used = set(ids[columns].tolist())
        if locked[ids[columns[:3]]].all():
            n_stuck += 1
            assert used - set(ids[columns[:3]].tolist()) == free
    assert n_stuck > 3
