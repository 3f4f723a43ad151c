"""Tile sets of odd input, in odd places and with damaged parts."""

import json
import warnings

import numpy as np
import pytest
import rasterio
from gis.samples import assert_same_raster, hills, write_tif

import wavelet_gis as wg
from wavelet_gis.cli.main import main
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.raster import write_dem
from wavelet_gis.tiles.index import open_index
from wavelet_gis.tiles.plan import TilePlan

SIZE = 16


def apart(folder, left, right, nodata=(None, None)):
    """Write two rasters with a gap between them, each in tiles of its own."""
    place = rasterio.Affine(10.0, 0.0, 500000.0, 0.0, -10.0, 5100000.0)
    beside = place @ rasterio.Affine.translation(37, 0)
    one = write_tif(folder / "one.tif", left, transform=place, nodata=nodata[0])
    return [
        one,
        write_tif(folder / "two.tif", right, transform=beside, nodata=nodata[1]),
    ]


def test_rasters_of_different_types_are_refused_before_any_tile_is_made(tmp_path):
    """Fractions of the second came back as whole numbers, and it was called the original."""
    files = apart(tmp_path, hills(17, 12).astype("i2"), hills(17, 12).astype("f4"))
    with pytest.raises(InputFileError, match=r"two.tif: this has numbers of type float32, and .*"):
        wg.tile_rasters(files, tmp_path / "t", tile=SIZE)
    assert not (tmp_path / "t").exists()


def test_holes_of_rasters_with_another_nodata_value_stay_holes(tmp_path):
    """Those of the second came back as elevations of -32768."""
    left, right = hills(17, 12).astype("f4"), hills(17, 12, seed=1).astype("f4")
    left[3, 4], right[5, 6] = -9999, -32768
    files = apart(tmp_path, left, right, nodata=(-9999.0, -32768.0))
    tiled = wg.tile_rasters(files, tmp_path / "t", tile=SIZE)
    restored = wg.restored_raster(tiled.index)
    write_dem(tmp_path / "back.tif", restored, None)
    with rasterio.open(tmp_path / "back.tif") as dataset:
        is_data = dataset.read_masks(1) != 0
        values = dataset.read(1)
    assert not is_data[3, 4]
    assert not is_data[5, 37 + 6]
    assert is_data.sum() == 2 * (17 * 12 - 1)
    assert values[is_data].min() > 0


def test_an_elevation_that_is_the_nodata_value_of_another_raster_is_refused(tmp_path):
    left, right = hills(17, 12).astype("f4"), hills(17, 12, seed=1).astype("f4")
    left[3, 4], right[5, 6], right[7, 7] = 300, -9999, 300
    files = apart(tmp_path, left, right, nodata=(300.0, -9999.0))
    tiled = wg.tile_rasters(files, tmp_path / "t", tile=SIZE)
    with pytest.raises(InputFileError, match="is an elevation in another of the files"):
        wg.restored_raster(tiled.index)


def test_a_raster_without_a_nodata_value_comes_back_without_one(tmp_path):
    values = hills(33, 33).astype("f4")
    values[4:20, 4:20] = np.nan
    raster = write_tif(tmp_path / "a.tif", values)
    index = wg.tile_rasters(raster, tmp_path / "t", tile=SIZE).index
    with rasterio.open(raster) as dataset:
        write_dem(tmp_path / "back.tif", wg.restored_raster(index), dataset.crs.to_wkt())
    assert_same_raster(raster, tmp_path / "back.tif")


@pytest.mark.parametrize("name", ["a;b", "a!b", "ä b"])
def test_a_tile_set_may_be_in_a_folder_of_any_name(tmp_path, name):
    """pyogrio takes ``;`` and ``!`` for the syntax of archives; the index could not be written."""
    raster = write_tif(tmp_path / "a.tif", hills(33, 33).astype("f4"))
    tiled = wg.tile_rasters(raster, tmp_path / name, tile=SIZE)
    assert sorted(path.name for path in (tmp_path / name).iterdir()) == [
        "index.gpkg",
        "pieces",
        "plan.json",
    ]
    assert wg.extract_region(tmp_path / name / "index.gpkg", level=tiled.index.n_levels).pieces


def test_a_raster_without_a_crs_is_told_of_once_and_in_our_words(tmp_path):
    raster = write_tif(tmp_path / "a.tif", hills(33, 33).astype("f4"), crs=None)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        wg.tile_rasters(raster, tmp_path / "t", tile=SIZE)
    assert [str(one.message).partition("; ")[0] for one in told] == [
        f"{raster}: there is no CRS",
    ]


@pytest.fixture
def with_a_gap(tmp_path):
    """Return a tile set of which a tile is missing."""
    raster = write_tif(tmp_path / "a.tif", hills(33, 33).astype("f4"))
    wg.tile_rasters(raster, tmp_path / "t", tile=SIZE)
    (tmp_path / "t" / "pieces" / "0" / "00000_00001.json").unlink()
    return tmp_path / "t"


def test_gaps_are_told_of_in_json_by_the_name_of_the_folder_alone(with_a_gap, tmp_path, capsys):
    """The folder was no text, and the command ended in an unforeseen TypeError."""
    output = str(tmp_path / "level.ply")
    assert main(["extract", str(with_a_gap / "index.gpkg"), output, "--json"]) == 0
    notes = json.loads(capsys.readouterr().out)["notes"]
    (gap,) = [note for note in notes if note["code"] == "pieces_missing"]
    assert gap["figures"]["path"] == "t"


@pytest.mark.parametrize("damage", [{}, {"sizes": None}, {"sizes": 3}, None])
def test_a_record_without_the_sizes_of_its_levels_counts_as_none(tmp_path, damage):
    """The group above looked for them and ended in a KeyError."""
    raster = write_tif(tmp_path / "a.tif", hills(33, 33).astype("f4"))
    wg.tile_rasters(raster, tmp_path / "t", tile=SIZE)
    path = tmp_path / "t" / "pieces" / "0" / "00000_00001.json"
    record = json.loads(path.read_text())
    del record["sizes"]
    path.write_text("[" * 100_000 if damage is None else json.dumps(record | damage))
    again = wg.tile_rasters(raster, tmp_path / "t", tile=SIZE)
    assert (again.n_made, again.failed) == (1, [])


@pytest.mark.parametrize("size", ["1e999", "[" * 100_000])
def test_a_plan_with_numbers_beyond_all_measure_is_refused_in_one_line(with_a_gap, size):
    plan = json.loads((with_a_gap / "plan.json").read_text())
    plan["files"][0][5] = "SIZE"
    text = json.dumps(plan).replace('"SIZE"', size)
    with pytest.raises(InputFileError, match="plan: this is no plan of tiles"):
        TilePlan.from_json(text, "plan")


@pytest.mark.parametrize(
    "options",
    [
        {"wavelets": {"levels": 3}},
        {"wavelets": {"partition": "none of ours"}},
        {"wavelets": {"removal_fraction": "all"}},
        {"reading": {"band": 1, "nodata": None, "offline": True, "path": "/etc/passwd"}},
    ],
)
def test_a_plan_with_options_that_tiles_do_not_have_is_refused_in_one_line(with_a_gap, options):
    plan = json.loads((with_a_gap / "plan.json").read_text())
    (with_a_gap / "plan.json").write_text(json.dumps({**plan, **options}))
    with pytest.raises(InputFileError, match="this is no plan of tiles") as error:
        open_index(with_a_gap)
    assert "\n" not in str(error.value)
