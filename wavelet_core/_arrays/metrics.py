"""Points into cells, faces laid over them, on whole arrays; see the kernels of the same name."""

from __future__ import annotations

import numpy as np

from .._kernels.metrics import EDGE_TOLERANCE
from ._csr import blocks, expanded

#: Pairs of a face and a point that are looked at together: a bound on the memory.
PAIRS_AT_ONCE = 1 << 20


def sort_into_cells(plan, x0, y0, size, n_columns, n_rows, cell_indptr, order):
    column = np.minimum(((plan[:, 0] - x0) / size).astype(np.int64), n_columns - 1)
    row = np.minimum(((plan[:, 1] - y0) / size).astype(np.int64), n_rows - 1)
    cell = row * n_columns + column
    cell_indptr[1:] = np.cumsum(np.bincount(cell, minlength=n_columns * n_rows))
    order[:] = np.argsort(cell, kind="stable")


def find_faces_near(start, stop, faces, ids, x, y, x0, y0, size, counts, is_near):
    for first in range(start, stop, 1 << 16):
        block = slice(first, min(first + (1 << 16), stop))
        corners = ids[faces[block]]
        cells = []
        for places, origin, n in ((x, x0, counts.shape[1] - 1), (y, y0, counts.shape[0] - 1)):
            low, high = places[corners].min(axis=1), places[corners].max(axis=1)
            cells.append((low, high, origin, n))
        (left, right, *_), (bottom, top, *_) = cells
        margin = 8.0 * EDGE_TOLERANCE * ((right - left) + (top - bottom))
        begins, ends = [], []
        for low, high, origin, n in cells:
            begins.append(_cells_of((low - margin - origin) / size, n).clip(0))
            ends.append(np.minimum(_cells_of((high + margin - origin) / size, n), n - 1))
        inside = (begins[0] <= ends[0]) & (begins[1] <= ends[1])
        (a, c), (b, d) = (part[inside] for part in begins), (part[inside] + 1 for part in ends)
        within = counts[d, b] - counts[c, b] - counts[d, a] + counts[c, a]
        is_near[block] = inside
        is_near[block][inside] = within > 0


def _cells_of(place, n):
    return np.floor(np.clip(place, -1.0, float(n))).astype(np.int64)


def cover_points(
    vertices, faces, points, x0, y0, size, n_columns, n_rows, cell_indptr, order, face_of, weights
):
    grid = (x0, y0, size, n_columns, n_rows, cell_indptr)
    step = 1 << 16
    for start in range(0, len(faces), step):
        face = np.arange(start, min(start + step, len(faces)))
        face, begin, count = _candidates(vertices, faces, face, *grid)
        for part in blocks(count + 1, PAIRS_AT_ONCE):
            row, place = expanded(begin[part], count[part])
            _cover(vertices, faces, points, face[part][row], order[place], face_of, weights)


def _candidates(vertices, faces, face, x0, y0, size, n_columns, n_rows, cell_indptr):
    """Return, for each face and each row of cells it meets, which entries of the cells' list."""
    ax, ay = vertices[faces[face, 0], 0], vertices[faces[face, 0], 1]
    bx, by = vertices[faces[face, 1], 0] - ax, vertices[faces[face, 1], 1] - ay
    cx, cy = vertices[faces[face, 2], 0] - ax, vertices[faces[face, 2], 1] - ay
    flat = bx * cy - by * cx == 0.0
    margin = EDGE_TOLERANCE * (np.abs(bx) + np.abs(by) + np.abs(cx) + np.abs(cy))
    low = ay + np.minimum(np.minimum(0.0, by), cy) - margin
    high = ay + np.maximum(np.maximum(0.0, by), cy) + margin
    first_row = np.maximum(_cell_of((low - y0) / size, n_rows), 0)
    last_row = np.minimum(_cell_of((high - y0) / size, n_rows), n_rows - 1)
    n_crossed = np.where(flat, 0, np.maximum(last_row - first_row + 1, 0))
    of, row = expanded(first_row, n_crossed)
    ax, ay, bx, by, cx, cy = (side[of] for side in (ax, ay, bx, by, cx, cy))
    margin = margin[of]
    bottom, top = y0 + row * size - margin, y0 + (row + 1) * size + margin
    left, right = np.full(len(of), np.inf), np.full(len(of), -np.inf)
    zero = np.zeros(len(of))
    for px, py, qx, qy in ((zero, zero, bx, by), (bx, by, cx, cy), (cx, cy, zero, zero)):
        px, py, qx, qy = px + ax, py + ay, qx + ax, qy + ay
        meets = ~(((py < bottom) & (qy < bottom)) | ((py > top) & (qy > top)))
        rise = np.where(py != qy, qy - py, 1.0)
        t1, t2 = (bottom - py) / rise, (top - py) / rise
        slanted = py != qy
        t_low = np.where(slanted, np.maximum(0.0, np.minimum(t1, t2)), 0.0)
        t_high = np.where(slanted, np.minimum(1.0, np.maximum(t1, t2)), 1.0)
        x1, x2 = px + t_low * (qx - px), px + t_high * (qx - px)
        left = np.where(meets, np.minimum(left, np.minimum(x1, x2)), left)
        right = np.where(meets, np.maximum(right, np.maximum(x1, x2)), right)
    met = np.flatnonzero(left <= right)
    of, row, margin, left, right = of[met], row[met], margin[met], left[met], right[met]
    first = np.maximum(_cell_of((left - margin - x0) / size, n_columns), 0)
    last = np.minimum(_cell_of((right + margin - x0) / size, n_columns), n_columns - 1)
    start = np.minimum(first, n_columns)
    begin = cell_indptr[row * n_columns + start]
    end = cell_indptr[row * n_columns + np.maximum(last + 1, start)]
    return face[of], begin, end - begin


def _cell_of(place, n):
    return np.floor(np.clip(place, -1.0, float(n))).astype(np.int64)


def _cover(vertices, faces, points, face, p, face_of, weights):
    """Give each point that has no face yet the first of those that cover it."""
    open_ = face_of[p] < 0
    face, p = face[open_], p[open_]
    a, b, c = faces[face].T
    ax, ay = vertices[a, 0], vertices[a, 1]
    bx, by = vertices[b, 0] - ax, vertices[b, 1] - ay
    cx, cy = vertices[c, 0] - ax, vertices[c, 1] - ay
    doubled_area = bx * cy - by * cx
    dx, dy = points[p, 0] - ax, points[p, 1] - ay
    at_b = (dx * cy - dy * cx) / doubled_area
    at_c = (bx * dy - by * dx) / doubled_area
    inside = (at_b >= -EDGE_TOLERANCE) & (at_c >= -EDGE_TOLERANCE)
    inside = np.flatnonzero(inside & (at_b + at_c <= 1.0 + EDGE_TOLERANCE))[::-1]
    face_of[p[inside]] = face[inside]  # the first is written last
    weights[p[inside], 0], weights[p[inside], 1] = at_b[inside], at_c[inside]
