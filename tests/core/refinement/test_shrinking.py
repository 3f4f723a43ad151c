"""TINs that go down to a number of vertices while they are refined."""

import itertools

import numpy as np
import pytest
from helpers_meshes import assert_refined, grid_with_holes, random_delaunay
from hypothesis import given, settings
from hypothesis import strategies as st

from wavelet_core import OptionError, TriangleMesh, analyse, finished, refine, synthetic
from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core._kernels.refine_polygon import MAX_POLYGON
from wavelet_core._kernels.refine_tin import Objective
from wavelet_core.mesh.location import cover_of
from wavelet_core.metrics import surface_errors
from wavelet_core.refinement import finish
from wavelet_core.refinement._tin_state import TinState

ORACLE = "compiled" if HAS_NUMBA else "loops"
ENGINES = [ORACLE, "arrays"]
MESHES = {
    "delaunay": lambda: random_delaunay(420, 1, seed=2, scale=100.0),
    "holes": lambda: grid_with_holes(24, 26, seed=5, hole_share=0.08, scale=100.0),
    "hills": lambda: synthetic.hills(24, 27),
}


def rmse(mesh, original):
    return float(np.sqrt(np.nanmean(surface_errors(mesh, original.vertices) ** 2)))


def state_of(mesh, original, ids):
    """Return a TIN to change by the sum of squares, its heights as they are."""
    cover = cover_of(mesh, original.vertices[:, :2])
    face_of = np.full(original.n_vertices, -1)
    face_of[cover.point] = cover.face
    return TinState(
        original.vertices[:, :2], original.vertices[:, 2:], mesh.vertices[:, 2:],
        mesh.faces.astype(np.int32), ids, face_of, np.zeros(len(ids), dtype=bool),
        Objective(False, True, np.inf, np.inf, 3),
    )  # fmt: skip


def triangulations(corners):
    """Return all triangulations of a polygon, given counter-clockwise."""
    if len(corners) == 2:
        return [[]]
    first, last = corners[0], corners[-1]
    return [
        [(first, corners[k], last), *left, *right]
        for k in range(1, len(corners) - 1)
        for left, right in itertools.product(
            triangulations(corners[: k + 1]), triangulations(corners[k:])
        )
    ]


def cost_without(mesh, v, original):
    """Return by what the squared errors grow at least without a vertex inside, inf if it stays."""
    star = mesh.faces[(mesh.faces == v).any(axis=1)]
    following = {
        face[(k + 1) % 3]: face[(k + 2) % 3] for face in star for k in np.nonzero(face == v)[0]
    }
    ring = [next(iter(following))]
    while len(ring) < len(star):
        ring.append(following.get(ring[-1]))
    if following.get(ring[-1]) != ring[0] or not 3 <= len(ring) <= MAX_POLYGON:
        return np.inf
    kept = mesh.faces[~(mesh.faces == v).any(axis=1)]
    present, least = np.nansum(surface_errors(mesh, original.vertices) ** 2), np.inf
    for faces in triangulations(ring):
        a, b, c = (mesh.vertices[[face[k] for face in faces], :2] for k in range(3))
        u, w = b - a, c - a
        if (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0] <= 1e-9).any():
            continue
        other = TriangleMesh(mesh.vertices, np.vstack([kept, faces]))
        least = min(least, np.nansum(surface_errors(other, original.vertices) ** 2) - present)
    return least


@pytest.mark.parametrize("name", ENGINES)
def test_the_vertex_goes_that_costs_least_in_all_triangulations(name):
    original = synthetic.hills(11, 12)
    pyramid = analyse(original, target_vertices=45)
    mesh, ids = pyramid.mesh(0), pyramid.vertex_ids(0)
    costs = np.array([cost_without(mesh, v, original) for v in range(mesh.n_vertices)])
    with engine(name):
        state = state_of(mesh, original, ids)
        before = state.face_errors().error.sum()
        assert state.shrink_to(mesh.n_vertices - 1) == 1
        gone = np.setdiff1d(np.arange(mesh.n_vertices), state.faces()[0])
    cost = state.face_errors().error.sum() - before
    assert np.isfinite(costs).sum() > 15
    assert cost == pytest.approx(costs.min(), rel=1e-6, abs=1e-9)
    assert costs[gone[0]] == pytest.approx(costs.min(), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("name", ENGINES)
def test_costs_are_those_of_the_stars_as_they_are(name, monkeypatch):
    """What a vertex costs is found once; where a neighbour has gone since, it is found anew."""
    original = MESHES["hills"]()
    pyramid = analyse(original, target_vertices=200)
    lay, n_laid = TinState._lay, []

    def checked(state, polygons):
        anew = state._polygons(polygons.vertex)
        for known, found in zip(polygons, anew, strict=True):
            np.testing.assert_array_equal(known, found)
        n_laid.append(lay(state, polygons))
        return n_laid[-1]

    monkeypatch.setattr(TinState, "_lay", checked)
    with engine(name):
        state = state_of(pyramid.mesh(0), original, pyramid.vertex_ids(0))
        assert state.shrink_to(120) == 80
    assert state.n_vertices == 120
    assert len(n_laid) > 2


@pytest.mark.parametrize("how", [{}, {"keep_points": True}, {"rounds": 2}])
@pytest.mark.parametrize("mesh_name", MESHES)
def test_it_ends_with_as_many_as_asked_for_alike_on_each_engine(mesh_name, how):
    mesh = MESHES[mesh_name]()
    pyramid = analyse(mesh, target_vertices=mesh.n_vertices // 3)
    fine, ids, outcomes = pyramid.mesh(0), pyramid.vertex_ids(0), []
    target = mesh.n_vertices // (5 if mesh_name != "holes" else 3) - 10  # outlines leave 165
    for name in ENGINES:
        with engine(name):
            refined = refine(fine, mesh, ids, target_vertices=target, **how)
        outcomes.append([*(a.tobytes() for a in refined.mesh.vertices), refined.rounds])
    assert outcomes[0] == outcomes[1]
    assert refined.mesh.n_vertices == target
    assert_refined(refined, ids, fine, mesh)
    sizes = [here.n_vertices for here in refined.rounds]
    assert sizes[:2] == [fine.n_vertices, fine.n_vertices]
    assert sizes == sorted(sizes, reverse=True)
    assert sum(here.n_removed for here in refined.rounds) == fine.n_vertices - target


@pytest.mark.parametrize("n_columns", [91, 95, 98])
def test_a_coarse_tin_starts_from_a_finer_level_and_errs_less(n_columns, monkeypatch):
    mesh = synthetic.hills(90, n_columns)
    pyramid = analyse(mesh, target_vertices=mesh.n_vertices // 40)
    shrunk = finished(pyramid, mesh)
    monkeypatch.setattr(finish, "HEAD_START", np.inf)
    straight = finished(pyramid, mesh)
    assert shrunk.mesh.n_vertices == straight.mesh.n_vertices == mesh.n_vertices // 40
    assert shrunk.rounds[0].n_vertices >= 2 * straight.rounds[0].n_vertices
    assert rmse(shrunk.mesh, mesh) < rmse(straight.mesh, mesh)


@settings(max_examples=15, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    n=st.integers(300, 900),
    n_attributes=st.integers(0, 1),
    share=st.sampled_from([20, 40, 80]),
    locks=st.booleans(),
)
def test_any_cloud_goes_down_to_a_valid_tin(seed, n, n_attributes, share, locks):
    mesh = random_delaunay(n, n_attributes, seed=seed, scale=50.0)
    locked = np.random.default_rng(seed).random(n) < (0.01 if locks else 0.0)
    pyramid = analyse(mesh, target_vertices=max(n // share, 6), locked=locked)
    coarse, ids = pyramid.mesh(0), pyramid.vertex_ids(0)
    tin = finished(pyramid, mesh)
    assert tin.mesh.n_vertices == coarse.n_vertices
    assert_refined(tin, ids, coarse, mesh)
    assert np.isin(ids[locked[ids]], tin.vertex_ids).all()


@pytest.mark.parametrize(
    ("share", "analysis"),
    [(4, {}), (40, {"norm": "max"}), (40, {"outline_tolerance": 1.0}), (None, {"max_rms": 1.0})],
)
def test_others_start_from_the_coarsest_level(share, analysis):
    mesh = synthetic.hills(40, 42)
    size = {} if share is None else {"target_vertices": mesh.n_vertices // share}
    pyramid = analyse(mesh, **size, **analysis)
    assert finished(pyramid, mesh).rounds[0].n_vertices == pyramid.n_vertices(0)


def test_rounds_that_are_asked_for_start_from_the_coarsest_level():
    mesh = synthetic.hills(40, 42)
    pyramid = analyse(mesh, target_vertices=50)
    rounds = finished(pyramid, mesh, rounds=3).rounds
    assert [here.n_vertices for here in rounds] == [50] * 5


@pytest.mark.parametrize("rounds", [None, 0, 2, 30])
def test_its_progress_never_goes_back(rounds):
    mesh = synthetic.hills(24, 27)
    pyramid = analyse(mesh, target_vertices=200)
    seen = []
    refine(
        pyramid.mesh(0), mesh, pyramid.vertex_ids(0), target_vertices=90, rounds=rounds,
        progress=lambda fraction: seen.append(fraction) or True,
    )  # fmt: skip
    assert seen == sorted(seen)
    assert len(seen) > 10
    assert seen[-1] <= 1.0


def test_where_locked_vertices_leave_more_it_says_how_many():
    mesh = synthetic.hills(14, 15)
    pyramid = analyse(mesh, target_vertices=90)
    ids = pyramid.vertex_ids(0)
    refined = refine(
        pyramid.mesh(0), mesh, ids, target_vertices=20, locked=np.arange(len(ids)) >= 10
    )
    assert refined.mesh.n_vertices >= len(ids) - 10
    assert refined.rounds[-1].n_vertices == refined.mesh.n_vertices
    np.testing.assert_array_equal(
        np.isin(ids[10:], refined.vertex_ids), np.ones(len(ids) - 10, dtype=bool)
    )


def test_a_target_goes_with_squares_and_no_tolerance():
    mesh = synthetic.hills(14, 15)
    pyramid = analyse(mesh, target_vertices=90)
    given = pyramid.mesh(0), mesh, pyramid.vertex_ids(0)
    with pytest.raises(OptionError, match=r"target_vertices goes with norm 'rms', not 'max'"):
        refine(*given, norm="max", target_vertices=20)
    with pytest.raises(OptionError, match="max_rms and target_vertices do not go together"):
        refine(*given, max_rms=1.0, target_vertices=20)
    with pytest.raises(OptionError, match="max_error and target_vertices do not go together"):
        refine(*given, norm="max", max_error=1.0, target_vertices=20)
    for wrong in (2.5, -1):
        with pytest.raises(OptionError, match="target_vertices is"):
            refine(*given, target_vertices=wrong)
    assert refine(*given, target_vertices=200).mesh.n_vertices == 90
