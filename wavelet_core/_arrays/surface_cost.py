"""The cheapest collapse of each vertex, on whole arrays; see the kernels of the same name.

Vertices are taken by the size of their rings, so that the rings of a block are one dense array and
a loop over a ring is a loop over its columns.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._kernels.surface_cost import (
    COLLINEAR_TOLERANCE,
    FLATNESS_TOLERANCE,
    LEAST_SQUARES,
    NONE,
    TIE_SHARE,
)
from ._csr import blocks, expanded, summed
from .half_edges import after, before, rings_of

#: Points of stars that are looked at together: a bound on the memory.
POINTS_AT_ONCE = 1 << 19


class Block(NamedTuple):
    """Vertices whose rings are of one size and kind, and the points of their stars."""

    v: np.ndarray
    ring: np.ndarray
    spoke: np.ndarray
    is_outline: bool
    rx: np.ndarray
    ry: np.ndarray
    rz: np.ndarray
    row: np.ndarray
    px: np.ndarray
    py: np.ndarray
    pz: np.ndarray


def collapse_costs(
    start, stop, todo, mesh, surface, points, stays, locked, squared, moments, integrals, norm,
    tolerance, cutoff, cost, target, is_stale, is_new,
):  # fmt: skip
    with_update = len(moments.weight) > 0
    known = np.where(with_update & ~is_new[todo], target[todo], -1)
    is_stale[todo], is_new[todo] = False, False
    cost[todo], target[todo] = np.inf, -1
    free = ~stays[todo]
    v, known = todo[free], known[free]
    rings = rings_of(v, mesh)
    has_ring = rings.ring >= 0
    may_go = (rings.size >= 3) & ~(locked[rings.ring] | ~has_ring).all(axis=1)
    n_points = np.where(rings.spoke >= 0, points.n_points[np.maximum(rings.spoke, 0) // 3], 0).sum(
        axis=1
    )
    kind = 2 * rings.size + (rings.n_sides < rings.size)
    for which in np.unique(kind[may_go]):
        rows = np.flatnonzero(may_go & (kind == which))
        size, n_sides = int(which) // 2, int(which) // 2 - int(which) % 2
        for part in blocks(n_points[rows] + size, POINTS_AT_ONCE):
            chosen = rows[part]
            _costs_of_block(
                v[chosen], rings.ring[chosen, :size], rings.spoke[chosen, :n_sides], known[chosen],
                surface, points, squared, moments, integrals, locked, norm, tolerance, cutoff,
                cost, target, is_stale, is_new,
            )  # fmt: skip


def _costs_of_block(
    v, ring, spoke, known, surface, points, squared, moments, integrals, locked, norm, tolerance,
    cutoff, cost, target, is_stale, is_new,
):  # fmt: skip
    is_outline = spoke.shape[1] < ring.shape[1]
    rx, ry = surface.x[ring] - surface.x[v][:, None], surface.y[ring] - surface.y[v][:, None]
    if is_outline:
        straight = _is_straight(rx[:, 0], ry[:, 0], rx[:, -1], ry[:, -1])
        v, ring, spoke, known = v[straight], ring[straight], spoke[straight], known[straight]
        rx, ry = rx[straight], ry[straight]
    if len(v) == 0:
        return
    block = _gather(v, ring, spoke, is_outline, rx, ry, surface, points)
    before_it = np.zeros(len(v))
    for k in range(spoke.shape[1]):
        before_it += squared[spoke[:, k] // 3]
    for i in range(surface.z.shape[1]):
        before_it += (surface.z[v, i] - surface.measured[v, i]) ** 2
    by_sum = norm == LEAST_SQUARES
    with_update = len(moments.weight) > 0

    cover, own, order, n_legal = _legal_targets(block, known, surface.measured, tolerance)
    best = cutoff + before_it if by_sum else np.full(len(v), cutoff)
    is_cut = own[np.arange(len(v)), order[:, 0]] >= best
    chosen = np.where((known >= 0) & (n_legal > 0), order[:, 0], -1)
    asked = np.flatnonzero((known < 0) & (n_legal > 0))
    for k in range(int(n_legal[asked].max(initial=0))):
        asked = asked[k < n_legal[asked]]
        candidate = order[asked, k]
        promising = own[asked, candidate] < best[asked]
        asked, candidate = asked[promising], candidate[promising]
        if len(asked) == 0:
            break
        here = own[asked, candidate]
        total, largest, largest_z = _fan_errors(block, asked, candidate, block.rz, here)
        if not by_sum:
            total = largest * (1.0 + TIE_SHARE * (1.0 - largest / np.maximum(total, 1e-300)))
        is_over = total >= best[asked]
        is_cut[asked[is_over]] = True
        is_better = ~is_over & (largest_z <= tolerance)
        best[asked[is_better]], chosen[asked[is_better]] = total[is_better], candidate[is_better]
    found = chosen >= 0
    only_bound = ~found & (known < 0) & (n_legal > 0) & is_cut & (cutoff < np.inf)
    cost[v[only_bound]] = cutoff
    is_stale[v[only_bound]], is_new[v[only_bound]] = True, True
    rows = np.flatnonzero(found)
    if len(rows) == 0:
        return
    target[v[rows]] = ring[rows, chosen[rows]]
    if not (by_sum and with_update):
        cost[v[rows]] = best[rows] - before_it[rows] if by_sum else best[rows]
        return
    here = _updated_errors(
        block, rows, chosen[rows], cover, before_it, surface, moments, integrals, locked
    )
    cost[v[rows]] = np.minimum(here, cutoff)
    is_stale[v[rows]] = here > cutoff


def _gather(v, ring, spoke, is_outline, rx, ry, surface, points):
    faces = spoke // 3
    row, place = expanded(points.start[faces].ravel(), points.n_points[faces].ravel())
    row //= spoke.shape[1]
    return Block(
        v, ring, spoke, is_outline, rx, ry, surface.z[ring], row,
        points.x[place] - surface.x[v][row], points.y[place] - surface.y[v][row], points.z[place],
    )  # fmt: skip


def _legal_targets(block, known, measured, tolerance):
    """Cover and own error of each legal target, and the targets in the order of these errors."""
    n, size = block.ring.shape
    reach = block.rx**2 + block.ry**2
    # on the outline only its two neighbours are targets
    targets = np.array([0, size - 1]) if block.is_outline else np.arange(size)
    b, at_b, at_c = _covers_from(targets, block, 4.0 * reach.max(axis=1))
    legal = b != NONE
    legal &= (known[:, None] < 0) | (block.ring[:, targets] == known[:, None])
    b = np.where(legal, b, 0)
    c = np.where(b + 1 < size, b + 1, 0)
    each = np.arange(n)[:, None]
    here = np.zeros(b.shape)
    for i in range(block.rz.shape[2]):
        z = block.rz[:, :, i]
        at_j = z[:, targets]
        error = (at_j + at_b * (z[each, b] - at_j) + at_c * (z[each, c] - at_j)) - measured[
            block.v, i, None
        ]
        here += error * error
        if i == 0:
            legal &= here <= tolerance
    own, cover = np.full((n, size), np.inf), np.full((n, size), NONE)
    own[:, targets] = np.where(legal, here, np.inf)
    cover[:, targets] = np.where(legal, b, NONE)
    weights_b, weights_c = np.zeros((n, size)), np.zeros((n, size))
    weights_b[:, targets], weights_c[:, targets] = at_b, at_c
    order = np.lexsort((reach, own), axis=1)
    return (cover, weights_b, weights_c), own, order, legal.sum(axis=1)


def _covers_from(targets, block, diameter):
    """Corner before the face that would hold v, and v's weights, for the fan around each target."""
    rx, ry, size = block.rx, block.ry, block.rx.shape[1]
    ax, ay = rx[:, targets], ry[:, targets]
    k = (targets + 1) % size
    kx, ky = rx[:, k], ry[:, k]
    previous = ax * ky - ay * kx
    is_legal = np.ones(ax.shape, dtype=bool)
    found, at_b, at_c = np.full(ax.shape, NONE), np.zeros(ax.shape), np.zeros(ax.shape)
    thinnest = FLATNESS_TOLERANCE * diameter[:, None]
    for t in range(size - 2):
        following = (k + 1) % size
        fx, fy = rx[:, following], ry[:, following]
        behind = ax * fy - ay * fx
        area = kx * fy - ky * fx + previous - behind
        thin = np.nonzero(area <= thinnest)
        if len(thin[0]):
            sides = (ax[thin], ay[thin], kx[thin], ky[thin], fx[thin], fy[thin])
            is_legal[thin] &= ~_is_flat(*sides, area[thin])
        if block.is_outline:
            begins, ends = (previous >= 0.0) | (t == 0), (behind <= 0.0) | (t == size - 3)
        else:
            begins, ends = previous >= 0.0, behind <= 0.0
        hit = np.nonzero(begins & ends & (found == NONE) & is_legal)
        found[hit] = k[hit[1]]
        at_b[hit] = np.maximum(-behind[hit], 0.0) / area[hit]
        at_c[hit] = np.maximum(previous[hit], 0.0) / area[hit]
        k, kx, ky, previous = following, fx, fy, behind
    return np.where(is_legal, found, NONE), at_b, at_c


def _is_flat(ax, ay, bx, by, cx, cy, area):
    longest = np.maximum(
        (bx - ax) ** 2 + (by - ay) ** 2,
        np.maximum((cx - bx) ** 2 + (cy - by) ** 2, (ax - cx) ** 2 + (ay - cy) ** 2),
    )
    return area <= FLATNESS_TOLERANCE * longest


def _fan_errors(block, rows, centre, rz, start):
    """Sum, largest, and largest of z, of the squared errors under the fan around ``centre``."""
    n, size = len(rows), block.ring.shape[1]
    columns = (centre[:, None] + 1 + np.arange(size - 1)) % size
    each = rows[:, None]
    ax, ay = block.rx[rows, centre], block.ry[rows, centre]
    fan_x, fan_y = block.rx[each, columns] - ax[:, None], block.ry[each, columns] - ay[:, None]
    bx, by, cx, cy = fan_x[:, :-1], fan_y[:, :-1], fan_x[:, 1:], fan_y[:, 1:]
    per_area = 1.0 / (bx * cy - by * cx)
    is_wide = (fan_x[:, :1] * cy - fan_y[:, :1] * cx <= 0.0).any(axis=1)
    z_a = rz[rows, centre]

    position = np.full(len(block.v), -1)
    position[rows] = np.arange(n)
    own_row = position[block.row]
    inside = np.flatnonzero(own_row >= 0)
    row = own_row[inside]
    x, y = block.px[inside] - ax[row], block.py[inside] - ay[row]
    wedge = _wedges(size - 2, row, is_wide, fan_x, fan_y, x, y)
    here = np.zeros(len(row))
    here_z = here
    for i in range(rz.shape[2]):
        to_b = (rz[each, columns[:, :-1], i] - z_a[:, i, None]) * per_area
        to_c = (rz[each, columns[:, 1:], i] - z_a[:, i, None]) * per_area
        slope_x, slope_y = to_b * cy - to_c * by, to_c * bx - to_b * cx
        error = (z_a[row, i] + slope_x[row, wedge] * x + slope_y[row, wedge] * y) - block.pz[
            inside, i
        ]
        here = here + error * error
        if i == 0:
            here_z = here
    largest, largest_z = start.copy(), np.zeros(n)
    if len(row):
        first = np.flatnonzero(np.diff(row, prepend=-1))
        largest[row[first]] = np.maximum(start[row[first]], np.maximum.reduceat(here, first))
        largest_z[row[first]] = np.maximum.reduceat(here_z, first)
    return summed(row, here, start), largest, largest_z


def _wedges(n_wedges, row, is_wide, fan_x, fan_y, x, y):
    wedge = np.zeros(len(row), dtype=np.int64)
    for t in range(1, n_wedges):
        wedge += fan_x[row, t] * y - fan_y[row, t] * x > 0.0
    wide = np.flatnonzero(is_wide[row])
    if len(wide):
        of, x, y = row[wide], x[wide], y[wide]
        found = np.full(len(wide), -1)
        for t in range(n_wedges):
            holds = fan_x[of, t] * y - fan_y[of, t] * x >= 0.0
            holds &= fan_x[of, t + 1] * y - fan_y[of, t + 1] * x <= 0.0
            found = np.where((found < 0) & holds, t, found)
        wedge[wide] = np.where(found < 0, wedge[wide], found)
    return wedge


def _updated_errors(block, rows, j, cover, before_it, surface, moments, integrals, locked):
    """Errors of the star, less those of before, once the update has shared the detail out."""
    size, n_sides = block.ring.shape[1], block.spoke.shape[1]
    b, at_b, at_c = (of[rows, j] for of in cover)
    c = (b + 1) % size
    v = block.v[rows]
    at_a = 1.0 - at_b - at_c
    corners = [(k, block.ring[rows, k]) for k in (j, b, c)]
    shares = [
        np.where(locked[u], 0.0, integrals[u] + at * integrals[v])
        for (_, u), at in zip(corners, (at_a, at_b, at_c), strict=True)
    ]
    norm_squared = shares[0] ** 2 + shares[1] ** 2 + shares[2] ** 2
    factor = np.divide(integrals[v], norm_squared, out=np.zeros(len(v)), where=norm_squared > 0.0)
    own_share = factor * (at_a * shares[0] + at_b * shares[1] + at_c * shares[2])
    here = -before_it[rows]
    rz = block.rz.copy()
    detail = np.empty((len(v), rz.shape[2]))
    for i in range(rz.shape[2]):
        fit = at_a * rz[rows, j, i] + at_b * rz[rows, b, i] + at_c * rz[rows, c, i]
        detail[:, i] = surface.z[v, i] - fit
        here += (fit + own_share * detail[:, i] - surface.measured[v, i]) ** 2
    for (corner, u), share in zip(corners, shares, strict=True):
        last = (corner - 1) % size
        has_following, has_preceding = corner < n_sides, last < n_sides
        following = after(block.spoke[rows, np.minimum(corner, n_sides - 1)])
        preceding = before(block.spoke[rows, np.minimum(last, n_sides - 1)])
        stiffness = moments.vertex_weight[u]
        stiffness = stiffness - np.where(has_following, moments.weight[following], np.float32(0))
        stiffness = stiffness - np.where(has_preceding, moments.weight[preceding], np.float32(0))
        for i in range(rz.shape[2]):
            rate = moments.vertex_slope[u, i]
            rate = rate - np.where(has_following, moments.slope[following, i], np.float32(0))
            rate = rate - np.where(has_preceding, moments.slope[preceding, i], np.float32(0))
            shift = factor * share * detail[:, i]
            here += (2.0 * rate + stiffness * shift) * shift
            rz[rows, corner, i] += shift
    return _fan_errors(block, rows, j, rz, here)[0]


def _is_straight(px, py, qx, qy):
    dx, dy = qx - px, qy - py
    near = np.abs(px * qy - py * qx) <= COLLINEAR_TOLERANCE * (dx * dx + dy * dy)
    return near & (px * qx + py * qy < 0.0)
