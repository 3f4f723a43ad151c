"""Change by scale: what was put in is found, where and at the scale it was put."""

import runpy
from pathlib import Path

import numpy as np
import pytest
import rasterio
from gis.samples import hills, write_las, write_tif
from matplotlib.cbook import get_sample_data

import wavelet_gis as wg
from wavelet_core import OptionError, band_components
from wavelet_core.features.signature import joined_levels
from wavelet_gis.errors import InputFileError

ROOT = Path(__file__).resolve().parents[3]
BANDS = {"levels": 6, "partition": "random", "prediction": "plane"}


@pytest.fixture
def surveys(tmp_path):
    """Return two DEMs: a dome and a rough square are what the second has more."""
    before = hills(60, 80)
    row, column = np.mgrid[:60, :80]
    dome = 9.0 * np.exp(-0.5 * ((row - 30) ** 2 + (column - 20) ** 2) / 36)
    rough = np.zeros_like(before)
    rough[20:40, 50:70] = np.random.default_rng(5).normal(0, 1.0, (20, 20))
    write_tif(tmp_path / "before.tif", before)
    write_tif(tmp_path / "after.tif", before + dome + rough)
    return tmp_path, dome, rough


def test_bands_add_up_to_the_change_and_tell_dome_from_roughness(surveys):
    folder, dome, rough = surveys
    later = wg.analyse(wg.open(folder / "after.tif"), **BANDS)
    change = wg.change_by_scale(later, folder / "before.tif")
    raster = change.raster()
    np.testing.assert_allclose(raster.values[0], dome + rough, atol=1e-4)
    np.testing.assert_allclose(raster.values[1:].sum(axis=0), dome + rough, atol=1e-4)
    coarse, fine = raster.values[1:-2].sum(axis=0), raster.values[-2:].sum(axis=0)
    is_dome, is_rough = dome > 1.0, rough != 0
    assert coarse[is_dome].sum() == pytest.approx(dome[is_dome].sum(), rel=0.02)
    assert np.corrcoef(fine[is_rough], rough[is_rough])[0, 1] > 0.85
    assert fine[is_rough].std() > 5 * fine[is_dome].std()


def test_a_band_is_that_of_the_later_survey_less_that_of_the_earlier(surveys):
    folder, *_ = surveys
    both = [wg.open(folder / name) for name in ("after.tif", "before.tif")]
    later, earlier = (wg.analyse(terrain, **BANDS) for terrain in both)
    change = wg.change_by_scale(later, both[1])
    a, b = (band_components(found.geo.pyramid) for found in (later, earlier))
    levels = joined_levels(later.geo.pyramid)
    expected = [a.base - b.base, *((a.bands - b.bands)[:, i:j].sum(axis=1) for i, j in levels)]
    np.testing.assert_allclose(change.columns, np.column_stack(expected), atol=1e-9)


def test_the_figures_of_the_bands_are_in_the_progress(surveys):
    """The spacings of a million vertices were looked for after the last word."""
    folder, *_ = surveys
    later, seen = wg.analyse(wg.open(folder / "after.tif"), **BANDS), []
    wg.change_by_scale(
        later, folder / "before.tif", progress=lambda fraction: seen.append(fraction) or True
    )
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1.0)
    assert sum(fraction > 0.7 for fraction in seen) > later.geo.pyramid.n_levels


def test_nothing_has_changed_in_the_same_survey(surveys):
    folder, *_ = surveys
    later = wg.analyse(wg.open(folder / "after.tif"), **BANDS)
    assert wg.change_by_scale(later, folder / "after.tif").figures()["rms"] < 1e-9


def test_an_earlier_survey_of_other_cells_and_less_extent_will_do(surveys):
    folder, *_ = surveys
    plane = np.tile(300 + 0.1 * np.arange(60.0), (50, 1))
    write_tif(folder / "plane.tif", plane + 2.0)
    offset = rasterio.Affine(10.0, 0.0, 500003.0, 0.0, -10.0, 5099996.0)
    write_tif(folder / "moved.tif", plane[:40, :50] + 0.1 * 0.3, transform=offset)
    later = wg.analyse(wg.open(folder / "plane.tif"), **BANDS)
    change = wg.change_by_scale(later, folder / "moved.tif")
    figures = change.figures()
    np.testing.assert_allclose(change.total, 2.0, atol=1e-9)  # goes on where nothing is known
    assert figures["n_not_covered"] == 3000 - figures["n_vertices"] > 900
    assert np.isnan(change.raster().values[0]).sum() == figures["n_not_covered"]


def test_what_cannot_be_compared_is_refused(surveys, tmp_path):
    folder, *_ = surveys
    later = wg.analyse(wg.open(folder / "after.tif"), **BANDS)
    wg.save(later, tmp_path / "later.gpkg")
    with pytest.raises(InputFileError, match="is a pyramid"):
        wg.change_by_scale(later, tmp_path / "later.gpkg")
    write_tif(tmp_path / "other.tif", hills(), crs="EPSG:32633")
    with pytest.raises(InputFileError, match="reproject"):
        wg.change_by_scale(later, tmp_path / "other.tif")
    away = rasterio.Affine(10.0, 0.0, 900000.0, 0.0, -10.0, 5100000.0)
    write_tif(tmp_path / "away.tif", hills(), transform=away)
    with pytest.raises(InputFileError, match="overlap"):
        wg.change_by_scale(later, tmp_path / "away.tif")
    moving = wg.analyse(wg.open(folder / "after.tif"), design="GLMN", signal="xyz", levels=2)
    with pytest.raises(OptionError, match="lifts x and y"):
        wg.change_by_scale(moving, folder / "before.tif")


def test_clouds_have_changes_too(tmp_path):
    path = write_las(tmp_path / "cloud.las", 500)
    later = wg.analyse(wg.open(path), **BANDS)
    change = wg.change_by_scale(later, wg.open(path, duplicates="highest"))
    assert change.figures()["n_not_covered"] == 0
    assert change.figures()["highest"] <= 1e-9  # the lowest points less the highest
    assert change.figures()["lowest"] < 0


def test_the_example_finds_what_it_puts_into_a_real_dem(tmp_path):
    with get_sample_data("jacksboro_fault_dem.npz") as sample:
        elevation = sample["elevation"].astype("f4")[60:320, 40:340]
    place = rasterio.Affine(90.0, 0.0, 500000.0, 0.0, -90.0, 4_000_000.0)
    write_tif(tmp_path / "dem.tif", elevation, crs="EPSG:32616", transform=place)
    example = runpy.run_path(str(ROOT / "examples" / "change_by_scale.py"))
    found = example["draw"](str(tmp_path / "dem.tif"), str(tmp_path / "picture.png"))
    assert (tmp_path / "picture.png").stat().st_size > 10_000
    assert found["share of the mound's volume in the coarse bands"] == pytest.approx(1, abs=0.02)
    assert found["RMS of the fine bands at the mound"] < 0.2
    assert 2.5 < found["RMS of the fine bands in the field"] < 3.0
    assert found["RMS of the coarse bands in the field"] < 1.5
