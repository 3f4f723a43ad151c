"""Refined TINs: valid, covering the same, better at all input points, the same on every engine."""

import itertools

import numpy as np
import pytest
from helpers_meshes import (
    assert_refined,
    edges_of,
    grid_with_holes,
    random_delaunay,
    slow_errors,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from wavelet_core import Cancelled, MeshError, OptionError, TriangleMesh, analyse, refine, synthetic
from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core._threads import THREADS_VARIABLE
from wavelet_core.metrics import surface_errors
from wavelet_core.refinement._tin_state import TinState
from wavelet_core.refinement.finish import finished_within

ORACLE = "compiled" if HAS_NUMBA else "loops"

MESHES = {
    "delaunay": lambda: random_delaunay(420, 1, seed=2, scale=100.0),
    "holes": lambda: grid_with_holes(24, 26, seed=5, hole_share=0.08, scale=100.0),
    "hills": lambda: synthetic.hills(24, 27),
}
#: What `refine` is asked for, and the analysis that it starts from.
TASKS = {
    "rms": ({}, {}),
    "kept points": ({"keep_points": True}, {}),
    "largest error": ({"norm": "max"}, {"norm": "max"}),
    "tolerance": ({"norm": "max", "max_error": 2.0}, {"max_error": 2.0}),
    "mean tolerance": ({"max_rms": 1.5}, {"max_rms": 1.5}),
}


def coarse_and_refined(mesh, task, locked=None, **more):
    """Return the coarsest level of an analysis, and it refined."""
    options, analysis = TASKS[task]
    size = {} if {"max_error", "max_rms"} & set(analysis) else {"target_vertices": len_of(mesh)}
    pyramid = analyse(mesh, locked=locked, **size, **analysis)
    ids = pyramid.vertex_ids(0)
    mask = None if locked is None else locked[ids]
    coarse = pyramid.mesh(0)
    return coarse, ids, refine(coarse, mesh, ids, locked=mask, **options, **more)


def len_of(mesh):
    return mesh.n_vertices // 7


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("mesh_name", MESHES)
def test_a_refined_tin_is_valid_and_no_worse(mesh_name, task):
    mesh = MESHES[mesh_name]()
    coarse, ids, refined = coarse_and_refined(mesh, task)
    assert_refined(refined, ids, coarse, mesh)
    errors = slow_errors(refined.mesh, mesh.vertices)
    covered = errors[np.isfinite(errors)]
    last, first = refined.rounds[-1], refined.rounds[0]
    np.testing.assert_allclose(np.sqrt(np.mean(covered**2)), last.rmse, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(np.abs(covered).max(), last.max_error, rtol=1e-6, atol=1e-9)
    options = TASKS[task][0]
    if "max_error" in options:
        assert np.abs(covered).max() <= options["max_error"] * (1 + 1e-9)
        assert refined.mesh.n_vertices < coarse.n_vertices or mesh_name == "holes"
    elif "max_rms" in options:
        assert last.rmse <= options["max_rms"]
        assert refined.mesh.n_vertices < coarse.n_vertices or mesh_name == "holes"
    else:
        assert refined.mesh.n_vertices == coarse.n_vertices
        assert last.max_error <= first.max_error or options.get("norm") != "max"
        if not mesh.attribute_names:
            assert last.rmse < first.rmse
    if task != "rms" and task != "mean tolerance":
        np.testing.assert_array_equal(refined.mesh.vertices, mesh.vertices[refined.vertex_ids])


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("mesh_name", MESHES)
def test_engines_give_the_same_bytes(mesh_name, task):
    mesh = MESHES[mesh_name]()
    outcomes = []
    for name in (ORACLE, "arrays"):
        with engine(name):
            refined = coarse_and_refined(mesh, task)[2]
            arrays = (refined.mesh.vertices, refined.mesh.attributes, refined.mesh.faces)
            outcomes.append([*(a.tobytes() for a in arrays), refined.rounds])
    assert outcomes[0] == outcomes[1]


@pytest.mark.parametrize("task", ["rms", "kept points", "largest error"])
@pytest.mark.parametrize("mesh_name", MESHES)
def test_coarse_tins_get_more_rounds_alike_on_each_engine(mesh_name, task):
    mesh = MESHES[mesh_name]()
    options, analysis = TASKS[task]
    pyramid = analyse(mesh, target_vertices=mesh.n_vertices // 20, **analysis)
    coarse, ids, outcomes = pyramid.mesh(0), pyramid.vertex_ids(0), []
    for name in (ORACLE, "arrays"):
        with engine(name):
            refined = refine(coarse, mesh, ids, **options)
            short = refine(coarse, mesh, ids, rounds=3, **options)
        outcomes.append((refined.mesh.vertices.tobytes(), refined.mesh.faces.tobytes()))
        assert len(refined.rounds) <= 12  # as given, 10 of them, and the fit
        assert [here.rmse for here in refined.rounds[:3]] == [h.rmse for h in short.rounds[:3]]
    assert outcomes[0] == outcomes[1]


@pytest.mark.parametrize("mesh_name", MESHES)
def test_what_is_known_of_a_tin_is_what_it_is_found_to_be_anew(mesh_name, monkeypatch):
    """Errors and gains are worked out where something has changed; elsewhere they have to hold."""
    change = TinState._change_around

    def judged(state, vertices):
        change(state, vertices)
        anew = state.snapshot()
        for tin in (state, anew):
            tin._judge_edges()
        np.testing.assert_array_equal(state._known.gains, anew._known.gains)
        for known, found in zip(state.face_errors(), anew.face_errors(), strict=True):
            np.testing.assert_array_equal(known, found)
        n_judged.append(1)

    monkeypatch.setattr(TinState, "_change_around", judged)
    for task in TASKS:
        n_judged = []
        coarse_and_refined(MESHES[mesh_name](), task)
        assert n_judged or task not in ("tolerance", "mean tolerance")


@pytest.mark.parametrize("mesh_name", MESHES)
def test_a_tolerance_for_each_point_is_kept_and_used(mesh_name):
    mesh = MESHES[mesh_name]()
    x = mesh.vertices[:, 0]
    limits = np.where(x < np.median(x), 0.5, 4.0) * (0.2 if mesh_name == "hills" else 1.0)
    pyramid = analyse(mesh, norm="max", max_error=float(limits.max()), update="none")
    outcomes = []
    for name in (ORACLE, "arrays"):
        with engine(name):
            tin = finished_within(pyramid, mesh, limits)
            outcomes.append((tin.mesh.vertices.tobytes(), tin.mesh.faces.tobytes(), tin.rounds))
    assert outcomes[0] == outcomes[1]
    errors = np.abs(surface_errors(tin.mesh, mesh.vertices))
    assert (errors[np.isfinite(errors)] <= limits[np.isfinite(errors)] * (1 + 1e-12)).all()
    assert tin.mesh.n_vertices < finished_within(pyramid, mesh, limits, rounds=0).mesh.n_vertices
    strict = refine(
        pyramid.mesh(pyramid.n_levels), mesh, np.arange(mesh.n_vertices), norm="max",
        max_error=float(limits.min()),
    )  # fmt: skip
    assert tin.mesh.n_vertices < strict.mesh.n_vertices


def test_plain_loops_agree_with_the_array_engine():
    mesh = synthetic.hills(13, 14)
    pyramid = analyse(mesh, target_vertices=30)
    outcomes = []
    for name in ("loops", "arrays"):
        with engine(name):
            refined = refine(pyramid.mesh(0), mesh, pyramid.vertex_ids(0), rounds=3)
            outcomes.append((refined.mesh.vertices.tobytes(), refined.mesh.faces.tobytes()))
    assert outcomes[0] == outcomes[1]


def test_threads_do_not_matter(monkeypatch):
    mesh = synthetic.hills(150, 150)
    pyramid = analyse(mesh, target_vertices=6000)
    outcomes = []
    for threads in ("1", "3"):
        monkeypatch.setenv(THREADS_VARIABLE, threads)
        refined = refine(pyramid.mesh(0), mesh, pyramid.vertex_ids(0), rounds=3)
        outcomes.append((refined.mesh.vertices.tobytes(), refined.mesh.faces.tobytes()))
    assert outcomes[0] == outcomes[1]


def test_locked_vertices_and_the_edges_between_them_stay():
    mesh = MESHES["hills"]()
    grid = np.arange(mesh.n_vertices).reshape(24, 27)
    locked = np.zeros(mesh.n_vertices, dtype=bool)
    locked[grid[11]] = True  # a breakline along a row
    _, _, refined = coarse_and_refined(mesh, "rms", locked=locked)
    position = {int(v): k for k, v in enumerate(refined.vertex_ids)}
    assert set(grid[11]) <= set(position)
    kept = [position[int(v)] for v in grid[11]]
    np.testing.assert_array_equal(refined.mesh.vertices[kept], mesh.vertices[grid[11]])
    edges = {tuple(sorted(pair)) for pair in edges_of(refined.mesh.faces).tolist()}
    for a, b in itertools.pairwise(kept):
        assert tuple(sorted((a, b))) in edges


def test_a_long_edge_across_a_valley_is_turned():
    r"""Of two triangles over a valley, the edge comes to lie along its floor.

    ::

        10 --- 0        10 --- 0
        |   /  |   to   |  \\   |
        0 --- 10        0 --- 10      (the floor runs from 0 to 0)
    """
    x, y = np.meshgrid(np.arange(5.0), np.arange(5.0))
    z = 2.5 * np.abs(x + y - 4.0) / 1.0
    original = TriangleMesh.from_grid(z, np.arange(5.0), np.arange(5.0))
    ids = np.array([0, 4, 20, 24])
    wrong = TriangleMesh(original.vertices[ids], [[0, 1, 3], [0, 3, 2]])
    refined = refine(wrong, original, ids, rounds=1)
    assert refined.rounds[-1].rmse < 1e-9
    assert refined.rounds[1].n_flipped == 1
    assert sorted(map(sorted, refined.mesh.faces.tolist())) == [[0, 1, 2], [1, 2, 3]]


def test_a_vertex_beside_a_summit_moves_onto_it():
    x, y = np.meshgrid(np.arange(7.0), np.arange(7.0))
    z = 3.0 - np.maximum(np.abs(x - 3), np.abs(y - 3))  # a pyramid of stone
    original = TriangleMesh.from_grid(z, np.arange(7.0), np.arange(7.0))
    ids = np.array([0, 6, 42, 48, 7 * 2 + 3])  # four corners, and one node beside the summit
    fan = [[0, 1, 4], [1, 3, 4], [3, 2, 4], [2, 0, 4]]
    refined = refine(TriangleMesh(original.vertices[ids], fan), original, ids, rounds=1)
    assert 7 * 3 + 3 in refined.vertex_ids
    assert refined.rounds[1].n_moved == 1
    assert refined.rounds[-1].rmse < 1e-9


def test_a_vertex_on_a_straight_outline_moves_along_it():
    x, _y = np.meshgrid(np.arange(9.0), np.arange(5.0))
    original = TriangleMesh.from_grid(np.abs(x - 5), np.arange(9.0), np.arange(5.0))
    ids = np.array([0, 4, 8, 36, 40, 44])
    faces = [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]]
    refined = refine(TriangleMesh(original.vertices[ids], faces), original, ids, rounds=2)
    assert {5, 41} <= set(refined.vertex_ids.tolist())
    assert refined.rounds[-1].rmse < 1e-9


def test_a_useless_vertex_is_taken_out_for_a_useful_one():
    """A plain with a cone on it, and a regular grid of vertices."""
    x, y = np.meshgrid(np.arange(31.0), np.arange(31.0))
    z = np.maximum(6.0 - np.hypot(x - 22.5, y - 22.5), 0.0)
    original = TriangleMesh.from_grid(z, np.arange(31.0), np.arange(31.0))
    ids = (31 * np.arange(0, 31, 5)[:, None] + np.arange(0, 31, 5)).ravel()
    mesh = TriangleMesh.from_points(original.vertices[ids])
    refined = refine(mesh, original, ids, rounds=8)
    assert sum(here.n_replaced for here in refined.rounds) >= 5
    near = [
        np.count_nonzero(np.hypot(*(m.vertices[:, :2].T - 22.5)) < 7) for m in (mesh, refined.mesh)
    ]
    assert near[1] >= near[0] + 5
    assert refined.rounds[-1].rmse < 0.5 * refined.rounds[0].rmse


def test_a_tin_without_error_stays_as_it_is():
    mesh = synthetic.plane(9, 11)
    pyramid = analyse(mesh, target_vertices=20)
    refined = refine(pyramid.mesh(0), mesh, pyramid.vertex_ids(0))
    assert refined.rounds[-1].max_error < 1e-9


def test_vertices_without_triangles_are_kept():
    z = np.random.default_rng(3).normal(size=(12, 12))
    valid = np.ones((12, 12), bool)
    valid[5, :], valid[:, 5] = False, False
    valid[5, 5] = True  # alone
    original = TriangleMesh.from_grid(z, np.arange(12.0), np.arange(12.0), valid)
    pyramid = analyse(original, target_vertices=50)
    refined = refine(pyramid.mesh(0), original, pyramid.vertex_ids(0))
    lone = np.flatnonzero(~np.isin(np.arange(original.n_vertices), original.faces))
    assert len(lone) == 1
    assert lone[0] in refined.vertex_ids


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    n=st.integers(30, 160),
    share=st.integers(3, 8),
    n_attributes=st.integers(0, 2),
    scale=st.sampled_from([1e-3, 1.0, 1e5]),
    task=st.sampled_from(["rms", "kept points", "largest error"]),
)
def test_any_cloud_gives_a_valid_tin(seed, n, share, n_attributes, scale, task):
    mesh = random_delaunay(n, n_attributes, seed=seed, scale=scale)
    options, analysis = TASKS[task]
    pyramid = analyse(mesh, target_vertices=max(n // share, 4), **analysis)
    coarse, ids = pyramid.mesh(0), pyramid.vertex_ids(0)
    with engine("arrays"):
        refined = refine(coarse, mesh, ids, **options)
    assert_refined(refined, ids, coarse, mesh)


def test_more_weight_on_an_attribute_lowers_its_error():
    mesh = random_delaunay(500, 1, seed=9, scale=100.0)
    pyramid = analyse(mesh, target_vertices=60)
    rmse = []
    for weight in (0.01, 100.0):
        refined = refine(
            pyramid.mesh(0), mesh, pyramid.vertex_ids(0), attribute_weights=[weight]
        ).mesh
        as_height = TriangleMesh(
            np.column_stack([refined.vertices[:, :2], refined.attributes]), refined.faces
        )
        points = np.column_stack([mesh.vertices[:, :2], mesh.attributes])
        rmse.append(np.sqrt(np.nanmean(surface_errors(as_height, points) ** 2)))
    assert rmse[1] < 0.95 * rmse[0]


def test_cancelling_stops_it():
    mesh = MESHES["hills"]()
    pyramid = analyse(mesh, target_vertices=80)
    with pytest.raises(Cancelled):
        refine(pyramid.mesh(0), mesh, pyramid.vertex_ids(0), progress=lambda fraction: False)


def test_tolerances_are_one_or_one_for_each_point():
    mesh = synthetic.hills(8, 8)
    for limits in (np.ones(63), np.full(64, -1.0), np.ones((8, 8))):
        with pytest.raises(OptionError, match="max_error"):
            refine(mesh, mesh, np.arange(64), norm="max", max_error=limits)


def test_bad_input_is_refused():
    mesh = MESHES["hills"]()
    pyramid = analyse(mesh, target_vertices=80)
    coarse, ids = pyramid.mesh(0), pyramid.vertex_ids(0)
    for wrong in (ids[:-1], ids.astype(float), ids + mesh.n_vertices, ids[::-1]):
        with pytest.raises(OptionError, match="vertex_ids"):
            refine(coarse, mesh, wrong)
    with pytest.raises(OptionError, match="norm"):
        refine(coarse, mesh, ids, max_error=1.0)
    with pytest.raises(OptionError, match="norm"):
        refine(coarse, mesh, ids, norm="max", max_rms=1.0)
    with pytest.raises(OptionError, match="rounds"):
        refine(coarse, mesh, ids, rounds=-1)
    with pytest.raises(OptionError, match=r"rounds is 1\.5; give a whole number"):
        refine(coarse, mesh, ids, rounds=1.5)
    with pytest.raises(OptionError, match="locked"):
        refine(coarse, mesh, ids, locked=[True])
    with pytest.raises(OptionError, match="attributes"):
        refine(coarse, TriangleMesh(mesh.vertices, mesh.faces, mesh.vertices[:, 2], ("a",)), ids)
    flipped = coarse.faces.copy()
    flipped[0] = flipped[0, ::-1]
    with pytest.raises(MeshError, match="only a TIN"):
        refine(TriangleMesh(coarse.vertices, flipped), mesh, ids)


def test_a_norm_that_there_is_not_is_refused_and_capitals_are_taken():
    """The first was a KeyError, and so was the second."""
    mesh = MESHES["hills"]()
    pyramid = analyse(mesh, target_vertices=80)
    coarse, ids = pyramid.mesh(0), pyramid.vertex_ids(0)
    with pytest.raises(OptionError, match="norm is 'median'; give one of rms, max"):
        refine(coarse, mesh, ids, norm="median")
    capitals, plain = (refine(coarse, mesh, ids, norm=n, rounds=1) for n in ("MAX", "max"))
    assert capitals.mesh == plain.mesh


def test_a_mean_error_beyond_all_measure_is_no_overflow():
    mesh = MESHES["hills"]()
    pyramid = analyse(mesh, target_vertices=80)
    refined = refine(pyramid.mesh(0), mesh, pyramid.vertex_ids(0), max_rms=1e200)
    assert refined.mesh.n_vertices == 4


def test_vertices_without_a_face_are_among_those_of_a_mean_tolerance():
    """The analysis counted them, the refinement did not, and left room that the tolerance had."""
    mesh = MESHES["hills"]()
    aside = np.column_stack([np.arange(400.0), np.full(400, -1e3), np.zeros(400)])
    both = TriangleMesh(np.vstack([mesh.vertices, aside]), mesh.faces)
    pyramid = analyse(both, max_rms=1.5)
    refined = refine(pyramid.mesh(0), both, pyramid.vertex_ids(0), max_rms=1.5)
    assert refined.mesh.n_vertices < pyramid.n_vertices(0)
    assert refined.rounds[-1].rmse <= 1.5


@pytest.mark.parametrize("name", [ORACLE, "arrays"])
def test_a_tolerance_of_nothing_somewhere_is_no_overflow(name):
    mesh = synthetic.hills(12, 12)
    limits = np.where(mesh.vertices[:, 0] > np.median(mesh.vertices[:, 0]), 0.0, 3.0)
    pyramid = analyse(mesh, norm="max", max_error=3.0)
    with engine(name):
        tin = finished_within(pyramid, mesh, limits)
    assert (np.abs(surface_errors(tin.mesh, mesh.vertices)) <= limits + 1e-12).all()
