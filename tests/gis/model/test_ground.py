"""Height above ground against terrain whose ground is known."""

import numpy as np
import pytest

from wavelet_gis.errors import InputFileError
from wavelet_gis.model.attributes.ground import HEIGHT_STEP, height_above_ground


def slope_with_trees(rng, n=3000, offset=0.0):
    x, y = rng.uniform(0, 100, n), rng.uniform(0, 100, n)
    height = np.where(rng.random(n) < 0.5, 0.0, rng.uniform(1, 30, n))
    coordinates = np.column_stack([x + offset, y + offset, 0.3 * x - 0.1 * y + 50 + height])
    return coordinates, height


@pytest.mark.parametrize("offset", [0.0, 5_000_000.0])
def test_heights_over_a_plane_are_exact_inside_the_ground(rng, offset):
    coordinates, height = slope_with_trees(rng, offset=offset)
    found = height_above_ground(coordinates, height == 0)
    inside = ((coordinates[:, :2] - offset > 5) & (coordinates[:, :2] - offset < 95)).all(axis=1)
    np.testing.assert_allclose(found[inside], height[inside], atol=HEIGHT_STEP)
    assert (np.abs(found[height == 0]) <= HEIGHT_STEP).all()


def test_outside_the_outline_the_nearest_ground_point_counts():
    ground = np.array([[0, 0, 5], [10, 0, 5], [0, 10, 5.0]])
    beyond = np.array([[30, 30, 12.0]])
    found = height_above_ground(np.vstack([ground, beyond]), np.arange(4) < 3)
    assert found[3] == 7.0


def test_heights_are_exact_in_float32(rng):
    coordinates, height = slope_with_trees(rng)
    found = height_above_ground(coordinates, height == 0)
    assert found.dtype == np.float32
    steps = found.astype(float) / HEIGHT_STEP
    assert (steps == np.rint(steps)).all()


def test_without_ground_there_is_no_height(rng):
    coordinates, _ = slope_with_trees(rng, n=10)
    with pytest.raises(InputFileError, match="class 2"):
        height_above_ground(coordinates, np.zeros(10, bool))
