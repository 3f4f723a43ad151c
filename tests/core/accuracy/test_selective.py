"""A TIN out of a pyramid that is fine here and coarse there: valid, and within its tolerance."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from wavelet_core import Cancelled, OptionError, TriangleMesh, analyse, synthetic
from wavelet_core.accuracy.between_levels import _thinned_level, mesh_of_accuracy
from wavelet_core.accuracy.selective import _history_of, mesh_within
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.mesh.location import surface_errors
from wavelet_core.refinement.finish import finished_within

DESIGNS = {
    "surface": {},
    "surface, heights of the input": {"update": "none"},
    "largest error": {"norm": "max", "max_error": 6.0},
    "GLMN": {"partition": "quadric", "levels": 6},
    "random, plane": {"partition": "random", "prediction": "plane", "levels": 5},
    "colouring": {"partition": "colouring", "levels": 5},
}


def require_valid_tin(mesh: TriangleMesh, original: TriangleMesh) -> None:
    build_connectivity(mesh.faces, mesh.n_vertices)
    assert mesh.plan_areas.min() > 0
    assert mesh.plan_areas.sum() == pytest.approx(original.plan_areas.sum())
    sides = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    n_edges = len(np.unique(sides, axis=0))
    assert mesh.n_vertices - n_edges + mesh.n_faces == 1, "a disc"


def largest_excess(mesh: TriangleMesh, original: TriangleMesh, limits: np.ndarray) -> float:
    errors = np.abs(surface_errors(mesh, original.vertices))
    assert np.isfinite(errors).all()
    return float((errors - limits).max())


@pytest.mark.parametrize("design", DESIGNS)
@pytest.mark.parametrize("n_attributes", [0, 2])
def test_every_place_keeps_its_own_tolerance(design: str, n_attributes: int) -> None:
    original = synthetic.scattered(900, seed=3, n_attributes=n_attributes)
    pyramid = analyse(original, **DESIGNS[design])
    x, y = original.vertices[:, :2].T
    relief = np.ptp(original.vertices[:, 2])
    for limits in (
        np.where(x < np.median(x), 0.002, 0.2) * relief,
        np.where(np.hypot(x - x.mean(), y - y.mean()) < 0.2 * np.ptp(x), 0.0, np.inf),
        np.random.default_rng(1).uniform(0, 0.3 * relief, original.n_vertices),
    ):
        found = mesh_within(pyramid, limits)
        require_valid_tin(found.mesh, original)
        assert largest_excess(found.mesh, original, limits) <= 1e-12 * relief
        np.testing.assert_array_equal(
            found.mesh.vertices[:, :2], original.vertices[found.vertex_ids, :2]
        )
        if pyramid.update == "none":
            np.testing.assert_allclose(
                found.mesh.attributes, original.attributes[found.vertex_ids], atol=1e-9
            )


@pytest.mark.parametrize("design", DESIGNS)
def test_without_a_limit_it_is_the_coarsest_level_and_with_none_the_input(design: str) -> None:
    original = synthetic.hills(20, 24)
    pyramid = analyse(original, **DESIGNS[design])
    coarse = mesh_within(pyramid, np.full(original.n_vertices, np.inf))
    assert coarse.level == 0
    np.testing.assert_allclose(coarse.mesh.vertices, pyramid.mesh(0).vertices)
    assert {frozenset(face) for face in coarse.mesh.faces.tolist()} == {
        frozenset(face) for face in pyramid.mesh(0).faces.tolist()
    }
    exact = mesh_within(pyramid, np.zeros(original.n_vertices))
    assert largest_excess(exact.mesh, original, np.zeros(original.n_vertices)) < 1e-12


@pytest.mark.parametrize("update", ["minimum_norm", "none"])
@pytest.mark.parametrize("partition", ["surface", "quadric"])
def test_any_closed_set_of_collapses_may_be_undone(partition: str, update: str) -> None:
    original = synthetic.scattered(300, seed=11)
    pyramid = analyse(original, partition=partition, levels=6, update=update)
    history = _history_of(pyramid)
    collapses = np.flatnonzero(history.level >= 0)
    generator = np.random.default_rng(0)
    for share in (0.02, 0.1, 0.4, 0.9):
        is_undone = np.zeros(original.n_vertices, dtype=bool)
        history.undo(generator.choice(collapses, int(share * len(collapses))), is_undone)
        faces = history.corners[history.present(is_undone)]
        used = np.unique(faces)
        np.testing.assert_array_equal(used, np.flatnonzero((history.level < 0) | is_undone))
        part = TriangleMesh(original.vertices[used], np.searchsorted(used, faces))
        require_valid_tin(part, original)


def test_levels_are_what_is_undone_down_to_a_step() -> None:
    pyramid = analyse(synthetic.hills(16, 18), levels=5)
    history = _history_of(pyramid)
    for level in range(pyramid.n_levels + 1):
        is_undone = (history.level >= 0) & (history.level < level)
        faces = history.corners[history.present(is_undone)]
        expected = pyramid.vertex_ids(level)[pyramid.mesh(level).faces]
        assert sorted(map(sorted, faces.tolist())) == sorted(map(sorted, expected.tolist()))


def test_no_smaller_set_of_collapses_would_do() -> None:
    """All closed sets of a small pyramid, one by one."""
    original = synthetic.scattered(30, seed=2)
    pyramid = analyse(original, update="none", levels=4)
    history = _history_of(pyramid)
    collapses = np.flatnonzero(history.level >= 0)
    assert 6 <= len(collapses) <= 12
    generator = np.random.default_rng(5)
    for _ in range(10):
        limits = generator.uniform(0, 0.5 * np.ptp(original.vertices[:, 2]), 30)
        fewest = min(
            original.n_vertices - len(collapses) + len(chosen)
            for n in range(len(collapses) + 1)
            for chosen in itertools.combinations(collapses, n)
            if _keeps(history, original, chosen, limits)
        )
        assert mesh_within(pyramid, limits).mesh.n_vertices == fewest


def _keeps(history, original, chosen, limits) -> bool:
    is_undone = np.zeros(original.n_vertices, dtype=bool)
    history.undo(np.array(chosen, dtype=np.int32), is_undone)
    if is_undone.sum() != len(chosen):
        return False  # not closed
    faces = history.corners[history.present(is_undone)]
    mesh = TriangleMesh(original.vertices, faces)
    errors = np.abs(surface_errors(mesh, original.vertices))
    return bool((errors <= limits + 1e-12).all())


@pytest.mark.parametrize("design", DESIGNS)
def test_one_tolerance_for_all_takes_no_more_vertices_than_a_level_that_keeps_it(
    design: str,
) -> None:
    original = synthetic.hills(30, 34)
    pyramid = analyse(original, **DESIGNS[design])
    for max_error in (0.1, 0.7, 3.0):
        found = mesh_of_accuracy(pyramid, max_error)
        assert largest_excess(found.mesh, original, np.full(1020, max_error)) < 1e-12
        thinned = _thinned_level(pyramid, max_error)
        assert found.mesh.n_vertices <= pyramid.n_vertices(thinned.level)
        if pyramid.update == "none":
            assert found.mesh.n_vertices <= thinned.mesh.n_vertices


def test_locked_vertices_stay_and_holes_stay_open() -> None:
    original = synthetic.hills(24, 24)
    x, y = original.vertices[:, :2].T
    centre = np.hypot(x - x.mean(), y - y.mean()) < 3 * np.ptp(x) / 23
    faces = original.faces[~centre[original.faces].any(axis=1)]
    used = np.unique(faces)
    holed = TriangleMesh(original.vertices[used], np.searchsorted(used, faces))
    locked = np.zeros(len(used), dtype=bool)
    locked[::9] = True
    pyramid = analyse(holed, locked=locked, levels=8)
    limits = np.where(holed.vertices[:, 0] < np.median(x), 0.2, 9.0)
    found = mesh_within(pyramid, limits)
    assert set(np.flatnonzero(locked)) <= set(found.vertex_ids.tolist())
    assert found.mesh.plan_areas.sum() == pytest.approx(holed.plan_areas.sum())
    assert largest_excess(found.mesh, holed, limits) < 1e-12


@pytest.mark.parametrize("given", [[0.1] * 5, np.nan, -1.0, "shape"])
def test_tolerances_that_are_none_are_refused(given: object) -> None:
    original = synthetic.hills(6, 6)
    limits = np.ones((36, 2)) if given == "shape" else np.full(36, 1.0)
    if isinstance(given, list):
        limits = np.array(given)
    elif isinstance(given, float):
        limits[7] = given
    with pytest.raises(OptionError, match="tolerance"):
        mesh_within(analyse(original, levels=2), limits)


@pytest.mark.parametrize("options", [{"signal": "xyz"}, {"update": "one_ring_mean"}])
def test_a_pyramid_that_cannot_be_taken_in_part_says_so(options: dict) -> None:
    pyramid = analyse(synthetic.hills(9, 9), levels=2, partition="quadric", **options)
    with pytest.raises(OptionError, match="analyse the input anew"):
        mesh_of_accuracy(pyramid, np.ones(81))
    assert mesh_of_accuracy(pyramid, 1e6).mesh.n_vertices == pyramid.n_vertices(0)


def test_it_stops_when_told_to() -> None:
    pyramid = analyse(synthetic.hills(20, 20), levels=4)
    with pytest.raises(Cancelled):
        mesh_within(pyramid, np.full(400, 0.01), lambda fraction: False)


@pytest.mark.parametrize("strict", [0.5, 0.05])
def test_what_a_moved_outline_left_outside_is_looked_for_once_it_is_inside(strict: float) -> None:
    """Points outside the coarsest level were never located again, and so broke their limits."""
    generator = np.random.default_rng(1)
    radius, turn = np.sqrt(generator.random(400)), generator.random(400) * 2 * np.pi
    ring = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    edge = 1 + 0.02 * generator.standard_normal(120)
    plan = 100 * np.concatenate(
        [
            0.95 * np.column_stack([radius * np.cos(turn), radius * np.sin(turn)]),
            np.column_stack([edge * np.cos(ring), edge * np.sin(ring)]),
        ]
    )
    z = 5 * np.sin(plan[:, 0] / 15) + 5 * np.cos(plan[:, 1] / 11)
    original = TriangleMesh.from_points(np.column_stack([plan, z]))
    pyramid = analyse(original, norm="max", max_error=8.0, outline_tolerance=3.0)
    limits = np.where(original.vertices[:, 0] > 0, strict, 8.0)
    for found in (
        mesh_within(pyramid, limits),
        finished_within(pyramid, original, limits),
        mesh_of_accuracy(pyramid, strict),
    ):
        errors = np.abs(surface_errors(found.mesh, original.vertices))
        is_covered = np.isfinite(errors)
        assert (errors[is_covered] <= limits[is_covered] * (1 + 1e-9)).all()
        assert is_covered.sum() > 0.9 * original.n_vertices
