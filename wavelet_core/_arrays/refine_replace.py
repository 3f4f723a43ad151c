"""Vertices that help least, places that need one, on whole arrays; see the kernels of that name."""

from __future__ import annotations

import numpy as np

from .._kernels.refine_replace import N_INSERTIONS, ON_EDGE
from ._csr import blocks, expanded
from .half_edges import after, before, rings_of
from .outline import is_straight
from .refine_move import find_side
from .refine_tin import POINTS_AT_ONCE, hand_over, is_wide, largest, stars_of, total, weighed


def list_stars(start, stop, chosen, mesh, needs):
    needs[:] = -1
    needs[:, 0] = chosen
    ring = rings_of(chosen, mesh).ring[:, : needs.shape[1] - 1]
    needs[:, 1 : 1 + ring.shape[1]] = ring


# -- removals -------------------------------------------------------------------------------------


def propose_removals(
    start, stop, chosen, tin, points, objective, error, bound, capacity, with_outline, target, cost
):
    target[:], cost[:] = -1, np.inf
    may = (tin.mesh.outgoing[chosen] >= 0) & ~tin.is_locked[chosen]
    for stars in stars_of(chosen, may, tin, points):
        size = stars.ring.shape[1]
        if size < 3:
            continue
        if stars.is_outline:
            legal = is_straight(stars.x[:, 0], stars.y[:, 0], stars.x[:, -1], stars.y[:, -1])
            legal &= bool(with_outline)
            places = (0, size - 1)
        else:
            legal, places = ~tin.stays[stars.v], range(size)
        present = np.zeros(len(stars.v))
        for k in range(stars.spoke.shape[1]):
            present += error[stars.spoke[:, k] // 3]
        limit = present + bound
        for j in places:
            new, fits = _laid(stars, j, legal, tin, points, objective)
            better = np.flatnonzero(fits & (new < limit))
            limit[better] = new[better]
            target[stars.rows[better]] = j
            cost[stars.rows[better]] = (new - present)[better]


def _fan(stars, j, tin):
    """Return the ring from its place j on, that place left out, and where it lies from there."""
    size = stars.ring.shape[1]
    places = (j + 1 + np.arange(size - 1)) % size
    return places, stars.x[:, places] - stars.x[:, [j]], stars.y[:, places] - stars.y[:, [j]]


def _laid(stars, j, legal, tin, points, objective):
    """Return the errors of the stars under the fan around ring[j], and whether that is legal."""
    n, size = stars.ring.shape
    places, seen_x, seen_y = _fan(stars, j, tin)
    legal = legal.copy()
    zero = np.zeros(n)
    for t in range(size - 2):
        sides = seen_x[:, t], seen_y[:, t], seen_x[:, t + 1], seen_y[:, t + 1]
        legal &= is_wide(zero, zero, *sides)
    mine = np.flatnonzero(legal[stars.row])
    row, p, a = stars.row[mine], stars.p[mine], stars.ring[:, j]
    px, py = points.x[p] - tin.x[a][row], points.y[p] - tin.y[a][row]
    hint = _fan_place(stars.side[mine], j, size)
    t = find_side(hint, size - 1, size - 2, seen_x, seen_y, row, px, py)
    bx, by, cx, cy = seen_x[:, :-1], seen_y[:, :-1], seen_x[:, 1:], seen_y[:, 1:]
    area = bx * cy - by * cx
    area = np.where(legal[:, None], area, 1.0)
    b, c = stars.ring[:, places[:-1]], stars.ring[:, places[1:]]
    squared, most = np.zeros(len(mine)), np.zeros(n)
    for i in range(tin.z.shape[1]):
        za = tin.z[a, i]
        to_b, to_c = (tin.z[b, i] - za[:, None]) / area, (tin.z[c, i] - za[:, None]) / area
        slope_x, slope_y = to_b * cy - to_c * by, to_c * bx - to_b * cx
        off = za[row] + slope_x[row, t] * px + slope_y[row, t] * py - points.z[p, i]
        squared += off * off
        if i == 0:
            most = largest(row, squared * points.strictness[p], n)
    return total(row, weighed(squared, objective.is_power), n), legal & (
        most <= objective.tolerance
    )


def _fan_place(side, j, size):
    return np.minimum((side - j - 1) % size, size - 3)


def remove_vertices(start, stop, chosen, target, base, tin, points, capacity, freed):
    freed[:] = -1
    # stars are grouped by their shape, and so are the places in them: one place at a time
    for stars in list(stars_of(chosen, np.ones(len(chosen), dtype=bool), tin, points)):
        for j in np.unique(target[stars.rows]):
            _remove(stars, int(j), target[stars.rows] == j, base, tin, points, freed)


def _remove(stars, j, is_mine, base, tin, points, freed):
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    size = stars.ring.shape[1]
    rows = np.flatnonzero(is_mine)
    position = np.full(len(stars.v), -1)
    position[rows] = np.arange(len(rows))
    mine = np.flatnonzero(is_mine[stars.row])
    row, p = position[stars.row[mine]], stars.p[mine]
    ring, spoke = stars.ring[rows], stars.spoke[rows]
    places = (j + 1 + np.arange(size - 1)) % size
    a = ring[:, j]
    seen_x, seen_y = (
        tin.x[ring[:, places]] - tin.x[a][:, None],
        (tin.y[ring[:, places]] - tin.y[a][:, None]),
    )
    px, py = points.x[p] - tin.x[a][row], points.y[p] - tin.y[a][row]
    hint = _fan_place(stars.side[mine], j, size)
    t = find_side(hint, size - 1, size - 2, seen_x, seen_y, row, px, py)
    hand_over(row, t, p, base[stars.rows[rows]], spoke[:, places[:-1]] // 3, points)
    origin[spoke] = a[:, None]
    at = stars.rows[rows]
    has_after, has_before = not (stars.is_outline and j > 0), not (stars.is_outline and j == 0)
    if has_after:
        gone = spoke[:, j]
        beyond, kept = twin[after(gone)], spoke[:, (j + 1) % size]
        following = ring[:, (j + 1) % size]
        twin[kept] = beyond
        twin[beyond[beyond >= 0]] = kept[beyond >= 0]
        names = outgoing[following] == before(gone)
        outgoing[following[names]] = after(kept)[names]
        names = outgoing[a] // 3 == gone // 3
        if has_before:
            names |= outgoing[a] // 3 == spoke[:, (j - 1) % size] // 3
        outgoing[a[names]] = kept[names]
        freed[at, 0] = gone // 3
    if has_before:
        gone = spoke[:, (j - 1) % size]
        beyond, kept = twin[after(gone)], before(spoke[:, (j - 2) % size])
        preceding = ring[:, (j - 1) % size]
        twin[kept] = beyond
        twin[beyond[beyond >= 0]] = kept[beyond >= 0]
        names = outgoing[preceding] == after(gone)
        outgoing[preceding[names]] = kept[names]
        if not has_after:
            outgoing[a] = spoke[:, 0]
        freed[at, 1] = gone // 3
    outgoing[stars.v[rows]] = -1
    faces = freed[at][freed[at] >= 0]
    points.n_points[faces] = 0
    corners = 3 * faces[:, None] + np.arange(3)
    origin[corners], twin[corners] = -1, -1


# -- insertions -----------------------------------------------------------------------------------


def propose_insertions(start, stop, faces, tin, points, objective, point, on_edge, height, gain):
    point[:], on_edge[:], gain[:], height[:] = -1, -1, 0.0, 0.0
    rows = np.flatnonzero(tin.mesh.origin[3 * faces] >= 0)
    for part in blocks(points.n_points[faces[rows]] + 1, POINTS_AT_ONCE):
        at = rows[part]
        row, p, rank = _largest_errors(faces[at], tin, points)
        for t in range(N_INSERTIONS):
            mine = rank == t
            _try(
                at[row[mine]], p[mine], faces, tin, points, objective, point, on_edge, height, gain
            )


def _errors_at(face, p, tin, points):
    """Return barycentric weights of points in faces, and how far those are above them."""
    x, y, z = tin.x, tin.y, tin.z
    a, b, c = (tin.mesh.origin[3 * face + k] for k in range(3))
    bx, by, cx, cy = x[b] - x[a], y[b] - y[a], x[c] - x[a], y[c] - y[a]
    px, py = points.x[p] - x[a], points.y[p] - y[a]
    area = bx * cy - by * cx
    at_b, at_c = (px * cy - py * cx) / area, (bx * py - by * px) / area
    at_a = 1.0 - at_b - at_c
    off = np.empty((len(p), z.shape[1]))
    for i in range(z.shape[1]):
        off[:, i] = z[a, i] + at_b * (z[b, i] - z[a, i]) + at_c * (z[c, i] - z[a, i])
        off[:, i] -= points.z[p, i]
    return np.column_stack([at_a, at_b, at_c]), off


def _squared(off):
    squared = np.zeros(len(off))
    for i in range(off.shape[1]):
        squared += off[:, i] * off[:, i]
    return squared


def _largest_errors(faces, tin, points):
    """Return the points of the largest errors of each face, the largest first."""
    row, place = expanded(points.first[faces], points.n_points[faces])
    p = points.pool[place]
    squared = _squared(_errors_at(faces[row], p, tin, points)[1])
    kept = np.flatnonzero(squared > 0.0)
    order = kept[np.lexsort((kept, -squared[kept], row[kept]))]
    row, p = row[order], p[order]
    rank = np.arange(len(row)) - np.searchsorted(row, row)
    kept = rank < N_INSERTIONS
    return row[kept], p[kept], rank[kept]


def _try(at, q, faces, tin, points, objective, point, on_edge, height, gain):
    """Put a point into each of some faces; keep what gains more."""
    face, n_channels = faces[at], tin.z.shape[1]
    own, own_off = _errors_at(face, q, tin, points)
    surface = own_off + points.z[q]
    edge = np.full(len(q), -1)
    for k in range(3):
        edge = np.where(own[:, k] <= ON_EDGE, 3 * face + (k + 1) % 3, edge)
    across = np.where(edge >= 0, tin.mesh.twin[edge], -1)
    legal = ~((edge >= 0) & (across < 0))
    legal &= _splits_well(face, edge, edge, q, tin, points)
    second = np.where(across >= 0, across // 3, face)
    legal &= ~(edge >= 0) | _splits_well(second, edge, across, q, tin, points)
    at, q, face, edge = at[legal], q[legal], face[legal], edge[legal]
    own, surface, second = own[legal], surface[legal], second[legal]
    n = len(q)
    squares, gained, pull = np.zeros(n), np.zeros(n), np.zeros((n, n_channels))
    for half in range(2):
        rows = np.arange(n) if half == 0 else np.flatnonzero(edge >= 0)
        here = (face if half == 0 else second)[rows]
        share = own[rows] if half == 0 else _errors_at(here, q[rows], tin, points)[0]
        row, place = expanded(points.first[here], points.n_points[here])
        p, of = points.pool[place], rows[row]
        weights, off = _errors_at(here[row], p, tin, points)
        inverse = np.full(share.shape, np.inf)
        np.divide(1.0, share, out=inverse, where=share > ON_EDGE)
        weight = np.full(len(p), np.inf)
        for k in range(3):
            known = inverse[row, k] < np.inf
            hat = weights[:, k] * np.where(known, inverse[row, k], 0.0)
            weight = np.where(known, np.minimum(weight, hat), weight)
        weight = np.maximum(weight, 0.0)
        squares = _added(squares, of, weight * weight)
        after_it = np.zeros(len(p))
        for i in range(n_channels):
            pull[:, i] = _added(pull[:, i], of, weight * off[:, i])
            changed = off[:, i] - weight * (surface[of, i] - points.z[q[of], i])
            after_it += changed * changed
        before_it = _squared(off)
        change = weighed(before_it, objective.is_power) - weighed(after_it, objective.is_power)
        gained = _added(gained, of, change)
    if objective.is_free:
        gained = np.zeros(n)
        for i in range(n_channels):
            gained += pull[:, i] * (pull[:, i] / squares)
    better = np.flatnonzero(gained > gain[at])
    at, q = at[better], q[better]
    point[at], on_edge[at], gain[at] = q, edge[better], gained[better]
    height[at] = points.z[q]
    if objective.is_free:
        height[at] = surface[better] - pull[better] / squares[better][:, None]


def _added(start, row, values):
    """Return ``start`` with the values of each row added to it, one after the other."""
    rows = np.concatenate([np.arange(len(start)), row])
    return total(rows, np.concatenate([start, values]), len(start))


def _splits_well(here, edge, spared, q, tin, points):
    x, y, origin = tin.x, tin.y, tin.mesh.origin
    fits = np.ones(len(q), dtype=bool)
    for k in range(3):
        half_edge = 3 * here + k
        u, w = origin[half_edge], origin[3 * here + (k + 1) % 3]
        wide = is_wide(points.x[q], points.y[q], x[u], y[u], x[w], y[w])
        fits &= wide | (half_edge == edge) | (half_edge == spared)
    return fits


def list_corners(start, stop, faces, on_edge, mesh, needs):
    needs[:, :3] = mesh.origin[3 * faces[:, None] + np.arange(3)]
    needs[:, 3] = -1
    split = on_edge >= 0
    needs[split, 3] = mesh.origin[before(mesh.twin[on_edge[split]])]


def insert_vertices(
    start, stop, faces, on_edge, point, height, vertex, free, base, tin, points, capacity
):
    tin.x[vertex], tin.y[vertex] = points.x[point], points.y[point]
    tin.z[vertex], tin.point[vertex] = height, point
    tin.stays[vertex], tin.is_locked[vertex] = False, False
    for size in (3, 4):
        rows = np.flatnonzero((on_edge >= 0) == (size == 4))
        if len(rows):
            _insert(rows, size, faces, on_edge, vertex, free, base, tin, points)


def _insert(rows, size, faces, on_edge, vertex, free, base, tin, points):
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    v, face, edge = vertex[rows], faces[rows], on_edge[rows]
    if size == 3:
        half_edges = 3 * face[:, None] + np.arange(3)
        old = face[:, None]
        slot = np.column_stack([face, free[rows]])
    else:
        other = twin[edge]
        half_edges = np.column_stack([after(edge), before(edge), after(other), before(other)])
        old = np.column_stack([face, other // 3])
        slot = np.column_stack([face, free[rows, 0], other // 3, free[rows, 1]])
    rim, beyond = origin[half_edges], twin[half_edges]
    seen_x, seen_y = tin.x[rim] - tin.x[v][:, None], tin.y[rim] - tin.y[v][:, None]
    row, place = expanded(points.first[old].ravel(), points.n_points[old].ravel())
    row //= old.shape[1]
    p = points.pool[place]
    px, py = points.x[p] - tin.x[v][row], points.y[p] - tin.y[v][row]
    hint = np.zeros(len(p), dtype=np.int64)
    side = find_side(hint, size, size, seen_x, seen_y, row, px, py)
    hand_over(row, side, p, base[rows], slot, points)
    first = 3 * slot.astype(np.int32)
    for k in range(size):
        f = first[:, k]
        origin[f], origin[f + 1], origin[f + 2] = rim[:, k], rim[:, (k + 1) % size], v
        twin[f] = beyond[:, k]
        twin[f + 1] = first[:, (k + 1) % size] + 2
        twin[f + 2] = first[:, (k - 1) % size] + 1
        there = beyond[:, k] >= 0
        twin[beyond[there, k]] = f[there]
    for k in range(size):
        names = (outgoing[rim[:, k], None] // 3 == old).any(axis=1)
        outgoing[rim[names, k]] = first[names, k]
    outgoing[v] = first[:, 0] + 2
