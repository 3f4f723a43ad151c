"""Kernels of :mod:`wavelet_core.partition.error_guided`: the face of each point, how far off."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._jit import inlined, kernel
from .half_edges import MAX_RING, before
from .outline import cuts_off, nearest_on_edge


class Surface(NamedTuple):
    """The vertices of a level.

    x, y : (n,) float64, plan coordinates about a local origin
    z : (n, c) float64, present heights and weighted attributes
    measured : (n, c) float64, the same as they were in the input
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]
    measured: NDArray[np.float64]


class Moments(NamedTuple):
    """Sums of error times hat function, and of how stiff the sum of squares is to a shift.

    slope : (3 n_faces, c) float32, weight : (3 n_faces,) float32, of the corners of the faces
    vertex_slope : (n, c) float64, vertex_weight : (n,) float64, over the stars
    """

    slope: NDArray[np.float32]
    weight: NDArray[np.float32]
    vertex_slope: NDArray[np.float64]
    vertex_weight: NDArray[np.float64]


class FacePoints(NamedTuple):
    """The removed vertices, face by face: ``n_points[f]`` of them from ``start[f]`` on.

    start, n_points : (n_faces,) int32
    x, y : (capacity,) float64; z : (capacity, c) float64
    """

    start: NDArray[np.int32]
    n_points: NDArray[np.int32]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]


# Which face of the fan (a, b[t], b[t + 1]), t < n_wedges, holds the point at (x, y) from a?
# fan_xy (2, n_wedges + 1) float64: b from a, counter-clockwise; hint: where to look first
@inlined
def locate(n_wedges, fan_xy, x, y, hint):
    t = hint
    while t > 0 and fan_xy[0, t] * y - fan_xy[1, t] * x < 0.0:
        t -= 1
    if t == hint:
        while t < n_wedges - 1 and fan_xy[0, t + 1] * y - fan_xy[1, t + 1] * x > 0.0:
            t += 1
    if is_in_wedge(t, fan_xy, x, y):
        return t
    for s in range(n_wedges):  # a fan of more than half a turn misleads the search
        if is_in_wedge(s, fan_xy, x, y):
            return s
    return t


@inlined
def is_in_wedge(t, fan_xy, x, y):
    return (
        fan_xy[0, t] * y - fan_xy[1, t] * x >= 0.0
        and fan_xy[0, t + 1] * y - fan_xy[1, t + 1] * x <= 0.0
    )


# rings in CSR: indptr (n_odd + 1,) int64; ring_faces int32; size (n_odd,) int64, filled with the
# number of points that each collapse moves, its own vertex included
@kernel
def count_points(start, stop, indptr, ring_faces, points, size):
    n_points = points.n_points
    for row in range(start, stop):
        size[row] = 1
        for k in range(indptr[row], indptr[row + 1]):
            if ring_faces[k] >= 0:
                size[row] += n_points[ring_faces[k]]


# Lay the ring of a collapsed vertex, from its target on, as a fan around that target.
# fan_xy (2, MAX_RING) float64, filled. Returns whether the new outline edge cuts v off, the ends of
# that edge as seen from the target, and the share of it at which v is judged.
@inlined
def lay_new_fan(v, base, size, ring, ring_faces, x, y, squared_tolerance, fan_xy):
    a = ring[base]
    for t in range(size - 1):
        fan_xy[0, t] = x[ring[base + 1 + t]] - x[a]
        fan_xy[1, t] = y[ring[base + 1 + t]] - y[a]
    ends_at_target = ring_faces[base] < 0
    if not (ends_at_target or ring_faces[base + size - 1] < 0):
        return False, 0.0, 0.0, 0.0, 0.0, 0.0
    p = ring[base + 1] if ends_at_target else a
    q = a if ends_at_target else ring[base + size - 1]
    px, py, qx, qy = x[p] - x[v], y[p] - y[v], x[q] - x[v], y[q] - y[v]
    if not cuts_off(px, py, qx, qy, squared_tolerance):
        return False, 0.0, 0.0, 0.0, 0.0, 0.0
    along = nearest_on_edge(0.0, 0.0, px, py, qx, qy)[2]
    return True, x[p] - x[a], y[p] - y[a], x[q] - x[a], y[q] - y[a], along


# The wedge of the fan that holds the removed vertex, seen from the target at (x, y), and the
# weights of the wedge's two outer corners
@inlined
def weights_in_fan(n_wedges, fan_xy, x, y):
    t = locate(n_wedges, fan_xy, x, y, 0)
    bx, by, cx, cy = fan_xy[0, t], fan_xy[1, t], fan_xy[0, t + 1], fan_xy[1, t + 1]
    doubled_area = bx * cy - by * cx
    at_b = max((x * cy - y * cx) / doubled_area, 0.0)
    at_c = max((bx * y - by * x) / doubled_area, 0.0)
    total = max(at_b + at_c, 1.0)
    return t, at_b / total, at_c / total


# Move the points of each collapsed star, and its vertex, to the faces that now cover it; those that
# a new outline edge leaves outside, to the nearest place of that edge.
# odd (n_odd,) int32; ring, ring_faces int32 from the target on; first (n_odd + 1,) int64, where
# the points go; corners (n_odd, 3) int32, weights (n_odd, 3), details (n_odd, c) float64, filled
@kernel
def hand_over(
    start, stop, odd, indptr, ring, ring_faces, surface, points, first, face_changed,
    squared_tolerance, corners, weights, details,
):  # fmt: skip
    vertex_x, vertex_y, vertex_z, measured = surface.x, surface.y, surface.z, surface.measured
    start_of, n_points = points.start, points.n_points
    point_x, point_y, point_z = points.x, points.y, points.z
    n_channels = vertex_z.shape[1]
    fan_xy = np.empty((2, MAX_RING))
    cursor = np.empty(MAX_RING, np.int64)
    wedge = np.empty(256, np.int32)
    for row in range(start, stop):
        v, base = odd[row], indptr[row]
        size = indptr[row + 1] - base
        n_wedges = size - 2
        a = ring[base]
        ax, ay = vertex_x[a], vertex_y[a]
        if first[row + 1] - first[row] > wedge.shape[0]:
            wedge = np.empty(2 * (first[row + 1] - first[row]), np.int32)
        cursor[: size - 1] = 0
        is_cut, px, py, qx, qy, along = lay_new_fan(
            v, base, size, ring, ring_faces, vertex_x, vertex_y, squared_tolerance, fan_xy
        )

        x, y = vertex_x[v] - ax, vertex_y[v] - ay
        if not is_cut:
            t, at_b, at_c = weights_in_fan(n_wedges, fan_xy, x, y)
        elif ring_faces[base] < 0:  # the new edge ends at the target
            t, at_b, at_c = 0, 1.0 - along, 0.0
        else:
            t, at_b, at_c = n_wedges - 1, 0.0, along
        at_a = max(1.0 - at_b - at_c, 0.0)
        b, c = ring[base + 1 + t], ring[base + 2 + t]
        wedge[0] = t
        cursor[t] += 1
        corners[row, 0], corners[row, 1], corners[row, 2] = a, b, c
        weights[row, 0], weights[row, 1], weights[row, 2] = at_a, at_b, at_c
        for i in range(n_channels):
            details[row, i] = vertex_z[v, i] - (
                at_a * vertex_z[a, i] + at_b * vertex_z[b, i] + at_c * vertex_z[c, i]
            )

        n_found = 1
        for k in range(size):
            face = ring_faces[base + k]
            if face < 0:
                continue
            hint = min(max(k - 1, 0), n_wedges - 1)
            for p in range(start_of[face], start_of[face] + n_points[face]):
                x, y = point_x[p] - ax, point_y[p] - ay
                if is_cut:
                    x, y, _ = nearest_on_edge(x, y, px, py, qx, qy)
                t = locate(n_wedges, fan_xy, x, y, hint)
                wedge[n_found] = t
                cursor[t] += 1
                n_found += 1

        position = first[row]
        for t in range(n_wedges):
            n_here = cursor[t]
            cursor[t] = position
            position += n_here
        p = cursor[wedge[0]]
        cursor[wedge[0]] += 1
        point_x[p], point_y[p] = vertex_x[v], vertex_y[v]
        if is_cut:
            point_x[p], point_y[p] = ax + px + along * (qx - px), ay + py + along * (qy - py)
        for i in range(n_channels):
            point_z[p, i] = measured[v, i]
        n_found = 1
        for k in range(size):
            face = ring_faces[base + k]
            if face < 0:
                continue
            for q in range(start_of[face], start_of[face] + n_points[face]):
                t = wedge[n_found]
                n_found += 1
                p = cursor[t]
                cursor[t] += 1
                point_x[p], point_y[p] = point_x[q], point_y[q]
                if is_cut:
                    x, y, _ = nearest_on_edge(point_x[q] - ax, point_y[q] - ay, px, py, qx, qy)
                    point_x[p], point_y[p] = ax + x, ay + y
                for i in range(n_channels):
                    point_z[p, i] = point_z[q, i]

        position = first[row]
        for k in range(size):
            face = ring_faces[base + k]
            if face < 0:
                continue
            if 1 <= k <= n_wedges:
                start_of[face] = position
                n_points[face] = cursor[k - 1] - position
                position = cursor[k - 1]
                face_changed[face] = True
            else:
                n_points[face] = 0


# Copy the points of the given faces, in their order, to the front of other arrays.
# faces (n,) int32; first (n + 1,) int64, where each face's points go
@kernel
def copy_points(start, stop, faces, first, points, x, y, z):
    start_of, point_x, point_y, point_z = points.start, points.x, points.y, points.z
    for k in range(start, stop):
        p = start_of[faces[k]]
        for q in range(first[k], first[k + 1]):
            x[q], y[q] = point_x[p], point_y[p]
            for i in range(z.shape[1]):
                z[q, i] = point_z[p, i]
            p += 1


# Errors of the faces that changed, or one of whose corners moved: in faces (FaceState), and the
# moments of their corners, which are empty without update. Of vertices (VertexState), is_stale is
# set for the corners of those faces, and is_new where the faces themselves changed.
@kernel
def sum_over_faces(start, stop, mesh, surface, points, vertices, faces, moments):
    face_lives, face_changed = faces.lives, faces.changed
    squared, squared_z, largest_z = faces.squared, faces.squared_z, faces.largest_z
    z_changed, has_moved = vertices.z_changed, vertices.has_moved
    is_stale, is_new = vertices.is_stale, vertices.is_new
    origin, x, y, z = mesh.origin, surface.x, surface.y, surface.z
    start_of, n_points = points.start, points.n_points
    point_x, point_y, point_z = points.x, points.y, points.z
    n_channels = z.shape[1]
    slope, weight = moments.slope, moments.weight
    with_slopes, with_z = weight.shape[0] > 0, squared_z.shape[0] > 0
    slope_sums = np.empty((3, n_channels))
    for face in range(start, stop):
        if not face_lives[face]:
            continue
        a, b, c = origin[3 * face], origin[3 * face + 1], origin[3 * face + 2]
        if not (face_changed[face] or z_changed[a] or z_changed[b] or z_changed[c]):
            continue
        if face_changed[face]:
            face_changed[face] = False
            is_new[a], is_new[b], is_new[c] = True, True, True
        is_stale[a], is_stale[b], is_stale[c] = True, True, True
        has_moved[a], has_moved[b], has_moved[c] = True, True, True
        sum_all, sum_z, largest = 0.0, 0.0, 0.0
        weight_a, weight_b, weight_c = 0.0, 0.0, 0.0
        slope_sums[:] = 0.0
        if n_points[face] > 0:
            ax, ay = x[a], y[a]
            bx, by = x[b] - ax, y[b] - ay
            cx, cy = x[c] - ax, y[c] - ay
            per_area = 1.0 / (bx * cy - by * cx)
            for p in range(start_of[face], start_of[face] + n_points[face]):
                px, py = point_x[p] - ax, point_y[p] - ay
                at_b = (px * cy - py * cx) * per_area
                at_c = (bx * py - by * px) * per_area
                at_a = 1.0 - at_b - at_c
                for i in range(n_channels):
                    error = (at_a * z[a, i] + at_b * z[b, i] + at_c * z[c, i]) - point_z[p, i]
                    sum_all += error * error
                    if i == 0:
                        sum_z += error * error
                        largest = max(largest, error * error)
                    if with_slopes:
                        slope_sums[0, i] += at_a * error
                        slope_sums[1, i] += at_b * error
                        slope_sums[2, i] += at_c * error
                if with_slopes:
                    weight_a += at_a * (1.0 + at_a)
                    weight_b += at_b * (1.0 + at_b)
                    weight_c += at_c * (1.0 + at_c)
        squared[face], largest_z[face] = sum_all, largest
        if with_z:
            squared_z[face] = sum_z
        if with_slopes:
            weight[3 * face] = 0.5 * weight_a
            weight[3 * face + 1] = 0.5 * weight_b
            weight[3 * face + 2] = 0.5 * weight_c
            for corner in range(3):
                for i in range(n_channels):
                    slope[3 * face + corner, i] = slope_sums[corner, i]


# Moments of the star of each vertex with has_moved (n,) bool, which is reset.
@kernel
def sum_over_stars(start, stop, mesh, vertex_lives, has_moved, surface, moments):
    twin, outgoing = mesh.twin, mesh.outgoing
    z, measured = surface.z, surface.measured
    n_channels = z.shape[1]
    slope, weight = moments.slope, moments.weight
    vertex_slope, vertex_weight = moments.vertex_slope, moments.vertex_weight
    for v in range(start, stop):
        if not has_moved[v]:
            continue
        has_moved[v] = False
        if not vertex_lives[v] or outgoing[v] < 0:
            continue
        vertex_weight[v] = 1.0
        for i in range(n_channels):
            vertex_slope[v, i] = z[v, i] - measured[v, i]
        half_edge = outgoing[v]
        while half_edge >= 0:
            vertex_weight[v] += weight[half_edge]
            for i in range(n_channels):
                vertex_slope[v, i] += slope[half_edge, i]
            half_edge = twin[before(half_edge)]
            if half_edge == outgoing[v]:
                break


# The minimum-norm update of one step (Eqs. 47 and 50), in place on z (n, c) and integrals (n,).
# support in CSR: indptr (n_odd + 1,), columns int32; weights float64
@kernel
def update_heights(odd, indptr, columns, weights, details, locked, integrals, z, z_changed):
    n_channels = z.shape[1]
    for row in range(odd.shape[0]):
        for k in range(indptr[row], indptr[row + 1]):
            integrals[columns[k]] += weights[k] * integrals[odd[row]]
    for row in range(odd.shape[0]):
        squared = 0.0
        for k in range(indptr[row], indptr[row + 1]):
            if not locked[columns[k]]:
                squared += integrals[columns[k]] * integrals[columns[k]]
        if squared <= 0.0:
            continue
        factor = integrals[odd[row]] / squared
        for k in range(indptr[row], indptr[row + 1]):
            if not locked[columns[k]]:
                z_changed[columns[k]] = True
                for i in range(n_channels):
                    z[columns[k], i] += factor * integrals[columns[k]] * details[row, i]
