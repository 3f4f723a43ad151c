"""Generalised quadrics on whole arrays; see :mod:`wavelet_core._kernels.quadric`."""

from __future__ import annotations

import numpy as np

from .._kernels.quadric import ROUNDING
from ._csr import summed
from ._rings import by_size, rings
from .lattice import on_lattice


def star_quadrics(start, stop, points, faces, indptr, star, quadrics):
    d = points.shape[1]
    p, q, r = (points[faces[:, k]] for k in range(3))
    u, length = _unit(q - p)
    along = _dot(r - p, u)
    w, height = _unit(r - p - along[:, None] * u)
    sound = (length > 0.0) & (height > 0.0)
    pu, pw, pp = _dot(p, u), _dot(p, w), _dot(p, p)
    vertex = np.repeat(np.arange(len(points)), np.diff(indptr))
    zero = np.zeros(len(points))
    slot = 0

    def add(*parts):
        rows = np.repeat(vertex, len(parts))
        values = np.column_stack([np.where(sound, part, 0.0)[star] for part in parts])
        quadrics[:, slot] = summed(rows, values.ravel(), zero)

    for i in range(d):
        for j in range(i, d):
            minus = -(u[:, i] * u[:, j] + w[:, i] * w[:, j])
            add(minus, np.ones(len(faces))) if i == j else add(minus)
            slot += 1
    for i in range(d):
        add(pu * u[:, i] + pw * w[:, i] - p[:, i])
        slot += 1
    add(pp - pu * pu - pw * pw)


def _dot(a, b):
    total = np.zeros(len(a))
    for i in range(a.shape[1]):
        total += a[:, i] * b[:, i]
    return total


def _unit(vectors):
    squared = _dot(vectors, vectors)
    length = np.sqrt(squared)
    return vectors / np.where(squared > 0.0, length, 1.0)[:, None], squared


def evaluate(quadrics, points):
    """Return the summed squared distance of each point under its own quadric."""
    d = points.shape[1]
    slot = 0
    total = np.zeros(len(points))
    for i in range(d):
        total += quadrics[:, slot] * points[:, i] * points[:, i]
        slot += 1
        for j in range(i + 1, d):
            total += 2.0 * quadrics[:, slot] * points[:, i] * points[:, j]
            slot += 1
    for i in range(d):
        total += 2.0 * quadrics[:, slot] * points[:, i]
        slot += 1
    return total + quadrics[:, slot]


def ring_costs(start, stop, points, quadrics, indptr, ring, ring_size, cost):
    for size, v in by_size(ring_size):
        around = rings(v, size, indptr, ring)
        total = np.zeros((len(v), quadrics.shape[1]))
        for k in range(size):
            total += quadrics[around[:, k]]
        exact = np.maximum(evaluate(total, points[v]), 0.0)
        cost[v] = on_lattice(exact, ROUNDING * _magnitude(total, points[v]))


def target_costs(start, stop, points, quadrics, indptr, ring, ring_size, cost):
    cost[:] = 0.0
    for size, v in by_size(ring_size):
        if size == 0:
            continue
        around = rings(v, size, indptr, ring)
        least = np.full(len(v), np.inf)
        for k in range(size):
            quadric = quadrics[around[:, k]]
            exact = np.maximum(evaluate(quadric, points[v]), 0.0)
            here = on_lattice(exact, ROUNDING * _magnitude(quadric, points[v]))
            least = np.minimum(least, here)
        cost[v] = least


def _magnitude(quadrics, points):
    d = points.shape[1]
    slot = 0
    trace, squared = np.zeros(len(points)), np.zeros(len(points))
    for i in range(d):
        trace += quadrics[:, slot]
        squared += points[:, i] * points[:, i]
        slot += d - i
    return trace * (1.0 + squared)


def spread_quadrics(odd, even, row_indptr, columns, weights, quadrics):
    counts = np.diff(row_indptr)
    row = np.repeat(np.arange(len(odd)), counts)
    positive = np.maximum(weights, 0.0)
    total = summed(row, positive, np.zeros(len(odd)))[row]
    share = np.where(total > 0.0, positive / np.where(total > 0.0, total, 1.0), 1.0 / counts[row])
    into = even[columns]
    for i in range(quadrics.shape[1]):
        quadrics[:, i] = summed(into, share * quadrics[odd, i][row], quadrics[:, i])
