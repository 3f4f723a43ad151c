"""How far refined TINs are from the least error that a long search finds, on a crop of a DEM.

usage: python benchmarks/quality/annealing.py DEM ROW COLUMN [--size 300] [--keep 0.02]
       [--moves 20000000] [--seed 0]

A plain annealer that shares nothing with the package but the TIN that it starts from. A step takes
a vertex at random and a node within a few steps of it, or an edge and its other diagonal; it is
taken if the sum of squared errors over all nodes falls, and by chance if it rises. Heights are
free; the moved vertex gets its best one. The temperature falls to nothing in a geometric way. At
the end heights are fitted for both. Needs the extra "bench".
"""

from __future__ import annotations

import argparse
from time import perf_counter

import numpy as np
from numba import njit
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve

#: Most faces around a vertex that is moved.
MAX_STAR = 24


@njit
def side(ax, ay, bx, by, px, py):
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


# Sums over the nodes of a face, each counted in one face alone (half-open edges): errors squared;
# and, for corner 0, weight squared, weight times error without that corner's height, error without
@njit
def face_sums(x0, y0, x1, y1, x2, y2, z0, z1, z2, grid):
    area = side(x0, y0, x1, y1, x2, y2)
    own, mixed, rest = 0.0, 0.0, 0.0
    for row in range(min(y0, y1, y2), max(y0, y1, y2) + 1):
        for column in range(min(x0, x1, x2), max(x0, x1, x2) + 1):
            w0 = side(x1, y1, x2, y2, column, row)
            w1 = side(x2, y2, x0, y0, column, row)
            w2 = side(x0, y0, x1, y1, column, row)
            if w0 < 0 or w1 < 0 or w2 < 0:
                continue
            if w0 == 0 and not is_upper(x2 - x1, y2 - y1, grid, row, column):
                continue
            if w1 == 0 and not is_upper(x0 - x2, y0 - y2, grid, row, column):
                continue
            if w2 == 0 and not is_upper(x1 - x0, y1 - y0, grid, row, column):
                continue
            a, b, c = w0 / area, w1 / area, w2 / area
            off = b * z1 + c * z2 - grid[row, column]
            own += a * a
            mixed += a * off
            rest += off * off
    return own, mixed, rest


# Of the two faces at an edge, a node on it counts in one
@njit
def is_upper(dx, dy, grid, row, column):
    if (row == 0 or row == grid.shape[0] - 1) and dy == 0:
        return True
    if (column == 0 or column == grid.shape[1] - 1) and dx == 0:
        return True
    return dy > 0 or (dy == 0 and dx > 0)


@njit
def star_of(v, faces, vertex_faces, n_faces_of, x, y, z, px, py, grid):
    """Return the sums of the star of v, were v at (px, py); own is -1 where that is not legal."""
    own, mixed, rest = 0.0, 0.0, 0.0
    for k in range(n_faces_of[v]):
        f = vertex_faces[v, k]
        i = 0
        while faces[f, i] != v:
            i += 1
        b, c = faces[f, (i + 1) % 3], faces[f, (i + 2) % 3]
        if side(px, py, x[b], y[b], x[c], y[c]) <= 0:
            return -1.0, 0.0, 0.0
        s = face_sums(px, py, x[b], y[b], x[c], y[c], 0.0, z[b], z[c], grid)
        own, mixed, rest = own + s[0], mixed + s[1], rest + s[2]
    return own, mixed, rest


@njit
def drop(v, f, vertex_faces, n_faces_of):
    for k in range(n_faces_of[v]):
        if vertex_faces[v, k] == f:
            n_faces_of[v] -= 1
            vertex_faces[v, k] = vertex_faces[v, n_faces_of[v]]
            return


@njit
def error_of(f, faces, x, y, z, grid):
    a, b, c = faces[f]
    own, mixed, rest = face_sums(x[a], y[a], x[b], y[b], x[c], y[c], z[a], z[b], z[c], grid)
    return own * z[a] * z[a] + 2 * mixed * z[a] + rest


@njit
def anneal(
    faces, vertex_faces, n_faces_of, x, y, z, is_corner, grid, n_moves, hot, cold, reach, rng
):
    n = len(x)
    for move in range(n_moves):
        heat = hot * (cold / hot) ** (move / n_moves)
        if move % 3 == 2:
            f = rng.integers(0, len(faces))
            i = rng.integers(0, 3)
            a, b, c = faces[f, i], faces[f, (i + 1) % 3], faces[f, (i + 2) % 3]
            g = -1
            for k in range(n_faces_of[b]):
                for j in range(3):
                    other = vertex_faces[b, k]
                    if faces[other, j] == b and faces[other, (j + 1) % 3] == a:
                        g, d = other, faces[other, (j + 2) % 3]
            if g < 0 or n_faces_of[c] >= MAX_STAR - 1 or n_faces_of[d] >= MAX_STAR - 1:
                continue
            if side(x[a], y[a], x[d], y[d], x[c], y[c]) <= 0:
                continue
            if side(x[d], y[d], x[b], y[b], x[c], y[c]) <= 0:
                continue
            before = error_of(f, faces, x, y, z, grid) + error_of(g, faces, x, y, z, grid)
            faces[f, 0], faces[f, 1], faces[f, 2] = a, d, c
            faces[g, 0], faces[g, 1], faces[g, 2] = d, b, c
            after = error_of(f, faces, x, y, z, grid) + error_of(g, faces, x, y, z, grid)
            if after < before or rng.random() < np.exp((before - after) / heat):
                drop(b, f, vertex_faces, n_faces_of)
                drop(a, g, vertex_faces, n_faces_of)
                vertex_faces[d, n_faces_of[d]] = f
                vertex_faces[c, n_faces_of[c]] = g
                n_faces_of[d] += 1
                n_faces_of[c] += 1
            else:
                faces[f, 0], faces[f, 1], faces[f, 2] = a, b, c
                faces[g, 0], faces[g, 1], faces[g, 2] = b, a, d
            continue
        v = rng.integers(0, n)
        if is_corner[v]:
            continue
        px = x[v] + rng.integers(-reach, reach + 1)
        py = y[v] + rng.integers(-reach, reach + 1)
        if x[v] == 0 or x[v] == grid.shape[1] - 1:
            px = x[v]
        if y[v] == 0 or y[v] == grid.shape[0] - 1:
            py = y[v]
        if px < 0 or py < 0 or px >= grid.shape[1] or py >= grid.shape[0]:
            continue
        if (px == 0) != (x[v] == 0) or (px == grid.shape[1] - 1) != (x[v] == grid.shape[1] - 1):
            continue
        if (py == 0) != (y[v] == 0) or (py == grid.shape[0] - 1) != (y[v] == grid.shape[0] - 1):
            continue
        own, mixed, rest = star_of(v, faces, vertex_faces, n_faces_of, x, y, z, x[v], y[v], grid)
        before = own * z[v] * z[v] + 2 * mixed * z[v] + rest
        own, mixed, rest = star_of(v, faces, vertex_faces, n_faces_of, x, y, z, px, py, grid)
        if own <= 0.0:
            continue
        after = rest - mixed * mixed / own
        if after < before or rng.random() < np.exp((before - after) / heat):
            x[v], y[v], z[v] = px, py, -mixed / own


def fitted_rmse(faces, x, y, grid):
    """Return the least RMSE that heights can give on these triangles, solved directly."""
    _n_rows, n_columns = grid.shape
    rows, columns, values = [], [], []
    found = np.zeros(grid.shape, dtype=bool)
    for a, b, c in faces:
        xs, ys = x[[a, b, c]], y[[a, b, c]]
        column, row = np.meshgrid(
            np.arange(xs.min(), xs.max() + 1), np.arange(ys.min(), ys.max() + 1)
        )
        area = (xs[1] - xs[0]) * (ys[2] - ys[0]) - (ys[1] - ys[0]) * (xs[2] - xs[0])
        w1 = ((xs[2] - column) * (ys[0] - row) - (ys[2] - row) * (xs[0] - column)) / area
        w2 = ((xs[0] - column) * (ys[1] - row) - (ys[0] - row) * (xs[1] - column)) / area
        inside = (w1 >= -1e-12) & (w2 >= -1e-12) & (w1 + w2 <= 1 + 1e-12) & ~found[row, column]
        found[row[inside], column[inside]] = True
        node = row[inside] * n_columns + column[inside]
        for vertex, weight in ((a, 1 - w1 - w2), (b, w1), (c, w2)):
            rows.append(node)
            columns.append(np.full(len(node), vertex))
            values.append(weight[inside])
    if not found.all():
        raise SystemExit("the TIN does not cover the crop")
    parts = (np.concatenate(rows), np.concatenate(columns))
    matrix = csr_array((np.concatenate(values), parts), shape=(grid.size, len(x)))
    z = spsolve((matrix.T @ matrix).tocsc(), matrix.T @ grid.ravel())
    return float(np.sqrt(np.mean((matrix @ z - grid.ravel()) ** 2))), z


def main():
    import rasterio

    from wavelet_core import TriangleMesh, analyse, finished

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dem")
    parser.add_argument("row", type=int)
    parser.add_argument("column", type=int)
    parser.add_argument("--size", type=int, default=300)
    parser.add_argument("--keep", type=float, default=0.02)
    parser.add_argument("--moves", type=int, default=20_000_000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    with rasterio.open(arguments.dem) as dataset:
        band = dataset.read(1)
    crop = band[arguments.row :, arguments.column :][: arguments.size, : arguments.size]
    crop = np.ascontiguousarray(crop, dtype=np.float64)
    n_rows, n_columns = crop.shape
    mesh = TriangleMesh.from_grid(crop, np.arange(float(n_columns)), np.arange(float(n_rows)))
    pyramid = analyse(mesh, target_vertices=round(arguments.keep * crop.size))
    rmse = {}
    for name, rounds in (("fitted", 0), ("refined", None)):
        tin = finished(pyramid, mesh, rounds=rounds)
        x, y = (np.round(tin.mesh.vertices[:, k]).astype(np.int64) for k in (0, 1))
        rmse[name], z = fitted_rmse(tin.mesh.faces, x, y, crop)
    faces = tin.mesh.faces.copy()
    star, degree = np.full((len(x), MAX_STAR), -1), np.zeros(len(x), dtype=np.int64)
    for f, face in enumerate(faces):
        for v in face:
            star[v, degree[v]] = f
            degree[v] += 1
    is_corner = ((x == 0) | (x == n_columns - 1)) & ((y == 0) | (y == n_rows - 1))
    mean = rmse["refined"] ** 2 * crop.size / len(x)  # squared error a vertex
    began = perf_counter()
    rng = np.random.default_rng(arguments.seed)
    start = (faces, star, degree, x, y, z, is_corner, crop)
    anneal(*start, arguments.moves, 0.3 * mean, 1e-4 * mean, 3, rng)
    rmse["annealed"], _ = fitted_rmse(faces, x, y, crop)
    shown = "   ".join(f"{name} {value:.4f}" for name, value in rmse.items())
    share = rmse["refined"] / rmse["annealed"]
    print(f"{shown}   refined/annealed {share:.3f}   {perf_counter() - began:.0f} s of annealing")


if __name__ == "__main__":
    main()
