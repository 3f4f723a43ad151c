"""How far a TIN is from the terrain along breaklines and clip polygon."""

from __future__ import annotations

from typing import Any

from wavelet_core import TriangleMesh
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.workflows.extract import SurfaceErrors, measured

__all__ = ["figures_along_lines", "line_about", "measured_along_lines"]


def measured_along_lines(terrain: Terrain, mesh: TriangleMesh) -> SurfaceErrors | None:
    """Return the vertical errors of a TIN along lines, None where there are no lines.

    Parameters
    ----------
    terrain : Terrain
        With the profile of its lines.
    mesh : TriangleMesh
        In the working frame.
    """
    if terrain.profile is None or len(terrain.profile) == 0:
        return None
    return measured(mesh, terrain.profile, terrain.frame.z_scale)


def figures_along_lines(errors: SurfaceErrors | None) -> dict[str, Any]:
    """Return the errors along lines as JSON-able values; nothing where there are no lines."""
    return {} if errors is None else {"along_lines": errors._asdict()}


def line_about(errors: SurfaceErrors, unit: str) -> str:
    """Return the errors along lines as a sentence.

    Examples
    --------
    >>> line_about(SurfaceErrors(0.02, 0.05, 0), "metre")
    'along the lines: RMSE 0.02, largest error 0.05 (metre)'
    """
    return f"along the lines: RMSE {errors.rmse:.4g}, largest error {errors.max_error:.4g} ({unit})"
