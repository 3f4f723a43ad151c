"""Planes for degrees, and how true to scale a plane is, by pyproj."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import MissingDependencyError
from wavelet_gis.crs.frame import CoordinateSystem
from wavelet_gis.crs.lookup import coordinate_system
from wavelet_gis.errors import CrsError

__all__ = ["AUTO", "plane_for", "projected", "scale_at"]

#: Stands for the UTM zone of the data.
AUTO = "auto"

FloatArray = NDArray[np.float64]


def plane_for(system: CoordinateSystem, xy: FloatArray, to_crs: str = AUTO) -> CoordinateSystem:
    """Return the projected CRS that coordinates are to go to.

    Parameters
    ----------
    system : CoordinateSystem
        Of the coordinates.
    xy : (n, 2) float64
        Where they are; longitude and latitude where geographic.
    to_crs : str
        A definition, or ``"auto"``: the UTM zone of the middle, on the input's own datum where
        EPSG has such a zone and else on WGS 84; near the poles the polar stereographic of UPS.

    Raises
    ------
    CrsError
        Without a CRS to start from, or when the one to go to is none of a plane.
    MissingDependencyError
        Without pyproj, as QGIS may be.
    """
    if system.wkt is None or system.kind == "unknown":
        raise CrsError(
            "the input has no CRS to transform from; give it with {0}, or leave {1} out.",
            "crs",
            "to_crs",
        )
    if find_spec("pyproj") is None:
        raise MissingDependencyError(
            "transforming coordinates needs pyproj; install it with 'pip install pyproj', or "
            "give input in a projected CRS."
        )
    if to_crs.lower() != AUTO:
        plane = coordinate_system(to_crs)
        if plane.kind != "projected":
            raise CrsError(f"the CRS {to_crs!r} is not projected; give one that is.")
        return plane
    x, y = (xy.min(axis=0) + xy.max(axis=0)) / 2
    longitude, latitude = _degrees(system, float(x), float(y))
    return coordinate_system(f"EPSG:{_utm_code(system, longitude, latitude)}")


def projected(
    system: CoordinateSystem, plane: CoordinateSystem, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return coordinates in another CRS.

    Raises
    ------
    CrsError
        When some of them have no place there.
    """
    from pyproj import Transformer

    transformer = Transformer.from_crs(_horizontal(system), _horizontal(plane), always_xy=True)
    east, north = transformer.transform(x, y)
    if not (np.isfinite(east).all() and np.isfinite(north).all()):
        raise CrsError(
            "some points cannot be transformed to {crs}; give another CRS with {0}.",
            "to_crs",
            crs=plane.name,
        )
    return np.asarray(east, dtype=np.float64), np.asarray(north, dtype=np.float64)


def scale_at(system: CoordinateSystem, x: float, y: float) -> float:
    """Return how many times too long (or, below 1, too short) distances in a plane are at a point.

    The larger of the scales along meridian and parallel; 1 where it is unknown.
    """
    if system.kind != "projected" or system.wkt is None:
        return 1.0
    from pyproj import Proj
    from pyproj.exceptions import ProjError

    try:
        longitude, latitude = _degrees(system, x, y)
        factors = Proj(_horizontal(system)).get_factors(longitude, latitude)
    except (ProjError, CrsError):
        return 1.0
    scales = np.array([factors.meridional_scale, factors.parallel_scale], dtype=float)
    if not np.isfinite(scales).all() or (scales <= 0).any():
        return 1.0
    return float(scales[np.argmax(np.abs(np.log(scales)))])


def _degrees(system: CoordinateSystem, x: float, y: float) -> tuple[float, float]:
    from pyproj import Transformer

    horizontal = _horizontal(system)
    geographic = horizontal.geodetic_crs
    transformer = Transformer.from_crs(horizontal, geographic, always_xy=True)
    east, north = transformer.transform(x, y)
    to_degrees = float(np.degrees(geographic.axis_info[0].unit_conversion_factor))
    longitude = (east * to_degrees + 180.0) % 360.0 - 180.0
    if not np.isfinite([longitude, north]).all():
        raise CrsError("the coordinates cannot be placed on the earth; check their CRS.")
    return float(longitude), float(north * to_degrees)


def _utm_code(system: CoordinateSystem, longitude: float, latitude: float) -> int:
    from pyproj.aoi import AreaOfInterest
    from pyproj.database import query_utm_crs_info

    if latitude > 84.0:
        return 5041
    if latitude < -80.0:
        return 5042
    zone = int((longitude + 180.0) // 6.0) % 60 + 1
    name = f"UTM zone {zone}{'N' if latitude >= 0 else 'S'}"
    geographic = _horizontal(system).geodetic_crs
    area = AreaOfInterest(longitude, latitude, longitude, latitude)
    datum = geographic.name.replace(" ", "")
    for info in query_utm_crs_info(datum_name=datum, area_of_interest=area):
        if info.name.endswith(name):
            return int(info.code)
    return (32600 if latitude >= 0 else 32700) + zone


def _horizontal(system: CoordinateSystem) -> Any:
    from pyproj import CRS

    from wavelet_gis.crs.lookup import horizontal_part

    return horizontal_part(CRS.from_user_input(system.wkt))
