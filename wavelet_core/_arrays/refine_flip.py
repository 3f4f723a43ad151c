"""Edges that lie better across their quadrangle, on whole arrays; see the kernels of that name."""

from __future__ import annotations

import numpy as np

from .._kernels.refine_flip import LEAST_GAIN
from ._csr import blocks, expanded
from .half_edges import after, before
from .refine_tin import POINTS_AT_ONCE, hand_over, is_wide, largest, total, weighed


def corners_of(half_edge, origin, twin):
    other = twin[half_edge]
    return (
        origin[half_edge], origin[other], origin[before(half_edge)], origin[before(other)]
    )  # fmt: skip


def gains_of_flips(start, stop, half_edges, tin, points, objective, error, gain):
    gain[:] = 0.0
    x, y, origin, twin = tin.x, tin.y, tin.mesh.origin, tin.mesh.twin
    faces = np.column_stack([half_edges // 3, twin[half_edges] // 3])
    present = error[faces[:, 0]] + error[faces[:, 1]]
    a, b, c, d = corners_of(half_edges, origin, twin)
    legal = (present > 0.0) & ~(tin.is_locked[a] & tin.is_locked[b])
    legal &= is_wide(x[a], y[a], x[d], y[d], x[c], y[c])
    legal &= is_wide(x[d], y[d], x[b], y[b], x[c], y[c])
    rows = np.flatnonzero(legal)
    for part in blocks(points.n_points[faces[rows]].sum(axis=1) + 1, POINTS_AT_ONCE):
        at = rows[part]
        corners = a[at], b[at], c[at], d[at]
        _gains(at, corners, faces[at], present[at], tin, points, objective, gain)


def _gains(at, corners, faces, present, tin, points, objective, gain):
    a, b, c, d = corners
    x, y, z = tin.x, tin.y, tin.z
    row, side, p, px, py = _points_beside(faces, c, d, tin, points)
    dx, dy = x[d] - x[c], y[d] - y[c]
    squared, most = np.zeros(len(p)), np.zeros(len(at))
    for i in range(z.shape[1]):
        slopes = []
        for u in (a, b):
            ux, uy = x[u] - x[c], y[u] - y[c]
            per_area = 1.0 / (ux * dy - uy * dx)
            to_u, to_d = z[u, i] - z[c, i], z[d, i] - z[c, i]
            slopes.append(((to_u * dy - to_d * uy) * per_area, (to_d * ux - to_u * dx) * per_area))
        slope_x, slope_y = (np.column_stack([slopes[0][k], slopes[1][k]]) for k in (0, 1))
        off = z[c, i][row] + slope_x[row, side] * px + slope_y[row, side] * py - points.z[p, i]
        squared += off * off
        if i == 0:
            most = largest(row, squared * points.strictness[p], len(at))
    new = total(row, weighed(squared, objective.is_power), len(at))
    better = (new < present - LEAST_GAIN * present) & (most <= objective.tolerance)
    gain[at[better]] = (present - new)[better]


def _points_beside(faces, c, d, tin, points):
    """Return the points of pairs of faces, from c, and on which side of c d each lies."""
    row, place = expanded(points.first[faces].ravel(), points.n_points[faces].ravel())
    row //= 2
    p = points.pool[place]
    px, py = points.x[p] - tin.x[c][row], points.y[p] - tin.y[c][row]
    dx, dy = tin.x[d] - tin.x[c], tin.y[d] - tin.y[c]
    side = (dx[row] * py - dy[row] * px >= 0.0).astype(np.int64)
    return row, side, p, px, py


def flip_edges(start, stop, half_edges, base, tin, points):
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    other = twin[half_edges]
    a, b, c, d = corners_of(half_edges, origin, twin)
    faces = np.column_stack([half_edges // 3, other // 3])
    row, side, p, _, _ = _points_beside(faces, c, d, tin, points)
    hand_over(row, side, p, base, faces, points)
    beyond_bc, beyond_ca = twin[after(half_edges)], twin[before(half_edges)]
    beyond_ad, beyond_db = twin[after(other)], twin[before(other)]
    f, g = 3 * faces[:, 0], 3 * faces[:, 1]
    for k, vertex in enumerate((a, d, c)):
        origin[f + k] = vertex
    for k, vertex in enumerate((d, b, c)):
        origin[g + k] = vertex
    twin[f], twin[f + 1], twin[f + 2] = beyond_ad, g + 2, beyond_ca
    twin[g], twin[g + 1], twin[g + 2] = beyond_db, beyond_bc, f + 1
    for beyond, own in ((beyond_ad, f), (beyond_ca, f + 2), (beyond_db, g), (beyond_bc, g + 1)):
        twin[beyond[beyond >= 0]] = own[beyond >= 0]
    for vertex, own in ((a, f), (b, g + 1), (c, f + 2), (d, g)):
        first = outgoing[vertex] - outgoing[vertex] % 3
        moved = (first == f) | (first == g)
        outgoing[vertex[moved]] = own[moved]
