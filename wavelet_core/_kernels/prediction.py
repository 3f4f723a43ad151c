"""Kernels of :mod:`wavelet_core.lifting.prediction`: weights of the one-ring of each odd vertex.

They share their first arguments: odd (n_odd,) int32; row_indptr (n_odd + 1,) int64; indptr, ring
of the connectivity; points (n, d) float64; weights (nnz,) float64, filled row by row in the order
of the ring.
"""

import math

import numpy as np

from ._jit import kernel, njit
from .connectivity import BOUNDARY

# shortest edge, in normalised coordinates, that the geometric weights tell from zero
SHORTEST_EDGE = 1e-12
# least sum of cotangents that is still divided by
LEAST_COTANGENT_SUM = 1e-9
NNLS_DAMPING = 1e-8
# the same, so that the two differ in the sign of the weights alone; with 1e-10 the weights of 20
# levels of LiDAR with the one-ring-mean update lost more than 1e-9 of the coefficients
LEAST_SQUARES_DAMPING = 1e-8
# dual values below this count as met in the non-negative least squares
NNLS_TOLERANCE = 1e-11
# a ring flatter than this in plan determines no plane (relative to its squared size)
LEAST_PLANE_DETERMINANT = 1e-12
# a vertex inside its ring has weights of squared norm 1 at most; more means it lies outside
LARGEST_PLANE_NORM = 1.0 + 1e-6


# even_position (n,) int32; columns (nnz,) int32, filled
@kernel
def ring_columns(start, stop, odd, row_indptr, indptr, ring, even_position, columns):
    for row in range(start, stop):
        base = indptr[odd[row]] + odd[row]
        for k in range(row_indptr[row + 1] - row_indptr[row]):
            columns[row_indptr[row] + k] = even_position[ring[base + k]]


@kernel
def geometric_weights(start, stop, odd, row_indptr, indptr, ring, points, weights):
    for row in range(start, stop):
        v = odd[row]
        base, first, last = indptr[v] + v, row_indptr[row], row_indptr[row + 1]
        total = 0.0
        for k in range(last - first):
            neighbour = ring[base + k]
            squared = 0.0
            for i in range(points.shape[1]):
                side = points[neighbour, i] - points[v, i]
                squared += side * side
            weights[first + k] = 1.0 / max(math.sqrt(squared), SHORTEST_EDGE)
            total += weights[first + k]
        for k in range(first, last):
            weights[k] /= total


# cotangent of the angle at `corner` in the triangle (corner, p, q), in the first three columns
@njit
def cotangent(points, corner, p, q):
    px, py = points[p, 0] - points[corner, 0], points[p, 1] - points[corner, 1]
    pz = points[p, 2] - points[corner, 2]
    qx, qy = points[q, 0] - points[corner, 0], points[q, 1] - points[corner, 1]
    qz = points[q, 2] - points[corner, 2]
    nx, ny, nz = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
    doubled_area = math.sqrt(nx * nx + ny * ny + nz * nz)
    if doubled_area <= 0.0:
        return 0.0
    return (px * qx + py * qy + pz * qz) / doubled_area


@kernel
def cotangent_weights(start, stop, odd, row_indptr, indptr, ring, kind, points, weights):
    for row in range(start, stop):
        v = odd[row]
        base, first = indptr[v] + v, row_indptr[row]
        size = row_indptr[row + 1] - first
        is_closed = kind[v] != BOUNDARY
        total = 0.0
        for k in range(size):
            neighbour = ring[base + k]
            cotangents = 0.0
            if is_closed or k > 0:
                cotangents += cotangent(points, ring[base + (k - 1) % size], neighbour, v)
            if is_closed or k < size - 1:
                cotangents += cotangent(points, ring[base + (k + 1) % size], v, neighbour)
            weights[first + k] = max(cotangents, 0.0)
            total += weights[first + k]
        for k in range(first, first + size):
            weights[k] = weights[k] / total if total > LEAST_COTANGENT_SUM else 1.0 / size


# gram (size, size) float64, filled with D D^T / scale + damping I, rows of D = neighbours - v;
# returns the mean squared length of the rows (0: all neighbours lie on v)
@njit
def damped_gram(v, base, size, ring, points, damping, gram):
    scale = 0.0
    for k in range(size):
        for i in range(points.shape[1]):
            side = points[ring[base + k], i] - points[v, i]
            scale += side * side
    scale /= size
    if scale <= 0.0:
        return scale
    for k in range(size):
        for m in range(k + 1):
            product = 0.0
            for i in range(points.shape[1]):
                product += (points[ring[base + k], i] - points[v, i]) * (
                    points[ring[base + m], i] - points[v, i]
                )
            gram[k, m] = product / scale
            gram[m, k] = product / scale
        gram[k, k] += damping
    return scale


# Solve matrix[free, free] x = 1 by Cholesky; free (n_free,) int64; factor, x: work and result
@njit
def solve_for_ones(matrix, free, n_free, factor, x):
    for i in range(n_free):
        for j in range(i + 1):
            total = matrix[free[i], free[j]]
            for k in range(j):
                total -= factor[i, k] * factor[j, k]
            if i == j:
                factor[i, i] = math.sqrt(max(total, 1e-300))
            else:
                factor[i, j] = total / factor[j, j]
    for i in range(n_free):
        total = 1.0
        for k in range(i):
            total -= factor[i, k] * x[k]
        x[i] = total / factor[i, i]
    for i in range(n_free - 1, -1, -1):
        total = x[i]
        for k in range(i + 1, n_free):
            total -= factor[k, i] * x[k]
        x[i] = total / factor[i, i]


# Lawson-Hanson on the normal equations: min x^T matrix x / 2 - 1^T x, x >= 0; x filled
@njit
def nonnegative_solution(matrix, size, x):
    free = np.empty(size, dtype=np.int64)
    is_free = np.zeros(size, dtype=np.bool_)
    factor = np.empty((size, size))
    trial = np.empty(size)
    n_free = 0
    for i in range(size):
        x[i] = 0.0
    for _ in range(10 * size):
        entering, steepest = -1, NNLS_TOLERANCE
        for i in range(size):
            if is_free[i]:
                continue
            slope = 1.0
            for k in range(size):
                slope -= matrix[i, k] * x[k]
            if slope > steepest:
                entering, steepest = i, slope
        if entering < 0:
            return
        is_free[entering] = True
        while True:
            n_free = 0
            for i in range(size):
                if is_free[i]:
                    free[n_free] = i
                    n_free += 1
            solve_for_ones(matrix, free, n_free, factor, trial)
            step, blocked = 1.0, False
            for k in range(n_free):
                if trial[k] <= 0.0:
                    blocked = True
                    step = min(step, x[free[k]] / (x[free[k]] - trial[k] + 1e-300))
            for k in range(n_free):
                i = free[k]
                x[i] += step * (trial[k] - x[i])
                if blocked and trial[k] <= 0.0 and x[i] <= 1e-15:
                    x[i] = 0.0
                    is_free[i] = False
            if not blocked:
                break


@kernel
def nnls_weights(start, stop, odd, row_indptr, indptr, ring, points, weights):
    for row in range(start, stop):
        v = odd[row]
        first = row_indptr[row]
        size = row_indptr[row + 1] - first
        gram = np.empty((size, size))
        scale = damped_gram(v, indptr[v] + v, size, ring, points, NNLS_DAMPING, gram)
        solution = np.zeros(size)
        if scale > 0.0:
            for k in range(size):
                for m in range(size):
                    gram[k, m] += 1.0
            nonnegative_solution(gram, size, solution)
        total = 0.0
        for k in range(size):
            total += solution[k]
        for k in range(size):
            weights[first + k] = solution[k] / total if total > 0.0 else 1.0 / size


@kernel
def least_squares_weights(start, stop, odd, row_indptr, indptr, ring, points, weights):
    for row in range(start, stop):
        v = odd[row]
        first = row_indptr[row]
        size = row_indptr[row + 1] - first
        gram = np.empty((size, size))
        scale = damped_gram(v, indptr[v] + v, size, ring, points, LEAST_SQUARES_DAMPING, gram)
        solution = np.ones(size)
        if scale > 0.0:
            everything = np.arange(size)
            solve_for_ones(gram, everything, size, np.empty((size, size)), solution)
        total = 0.0
        for k in range(size):
            total += solution[k]
        for k in range(size):
            weights[first + k] = solution[k] / total


# plan (n, 2) float64. The weights of least norm that give back every plane; even ones where the
# ring is a line in plan, or does not lie round v (signal "xyz" only)
@kernel
def plane_weights(start, stop, odd, row_indptr, indptr, ring, plan, weights):
    for row in range(start, stop):
        v = odd[row]
        base, first = indptr[v] + v, row_indptr[row]
        size = row_indptr[row + 1] - first
        mean_x, mean_y = 0.0, 0.0
        for k in range(size):
            mean_x += (plan[ring[base + k], 0] - plan[v, 0]) / size
            mean_y += (plan[ring[base + k], 1] - plan[v, 1]) / size
        xx, xy, yy = 0.0, 0.0, 0.0
        for k in range(size):
            x = plan[ring[base + k], 0] - plan[v, 0] - mean_x
            y = plan[ring[base + k], 1] - plan[v, 1] - mean_y
            xx += x * x
            xy += x * y
            yy += y * y
        determinant = xx * yy - xy * xy
        is_sound = determinant > LEAST_PLANE_DETERMINANT * (xx + yy) * (xx + yy)
        norm = 0.0
        if is_sound:
            slope_x = (yy * mean_x - xy * mean_y) / determinant
            slope_y = (xx * mean_y - xy * mean_x) / determinant
            for k in range(size):
                x = plan[ring[base + k], 0] - plan[v, 0] - mean_x
                y = plan[ring[base + k], 1] - plan[v, 1] - mean_y
                weights[first + k] = 1.0 / size - slope_x * x - slope_y * y
                norm += weights[first + k] * weights[first + k]
        if not is_sound or norm > LARGEST_PLANE_NORM:
            for k in range(first, first + size):
                weights[k] = 1.0 / size


# target (n_odd,) int32; plan (n, 2) float64; corners (n_odd, 3) int32 and weights (n_odd, 3)
# float64, filled: the coarse face that covers each odd vertex in plan, and its coordinates there
@kernel
def covering_faces(start, stop, odd, target, indptr, ring, ring_size, kind, plan, corners, weights):
    for row in range(start, stop):
        v, a = odd[row], target[row]
        base, size = indptr[v] + v, ring_size[v]
        n_sides = size - 1 if kind[v] == BOUNDARY else size
        best = -np.inf
        for k in range(n_sides):
            b, c = ring[base + k], ring[base + (k + 1) % size]
            if b == a or c == a:
                continue
            abx, aby = plan[b, 0] - plan[a, 0], plan[b, 1] - plan[a, 1]
            acx, acy = plan[c, 0] - plan[a, 0], plan[c, 1] - plan[a, 1]
            avx, avy = plan[v, 0] - plan[a, 0], plan[v, 1] - plan[a, 1]
            doubled_area = abx * acy - aby * acx
            if doubled_area <= 0.0:
                continue
            at_b = (avx * acy - avy * acx) / doubled_area
            at_c = (abx * avy - aby * avx) / doubled_area
            at_a = 1.0 - at_b - at_c
            least = min(at_a, at_b, at_c)
            if least > best:
                best = least
                corners[row, 0], corners[row, 1], corners[row, 2] = a, b, c
                at_a, at_b, at_c = max(at_a, 0.0), max(at_b, 0.0), max(at_c, 0.0)
                total = at_a + at_b + at_c
                weights[row, 0] = at_a / total
                weights[row, 1] = at_b / total
                weights[row, 2] = at_c / total
        if best == -np.inf:  # no upright face (signal "xyz" only): the target alone predicts
            for k in range(3):
                corners[row, k] = a
                weights[row, k] = 1.0 if k == 0 else 0.0
