"""Sizes and errors of a level of an error-guided analysis, summed block by block."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._kernels.surface_points import Surface
from .._threads import run_in_blocks
from .._validate import FloatArray
from ._level_state import FaceState, VertexState


class LevelFigures(NamedTuple):
    """Sizes and errors of a level.

    n_vertices, n_faces : int
    n_points : int, input vertices, and points of a finer input if there are any
    squared_errors : float, sum of the squared height errors of all of these
    largest_error : float, the largest of them
    squared_changes : (c,) float64, of each weighted column the sum of the squared differences of
        the level's vertices from the input
    """

    n_vertices: int
    n_faces: int
    n_points: int
    squared_errors: float
    largest_error: float
    squared_changes: FloatArray


def squared_of_faces(faces: FaceState) -> float:
    """Return the sum of the squared height errors of the points of all faces."""
    squared = faces.squared_z if len(faces.squared_z) else faces.squared

    def summed(start: int, stop: int) -> float:
        return float(squared[start:stop][faces.lives[start:stop]].sum())

    return sum(run_in_blocks(summed, len(squared)), start=0.0)


def largest_of_faces(faces: FaceState) -> float:
    """Return the largest height error of the points of all faces."""

    def largest(start: int, stop: int) -> float:
        return float(faces.largest_z[start:stop][faces.lives[start:stop]].max(initial=0.0))

    return float(np.sqrt(max(run_in_blocks(largest, len(faces.largest_z)), default=0.0)))


def changes_of(surface: Surface, vertices: VertexState) -> tuple[FloatArray, float]:
    """Return how far the vertices are from the input: sums of squares by column, the largest of z.

    The sums are ``(n_channels,)`` float64.
    """
    z, measured, lives = surface.z, surface.measured, vertices.lives

    def of_block(start: int, stop: int) -> tuple[FloatArray, float]:
        change = (z[start:stop] - measured[start:stop])[lives[start:stop]]
        return (change**2).sum(axis=0), float(np.abs(change[:, 0]).max(initial=0.0))

    squared, largest = zip(*run_in_blocks(of_block, len(lives)), strict=True)
    return np.sum(squared, axis=0), max(largest)
