"""Averages that keep the edges of a first result."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from wavelet_core import TriangleMesh, denoise
from wavelet_core.filtering import _guided, _weighted_sum
from wavelet_core.filtering._guided import Moved, edge_kept, n_ticks
from wavelet_core.filtering.undecimated import rings


def scattered(n, seed=0):
    """Return points over a hill with a wall across it, and the hill."""
    plan = np.random.default_rng(seed).uniform(0, 100, (n, 2))
    truth = 4 * np.sin(plan[:, 0] / 20) + 3.0 * (plan @ [1.0, 0.4] > 70)
    return plan, truth, Delaunay(plan).simplices


@pytest.fixture(scope="module")
def wall():
    plan, truth, faces = scattered(12_000)
    noisy = truth + np.random.default_rng(1).normal(0, 0.3, len(truth))
    return TriangleMesh(np.column_stack([plan, noisy]), faces), truth


def error_of(mesh, truth):
    return float(np.sqrt(np.mean((mesh.vertices[:, 2] - truth) ** 2)))


@pytest.mark.parametrize("sigma", [0.3, None])
def test_a_wall_between_points_stands_clearer(wall, monkeypatch, sigma):
    mesh, truth = wall
    guided = error_of(denoise(mesh, sigma), truth)
    monkeypatch.setattr(_weighted_sum, "LEAST_FOR_GUIDED", mesh.n_vertices + 1)
    assert guided < 0.9 * error_of(denoise(mesh, sigma), truth)


def test_noise_by_place_keeps_its_wall_too(monkeypatch):
    plan, truth, faces = scattered(12_000, seed=3)
    local = 0.1 + 0.4 * (plan[:, 1] > 50)
    noisy = truth + local * np.random.default_rng(2).standard_normal(len(truth))
    mesh = TriangleMesh(np.column_stack([plan, noisy]), faces)
    guided = error_of(denoise(mesh, local_noise=True), truth)
    monkeypatch.setattr(_weighted_sum, "LEAST_FOR_GUIDED", mesh.n_vertices + 1)
    assert guided < 0.95 * error_of(denoise(mesh, local_noise=True), truth)


def test_rounded_values_are_not_guided(wall, monkeypatch):
    """What rounding leaves is alike in neighbours: a guide made the error 1.6 times as large."""
    mesh, truth = wall
    rounded = np.column_stack([mesh.vertices[:, :2], np.round(truth)])
    whole = denoise(TriangleMesh(rounded, mesh.faces))
    monkeypatch.setattr(_weighted_sum, "LEAST_FOR_GUIDED", mesh.n_vertices + 1)
    np.testing.assert_array_equal(
        whole.vertices, denoise(TriangleMesh(rounded, mesh.faces)).vertices
    )


def test_locked_values_stay(wall):
    mesh, _ = wall
    locked = np.random.default_rng(5).random(mesh.n_vertices) < 0.1
    clean = denoise(mesh, 0.3, locked=locked)
    np.testing.assert_array_equal(clean.vertices[locked], mesh.vertices[locked])


def test_the_change_of_an_average_is_its_derivative():
    """The guide moves with the values, and so do the weights."""
    plan, truth, faces = scattered(400)
    around = rings(TriangleMesh(np.column_stack([plan, truth]), faces))
    generator = np.random.default_rng(4)
    values, guide, along, of_guide = truth + generator.normal(0, 0.3, (4, len(truth)))
    locked = generator.random(len(truth)) < 0.1
    deviation = generator.uniform(0.2, 0.4, len(truth))

    def averages(step):
        moved = Moved(values + step * along, along), Moved(guide + step * of_guide, of_guide)
        return list(_guided._averages(around, *moved, deviation, locked, lambda: None))

    step = 1e-6
    for before, here, after in zip(averages(-step), averages(0.0), averages(step), strict=True):
        numeric = (after.column - before.column) / (2 * step)
        np.testing.assert_allclose(here.change, numeric, rtol=1e-5, atol=1e-7)


def test_an_average_is_a_mean_by_hand():
    """Two triangles: of four vertices in a row of heights 0, 0, 1, 1 the middle ones meet."""
    plan = np.array([[0.0, 0], [1, 1], [1, -1], [2, 0]])
    mesh = TriangleMesh(np.column_stack([plan, [0.0, 0, 1, 1]]), [[0, 2, 1], [1, 2, 3]])
    height, still = mesh.vertices[:, 2], np.zeros(4)
    moved = Moved(height, still)
    first = next(
        _guided._averages(rings(mesh), moved, moved, np.ones(1), np.zeros(4, bool), lambda: None)
    )
    weight = np.exp(-0.5 / _guided.WIDTHS[0] ** 2)  # of a neighbour one higher or lower
    lower, upper = weight / (2 + weight), 2 * weight / (2 + 2 * weight)
    np.testing.assert_allclose(first.column, [lower, upper, 1 - upper, 1 - lower])


def test_ticks_are_known_before(wall):
    mesh, truth = wall
    around, ticks = rings(mesh), []
    height = mesh.vertices[:, 2]
    values = Moved(height, np.random.default_rng(6).choice([-1.0, 1.0], len(height)))
    first = Moved(truth, 0.1 * values.change)
    still = np.zeros(len(height), dtype=bool)
    edge_kept(around, values, first, np.array([0.3]), still, lambda: ticks.append(1))
    assert len(ticks) == n_ticks(len(height))
    assert n_ticks(100) == 0


def test_a_first_result_that_lets_all_noise_pass_stays():
    plan, truth, faces = scattered(500)
    around = rings(TriangleMesh(np.column_stack([plan, truth]), faces))
    values = Moved(truth, np.ones(len(truth)))
    still = np.zeros(len(truth), dtype=bool)
    found = edge_kept(around, values, values, np.ones(1), still, lambda: None)
    np.testing.assert_array_equal(found, truth)
