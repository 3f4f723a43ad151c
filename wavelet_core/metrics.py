"""Errors between surfaces: what a coarse level gets wrong, measured at every input point."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ._kernels.metrics import errors_under_faces, sort_into_cells
from ._validate import FloatArray
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
    errors = np.full(len(points), np.nan)
    if mesh.n_faces == 0 or len(points) == 0:
        return errors
    origin = points[:, :2].min(axis=0)
    extent = points[:, :2].max(axis=0) - origin
    shift = np.array([*origin, 0.0])
    local = np.ascontiguousarray(points - shift)
    n_cells = max(len(points) // POINTS_PER_CELL, 1)
    area = max(extent[0], 1e-12 * extent[1]) * max(extent[1], 1e-12 * extent[0])
    size = float(np.sqrt(area / n_cells)) or 1.0
    size = max(size, float(extent.max()) / 20_000)
    n_columns, n_rows = (int(side / size) + 1 for side in extent)
    cell_indptr = np.zeros(n_columns * n_rows + 1, dtype=np.int64)
    order = np.empty(len(points), dtype=np.int64)
    grid = (0.0, 0.0, size, n_columns, n_rows, cell_indptr, order)
    sort_into_cells(local[:, :2], *grid)
    errors_under_faces(mesh.vertices - shift, mesh.faces, local, *grid, errors)
    return errors


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
