"""Roughness and deviation by scale against surfaces whose forms have one size."""

import numpy as np
import pytest

from wavelet_core import (
    Cancelled,
    OptionError,
    PyramidError,
    TriangleMesh,
    analyse,
    band_energies,
    deviation_by_scale,
    heights_above_means,
    level_at_distance,
    level_spacings,
    local_means,
    roughness_by_scale,
    synthetic,
)

BY_SIZE = {"partition": "random", "prediction": "plane"}
MAPS = (roughness_by_scale, deviation_by_scale)


def grid(z):
    """Return a DEM of cells of one unit."""
    return TriangleMesh.from_grid(z, x=np.arange(z.shape[1]) * 1.0, y=np.arange(z.shape[0]) * 1.0)


@pytest.mark.parametrize("wavelength", [6.0, 10.0, 16.0])
def test_a_sinusoid_is_strongest_where_its_wavelength_is_under_two_spacings(wavelength):
    x, y = np.meshgrid(np.arange(160.0), np.arange(160.0))
    mesh = grid(np.sin(2 * np.pi * (0.8 * x + 0.6 * y) / wavelength))
    pyramid = analyse(mesh, levels=18, **BY_SIZE)
    strongest = np.argmax(band_energies(pyramid).mean(axis=0))
    assert 1.3 < wavelength / level_spacings(pyramid)[strongest + 1] < 2.2


def test_roughness_is_the_angle_of_what_the_smooth_surface_leaves_out():
    x, y = np.meshgrid(np.arange(120.0), np.arange(120.0))
    fine = 0.3 * np.sin(2 * np.pi * x / 4) * (x > 60)
    maps = roughness_by_scale(analyse(grid(fine + 0.2 * y), levels=14, **BY_SIZE))
    assert maps.values.shape == (120 * 120, len(maps.levels))
    assert list(maps.distances) == sorted(maps.distances, reverse=True)
    rough, smooth = maps.values[(x > 75).ravel()], maps.values[(x < 45).ravel()]
    assert np.median(smooth, axis=0).max() < 0.01  # of a tilted plane
    # every other vertex is a crest or a trough, as level as the smooth surface; the rest climb
    coarse = np.median(rough[:, maps.distances > 4], axis=0)
    np.testing.assert_allclose(coarse, 0.5 * np.degrees(np.arctan(0.3)), rtol=0.1)


def test_how_far_a_hill_stands_out_depends_on_the_distance_in_its_own_widths():
    x, y = np.meshgrid(np.arange(220.0), np.arange(120.0))
    z = 0.01 * np.random.default_rng(0).normal(size=x.shape)
    for at, radius in ((40, 3.0), (140, -12.0)):  # a hill and a wider pit
        z += radius * np.exp(-0.5 * ((x - at) ** 2 + (y - 60) ** 2) / radius**2)
    maps = deviation_by_scale(analyse(grid(z), levels=22, **BY_SIZE))

    def deviation(at, distance):
        around = (np.hypot(x - at, y - 60) < 2).ravel()
        return np.median(maps.values[around, np.abs(maps.distances - distance).argmin()])

    assert deviation(40, 4.5) == pytest.approx(-deviation(140, 18.0), rel=0.25)
    assert deviation(40, 18.0) > 3 > 2 > -deviation(140, 18.0) > 1.2
    assert -deviation(140, 4.5) < 1.1 < deviation(40, 4.5)


def test_on_a_slope_heights_are_above_the_slope():
    x, y = np.meshgrid(np.arange(80.0), np.arange(80.0))
    pyramid = analyse(grid(0.3 * x + 0.1 * y), levels=14, **BY_SIZE)
    above = heights_above_means(pyramid, [0, 7, 14])
    inner = ((np.abs(x - 39.5) < 20) & (np.abs(y - 39.5) < 20)).ravel()
    np.testing.assert_allclose(above[inner], 0.0, atol=1e-9)
    hill = 5 * np.exp(-0.5 * ((x - 40) ** 2 + (y - 40) ** 2) / 9)
    above = heights_above_means(analyse(grid(0.3 * x + hill), levels=14, **BY_SIZE), [0])
    assert above[:, 0].argmax() == 40 * 80 + 40
    assert 4 < above.max() < 5


def test_nothing_stands_out_of_a_lake():
    z = np.full((60, 60), 100.0)
    z[:, 40:] += np.arange(20.0)
    maps = deviation_by_scale(analyse(grid(z), levels=8, **BY_SIZE))
    lake = (np.arange(3600) % 60) < 10
    assert (maps.values[lake, maps.distances.argmin()] == 0).all()
    is_still = (maps.values == 0).all(axis=1)
    assert is_still.any()
    assert np.isnan(maps.strongest_distance[is_still]).all()


def test_of_equal_scales_the_finest_is_taken():
    from wavelet_core import ScaleMaps

    maps = ScaleMaps((0, 3), np.array([8.0, 2.0]), np.array([[1.0, -1.0], [-2.0, 1.0]]))
    assert maps.strongest.tolist() == [-1.0, -2.0]
    assert maps.strongest_distance.tolist() == [2.0, 8.0]


def test_a_vertical_shift_changes_no_map():
    mesh = synthetic.scattered(600)
    raised = TriangleMesh.from_points(mesh.vertices + np.array([0, 0, 1000.0]))
    for function in MAPS:
        one = function(analyse(mesh, levels=6, **BY_SIZE))
        other = function(analyse(raised, levels=6, **BY_SIZE))
        np.testing.assert_allclose(one.values, other.values, rtol=0, atol=1e-6)


@pytest.mark.parametrize("prediction", ["uniform", "geometric", "nnls", "plane"])
def test_means_of_a_constant_are_the_constant_and_of_the_input_the_input(prediction):
    mesh = synthetic.scattered(500)
    pyramid = analyse(mesh, levels=6, partition="random", prediction=prediction)
    levels = [6, 0, 3]
    constant = local_means(pyramid, np.full(mesh.n_vertices, 7.0), levels)
    np.testing.assert_allclose(constant, 7.0, rtol=1e-12)
    values = np.random.default_rng(0).uniform(size=mesh.n_vertices)
    means = local_means(pyramid, values, levels)
    np.testing.assert_array_equal(means[:, 0], values)
    assert means[:, 1].std() < means[:, 2].std() < values.std()
    assert means.min() >= values.min()
    assert means.max() <= values.max()
    columns = np.column_stack([values, 2 * values, 3 * values])
    np.testing.assert_allclose(local_means(pyramid, columns, levels), means * (1, 2, 3))


def test_the_level_of_a_distance_is_the_nearest_by_ratio():
    pyramid = analyse(synthetic.scattered(2000), levels=8, **BY_SIZE)
    spacings = level_spacings(pyramid)
    for level, spacing in enumerate(spacings):
        assert level_at_distance(pyramid, spacing * 1.01) == level
    between = np.sqrt(spacings[2] * spacings[3])
    assert level_at_distance(pyramid, between * 1.001) == 2
    assert level_at_distance(pyramid, between * 0.999) == 3
    for wrong in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(OptionError, match="give one above 0"):
            level_at_distance(pyramid, wrong)
    for away in (spacings[0] * 2, spacings[-1] / 2):
        with pytest.raises(OptionError, match="levels' spacings are"):
            level_at_distance(pyramid, away)


def test_no_levels_are_refused_and_progress_may_stop():
    flat = analyse(synthetic.hills(5, 5), levels=0)
    pyramid = analyse(synthetic.hills(12, 12), levels=3, **BY_SIZE)
    for function in MAPS:
        with pytest.raises(OptionError, match="pyramid has no levels"):
            function(flat)
        with pytest.raises(Cancelled):
            function(pyramid, progress=lambda fraction: False)
        seen = []
        function(pyramid, progress=lambda fraction, seen=seen: seen.append(fraction) or True)
        assert seen[-1] == pytest.approx(1.0)
        assert sorted(seen) == seen
    with pytest.raises(PyramidError, match="no level 9"):
        local_means(pyramid, np.zeros(144), [9])
