"""From a file to the terrain that is analysed."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from pathlib import Path

from wavelet_gis.crs.frame import MAX_DISTORTION, vertical_unit_name
from wavelet_gis.errors import CrsError, CrsWarning, InputFileError
from wavelet_gis.io.names import readable
from wavelet_gis.model.terrain import Terrain, terrain_of_cloud, terrain_of_dem

__all__ = ["CLOUD_SUFFIXES", "open_terrain"]

#: Beyond it a plane is told to be untrue: the same error that a frame for degrees may have.
LARGEST_SCALE_ERROR = MAX_DISTORTION

#: What is read with laspy; anything else is left to GDAL.
CLOUD_SUFFIXES = (".las", ".laz")


def open_terrain(
    path: str | os.PathLike[str],
    *,
    band: int | None = None,
    attributes: Sequence[str] = (),
    classes: Sequence[int] | None = None,
    carry: bool = True,
    crs: str | None = None,
    vertical_unit: str | None = None,
    nodata: float | str | None = None,
    offline: bool = False,
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
    crs : str, optional
        Instead of the CRS in the file.
    vertical_unit : str, optional
        Unit of z, instead of what the file tells.
    nodata, offline
        Of a raster; see `wavelet_gis.io.raster.read_dem`.

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
        if nodata is not None:
            raise InputFileError(f"{path}: a point cloud has no nodata; leave --nodata out.")
        cloud, place = read_cloud(path, attributes=attributes, classes=classes, carry=carry)
        system = override or coordinate_system(place.wkt)
        terrain = terrain_of_cloud(
            readable(path), cloud, system, vertical_unit or place.vertical_unit, fault=place.fault
        )
        _tell_of_scale(terrain)
        return terrain
    from wavelet_gis.io.raster import read_dem

    if attributes or classes is not None:
        raise InputFileError(
            f"{path}: --attributes and --classes are for point clouds; leave them out for a raster."
        )
    dem, place = read_dem(path, band=band, nodata=nodata, offline=offline)
    system = override or coordinate_system(place.wkt)
    unit = vertical_unit or _known_unit(place.vertical_unit)
    terrain = terrain_of_dem(readable(path), dem, system, unit)
    _tell_of_scale(terrain)
    return terrain


def _tell_of_scale(terrain: Terrain) -> None:
    """Warn where the plane is not true to scale, as Web Mercator far from the equator."""
    from wavelet_gis.crs.projection import scale_at

    low, high = terrain.mesh.vertices.min(axis=0), terrain.mesh.vertices.max(axis=0)
    x, y = (low[:2] + high[:2]) / 2
    scale = scale_at(terrain.system, float(x), float(y))
    if abs(scale - 1.0) > LARGEST_SCALE_ERROR:
        how = f"{scale:.3g} times too long" if scale > 1 else f"{1 / scale:.3g} times too short"
        warnings.warn(
            f"{terrain.name}: distances in {terrain.system.name} are {how} here, and slopes and "
            "areas wrong with them; reproject the input, to its UTM zone for instance",
            CrsWarning,
            stacklevel=3,
        )


def _known_unit(unit: str | None) -> str | None:
    """Return the unit that a raster band names, if it is a length that we know."""
    try:
        return vertical_unit_name(unit) if unit else None
    except CrsError:
        return None
