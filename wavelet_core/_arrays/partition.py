"""The greedy labelling of Algorithm 2 in rounds; see :mod:`wavelet_core._kernels.partition`.

Whether a vertex goes depends on those before it in the order, and of these only on vertices at most
two edges away. A vertex that comes before all undecided ones so near can be decided, and all such
vertices of a round at once: no two of them see each other. The outcome is that of the single pass.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._kernels.connectivity import BOUNDARY, INTERIOR
from .._kernels.outline import COLLINEAR_TOLERANCE, FLATNESS_TOLERANCE
from .._kernels.partition import EVEN, ODD, ROUNDING
from ..progress import report_share
from ._csr import expanded
from ._rings import by_size, rings
from .quadric import evaluate

#: Candidates that are looked at together: a bound on the memory.
AT_ONCE = 20_000
#: Share of the time that their targets take, for the progress.
OF_CHOICES = 0.7


class Choices(NamedTuple):
    """Targets of the candidates, entry for entry of their rings, best first.

    vertex : (n,) candidates, in the order in which they are decided
    first : (n + 1,) where the entries of each begin
    place, is_legal : (entries,) place in the ring; whether nothing of the level forbids it
    """

    vertex: np.ndarray
    first: np.ndarray
    place: np.ndarray
    is_legal: np.ndarray


def label(
    order, max_odd, in_plan, points, plan, faces, indptr, star, ring, ring_size, kind, locked,
    quadrics, mark, odd, target,
):  # fmt: skip
    n = len(points)
    shape = plan if in_plan else points
    rank = np.full(n, n, dtype=np.int64)
    rank[order] = np.arange(len(order))
    candidates = _removable(order, in_plan, shape, indptr, ring, ring_size, kind, locked)
    choices = _choices(
        candidates, in_plan, shape, points, faces, indptr, ring, ring_size, kind, quadrics
    )
    n_faces_of = np.diff(indptr)
    mark[order] = EVEN
    made = np.empty(0, dtype=np.int64)
    chosen_vertex, chosen_target = [], []
    open_rows = np.arange(len(candidates))
    is_open = np.zeros(n, dtype=bool)
    is_open[candidates] = True
    while len(open_rows):
        report_share(1.0 - (1.0 - OF_CHOICES) * len(open_rows) / len(candidates))
        open_rows = open_rows[is_open[candidates[open_rows]]]
        if len(open_rows) == 0:
            break
        winners = open_rows[_come_first(candidates[open_rows], rank, indptr, ring, ring_size)]
        v = candidates[winners]
        is_open[v] = False
        place = _best_places(winners, choices, v, indptr, ring, ring_size, kind, n_faces_of, made)
        goes = place >= 0
        v, place = v[goes], place[goes]
        if len(v) == 0:
            continue
        made = _collapse(v, place, indptr, ring, ring_size, kind, n_faces_of, is_open, made)
        chosen_vertex.append(v)
        chosen_target.append(ring[indptr[v] + v + place])
    if not chosen_vertex:
        return 0
    vertex, onto = np.concatenate(chosen_vertex), np.concatenate(chosen_target)
    in_order = np.argsort(rank[vertex], kind="stable")[:max_odd]
    n_odd = len(in_order)
    odd[:n_odd], target[:n_odd] = vertex[in_order], onto[in_order]
    mark[odd[:n_odd]] = ODD
    return n_odd


def _removable(order, in_plan, shape, indptr, ring, ring_size, kind, locked):
    """Those that may go onto some target, in their order, and have whom to share with."""
    on_outline = (kind[order] == BOUNDARY) & (ring_size[order] >= 3)
    v = order[on_outline]
    if in_plan and len(v):
        base = indptr[v] + v
        p, q = ring[base], ring[base + ring_size[v] - 1]
        px, py = shape[p, 0] - shape[v, 0], shape[p, 1] - shape[v, 1]
        qx, qy = shape[q, 0] - shape[v, 0], shape[q, 1] - shape[v, 1]
        dx, dy = qx - px, qy - py
        chord = dx * dx + dy * dy
        straight = np.abs(px * qy - py * qx) <= COLLINEAR_TOLERANCE * chord
        on_outline[on_outline] = straight & (px * qx + py * qy < 0.0)
    may_go = ~locked[order] & ((kind[order] == INTERIOR) | on_outline)
    v = order[may_go]
    row, place = expanded(indptr[v] + v, ring_size[v])
    n_free = np.bincount(row[~locked[ring[place]]], minlength=len(v))
    return v[n_free > 0]


def _choices(candidates, in_plan, shape, points, faces, indptr, ring, ring_size, kind, quadrics):
    sizes = ring_size[candidates]
    first = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    places = np.empty(first[-1], dtype=np.int32)
    legal = np.empty(first[-1], dtype=bool)
    edges = _edges(faces, len(points))
    n_done = 0
    for size, rows in _blocks(sizes):
        report_share(OF_CHOICES * n_done / len(candidates))
        n_done += len(rows)
        v = candidates[rows]
        around = rings(v, size, indptr, ring)
        error = np.zeros(around.shape)
        for k in range(size):
            neighbour = around[:, k]
            if len(quadrics):
                here = evaluate(quadrics[neighbour], points[v])
                error[:, k] = np.where(here < ROUNDING, 0.0, here)
            else:
                for i in range(points.shape[1]):
                    error[:, k] += (points[neighbour, i] - points[v, i]) ** 2
        is_outline = kind[v] == BOUNDARY
        is_legal = np.empty(around.shape, dtype=bool)
        for k in range(size):
            is_legal[:, k] = _is_legal(k, v, around, is_outline, in_plan, shape, edges, len(points))
        best_first = np.lexsort((around, error), axis=1)
        into = first[rows][:, None] + np.arange(size)
        places[into] = best_first
        legal[into] = np.take_along_axis(is_legal, best_first, axis=1)
    return Choices(candidates, first, places, legal)


def _blocks(sizes):
    for size, rows in by_size(sizes):
        for start in range(0, len(rows), AT_ONCE):
            yield size, rows[start : start + AT_ONCE]


def _edges(faces, n):
    """Return the sorted keys of the edges, those of two faces twice."""
    a, b, c = faces.T
    keys = np.concatenate([_keys(a, b, n), _keys(b, c, n), _keys(c, a, n)])
    keys.sort()
    return keys


def _keys(a, b, n):
    return np.minimum(a, b).astype(np.int64) * n + np.maximum(a, b)


def _contains(sorted_keys, keys):
    if len(sorted_keys) == 0:
        return np.zeros(keys.shape, dtype=bool)
    place = np.minimum(np.searchsorted(sorted_keys, keys), len(sorted_keys) - 1)
    return sorted_keys[place] == keys


def _is_beside(k, other, size, is_outline):
    """Return whether a ring entry is the one before or after another."""
    if abs(k - other) == 1:
        return np.ones(len(is_outline), dtype=bool)
    return ~is_outline if abs(k - other) == size - 1 else np.zeros(len(is_outline), dtype=bool)


def _is_legal(position, v, around, is_outline, in_plan, shape, edges, n):
    """Return whether the level alone allows the collapse onto a ring entry (Fig. 3)."""
    size = around.shape[1]
    target = around[:, position]
    legal = ~is_outline | (position in (0, size - 1))
    for k in range(size):
        following = (k + 1) % size
        if k == position or following == position:
            continue
        is_side = ~is_outline | (k < size - 1)
        b, c = around[:, k], around[:, following]
        sound = (
            _is_upright(shape, target, b, c) if in_plan else _keeps_normal(shape, v, target, b, c)
        )
        legal &= ~is_side | sound
    for k in range(size):
        if k == position:
            continue
        far = np.flatnonzero(legal & ~_is_beside(k, position, size, is_outline))
        legal[far[_contains(edges, _keys(target[far], around[far, k], n))]] = False
    return legal


def _is_upright(points, a, b, c):
    abx, aby = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    acx, acy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    bcx, bcy = acx - abx, acy - aby
    longest = np.maximum(
        np.maximum(abx * abx + aby * aby, acx * acx + acy * acy), bcx * bcx + bcy * bcy
    )
    return abx * acy - aby * acx > FLATNESS_TOLERANCE * longest


def _keeps_normal(points, v, a, b, c):
    bcx, bcy, bcz = (points[c, i] - points[b, i] for i in range(3))
    vx, vy, vz = (points[b, i] - points[v, i] for i in range(3))
    ax, ay, az = (points[b, i] - points[a, i] for i in range(3))
    ox, oy, oz = vy * bcz - vz * bcy, vz * bcx - vx * bcz, vx * bcy - vy * bcx
    nx, ny, nz = ay * bcz - az * bcy, az * bcx - ax * bcz, ax * bcy - ay * bcx
    longest = np.maximum(bcx * bcx + bcy * bcy + bcz * bcz, ax * ax + ay * ay + az * az)
    has_area = nx * nx + ny * ny + nz * nz > (FLATNESS_TOLERANCE * longest) ** 2
    return has_area & (ox * nx + oy * ny + oz * nz > 0.0)


def _come_first(v, rank, indptr, ring, ring_size):
    """Return which undecided vertices, in order, come before all others within two edges."""
    row, place = expanded(indptr[v] + v, ring_size[v])
    sizes = ring_size[v].astype(np.int64) + 1
    starts = np.cumsum(sizes) - sizes
    reach = np.empty(int(sizes.sum()), dtype=np.int64)
    reach[starts] = v
    reach[starts[row] + 1 + place - (indptr[v] + v)[row]] = ring[place]
    ranks = rank[v]
    lowest = np.full(len(rank), len(rank), dtype=np.int64)
    lowest[reach[::-1]] = np.repeat(ranks, sizes)[::-1]  # the first in order is written last
    return np.minimum.reduceat(lowest[reach], starts) == ranks


def _best_places(rows, choices, v, indptr, ring, ring_size, kind, n_faces_of, made):
    """Place, in the ring, of the best legal target now; -1 where none is."""
    found = np.full(len(rows), -1, dtype=np.int64)
    n = len(n_faces_of)
    left = np.arange(len(rows))
    k = 0
    while True:
        left = left[choices.first[rows[left]] + k < choices.first[rows[left] + 1]]
        if len(left) == 0:
            return found
        entry = choices.first[rows[left]] + k
        asked = left[choices.is_legal[entry]]
        place = choices.place[entry[choices.is_legal[entry]]]
        legal = _is_legal_now(v[asked], place, indptr, ring, ring_size, kind, n_faces_of, made, n)
        found[asked[legal]] = place[legal]
        left = left[found[left] < 0]
        k += 1


def _is_legal_now(v, place, indptr, ring, ring_size, kind, n_faces_of, made, n):
    """Return whether the collapses made earlier in the pass allow it."""
    base, size = indptr[v] + v, ring_size[v].astype(np.int64)
    is_outline = kind[v] == BOUNDARY
    target = ring[base + place]
    following, preceding = ring[base + (place + 1) % size], ring[base + (place - 1) % size]
    legal = (is_outline & (place == size - 1)) | ~_is_worn(
        following, n_faces_of[following] - 1, kind
    )
    legal &= (is_outline & (place == 0)) | ~_is_worn(preceding, n_faces_of[preceding] - 1, kind)
    n_sides = np.where(is_outline, size - 1, size)
    n_shared = np.where(is_outline, 1, 2)
    legal &= ~_is_worn(target, n_faces_of[target] + n_sides - 2 * n_shared, kind)
    if len(made):
        row, entry = expanded(base, size)
        distance = np.abs(entry - base[row] - place[row])
        beside = (distance == 1) | (~is_outline[row] & (distance == size[row] - 1))
        far = ~beside & (distance > 0)
        row, entry = row[far], entry[far]
        joined = _contains(made, _keys(target[row], ring[entry], n))
        legal[row[joined]] = False
    return legal


def _is_worn(v, n_left, kind):
    return n_left < np.where(kind[v] == INTERIOR, 3, 1)


def _collapse(v, place, indptr, ring, ring_size, kind, n_faces_of, is_open, made):
    """Count faces and edges anew, rule the rings out; return the edges made so far."""
    base, size = indptr[v] + v, ring_size[v].astype(np.int64)
    is_outline = kind[v] == BOUNDARY
    row, entry = expanded(base, size)
    is_open[ring[entry]] = False
    distance = np.abs(entry - base[row] - place[row])
    beside = (distance == 1) | (~is_outline[row] & (distance == size[row] - 1))
    n_faces_of[ring[entry[beside]]] -= 1
    lost = np.bincount(row[beside], minlength=len(v))
    target = ring[base + place]
    n_faces_of[target] += np.where(is_outline, size - 1, size) - 2 * lost
    far = ~beside & (distance > 0)
    new = _keys(target[row[far]], ring[entry[far]], len(n_faces_of))
    return np.sort(np.concatenate([made, new]))
