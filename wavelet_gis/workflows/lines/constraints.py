"""Lines, an outline and fixed points in a terrain: from shapes in its frame to a terrain with them.

The command line, Python and QGIS come here with what their own geometry libraries have cut where it
crosses. What comes out is a TIN, whatever went in: it has vertices that are not in the input.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from wavelet_core import TriangleMesh
from wavelet_core.errors import MeshError
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.drape import default_tolerance, drape
from wavelet_gis.model.mesh_origin import MeshOrigin
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.model.tin import SAME_PLACE, ConstrainedTin, tin_with_lines

__all__ = ["Constraints", "constrained", "laid", "locked_vertices", "same_place"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


class Constraints(NamedTuple):
    """What a triangulation must respect, in the working frame, cut where it crosses.

    breaklines : sequence of (n, 3) float64, z is NaN where it is that of the terrain
    outline : sequence of (n, 3) float64, the rings of a clip polygon, or what of them is inside
    contains : callable or None, takes (m, 2) positions, returns which are inside
    border : sequence of (n, 3) float64, rings of the terrain itself, edges that are not locked
    points : (n_points, 3) float64, fixed ones; z is NaN where it is that of the terrain
    """

    breaklines: Sequence[FloatArray]
    outline: Sequence[FloatArray] = ()
    contains: Callable[[FloatArray], BoolArray] | None = None
    border: Sequence[FloatArray] = ()
    points: FloatArray = np.empty((0, 3))


def laid(
    constraints: Constraints, surface: TriangleMesh, tolerance: float | None = None
) -> tuple[Constraints, FloatArray]:
    """Return the constraints with all heights known, and the terrain along their lines.

    Parameters
    ----------
    constraints : Constraints
        As they were given.
    surface : TriangleMesh
        The terrain without them.
    tolerance : float, optional
        See `wavelet_gis.model.drape.drape`; by default a thousandth of the relief.

    Returns
    -------
    Constraints
        Lines with as many vertices as they need.
    profile : (n, 3) float64
        Where the terrain is known along breaklines and outline.
    """
    within = default_tolerance(surface.vertices) if tolerance is None else tolerance
    n_lines = len(constraints.breaklines)
    draped = drape([*constraints.breaklines, *constraints.outline], surface, within)
    border = drape(constraints.border, surface, 0.0)
    points = constraints.points.copy()
    is_open = np.isnan(points[:, 2])
    if is_open.any():
        points[is_open] = drape([points[is_open]], surface, np.inf).lines[0]
    placed = constraints._replace(
        breaklines=draped.lines[:n_lines],
        outline=draped.lines[n_lines:],
        border=border.lines,
        points=points,
    )
    return placed, draped.profile


def locked_vertices(tin: ConstrainedTin, *, lines: bool = True) -> BoolArray:
    """Return the vertices that stay at every level.

    Parameters
    ----------
    tin : ConstrainedTin
        A TIN with lines.
    lines : bool
        Whether those of breaklines and outline do, beside the points that are marked.
    """
    return tin.is_marked | tin.is_on_line | tin.is_on_outline if lines else tin.is_marked


def constrained(
    terrain: Terrain, constraints: Constraints, tolerance: float | None = None
) -> Terrain:
    """Return a terrain with lines as edges, clipped, its lines and fixed points locked.

    Parameters
    ----------
    terrain : Terrain
        Of a raster, a point cloud or points.
    constraints : Constraints
        In its working frame.
    tolerance : float, optional
        See `laid`; in the input's unit of z.

    Raises
    ------
    InputFileError
        Lines that cannot be triangulated.
    """
    mesh, frame = terrain.mesh, terrain.frame
    within = None if tolerance is None else tolerance * frame.z_scale
    placed, profile = laid(constraints, mesh, within)
    others = terrain.points_for_errors()[mesh.n_vertices :]
    stays = np.zeros(mesh.n_vertices, dtype=bool)
    stays[mesh.faces] = True
    if placed.contains is not None:
        stays &= placed.contains(mesh.vertices[:, :2])
        others = others[placed.contains(others[:, :2])]
    fixed, attributes = placed.points, mesh.attributes
    tree = cKDTree(mesh.vertices[:, :2])
    if len(fixed):
        distance, nearest = tree.query(fixed[:, :2])
        under = np.unique(nearest[(distance <= same_place(mesh.vertices)) & stays[nearest]])
        stays[under] = False
        others = np.concatenate([others, mesh.vertices[under]])
        attributes = np.concatenate([attributes[stays], attributes[nearest]])
    else:
        attributes = attributes[stays]
    try:
        tin = tin_with_lines(
            np.concatenate([mesh.vertices[stays], fixed]),
            attributes,
            mesh.attribute_names,
            breaklines=placed.breaklines,
            outline=placed.outline,
            border=placed.border,
            contains=placed.contains,
            is_marked=np.arange(np.count_nonzero(stays) + len(fixed)) >= np.count_nonzero(stays),
        )
    except MeshError as error:
        raise InputFileError(
            "{name}: the lines of {0} and {1} cannot be edges of the TIN ({reason})",
            "breaklines",
            "clip",
            name=terrain.name,
            reason=str(error).rstrip("."),
        ) from error
    return replace(
        terrain,
        mesh=tin.mesh,
        origin=MeshOrigin(),
        merged=np.concatenate([others, tin.replaced]),
        locked=locked_vertices(tin),
        profile=profile,
        segments=_segments([*placed.breaklines, *placed.outline]),
    )


def _segments(lines: Sequence[FloatArray]) -> FloatArray:
    """Return the pieces of lines in plan, ``(n, 2, 2)``."""
    pieces = [np.stack([line[:-1, :2], line[1:, :2]], axis=1) for line in lines]
    return np.concatenate([np.empty((0, 2, 2)), *pieces])


def same_place(vertices: FloatArray) -> float:
    """Return how near, in plan, a point must be to another to be the same."""
    return SAME_PLACE * float(np.abs(vertices[:, :2]).max(initial=0.0))
