"""Errors between surfaces: what a coarse level gets wrong, measured at every input point."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._validate import FloatArray
from ..lifting.pyramid import Pyramid
from ..mesh.location import surface_errors
from ..mesh.triangle_mesh import TriangleMesh
from ..progress import Progress, report


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
        Input points that lie on no face of the level and at no isolated vertex (none with signal
        "z").
    """

    level: int
    n_vertices: int
    n_faces: int
    rmse_coefficients: float
    rmse_surface: float
    max_error_surface: float
    n_uncovered: int


def level_errors(
    pyramid: Pyramid,
    progress: Progress | None = None,
    finest: TriangleMesh | None = None,
    points: FloatArray | None = None,
) -> list[LevelErrors]:
    """Return size and errors of every level, the coarsest first: ``rows[level]``.

    Parameters
    ----------
    pyramid : Pyramid
        What is measured.
    progress : callable, optional
        Called with a fraction in [0, 1] after each level; the work stops when it returns False.
    finest : TriangleMesh, optional
        The pyramid's finest mesh, where it has been synthesised already.
    points : (n_points, 3) float64, optional
        Where the surfaces are measured, if not at the vertices of the finest mesh: these, and
        points that share x and y with them.

    Raises
    ------
    Cancelled
        ``progress`` returned False.
    """
    finest = pyramid.synthesise() if finest is None else finest
    points = finest.vertices if points is None else points
    reference = _columns(finest)
    extent = reference.max(axis=0) - reference.min(axis=0)
    scale = np.where(extent > 0, extent, 1.0)
    rows = []
    for level, mesh in enumerate(pyramid):
        ids = pyramid.vertex_ids(level)
        difference = (_columns(mesh) - reference[ids]) / scale
        errors = surface_errors(mesh, points)
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
        report(
            progress,
            len(rows) / len(pyramid),
            "measuring the errors was cancelled; nothing was kept.",
        )
    return rows


def _columns(mesh: TriangleMesh) -> FloatArray:
    return np.hstack([mesh.vertices, mesh.attributes])
