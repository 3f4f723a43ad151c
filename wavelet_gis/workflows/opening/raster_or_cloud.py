"""The terrain in rasters and LAS files, as their readers give it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

from wavelet_gis.crs.frame import CoordinateSystem, vertical_unit_name
from wavelet_gis.errors import CrsError, InputFileError
from wavelet_gis.io.formats import EPT, is_cloud
from wavelet_gis.io.las.ept import nodes_within, read_ept
from wavelet_gis.io.names import files_of, joint_name, readable
from wavelet_gis.model.attributes.categories import one_channel_per_category
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.model.terrain import Terrain, terrain_of_cloud, terrain_of_dem
from wavelet_gis.workflows.opening.input_options import (
    CLOUD,
    RASTER,
    require_meaning,
    system_given,
)

__all__ = ["ReadPoints", "open_points", "open_terrain"]

Path = str | os.PathLike[str]


def open_terrain(
    path: Path | Sequence[Path],
    *,
    band: int | None = None,
    attributes: Sequence[str] = (),
    classes: Sequence[int] | None = None,
    carry: bool = True,
    class_channels: bool = False,
    crs: str | None = None,
    vertical_unit: str | None = None,
    nodata: float | str | None = None,
    offline: bool = False,
    keep_noise: bool = False,
    keep_withheld: bool = False,
    duplicates: str | None = None,
    max_edge: float | Literal["auto"] | None = None,
    concave: bool = False,
    bbox: tuple[float, float, float, float] | None = None,
    resolution: float | None = None,
) -> Terrain:
    """Return the terrain in a raster or a LAS file, or in several that are parts of one.

    Parameters
    ----------
    path : path or sequence of path
        ``.las`` and ``.laz`` are read with laspy, all else with GDAL; see `open_data` for several.
    band : int, optional
        Of a raster, from 1.
    attributes, classes, carry, keep_noise, keep_withheld, bbox, resolution
        Of a point cloud; see `wavelet_gis.io.las.read_cloud`.
    class_channels : bool
        Lift classes, return numbers and other categories as one channel of 0 and 1 each.
    crs : str, optional
        Instead of the CRS in the file.
    vertical_unit : str, optional
        Unit of z, instead of what the file says.
    nodata, offline
        Of a raster; see `wavelet_gis.io.raster.read_dem`.
    duplicates, max_edge, concave
        Of a point cloud; see `wavelet_gis.model.points.mesh.cloud_mesh`.

    Raises
    ------
    InputFileError, CrsError, MeshError
        As the readers do.

    Warns
    -----
    CrsWarning
        When there is no CRS, or one whose x and y are not a map plane.
    UnitWarning
        When z is in another unit than the working frame and is converted.
    """
    override = system_given(crs)
    files = files_of(path)
    of_raster = {"band": band, "nodata": nodata, "offline": offline}
    of_reading = {
        "attributes": attributes,
        "classes": classes,
        "carry": carry,
        "keep_noise": keep_noise,
        "keep_withheld": keep_withheld,
        "bbox": bbox,
        "resolution": resolution,
    }
    of_surface: dict[str, Any] = {
        "duplicates": duplicates,
        "max_edge": max_edge,
        "concave": concave,
    }
    name = readable(joint_name(files))
    if is_cloud(files[0]):
        require_meaning(name, CLOUD, {"band": band, "nodata": nodata})
        read = _read_points(name, files, override, vertical_unit, of_reading)
        cloud = one_channel_per_category(read.cloud) if class_channels else read.cloud
        return terrain_of_cloud(
            name, cloud, read.system, read.vertical_unit, fault=read.fault, **of_surface
        )
    require_meaning(name, RASTER, {**of_reading, **of_surface, "class_channels": class_channels})
    return _terrain_of_raster(name, files, override, vertical_unit, of_raster)


class ReadPoints(NamedTuple):
    """Points as their files have them.

    name : str, for messages
    cloud : PointCloud
    system : CoordinateSystem
    vertical_unit : str or None
    fault : str, why there is no CRS
    """

    name: str
    cloud: PointCloud
    system: CoordinateSystem
    vertical_unit: str | None
    fault: str


def open_points(
    path: Path | Sequence[Path],
    *,
    crs: str | None = None,
    vertical_unit: str | None = None,
    **of_reading: Any,
) -> ReadPoints:
    """Return the points of one LAS file or of several, without making a surface of them.

    Parameters
    ----------
    path, crs, vertical_unit
        See `open_terrain`.
    **of_reading
        See `wavelet_gis.io.las.read_cloud`.

    Raises
    ------
    InputFileError
        No point cloud, or one that cannot be read.
    """
    files = files_of(path)
    name = readable(joint_name(files))
    if not is_cloud(files[0]):
        raise InputFileError(f"{name}: this is no point cloud; name LAS, LAZ or COPC files.")
    return _read_points(name, files, system_given(crs), vertical_unit, of_reading)


def _read_points(
    name: str,
    files: Sequence[str],
    override: CoordinateSystem | None,
    vertical_unit: str | None,
    of_reading: dict[str, Any],
) -> ReadPoints:
    from wavelet_gis.crs.lookup import coordinate_system
    from wavelet_gis.io.las import read_cloud, read_clouds

    wkt = None
    if os.path.basename(files[0]) == EPT and not files[1:]:
        ept = read_ept(files[0])
        files = nodes_within(ept, of_reading.get("bbox"), of_reading.get("resolution"))
        of_reading = {**of_reading, "resolution": None}
        wkt = ept.wkt  # where the files themselves have none
    cloud, place = (
        read_clouds(
            files, any_crs=override is not None, any_unit=vertical_unit is not None, **of_reading
        )
        if files[1:]
        else read_cloud(files[0], **of_reading)
    )
    system = override or coordinate_system(place.wkt or wkt)
    return ReadPoints(name, cloud, system, vertical_unit or place.vertical_unit, place.fault)


def _terrain_of_raster(
    name: str,
    files: Sequence[str],
    override: CoordinateSystem | None,
    vertical_unit: str | None,
    of_raster: dict[str, Any],
) -> Terrain:
    from wavelet_gis.crs.lookup import coordinate_system
    from wavelet_gis.io.raster import read_dem, read_dems

    dem, place = (
        read_dems(
            files, any_crs=override is not None, any_unit=vertical_unit is not None, **of_raster
        )
        if files[1:]
        else read_dem(files[0], **of_raster)
    )
    system = override or coordinate_system(place.wkt)
    unit = vertical_unit or _known_unit(place.vertical_unit)
    return terrain_of_dem(name, dem, system, unit)


def _known_unit(unit: str | None) -> str | None:
    """Return the unit that a raster band names, if it is a length that we know."""
    try:
        return vertical_unit_name(unit) if unit else None
    except CrsError:
        return None
