"""Ground without training: what stands up goes, what rises stays, on plains and on mountains."""

import numpy as np
import pytest

from wavelet_core import Cancelled, MeshError, OptionError, ground_points


def scattered(n=20_000, side=100.0, seed=0):
    """Return places on a square, two a square metre."""
    return np.random.default_rng(seed).uniform(0, side, (n, 2))


def cloud(plan, *heights):
    return np.column_stack([plan, sum(heights)])


def shares(found, is_ground):
    """Return type I and type II error."""
    return np.mean(~found[is_ground]), np.mean(found[~is_ground])


@pytest.mark.parametrize("slope", [0.0, 0.1, 0.2])
def test_houses_and_trees_are_taken_off_plains_and_slopes_alike(slope):
    plan = scattered()
    x, y = plan.T
    rng = np.random.default_rng(1)
    is_house = (abs(x - 30) < 8) & (abs(y - 60) < 12)
    is_tree = ~is_house & (rng.random(len(x)) < 0.3)
    above = np.where(is_house, 6.0, 0.0) + np.where(is_tree, rng.uniform(1, 15, len(x)), 0.0)
    ground = slope * x + 2 * np.sin(y / 20) + rng.normal(0, 0.02, len(x))
    type_1, type_2 = shares(ground_points(cloud(plan, ground, above)), above == 0)
    assert type_1 < 0.03
    assert type_2 < 0.01


def test_a_mountain_is_ground():
    plan = scattered()
    x, y = plan.T
    assert ground_points(cloud(plan, 0.7 * x + 5 * np.sin(y / 10))).mean() > 0.97


def test_a_roof_that_the_border_cuts_is_taken_off():
    plan = scattered()
    is_roof = (plan[:, 0] < 12) & (abs(plan[:, 1] - 50) < 10)
    found = ground_points(cloud(plan, 5.0 * is_roof))
    assert shares(found, ~is_roof) == (0.0, 0.0)


def test_a_bank_stays_where_a_wall_goes():
    plan = scattered()
    across = abs(plan[:, 0] - 50)
    bank = np.clip(4.0 - 0.5 * (across - 5), 0.0, 4.0)  # 10 m wide on top, sides of 1 : 2
    wall = np.where(across < 9, 4.0, 0.0)
    assert ground_points(cloud(plan, bank)).mean() > 0.98
    assert shares(ground_points(cloud(plan, wall)), wall == 0) < (0.01, 0.01)


def test_a_hall_wider_than_the_largest_object_needs_that_to_be_said():
    plan = scattered()
    is_roof = (abs(plan - 50) < 20).all(axis=1)
    points = cloud(plan, 8.0 * is_roof)
    assert ground_points(points, largest_object=20)[is_roof].mean() > 0.5
    assert ground_points(points, largest_object=50)[is_roof].mean() == 0.0


def test_lone_low_points_are_not_ground_and_pull_nothing_down():
    plan = scattered()
    is_low = np.zeros(len(plan), dtype=bool)
    is_low[::2000] = True
    found = ground_points(cloud(plan, 0.05 * plan[:, 0], -20.0 * is_low))
    assert shares(found, ~is_low) == (0.0, 0.0)


def test_a_wider_tolerance_takes_more():
    plan = scattered()
    points = cloud(plan, np.random.default_rng(2).uniform(0, 0.5, len(plan)))
    counts = [ground_points(points, height_tolerance=t).sum() for t in (0.05, 0.15, 0.45)]
    assert counts[0] < counts[1] < counts[2]


def test_neither_order_nor_place_of_the_points_matters():
    plan = scattered(5_000, 50.0)
    points = cloud(plan, np.where((abs(plan - 25) < 6).all(axis=1), 4.0, 0.1 * plan[:, 1]))
    found = ground_points(points)
    assert 0 < found.sum() < len(found)
    order = np.random.default_rng(3).permutation(len(points))
    np.testing.assert_array_equal(ground_points(points[order]), found[order])
    moved = points + np.array([2.0**19, 2.0**22, 512.0])
    assert np.mean(ground_points(moved) != found) < 1e-3  # rounding moves some over a cell's side


@pytest.mark.parametrize(
    "points",
    [np.zeros((5, 3)), np.arange(30.0).reshape(10, 3), np.eye(3)],
    ids=["one place", "a line", "three points"],
)
def test_few_points_have_a_ground_too(points):
    assert ground_points(points).any()


def test_what_is_no_cloud_is_refused():
    good = np.random.default_rng(0).uniform(0, 10, (100, 3))
    with pytest.raises(MeshError, match="three points"):
        ground_points(good[:2])
    with pytest.raises(MeshError, match=r"point 7 .* leave it out"):
        ground_points(np.where(np.arange(100)[:, None] == 7, np.nan, good))
    with pytest.raises(MeshError, match="cut stray points off"):
        ground_points(np.vstack([good, [[1e7, 3e6, 0.0]]]))
    with pytest.raises(OptionError, match="least_slope is 0"):
        ground_points(good, least_slope=0)
    with pytest.raises(OptionError, match="largest_object is nan"):
        ground_points(good, largest_object=float("nan"))


def test_it_tells_how_far_it_is_and_stops_when_told():
    points = cloud(scattered(2_000, 30.0), np.zeros(2_000))
    seen = []
    ground_points(points, progress=seen.append)
    assert seen == sorted(seen)
    assert len(seen) > 5
    assert seen[-1] == 1.0
    with pytest.raises(Cancelled):
        ground_points(points, progress=lambda fraction: fraction < 0.5)
