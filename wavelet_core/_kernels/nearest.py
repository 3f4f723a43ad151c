"""Kernels of :mod:`wavelet_core.mesh.point_faces`: the nearest of points in square cells."""

import numpy as np

from ._jit import inlined, kernel

#: Cells on each side of a point's own that are looked through at first, and at most.
LEAST_RADIUS, MOST_RADIUS = 1, 6
#: Points that are looked at for one: where more are around, a tree finds them sooner.
MOST_LOOKED_AT = 512
NO_ID = np.iinfo(np.int32).max


# x, y (n,) float64: whole numbers, none below 0; side: of a cell; n_columns: of cells;
# first (n_cells + 1,) int32 and order (n,) int32, filled: the points of each cell, row by row
@kernel
def sort_into_cells(x, y, side, n_columns, first, order):
    for v in range(x.shape[0]):
        first[int(y[v]) // side * n_columns + int(x[v]) // side + 1] += 1
    for c in range(first.shape[0] - 1):
        first[c + 1] += first[c]
    cursor = first[:-1].copy()
    for v in range(x.shape[0]):
        c = int(y[v]) // side * n_columns + int(x[v]) // side
        order[cursor[c]] = v
        cursor[c] += 1


# x, y (n,), first, order: of `sort_into_cells`, but x and y in the order of the cells;
# nearest (n, m) int32, reach (n,) float64, filled: of each point the others by distance, then by
# index, and the square of the distance of the one after them;
# is_open (n,) bool, set: of points whose nearest were not found
@kernel
def nearest_in_cells(start, stop, x, y, side, n_columns, first, order, nearest, reach, is_open):
    m = nearest.shape[1]
    n_rows = (first.shape[0] - 1) // n_columns
    squared, ids = np.empty(m + 1), np.empty(m + 1, np.int32)
    for i in range(start, stop):
        v = order[i]
        column, row = int(x[i]) // side, int(y[i]) // side
        squared[:] = np.inf
        ids[:] = NO_ID
        seen, radius = -1, LEAST_RADIUS
        is_found = False
        while not is_found and radius <= MOST_RADIUS:
            left, right = max(column - radius, 0), min(column + radius, n_columns - 1)
            low, high = max(row - radius, 0), min(row + radius, n_rows - 1)
            n_around = 0
            for r in range(low, high + 1):
                n_around += first[r * n_columns + right + 1] - first[r * n_columns + left]
            if n_around > MOST_LOOKED_AT:
                break
            for r in range(low, high + 1):
                cells = r * n_columns
                if abs(r - row) > seen:
                    begin, end = first[cells + left], first[cells + right + 1]
                    look_at(begin, end, i, x, y, order, squared, ids)
                else:
                    begin, end = first[cells + left], first[cells + max(column - seen, left)]
                    look_at(begin, end, i, x, y, order, squared, ids)
                    begin = first[cells + min(column + seen, right) + 1]
                    look_at(begin, first[cells + right + 1], i, x, y, order, squared, ids)
            # what is in no cell looked at is at least so far, or is not there
            beyond = np.inf
            if left > 0:
                beyond = min(beyond, x[i] - left * side + 1)
            if right < n_columns - 1:
                beyond = min(beyond, (right + 1) * side - x[i])
            if low > 0:
                beyond = min(beyond, y[i] - low * side + 1)
            if high < n_rows - 1:
                beyond = min(beyond, (high + 1) * side - y[i])
            is_found = squared[m] <= beyond * beyond
            seen, radius = radius, radius + 1
        is_open[v] = not is_found
        reach[v] = squared[m]
        for k in range(m):
            nearest[v, k] = ids[k]


# Put points [begin, end) but i among the nearest so far, which they shift.
@inlined
def look_at(begin, end, i, x, y, order, squared, ids):
    last = squared.shape[0] - 1
    for j in range(begin, end):
        here = (x[j] - x[i]) * (x[j] - x[i]) + (y[j] - y[i]) * (y[j] - y[i])
        if here > squared[last] or j == i:
            continue
        u = order[j]
        if here == squared[last] and u > ids[last]:
            continue
        k = last
        while k > 0 and (squared[k - 1] > here or (squared[k - 1] == here and ids[k - 1] > u)):
            squared[k], ids[k] = squared[k - 1], ids[k - 1]
            k -= 1
        squared[k], ids[k] = here, u
