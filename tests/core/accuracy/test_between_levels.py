"""Meshes between two levels."""

from __future__ import annotations

import numpy as np
import pytest
from helpers import UPDATES

from wavelet_core import OptionError, TriangleMesh, analyse, synthetic
from wavelet_core.accuracy.between_levels import mesh_of_accuracy, mesh_of_size
from wavelet_core.mesh.location import surface_errors


def hills() -> TriangleMesh:
    return synthetic.hills(24, 30)


def n_edges(mesh: TriangleMesh) -> int:
    sides = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, counts = np.unique(sides, axis=0, return_counts=True)
    assert counts.max() <= 2
    return len(unique)


@pytest.mark.parametrize("update", UPDATES)
@pytest.mark.parametrize("signal", ["z", "xyz"])
def test_a_size_that_a_level_has_is_that_level(update: str, signal: str) -> None:
    pyramid = analyse(hills(), levels=3, update=update, signal=signal)
    for level in range(4):
        found = mesh_of_size(pyramid, pyramid.n_vertices(level))
        np.testing.assert_array_equal(found.mesh.vertices, pyramid.mesh(level).vertices)
        np.testing.assert_array_equal(found.vertex_ids, pyramid.vertex_ids(level))


@pytest.mark.parametrize("update", UPDATES)
@pytest.mark.parametrize("locked", [False, True])
def test_the_whole_step_taken_in_part_is_the_coarser_level(update: str, locked: bool) -> None:
    mesh = hills()
    mask = np.zeros(mesh.n_vertices, dtype=bool)
    mask[::7] = locked
    pyramid = analyse(mesh, levels=2, update=update, locked=mask)
    from wavelet_core.accuracy.between_levels import _Step

    step = _Step(pyramid, 2, pyramid.mesh(2))
    whole = step.without(pyramid.n_vertices(2) - pyramid.n_vertices(1))
    coarser = pyramid.mesh(1)
    np.testing.assert_allclose(whole.mesh.vertices, coarser.vertices, atol=1e-9)
    np.testing.assert_array_equal(whole.mesh.faces, coarser.faces)


@pytest.mark.parametrize("partition", ["surface", "quadric", "colouring"])
def test_every_size_between_is_a_valid_tin_of_that_size(partition: str) -> None:
    mesh = synthetic.scattered(300, seed=5, n_attributes=1)
    pyramid = analyse(mesh, levels=3, partition=partition)
    for n_vertices in range(pyramid.n_vertices(0), mesh.n_vertices + 1, 7):
        found = mesh_of_size(pyramid, n_vertices)
        assert found.mesh.n_vertices == n_vertices == len(found.vertex_ids)
        assert found.mesh.plan_areas.min() > 0
        assert n_vertices - n_edges(found.mesh) + found.mesh.n_faces == 1
        assert found.mesh.plan_areas.sum() == pytest.approx(mesh.plan_areas.sum())


def test_the_smallest_details_go_first() -> None:
    pyramid = analyse(hills(), levels=1, partition="quadric")
    magnitude = pyramid.detail(0).magnitude
    found = mesh_of_size(pyramid, pyramid.n_vertices(1) - 10)
    gone = np.setdiff1d(pyramid.vertex_ids(1), found.vertex_ids)
    smallest = pyramid.detail(0).vertex_ids[np.argsort(magnitude, kind="stable")[:10]]
    np.testing.assert_array_equal(gone, np.sort(smallest))


def test_fewer_than_the_coarsest_has_is_refused() -> None:
    pyramid = analyse(hills(), levels=2)
    with pytest.raises(OptionError, match="analyse the input anew"):
        mesh_of_size(pyramid, pyramid.n_vertices(0) - 1)


@pytest.mark.parametrize("size", [250.5, float("nan"), "300"])
def test_a_size_that_is_no_whole_number_is_refused(size: object) -> None:
    """It ended in a TypeError of a slice."""
    with pytest.raises(OptionError, match=r"n_vertices is .*; give a whole number"):
        mesh_of_size(analyse(hills(), levels=2), size)  # type: ignore[arg-type]


def test_more_than_the_input_has_is_the_input() -> None:
    pyramid = analyse(hills(), levels=2)
    assert mesh_of_size(pyramid, 10**6).mesh.n_vertices == hills().n_vertices


@pytest.mark.parametrize("max_error", [0.0, 0.05, 0.5, 3.0, 1e6])
def test_the_tolerance_holds_at_every_input_vertex(max_error: float) -> None:
    mesh = hills()
    pyramid = analyse(mesh, levels=6)
    found = mesh_of_accuracy(pyramid, max_error)
    largest = np.abs(surface_errors(found.mesh, mesh.vertices)).max()
    assert largest <= max_error + 1e-12 * np.ptp(mesh.vertices[:, 2])  # synthesis rounds
    if max_error == 1e6:
        assert found.mesh.n_vertices == pyramid.n_vertices(0)


def test_a_looser_tolerance_never_takes_more_vertices() -> None:
    pyramid = analyse(hills(), levels=6)
    sizes = [mesh_of_accuracy(pyramid, e).mesh.n_vertices for e in (0.02, 0.1, 0.4, 1.5, 6.0)]
    assert sizes == sorted(sizes, reverse=True)


def test_a_negative_tolerance_is_refused() -> None:
    with pytest.raises(OptionError, match="0 or more"):
        mesh_of_accuracy(analyse(hills(), levels=1), -1.0)
