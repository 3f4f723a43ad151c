"""Which points lie near each other, and the faces that edges between them enclose."""

from __future__ import annotations

from math import isqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .._kernels._jit import current_engine, run_in_ranges
from .._kernels.nearest import nearest_in_cells, sort_into_cells
from .._kernels.point_faces import (
    NOT_ASKED,
    classify_pairs,
    count_triangles,
    fill_triangles,
    gather_spokes,
    group_pairs,
    look_up_pairs,
    order_nearest,
    sort_groups,
    turn_spokes,
)
from .._threads import rows_at
from .._validate import FloatArray
from ..progress import Progress, part_of, report, watched_part

__all__ = [
    "NOT_ASKED", "NearPairs", "SortedEdges", "near_pairs", "nearest_points", "sorted_edges",
    "triangles_of",
]  # fmt: skip

#: Points that a tree is asked about together: a bound on the memory.
POINTS_AT_ONCE = 1 << 16

#: How many points a cell with any holds on average: cells of more, where the points fill but a part
#: of the plan, are made smaller once.
POINTS_A_CELL = 2

#: Share of the time of `nearest_points` after which the points are in cells, and looked up there.
_SORTED, _LOOKED_UP = 0.1, 0.8

#: Share of the time of `near_pairs` after which the nearest points are known: 0.6 of it without a
#: compiler, 0.7 with one.
_OF_NEAREST = 0.7

_CANCELLED = "the work on the faces was cancelled; nothing was kept."


class NearPairs(NamedTuple):
    """Of each point the nearest others.

    nearest : (n, m) int32, by distance, then by index
    classes : (n, m) uint8, how clear it is that they are joined; NOT_ASKED where nobody asks:
        beyond the reach, or where the other one of the two does
    """

    nearest: NDArray[np.int32]
    classes: NDArray[np.uint8]


class SortedEdges(NamedTuple):
    """Edges by their lower ends.

    indptr : (n + 1,) int64; heads : (k,) int32, the higher ends, ascending
    """

    indptr: NDArray[np.int64]
    heads: NDArray[np.int32]

    def rows(self) -> NDArray[np.int32]:
        """Return the edges, ``(k, 2)``, the lower ends first."""
        tails = np.arange(len(self.indptr) - 1, dtype=np.int32)
        return np.column_stack([np.repeat(tails, np.diff(self.indptr)), self.heads])

    def are_joined(
        self, pairs: NearPairs, progress: Progress | None = None
    ) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
        """Return of each pair that is asked about whether it is an edge, and which edges are."""
        joined = np.empty(pairs.classes.shape, dtype=np.uint8)
        is_asked = np.zeros(len(self.heads), dtype=bool)
        with watched_part(progress, 0.0, 1.0, _CANCELLED):
            run_in_ranges(
                look_up_pairs, len(joined), pairs.nearest, pairs.classes, self.indptr, self.heads,
                joined, is_asked,
            )  # fmt: skip
        return joined, is_asked


def near_pairs(
    x: FloatArray, y: FloatArray, n_nearest: int, progress: Progress | None = None
) -> NearPairs:
    """Return the nearest points of each of some points, for docs/reference/format.md, "The input".

    Parameters
    ----------
    x, y : (n,) float64
        Whole numbers, so small that sums of their products are exact; ``n > n_nearest + 1``.
    n_nearest : int
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    n = len(x)
    nearest, reach = nearest_points(x, y, n_nearest, part_of(progress, 0.0, _OF_NEAREST))
    classes = np.empty((n, n_nearest), dtype=np.uint8)
    with watched_part(progress, _OF_NEAREST, 1.0, _CANCELLED):
        run_in_ranges(classify_pairs, n, x, y, nearest, reach, classes)
    return NearPairs(nearest, classes)


def nearest_points(
    x: FloatArray, y: FloatArray, n_nearest: int, progress: Progress | None = None
) -> tuple[NDArray[np.int32], FloatArray]:
    """Return the nearest others of each point, and how far the next one is.

    Points in cells of about their density are looked up there; the others, those that are few in
    cells or many, in a k-d tree. Which of several at the same distance as the next one are
    returned depends on where they were found.

    Parameters
    ----------
    x, y : (n,) float64
        Whole numbers of 0 or more, no two points the same; ``n > n_nearest + 1``.
    n_nearest : int
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    nearest : (n, n_nearest) int32, by distance, then by index
    reach : (n,) float64, the square of the distance of the next one
    """
    n = len(x)
    reach = np.empty(n)
    nearest = np.empty((n, n_nearest), dtype=np.int32)
    is_open = np.empty(n, dtype=bool)
    report(progress, 0.0, _CANCELLED)
    cells = _cells(x, y)
    sorted_x, sorted_y = rows_at(x, cells.order), rows_at(y, cells.order)
    looked_up = _SORTED if current_engine() == "arrays" else _LOOKED_UP  # they leave all of it
    with watched_part(progress, _SORTED, looked_up, _CANCELLED):
        run_in_ranges(nearest_in_cells, n, sorted_x, sorted_y, *cells, nearest, reach, is_open)
    left = np.flatnonzero(is_open).astype(np.int32)
    in_tree = part_of(progress, looked_up, 1.0)
    _look_up_in_tree(left, x, y, nearest, reach, in_tree)
    return nearest, reach


class _Cells(NamedTuple):
    """Side and columns of square cells, and their points, row by row, in CSR."""

    side: int
    n_columns: int
    first: NDArray[np.int32]
    order: NDArray[np.int32]


def _cells(x: FloatArray, y: FloatArray) -> _Cells:
    """Return the points in cells of about their density."""
    width, height = int(x.max()) + 1, int(y.max()) + 1
    side = max(isqrt(width * height * POINTS_A_CELL // len(x)), 1)
    cells = _sorted_into(side, x, y, width, height)
    n_filled = int(np.count_nonzero(np.diff(cells.first)))
    if len(x) > 2 * POINTS_A_CELL * n_filled:
        side = max(isqrt(side * side * POINTS_A_CELL * n_filled // len(x)), 1)
        if (width // side + 1) * (height // side + 1) <= 4 * len(x):
            cells = _sorted_into(side, x, y, width, height)
    return cells


def _sorted_into(side: int, x: FloatArray, y: FloatArray, width: int, height: int) -> _Cells:
    n_columns, n_rows = -(-width // side), -(-height // side)
    first = np.zeros(n_columns * n_rows + 1, dtype=np.int32)
    order = np.empty(len(x), dtype=np.int32)
    sort_into_cells(x, y, side, n_columns, first, order)
    return _Cells(side, n_columns, first, order)


def _look_up_in_tree(
    points: NDArray[np.int32],
    x: FloatArray,
    y: FloatArray,
    nearest: NDArray[np.int32],
    reach: FloatArray,
    progress: Progress | None,
) -> None:
    """Fill the rows of some points."""
    if not len(points):
        return
    plan = np.column_stack([x, y])
    tree = cKDTree(plan, balanced_tree=False, compact_nodes=False)
    for first in range(0, len(points), POINTS_AT_ONCE):
        report(progress, first / len(points), _CANCELLED)
        here = points[first : first + POINTS_AT_ONCE]
        _, found = tree.query(plan[here], k=nearest.shape[1] + 2, workers=-1)
        run_in_ranges(order_nearest, len(found), here, found, x, y, nearest, reach)


def sorted_edges(pairs: NDArray[np.int32], n_points: int) -> SortedEdges:
    """Return pairs of points as edges, each once.

    Parameters
    ----------
    pairs : (k, 2) int32
        Of points below ``n_points``, in any order, with repetitions.
    n_points : int
    """
    indptr = np.zeros(n_points + 1, dtype=np.int64)
    heads, is_new = np.empty(len(pairs), dtype=np.int32), np.empty(len(pairs), dtype=bool)
    group_pairs(pairs, indptr, heads)
    run_in_ranges(sort_groups, n_points, indptr, heads, is_new)
    before = np.concatenate([[0], np.cumsum(is_new)])
    return SortedEdges(before[indptr], heads[is_new])


def triangles_of(
    x: FloatArray, y: FloatArray, edges: SortedEdges, progress: Progress | None = None
) -> NDArray[np.int32]:
    """Return the triangles of edges with no edge inside, the lowest corner first, sorted.

    Parameters
    ----------
    x, y : (n,) float64
        As for `near_pairs`.
    edges : SortedEdges
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    n, n_spokes = len(x), 2 * len(edges.heads)
    indptr = np.zeros(n + 1, dtype=np.int64)
    heads = np.empty(n_spokes, dtype=np.int32)
    edge_of = np.empty(n_spokes, dtype=np.int32)
    place = np.empty(n_spokes, dtype=np.int32)
    report(progress, 0.0, _CANCELLED)
    gather_spokes(edges.rows(), indptr, heads, edge_of)
    report(progress, 0.1, _CANCELLED)
    with watched_part(progress, 0.1, 0.5, _CANCELLED):
        run_in_ranges(turn_spokes, n, x, y, indptr, heads, edge_of, place)
    report(progress, 0.5, _CANCELLED)
    n_triangles = np.empty(n, dtype=np.int32)
    spokes = (x, y, indptr, heads, edge_of, place)
    with watched_part(progress, 0.5, 0.75, _CANCELLED):
        run_in_ranges(count_triangles, n, *spokes, n_triangles)
    report(progress, 0.75, _CANCELLED)
    first = np.concatenate([[0], np.cumsum(n_triangles, dtype=np.int64)])
    triangles = np.empty((int(first[-1]), 3), dtype=np.int32)
    with watched_part(progress, 0.75, 1.0, _CANCELLED):
        run_in_ranges(fill_triangles, n, *spokes, first, triangles)
    return triangles
