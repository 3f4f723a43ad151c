"""Kernels of :mod:`wavelet_core.features.shape`: quadratics fitted to neighbourhoods."""

import math

import numpy as np

from ._jit import kernel, njit

# more neighbours than this are not looked at; real stars have 6 on average
MAX_NEIGHBOURS = 64
# five coefficients need five neighbours; with fewer the second ring joins in
MIN_NEIGHBOURS = 5
# smallest pivot, as part of its diagonal, with which the first ring and the second determine the
# normal equations; neighbours near a conic hardly do, which gave one vertex in a thousand of
# irregular meshes slopes towards 90 degrees when the first ring had the bound of the second
MIN_PIVOTS = (0.03, 1e-7)
# the same of windows, whose quadratics are over-determined, and the fewest means in one: three more
# than coefficients
MIN_WINDOW_PIVOT, MIN_MEANS = 1e-3, 9


# matrix (n, n) and right (n,) float64, overwritten; solution (n,) float64, filled by Cholesky;
# True where every pivot is above `least` of its diagonal
@njit
def solve_normal(matrix, right, solution, least):
    n = len(right)
    for i in range(n):
        diagonal = matrix[i, i]
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            if i == j:
                if not total > least * diagonal:
                    return False
                matrix[i, i] = math.sqrt(total)
            else:
                matrix[i, j] = total / matrix[j, j]
    for i in range(n):
        total = right[i]
        for k in range(i):
            total -= matrix[i, k] * solution[k]
        solution[i] = total / matrix[i, i]
    for i in range(n - 1, -1, -1):
        total = solution[i]
        for k in range(i + 1, n):
            total -= matrix[k, i] * solution[k]
        solution[i] = total / matrix[i, i]
    return True


# neighbours (MAX_NEIGHBOURS,) int32, filled with the vertices of the faces around a vertex, and
# with those around its neighbours where `n_rings` is 2; returns how many
@njit
def gather_neighbours(vertex, n_rings, faces, indptr, star, neighbours):
    count, first, last = 0, -1, 0
    for _ring in range(n_rings):
        for position in range(first, last):
            centre = vertex if position < 0 else neighbours[position]
            for k in range(indptr[centre], indptr[centre + 1]):
                for corner in range(3):
                    other = faces[star[k], corner]
                    known = other == vertex
                    for m in range(count):
                        known = known or neighbours[m] == other
                    if not known and count < MAX_NEIGHBOURS:
                        neighbours[count] = other
                        count += 1
        first, last = 0, count
    return count


# points (n, 3) float64; faces (n_faces, 3) int32; indptr (n + 1,) int64, star int32;
# coefficients (n, 5) float64, filled with z_x, z_y, z_xx, z_xy, z_yy; NaN without a face
@kernel
def fit_quadratics(start, stop, points, faces, indptr, star, coefficients):
    neighbours = np.empty(MAX_NEIGHBOURS, dtype=np.int32)
    matrix = np.empty((5, 5))
    right = np.empty(5)
    row = np.empty(5)
    solution = np.empty(5)
    for vertex in range(start, stop):
        for i in range(5):
            coefficients[vertex, i] = np.nan
        if indptr[vertex + 1] == indptr[vertex]:
            continue
        for n_rings in range(1, 3):
            count = gather_neighbours(vertex, n_rings, faces, indptr, star, neighbours)
            if n_rings == 1 and count < MIN_NEIGHBOURS:
                continue
            scale = 0.0
            for k in range(count):
                dx = points[neighbours[k], 0] - points[vertex, 0]
                dy = points[neighbours[k], 1] - points[vertex, 1]
                scale += math.sqrt(dx * dx + dy * dy) / count
            if not scale > 0.0:
                continue
            for i in range(5):
                right[i] = 0.0
                for j in range(5):
                    matrix[i, j] = 0.0
            for k in range(count):
                u = (points[neighbours[k], 0] - points[vertex, 0]) / scale
                v = (points[neighbours[k], 1] - points[vertex, 1]) / scale
                rise = points[neighbours[k], 2] - points[vertex, 2]
                squared = u * u + v * v
                if squared <= 0.0:
                    continue
                row[0], row[1], row[2], row[3], row[4] = u, v, 0.5 * u * u, u * v, 0.5 * v * v
                for i in range(5):
                    right[i] += row[i] * rise / squared
                    for j in range(i + 1):
                        matrix[i, j] += row[i] * row[j] / squared
            if solve_normal(matrix, right, solution, MIN_PIVOTS[n_rings - 1]):
                coefficients[vertex, 0] = solution[0] / scale
                coefficients[vertex, 1] = solution[1] / scale
                for i in range(2, 5):
                    coefficients[vertex, i] = solution[i] / (scale * scale)
                break
        if math.isnan(coefficients[vertex, 0]):
            mean_gradient(vertex, points, faces, indptr, star, coefficients)


# the gradient of the faces around a vertex, weighted by plan area, and no curvature
@njit
def mean_gradient(vertex, points, faces, indptr, star, coefficients):
    area, rise_x, rise_y = 0.0, 0.0, 0.0
    for k in range(indptr[vertex], indptr[vertex + 1]):
        a, b, c = faces[star[k], 0], faces[star[k], 1], faces[star[k], 2]
        bx, by = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        bz = points[b, 2] - points[a, 2]
        cx, cy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
        cz = points[c, 2] - points[a, 2]
        area += bx * cy - by * cx
        rise_x += bz * cy - by * cz
        rise_y += bx * cz - bz * cx
    if area != 0.0:
        coefficients[vertex, 0], coefficients[vertex, 1] = rise_x / area, rise_y / area
        for i in range(2, 5):
            coefficients[vertex, i] = 0.0


# places (n, 3) float64; first, last (n, 3) int64: runs of the means that may be near each place;
# means (n_means, 3), moments (n_means, 3), weights (n_means,) float64; coefficients (n, 5) float64,
# filled as above, NaN where too few means are within `radius`, or they do not determine them
@kernel
def fit_windows(start, stop, places, first, last, means, moments, weights, radius, coefficients):
    matrix = np.empty((6, 6))
    right = np.empty(6)
    row = np.empty(6)
    solution = np.empty(6)
    for place in range(start, stop):
        count = 0
        for i in range(6):
            right[i] = 0.0
            for j in range(6):
                matrix[i, j] = 0.0
        for run in range(3):
            for k in range(first[place, run], last[place, run]):
                u = (means[k, 0] - places[place, 0]) / radius
                v = (means[k, 1] - places[place, 1]) / radius
                weight = weights[k] * (1.0 - (u * u + v * v))
                if not weight > 0.0:
                    continue
                count += 1
                rise = means[k, 2] - places[place, 2]
                row[0], row[1], row[2] = 1.0, u, v
                row[3] = 0.5 * (u * u + moments[k, 0] / (radius * radius))
                row[4] = u * v + moments[k, 1] / (radius * radius)
                row[5] = 0.5 * (v * v + moments[k, 2] / (radius * radius))
                for i in range(6):
                    right[i] += row[i] * rise * weight
                    for j in range(i + 1):
                        matrix[i, j] += row[i] * row[j] * weight
        for i in range(5):
            coefficients[place, i] = np.nan
        if count >= MIN_MEANS and solve_normal(matrix, right, solution, MIN_WINDOW_PIVOT):
            coefficients[place, 0] = solution[1] / radius
            coefficients[place, 1] = solution[2] / radius
            for i in range(2, 5):
                coefficients[place, i] = solution[i + 1] / (radius * radius)


# positions (n_even, 2), odd_positions (n_odd, 2) float64; indptr, indices, weights: a prediction
# filter; first (n_odd, 2) and second (n_odd,) float64, filled with its plan moments
@kernel
def filter_moments(start, stop, indptr, indices, weights, positions, odd_positions, first, second):
    for row in range(start, stop):
        first[row, 0], first[row, 1], second[row] = 0.0, 0.0, 0.0
        for k in range(indptr[row], indptr[row + 1]):
            dx = positions[indices[k], 0] - odd_positions[row, 0]
            dy = positions[indices[k], 1] - odd_positions[row, 1]
            first[row, 0] += weights[k] * dx
            first[row, 1] += weights[k] * dy
            second[row] += weights[k] * (dx * dx + dy * dy)
