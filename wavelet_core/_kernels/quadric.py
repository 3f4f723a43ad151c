"""Kernels of :mod:`wavelet_core.mesh.quadric`: packed symmetric matrices in R^(n+1), homogeneous.

A quadric of dimension d is stored as the upper triangle of A (d (d + 1) / 2 values, row by
row), then b (d values), then c: error(p) = p^T A p + 2 b^T p + c.
"""

import math

import numpy as np

from ._jit import kernel, njit
from .lattice import on_lattice

# what rounding leaves of a quadric's value, as a part of its terms: some 256 times the spacing of
# doubles; on flat terrain Eq. 36 came out at up to 2e-15 of terms of about 10
ROUNDING = 2.0**-44


# points (n, d) float64; quadrics (n, (d + 1) (d + 2) / 2) float64, filled: Eq. 35
@kernel
def star_quadrics(start, stop, points, faces, indptr, star, quadrics):
    d = points.shape[1]
    u = np.empty(d)
    w = np.empty(d)
    for vertex in range(start, stop):
        for k in range(quadrics.shape[1]):
            quadrics[vertex, k] = 0.0
        for k in range(indptr[vertex], indptr[vertex + 1]):
            p, q, r = faces[star[k], 0], faces[star[k], 1], faces[star[k], 2]
            length = 0.0
            for i in range(d):
                u[i] = points[q, i] - points[p, i]
                length += u[i] * u[i]
            if length <= 0.0:
                continue
            length = math.sqrt(length)
            along = 0.0
            for i in range(d):
                u[i] /= length
                along += (points[r, i] - points[p, i]) * u[i]
            height = 0.0
            for i in range(d):
                w[i] = points[r, i] - points[p, i] - along * u[i]
                height += w[i] * w[i]
            if height <= 0.0:
                continue
            height = math.sqrt(height)
            pu, pw, pp = 0.0, 0.0, 0.0
            for i in range(d):
                w[i] /= height
                pu += points[p, i] * u[i]
                pw += points[p, i] * w[i]
                pp += points[p, i] * points[p, i]
            slot = 0
            for i in range(d):
                for j in range(i, d):
                    quadrics[vertex, slot] -= u[i] * u[j] + w[i] * w[j]
                    if i == j:
                        quadrics[vertex, slot] += 1.0
                    slot += 1
            for i in range(d):
                quadrics[vertex, slot] += pu * u[i] + pw * w[i] - points[p, i]
                slot += 1
            quadrics[vertex, slot] += pp - pu * pu - pw * pw


# quadric (size,) float64, point (d,) float64 -> the summed squared distance
@njit
def evaluate(quadric, point):
    d = point.shape[0]
    slot = 0
    total = 0.0
    for i in range(d):
        total += quadric[slot] * point[i] * point[i]
        slot += 1
        for j in range(i + 1, d):
            total += 2.0 * quadric[slot] * point[i] * point[j]
            slot += 1
    for i in range(d):
        total += 2.0 * quadric[slot] * point[i]
        slot += 1
    return total + quadric[slot]


# How large the terms were that the quadric was summed from: the trace counts its planes (each gives
# d - 2), and points are normalised, so that their coordinates are at most about 1
@njit
def magnitude(quadric, point):
    d = point.shape[0]
    slot = 0
    trace, squared = 0.0, 0.0
    for i in range(d):
        trace += quadric[slot]
        squared += point[i] * point[i]
        slot += d - i
    return trace * (1.0 + squared)


# Eq. 36; cost (n,) float64, filled: on a lattice of powers of two above what rounding leaves, so
# that costs which are equal in exact arithmetic are equal
@kernel
def ring_costs(start, stop, points, quadrics, indptr, ring, ring_size, cost):
    total = np.empty(quadrics.shape[1])
    for vertex in range(start, stop):
        total[:] = 0.0
        base = indptr[vertex] + vertex
        for k in range(ring_size[vertex]):
            neighbour = ring[base + k]
            for i in range(quadrics.shape[1]):
                total[i] += quadrics[neighbour, i]
        exact = max(evaluate(total, points[vertex]), 0.0)
        step = ROUNDING * magnitude(total, points[vertex])
        cost[vertex] = on_lattice(exact, step)


# What the cheapest collapse of each vertex costs: v^T Q(a) v, the least over its neighbours a, on
# the same lattice; 0 without a ring. cost (n,) float64, filled
@kernel
def target_costs(start, stop, points, quadrics, indptr, ring, ring_size, cost):
    for vertex in range(start, stop):
        base = indptr[vertex] + vertex
        point = points[vertex]
        least = 0.0
        for k in range(ring_size[vertex]):
            quadric = quadrics[ring[base + k]]
            exact = max(evaluate(quadric, point), 0.0)
            here = on_lattice(exact, ROUNDING * magnitude(quadric, point))
            if k == 0 or here < least:
                least = here
        cost[vertex] = least


# Eqs. 52-53: quadrics (n, size) float64, changed; odd (n_odd,) int32; columns are even positions
@kernel
def spread_quadrics(odd, even, row_indptr, columns, weights, quadrics):
    for row in range(odd.shape[0]):
        total = 0.0
        for k in range(row_indptr[row], row_indptr[row + 1]):
            total += max(weights[k], 0.0)
        n_columns = row_indptr[row + 1] - row_indptr[row]
        for k in range(row_indptr[row], row_indptr[row + 1]):
            share = max(weights[k], 0.0) / total if total > 0.0 else 1.0 / n_columns
            for i in range(quadrics.shape[1]):
                quadrics[even[columns[k]], i] += share * quadrics[odd[row], i]
