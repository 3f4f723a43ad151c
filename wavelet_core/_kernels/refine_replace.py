"""Kernels of :mod:`wavelet_core.refinement`: vertices that help least, places that need one."""

import numpy as np

from ._jit import inlined, kernel
from .half_edges import MAX_RING, after, before, walk_ring
from .outline import is_straight
from .refine_move import find_side
from .refine_tin import hand_over, is_wide, weighed

#: Points of a face that are tried as a vertex: those of the largest errors. One, two and eight of
#: them leave the same RMSE to 0.1 % (benchmarks/quality/constants.py).
N_INSERTIONS = 4
#: Barycentric weights below this are those of a point on an edge.
ON_EDGE = 1e-9


# needs (k, width) int32, filled: each of chosen (k,) int32, then its ring, then -1
@kernel
def list_stars(start, stop, chosen, mesh, needs):
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for row in range(start, stop):
        size, _ = walk_ring(chosen[row], mesh.origin, mesh.twin, mesh.outgoing, ring, spoke)
        needs[row, 0] = chosen[row]
        for k in range(1, needs.shape[1]):
            needs[row, k] = ring[k - 1] if k <= size else -1


# For each of chosen (k,) int32: target (k,) int32, the place in its ring that it would best be
# collapsed onto, -1 if none; cost (k,) float64, what that adds to the errors, at most bound.
# error (n_faces,) float64 as of sum_face_errors; capacity: most points of a star
@kernel
def propose_removals(
    start, stop, chosen, tin, points, objective, error, bound, capacity, with_outline, target, cost
):
    x, y, z = tin.x, tin.y, tin.z
    n_channels = z.shape[1]
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    ring_x, ring_y = np.empty(MAX_RING), np.empty(MAX_RING)
    seen_x, seen_y = np.empty(MAX_RING), np.empty(MAX_RING)
    slope_x, slope_y = np.empty((MAX_RING, n_channels)), np.empty((MAX_RING, n_channels))
    near, side = np.empty(capacity, np.int32), np.empty(capacity, np.int32)
    for row in range(start, stop):
        v = chosen[row]
        target[row], cost[row] = -1, np.inf
        if tin.mesh.outgoing[v] < 0 or tin.is_locked[v]:
            continue
        size, n_sides = walk_ring(v, tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing, ring, spoke)
        if size < 3:
            continue
        is_outline = n_sides < size
        for k in range(size):
            ring_x[k], ring_y[k] = x[ring[k]] - x[v], y[ring[k]] - y[v]
        if is_outline and not (
            with_outline and is_straight(ring_x[0], ring_y[0], ring_x[size - 1], ring_y[size - 1])
        ):
            continue
        if tin.stays[v] and not is_outline:
            continue
        present, n = 0.0, 0
        for k in range(n_sides):
            face = spoke[k] // 3
            present += error[face]
            for place in range(points.first[face], points.first[face] + points.n_points[face]):
                near[n], side[n] = points.pool[place], k
                n += 1
        limit = present + bound
        for j in range(0, size, size - 1 if is_outline else 1):
            a = ring[j]
            is_legal = True
            for t in range(size - 1):
                k = (j + 1 + t) % size
                seen_x[t], seen_y[t] = ring_x[k] - ring_x[j], ring_y[k] - ring_y[j]
            for t in range(size - 2):
                if not is_wide(0.0, 0.0, seen_x[t], seen_y[t], seen_x[t + 1], seen_y[t + 1]):
                    is_legal = False
                    break
                area = seen_x[t] * seen_y[t + 1] - seen_y[t] * seen_x[t + 1]
                b, c = ring[(j + 1 + t) % size], ring[(j + 2 + t) % size]
                for i in range(n_channels):
                    to_b, to_c = (z[b, i] - z[a, i]) / area, (z[c, i] - z[a, i]) / area
                    slope_x[t, i] = to_b * seen_y[t + 1] - to_c * seen_y[t]
                    slope_y[t, i] = to_c * seen_x[t] - to_b * seen_x[t + 1]
            if not is_legal:
                continue
            total, largest = 0.0, 0.0
            for q in range(n):
                p = near[q]
                px, py = points.x[p] - x[a], points.y[p] - y[a]
                hint = fan_place(side[q], j, size)
                t = find_side(hint, size - 1, size - 2, seen_x, seen_y, px, py)
                squared = 0.0
                for i in range(n_channels):
                    off = z[a, i] + slope_x[t, i] * px + slope_y[t, i] * py - points.z[p, i]
                    squared += off * off
                    if i == 0:
                        largest = max(largest, squared * points.strictness[p])
                total += weighed(squared, objective.is_power)
                if total >= limit or largest > objective.tolerance:
                    break
            if total < limit and largest <= objective.tolerance:
                limit = total
                target[row], cost[row] = j, total - present


# Where in the fan around ring[j] is the face over that side of the star?
@inlined
def fan_place(side, j, size):
    t = (side - j - 1) % size
    return min(t, size - 3)


# Collapse vertices whose stars have no vertex in common onto target (k,) int32, places in their
# rings. freed (k, 2) int32, filled with the faces that are gone; base (k,) int64: room in the pool
@kernel
def remove_vertices(start, stop, chosen, target, base, tin, points, capacity, freed):
    x, y = tin.x, tin.y
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    seen_x, seen_y = np.empty(MAX_RING), np.empty(MAX_RING)
    near, side = np.empty(capacity, np.int32), np.empty(capacity, np.int32)
    faces, cursor = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int64)
    for row in range(start, stop):
        v, j = chosen[row], target[row]
        size, n_sides = walk_ring(v, origin, twin, outgoing, ring, spoke)
        a = ring[j]
        for t in range(size - 1):
            k = (j + 1 + t) % size
            seen_x[t], seen_y[t] = x[ring[k]] - x[a], y[ring[k]] - y[a]
        n = 0
        for k in range(n_sides):
            face = spoke[k] // 3
            for place in range(points.first[face], points.first[face] + points.n_points[face]):
                p = points.pool[place]
                px, py = points.x[p] - x[a], points.y[p] - y[a]
                near[n] = p
                side[n] = find_side(
                    fan_place(k, j, size), size - 1, size - 2, seen_x, seen_y, px, py
                )
                n += 1
        for t in range(size - 2):
            faces[t] = spoke[(j + 1 + t) % size] // 3
        hand_over(near, side, n, faces, size - 2, base[row], cursor, points)
        # -- the faces on either side of the edge to a go, the others take a for v
        is_outline = n_sides < size
        gone_after = -1 if is_outline and j > 0 else spoke[j]
        gone_before = -1 if is_outline and j == 0 else spoke[(j - 1) % size]
        for k in range(n_sides):
            origin[spoke[k]] = a
        freed[row, 0] = freed[row, 1] = -1
        if gone_after >= 0:  # (v, a, following)
            beyond, kept = twin[after(gone_after)], spoke[(j + 1) % size]
            following = ring[(j + 1) % size]
            twin[kept] = beyond
            if beyond >= 0:
                twin[beyond] = kept
            if outgoing[following] == before(gone_after):
                outgoing[following] = after(kept)
            if outgoing[a] // 3 == gone_after // 3 or outgoing[a] // 3 == gone_before // 3:
                outgoing[a] = kept
            freed[row, 0] = gone_after // 3
        if gone_before >= 0:  # (v, preceding, a)
            beyond, kept = twin[after(gone_before)], before(spoke[(j - 2) % size])
            preceding = ring[(j - 1) % size]
            twin[kept] = beyond
            if beyond >= 0:
                twin[beyond] = kept
            if outgoing[preceding] == after(gone_before):
                outgoing[preceding] = kept
            if gone_after < 0:  # the outline now leaves a for the first of the ring
                outgoing[a] = spoke[0]
            freed[row, 1] = gone_before // 3
        outgoing[v] = -1
        for f in range(2):
            if freed[row, f] >= 0:
                face = freed[row, f]
                points.n_points[face] = 0
                for corner in range(3):
                    origin[3 * face + corner], twin[3 * face + corner] = -1, -1


# For each of faces (k,) int32: the point of its list that helps most as a vertex, or -1; the
# half-edge that it lies on, -1 inside; its height (k, c) float64; gain (k,) float64
@kernel
def propose_insertions(start, stop, faces, tin, points, objective, point, on_edge, height, gain):
    origin, twin = tin.mesh.origin, tin.mesh.twin
    n_channels = tin.z.shape[1]
    trial, trial_error = np.empty(N_INSERTIONS, np.int64), np.empty(N_INSERTIONS)
    corner, share = np.empty(3, np.int32), np.empty(3)
    at, off, pull = np.empty(3), np.empty(n_channels), np.empty(n_channels)
    own, own_off, surface = np.empty(3), np.empty(n_channels), np.empty(n_channels)
    for row in range(start, stop):
        face = faces[row]
        point[row], on_edge[row], gain[row] = -1, -1, 0.0
        for i in range(n_channels):
            height[row, i] = 0.0
        if origin[3 * face] < 0:
            continue
        n_trials = 0
        for place in range(points.first[face], points.first[face] + points.n_points[face]):
            p = points.pool[place]
            errors_at(face, p, tin, points, at, off)
            squared = 0.0
            for i in range(n_channels):
                squared += off[i] * off[i]
            if not squared > 0.0 or (
                n_trials == N_INSERTIONS and squared <= trial_error[N_INSERTIONS - 1]
            ):
                continue
            k = min(n_trials, N_INSERTIONS - 1)
            while k > 0 and squared > trial_error[k - 1]:
                trial[k], trial_error[k] = trial[k - 1], trial_error[k - 1]
                k -= 1
            trial[k], trial_error[k] = p, squared
            n_trials = min(n_trials + 1, N_INSERTIONS)
        for t in range(n_trials):
            q = trial[t]
            errors_at(face, q, tin, points, own, own_off)
            for i in range(n_channels):
                surface[i] = own_off[i] + points.z[q, i]
            for k in range(3):
                corner[k] = origin[3 * face + k]
            edge = -1
            for k in range(3):
                if own[k] <= ON_EDGE:
                    edge = 3 * face + (k + 1) % 3
            if edge >= 0 and twin[edge] < 0:
                continue
            if not splits_well(face, edge, q, tin, points):
                continue
            # hat functions of q over its face, or over the faces on both sides of its edge
            gained, squares = 0.0, 0.0
            pull[:] = 0.0
            for half in range(2):
                here = face if half == 0 else twin[edge] // 3
                if half == 1:
                    errors_at(here, q, tin, points, own, own_off)
                for k in range(3):
                    share[k] = 1.0 / own[k] if own[k] > ON_EDGE else np.inf
                for place in range(points.first[here], points.first[here] + points.n_points[here]):
                    p = points.pool[place]
                    errors_at(here, p, tin, points, at, off)
                    weight = np.inf
                    for k in range(3):
                        if share[k] < np.inf:
                            weight = min(weight, at[k] * share[k])
                    weight = max(weight, 0.0)
                    squares += weight * weight
                    if objective.is_free:
                        for i in range(n_channels):
                            pull[i] += weight * off[i]
                        continue
                    before_it, after_it = 0.0, 0.0
                    for i in range(n_channels):
                        before_it += off[i] * off[i]
                        changed = off[i] - weight * (surface[i] - points.z[q, i])
                        after_it += changed * changed
                    gained += weighed(before_it, objective.is_power) - weighed(
                        after_it, objective.is_power
                    )
                if edge < 0:
                    break
            if objective.is_free:
                gained = 0.0
                for i in range(n_channels):
                    gained += pull[i] * (pull[i] / squares)
            if gained > gain[row]:
                point[row], on_edge[row], gain[row] = q, edge, gained
                for i in range(n_channels):
                    height[row, i] = points.z[q, i]
                    if objective.is_free:
                        height[row, i] = surface[i] - pull[i] / squares


# Barycentric weights of a point in a face, and how far the face is above it in each channel
@inlined
def errors_at(face, p, tin, points, at, off):
    x, y, z = tin.x, tin.y, tin.z
    a, b, c = (
        tin.mesh.origin[3 * face],
        tin.mesh.origin[3 * face + 1],
        tin.mesh.origin[3 * face + 2],
    )
    bx, by, cx, cy = x[b] - x[a], y[b] - y[a], x[c] - x[a], y[c] - y[a]
    px, py = points.x[p] - x[a], points.y[p] - y[a]
    area = bx * cy - by * cx
    at[1], at[2] = (px * cy - py * cx) / area, (bx * py - by * px) / area
    at[0] = 1.0 - at[1] - at[2]
    for i in range(z.shape[1]):
        off[i] = z[a, i] + at[1] * (z[b, i] - z[a, i]) + at[2] * (z[c, i] - z[a, i])
        off[i] -= points.z[p, i]


# Are the parts wide enough that a point makes of a face, or of the faces beside an edge?
@inlined
def splits_well(face, edge, q, tin, points):
    x, y, origin, twin = tin.x, tin.y, tin.mesh.origin, tin.mesh.twin
    qx, qy = points.x[q], points.y[q]
    for half in range(2):
        here = face if half == 0 else twin[edge] // 3
        for k in range(3):
            half_edge = 3 * here + k
            if half_edge == edge or (half == 1 and half_edge == twin[edge]):
                continue
            u, w = origin[half_edge], origin[3 * here + (k + 1) % 3]
            if not is_wide(qx, qy, x[u], y[u], x[w], y[w]):
                return False
        if edge < 0:
            break
    return True


# needs (k, 4) int32, filled: the corners of each face, and the one beyond the edge, or -1
@kernel
def list_corners(start, stop, faces, on_edge, mesh, needs):
    for row in range(start, stop):
        for k in range(3):
            needs[row, k] = mesh.origin[3 * faces[row] + k]
        needs[row, 3] = -1
        if on_edge[row] >= 0:
            needs[row, 3] = mesh.origin[before(mesh.twin[on_edge[row]])]


# Insert points in faces that have no vertex in common. vertex (k,) int32, face (k, 2) int32: free
# slots; base (k,) int64: room in the pool
@kernel
def insert_vertices(
    start, stop, faces, on_edge, point, height, vertex, free, base, tin, points, capacity
):
    x, y, z = tin.x, tin.y, tin.z
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    near, side = np.empty(capacity, np.int32), np.empty(capacity, np.int32)
    cursor = np.empty(4, np.int64)
    rim, beyond, slot = np.empty(4, np.int32), np.empty(4, np.int32), np.empty(4, np.int32)
    seen_x, seen_y = np.empty(4), np.empty(4)
    for row in range(start, stop):
        v, face, edge = vertex[row], faces[row], on_edge[row]
        x[v], y[v] = points.x[point[row]], points.y[point[row]]
        for i in range(z.shape[1]):
            z[v, i] = height[row, i]
        tin.point[v], tin.stays[v], tin.is_locked[v] = point[row], False, False
        # -- the rim, counter-clockwise, and what lies beyond it
        second = -1
        if edge < 0:
            size = 3
            for k in range(3):
                rim[k], beyond[k] = origin[3 * face + k], twin[3 * face + k]
            slot[0], slot[1], slot[2] = face, free[row, 0], free[row, 1]
        else:
            size, other = 4, twin[edge]
            second = other // 3
            rim[0], rim[1] = origin[after(edge)], origin[before(edge)]
            rim[2], rim[3] = origin[after(other)], origin[before(other)]
            beyond[0], beyond[1] = twin[after(edge)], twin[before(edge)]
            beyond[2], beyond[3] = twin[after(other)], twin[before(other)]
            slot[0], slot[1], slot[2], slot[3] = face, free[row, 0], second, free[row, 1]
        for k in range(size):
            seen_x[k], seen_y[k] = x[rim[k]] - x[v], y[rim[k]] - y[v]
        n = 0
        for half in range(2):
            here = face if half == 0 else second
            if here < 0:
                continue
            for place in range(points.first[here], points.first[here] + points.n_points[here]):
                p = points.pool[place]
                px, py = points.x[p] - x[v], points.y[p] - y[v]
                near[n], side[n] = p, find_side(0, size, size, seen_x, seen_y, px, py)
                n += 1
        hand_over(near, side, n, slot, size, base[row], cursor, points)
        # -- faces (rim[k], rim[k + 1], v)
        for k in range(size):
            f, following = 3 * slot[k], (k + 1) % size
            origin[f], origin[f + 1], origin[f + 2] = rim[k], rim[following], v
            twin[f] = beyond[k]
            twin[f + 1] = 3 * slot[following] + 2
            twin[f + 2] = 3 * slot[(k - 1) % size] + 1
            if beyond[k] >= 0:
                twin[beyond[k]] = f
        for k in range(size):
            # a vertex of the outline keeps naming the half-edge without a twin, which is on the rim
            if outgoing[rim[k]] // 3 == face or outgoing[rim[k]] // 3 == second:
                outgoing[rim[k]] = 3 * slot[k]
        outgoing[v] = 3 * slot[0] + 2
