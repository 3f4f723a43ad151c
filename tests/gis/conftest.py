"""Fixtures of the adapters' tests."""

import os
import shutil
import subprocess

import numpy as np
import pytest
from gis.samples import hills, write_las, write_tif

from wavelet_core import analyse
from wavelet_gis.io.pyramid.pyramid_file import write_pyramid
from wavelet_gis.workflows.open import open_terrain


@pytest.fixture(scope="session")
def tif(tmp_path_factory):
    """Return a float32 DEM in UTM with a hole."""
    values = hills().astype("f4")
    values[5:9, 7:12] = -9999
    return write_tif(tmp_path_factory.mktemp("tif") / "hills.tif", values, nodata=-9999)


@pytest.fixture(scope="session")
def las(tmp_path_factory):
    """Return a cloud of ground and trees in UTM."""
    return write_las(tmp_path_factory.mktemp("las") / "trees.laz")


@pytest.fixture(scope="session")
def raster_record(tif):
    """Return the pyramid of the DEM."""
    terrain = open_terrain(tif)
    return terrain.geo_pyramid(analyse(terrain.mesh, levels=4)).with_errors()


@pytest.fixture(scope="session")
def cloud_record(las):
    """Return the pyramid of the cloud, with attributes."""
    terrain = open_terrain(las, attributes=["classification", "hag", "intensity"])
    return terrain.geo_pyramid(analyse(terrain.mesh, levels=4))


@pytest.fixture(scope="session")
def raster_pyramid(raster_record, tmp_path_factory):
    """Return the DEM's pyramid file, without layers; do not change it."""
    path = tmp_path_factory.mktemp("pyramid") / "raster.gpkg"
    write_pyramid(path, raster_record)
    return path


@pytest.fixture(scope="session")
def cloud_pyramid(cloud_record, tmp_path_factory):
    """Return the cloud's pyramid file, without layers; do not change it."""
    path = tmp_path_factory.mktemp("pyramid") / "cloud.gpkg"
    write_pyramid(path, cloud_record)
    return path


@pytest.fixture(scope="session")
def validate_gpkg():
    """Return a function that asserts that GDAL's validator finds no fault in a file."""
    for python in ("/usr/bin/python3", shutil.which("python3")):
        command = [python, "-m", "osgeo_utils.samples.validate_gpkg"]
        if python and _runs([*command, "--help"]):
            break
    else:
        pytest.skip("no GDAL with its Python samples (Debian: python3-gdal)")

    def validate(path):
        result = subprocess.run(
            [*command, "--extra", "--warning-as-error", str(path)],
            capture_output=True,
            text=True,
            env={"PATH": os.environ["PATH"]},
        )
        assert result.returncode == 0, result.stdout + result.stderr

    return validate


def _runs(command):
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    return "my.gpkg" in result.stdout + result.stderr


@pytest.fixture
def rng():
    """Return a generator of the same numbers every time."""
    return np.random.default_rng(7)
