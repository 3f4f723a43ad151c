"""Contour lines of a TIN: straight in each triangle, whole from outline to outline or closed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core.progress import report

__all__ = ["contour_lines", "contour_values", "round_interval"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def round_interval(relief: float, n_lines: int = 20) -> float:
    """Return an interval of 1, 2 or 5 times a power of ten that gives about so many contours.

    Examples
    --------
    >>> round_interval(430.0), round_interval(8.0)
    (20.0, 0.5)
    """
    wanted = relief / n_lines
    if not wanted > 0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(min((1 * power, 2 * power, 5 * power, 10 * power), key=lambda x: abs(x - wanted)))


def contour_values(heights: FloatArray, interval: float, base: float = 0.0) -> FloatArray:
    """Return the multiples of an interval, counted from a base, between heights."""
    first = np.ceil((heights.min() - base) / interval)
    last = np.floor((heights.max() - base) / interval)
    values: FloatArray = base + interval * np.arange(first, last + 1)
    return values


def contour_lines(
    vertices: FloatArray,
    faces: IntArray,
    values: Sequence[float] | FloatArray,
    progress: Progress | None = None,
) -> Iterator[tuple[float, FloatArray]]:
    """Yield the contours of a TIN, each as its height and a line.

    Parameters
    ----------
    vertices : ndarray, shape (n_vertices, 3)
        x, y, z.
    faces : ndarray of int, shape (n_faces, 3)
        Counter-clockwise.
    values : sequence of float
        Heights to draw contours at. A vertex at just this height counts as above it.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Yields
    ------
    value : float
    line : ndarray, shape (n, 3)
        With higher ground on its right; a closed one ends where it begins.
    """
    z = vertices[:, 2]
    low, high = z[faces].min(axis=1), z[faces].max(axis=1)
    for k, value in enumerate(values):
        report(progress, k / len(values))
        crossed = faces[(low < value) & (high >= value)]
        for edges in _chained(*_segments(z, crossed, float(value))):
            line = _placed(vertices, edges, float(value))
            if len(line) > 1:  # a peak that just touches the height is a place, no line
                yield float(value), line


def _segments(z: FloatArray, faces: IntArray, value: float) -> tuple[IntArray, IntArray]:
    """Return the edge by which a contour enters each face, and that by which it leaves it.

    An edge is named ``smaller * n_vertices + larger``. The contour enters where the edge of the
    face goes up, so that the face behind, which sees the edge the other way round, is left there.
    """
    n = len(z)
    tails, heads = faces, np.roll(faces, -1, axis=1)
    is_up = (z[tails] < value) & (z[heads] >= value)
    is_down = (z[tails] >= value) & (z[heads] < value)
    names = np.minimum(tails, heads) * n + np.maximum(tails, heads)
    return names[is_up], names[is_down]


def _chained(entries: IntArray, exits: IntArray) -> Iterator[IntArray]:
    """Yield the edges that each contour crosses, in order; those of a closed one end as they begin.

    Open ones, which begin at the outline, come first.
    """
    following = dict(zip(entries.tolist(), exits.tolist(), strict=True))
    begins = sorted(set(following) - set(exits.tolist()))
    for start in begins:
        yield _walk(following, start)
    while following:
        yield _walk(following, next(iter(following)))


def _walk(following: dict[int, int], start: int) -> IntArray:
    line = [start]
    while (edge := following.pop(line[-1], None)) is not None:
        line.append(edge)
    return np.array(line, dtype=np.int64)


def _placed(vertices: FloatArray, edges: IntArray, value: float) -> FloatArray:
    """Return where a contour crosses edges: the same place from either side."""
    a, b = vertices[edges // len(vertices)], vertices[edges % len(vertices)]
    share = (value - a[:, 2]) / (b[:, 2] - a[:, 2])
    line = a + share[:, None] * (b - a)
    line[:, 2] = value
    # Through a vertex, several edges are crossed at one place.
    is_new = np.ones(len(line), dtype=bool)
    is_new[1:] = (line[1:, :2] != line[:-1, :2]).any(axis=1)
    placed: FloatArray = line[is_new]
    return placed
