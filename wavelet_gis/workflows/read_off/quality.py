"""The triangles of each level as a table: angles, edges, areas."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wavelet_core import Progress
from wavelet_core.progress import report
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.workflows.options import HoldsPyramid, pyramid_of
from wavelet_gis.workflows.read_off.levels import checked_levels
from wavelet_gis.workflows.solver.quality import quality_of, triangle_quality

__all__ = ["LevelQuality", "mesh_quality"]

#: Shares of a level's time until its mesh is there, and until its smallest angles are sorted.
REBUILT_SHARE, SORTED_SHARE = 0.3, 0.7


class LevelQuality(NamedTuple):
    """The triangles of a level, in plan. NaN of a level without any.

    level, n_vertices, n_triangles : int
    smallest_angle, low_angle, median_angle : float, degrees: the smallest of the smallest angles of
        the triangles, the one that 95 % are above, and their median
    largest_angle : float, degrees
    sliver_share : float, part of the triangles with an angle below 10 degrees
    shortest_edge, longest_edge : float, in the unit of x and y; metres for degrees
    smallest_area, largest_area : float, in that unit squared
    """

    level: int
    n_vertices: int
    n_triangles: int
    smallest_angle: float
    low_angle: float
    median_angle: float
    largest_angle: float
    sliver_share: float
    shortest_edge: float
    longest_edge: float
    smallest_area: float
    largest_area: float


def mesh_quality(
    data: HoldsPyramid | GeoPyramid,
    *,
    levels: Sequence[int] | None = None,
    progress: Progress | None = None,
) -> list[LevelQuality]:
    """Return the shapes of the triangles of each level, the coarsest first.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    levels : sequence of int, optional
        Which; by default all.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        A level that the pyramid does not have.
    """
    geo = pyramid_of(data)
    n_levels = geo.pyramid.n_levels
    chosen = checked_levels(geo, list(range(n_levels + 1)) if levels is None else list(levels))
    ends = np.cumsum([geo.pyramid.n_vertices(level) for level in range(n_levels + 1)])
    rows = []
    for level, mesh in enumerate(geo.pyramid):
        before = ends[level] - mesh.n_vertices
        report(progress, (before + REBUILT_SHARE * mesh.n_vertices) / ends[-1])
        if level in chosen:
            shape, nan = triangle_quality(mesh), float("nan")
            report(progress, (before + SORTED_SHARE * mesh.n_vertices) / ends[-1])
            extremes = quality_of(mesh) if mesh.n_faces else None
            rows.append(
                LevelQuality(
                    level,
                    mesh.n_vertices,
                    mesh.n_faces,
                    nan if extremes is None else extremes.smallest_angle,
                    shape["low_smallest_angle"],
                    shape["median_smallest_angle"],
                    nan if extremes is None else extremes.largest_angle,
                    shape["sliver_share"],
                    *((nan,) * 4 if extremes is None else extremes[2:]),
                )
            )
        report(progress, ends[level] / ends[-1])
    return rows
