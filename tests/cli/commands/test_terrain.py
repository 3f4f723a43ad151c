"""The command that writes tiles for globes."""

import json
import os
import warnings

import numpy as np
import pytest
import rasterio
from gis.samples import hills, write_las, write_tif

from wavelet_gis.errors import CrsError
from wavelet_gis.io.atomic import new_folder
from wavelet_gis.io.read_back import write_text


def test_tiles_of_a_dem_and_of_its_pyramid(done, tmp_path):
    dem = write_tif(tmp_path / "dem.tif", hills(60, 70))
    figures = done("terrain", dem, tmp_path / "a", "--max-error", 1, "--json").figures
    assert json.loads((tmp_path / "a" / "layer.json").read_text("utf-8"))["name"] == "dem.tif"
    assert [zoom["promised"] for zoom in figures["zooms"]][-2:] == [2.0, 1.0]
    assert all(zoom["max_error"] <= zoom["promised"] for zoom in figures["zooms"])
    done("analyse", dem, tmp_path / "dem.gpkg", "--levels", 3)
    done("terrain", tmp_path / "dem.gpkg", tmp_path / "b", "--max-error", 1)
    said = done("terrain", tmp_path / "dem.gpkg", tmp_path / "b", "--overwrite", "--level", 1).out
    assert "promised (m)" in said


def test_a_tile_set_gives_the_tiles_of_its_input(done, refused, tmp_path):
    dem = write_tif(tmp_path / "dem.tif", hills(60, 70))
    index = tmp_path / "tiles" / "index.gpkg"
    done("tile", dem, tmp_path / "tiles", "--tile", 32, "--levels", 3, "--workers", 1)
    done("terrain", dem, tmp_path / "a", "--max-error", 1)
    done("terrain", index, tmp_path / "b", "--max-error", 1)
    tiles = [
        {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*.terrain")}
        for folder in (tmp_path / "a", tmp_path / "b")
    ]
    assert len(tiles[0]) > 5
    assert tiles[0] == tiles[1]
    done("terrain", index, tmp_path / "c", "--level", 3, "--max-error", 1)
    message = refused("terrain", index, tmp_path / "d", "--crs", "EPSG:4326")
    assert "--crs is for other input" in message


def test_what_is_refused(refused, tmp_path):
    dem = write_tif(tmp_path / "dem.tif", hills(20, 20))
    write_las(tmp_path / "cloud.laz")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "a.txt").write_text("a", "utf-8")
    assert "no folder with a layer.json" in refused("terrain", dem, tmp_path / "full")
    assert "there is no such folder" in refused("terrain", dem, tmp_path / "no" / "where")
    assert "--level is for one" in refused("terrain", dem, tmp_path / "out", "--level", 1)
    assert "--max-zoom is 99" in refused("terrain", dem, tmp_path / "out", "--max-zoom", 99)
    cloud = tmp_path / "cloud.laz"
    assert "--band is for a raster" in refused("terrain", cloud, tmp_path / "out", "--band", 1)


def test_a_pyramid_refuses_what_is_for_other_input(done, refused, tmp_path):
    dem = write_tif(tmp_path / "dem.tif", hills(20, 20))
    done("analyse", dem, tmp_path / "dem.gpkg", "--levels", 2)
    pyramid = tmp_path / "dem.gpkg"
    for flag, value in (("--crs", "EPSG:4326"), ("--band", "1")):
        message = refused("terrain", pyramid, tmp_path / "out", flag, value)
        assert flag in message
        assert "leave it out" in message


@pytest.mark.parametrize("words", [("--fill", "nan"), ("--fill", "inf")])
def test_a_height_that_is_none_is_refused(refused, tmp_path, words):
    dem = write_tif(tmp_path / "dem.tif", hills(12, 12))
    assert "--fill is" in refused("terrain", dem, tmp_path / "out", *words)


@pytest.mark.parametrize(
    ("crs", "west", "cell"), [("EPSG:4326", 179.99, 0.001), ("EPSG:3994", -8.7e6, 500.0)]
)
def test_terrain_on_both_sides_of_180_degrees_is_refused(tmp_path, crs, west, cell):
    """It gave 16,378 tiles around the earth instead of a few."""
    import wavelet_gis as wg

    if crs == "EPSG:3994":
        from pyproj import Transformer

        west = (
            Transformer.from_crs(4326, crs, always_xy=True).transform(180.0, -30.0)[0] - 10 * cell
        )
    place = rasterio.Affine(cell, 0.0, west, 0.0, -cell, 10.0 if cell < 1 else -2.6e6)
    path = write_tif(tmp_path / "dem.tif", hills(20, 20), crs=crs, transform=place)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        terrain = wg.open(path)
        with pytest.raises(CrsError, match="both sides of longitude 180"):
            wg.terrain_tiles(terrain, tmp_path / "out")


def test_a_set_that_cannot_take_its_place_leaves_the_old_one(tmp_path, monkeypatch):
    """The old folder had been moved away already, and was lost."""
    target = tmp_path / "out"
    target.mkdir()
    (target / "layer.json").write_text("old")
    replace = os.replace

    def fails(source, destination):
        if os.path.abspath(destination) == str(target) and os.path.basename(source) == "out":
            raise PermissionError("held by another program")
        replace(source, destination)

    monkeypatch.setattr(os, "replace", fails)
    with pytest.raises(PermissionError), new_folder(target, "layer.json", overwrite=True) as made:
        write_text(made / "layer.json", "new")
    assert (target / "layer.json").read_text() == "old"


def test_the_bar_moves_evenly_over_all_zooms(tmp_path):
    """Counted by tiles, it stood still where few tiles have all the points, at the first zooms."""
    import wavelet_gis as wg

    seen = []
    dem = write_tif(tmp_path / "dem.tif", hills(60, 70))
    tiles = wg.terrain_tiles(wg.open(dem), tmp_path / "out", progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1.0)
    assert len(seen) > 4 * len(tiles.zooms)
    assert max(np.diff(seen)) < 0.1
