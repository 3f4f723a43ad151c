"""The best place of a vertex near where it is, on whole arrays; see the kernels of that name."""

from __future__ import annotations

import numpy as np

from .._kernels.refine_move import LEAST_GAIN
from .outline import is_straight
from .refine_tin import hand_over, is_wide, largest, stars_of, total, weighed


def following_of(side, size):
    return np.where(side + 1 < size, side + 1, 0)


def find_side(hint, size, n_sides, ring_x, ring_y, row, x, y):
    """Return which side of its star holds each point; see the kernel."""
    k = np.array(hint)
    found = k.copy()
    open_ = np.arange(len(k))
    for _ in range(n_sides):
        if len(open_) == 0:
            break
        here, side = row[open_], k[open_]
        following = following_of(side, size)
        holds = (ring_x[here, side] * y[open_] - ring_y[here, side] * x[open_] >= 0.0) & (
            ring_x[here, following] * y[open_] - ring_y[here, following] * x[open_] <= 0.0
        )
        found[open_[holds]] = side[holds]
        open_ = open_[~holds]
        side = k[open_]
        k[open_] = np.where(side + 1 < n_sides, side + 1, 0)
    return found


def propose_moves(start, stop, chosen, tin, points, objective, capacity, to, shift, gain):
    to[:], gain[:], shift[:] = -1, 0.0, 0.0
    may = (tin.mesh.outgoing[chosen] >= 0) & ~tin.is_locked[chosen]
    for stars in stars_of(chosen, may, tin, points):
        _propose(stars, tin, points.strictness, objective, to, shift, gain)


def _propose(stars, tin, strictness, objective, to, shift, gain):
    n, size = stars.ring.shape
    n_sides, n_channels = stars.spoke.shape[1], tin.z.shape[1]
    row, side = stars.row, stars.side
    following = following_of(side, size)
    every = np.arange(n_sides)
    turned = following_of(every, size)
    bx, by = stars.x[:, every], stars.y[:, every]
    cx, cy = stars.x[:, turned], stars.y[:, turned]
    inverse = 1.0 / (bx * cy - by * cx)
    at_b = (stars.px * cy[row, side] - stars.py * cx[row, side]) * inverse[row, side]
    at_c = (bx[row, side] * stars.py - by[row, side] * stars.px) * inverse[row, side]
    weight = 1.0 - at_b - at_c
    offs, squared = [], np.zeros(len(row))
    for i in range(n_channels):
        z = stars.z[:, :, i]
        off = at_b * z[row, side] + at_c * z[row, following] - stars.pz[:, i]
        squared += off * off
        offs.append(off)
    present = total(row, weighed(squared, objective.is_power), n)
    stress = squared * squared * squared if objective.is_power else 1.0
    key = row * n_sides + side
    squares = total(key, stress * (weight * weight), n * n_sides).reshape(n, n_sides)
    model = np.zeros((n_channels, 9, n))
    for i in range(n_channels):
        part = total(key, stress * (weight * offs[i]), n * n_sides).reshape(n, n_sides)
        zb, zc = stars.z[:, every, i], stars.z[:, turned, i]
        gx = (zb * cy - zc * by) * inverse
        gy = (zc * bx - zb * cx) * inverse
        terms = (
            squares, squares * gx, squares * gy, squares * (gx * gx), squares * (gx * gy),
            squares * (gy * gy), part, part * gx, part * gy,
        )  # fmt: skip
        for k in range(n_sides):
            for t, term in enumerate(terms):
                model[i, t] += term[:, k]
    n_points = np.bincount(row, minlength=n)
    judged = (n_points > 0) & (present > 0.0)
    best = present.copy()
    stiff = model[0, 0] > 0.0
    if objective.is_free:
        for i in range(n_channels):
            ratio = model[i, 6] / np.where(stiff, model[i, 0], 1.0)
            shift[stars.rows, i] = np.where(judged & stiff, -ratio, 0.0)
            best -= np.where(stiff, model[i, 6] * ratio, 0.0)
    gain[stars.rows] = np.where(judged, present - best, 0.0)
    moves = judged & ~tin.stays[stars.v]
    if stars.is_outline:
        moves &= is_straight(stars.x[:, 0], stars.y[:, 0], stars.x[:, -1], stars.y[:, -1])
    q, order_of = _trials(stars, moves, model, stiff, tin, objective)
    threshold = best - LEAST_GAIN * present
    for t in range(objective.n_trials):
        _try(stars, q[order_of == t], strictness, present, threshold, objective, to, shift, gain)


def _trials(stars, moves, model, stiff, tin, objective):
    """Return the most promising points, as entries of the stars, and which each is of its star."""
    n_channels, size = len(model), stars.ring.shape[1]
    row, dx, dy = stars.row, stars.px, stars.py
    q = moves[row] & ~(dx * dx + dy * dy > objective.reach) & (stars.p != tin.point[stars.v][row])
    q = np.flatnonzero(q)
    if stars.is_outline:
        at, x, y = row[q], dx[q], dy[q]
        ends = stars.x[at, 0] - x, stars.y[at, 0] - y, stars.x[at, -1] - x, stars.y[at, -1] - y
        q = q[is_straight(*ends)]
    for k in range(stars.spoke.shape[1]):
        at, then = row[q], k + 1 if k + 1 < size else 0
        ends = stars.x[at, k], stars.y[at, k], stars.x[at, then], stars.y[at, then]
        q = q[is_wide(dx[q], dy[q], *ends)]
    at, dx, dy = row[q], dx[q], dy[q]
    expected = np.zeros(len(q))
    for i in range(n_channels):
        m = model[i][:, at]
        pull = m[1] * dx + m[2] * dy - m[6]
        expected += m[3] * dx * dx + 2.0 * (m[4] * dx * dy) + m[5] * dy * dy
        expected -= 2.0 * (m[7] * dx + m[8] * dy)
        if objective.is_free:
            ratio = pull / np.where(stiff[at], m[0], 1.0)
            expected -= np.where(stiff[at], pull * ratio, 0.0)
        else:
            expected += stars.pz[q, i] * (m[0] * stars.pz[q, i] - 2.0 * pull)
    order = np.lexsort((q, expected, at))
    q, at = q[order], at[order]
    begins = np.searchsorted(at, at)
    return q, np.arange(len(q)) - begins


def _try(stars, q, strictness, present, threshold, objective, to, shift, gain):
    """Lay the stars around the points ``q``, at most one each; keep what is better."""
    n_channels, size, n_sides = stars.z.shape[2], stars.ring.shape[1], stars.spoke.shape[1]
    rows = stars.row[q]
    position = np.full(len(stars.v), -1)
    position[rows] = np.arange(len(q))
    mine = np.flatnonzero(position[stars.row] >= 0)
    row = position[stars.row[mine]]
    ux, uy, uz = stars.px[q], stars.py[q], stars.pz[q]
    seen_x, seen_y = stars.x[rows] - ux[:, None], stars.y[rows] - uy[:, None]
    px, py = stars.px[mine] - ux[row], stars.py[mine] - uy[row]
    side = find_side(stars.side[mine], size, n_sides, seen_x, seen_y, row, px, py)
    following = following_of(side, size)
    bx, by, cx, cy = (
        seen_x[row, side], seen_y[row, side], seen_x[row, following], seen_y[row, following],
    )  # fmt: skip
    per_area = 1.0 / (bx * cy - by * cx)
    at_b, at_c = (px * cy - py * cx) * per_area, (bx * py - by * px) * per_area
    weight = 1.0 - at_b - at_c
    squares = total(row, weight * weight, len(q))
    squared, most, new = np.zeros(len(mine)), np.zeros(len(q)), np.zeros(len(q))
    dz = uz.copy()
    for i in range(n_channels):
        z = stars.z[rows, :, i]
        off = at_b * z[row, side] + at_c * z[row, following] - stars.pz[mine, i]
        if objective.is_free:
            rests, pulls = total(row, off * off, len(q)), total(row, weight * off, len(q))
            dz[:, i] = -(pulls / squares)
            new += rests - pulls * (pulls / squares)
            continue
        off += weight * uz[row, i]
        squared += off * off
        if i == 0:
            most = largest(row, squared * strictness[stars.p[mine]], len(q))
    if not objective.is_free:
        new = total(row, weighed(squared, objective.is_power), len(q))
    better = np.flatnonzero((new < threshold[rows]) & (most <= objective.tolerance))
    at = stars.rows[rows[better]]
    threshold[rows[better]] = new[better]
    to[at], shift[at] = stars.p[q[better]], dz[better]
    gain[at] = present[rows[better]] - new[better]


def move_vertices(start, stop, chosen, to, shift, base, tin, points, capacity):
    tin.z[chosen] += shift
    moves = to >= 0
    v = chosen[moves]
    tin.point[v] = to[moves]
    tin.x[v], tin.y[v] = points.x[to[moves]], points.y[to[moves]]
    for stars in stars_of(chosen, moves, tin, points):
        n_sides = stars.spoke.shape[1]
        side = find_side(
            stars.side, stars.ring.shape[1], n_sides, stars.x, stars.y, stars.row, stars.px,
            stars.py,
        )  # fmt: skip
        hand_over(stars.row, side, stars.p, base[stars.rows], stars.spoke // 3, points)
