"""The points of the faces, on whole arrays; see the kernels of the same name."""

from __future__ import annotations

import numpy as np

from ._csr import blocks, expanded, summed
from .half_edges import before
from .outline import is_straight, nearest_on_edge

#: Points that are looked at together: a bound on the memory.
POINTS_AT_ONCE = 1 << 20


def count_points(start, stop, indptr, ring_faces, points, size):
    counts = np.where(ring_faces >= 0, points.n_points[np.maximum(ring_faces, 0)], 0)
    row = np.repeat(np.arange(len(size)), np.diff(indptr))
    size[:] = 1 + np.bincount(row, counts, minlength=len(size)).astype(np.int64)


def hand_over(
    start, stop, odd, indptr, ring, ring_faces, surface, points, first, face_changed,
    squared_tolerance, corners, weights, details,
):  # fmt: skip
    sizes = np.diff(indptr)
    totals = np.diff(first)
    for size in np.unique(sizes):
        rows = np.flatnonzero(sizes == size)
        for part in blocks(totals[rows] + size, POINTS_AT_ONCE):
            _hand_over_rows(
                rows[part], int(size), odd, indptr, ring, ring_faces, surface, points, first,
                face_changed, squared_tolerance, corners, weights, details,
            )  # fmt: skip


def _hand_over_rows(
    rows, size, odd, indptr, ring, ring_faces, surface, points, first, face_changed,
    squared_tolerance, corners, weights, details,
):  # fmt: skip
    n, n_wedges = len(rows), size - 2
    place = indptr[rows][:, None] + np.arange(size)
    around, faces = ring[place], ring_faces[place]
    v, a = odd[rows], around[:, 0]
    ax, ay = surface.x[a], surface.y[a]
    bx, by = surface.x[around[:, 1:]] - ax[:, None], surface.y[around[:, 1:]] - ay[:, None]
    cut = _cut_edges(v, around, faces, surface, squared_tolerance)

    counts = np.where(faces >= 0, points.n_points[np.maximum(faces, 0)], 0)
    cell, source = expanded(points.start[np.maximum(faces, 0)].ravel(), counts.ravel())
    of, k = cell // size, cell % size
    x, y = points.x[source] - ax[of], points.y[source] - ay[of]
    point_x, point_y = points.x[source], points.y[source]
    every = np.arange(n)
    own_x, own_y = surface.x[v] - ax, surface.y[v] - ay
    own = locate(n_wedges, bx, by, every, own_x, own_y, np.zeros(n, dtype=np.int64))
    own, at_b, at_c = _weights(own, own_x, own_y, bx, by, every)
    vertex_x, vertex_y = surface.x[v], surface.y[v]
    if cut is not None:
        is_cut, ends_at_target, px, py, qx, qy, along = cut
        moved = np.flatnonzero(is_cut[of])
        on = of[moved]
        x[moved], y[moved], _ = nearest_on_edge(x[moved], y[moved], px[on], py[on], qx[on], qy[on])
        point_x[moved], point_y[moved] = ax[on] + x[moved], ay[on] + y[moved]
        own = np.where(is_cut, np.where(ends_at_target, 0, n_wedges - 1), own)
        at_b = np.where(is_cut, np.where(ends_at_target, 1.0 - along, 0.0), at_b)
        at_c = np.where(is_cut, np.where(ends_at_target, 0.0, along), at_c)
        vertex_x = np.where(is_cut, ax + px + along * (qx - px), vertex_x)
        vertex_y = np.where(is_cut, ay + py + along * (qy - py), vertex_y)
    wedge = locate(n_wedges, bx, by, of, x, y, np.clip(k - 1, 0, n_wedges - 1))
    _predict(rows, own, at_b, at_c, around, v, surface, corners, weights, details)

    # the vertex itself first in its face, then the points in their order
    row = np.concatenate([every, of])
    into = np.concatenate([own, wedge])
    order = np.argsort(row * size + into, kind="stable")
    row, into = row[order], into[order]
    starts = np.cumsum(np.bincount(row, minlength=n)) - np.bincount(row, minlength=n)
    target = first[rows][row] + np.arange(len(row)) - starts[row]
    new_z = np.concatenate([surface.measured[v], points.z[source]])[order]
    points.x[target] = np.concatenate([vertex_x, point_x])[order]
    points.y[target] = np.concatenate([vertex_y, point_y])[order]
    points.z[target] = new_z

    n_here = np.bincount(row * n_wedges + into, minlength=n * n_wedges).reshape(n, n_wedges)
    begin = first[rows][:, None] + np.cumsum(n_here, axis=1) - n_here
    covering = faces[:, 1 : n_wedges + 1]
    holds = covering >= 0
    points.start[covering[holds]] = begin[holds]
    points.n_points[covering[holds]] = n_here[holds]
    face_changed[covering[holds]] = True
    for gone in (faces[:, 0], faces[:, size - 1]):
        points.n_points[gone[gone >= 0]] = 0


def _cut_edges(v, around, faces, surface, squared_tolerance):
    """Return which rows' new outline edge cuts their vertex off, and that edge from the target."""
    if squared_tolerance <= 0.0:
        return None
    ends_at_target = faces[:, 0] < 0
    a = around[:, 0]
    p = np.where(ends_at_target, around[:, 1], a)
    q = np.where(ends_at_target, a, around[:, -1])
    x, y = surface.x, surface.y
    px, py, qx, qy = x[p] - x[v], y[p] - y[v], x[q] - x[v], y[q] - y[v]
    is_cut = (ends_at_target | (faces[:, -1] < 0)) & (px * qy - py * qx > 0.0)
    is_cut &= ~is_straight(px, py, qx, qy)
    zero = np.zeros(len(v))
    with np.errstate(invalid="ignore", divide="ignore"):
        along = nearest_on_edge(zero, zero, px, py, qx, qy)[2]
    along = np.where(is_cut, along, 0.0)
    return is_cut, ends_at_target, x[p] - x[a], y[p] - y[a], x[q] - x[a], y[q] - y[a], along


def _weights(t, x, y, bx, by, every):
    """Weights of the outer corners of the wedge that holds the vertex, and that wedge."""
    b_x, b_y, c_x, c_y = bx[every, t], by[every, t], bx[every, t + 1], by[every, t + 1]
    doubled_area = b_x * c_y - b_y * c_x
    at_b = np.maximum((x * c_y - y * c_x) / doubled_area, 0.0)
    at_c = np.maximum((b_x * y - b_y * x) / doubled_area, 0.0)
    total = np.maximum(at_b + at_c, 1.0)
    return t, at_b / total, at_c / total


def _predict(rows, t, at_b, at_c, around, v, surface, corners, weights, details):
    every = np.arange(len(rows))
    a, b, c = around[:, 0], around[every, 1 + t], around[every, 2 + t]
    at_a = np.maximum(1.0 - at_b - at_c, 0.0)
    corners[rows] = np.column_stack([a, b, c])
    weights[rows] = np.column_stack([at_a, at_b, at_c])
    z = surface.z
    for i in range(z.shape[1]):
        details[rows, i] = z[v, i] - (at_a * z[a, i] + at_b * z[b, i] + at_c * z[c, i])


def locate(n_wedges, bx, by, row, x, y, hint):
    """Which face of the fan holds each point; the same walk as the kernel's."""

    def side(t):
        return bx[row, t] * y - by[row, t] * x

    t = hint.copy()
    for _ in range(n_wedges):
        back = (t > 0) & (side(t) < 0.0)
        if not back.any():
            break
        t = t - back
    may_advance = t == hint
    for _ in range(n_wedges):
        ahead = may_advance & (t < n_wedges - 1) & (side(t + 1) > 0.0)
        if not ahead.any():
            break
        t = t + ahead
    lost = np.flatnonzero(~((side(t) >= 0.0) & (side(t + 1) <= 0.0)))
    if len(lost):
        row, x, y = row[lost], x[lost], y[lost]
        found = np.full(len(lost), -1)
        for s in range(n_wedges):
            holds = (side(s) >= 0.0) & (side(s + 1) <= 0.0)
            found = np.where((found < 0) & holds, s, found)
        t[lost] = np.where(found < 0, t[lost], found)
    return t


def copy_points(start, stop, faces, first, points, x, y, z):
    _, place = expanded(points.start[faces], points.n_points[faces])
    n = len(place)
    x[:n], y[:n], z[:n] = points.x[place], points.y[place], points.z[place]


def sum_over_faces(start, stop, mesh, surface, points, vertices, faces, moments):
    corners = mesh.origin.reshape(-1, 3)
    z_changed = vertices.z_changed[corners].any(axis=1)
    renewed = faces.lives & faces.changed
    changed = np.flatnonzero(renewed | (faces.lives & z_changed))
    faces.changed[renewed] = False
    vertices.is_new[corners[renewed].ravel()] = True
    touched = corners[changed].ravel()
    vertices.is_stale[touched], vertices.has_moved[touched] = True, True
    sums = (faces.squared, faces.squared_z, faces.largest_z)
    for part in blocks(points.n_points[changed] + 1, POINTS_AT_ONCE):
        _sum_faces(changed[part], corners, surface, points, *sums, moments)


def _sum_faces(faces, corners, surface, points, squared, squared_z, largest_z, moments):
    n, n_channels = len(faces), surface.z.shape[1]
    a, b, c = corners[faces].T
    ax, ay = surface.x[a], surface.y[a]
    bx, by = surface.x[b] - ax, surface.y[b] - ay
    cx, cy = surface.x[c] - ax, surface.y[c] - ay
    per_area = 1.0 / (bx * cy - by * cx)
    row, place = expanded(points.start[faces], points.n_points[faces])
    px, py = points.x[place] - ax[row], points.y[place] - ay[row]
    at_b = (px * cy[row] - py * cx[row]) * per_area[row]
    at_c = (bx[row] * py - by[row] * px) * per_area[row]
    at_a = 1.0 - at_b - at_c
    z = surface.z
    errors = np.empty((len(row), n_channels))
    for i in range(n_channels):
        surface_here = at_a * z[a, i][row] + at_b * z[b, i][row] + at_c * z[c, i][row]
        errors[:, i] = surface_here - points.z[place, i]
    zero = np.zeros(n)
    squares = errors * errors
    squared[faces] = summed(np.repeat(row, n_channels), squares.ravel(), zero)
    largest = np.zeros(n)
    if len(row):
        first = np.flatnonzero(np.diff(row, prepend=-1))
        largest[row[first]] = np.maximum.reduceat(squares[:, 0], first)
    largest_z[faces] = largest
    if len(squared_z):
        squared_z[faces] = summed(row, squares[:, 0], zero)
    if len(moments.weight):
        for corner, at in enumerate((at_a, at_b, at_c)):
            moments.weight[3 * faces + corner] = 0.5 * summed(row, at * (1.0 + at), zero)
            for i in range(n_channels):
                moments.slope[3 * faces + corner, i] = summed(row, at * errors[:, i], zero)


def sum_over_stars(start, stop, mesh, vertex_lives, has_moved, surface, moments):
    v = np.flatnonzero(has_moved & vertex_lives & (mesh.outgoing >= 0))
    has_moved[:] = False
    moments.vertex_weight[v] = 1.0
    moments.vertex_slope[v] = surface.z[v] - surface.measured[v]
    half_edge = mesh.outgoing[v]
    while len(v):
        moments.vertex_weight[v] += moments.weight[half_edge]
        moments.vertex_slope[v] += moments.slope[half_edge]
        half_edge = mesh.twin[before(half_edge)]
        goes_on = (half_edge >= 0) & (half_edge != mesh.outgoing[v])
        v, half_edge = v[goes_on], half_edge[goes_on]


def update_heights(odd, indptr, columns, weights, details, locked, integrals, z, z_changed):
    n_odd = len(odd)
    row = np.repeat(np.arange(n_odd), np.diff(indptr))
    integrals[:] = summed(columns, weights * integrals[odd][row], integrals)
    free = ~locked[columns]
    share = np.where(free, integrals[columns], 0.0)
    squared = summed(row, share**2, np.zeros(n_odd))
    factor = np.divide(integrals[odd], squared, out=np.zeros(n_odd), where=squared > 0.0)
    moved = free & (squared[row] > 0.0)
    columns, row = columns[moved], row[moved]
    z_changed[columns] = True
    for i in range(z.shape[1]):
        z[:, i] = summed(columns, factor[row] * integrals[columns] * details[row, i], z[:, i])
