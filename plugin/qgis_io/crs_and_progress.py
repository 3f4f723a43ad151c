"""Feedback to progress, and a QGIS CRS to the numbers that ``wavelet_gis`` works with."""

from __future__ import annotations

from osgeo import osr
from qgis.core import QgsCoordinateReferenceSystem


def progress(feedback, start: float = 0.0, stop: float = 1.0):
    """Return a progress function for the core that drives a part of QGIS's bar.

    Parameters
    ----------
    feedback : QgsProcessingFeedback
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


def require_running(feedback) -> None:
    """Stop here if the user has cancelled.

    Raises
    ------
    Cancelled
    """
    from wavelet_core.errors import Cancelled

    if feedback.isCanceled():
        raise Cancelled("cancelled by the user")


def coordinate_system(crs: QgsCoordinateReferenceSystem):
    """Return the ``CoordinateSystem`` of a QGIS CRS; an invalid one is no CRS."""
    from wavelet_gis.crs.frame import CoordinateSystem

    if not crs.isValid():
        return CoordinateSystem()
    wkt = crs.toWkt(QgsCoordinateReferenceSystem.WktVariant.WKT_PREFERRED_GDAL)
    name = crs.description() or crs.authid()
    system = _spatial_reference(wkt)
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


def _spatial_reference(wkt: str):
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
