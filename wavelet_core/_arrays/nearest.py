"""The nearest of points in square cells; see :mod:`wavelet_core._kernels.nearest`."""

from __future__ import annotations

import numpy as np


def sort_into_cells(x, y, side, n_columns, first, order):
    cells = y.astype(np.int64) // side * n_columns + x.astype(np.int64) // side
    first[1:] = np.cumsum(np.bincount(cells, minlength=len(first) - 1))
    order[:] = np.argsort(cells, kind="stable")


def nearest_in_cells(start, stop, x, y, side, n_columns, first, order, nearest, reach, is_open):
    """Leave all of them to the tree, which is faster than whole arrays are."""
    is_open[order[start:stop]] = True
