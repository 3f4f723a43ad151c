"""The cheapest collapse of each vertex, on whole arrays; see the kernels of the same name.

Vertices are taken by the size of their rings, so that the rings of a block are one dense array and
a loop over a ring is a loop over its columns.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .._kernels.outline import CUTS, FLATNESS_TOLERANCE, STAYS
from .._kernels.surface_cost import (
    LEAST_SQUARES,
    MOMENT_STEP,
    NONE,
    RELATIVE_STEP,
    TIE_SHARE,
)
from ._csr import blocks, expanded, summed
from .half_edges import after, before, rings_of
from .lattice import on_lattice
from .outline import nearest_on_edge, outline_rules
from .surface_choice import are_linked

#: Points of stars that are looked at together: a bound on the memory.
POINTS_AT_ONCE = 1 << 19


class Level(NamedTuple):
    """What the kernel is given, all of it."""

    mesh: Any
    surface: Any
    points: Any
    moments: Any
    vertices: Any
    squared: np.ndarray
    outline: Any
    limits: Any


class Block(NamedTuple):
    """Vertices whose rings are of one size and kind, and the points of their stars.

    v : (n,) the vertices; ring, spoke : (n, size), (n, n_sides)
    rule, along : (n,) of the outline; NONE inside
    rx, ry, rz : (n, size), (n, size, c) where the rings lie, from v
    row, px, py, pz : (k,) the points, from the vertex that `row` gives
    n_points : (n,) how many each has
    """

    v: np.ndarray
    ring: np.ndarray
    spoke: np.ndarray
    rule: np.ndarray
    along: np.ndarray
    rx: np.ndarray
    ry: np.ndarray
    rz: np.ndarray
    row: np.ndarray
    px: np.ndarray
    py: np.ndarray
    pz: np.ndarray
    n_points: np.ndarray

    @property
    def is_outline(self) -> bool:
        """Whether the vertices lie on an outline."""
        return self.spoke.shape[1] < self.ring.shape[1]


class Targets(NamedTuple):
    """Legal targets: (n, size) arrays by place in the ring, and in `order` the best first."""

    cover: np.ndarray
    at_b: np.ndarray
    at_c: np.ndarray
    own: np.ndarray
    order: np.ndarray
    n_legal: np.ndarray


def collapse_costs(
    start, stop, todo, mesh, surface, points, moments, vertices, squared, outline, limits
):
    level = Level(mesh, surface, points, moments, vertices, squared, outline, limits)
    is_kept = len(moments.weight) > 0 and limits.norm == LEAST_SQUARES
    known = np.where(is_kept & ~vertices.is_new[todo], vertices.target[todo], NONE)
    vertices.is_stale[todo], vertices.is_new[todo] = False, False
    vertices.cost[todo], vertices.target[todo] = np.inf, -1
    free = ~vertices.stays[todo]
    v, known = todo[free], known[free]
    rings = rings_of(v, mesh)
    is_enclosed = (vertices.locked[rings.ring] | (rings.ring < 0)).all(axis=1)
    may_go = (rings.size >= 3) & ~is_enclosed
    of_spokes = np.where(rings.spoke >= 0, points.n_points[np.maximum(rings.spoke, 0) // 3], 0)
    n_points = of_spokes.sum(axis=1)
    kind = 2 * rings.size + (rings.n_sides < rings.size)
    for which in np.unique(kind[may_go]):
        rows = np.flatnonzero(may_go & (kind == which))
        size, n_sides = int(which) // 2, int(which) // 2 - int(which) % 2
        for part in blocks(n_points[rows] + size, POINTS_AT_ONCE):
            chosen = rows[part]
            _rank_block(
                level, v[chosen], rings.ring[chosen, :size], rings.spoke[chosen, :n_sides],
                known[chosen], np.zeros((len(chosen), size), dtype=bool),
            )  # fmt: skip


def _rank_block(level, v, ring, spoke, known, barred):
    """Fill cost and target of a block; those whose best target is no link come once more."""
    while len(v):
        block, kept = _gather(level, v, ring, spoke)
        known, barred = known[kept], barred[kept]
        chosen = _rank(level, block, known, barred)
        unlinked = np.flatnonzero(chosen >= 0)
        at = block.ring[unlinked, chosen[unlinked]]
        linked = are_linked(block.ring[unlinked], at, block.spoke.shape[1], level.mesh)
        unlinked = unlinked[~linked]
        barred[unlinked, chosen[unlinked]] = True
        v, ring, spoke = block.v[unlinked], block.ring[unlinked], block.spoke[unlinked]
        level.vertices.is_stale[v], level.vertices.is_new[v] = False, False
        level.vertices.cost[v], level.vertices.target[v] = np.inf, -1
        known, barred = np.full(len(v), NONE), barred[unlinked]


def _gather(level, v, ring, spoke):
    """Return the block, and which of the vertices the outline lets go at all."""
    surface, points = level.surface, level.points
    rx, ry = surface.x[ring] - surface.x[v][:, None], surface.y[ring] - surface.y[v][:, None]
    rule, along = np.full(len(v), NONE), np.zeros(len(v))
    kept = np.ones(len(v), dtype=bool)
    if spoke.shape[1] < ring.shape[1]:
        rule, along = outline_rules(v, ring, rx, ry, level.outline)
        kept = rule != STAYS
        v, ring, spoke, rule, along = v[kept], ring[kept], spoke[kept], rule[kept], along[kept]
        rx, ry = rx[kept], ry[kept]
    faces = spoke // 3
    counts = points.n_points[faces]
    row, place = expanded(points.start[faces].ravel(), counts.ravel())
    row //= max(spoke.shape[1], 1)
    px, py = points.x[place] - surface.x[v][row], points.y[place] - surface.y[v][row]
    cut = np.flatnonzero(rule[row] == CUTS)
    if len(cut):
        of = row[cut]
        ends = (rx[of, 0], ry[of, 0], rx[of, -1], ry[of, -1])
        px[cut], py[cut], _ = nearest_on_edge(px[cut], py[cut], *ends)
    return Block(
        v, ring, spoke, rule, along, rx, ry, surface.z[ring], row, px, py, points.z[place],
        counts.sum(axis=1),
    ), kept  # fmt: skip


def _rank(level, block, known, barred):
    """Fill cost and target; return the place in the ring of each target, NONE without any."""
    surface, vertices, limits = level.surface, level.vertices, level.limits
    v = block.v
    before_it = np.zeros(len(v))
    for k in range(block.spoke.shape[1]):
        before_it += level.squared[block.spoke[:, k] // 3]
    for i in range(surface.z.shape[1]):
        before_it += (surface.z[v, i] - surface.measured[v, i]) ** 2
    by_sum = limits.norm == LEAST_SQUARES
    targets = legal_targets(block, known, barred, surface.measured, limits)
    bound = limits.cutoff + before_it if by_sum else np.full(len(v), limits.cutoff)
    chosen, best, is_cut = _best_targets(block, targets, known, bound, limits)
    only_bound = (chosen == NONE) & (targets.n_legal > 0) & is_cut & (limits.cutoff < np.inf)
    vertices.cost[v[only_bound]] = limits.cutoff
    vertices.is_stale[v[only_bound]] = vertices.is_new[v[only_bound]] = True
    rows = np.flatnonzero(chosen >= 0)
    j, ids = chosen[rows], v[rows]
    vertices.target[ids] = block.ring[rows, j]
    n = block.n_points[rows] + 1
    best, before_it = best[rows], before_it[rows]
    step = limits.height_step
    if not by_sum:
        vertices.cost[ids] = on_lattice(best, _step_of(1, best, step))
    elif len(level.moments.weight) == 0:
        vertices.cost[ids] = on_lattice(best - before_it, _step_of(n, before_it + best, step))
    elif len(rows):
        change, terms, rz = _update_corners(level, block, rows, j, targets)
        here = _fan_errors(block, rows, j, rz, change - before_it)[0]
        width = _step_of(n, before_it + np.abs(here), step) + MOMENT_STEP * terms
        is_over = here > limits.cutoff  # a lower bound only
        vertices.cost[ids] = np.where(is_over, limits.cutoff, on_lattice(here, width))
        vertices.is_stale[ids] = is_over
    return chosen


def _step_of(n, squared, height_step):
    return height_step * (2.0 * np.sqrt(n * squared) + n * height_step) + RELATIVE_STEP * squared


def legal_targets(block, known, barred, measured, limits):
    n, size = block.ring.shape
    places = np.array([0, size - 1]) if block.is_outline else np.arange(size)
    reach = block.rx**2 + block.ry**2
    b, at_b, at_c = _covers_from(places, block, 4.0 * reach.max(axis=1, initial=0.0))
    legal = (b != NONE) & ~barred[:, places]
    legal &= (known[:, None] == NONE) | (block.ring[:, places] == known[:, None])
    cut = block.rule == CUTS
    if cut.any():  # v is judged on the new edge
        b[cut], at_b[cut], at_c[cut] = [size - 2, 0], 0.0, 0.0
        at_c[cut, 0], at_b[cut, 1] = block.along[cut], 1.0 - block.along[cut]
    b = np.where(legal, b, 0)
    c = np.where(b + 1 < size, b + 1, 0)
    each = np.arange(n)[:, None]
    here = np.zeros(b.shape)
    for i in range(block.rz.shape[2]):
        z = block.rz[:, :, i]
        a_z = z[:, places]
        error = (a_z + at_b * (z[each, b] - a_z) + at_c * (z[each, c] - a_z)) - measured[
            block.v, i, None
        ]
        here += error * error
        if i == 0:
            legal &= here <= limits.tolerance
    own, cover = np.full((n, size), np.inf), np.full((n, size), NONE)
    own[:, places] = np.where(legal, here, np.inf)
    cover[:, places] = np.where(legal, b, NONE)
    weights_b, weights_c = np.zeros((n, size)), np.zeros((n, size))
    weights_b[:, places], weights_c[:, places] = at_b, at_c
    order, n_legal = _in_order(places, legal, own, reach, block.ring, limits.height_step)
    return Targets(cover, weights_b, weights_c, own, order, n_legal)


def _in_order(places, legal, own, reach, ring, height_step):
    """Sort the legal targets by insertion, as the kernel does: ties are not transitive."""
    n, size = own.shape
    rows = np.arange(n)
    order, n_legal = np.zeros((n, size), dtype=np.int64), np.zeros(n, dtype=np.int64)
    for column, j in enumerate(places):
        at = n_legal.copy()
        moving = np.flatnonzero(legal[:, column] & (at > 0))
        while len(moving):
            other = order[moving, at[moving] - 1]
            goes = _comes_before(
                own[moving, j], own[moving, other], reach[moving, j], reach[moving, other],
                ring[moving, j], ring[moving, other], height_step,
            )  # fmt: skip
            moving, other = moving[goes], other[goes]
            order[moving, at[moving]] = other
            at[moving] -= 1
            moving = moving[at[moving] > 0]
        here = rows[legal[:, column]]
        order[here, at[here]] = j
        n_legal[here] += 1
    return order, n_legal


def _comes_before(own, other_own, reach, other_reach, ring, other_ring, height_step):
    return np.where(
        ~_are_tied(own, other_own, height_step),
        own < other_own,
        np.where(~_are_tied(reach, other_reach, 0.0), reach < other_reach, ring < other_ring),
    )


def _are_tied(a, b, height_step):
    larger, squared_step = np.maximum(a, b), height_step * height_step
    tied = 4.0 * squared_step * (larger + squared_step) + (RELATIVE_STEP * larger) ** 2
    return (a - b) * (a - b) <= tied


def _covers_from(places, block, diameter):
    """Corner before the face that would hold v, and v's weights, for the fan around each place."""
    rx, ry, size = block.rx, block.ry, block.rx.shape[1]
    ax, ay = rx[:, places], ry[:, places]
    k = (places + 1) % size
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
        begins, ends = previous >= 0.0, behind <= 0.0
        if block.is_outline:
            begins, ends = begins | (t == 0), ends | (t == size - 3)
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


def _best_targets(block, targets, known, bound, limits):
    """Place of the best target of each vertex, its error, and whether the bound was met."""
    by_sum = limits.norm == LEAST_SQUARES
    rows = np.arange(len(block.v))
    has_any = targets.n_legal > 0
    best, found = bound.copy(), np.full(len(rows), NONE)
    is_cut = has_any & (targets.own[rows, targets.order[:, 0]] >= bound)
    is_kept = has_any & (known != NONE)
    found[is_kept], best[is_kept], is_cut[is_kept] = targets.order[is_kept, 0], 0.0, False
    asked = np.flatnonzero(has_any & (known == NONE))
    k = 0
    while True:
        asked = asked[k < targets.n_legal[asked]]
        j = targets.order[asked, k] if len(asked) else asked
        here = targets.own[asked, j]
        promising = here < best[asked]
        asked, j, here = asked[promising], j[promising], here[promising]
        if len(asked) == 0:
            return found, best, is_cut
        total, largest, largest_z = _fan_errors(block, asked, j, block.rz, here)
        if not by_sum:
            total = largest * (1.0 + TIE_SHARE * (1.0 - largest / np.maximum(total, 1e-300)))
        is_over = total >= best[asked]
        is_cut[asked[is_over]] = True
        with np.errstate(invalid="ignore"):  # infinite bounds
            step = _step_of(block.n_points[asked] + 1, best[asked], limits.height_step)
            is_tied = (found[asked] != NONE) & (best[asked] - total <= step)
        is_better = ~is_over & ~is_tied & (largest_z <= limits.tolerance)
        best[asked[is_better]], found[asked[is_better]] = total[is_better], j[is_better]
        k += 1


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


def _update_corners(level, block, rows, j, targets):
    """Change of the errors outside the stars by the update, its terms, and the heights moved."""
    surface, moments = level.surface, level.moments
    integrals, locked = level.vertices.integrals, level.vertices.locked
    size, n_sides = block.ring.shape[1], block.spoke.shape[1]
    b, at_b, at_c = (of[rows, j] for of in (targets.cover, targets.at_b, targets.at_c))
    c = np.where(b + 1 < size, b + 1, 0)
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
    change, terms = np.zeros(len(v)), np.zeros(len(v))
    rz = block.rz.copy()
    detail = np.empty((len(v), rz.shape[2]))
    for i in range(rz.shape[2]):
        fit = at_a * rz[rows, j, i] + at_b * rz[rows, b, i] + at_c * rz[rows, c, i]
        detail[:, i] = surface.z[v, i] - fit
        change += (fit + own_share * detail[:, i] - surface.measured[v, i]) ** 2
    zero = np.float32(0)
    for (corner, u), share in zip(corners, shares, strict=True):
        last = np.where(corner > 0, corner - 1, size - 1)
        has_following, has_preceding = corner < n_sides, last < n_sides
        following = after(block.spoke[rows, np.minimum(corner, n_sides - 1)])
        preceding = before(block.spoke[rows, np.minimum(last, n_sides - 1)])
        stiffness = moments.vertex_weight[u]
        stiffness = stiffness - np.where(has_following, moments.weight[following], zero)
        stiffness = stiffness - np.where(has_preceding, moments.weight[preceding], zero)
        for i in range(rz.shape[2]):
            rate = moments.vertex_slope[u, i]
            rate = rate - np.where(has_following, moments.slope[following, i], zero)
            rate = rate - np.where(has_preceding, moments.slope[preceding, i], zero)
            shift = factor * share * detail[:, i]
            change += (2.0 * rate + stiffness * shift) * shift
            terms += np.abs(shift) * (2.0 * np.abs(rate) + moments.vertex_weight[u] * np.abs(shift))
            rz[rows, corner, i] += shift
    return change, terms, rz
