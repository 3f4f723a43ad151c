"""Rasters in and out through rasterio."""

import numpy as np
import pytest
import rasterio
from gis.samples import UTM, assert_same_raster, hills, write_tif

from wavelet_core import analyse
from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.io.raster import read_dem, write_cog, write_dem
from wavelet_gis.workflows.open import open_terrain

TRANSFORMS = {
    "north-up": rasterio.Affine(10.0, 0.0, 500000.0, 0.0, -10.0, 5100000.0),
    "south-up": rasterio.Affine(10.0, 0.0, 500000.0, 0.0, 10.0, 5100000.0),
    "rotated": rasterio.Affine(8.0, -6.0, 500000.0, -6.0, -8.0, 5100000.0),
    "odd": rasterio.Affine(33.36517799, 0.0, 505010.324995561, 0.0, -29.98, 5275133.368195),
}


def through_a_pyramid(path, out, **options):
    terrain = open_terrain(path, **options)
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=3))
    write_dem(out, geo.restore(), geo.system.wkt)


@pytest.mark.parametrize("name", TRANSFORMS)
@pytest.mark.parametrize(
    ("dtype", "nodata"),
    [
        ("uint8", None),
        ("int16", -32768),
        ("uint16", 65535),
        ("int32", -9999),
        ("float32", float("nan")),
        ("float32", -3.4028234663852886e38),
        ("float64", -9999.0),
        ("float64", None),
    ],
)
def test_every_type_and_transform_comes_back(tmp_path, name, dtype, nodata):
    values = hills(20, 25).astype(dtype) if dtype != "uint8" else (hills(20, 25) / 2).astype("u1")
    if nodata is not None:
        values[3:6, 4:9] = nodata
    source = write_tif(tmp_path / "a.tif", values, transform=TRANSFORMS[name], nodata=nodata)
    through_a_pyramid(source, tmp_path / "b.tif")
    assert_same_raster(source, tmp_path / "b.tif")


def test_compression_tiling_tags_and_description_come_back(tmp_path):
    source = write_tif(
        tmp_path / "a.tif",
        hills(70, 90).astype("f4"),
        compress="deflate",
        predictor=3,
        tiled=True,
        blockxsize=32,
        blockysize=32,
    )
    with rasterio.open(source, "r+") as dataset:
        dataset.update_tags(SURVEY="spring", AREA_OR_POINT="Point")
        dataset.update_tags(1, INSTRUMENT="level")
        dataset.set_band_description(1, "ground")
        dataset.units = ("metre",)
    through_a_pyramid(source, tmp_path / "b.tif")
    assert_same_raster(source, tmp_path / "b.tif")
    with rasterio.open(source) as expected, rasterio.open(tmp_path / "b.tif") as actual:
        assert actual.profile == expected.profile
        assert actual.tags() == expected.tags()
        assert actual.tags(1) == expected.tags(1)
        assert actual.descriptions == expected.descriptions
        assert actual.units == expected.units


def test_a_mask_band_makes_holes_and_comes_back(tmp_path):
    values, mask = hills(20, 20).astype("i2"), np.ones((20, 20), bool)
    mask[4:8, 4:8] = False
    path = tmp_path / "a.tif"
    profile = {"driver": "GTiff", "count": 1, "height": 20, "width": 20, "dtype": "int16"}
    transform = TRANSFORMS["north-up"]
    with (
        rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True),
        rasterio.open(path, "w", crs=UTM, transform=transform, **profile) as dataset,
    ):
        dataset.write(values, 1)
        dataset.write_mask(mask)
    assert (read_dem(path)[0].valid == mask).all()
    through_a_pyramid(path, tmp_path / "b.tif")
    assert_same_raster(path, tmp_path / "b.tif")


def test_nan_without_a_tag_is_a_hole(tmp_path):
    values = hills(12, 12)
    values[2:5, 2:5] = np.nan
    values[8, 8] = np.inf
    source = write_tif(tmp_path / "a.tif", values)
    assert read_dem(source)[0].valid.sum() == 144 - 10
    through_a_pyramid(source, tmp_path / "b.tif")
    assert_same_raster(source, tmp_path / "b.tif")


def test_scaled_values_are_elevations(tmp_path):
    source = write_tif(tmp_path / "a.tif", np.rint(hills() * 10).astype("i2"))
    with rasterio.open(source, "r+") as dataset:
        dataset.scales, dataset.offsets = (0.1,), (-3.0,)
    terrain = open_terrain(source)
    assert 200 < terrain.mesh.vertices[:, 2].mean() < 400
    through_a_pyramid(source, tmp_path / "b.tif")
    assert_same_raster(source, tmp_path / "b.tif")


@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:2056", "EPSG:32632+5773"])
def test_the_crs_comes_back(tmp_path, crs):
    transform = None
    if crs == "EPSG:4326":
        transform = rasterio.Affine(0.001, 0.0, 7.0, 0.0, -0.001, 44.0)
    if crs == "EPSG:2056":
        transform = rasterio.Affine(10.0, 0.0, 2600000.0, 0.0, -10.0, 1200000.0)
    source = write_tif(tmp_path / "a.tif", hills(), crs=crs, transform=transform)
    through_a_pyramid(source, tmp_path / "b.tif")
    assert_same_raster(source, tmp_path / "b.tif")


@pytest.mark.filterwarnings("ignore:.*no CRS")
@pytest.mark.parametrize("driver", ["GTiff", "AAIGrid", "HFA", "SRTMHGT"])
def test_other_formats_of_gdal(tmp_path, driver):
    from rasterio.shutil import copy

    suffix = {"GTiff": "tif", "AAIGrid": "asc", "HFA": "img", "SRTMHGT": "hgt"}[driver]
    if driver == "SRTMHGT":
        step = 1 / 1200
        transform = rasterio.Affine(step, 0, 7 - step / 2, 0, -step, 44 + step / 2)
        base = write_tif(
            tmp_path / "base.tif",
            np.tile(hills(120, 120).astype("i2"), (11, 11))[:1201, :1201],
            crs="EPSG:4326",
            transform=transform,
            nodata=-32768,
        )
        source = tmp_path / "N43E007.hgt"
        copy(base, source, driver=driver)
        dem, _ = read_dem(source)
        assert dem.values.shape == (1201, 1201)
        return
    base = write_tif(tmp_path / "base.tif", hills(30, 30).astype("i2"), nodata=-9999)
    source = tmp_path / f"a.{suffix}"
    copy(base, source, driver=driver)
    through_a_pyramid(source, tmp_path / f"b.{suffix}")
    with rasterio.open(source) as expected, rasterio.open(tmp_path / f"b.{suffix}") as actual:
        assert actual.driver == driver
        assert (actual.read() == expected.read()).all()
        assert actual.nodata == expected.nodata
        np.testing.assert_allclose(actual.transform, expected.transform)


def test_one_of_several_bands(tmp_path):
    source = write_tif(tmp_path / "a.tif", np.stack([hills(seed=1), hills(seed=2)]).astype("f4"))
    with pytest.raises(InputFileError, match=r"2 bands; choose .* with band"):
        read_dem(source)
    with pytest.raises(InputFileError, match="no band 3"):
        read_dem(source, band=3)
    through_a_pyramid(source, tmp_path / "b.tif", band=2)
    assert_same_raster(source, tmp_path / "b.tif", band=2)


def test_what_is_no_dem(tmp_path):
    (tmp_path / "text.tif").write_text("no raster")
    complex_values = write_tif(tmp_path / "complex.tif", hills(5, 5).astype("c8"))
    line = write_tif(
        tmp_path / "line.tif", hills(5, 5), transform=rasterio.Affine(1, 1, 0, 1, 1, 0)
    )
    for path, what in [
        (tmp_path / "absent.tif", "no such file"),
        (tmp_path, "folder"),
        (tmp_path / "text.tif", "no raster"),
        (complex_values, "real numbers"),
        (line, "onto a line"),
    ]:
        with pytest.raises(InputFileError, match=what):
            read_dem(path)


def test_a_file_that_ends_early_is_refused(tmp_path):
    path = write_tif(tmp_path / "a.tif", hills(64, 64).astype("f4"), compress="deflate")
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(InputFileError, match="damaged"):
        read_dem(path)


def test_formats_that_cannot_be_written(tmp_path, tif):
    dem, place = read_dem(tif)
    with pytest.raises(OutputFileError, match="no raster format"):
        write_dem(tmp_path / "a.nonsense", dem, place.wkt)
    with pytest.raises(OutputFileError, match=r"name ending in \.tif"):
        write_dem(tmp_path / "a.png", dem, place.wkt)  # PNG holds no float32


@pytest.mark.parametrize(
    "profile",
    [
        {"options": 7, "tags": "x", "band_tags": [1]},
        {"options": {"compress": "jpeg", "predictor": 9, "tiled": "yes"}},
        {"options": {"compress": ["lzw"], "tiled": True, "blockxsize": 17, "blockysize": 10**9}},
        {"options": {"compress": "deflate", "predictor": [2]}, "description": 5, "unit": 3.5},
        {"options": {"driver": "PNG", "count": 4}, "tags": {"A": 1}},
    ],
)
def test_hints_of_a_stranger_do_no_harm(tmp_path, tif, profile):
    from dataclasses import replace

    dem, place = read_dem(tif)
    write_dem(tmp_path / "a.tif", replace(dem, profile=profile), place.wkt)
    assert_same_raster(tif, tmp_path / "a.tif")


def test_a_crs_that_is_none_is_told_of(tmp_path, tif):
    dem, _ = read_dem(tif)
    with pytest.raises(OutputFileError, match="GDAL cannot write"):
        write_dem(tmp_path / "a.tif", dem, "nonsense")


def test_a_format_that_changes_the_values_is_refused(tmp_path):
    source = write_tif(tmp_path / "a.tif", (hills(40, 40) / 2).astype("u1"))
    dem, place = read_dem(source)
    with pytest.raises(OutputFileError, match="changes the values"):
        write_dem(tmp_path / "a.jpg", dem, place.wkt)


def test_a_cloud_optimised_geotiff_is_one(tmp_path, tif):
    dem, place = read_dem(tif)
    write_cog(tmp_path / "cog.tif", dem, place.wkt)
    with rasterio.open(tmp_path / "cog.tif") as dataset:
        assert dataset.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
        assert dataset.read(1).tobytes() == dem.values.tobytes()
