"""Feedback to progress, and a QGIS CRS to the numbers that ``wavelet_gis`` works with."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

from osgeo import osr
from qgis.core import QgsCoordinateReferenceSystem

from ..ui.enums import WKT_FOR_GDAL

if TYPE_CHECKING:
    from qgis.core import QgsFeedback

    from wavelet_gis.crs.frame import CoordinateSystem

    from .background import Work


def progress(
    feedback: QgsFeedback, start: float = 0.0, stop: float = 1.0
) -> Callable[[float], bool]:
    """Return a progress function for the core that drives a part of QGIS's bar.

    Parameters
    ----------
    feedback : QgsFeedback
        Shows the progress and holds the cancel button.
    start, stop : float
        The part of the whole work that this step is.

    Returns
    -------
    callable
        Takes a fraction in [0, 1]; returns False once the user has cancelled.
    """

    def report(fraction: float) -> bool:
        feedback.setProgress(100.0 * (start + (stop - start) * fraction))
        return not feedback.isCanceled()

    return report


def require_running(feedback: QgsFeedback | Work) -> None:
    """Stop here if the user has cancelled.

    Raises
    ------
    Cancelled
    """
    from wavelet_core.errors import Cancelled

    if feedback.isCanceled():
        raise Cancelled("cancelled by the user")


def coordinate_system(crs: QgsCoordinateReferenceSystem) -> CoordinateSystem:
    """Return the ``CoordinateSystem`` of a QGIS CRS; an invalid one is no CRS."""
    from wavelet_gis.crs.frame import CoordinateSystem

    if not crs.isValid():
        return CoordinateSystem()
    wkt = crs.toWkt(WKT_FOR_GDAL)
    name = crs.description() or crs.authid()
    system = _spatial_reference(wkt)
    kind: Literal["geographic", "projected"]
    if system.IsGeographic():
        kind, unit = "geographic", system.GetAngularUnits()
    elif system.IsProjected():
        kind, unit = "projected", system.GetLinearUnits()
    else:  # a local one has no ellipsoid to ask for
        return CoordinateSystem(wkt=wkt, name=name)
    return CoordinateSystem(
        wkt=wkt,
        name=name,
        kind=kind,
        horizontal_unit=unit,
        vertical_unit=known_unit(system.GetAttrValue("VERT_CS|UNIT")),
        semi_major=system.GetSemiMajor(),
        inverse_flattening=system.GetInvFlattening(),
    )


def is_geocentric(wkt: str) -> bool:
    """Return whether a CRS has its origin in the middle of the earth."""
    return bool(_spatial_reference(wkt).IsGeocentric())


def _spatial_reference(wkt: str) -> Any:
    """Return GDAL's view of a CRS; one that it does not understand is of no kind."""
    try:
        system = osr.SpatialReference()
        system.ImportFromWkt(wkt)
    except RuntimeError:  # only where another plugin has told GDAL to raise
        return osr.SpatialReference()
    return system


def known_unit(name: str | None) -> str | None:
    """Return a unit as ``wavelet_gis`` names it, or None for one that is no length known to it."""
    from wavelet_gis.crs.frame import vertical_unit_name
    from wavelet_gis.errors import CrsError

    try:
        return vertical_unit_name(name) if name else None
    except CrsError:
        return None
