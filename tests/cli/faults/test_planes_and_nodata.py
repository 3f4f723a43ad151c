"""What the commands tell of planes, units, fillers and the network, by the names of their flags."""

import re

import numpy as np
import pytest
import rasterio
from gis.samples import hills, write_tif

from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

DEGREES = rasterio.Affine(0.0003, 0.0, 7.0, 0.0, -0.0003, 44.0)
FAR_NORTH = rasterio.Affine(10.0, 0.0, 1e6, 0.0, -10.0, 11e6)


def codes(outcome):
    return [note["code"] for note in outcome.figures["notes"]]


@pytest.fixture
def in_degrees(tmp_path):
    return write_tif(tmp_path / "d.tif", hills(), crs="EPSG:4326", transform=DEGREES)


def test_a_mesh_file_of_degrees_is_in_metres_and_both_ways_tell(done, in_degrees, tmp_path):
    said = done("simplify", in_degrees, tmp_path / "a.obj", "--vertices", 60)
    assert "in WGS 84 / UTM zone 32N, instead of degrees (--to-crs names another CRS)" in said.out
    said = done("simplify", in_degrees, tmp_path / "b.obj", "--vertices", 60, "--json")
    assert "mesh_file_crs" in codes(said)
    assert (tmp_path / "a.obj").read_bytes() == (tmp_path / "b.obj").read_bytes()
    lines = (tmp_path / "a.obj").read_text("ascii").splitlines()
    x = [float(line.split()[1]) for line in lines if line.startswith("v ")]
    assert 1000 < np.ptp(x) < 1300  # metres


def test_extract_takes_the_crs_that_is_named_for_mesh_files_only(done, refused, tif, tmp_path):
    done("analyse", tif, tmp_path / "a.gpkg", "--levels", 2)
    done("extract", tmp_path / "a.gpkg", tmp_path / "a.xml", "--to-crs", "EPSG:25833")
    assert "zone 33N" in (tmp_path / "a.xml").read_text("utf-8")
    for name in ("b.tif", "b.gpkg"):
        message = refused("extract", tmp_path / "a.gpkg", tmp_path / name, "--to-crs", "auto")
        assert "--to-crs is for mesh files" in message


def test_a_plane_out_of_scale_is_told_and_stays_with_the_pyramid(done, tmp_path):
    source = write_tif(tmp_path / "m.tif", hills(), crs="EPSG:3857", transform=FAR_NORTH)
    said = done("analyse", source, tmp_path / "a.gpkg", "--levels", 2)
    assert "Mercator are 2.89 times too long" in said.err
    assert codes(done("info", tmp_path / "a.gpkg", "--json")) == ["plane_not_true_to_scale"]


def test_fillers_are_told_by_the_flag_that_names_them(done, refused, tmp_path):
    values = hills(20, 20).astype("f4")
    values[3:5, 3:9] = -9999
    source = write_tif(tmp_path / "a.tif", values)
    said = done("analyse", source, tmp_path / "a.gpkg", "--levels", 1)
    assert "--nodata -9999 makes them holes" in said.err
    said = done("analyse", source, tmp_path / "b.gpkg", "--levels", 1, "--nodata", "-9999")
    assert said.err == ""
    assert read_pyramid(tmp_path / "b.gpkg").origin.valid.sum() == 400 - 12
    text = refused("analyse", source, tmp_path / "a.gpkg")
    assert re.search("this file exists; .*--overwrite", text)


def test_the_network_is_refused_by_its_flag(refused, tmp_path):
    (tmp_path / "a.vrt").write_text(
        '<VRTDataset rasterXSize="4" rasterYSize="4"><VRTRasterBand dataType="Float32" band="1">'
        "<SimpleSource><SourceFilename>/vsicurl/http://127.0.0.1:9/a.tif</SourceFilename>"
        "</SimpleSource></VRTRasterBand></VRTDataset>"
    )
    message = refused("analyse", tmp_path / "a.vrt", tmp_path / "a.gpkg", "--offline")
    assert "which --offline forbids" in message


def test_a_pyramid_without_levels_has_no_details_to_show_or_change(done, refused, tmp_path):
    source = write_tif(tmp_path / "a.tif", hills(2, 2))
    done("analyse", source, tmp_path / "a.gpkg", "--levels", 0)
    assert "no levels" in refused("details", tmp_path / "a.gpkg", tmp_path / "b.tif")
    arguments = (tmp_path / "a.gpkg", tmp_path / "b.tif", "--gain", "0=2")
    assert "no levels" in refused("filter", *arguments)
