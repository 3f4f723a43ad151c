"""Kernels of :mod:`wavelet_core.surface`: what each collapse would cost, and which are taken."""

import numpy as np

from ._jit import njit
from .half_edges import MAX_RING, collapse, meets_link_condition, walk_ring
from .surface_points import locate

# new faces thinner than this part of their longest edge squared are refused
FLATNESS_TOLERANCE = 1e-9
# an outline vertex is collinear with its outline neighbours below this, relative likewise
COLLINEAR_TOLERANCE = 1e-9
LEAST_SQUARES = 0
LARGEST = 1
# share of the largest error that the sum of squares may add to it, to tell equal ones apart
TIE_SHARE = 1e-3


# The fan around ring[j] over the rest of the ring: bx, by (size - 1,) float64 from ring[j] on,
# filled. False if one of its faces is flipped or flat.
@njit
def lay_fan(j, size, rx, ry, bx, by):
    k = j
    for t in range(size - 1):
        k = k + 1 if k + 1 < size else 0
        bx[t], by[t] = rx[k] - rx[j], ry[k] - ry[j]
    for t in range(size - 2):
        ex, ey = bx[t + 1] - bx[t], by[t + 1] - by[t]
        longest = max(
            bx[t] * bx[t] + by[t] * by[t],
            bx[t + 1] * bx[t + 1] + by[t + 1] * by[t + 1],
            ex * ex + ey * ey,
        )
        if bx[t] * by[t + 1] - by[t] * bx[t + 1] <= FLATNESS_TOLERANCE * longest:
            return False
    return True


# Gradients of the faces of that fan: gx, gy (size - 2, c) float64, filled; rz (size, c)
@njit
def tilt_fan(j, size, bx, by, rz, gx, gy):
    k = j + 1 if j + 1 < size else 0
    for t in range(size - 2):
        following = k + 1 if k + 1 < size else 0
        per_area = 1.0 / (bx[t] * by[t + 1] - by[t] * bx[t + 1])
        for i in range(rz.shape[1]):
            to_b, to_c = rz[k, i] - rz[j, i], rz[following, i] - rz[j, i]
            gx[t, i] = (to_b * by[t + 1] - to_c * by[t]) * per_area
            gy[t, i] = (to_c * bx[t] - to_b * bx[t + 1]) * per_area
        k = following


# Sum of squared errors of the points of a star under such a fan, and the largest one of heights
# and of all channels; `bound` on the sum (or, for LARGEST, on the largest) ends it early.
@njit
def fan_error(
    j, size, n_sides, spoke, points, ax, ay, rz, bx, by, gx, gy, norm, bound, squared, largest
):
    n_channels = rz.shape[1]
    largest_z = 0.0
    for k in range(n_sides):
        face = spoke[k] // 3
        n_here = points.count[face]
        if n_here == 0:
            continue
        hint = k - j - 1
        if hint < 0:
            hint += size
        hint = 0 if hint == size - 1 else min(hint, size - 3)
        first = points.start[face]
        for p in range(first, first + n_here):
            x, y = points.x[p] - ax, points.y[p] - ay
            t = locate(size - 2, bx, by, x, y, hint)
            here = 0.0
            for i in range(n_channels):
                error = rz[j, i] + gx[t, i] * x + gy[t, i] * y - points.z[p, i]
                here += error * error
                if i == 0:
                    largest_z = max(largest_z, error * error)
            squared += here
            largest = max(largest, here)
        if (squared if norm == LEAST_SQUARES else largest) > bound:
            break
    return squared, largest, largest_z


# The cost of the best legal collapse of each vertex of todo (k,) int32, and its target.
#
# mesh, surface, points: HalfEdges, Surface, FacePoints; locked, stays (n,) bool
# squared (m,) float64; slope (3 m, c), weight (3 m,), vertex_slope (n, c), vertex_weight (n,):
# as summed by sum_over_faces and sum_over_stars, empty if there is no update
# integrals (n,) float64; tolerance: of squared height errors; cutoff: costs above need not be exact
# cost (n,) float64, target (n,) int32, is_stale (n,) bool: filled
@njit
def collapse_costs(
    start, stop, todo, mesh, surface, points, stays, locked, squared, slope, weight, vertex_slope,
    vertex_weight, integrals, norm, tolerance, cutoff, cost, target, is_stale,
):  # fmt: skip
    n_channels = surface.z.shape[1]
    with_update = weight.shape[0] > 0
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    rx, ry, rz = np.empty(MAX_RING), np.empty(MAX_RING), np.empty((MAX_RING, n_channels))
    bx, by = np.empty(MAX_RING), np.empty(MAX_RING)
    gx, gy = np.empty((MAX_RING, n_channels)), np.empty((MAX_RING, n_channels))
    own, length = np.empty(MAX_RING), np.empty(MAX_RING)
    order = np.empty(MAX_RING, np.int32)
    at = np.empty(3)
    corner = np.empty(3, np.int32)
    detail = np.empty(n_channels)
    for q in range(start, stop):
        v = todo[q]
        is_stale[v] = False
        cost[v], target[v] = np.inf, -1
        if stays[v]:
            continue
        size, n_sides = walk_ring(v, mesh, ring, spoke)
        if size < 3:
            continue
        is_enclosed = True  # no neighbour may take a share of the detail
        for k in range(size):
            is_enclosed = is_enclosed and locked[ring[k]]
        if is_enclosed:
            continue
        vx, vy = surface.x[v], surface.y[v]
        for k in range(size):
            rx[k], ry[k] = surface.x[ring[k]] - vx, surface.y[ring[k]] - vy
            for i in range(n_channels):
                rz[k, i] = surface.z[ring[k], i]
        step = 1
        if n_sides < size:
            if not is_straight(rx[0], ry[0], rx[size - 1], ry[size - 1]):
                continue
            step = size - 1

        # each legal target, and the error that v itself would have: a bound on all
        n_legal = 0
        n_points = 0
        before_it = 0.0
        for k in range(n_sides):
            n_points += points.count[spoke[k] // 3]
            before_it += squared[spoke[k] // 3]
        for i in range(n_channels):
            before_it += (surface.z[v, i] - surface.measured[v, i]) ** 2
        for j in range(0, size, step):
            if not lay_fan(j, size, rx, ry, bx, by):
                continue
            t = locate(size - 2, bx, by, -rx[j], -ry[j], 0)
            b = (j + 1 + t) % size
            c = (j + 2 + t) % size
            per_area = 1.0 / (bx[t] * by[t + 1] - by[t] * bx[t + 1])
            at_b = (ry[j] * bx[t + 1] - rx[j] * by[t + 1]) * per_area
            at_c = (by[t] * rx[j] - bx[t] * ry[j]) * per_area
            at_a = 1.0 - at_b - at_c
            here = 0.0
            for i in range(n_channels):
                error = at_a * rz[j, i] + at_b * rz[b, i] + at_c * rz[c, i] - surface.measured[v, i]
                here += error * error
                if i == 0 and error * error > tolerance:
                    here = np.inf
            if here == np.inf:
                continue
            own[j], length[j] = here, rx[j] * rx[j] + ry[j] * ry[j]
            k = n_legal
            while k > 0 and (
                own[order[k - 1]] > here
                or (own[order[k - 1]] == here and length[order[k - 1]] > length[j])
            ):
                order[k] = order[k - 1]
                k -= 1
            order[k] = j
            n_legal += 1

        # the target that leaves the least error in the star
        bound = cutoff + before_it if norm == LEAST_SQUARES else cutoff
        best, best_j = bound, -1
        is_cut = False
        for k in range(n_legal):
            j = order[k]
            if own[j] >= best:
                is_cut = True
                break
            total, largest, largest_z = own[j], own[j], 0.0
            if n_points > 0:
                lay_fan(j, size, rx, ry, bx, by)
                tilt_fan(j, size, bx, by, rz, gx, gy)
                total, largest, largest_z = fan_error(
                    j, size, n_sides, spoke, points, vx + rx[j], vy + ry[j], rz, bx, by, gx, gy,
                    norm, best, total, largest,
                )  # fmt: skip
            if norm == LARGEST:
                total = largest * (1.0 + TIE_SHARE * (1.0 - largest / max(total, 1e-300)))
            if total >= best:
                is_cut = True
            elif largest_z <= tolerance:
                best, best_j = total, j
        if best_j < 0:
            if is_cut and cutoff < np.inf:
                cost[v] = cutoff
                is_stale[v] = True  # a lower bound only
            continue
        j = best_j
        target[v] = ring[j]
        if norm == LARGEST:
            cost[v] = best
            continue
        cost[v] = best - before_it
        if not with_update:
            continue

        # the same once the update has shared out the detail
        lay_fan(j, size, rx, ry, bx, by)
        t = locate(size - 2, bx, by, -rx[j], -ry[j], 0)
        corner[0], corner[1], corner[2] = j, (j + 1 + t) % size, (j + 2 + t) % size
        per_area = 1.0 / (bx[t] * by[t + 1] - by[t] * bx[t + 1])
        at[1] = (ry[j] * bx[t + 1] - rx[j] * by[t + 1]) * per_area
        at[2] = (by[t] * rx[j] - bx[t] * ry[j]) * per_area
        at[0] = 1.0 - at[1] - at[2]
        for i in range(n_channels):
            detail[i] = surface.z[v, i]
            for k in range(3):
                detail[i] -= at[k] * rz[corner[k], i]
        norm_squared = 0.0
        for k in range(3):
            u = ring[corner[k]]
            at[k] = integrals[u] + at[k] * integrals[v]
            if locked[u]:
                at[k] = 0.0
            norm_squared += at[k] * at[k]
        if norm_squared <= 0.0:
            continue
        total = 0.0
        for k in range(3):
            share = at[k] * integrals[v] / norm_squared
            u = ring[corner[k]]
            outside = vertex_weight[u]
            inner, outer = star_corners(corner[k], size, n_sides, spoke)
            if inner >= 0:
                outside -= weight[inner]
            if outer >= 0:
                outside -= weight[outer]
            for i in range(n_channels):
                shift = share * detail[i]
                steepness = vertex_slope[u, i]
                if inner >= 0:
                    steepness -= slope[inner, i]
                if outer >= 0:
                    steepness -= slope[outer, i]
                total += (2.0 * steepness + outside * shift) * shift
                rz[corner[k], i] += shift
        here = 0.0
        tilt_fan(j, size, bx, by, rz, gx, gy)
        for i in range(n_channels):
            error = rz[j, i] - gx[t, i] * rx[j] - gy[t, i] * ry[j] - surface.measured[v, i]
            here += error * error
        if n_points > 0:
            here = fan_error(
                j, size, n_sides, spoke, points, vx + rx[j], vy + ry[j], rz, bx, by, gx, gy,
                norm, np.inf, here, here,
            )[0]  # fmt: skip
        cost[v] = total + here - before_it


# Half-edges that leave ring[k] in the faces of the star before and after it; -1 where none
@njit
def star_corners(k, size, n_sides, spoke):
    following, preceding = -1, -1
    if k < n_sides:
        following = spoke[k] + 1 if spoke[k] % 3 < 2 else spoke[k] - 2
    last = k - 1 if k > 0 else size - 1
    if last < n_sides:
        preceding = spoke[last] - 1 if spoke[last] % 3 > 0 else spoke[last] + 2
    return following, preceding


# Does the outline run straight through the origin, from p to q?
@njit
def is_straight(px, py, qx, qy):
    dx, dy = qx - px, qy - py
    return (
        abs(px * qy - py * qx) <= COLLINEAR_TOLERANCE * (dx * dx + dy * dy)
        and px * qx + py * qy < 0.0
    )


CANDIDATE = 1
TAKEN = 2


# Which of the candidates still in question are cheaper than all such neighbours?
# active (k,) int32; state (n,) int8; cost (n,) float64; key (n,) uint32; wins (k,) bool, filled
@njit
def find_cheapest(start, stop, active, mesh, state, cost, key, wins):
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for q in range(start, stop):
        v = active[q]
        wins[q] = False
        if state[v] != CANDIDATE:
            continue
        wins[q] = True
        size, _ = walk_ring(v, mesh, ring, spoke)
        for k in range(size):
            u = ring[k]
            if state[u] == CANDIDATE and (
                cost[u] < cost[v] or (cost[u] == cost[v] and key[u] < key[v])
            ):
                wins[q] = False
                break


# Take the winners, rule their neighbours out
@njit
def take_cheapest(start, stop, active, wins, mesh, state):
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for q in range(start, stop):
        if not wins[q]:
            continue
        size, _ = walk_ring(active[q], mesh, ring, spoke)
        for k in range(size):
            state[ring[k]] = 0
        state[active[q]] = TAKEN


# size (n_odd,) int64, filled
@njit
def measure_rings(start, stop, odd, mesh, size):
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for row in range(start, stop):
        size[row] = walk_ring(odd[row], mesh, ring, spoke)[0]


# ring, ring_faces (indptr[-1],) int32, filled: from the target on, NO_INDEX where no face follows
@njit
def record_rings(start, stop, odd, target, mesh, indptr, ring, ring_faces):
    around, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for row in range(start, stop):
        size, n_sides = walk_ring(odd[row], mesh, around, spoke)
        j = 0
        while around[j] != target[row]:
            j += 1
        for k in range(indptr[row], indptr[row + 1]):
            ring[k] = around[j]
            ring_faces[k] = spoke[j] // 3 if j < n_sides else -1
            j = j + 1 if j + 1 < size else 0


# Collapse all that the link condition allows, also against the edges made just before.
# is_taken (n_odd,) bool, filled; stamp (n,) int32, zeros
@njit
def collapse_all(odd, indptr, ring, ring_faces, mesh, vertex_lives, face_lives, stamp, is_taken):
    for row in range(odd.shape[0]):
        base, end = indptr[row], indptr[row + 1]
        size = end - base
        n_sides = 0
        for k in range(base, end):
            if ring_faces[k] >= 0:
                n_sides += 1
        is_taken[row] = meets_link_condition(
            ring[base], ring[base:end], size, n_sides, mesh, stamp, row + 1
        )
        if is_taken[row]:
            collapse(odd[row], ring[base:end], ring_faces[base:end], size, mesh, face_lives)
            vertex_lives[odd[row]] = False
