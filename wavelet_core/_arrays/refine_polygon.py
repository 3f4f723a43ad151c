"""A vertex goes, the best triangles come, on whole arrays; see the kernels of that name."""

from __future__ import annotations

import numpy as np

from .._kernels.refine_polygon import MAX_POLYGON, N_JUDGES, WITHIN
from ._csr import summed
from .half_edges import after
from .outline import is_straight
from .refine_tin import hand_over, is_wide, largest, stars_of, total


def propose_polygons(start, stop, chosen, tin, points, objective, error, capacity, corners, cost):
    cost[:], corners[:] = np.inf, -1
    may = (tin.mesh.outgoing[chosen] >= 0) & ~tin.is_locked[chosen]
    for stars in stars_of(chosen, may, tin, points):
        size = stars.ring.shape[1]
        if not 3 <= size <= MAX_POLYGON:
            continue
        legal = np.ones(len(stars.v), dtype=bool)
        if stars.is_outline:
            legal = is_straight(stars.x[:, 0], stars.y[:, 0], stars.x[:, -1], stars.y[:, -1])
        least, middle = _best_parts(stars, legal, tin, points, objective)
        rows = np.flatnonzero(least < np.inf)
        laid = _triangles(middle[rows], size)
        mine = np.flatnonzero((least < np.inf)[stars.row])
        row = (np.cumsum(least < np.inf) - 1)[stars.row[mine]]
        p, ring = stars.p[mine], stars.ring[rows]
        face = _holding(laid, ring, row, p, tin, points)
        a, b, c = (ring[row, laid[row, face, corner]] for corner in range(3))
        squared, squared_z = _squared_errors(a, b, c, p, tin, points)
        most = largest(row, squared_z * points.strictness[p], len(rows))
        present = np.zeros(len(stars.v))
        for k in range(stars.spoke.shape[1]):
            present += error[stars.spoke[:, k] // 3]
        keeps = most <= objective.tolerance
        at = stars.rows[rows[keeps]]
        cost[at] = (total(row, squared, len(rows)) - present[rows])[keeps]
        corners[at, : size - 2] = laid[keeps]


def _best_parts(stars, legal, tin, points, objective):
    """Return what the best triangles of each whole ring cost, and where each part is split."""
    n, size = stars.ring.shape
    count = np.bincount(stars.row, minlength=n)
    place = np.arange(len(stars.row)) - (np.cumsum(count) - count)[stars.row]
    stride = 1 + (count - 1) // N_JUDGES if objective.tolerance == np.inf else np.ones_like(count)
    judges = place % np.maximum(stride, 1)[stars.row] == 0
    of_row, of_star = stars.row[judges], stars.p[judges]
    least = np.where(legal[:, None, None], np.zeros((n, size, size)), np.inf)
    middle = np.zeros((n, size, size), dtype=np.int8)
    for length in range(2, size):
        for i in range(size - length):
            k = i + length
            least[:, i, k] = np.inf
            for j in range(i + 1, k):
                summands = least[:, i, j] + least[:, j, k]
                a, b, c = stars.ring[:, i], stars.ring[:, j], stars.ring[:, k]
                tried = (summands < least[:, i, k]) & is_wide(
                    tin.x[a], tin.y[a], tin.x[b], tin.y[b], tin.x[c], tin.y[c]
                )
                mine = np.flatnonzero(tried[of_row])
                row, p = of_row[mine], of_star[mine]
                within = _least_weight(a[row], b[row], c[row], p, tin, points) >= WITHIN
                row, p = row[within], p[within]
                squared, squared_z = _squared_errors(a[row], b[row], c[row], p, tin, points)
                summands = summed(row, squared, summands)
                summands[row[squared_z * points.strictness[p] > objective.tolerance]] = np.inf
                better = tried & (summands < least[:, i, k])
                least[better, i, k], middle[better, i, k] = summands[better], j
    return least[:, 0, size - 1], middle


def _triangles(middle, size):
    """Return the places in the ring of the triangles that the parts are split into."""
    n = len(middle)
    corners = np.full((n, size - 2, 3), -1, dtype=np.int8)
    is_side = np.zeros((n, size, size), dtype=bool)
    is_side[:, 0, size - 1] = True
    n_faces = np.zeros(n, dtype=np.int64)
    for length in range(size - 1, 1, -1):
        for i in range(size - length):
            k = i + length
            rows = np.flatnonzero(is_side[:, i, k])
            j = middle[rows, i, k]
            ends = np.full_like(j, i), np.full_like(j, k)
            corners[rows, n_faces[rows]] = np.column_stack([ends[0], j, ends[1]])
            is_side[rows, i, j], is_side[rows, j, k] = True, True
            n_faces[rows] += 1
    return corners


def _weights(a, b, c, p, tin, points):
    x, y = tin.x, tin.y
    bx, by, cx, cy = x[b] - x[a], y[b] - y[a], x[c] - x[a], y[c] - y[a]
    px, py = points.x[p] - x[a], points.y[p] - y[a]
    area = bx * cy - by * cx
    at_b, at_c = (px * cy - py * cx) / area, (bx * py - by * px) / area
    return 1.0 - at_b - at_c, at_b, at_c


def _least_weight(a, b, c, p, tin, points):
    at_a, at_b, at_c = _weights(a, b, c, p, tin, points)
    return np.minimum(at_a, np.minimum(at_b, at_c))


def _squared_errors(a, b, c, p, tin, points):
    """Return the squared errors of points under triangles: of all channels, and of the height."""
    z = tin.z
    _, at_b, at_c = _weights(a, b, c, p, tin, points)
    squared = np.zeros(len(p))
    squared_z = squared
    for i in range(z.shape[1]):
        off = z[a, i] + at_b * (z[b, i] - z[a, i]) + at_c * (z[c, i] - z[a, i])
        off -= points.z[p, i]
        squared = squared + off * off
        squared_z = squared if i == 0 else squared_z
    return squared, squared_z


def _holding(corners, ring, row, p, tin, points):
    """Return which triangle holds each point best: the one whose least weight is the largest."""
    found, most = np.zeros(len(p), dtype=np.int64), np.full(len(p), -np.inf)
    for t in range(corners.shape[1]):
        a, b, c = (ring[row, corners[row, t, corner]] for corner in range(3))
        least = _least_weight(a, b, c, p, tin, points)
        better = least > most
        found[better], most[better] = t, least[better]
    return found


def lay_polygons(start, stop, chosen, corners, base, tin, points, capacity):
    for stars in list(stars_of(chosen, np.ones(len(chosen), dtype=bool), tin, points)):
        _lay(stars, corners[stars.rows], base, tin, points)


def _lay(stars, corners, base, tin, points):
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    ring, spoke = stars.ring, stars.spoke
    n, size = ring.shape
    n_sides, n_faces = spoke.shape[1], size - 2
    every = np.arange(n)
    corners = corners[:, :n_faces]
    face = _holding(corners, ring, stars.row, stars.p, tin, points)
    slots = spoke // 3
    hand_over(stars.row, face, stars.p, base[stars.rows], slots[:, :n_faces], points)
    across = np.full((n, size, size), -1, dtype=np.int32)
    for k in range(size):
        low, high = (k, k + 1) if k + 1 < size else (0, k)
        across[:, low, high] = twin[after(spoke[:, k])] if k < n_sides else -1
        names = (outgoing[ring[:, k], None] // 3 == slots).any(axis=1)
        outgoing[ring[names, k]] = -1
    for t in range(n_faces):
        i, j, k = (corners[:, t, corner].astype(np.int64) for corner in range(3))
        f = 3 * slots[:, t]
        origin[f], origin[f + 1], origin[f + 2] = ring[every, k], ring[every, i], ring[every, j]
        for side, (tail, head) in enumerate(((k, i), (i, j), (j, k))):
            is_rim = (head - tail == 1) | ((tail == size - 1) & (head == 0))
            meets = across[every, np.minimum(tail, head), np.maximum(tail, head)]
            joins = is_rim | (side == 0)
            twin[f[joins] + side] = meets[joins]
            there = joins & (meets >= 0)
            twin[meets[there]] = f[there] + side
            across[every[~joins], tail[~joins], head[~joins]] = f[~joins] + side
            vertex = ring[every, tail]
            names = is_rim & (outgoing[vertex] < 0)
            outgoing[vertex[names]] = f[names] + side
    outgoing[stars.v] = -1
    gone = slots[:, n_faces:].ravel()
    points.n_points[gone] = 0
    half_edges = 3 * gone[:, None] + np.arange(3)
    origin[half_edges], twin[half_edges] = -1, -1
