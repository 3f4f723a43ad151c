"""Errors between surfaces: what a coarse level gets wrong, measured at every input point."""

from __future__ import annotations

from itertools import repeat
from typing import NamedTuple

import numpy as np

from .._threads import centre_of
from .._validate import FloatArray
from ..lifting.pyramid import Pyramid
from ..mesh.location import surface_errors
from ..mesh.triangle_mesh import TriangleMesh
from ..progress import Progress, report
from .few_points import errors_by_level

#: Heights that differ by no more than this part of the largest are those of one point.
SAME_HEIGHT = 1e-9


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
    extent = np.concatenate([centre_of(part)[1] for part in (finest.vertices, finest.attributes)])
    scale = np.where(extent > 0, extent, 1.0)
    merged = _merged_points(finest, points)
    if pyramid.measured is not None and merged is not None:
        return _from_analysis(pyramid, progress, merged, extent)
    reference = _columns(finest)
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


def _merged_points(finest: TriangleMesh, points: FloatArray) -> FloatArray | None:
    """Return the points beyond those that the vertices are; None where these lie elsewhere."""
    n = finest.n_vertices
    if len(points) < n:
        return None
    height = finest.vertices[:, 2]
    apart = np.abs(points[:n, 2] - height).max(initial=0.0)
    is_same = apart <= SAME_HEIGHT * np.abs(height).max(initial=0.0)
    return points[n:] if is_same else None


def _from_analysis(
    pyramid: Pyramid, progress: Progress | None, merged: FloatArray, extent: FloatArray
) -> list[LevelErrors]:
    """Return the errors that the analysis measured, and those of points that it did not have.

    Of an analysis that knew points of a finer input (`wavelet_core.analyse`), these count too.
    """
    assert pyramid.measured is not None
    scale = np.where(extent > 0, extent, 1.0)[2:]
    by_level = errors_by_level(pyramid, merged) if len(merged) else repeat(None)
    rows = []
    for level, (figures, errors) in enumerate(zip(pyramid.measured, by_level, strict=False)):
        squared, largest, n_uncovered = figures.squared_errors, figures.largest_error, 0
        n_points = figures.n_points + len(merged)
        if errors is not None:
            covered = errors[np.isfinite(errors)]
            squared += float((covered**2).sum())
            largest = max(largest, float(np.abs(covered).max(initial=0.0)))
            n_uncovered = len(errors) - len(covered)
        relative = float((figures.squared_changes / scale**2).sum()) / figures.n_vertices
        rows.append(
            LevelErrors(
                level,
                figures.n_vertices,
                figures.n_faces,
                float(np.sqrt(relative)),
                float(np.sqrt(squared / max(n_points - n_uncovered, 1))),
                largest,
                n_uncovered,
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
