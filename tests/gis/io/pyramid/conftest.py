"""Pyramid files of either format."""

import pytest
from tools.format_one import write_format_one

#: Those whose steps are listed in arrays of their own, which the reader must check one by one.
LISTED = ["raster of format 1", "cloud of format 1"]
RECORDED = ["raster", "cloud"]


@pytest.fixture(scope="session")
def of_format_one(raster_record, cloud_record, tmp_path_factory):
    """Return the paths of files of format 1, by the name of the terrain; do not change them."""
    folder = tmp_path_factory.mktemp("format_one")
    for name, geo in (("raster", raster_record), ("cloud", cloud_record)):
        write_format_one(folder / f"{name}.gpkg", geo)
    return {name: folder / f"{name}.gpkg" for name in RECORDED}


@pytest.fixture(params=[*RECORDED, *LISTED])
def sound(request, raster_pyramid, cloud_pyramid, of_format_one):
    """Return a sound file; do not change it."""
    paths = {"raster": raster_pyramid, "cloud": cloud_pyramid}
    paths |= {f"{name} of format 1": path for name, path in of_format_one.items()}
    return paths[request.param]
