"""The command that writes tiles for globes."""

import json

from gis.samples import hills, write_las, write_tif


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
