"""Filtering in the units of the input: what the command and the algorithm in QGIS share."""

import numpy as np
import pytest
from gis.samples import hills, write_tif

import wavelet_gis as wg
from wavelet_core import OptionError, analyse
from wavelet_core.lifting.spacings import level_spacings
from wavelet_gis.workflows import filtering
from wavelet_gis.workflows.analyse import Analysis
from wavelet_gis.workflows.filtering import (
    chosen_gains,
    denoised,
    filter_pyramid,
    with_level_gains,
)
from wavelet_gis.workflows.open import open_terrain
from wavelet_gis.workflows.save import save


@pytest.fixture(scope="module")
def in_feet(tmp_path_factory):
    """Return the pyramid of a DEM in feet, whose levels are bands of sizes."""
    path = write_tif(
        tmp_path_factory.mktemp("feet") / "feet.tif", hills().astype("f4"), crs="EPSG:2226"
    )
    terrain = open_terrain(path)
    return terrain.geo_pyramid(analyse(terrain.mesh, levels=3, partition="random"))


def test_a_band_in_metres_and_single_gains_multiply(in_feet):
    finest = level_spacings(in_feet.pyramid)[3] * 0.3048006096
    gains = chosen_gains(in_feet, [(1, 3.0), (1, 0.5)], metres=(1.01 * finest, np.inf))
    assert gains == {0: 1.0, 1: 1.5, 2: 0.0}
    assert chosen_gains(in_feet, [(1, 3.0), (2, 3.0)], levels=(0, 1)) == {0: 1, 1: 3, 2: 0}


def test_every_change_is_a_line_of_history(in_feet):
    once = with_level_gains(in_feet, {2: 0.0})
    twice, sigmas = denoised(once, 0.5, n_pyramids=0)
    assert sigmas == {"z": 0.5}
    assert twice.history == (
        "gains 2=0",
        "denoised by thresholds, standard deviation of the noise: z 0.5",
    )
    filtered = filter_pyramid(in_feet, gains={2: 0.0})
    assert filtered.changes == once.history
    rms, largest = filtered.change()
    assert 0 < rms < largest < 10
    assert filter_pyramid(once, gains={0: 1.0}).change() == (0.0, 0.0)


def test_what_is_not_there_is_refused_before_the_long_work(in_feet, monkeypatch):
    def never(*arguments, **options):
        raise AssertionError("the long work began")

    monkeypatch.setattr(filtering, "denoise", never)
    with pytest.raises(OptionError, match="no channel 'w'"):
        denoised(in_feet, 0.5, channels=("z", "w"))
    with pytest.raises(OptionError, match="no details at level 3"):
        chosen_gains(in_feet, [(3, 0.0)])


def test_noise_in_units_of_the_input_moves_z_in_units_of_the_input(tmp_path):
    z = 1000 + np.random.default_rng(0).normal(0, 0.5, (30, 30))  # a plain with noise, in feet
    path = write_tif(tmp_path / "plain.tif", z, crs="EPSG:2226")
    terrain = open_terrain(path)
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=4, partition="random"))
    clean = filter_pyramid(geo, denoise=True, n_pyramids=2)
    assert clean.sigmas["z"] == pytest.approx(0.5, rel=0.15)
    assert clean.change()[0] == pytest.approx(0.5, rel=0.25)


def test_a_band_by_levels_and_by_lengths_is_a_contradiction(in_feet):
    with pytest.raises(OptionError, match="exclude each other") as error:
        filter_pyramid(in_feet, levels=(0, 1), metres=(1.0, 50.0))
    assert set(error.value.options) == {"levels", "metres"}


def test_names_that_no_list_holds_are_refused(in_feet, tmp_path):
    with pytest.raises(OptionError, match="'majority'; give one of nearest, number"):
        in_feet.file_mesh(in_feet.pyramid.mesh(0), categories="majority")
    with pytest.raises(OptionError, match="'most'; give one of auto, all, coarse, none"):
        save(Analysis(in_feet), tmp_path / "a.gpkg", layers="most")
    assert list(tmp_path.iterdir()) == []


def test_sizes_are_filtered_on_whatever_pyramid(tmp_path):
    """Narrow furrows over a broad hill, in a pyramid whose levels are no bands of sizes."""
    x = np.arange(120.0)
    hill = 30 * np.sin(x / 40) + 20 * np.cos(x[:, None] / 50)
    furrows = 1.5 * np.sin(2 * np.pi * x / 6) + 0 * x[:, None]
    path = write_tif(tmp_path / "furrows.tif", (hill + furrows).astype("f4"), crs="EPSG:25832")
    geo = wg.analyse(wg.open(path)).geo
    cell = level_spacings(geo.pyramid)[-1]
    smooth = filter_pyramid(geo, metres=(12 * cell, np.inf))
    left = smooth.finest.vertices[:, 2] - hill.ravel()
    inner = np.zeros((120, 120), dtype=bool)
    inner[10:-10, 10:-10] = True
    assert np.std(left[inner.ravel()]) < 0.4 * np.std(furrows)
    (line,) = smooth.changes
    assert "by a pyramid in random order" in line
    # The rest is what was taken: the two bands add up to the terrain.
    rough = filter_pyramid(geo, metres=(0.0, 12 * cell), drop_coarse=True)
    both = smooth.finest.vertices[:, 2] + rough.finest.vertices[:, 2]
    np.testing.assert_allclose(both, smooth.finest_before.vertices[:, 2], atol=1e-6)
    # A size larger than all that there is leaves the coarsest surface alone.
    assert filter_pyramid(geo, metres=(1e5, np.inf)).change()[0] > smooth.change()[0]
    with pytest.raises(OptionError, match="smaller bound first"):
        filter_pyramid(geo, metres=(30.0, 20.0))


def test_bounds_in_the_wrong_order_are_refused_before_the_work(in_feet):
    """Denoising was done first, and another pyramid built."""
    told = []
    with pytest.raises(OptionError, match=r"the band runs from 90\.0 to 30\.0"):
        filter_pyramid(in_feet, metres=(90.0, 30.0), denoise=True, progress=told.append)
    assert told == []


def test_the_true_of_numpy_estimates_the_noise_too(in_feet):
    """It was taken for a standard deviation of 1."""
    plain, other = (
        filter_pyramid(in_feet, denoise=wish, n_pyramids=1) for wish in (True, np.True_)
    )
    assert plain.sigmas == other.sigmas
    with pytest.raises(OptionError, match="nothing to change"):
        filter_pyramid(in_feet, denoise=np.False_)
