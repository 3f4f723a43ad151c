"""Joined points, and the faces of edges; see :mod:`wavelet_core._kernels.point_faces`."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .._kernels.point_faces import CLEAR, NOT_ASKED, TIED
from ..progress import report_share
from ._csr import expanded

#: Points that are looked at together: a bound on the memory, and on the time without a word.
POINTS_AT_ONCE = 1 << 14


def _blocks(start: int, stop: int) -> Iterator[slice]:
    """Yield slices of points that are looked at together, and report how far they are."""
    for first in range(start, stop, POINTS_AT_ONCE):
        report_share((first - start) / (stop - start))
        yield slice(first, min(first + POINTS_AT_ONCE, stop))


def order_nearest(start, stop, points, found, x, y, nearest, reach):
    squared = (x[found] - x[points][:, None]) ** 2 + (y[found] - y[points][:, None]) ** 2
    order = np.lexsort((found, squared), axis=1)
    reach[points] = np.take_along_axis(squared, order[:, -1:], axis=1)[:, 0]
    nearest[points] = np.take_along_axis(found, order, axis=1)[:, 1:-1]


def classify_pairs(start, stop, x, y, nearest, reach, classes):
    for here in _blocks(start, stop):
        others = nearest[here]
        offset_x, offset_y = x[others] - x[here][:, None], y[others] - y[here][:, None]
        squared = offset_x**2 + offset_y**2
        is_known = squared < reach[here][:, None]
        ids = np.arange(here.start, here.stop)[:, None]
        asked = is_known & ((ids < others) | (squared >= reach[others]))
        classes[here] = NOT_ASKED
        for k in range(others.shape[1]):
            rows = np.flatnonzero(asked[:, k])
            near = (offset_x[rows], offset_y[rows], squared[rows], is_known[rows])
            classes[here.start + rows, k] = _classes(k, *near)


def _classes(k, x, y, squared, is_known):
    """Return how clear it is that points are joined to the k-th of their nearest."""
    cross = x[:, k, None] * y - y[:, k, None] * x
    inner = squared - (x[:, k, None] * x + y[:, k, None] * y)
    with np.errstate(divide="ignore", invalid="ignore"):
        cotangent = np.where(is_known, inner / np.abs(cross), np.inf)
    left = np.where(cross > 0, cotangent, np.inf).min(axis=1)
    right = np.where(cross < 0, cotangent, np.inf).min(axis=1)
    is_between = (is_known & (cross == 0) & (inner < 0)).any(axis=1)
    total = left + right
    return np.select(
        [is_between, np.isinf(total), total < -CLEAR, total < -TIED, total <= TIED,
         total <= CLEAR],
        [0, 1, 2, 3, 4, 5], 7 if k >= x.shape[1] // 2 else 6,
    )  # fmt: skip


def group_pairs(pairs, indptr, others):
    low, high = pairs.min(axis=1), pairs.max(axis=1)
    indptr[1:] = np.cumsum(np.bincount(low, minlength=len(indptr) - 1))
    others[:] = high[np.argsort(low, kind="stable")]


def sort_groups(start, stop, indptr, others, is_new):
    for here in _blocks(start, stop):
        pairs = slice(indptr[here.start], indptr[here.stop])
        low = np.repeat(
            np.arange(here.start, here.stop), np.diff(indptr[here.start : here.stop + 1])
        )
        high = others[pairs][np.lexsort((others[pairs], low))]
        others[pairs] = high
        is_new[pairs] = True
        is_new[pairs][1:] = (low[1:] != low[:-1]) | (high[1:] != high[:-1])


def look_up_pairs(start, stop, nearest, classes, indptr, heads, joined, is_asked):
    n = len(indptr) - 1
    keys = np.repeat(np.arange(n), np.diff(indptr)) * n + heads
    joined[start:stop] = 0
    if not len(keys):
        return
    for here in _blocks(start, stop):
        v, k = np.nonzero(classes[here] != NOT_ASKED)
        v += here.start
        u = nearest[v, k].astype(np.int64)
        asked = np.minimum(v, u) * n + np.maximum(v, u)
        place = np.minimum(np.searchsorted(keys, asked), len(keys) - 1)
        is_edge = keys[place] == asked
        joined[v, k] = is_edge
        is_asked[place[is_edge]] = True


def gather_spokes(edges, indptr, heads, edge_of):
    tail = np.concatenate([edges[:, 0], edges[:, 1]])
    order = np.argsort(tail, kind="stable")
    indptr[1:] = np.cumsum(np.bincount(tail, minlength=len(indptr) - 1))
    heads[:] = np.concatenate([edges[:, 1], edges[:, 0]])[order]
    twice = 2 * np.arange(len(edges))
    edge_of[:] = np.concatenate([twice, twice + 1])[order]


def turn_spokes(start, stop, x, y, indptr, heads, edge_of, place):
    for here in _blocks(start, stop):
        spokes = slice(indptr[here.start], indptr[here.stop])
        tail = np.repeat(
            np.arange(here.start, here.stop), np.diff(indptr[here.start : here.stop + 1])
        )
        across, up = x[heads[spokes]] - x[tail], y[heads[spokes]] - y[tail]
        span = np.abs(across) + np.abs(up)
        turn = np.divide(up, span, out=np.zeros(len(up)), where=span > 0)
        turn = np.where(across >= 0, turn, 2.0 - turn)
        order = spokes.start + np.lexsort((turn, tail))
        heads[spokes], edge_of[spokes] = heads[order], edge_of[order]
        place[edge_of[spokes]] = np.arange(spokes.start, spokes.stop)


def count_triangles(start, stop, x, y, indptr, heads, edge_of, place, n_triangles):
    begins, _ = _triangles(x, y, indptr, heads, edge_of, place)
    tail = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    n_triangles[:] = np.bincount(tail[begins], minlength=len(n_triangles))


def fill_triangles(start, stop, x, y, indptr, heads, edge_of, place, first, triangles):
    begins, after = _triangles(x, y, indptr, heads, edge_of, place)
    tail = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    found = np.column_stack([tail[begins], heads[begins], heads[after[begins]]])
    triangles[:] = found[np.lexsort((found[:, 1], found[:, 0]))]


def _triangles(x, y, indptr, heads, edge_of, place):
    """Return of each spoke whether a triangle begins there, and the one that follows it."""
    counts = np.diff(indptr)
    tail, at = expanded(indptr[:-1], counts)
    after = np.where(at + 1 < indptr[tail + 1], at + 1, indptr[tail])
    before = np.where(at > indptr[tail], at - 1, indptr[tail + 1] - 1)
    across, up = x[heads] - x[tail], y[heads] - y[tail]
    is_convex = across * up[after] - up * across[after] > 0.0
    b, c = heads, heads[after]
    begins = is_convex & (b > tail) & (c > tail)
    at_b = before[place[edge_of ^ 1]]  # from b, the one before that to the tail, to c
    at_c = place[edge_of[after] ^ 1]  # from c to the tail; the one after it, to b
    begins &= (heads[at_b] == c) & is_convex[at_b]
    begins &= (heads[after[at_c]] == b) & is_convex[at_c]
    return begins, after
