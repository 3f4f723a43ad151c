"""The nearest others of each of many points."""

from __future__ import annotations

from math import isqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .._kernels._jit import current_engine, run_in_ranges
from .._kernels.nearest import nearest_in_cells, sort_into_cells
from .._kernels.point_faces import order_nearest
from .._threads import rows_at
from .._validate import FloatArray
from ..progress import Progress, part_of, report, watched_part

__all__ = ["nearest_points"]

#: Points that a tree is asked about together: a bound on the memory.
POINTS_AT_ONCE = 1 << 16

#: How many points a cell with any holds on average: cells of more, where the points fill but a part
#: of the plan, are made smaller once.
POINTS_A_CELL = 2

#: Share of the time after which the points are in cells, and looked up there.
_SORTED, _LOOKED_UP = 0.1, 0.8


def nearest_points(
    x: FloatArray, y: FloatArray, n_nearest: int, cancelled: str, progress: Progress | None = None
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
    cancelled : str
        What is said when ``progress`` returns False.
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
    report(progress, 0.0, cancelled)
    cells = _cells(x, y)
    sorted_x, sorted_y = rows_at(x, cells.order), rows_at(y, cells.order)
    looked_up = _SORTED if current_engine() == "arrays" else _LOOKED_UP  # they leave all of it
    with watched_part(progress, _SORTED, looked_up, cancelled):
        run_in_ranges(nearest_in_cells, n, sorted_x, sorted_y, *cells, nearest, reach, is_open)
    left = np.flatnonzero(is_open).astype(np.int32)
    in_tree = part_of(progress, looked_up, 1.0)
    _look_up_in_tree(left, x, y, nearest, reach, cancelled, in_tree)
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
    cancelled: str,
    progress: Progress | None,
) -> None:
    """Fill the rows of some points."""
    if not len(points):
        return
    plan = np.column_stack([x, y])
    tree = cKDTree(plan, balanced_tree=False, compact_nodes=False)
    for first in range(0, len(points), POINTS_AT_ONCE):
        report(progress, first / len(points), cancelled)
        here = points[first : first + POINTS_AT_ONCE]
        _, found = tree.query(plan[here], k=nearest.shape[1] + 2, workers=-1)
        run_in_ranges(order_nearest, len(found), here, found, x, y, nearest, reach)
