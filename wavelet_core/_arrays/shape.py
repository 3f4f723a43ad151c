"""Quadratics fitted to neighbourhoods, on whole arrays; see :mod:`wavelet_core._kernels.shape`."""

from __future__ import annotations

import numpy as np

from .._kernels.shape import (
    MAX_NEIGHBOURS,
    MIN_MEANS,
    MIN_NEIGHBOURS,
    MIN_PIVOTS,
    MIN_WINDOW_PIVOT,
)
from ._csr import blocks, expanded, summed

#: Vertices whose neighbourhoods are looked at together: a bound on the memory.
VERTICES_AT_ONCE = 1 << 15
#: Pairs of a place and a mean near it that are looked at together.
PAIRS_AT_ONCE = 1 << 20


def fit_quadratics(start, stop, points, faces, indptr, star, coefficients):
    coefficients[:] = np.nan
    with_face = np.flatnonzero(np.diff(indptr) > 0)
    for first in range(0, len(with_face), VERTICES_AT_ONCE):
        left = with_face[first : first + VERTICES_AT_ONCE]
        for n_rings in (1, 2):
            row, neighbour = _neighbours(left, n_rings, faces, indptr, star)
            left = _fit(left, row, neighbour, n_rings, points, coefficients)
        _mean_gradients(left, points, faces, indptr, star, coefficients)


def _corners_around(row, centre, faces, indptr, star):
    """Row and vertex of all corners of the faces around the centres."""
    entry, place = expanded(indptr[centre], np.diff(indptr)[centre])
    return np.repeat(row[entry], 3), faces[star[place]].ravel()


def _neighbours(vertices, n_rings, faces, indptr, star):
    """Neighbours of each vertex in the order in which they are met, each once."""
    row, found = _corners_around(np.arange(len(vertices)), vertices, faces, indptr, star)
    row, found = _first_ones(row, found, vertices)
    if n_rings == 2:
        more_row, more = _corners_around(row, found, faces, indptr, star)
        row, found = np.concatenate([row, more_row]), np.concatenate([found, more])
        in_order = np.argsort(row, kind="stable")
        row, found = _first_ones(row[in_order], found[in_order], vertices)
    return row, found


def _first_ones(row, found, vertices):
    """Each vertex once a row, but for the row's own; at most ``MAX_NEIGHBOURS``."""
    key = row * (np.int64(found.max(initial=0)) + 1) + found
    _, first = np.unique(key, return_index=True)
    first.sort()
    first = first[found[first] != vertices[row[first]]]
    row, found = row[first], found[first]
    count = np.bincount(row, minlength=len(vertices))
    place = np.arange(len(row)) - (np.cumsum(count) - count)[row]
    kept = place < MAX_NEIGHBOURS
    return row[kept], found[kept]


def _fit(vertices, row, neighbour, n_rings, points, coefficients):
    """Fit where it can be done; return the vertices that are left."""
    n = len(vertices)
    count = np.bincount(row, minlength=n)
    offset = points[neighbour, :2] - points[vertices[row], :2]
    reach = np.sqrt(offset[:, 0] * offset[:, 0] + offset[:, 1] * offset[:, 1])
    scale = summed(row, reach / count[row], np.zeros(n))
    asked = (scale > 0.0) & ((count >= MIN_NEIGHBOURS) | (n_rings == 2))
    divisor = np.where(scale > 0.0, scale, 1.0)
    u, v = offset[:, 0] / divisor[row], offset[:, 1] / divisor[row]
    squared = u * u + v * v
    used = squared > 0.0
    row, u, v, squared = row[used], u[used], v[used], squared[used]
    rise = points[neighbour[used], 2] - points[vertices[row], 2]
    terms = (u, v, 0.5 * u * u, u * v, 0.5 * v * v)
    zero = np.zeros(n)
    right = [summed(row, term * rise / squared, zero) for term in terms]
    matrix = [
        [summed(row, terms[i] * terms[j] / squared, zero) for j in range(i + 1)] for i in range(5)
    ]
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        solved, solution = _solve_normal(matrix, right, MIN_PIVOTS[n_rings - 1])
        solved &= asked
        values = np.column_stack(
            [s / divisor for s in solution[:2]] + [s / (divisor * divisor) for s in solution[2:]]
        )
    coefficients[vertices[solved]] = values[solved]
    return vertices[~solved]


def _solve_normal(matrix, right, least):
    """Cholesky of all systems at once; which are determined, and their solutions."""
    n = len(right)
    sound = np.ones(len(right[0]), dtype=bool)
    for i in range(n):
        diagonal = matrix[i][i]
        for j in range(i + 1):
            total = matrix[i][j]
            for k in range(j):
                total = total - matrix[i][k] * matrix[j][k]
            if i == j:
                sound &= total > least * diagonal
                matrix[i][i] = np.sqrt(total)
            else:
                matrix[i][j] = total / matrix[j][j]
    solution = [right[0]] * n
    for i in range(n):
        total = right[i]
        for k in range(i):
            total = total - matrix[i][k] * solution[k]
        solution[i] = total / matrix[i][i]
    for i in range(n - 1, -1, -1):
        total = solution[i]
        for k in range(i + 1, n):
            total = total - matrix[k][i] * solution[k]
        solution[i] = total / matrix[i][i]
    return sound, solution


def _mean_gradients(vertices, points, faces, indptr, star, coefficients):
    row, place = expanded(indptr[vertices], np.diff(indptr)[vertices])
    a, b, c = faces[star[place]].T
    bx, by, bz = (points[b, i] - points[a, i] for i in range(3))
    cx, cy, cz = (points[c, i] - points[a, i] for i in range(3))
    zero = np.zeros(len(vertices))
    area = summed(row, bx * cy - by * cx, zero)
    rise_x = summed(row, bz * cy - by * cz, zero)
    rise_y = summed(row, bx * cz - bz * cx, zero)
    sound = area != 0.0
    vertices = vertices[sound]
    coefficients[vertices] = 0.0
    coefficients[vertices, 0] = rise_x[sound] / area[sound]
    coefficients[vertices, 1] = rise_y[sound] / area[sound]


def fit_windows(start, stop, places, first, last, means, moments, weights, radius, coefficients):
    sizes = (last - first).sum(axis=1)
    for part in blocks(sizes, PAIRS_AT_ONCE):
        entry, near = expanded(first[part].ravel(), (last[part] - first[part]).ravel())
        coefficients[part] = _windows(
            places[part], entry // 3, near, means, moments, weights, radius
        )


def _windows(places, row, near, means, moments, weights, radius):
    """Coefficients of the places, from pairs of a place and a mean."""
    u = (means[near, 0] - places[row, 0]) / radius
    v = (means[near, 1] - places[row, 1]) / radius
    weight = weights[near] * (1.0 - (u * u + v * v))
    used = weight > 0.0
    row, near, u, v, weight = row[used], near[used], u[used], v[used], weight[used]
    rise = means[near, 2] - places[row, 2]
    squared = radius * radius
    terms = (
        np.ones(len(row)),
        u,
        v,
        0.5 * (u * u + moments[near, 0] / squared),
        u * v + moments[near, 1] / squared,
        0.5 * (v * v + moments[near, 2] / squared),
    )
    zero = np.zeros(len(places))
    right = [summed(row, term * rise * weight, zero) for term in terms]
    matrix = [
        [summed(row, terms[i] * terms[j] * weight, zero) for j in range(i + 1)] for i in range(6)
    ]
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        solved, solution = _solve_normal(matrix, right, MIN_WINDOW_PIVOT)
        values = np.column_stack(
            [s / radius for s in solution[1:3]] + [s / squared for s in solution[3:]]
        )
    values[~(solved & (np.bincount(row, minlength=len(places)) >= MIN_MEANS))] = np.nan
    return values


def filter_moments(start, stop, indptr, indices, weights, positions, odd_positions, first, second):
    row = np.repeat(np.arange(len(odd_positions)), np.diff(indptr))
    dx = positions[indices, 0] - odd_positions[row, 0]
    dy = positions[indices, 1] - odd_positions[row, 1]
    zero = np.zeros(len(odd_positions))
    first[:, 0], first[:, 1] = summed(row, weights * dx, zero), summed(row, weights * dy, zero)
    second[:] = summed(row, weights * (dx * dx + dy * dy), zero)
