"""What came out where a tolerance differs from place to place."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.mesh.location import surface_errors

__all__ = ["ZoneErrors", "zone_errors"]

FloatArray = NDArray[np.float64]

#: Zones are listed one by one up to so many different tolerances, and in octaves beyond.
MOST_ZONES = 12


class ZoneErrors(NamedTuple):
    """What came out where the tolerance is one, or of one octave, in the input's unit of z.

    least, most : float, tolerances; equal where the zone has one
    n_points, n_vertices : int, input vertices, and those that are vertices of the surface
    rmse, max_error : float
    """

    least: float
    most: float
    n_points: int
    n_vertices: int
    rmse: float
    max_error: float


def zone_errors(
    mesh: TriangleMesh,
    vertex_ids: NDArray[np.int64],
    points: FloatArray,
    limits: FloatArray,
    z_scale: float,
) -> tuple[ZoneErrors, ...]:
    """Return vertices and errors of a surface by its tolerance, the strictest zone first.

    Parameters
    ----------
    mesh : TriangleMesh
        The surface.
    vertex_ids : (n_vertices,) int64
        Input vertices that it has; -1 of nodes that are none.
    points : (n_points, 3) float64
        The input vertices.
    limits : (n_points,) float64
        From `tolerances`.
    z_scale : float
        Working units in one of the input's unit of z.
    """
    errors = np.abs(surface_errors(mesh, points)) / z_scale
    levels = np.unique(limits)
    zone = np.searchsorted(levels, limits)
    if len(levels) > MOST_ZONES:
        octave = np.floor(np.log2(np.maximum(limits, np.finfo(float).tiny)))
        zone = np.searchsorted(np.unique(octave), octave)
    is_vertex = np.zeros(len(points), dtype=bool)
    is_vertex[vertex_ids[vertex_ids >= 0]] = True
    rows = []
    for number in range(int(zone.max(initial=-1)) + 1):
        inside = zone == number
        covered = errors[inside & np.isfinite(errors)]
        rows.append(
            ZoneErrors(
                float(limits[inside].min()),
                float(limits[inside].max()),
                int(inside.sum()),
                int((inside & is_vertex).sum()),
                float(np.sqrt(np.mean(covered**2))) if len(covered) else 0.0,
                float(covered.max(initial=0.0)),
            )
        )
    return tuple(rows)
