"""Kernels of :class:`wavelet_core.mesh.triangle_mesh.TriangleMesh`: the faces of a raster."""

from ._jit import inlined, kernel


# Corners of the square whose lower left is (row, column), -1 where there is no cell
@inlined
def square(ids, row, column):
    return (
        ids[row, column], ids[row, column + 1], ids[row + 1, column], ids[row + 1, column + 1],
    )  # fmt: skip


# How many of the corners are cells; whole numbers, since the sum of numpy's bools is a bool
@inlined
def n_cells(a, b, d, e):
    return int(a >= 0) + int(b >= 0) + int(d >= 0) + int(e >= 0)


# How many faces the squares between the rows r and r + 1 have; ids (n_rows, n_columns) int32, -1
# where there is no cell; counts (n_rows - 1,) int64, filled
@kernel
def count_grid_faces(start, stop, ids, counts):
    for row in range(start, stop):
        n_faces = 0
        for column in range(ids.shape[1] - 1):
            a, b, d, e = square(ids, row, column)
            n_faces += max(n_cells(a, b, d, e) - 2, 0)
        counts[row] = n_faces


# The faces themselves, those of row r from first[r] on: faces (n_faces, 3) int64, filled. See
# `grid_faces` of mesh/triangle_mesh.py for which they are.
@kernel
def fill_grid_faces(start, stop, ids, first, is_clockwise, faces):
    begin, end = (2, 0) if is_clockwise else (0, 2)
    for row in range(start, stop):
        face = first[row]
        for column in range(ids.shape[1] - 1):
            a, b, d, e = square(ids, row, column)
            if n_cells(a, b, d, e) < 3:
                continue
            if a < 0:
                p, q, r = b, e, d
            elif e < 0:
                p, q, r = a, b, d
            elif b < 0:
                p, q, r = a, e, d
            else:
                p, q, r = a, b, e
            faces[face, begin], faces[face, 1], faces[face, end] = p, q, r
            face += 1
            if a >= 0 and b >= 0 and d >= 0 and e >= 0:
                faces[face, begin], faces[face, 1], faces[face, end] = a, e, d
                face += 1
