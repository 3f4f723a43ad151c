"""Errors between surfaces: what a coarse level gets wrong, measured at every input point."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ._kernels.metrics import cover_points, sort_into_cells
from ._validate import FloatArray, IntArray
from .errors import Cancelled
from .mesh import TriangleMesh
from .pyramid import Pyramid

#: Points that a cell of the search grid holds on average.
POINTS_PER_CELL = 2


class LevelErrors(NamedTuple):
    """Size and errors of one level.

    level, n_vertices, n_faces : int
    rmse_coefficients : float
        Root mean square distance of the level's coefficients from the same vertices of the
        input, over channels divided by their range: the mean form of Eq. 54 (as printed it
        lacks the 1/n). It is 0 for plain subsampling, so it says little by itself.
    rmse_surface, max_error_surface : float
        Vertical distance of all input vertices from the level's surface, in the unit of z.
    n_uncovered : int
        Input vertices that lie on no face of the level (none with signal "z", but for the
        isolated ones).
    """

    level: int
    n_vertices: int
    n_faces: int
    rmse_coefficients: float
    rmse_surface: float
    max_error_surface: float
    n_uncovered: int


class Cover(NamedTuple):
    """The points that lie on a mesh in plan, and where.

    point, face : (n_covered,) int64
        Index of the point and of the face; where faces overlap in plan, the first one.
    at_b, at_c : (n_covered,) float64
        Barycentric weights of the face's second and third corner.
    """

    point: IntArray
    face: IntArray
    at_b: FloatArray
    at_c: FloatArray


def surface_errors(mesh: TriangleMesh, points: FloatArray) -> FloatArray:
    """Return the vertical distance of points from a surface.

    Parameters
    ----------
    mesh : TriangleMesh
        The surface; linear on each face.
    points : ndarray, shape (n_points, 3)
        x, y, z in the unit of the mesh.

    Returns
    -------
    ndarray, shape (n_points,)
        z of the point minus z of the surface at its x, y; NaN where no face covers it. Where
        faces overlap in plan, the first one counts.
    """
    cover = cover_of(mesh, points[:, :2])
    z = mesh.vertices[:, 2]
    a, b, c = mesh.faces[cover.face].T
    surface = z[a] + cover.at_b * (z[b] - z[a]) + cover.at_c * (z[c] - z[a])
    errors = np.full(len(points), np.nan)
    errors[cover.point] = points[cover.point, 2] - surface
    return errors


def cover_of(mesh: TriangleMesh, plan: FloatArray) -> Cover:
    """Return which face covers each point, and where in it the point lies.

    Parameters
    ----------
    mesh : TriangleMesh
    plan : ndarray, shape (n_points, 2)
        x and y of the points.
    """
    face_of = np.full(len(plan), -1, dtype=np.int64)
    weights = np.empty((len(plan), 2))
    if mesh.n_faces > 0 and len(plan) > 0:
        origin = plan.min(axis=0)
        local = np.ascontiguousarray(plan - origin)
        extent = local.max(axis=0)
        n_cells = max(len(plan) // POINTS_PER_CELL, 1)
        area = max(extent[0], 1e-12 * extent[1]) * max(extent[1], 1e-12 * extent[0])
        size = float(np.sqrt(area / n_cells)) or 1.0
        size = max(size, float(extent.max()) / 20_000)
        n_columns, n_rows = (int(side / size) + 1 for side in extent)
        cell_indptr = np.zeros(n_columns * n_rows + 1, dtype=np.int64)
        order = np.empty(len(plan), dtype=np.int64)
        grid = (0.0, 0.0, size, n_columns, n_rows, cell_indptr, order)
        sort_into_cells(local, *grid)
        corners = mesh.vertices[:, :2] - origin
        cover_points(corners, mesh.faces, local, *grid, face_of, weights)
    point = np.flatnonzero(face_of >= 0)
    return Cover(point, face_of[point], weights[point, 0], weights[point, 1])


def level_errors(
    pyramid: Pyramid, progress: Callable[[float], bool | None] | None = None
) -> list[LevelErrors]:
    """Return size and errors of every level, the finest first.

    Parameters
    ----------
    pyramid : Pyramid
        What is measured.
    progress : callable, optional
        Called with a fraction in [0, 1] after each level; the work stops when it returns False.

    Raises
    ------
    Cancelled
        ``progress`` returned False.
    """
    finest = pyramid.mesh(pyramid.n_levels)
    reference = _columns(finest)
    extent = reference.max(axis=0) - reference.min(axis=0)
    scale = np.where(extent > 0, extent, 1.0)
    rows = []
    for level, mesh in pyramid.meshes():
        ids = pyramid.vertex_ids(level)
        difference = (_columns(mesh) - reference[ids]) / scale
        errors = surface_errors(mesh, finest.vertices)
        covered = errors[np.isfinite(errors)]
        rows.append(
            LevelErrors(
                level,
                mesh.n_vertices,
                mesh.n_faces,
                float(np.sqrt((difference**2).sum() / len(ids))),
                float(np.sqrt(np.mean(covered**2))) if len(covered) else 0.0,
                float(np.abs(covered).max(initial=0.0)),
                len(errors) - len(covered),
            )
        )
        if progress is not None and progress(len(rows) / (pyramid.n_levels + 1)) is False:
            raise Cancelled("measuring the errors was cancelled; nothing was kept.")
    return rows[::-1]


def _columns(mesh: TriangleMesh) -> FloatArray:
    return np.hstack([mesh.vertices, mesh.attributes])
