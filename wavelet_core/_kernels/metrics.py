"""Kernels of :mod:`wavelet_core.mesh.location`: points into cells, faces laid over them."""

import math

import numpy as np

from ._jit import kernel, njit

# a point this far outside a face, in barycentric coordinates, still counts as on it
EDGE_TOLERANCE = 1e-9


# plan (n_points, 2) float64; the grid has n_columns x n_rows square cells of `size` from (x0, y0);
# cell_indptr (n_cells + 1,) int64 and order (n_points,) int64, filled
@kernel
def sort_into_cells(plan, x0, y0, size, n_columns, n_rows, cell_indptr, order):
    n = plan.shape[0]
    cell = np.empty(n, dtype=np.int64)
    for p in range(n):
        column = min(int((plan[p, 0] - x0) / size), n_columns - 1)
        row = min(int((plan[p, 1] - y0) / size), n_rows - 1)
        cell[p] = row * n_columns + column
        cell_indptr[cell[p] + 1] += 1
    for c in range(n_columns * n_rows):
        cell_indptr[c + 1] += cell_indptr[c]
    cursor = cell_indptr[:-1].copy()
    for p in range(n):
        order[cursor[cell[p]]] = p
        cursor[cell[p]] += 1


# The row or column of cells that holds a place, given in cells from the first; -1 before, n behind.
# Cut off before it is whole: 64 bits do not hold what lies far enough out.
@njit
def cell_of(place, n):
    return math.floor(min(max(place, -1.0), float(n)))


# Which faces have bounds that share a cell with a point? faces (m, 3) int32 of places in ids (n,)
# int32; x, y float64 by id; counts (n_rows + 1, n_columns + 1) int64, of the points below and to
# the left, in cells of that size from (x0, y0) on; is_near (m,) bool, filled
@kernel
def find_faces_near(start, stop, faces, ids, x, y, x0, y0, size, counts, is_near):
    n_rows, n_columns = counts.shape[0] - 1, counts.shape[1] - 1
    for face in range(start, stop):
        a, b, c = ids[faces[face, 0]], ids[faces[face, 1]], ids[faces[face, 2]]
        left, right = min(x[a], x[b], x[c]), max(x[a], x[b], x[c])
        bottom, top = min(y[a], y[b], y[c]), max(y[a], y[b], y[c])
        margin = 8.0 * EDGE_TOLERANCE * ((right - left) + (top - bottom))
        first = max(cell_of((left - margin - x0) / size, n_columns), 0)
        last = min(cell_of((right + margin - x0) / size, n_columns), n_columns - 1)
        lowest = max(cell_of((bottom - margin - y0) / size, n_rows), 0)
        highest = min(cell_of((top + margin - y0) / size, n_rows), n_rows - 1)
        is_near[face] = False
        if first <= last and lowest <= highest:
            within = counts[highest + 1, last + 1] - counts[lowest, last + 1]
            is_near[face] = within - counts[highest + 1, first] + counts[lowest, first] > 0


# vertices (n, >= 2), points (n_points, >= 2) float64, of which x and y count; faces (n_faces, 3)
# int; face_of (n_points,) int64, -1 on entry: filled with the first face that covers each point,
# weights (n_points, 2) with those of its second and third corner
@kernel
def cover_points(
    vertices, faces, points, x0, y0, size, n_columns, n_rows, cell_indptr, order, face_of, weights
):
    for face in range(faces.shape[0]):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        ax, ay = vertices[a, 0], vertices[a, 1]
        bx, by = vertices[b, 0] - ax, vertices[b, 1] - ay
        cx, cy = vertices[c, 0] - ax, vertices[c, 1] - ay
        doubled_area = bx * cy - by * cx
        if doubled_area == 0.0:
            continue
        margin = EDGE_TOLERANCE * (abs(bx) + abs(by) + abs(cx) + abs(cy))
        low, high = ay + min(0.0, by, cy) - margin, ay + max(0.0, by, cy) + margin
        first_row = max(cell_of((low - y0) / size, n_rows), 0)
        last_row = min(cell_of((high - y0) / size, n_rows), n_rows - 1)
        for row in range(first_row, last_row + 1):
            bottom, top = y0 + row * size - margin, y0 + (row + 1) * size + margin
            left, right = np.inf, -np.inf
            for side in range(3):  # extent in x of the face between bottom and top
                if side == 0:
                    px, py, qx, qy = 0.0, 0.0, bx, by
                elif side == 1:
                    px, py, qx, qy = bx, by, cx, cy
                else:
                    px, py, qx, qy = cx, cy, 0.0, 0.0
                px, py, qx, qy = px + ax, py + ay, qx + ax, qy + ay
                if (py < bottom and qy < bottom) or (py > top and qy > top):
                    continue
                t_low, t_high = 0.0, 1.0
                if py != qy:
                    t1, t2 = (bottom - py) / (qy - py), (top - py) / (qy - py)
                    t_low, t_high = max(0.0, min(t1, t2)), min(1.0, max(t1, t2))
                x1, x2 = px + t_low * (qx - px), px + t_high * (qx - px)
                left, right = min(left, x1, x2), max(right, x1, x2)
            if left > right:
                continue
            first = max(cell_of((left - margin - x0) / size, n_columns), 0)
            last = min(cell_of((right + margin - x0) / size, n_columns), n_columns - 1)
            for k in range(
                cell_indptr[row * n_columns + min(first, n_columns)],
                cell_indptr[row * n_columns + max(last + 1, min(first, n_columns))],
            ):
                p = order[k]
                if face_of[p] >= 0:
                    continue
                dx, dy = points[p, 0] - ax, points[p, 1] - ay
                at_b = (dx * cy - dy * cx) / doubled_area
                at_c = (bx * dy - by * dx) / doubled_area
                if at_b < -EDGE_TOLERANCE or at_c < -EDGE_TOLERANCE:
                    continue
                if at_b + at_c > 1.0 + EDGE_TOLERANCE:
                    continue
                face_of[p] = face
                weights[p, 0], weights[p, 1] = at_b, at_c
