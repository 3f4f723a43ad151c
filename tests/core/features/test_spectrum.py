"""Spectra of vertices: the sums that must hold, and what a bump, a plane and a lone spike give."""

from dataclasses import replace

import numpy as np
import pytest
from helpers import PAIRS, UNSTABLE_TOO

from wavelet_core import Cancelled, OptionError, PyramidError, TriangleMesh, analyse, synthetic
from wavelet_core.features.spectrum import (
    STAYS,
    band_components,
    band_energies,
    heights_above_lows,
    vertex_details,
)
from wavelet_core.lifting.spacings import level_spacings


@UNSTABLE_TOO
@pytest.mark.parametrize(("prediction", "update"), PAIRS)
def test_base_and_bands_sum_to_the_input(prediction, update):
    mesh = synthetic.scattered(300, n_attributes=1)
    pyramid = analyse(mesh, levels=4, partition="colouring", prediction=prediction, update=update)
    for channel, expected in (("z", mesh.vertices[:, 2]), ("a0", mesh.attributes[:, 0])):
        components = band_components(pyramid, channel)
        total = components.base + components.bands.sum(axis=1)
        scale = max(np.abs(components.bands).max(), np.ptp(expected))  # least squares has no bound
        np.testing.assert_allclose(total, expected, rtol=0, atol=1e-9 * scale)


def test_a_component_is_the_synthesis_of_its_details_alone():
    mesh = synthetic.scattered(300)
    pyramid = analyse(mesh, levels=4, partition="quadric", prediction="geometric")
    components = band_components(pyramid)
    for band in range(pyramid.n_levels):
        steps = [
            step if level == band else replace(step, details=np.zeros_like(step.details))
            for level, step in enumerate(pyramid.steps)
        ]
        alone = pyramid.with_parts(coarse=np.zeros_like(pyramid.coarse), steps=tuple(steps))
        np.testing.assert_allclose(
            components.bands[:, band], alone.synthesise().vertices[:, 2], rtol=0, atol=1e-9
        )


def test_residual_is_what_lies_above_a_level():
    mesh = synthetic.hills(12, 15)
    pyramid = analyse(mesh, levels=3, partition="quadric", prediction="geometric")
    components = band_components(pyramid)
    ids = pyramid.vertex_ids(2)
    smooth = pyramid.mesh(2).vertices[:, 2]
    np.testing.assert_allclose(
        components.residual(2)[ids], mesh.vertices[ids, 2] - smooth, rtol=0, atol=1e-9
    )


@pytest.mark.parametrize("prediction", ["uniform", "geometric", "nnls", "barycentric"])
def test_a_band_keeps_its_energy(prediction):
    pyramid = analyse(
        synthetic.scattered(400), levels=5, partition="quadric", prediction=prediction
    )
    energies = band_energies(pyramid)
    assert energies.min() >= 0
    for level, step in enumerate(pyramid.steps):
        integrals = pyramid.integrals(level + 1)[step.odd]
        expected = (integrals * step.details[:, 0] ** 2).sum()
        assert energies[:, level].sum() == pytest.approx(expected, rel=1e-9)


def test_negative_weights_give_no_negative_energy():
    pyramid = analyse(
        synthetic.scattered(400), levels=5, partition="colouring", prediction="least_squares"
    )
    assert min(step.weights.min() for step in pyramid.steps) < 0
    assert band_energies(pyramid).min() >= 0


def test_a_plane_has_no_energy():
    pyramid = analyse(synthetic.plane(), levels=4, partition="colouring", prediction="barycentric")
    assert band_energies(pyramid).max() < 1e-20


def test_the_energy_of_a_spike_stays_around_it():
    z = np.zeros((21, 21))
    z[10, 10] = 5.0
    axis = np.arange(21.0)
    mesh = TriangleMesh.from_grid(z, x=axis, y=axis)
    pyramid = analyse(
        mesh, levels=4, partition="random", prediction="barycentric", update="none", seed=3
    )
    energies = band_energies(pyramid)
    distance = np.hypot(*(mesh.vertices[:, :2] - 10).T)
    level = vertex_details(pyramid).level[220]
    assert level != STAYS  # else the seed must change
    assert energies[:, level].max() > 0
    for band in np.flatnonzero(energies.sum(axis=0) > 0):
        assert energies[distance > 9, band].max() == 0
        assert distance[np.argmax(energies[:, band])] < 3


def test_channels_are_apart_and_geometry_is_the_default():
    mesh = synthetic.scattered(200, n_attributes=2)
    pyramid = analyse(mesh, levels=3, partition="quadric", prediction="geometric")
    np.testing.assert_array_equal(band_energies(pyramid), band_energies(pyramid, "z"))
    assert not np.allclose(band_energies(pyramid, "a0"), band_energies(pyramid, "a1"))
    lifted = analyse(mesh, levels=3, partition="quadric", prediction="geometric", signal="xyz")
    total = sum(band_energies(lifted, axis) for axis in "xyz")
    np.testing.assert_allclose(band_energies(lifted), total, rtol=1e-12)


def test_every_vertex_goes_once_or_stays():
    pyramid = analyse(synthetic.hills(14, 17), levels=4, partition="quadric")
    details = vertex_details(pyramid)
    assert (details.level == STAYS).sum() == pyramid.n_vertices(0)
    assert np.isnan(details.magnitude[details.level == STAYS]).all()
    for level, layer in pyramid.details():
        np.testing.assert_array_equal(
            np.flatnonzero(details.level == level), np.sort(layer.vertex_ids)
        )
        np.testing.assert_array_equal(details.vectors[layer.vertex_ids], layer.vectors)
        np.testing.assert_array_equal(details.magnitude[layer.vertex_ids], layer.magnitude)


def test_spacings_grow_and_begin_with_the_grid():
    pyramid = analyse(synthetic.hills(30, 30, cell=2.0), levels=6, partition="quadric")
    spacings = level_spacings(pyramid)
    assert len(spacings) == 7
    assert spacings[-1] == pytest.approx(2.0)
    assert spacings[0] > 3.0


def test_no_levels_give_no_bands():
    mesh = synthetic.hills(5, 5)
    pyramid = analyse(mesh, levels=0)
    assert band_energies(pyramid).shape == (25, 0)
    components = band_components(pyramid)
    np.testing.assert_array_equal(components.base, mesh.vertices[:, 2])


def test_an_unknown_channel_is_refused_and_progress_may_stop():
    pyramid = analyse(synthetic.hills(10, 10), levels=2)
    with pytest.raises(OptionError, match="no channel 'hag'; the pyramid has z"):
        band_energies(pyramid, "hag")
    for function in (band_energies, band_components):
        with pytest.raises(Cancelled):
            function(pyramid, progress=lambda fraction: False)
        seen = []
        function(pyramid, progress=seen.append)
        assert seen[-1] == 1.0
        assert sorted(seen) == seen


def test_the_ground_is_low_at_all_scales_and_a_roof_only_at_fine_ones():
    axis = np.arange(40.0)
    x, y = np.meshgrid(axis, axis)
    is_roof = (np.abs(x - 20) < 6) & (np.abs(y - 20) < 6)
    mesh = TriangleMesh.from_grid(np.where(is_roof, 8.0, 0.1 * x), x=axis, y=axis)
    pyramid = analyse(mesh, levels=16, partition="random", prediction="uniform")
    heights = heights_above_lows(pyramid, [0, pyramid.n_levels])
    assert heights.min() >= -1e-9
    assert np.abs(heights[:, 1]).max() < 1e-9
    middle = np.hypot(x - 20, y - 20).ravel() < 3
    assert heights[middle, 0].min() > 4
    assert np.median(heights[~is_roof.ravel(), 0]) < 2


def test_lows_are_bounded_by_the_lowest_and_levels_are_checked():
    mesh = synthetic.scattered(300)
    pyramid = analyse(mesh, levels=5, partition="quadric", prediction="geometric")
    heights = heights_above_lows(pyramid, [3, 0, 1])
    z = mesh.vertices[:, 2]
    assert (heights <= (z - z.min())[:, None] + 1e-9).all()
    assert heights[:, 1].mean() > heights[:, 2].mean() > heights[:, 0].mean()
    with pytest.raises(PyramidError, match="no level 6"):
        heights_above_lows(pyramid, [6])
    with pytest.raises(Cancelled):
        heights_above_lows(pyramid, [0], progress=lambda fraction: False)
