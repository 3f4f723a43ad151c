"""Vertices taken out within a tolerance: by other triangles, and two for one on a new place."""

import numpy as np
import pytest
from helpers_meshes import assert_refined, edges_of, grid_with_holes, random_delaunay, slow_errors
from hypothesis import given, settings
from hypothesis import strategies as st

from wavelet_core import Cancelled, TriangleMesh, analyse, refine, synthetic
from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core._kernels.half_edges import after
from wavelet_core._kernels.refine_merge import MAX_RIM, count_polygon_points, list_polygons
from wavelet_core._kernels.refine_tin import Objective
from wavelet_core.mesh.location import cover_of
from wavelet_core.refinement._tin_state import TinState

ORACLE = "compiled" if HAS_NUMBA else "loops"
ENGINES = [ORACLE, "arrays"]


def state_of(mesh, original, ids, max_error, locked=None):
    """Return a TIN to change, its heights those of the input."""
    cover = cover_of(mesh, original.vertices[:, :2])
    face_of = np.full(original.n_vertices, -1)
    face_of[cover.point] = cover.face
    locked = np.zeros(len(ids), dtype=bool) if locked is None else locked
    columns = np.hstack([original.vertices[:, 2:], original.attributes])
    return TinState(
        original.vertices[:, :2], columns, columns[ids], mesh.faces.astype(np.int32), ids, face_of,
        locked, Objective(False, False, max_error**2, np.inf, 3),
    )  # fmt: skip


def grid_on(surface, columns, rows):
    """Return a grid whose heights are those of a TIN, 0 outside."""
    x, y = np.meshgrid(np.arange(float(columns)), np.arange(float(rows)))
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    heights = np.nan_to_num(-slow_errors(surface, points)).reshape(x.shape)
    return TriangleMesh.from_grid(heights, np.arange(float(columns)), np.arange(float(rows)))


def ids_of(state):
    slots, _, faces = state.faces()
    return state.tin.point[slots], faces


def beside_the_summit():
    r"""Return a pyramid of stone, and a TIN with a vertex on either side of its summit.

    ::

        C ------- D
        | \     / |
        |  a - b  |      the summit is between a and b
        | /     \ |
        A ------- B
    """
    x, y = np.meshgrid(np.arange(7.0), np.arange(7.0))
    z = 3.0 - np.maximum(np.abs(x - 3), np.abs(y - 3))
    original = TriangleMesh.from_grid(z, np.arange(7.0), np.arange(7.0))
    ids = np.array([0, 6, 42, 48, 7 * 3 + 2, 7 * 3 + 4])
    faces = [[0, 1, 4], [1, 5, 4], [1, 3, 5], [3, 2, 5], [2, 4, 5], [2, 0, 4]]
    return original, TriangleMesh(original.vertices[ids], faces), ids


@pytest.mark.parametrize("name", ENGINES)
def test_two_vertices_beside_a_summit_become_one_on_it(name):
    original, mesh, ids = beside_the_summit()
    with engine(name):
        state = state_of(mesh, original, ids, 1e-6)
        assert (state.thin(), state.thin_by_polygons()) == (0, 0)  # neither can go by itself
        assert state.merge() == 1
        points, faces = ids_of(state)
        assert points.tolist() == [0, 6, 24, 42, 48]
        assert state.n_vertices == 5
        assert sorted(map(sorted, faces.tolist())) == [[0, 1, 2], [0, 2, 3], [1, 2, 4], [2, 3, 4]]
        assert state.face_errors().largest.max() < 1e-12


@pytest.mark.parametrize("name", ENGINES)
def test_an_edge_with_a_locked_end_stays(name):
    original, mesh, ids = beside_the_summit()
    with engine(name):
        for end in (4, 5):
            locked = np.arange(6) == end
            assert state_of(mesh, original, ids, 1e-6, locked).merge() == 0


@pytest.mark.parametrize("name", ENGINES)
def test_no_place_that_breaks_the_tolerance_at_one_point_is_taken(name):
    original, mesh, ids = beside_the_summit()
    vertices = original.vertices.copy()
    vertices[7 * 1 + 3, 2] += 0.5  # far from both ends of the edge
    original = TriangleMesh(vertices, original.faces)
    with engine(name):
        assert state_of(mesh, original, ids, 0.49).merge() == 0
        assert state_of(mesh, original, ids, 0.51).merge() == 1


@pytest.mark.parametrize("name", ENGINES)
def test_two_vertices_of_a_straight_outline_become_one_on_it(name):
    r"""A ridge that runs from (5, 0) of the lower side to the corners of the upper one.

    ::

        F -------------- E
        |  \         /   |
        |     \   /      |
        A --- b - c ---- D      the ridge begins between b and c
    """
    corners = [[0, 0, 0], [5, 0, 3], [10, 0, 0], [10, 4, 0], [0, 4, 0]]
    surface = TriangleMesh(np.array(corners, float), [[0, 1, 4], [1, 3, 4], [1, 2, 3]])
    original = grid_on(surface, 11, 5)
    ids = np.array([0, 4, 6, 10, 54, 44])
    faces = [[0, 1, 5], [1, 4, 5], [1, 2, 4], [2, 3, 4]]
    mesh = TriangleMesh(original.vertices[ids], faces)
    with engine(name):
        state = state_of(mesh, original, ids, 1e-6)
        assert (state.thin(), state.thin_by_polygons()) == (0, 0)
        assert state.merge() == 1
        points, faces = ids_of(state)
    assert points.tolist() == [0, 5, 10, 44, 54]
    assert sorted(map(sorted, faces.tolist())) == [[0, 1, 3], [1, 2, 4], [1, 3, 4]]


@pytest.mark.parametrize("name", ENGINES)
def test_a_vertex_goes_whose_star_no_fan_can_replace(name):
    r"""The folds run in a zigzag, so that no corner is on all of them.

    ::

        c ----- b               c ----- b
       / \     / \             / |    / | \
      /   \   /   \           /  |   /  |  \
     d ---- v ---- a    to   d   |  /   |   a
      \   /   \   /           \  | /    |  /
       \ /     \ /             \ |/     | /
        e ----- f               e ----- f
    """
    a, b, c, d, e, f = [6, 3, 1], [5, 6, 5], [1, 6, 1], [0, 3, 4], [1, 0, -2], [5, 0, 3]
    zigzag = [[0, 1, 5], [1, 4, 5], [1, 2, 4], [2, 3, 4]]
    original = grid_on(TriangleMesh(np.array([a, b, c, d, e, f], float), zigzag), 7, 7)
    ids = np.array([7 * y + x for x, y, _ in (a, b, c, d, e, f)] + [7 * 2 + 3])
    fan = [[k, (k + 1) % 6, 6] for k in range(6)]
    mesh = TriangleMesh(original.vertices[ids], fan)
    with engine(name):
        state = state_of(mesh, original, ids, 1e-6)
        assert state.thin() == 0
        locked = np.arange(7) == 6
        assert state_of(mesh, original, ids, 1e-6, locked).thin_by_polygons() == 0
        assert state.thin_by_polygons() == 1
        points, faces = ids_of(state)
        assert state.face_errors().largest.max() < 1e-12
    as_given = np.argsort(np.argsort(ids[:6]))
    expected = sorted(sorted(as_given[face].tolist()) for face in zigzag)
    assert points.tolist() == sorted(ids[:6].tolist())
    assert sorted(map(sorted, faces.tolist())) == expected


@pytest.mark.parametrize("name", ENGINES)
def test_the_rim_of_an_edge_goes_once_around_its_faces(name):
    mesh = grid_with_holes(12, 13, seed=5, hole_share=0.08, scale=100.0)
    state = state_of(mesh, mesh, np.arange(mesh.n_vertices), 1.0)
    tin = state.tin.mesh
    every = np.arange(len(tin.twin))
    half_edges = np.flatnonzero(tin.twin < every).astype(np.int32)
    counts = np.empty(len(half_edges), dtype=np.int64)
    with engine(name):
        count_polygon_points(0, len(half_edges), half_edges, state.tin, state.points, counts)
        half_edges = half_edges[counts > 0]
        needs = np.empty((len(half_edges), MAX_RIM + 3), dtype=np.int32)
        list_polygons(0, len(half_edges), half_edges, tin, needs)
    n_paths = 0
    corners = [set(face) for face in mesh.faces.tolist()]
    for half_edge, row, count in zip(half_edges, needs, counts[counts > 0], strict=True):
        pair = {int(tin.origin[half_edge]), int(tin.origin[after(half_edge)])}
        rim = [int(v) for v in row[2:] if v >= 0]
        assert set(row[:2].tolist()) == pair
        sides = {frozenset(face - pair) for face in corners if len(face & pair) == 1}
        steps = [frozenset(step) for step in zip(rim, rim[1:] + rim[:1], strict=True)]
        is_path = steps[-1] not in sides
        n_paths += is_path
        inside = sum(state.points.n_points[k] for k, face in enumerate(corners) if pair & face)
        assert inside == count
        assert set(steps[: len(steps) - is_path]) == sides
    assert 0 < n_paths < len(half_edges)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    n=st.integers(40, 200),
    n_attributes=st.integers(0, 2),
    scale=st.sampled_from([1e-3, 1.0, 1e5]),
    tolerance=st.floats(0.02, 1.0),
    by_place=st.booleans(),
    share_locked=st.sampled_from([0.0, 0.1]),
)
def test_any_cloud_keeps_its_tolerance(
    seed, n, n_attributes, scale, tolerance, by_place, share_locked
):
    mesh = random_delaunay(n, n_attributes, seed=seed, scale=scale)
    rng = np.random.default_rng(seed)
    tolerance = tolerance * float(np.ptp(mesh.vertices[:, 2]))
    locked = rng.random(n) < share_locked
    pyramid = analyse(mesh, max_error=tolerance, locked=locked)
    coarse, ids = pyramid.mesh(0), pyramid.vertex_ids(0)
    limits = np.full(n, tolerance)
    if by_place:  # wider than what the coarse TIN needs, here and there
        limits[rng.random(n) < 0.3] *= 3.0
    with engine("arrays"):
        refined = refine(coarse, mesh, ids, norm="max", max_error=limits, locked=locked[ids])
    assert_refined(refined, ids, coarse, mesh)
    errors = np.abs(slow_errors(refined.mesh, mesh.vertices))
    assert (errors <= limits * (1 + 1e-9) + 1e-12 * scale)[np.isfinite(errors)].all()
    np.testing.assert_array_equal(refined.mesh.vertices, mesh.vertices[refined.vertex_ids])
    assert set(np.flatnonzero(locked)) <= set(refined.vertex_ids.tolist())
    sizes = [here.n_vertices for here in refined.rounds]
    assert (np.diff(sizes) <= 0).all()
    assert (
        refined.mesh.n_vertices
        == sizes[-1]
        == sizes[0] - sum(here.n_removed for here in refined.rounds)
    )


def test_edges_between_locked_vertices_stay_within_a_tolerance():
    mesh = synthetic.hills(24, 27)
    grid = np.arange(mesh.n_vertices).reshape(24, 27)
    locked = np.zeros(mesh.n_vertices, dtype=bool)
    locked[grid[11]] = True  # a breakline along a row
    pyramid = analyse(mesh, max_error=3.0, locked=locked)
    ids = pyramid.vertex_ids(0)
    refined = refine(pyramid.mesh(0), mesh, ids, norm="max", max_error=3.0, locked=locked[ids])
    assert refined.mesh.n_vertices < len(ids)
    kept = np.searchsorted(refined.vertex_ids, grid[11])
    np.testing.assert_array_equal(refined.vertex_ids[kept], grid[11])
    edges = {tuple(sorted(pair)) for pair in edges_of(refined.mesh.faces).tolist()}
    assert {tuple(sorted(pair)) for pair in zip(kept[1:], kept[:-1], strict=True)} <= edges


def test_fewer_vertices_than_collapses_and_moves_leave():
    """What is gained by the two steps, on a surface whose collapses alone left 171 vertices."""
    mesh = synthetic.hills(60, 60)
    pyramid = analyse(mesh, max_error=2.0)
    coarse, ids = pyramid.mesh(0), pyramid.vertex_ids(0)
    refined = refine(coarse, mesh, ids, norm="max", max_error=2.0)
    assert refined.mesh.n_vertices < 0.9 * 171


def test_it_can_be_cancelled_between_its_steps():
    mesh = synthetic.hills(24, 27)
    pyramid = analyse(mesh, max_error=3.0)
    calls = []
    refine(
        pyramid.mesh(0), mesh, pyramid.vertex_ids(0), norm="max", max_error=3.0, rounds=2,
        progress=lambda fraction: calls.append(fraction) or True,
    )  # fmt: skip
    assert calls == sorted(calls)
    assert len(calls) >= 6
    for last in range(len(calls)):
        left = iter(range(last))
        with pytest.raises(Cancelled):
            refine(
                pyramid.mesh(0), mesh, pyramid.vertex_ids(0), norm="max", max_error=3.0, rounds=2,
                progress=lambda fraction, left=left: next(left, None) is not None,
            )  # fmt: skip
