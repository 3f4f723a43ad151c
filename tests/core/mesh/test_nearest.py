"""The nearest of points against all distances: lattices, clusters, strips, one far away."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wavelet_core._kernels._jit import HAS_NUMBA, engine
from wavelet_core.errors import Cancelled
from wavelet_core.mesh.point_faces import nearest_points

M = 16
ENGINES = ("arrays", "loops", *(("compiled",) if HAS_NUMBA else ()))


def brute(x, y):
    """Return nearest and reach by all distances, as exact whole numbers."""
    x, y = x.astype(np.int64), y.astype(np.int64)
    squared = (x[:, None] - x) ** 2 + (y[:, None] - y) ** 2
    np.fill_diagonal(squared, -1)
    order = np.lexsort((np.broadcast_to(np.arange(len(x)), squared.shape), squared), axis=1)[:, 1:]
    by_distance = np.take_along_axis(squared, order, axis=1)
    return order[:, :M], by_distance[:, :M], by_distance[:, M]


def assert_nearest(plan):
    x, y = (np.ascontiguousarray(column) for column in plan.T.astype(float))
    wanted, squared, reach = brute(x, y)
    is_clear = squared < reach[:, None]  # of the others it is not said which
    for name in ENGINES:
        with engine(name):
            found, found_reach = nearest_points(x, y, M)
        np.testing.assert_array_equal(found_reach, reach)
        np.testing.assert_array_equal(found[is_clear], wanted[is_clear])


def distinct(plan):
    plan = np.unique(plan, axis=0)
    return np.random.default_rng(1).permutation(plan - plan.min(axis=0))


@settings(max_examples=40, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(20, 300),
    st.sampled_from([(9, 40), (40, 40), (1000, 1), (5000, 3000), (2**24, 2**24)]),
)
def test_random_points_of_any_density(seed, n, extent):
    rng = np.random.default_rng(seed)
    plan = distinct(rng.integers(0, np.array(extent) + 1, (n, 2)))
    if len(plan) > M + 1:
        assert_nearest(plan)


@pytest.mark.parametrize(
    "name", ["lattice", "one far away", "two clusters", "strip", "ring", "row", "dense and sparse"]
)
def test_points_of_a_kind(name):
    rng = np.random.default_rng(7)
    lattice = np.argwhere(np.ones((25, 30)))
    angles = rng.uniform(0, 2 * np.pi, 700)
    plan = {
        "lattice": 10 * lattice,
        "one far away": np.vstack([lattice, [[2**24, 2**24 - 5]]]),
        "two clusters": np.vstack([lattice, lattice + 100_000]),
        "strip": np.arange(800)[:, None] * 40 + rng.integers(0, 60, (800, 2)),
        "ring": (10_000 * np.column_stack([np.cos(angles), np.sin(angles)])).astype(int),
        "row": np.column_stack([rng.integers(0, 9000, 600), np.zeros(600, int)]),
        "dense and sparse": np.vstack([lattice, rng.integers(0, 3000, (300, 2))]),
    }[name]
    assert_nearest(distinct(plan))


@pytest.mark.skipif(not HAS_NUMBA, reason="whole arrays leave all to the tree")
def test_most_points_are_found_in_cells(monkeypatch):
    from wavelet_core.mesh import point_faces

    asked = []
    look_up = point_faces._look_up_in_tree
    monkeypatch.setattr(
        point_faces, "_look_up_in_tree", lambda points, *rest: (asked.append(len(points)),
                                                            look_up(points, *rest))
    )  # fmt: skip
    x, y = np.random.default_rng(3).integers(0, 40_000, (2, 30_000)).astype(float)
    places = np.unique(np.column_stack([x, y]), axis=0)
    x, y = (np.ascontiguousarray(column) for column in places.T)
    with engine("compiled"):
        nearest_points(x, y, M)
    assert asked[0] < 0.01 * len(x)


@pytest.mark.parametrize("name", ENGINES)
def test_a_cancel_stops_it(name):
    plan = np.argwhere(np.ones((20, 20))).astype(float)
    x, y = (np.ascontiguousarray(column) for column in plan.T)
    with engine(name), pytest.raises(Cancelled, match="nothing was kept"):
        nearest_points(x, y, M, lambda share: False)
