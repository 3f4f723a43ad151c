"""Prediction weights on whole arrays; see :mod:`wavelet_core._kernels.prediction`."""

from __future__ import annotations

import numpy as np

from .._kernels.connectivity import BOUNDARY
from .._kernels.prediction import (
    LARGEST_PLANE_NORM,
    LEAST_COTANGENT_SUM,
    LEAST_PLANE_DETERMINANT,
    SHORTEST_EDGE,
)
from ._csr import expanded
from ._rings import by_size, rings


def ring_columns(start, stop, odd, row_indptr, indptr, ring, even_position, columns):
    _, place = expanded(indptr[odd] + odd, np.diff(row_indptr))
    columns[:] = even_position[ring[place]]


def _each_size(odd, row_indptr, indptr, ring):
    """Yield rows, their vertices, rings ``(n, size)`` and where their weights go."""
    for size, rows in by_size(np.diff(row_indptr)):
        places = row_indptr[rows][:, None] + np.arange(size)
        yield rows, odd[rows], rings(odd[rows], size, indptr, ring), places


def _row_sums(values):
    total = np.zeros(len(values))
    for k in range(values.shape[1]):
        total += values[:, k]
    return total


def geometric_weights(start, stop, odd, row_indptr, indptr, ring, points, weights):
    for _, v, around, places in _each_size(odd, row_indptr, indptr, ring):
        squared = np.zeros(around.shape)
        for i in range(points.shape[1]):
            squared += (points[around, i] - points[v, i][:, None]) ** 2
        nearness = 1.0 / np.maximum(np.sqrt(squared), SHORTEST_EDGE)
        weights[places] = nearness / _row_sums(nearness)[:, None]


def _cotangent(points, corner, p, q):
    px, py, pz = (points[p, i] - points[corner, i] for i in range(3))
    qx, qy, qz = (points[q, i] - points[corner, i] for i in range(3))
    nx, ny, nz = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
    doubled_area = np.sqrt(nx * nx + ny * ny + nz * nz)
    has_area = doubled_area > 0.0
    along = px * qx + py * qy + pz * qz
    return np.where(has_area, along / np.where(has_area, doubled_area, 1.0), 0.0)


def cotangent_weights(start, stop, odd, row_indptr, indptr, ring, kind, points, weights):
    for _, v, around, places in _each_size(odd, row_indptr, indptr, ring):
        size = around.shape[1]
        is_closed = kind[v] != BOUNDARY
        values = np.empty(around.shape)
        for k in range(size):
            neighbour = around[:, k]
            total = np.zeros(len(v))
            has_face = is_closed | (k > 0)
            total += np.where(
                has_face, _cotangent(points, around[:, (k - 1) % size], neighbour, v), 0.0
            )
            has_face = is_closed | (k < size - 1)
            total += np.where(
                has_face, _cotangent(points, around[:, (k + 1) % size], v, neighbour), 0.0
            )
            values[:, k] = np.maximum(total, 0.0)
        sums = _row_sums(values)[:, None]
        sound = sums > LEAST_COTANGENT_SUM
        weights[places] = np.where(sound, values / np.where(sound, sums, 1.0), 1.0 / size)


def plane_weights(start, stop, odd, row_indptr, indptr, ring, plan, weights):
    for _, v, around, places in _each_size(odd, row_indptr, indptr, ring):
        size = around.shape[1]
        dx = plan[around, 0] - plan[v, 0][:, None]
        dy = plan[around, 1] - plan[v, 1][:, None]
        mean_x, mean_y = _row_sums(dx / size), _row_sums(dy / size)
        x, y = dx - mean_x[:, None], dy - mean_y[:, None]
        xx, xy, yy = _row_sums(x * x), _row_sums(x * y), _row_sums(y * y)
        determinant = xx * yy - xy * xy
        is_sound = determinant > LEAST_PLANE_DETERMINANT * (xx + yy) ** 2
        divisor = np.where(is_sound, determinant, 1.0)
        slope_x = (yy * mean_x - xy * mean_y) / divisor
        slope_y = (xx * mean_y - xy * mean_x) / divisor
        values = 1.0 / size - slope_x[:, None] * x - slope_y[:, None] * y
        is_sound &= _row_sums(values**2) <= LARGEST_PLANE_NORM
        weights[places] = np.where(is_sound[:, None], values, 1.0 / size)


def covering_faces(start, stop, odd, target, indptr, ring, ring_size, kind, plan, corners, weights):
    for size, rows in by_size(ring_size[odd]):
        v, a = odd[rows], target[rows]
        around = rings(v, size, indptr, ring)
        n_sides = np.where(kind[v] == BOUNDARY, size - 1, size)
        best = np.full(len(v), -np.inf)
        corners[rows] = a[:, None]  # without an upright face the target alone predicts
        weights[rows] = [1.0, 0.0, 0.0]
        avx, avy = plan[v, 0] - plan[a, 0], plan[v, 1] - plan[a, 1]
        for k in range(size):
            b, c = around[:, k], around[:, (k + 1) % size]
            abx, aby = plan[b, 0] - plan[a, 0], plan[b, 1] - plan[a, 1]
            acx, acy = plan[c, 0] - plan[a, 0], plan[c, 1] - plan[a, 1]
            doubled_area = abx * acy - aby * acx
            asked = (k < n_sides) & (b != a) & (c != a) & (doubled_area > 0.0)
            divisor = np.where(asked, doubled_area, 1.0)
            at_b = (avx * acy - avy * acx) / divisor
            at_c = (abx * avy - aby * avx) / divisor
            at_a = 1.0 - at_b - at_c
            least = np.minimum(np.minimum(at_a, at_b), at_c)
            better = np.flatnonzero(asked & (least > best))
            best[better] = least[better]
            into = rows[better]
            corners[into] = np.column_stack([a[better], b[better], c[better]])
            at = [np.maximum(values[better], 0.0) for values in (at_a, at_b, at_c)]
            weights[into] = np.column_stack(at) / (at[0] + at[1] + at[2])[:, None]
