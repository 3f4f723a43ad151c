"""CRS definitions read with pyproj into the numbers of `wavelet_gis.crs.frame`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wavelet_gis.crs.frame import VERTICAL_UNITS, CoordinateSystem, Kind, vertical_unit_name
from wavelet_gis.errors import CrsError

if TYPE_CHECKING:
    from pyproj import CRS

__all__ = ["coordinate_system", "epsg_of", "horizontal_part"]


def coordinate_system(definition: str | None) -> CoordinateSystem:
    """Return what is known of the CRS that a text defines.

    Parameters
    ----------
    definition : str or None
        WKT, ``EPSG:2154``, a PROJ string; None or an empty text for no CRS.

    Raises
    ------
    CrsError
        When pyproj does not understand the definition.

    Examples
    --------
    >>> coordinate_system("EPSG:4326").kind, coordinate_system("EPSG:2154").kind
    ('geographic', 'projected')
    """
    if not definition or not definition.strip():
        return CoordinateSystem()
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    try:
        crs = CRS.from_user_input(definition)
    except CRSError as error:
        raise CrsError(
            f"the CRS {_shortened(definition)!r} is not understood; give one such as EPSG:2154."
        ) from error
    # The definition is kept as it came where it is WKT: another version of PROJ would write
    # another text, and the file's CRS would not come back as it was.
    is_wkt = "[" in definition
    wkt = definition if is_wkt else crs.to_wkt()
    horizontal = horizontal_part(crs)
    ellipsoid = crs.ellipsoid
    return CoordinateSystem(
        wkt=wkt,
        name=crs.name,
        kind=_kind(horizontal),
        horizontal_unit=_horizontal_unit(horizontal),
        vertical_unit=_vertical_unit(crs),
        semi_major=ellipsoid.semi_major_metre if ellipsoid else 6378137.0,
        inverse_flattening=ellipsoid.inverse_flattening if ellipsoid else 298.257223563,
    )


def epsg_of(system: CoordinateSystem) -> int | None:
    """Return the EPSG code of a CRS where its definition names one, else None."""
    if system.wkt is None:
        return None
    from pyproj import CRS

    code: int | None = CRS.from_user_input(system.wkt).to_epsg(min_confidence=100)
    return code


def horizontal_part(crs: CRS) -> CRS:
    """Return what a CRS says of x and y, without heights and datum shifts."""
    while crs.is_bound or crs.is_compound:
        part = crs.source_crs if crs.is_bound else crs.sub_crs_list[0]
        if part is None:
            break
        crs = part
    return crs


def _kind(horizontal: CRS) -> Kind:
    if horizontal.is_geographic:
        return "geographic"
    return "projected" if horizontal.is_projected else "unknown"


def _horizontal_unit(horizontal: CRS) -> float:
    if _kind(horizontal) == "unknown" or not horizontal.axis_info:
        return 1.0
    units = [float(axis.unit_conversion_factor) for axis in horizontal.axis_info[:2]]
    if not all(math.isfinite(unit) and unit > 0.0 for unit in units) or len(set(units)) > 1:
        raise CrsError(
            f"the CRS {_shortened(horizontal.name)!r} counts x and y in units of "
            f"{' and '.join(f'{unit:g}' for unit in units)} metres or radians; name the right CRS."
        )
    return units[0]


def _vertical_unit(crs: CRS) -> str | None:
    """Name of the unit of an upward axis, if the CRS has one in a unit that we know."""
    source = crs.source_crs if crs.is_bound and crs.source_crs is not None else crs
    for axis in source.axis_info:
        if axis.direction.lower() == "up":
            for name, metres in VERTICAL_UNITS.items():  # the factor says more than the name
                if abs(axis.unit_conversion_factor - metres) < 1e-9:
                    return name
            try:
                return vertical_unit_name(axis.unit_name)
            except CrsError:
                return None
    return None


def _shortened(text: str, length: int = 60) -> str:
    return text if len(text) <= length else text[: length - 3] + "..."
