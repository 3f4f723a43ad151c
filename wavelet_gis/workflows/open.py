"""From a file to the terrain that is analysed."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from wavelet_gis.crs.frame import vertical_unit_name
from wavelet_gis.errors import CrsError, InputFileError
from wavelet_gis.model.categories import one_channel_per_category
from wavelet_gis.model.terrain import Terrain, terrain_of_cloud, terrain_of_dem

__all__ = ["CLOUD_SUFFIXES", "open_terrain"]

#: What is read with laspy; anything else is left to GDAL.
CLOUD_SUFFIXES = (".las", ".laz")


def open_terrain(
    path: str | os.PathLike[str],
    *,
    band: int | None = None,
    attributes: Sequence[str] = (),
    classes: Sequence[int] | None = None,
    carry: bool = True,
    class_channels: bool = False,
    crs: str | None = None,
    vertical_unit: str | None = None,
) -> Terrain:
    """Return the terrain in a raster or a LAS file.

    Parameters
    ----------
    path : path
        ``.las`` and ``.laz`` are read with laspy, all else with GDAL.
    band : int, optional
        Of a raster, from 1.
    attributes, classes, carry
        Of a point cloud; see `wavelet_gis.io.las.read_cloud`.
    class_channels : bool
        Lift classes, return numbers and other categories as one channel of 0 and 1 each.
    crs : str, optional
        Instead of the CRS in the file.
    vertical_unit : str, optional
        Unit of z, instead of what the file tells.

    Raises
    ------
    InputFileError, CrsError, MeshError
        As the readers do.

    Warns
    -----
    CrsWarning
        When there is no CRS, or one whose x and y are no map plane.
    UnitWarning
        When z is in another unit than the working frame and is converted.
    """
    from wavelet_gis.crs.lookup import coordinate_system

    override = coordinate_system(crs) if crs else None
    if Path(path).suffix.lower() in CLOUD_SUFFIXES:
        from wavelet_gis.io.las import read_cloud

        if band is not None:
            raise InputFileError(f"{path}: a point cloud has no bands; leave --band out.")
        cloud, place = read_cloud(path, attributes=attributes, classes=classes, carry=carry)
        if class_channels:
            cloud = one_channel_per_category(cloud)
        system = override or coordinate_system(place.wkt)
        return terrain_of_cloud(
            os.fspath(path), cloud, system, vertical_unit or place.vertical_unit, fault=place.fault
        )
    from wavelet_gis.io.raster import read_dem

    if attributes or classes is not None:
        raise InputFileError(
            f"{path}: --attributes and --classes are for point clouds; leave them out for a raster."
        )
    dem, place = read_dem(path, band=band)
    system = override or coordinate_system(place.wkt)
    unit = vertical_unit or _known_unit(place.vertical_unit)
    return terrain_of_dem(os.fspath(path), dem, system, unit)


def _known_unit(unit: str | None) -> str | None:
    """Return the unit that a raster band names, if it is a length that we know."""
    try:
        return vertical_unit_name(unit) if unit else None
    except CrsError:
        return None
