"""Kernels of :mod:`wavelet_core.refinement`: the best place of a vertex near where it is.

While a vertex v moves by (dx, dy) and its height by dz, the error of a point in a face of its star
changes by w (dz - gx dx - gy dy) to first order: w is the weight of v at the point, (gx, gy) the
gradient of the face. Sums of w times w and of w times error over each face so give, for any
place, about what the error would be; only the most promising places are tried at all points.
"""

import numpy as np

from ._jit import inlined, kernel
from .half_edges import MAX_RING, walk_ring
from .outline import is_straight
from .refine_tin import hand_over, is_wide, weighed

#: A vertex moves only where the error of its star falls by more than this part of it. From 0 to
#: 0.001 the RMSE is the same to 0.03 %, with 0.01 0.5 % more (benchmarks/quality/constants.py).
LEAST_GAIN = 1e-4


# May a vertex of this star lie at (x, y) from where it is?
@inlined
def is_open(x, y, size, n_sides, ring_x, ring_y):
    for k in range(n_sides):
        following = k + 1 if k + 1 < size else 0
        if not is_wide(x, y, ring_x[k], ring_y[k], ring_x[following], ring_y[following]):
            return False
    return True


# Which side of the star holds a point at (x, y) from its centre? ring_x, ring_y as seen from there
@inlined
def find_side(hint, size, n_sides, ring_x, ring_y, x, y):
    k = hint
    for _ in range(n_sides):
        following = k + 1 if k + 1 < size else 0
        if (
            ring_x[k] * y - ring_y[k] * x >= 0.0
            and ring_x[following] * y - ring_y[following] * x <= 0.0
        ):
            return k
        k = k + 1 if k + 1 < n_sides else 0
    return hint


# For each of chosen (k,) int32, no two of them neighbours: to (k,) int32, the point to move onto,
# or -1 to stay; shift (k, c) float64, what to add to its heights; gain (k,) float64. capacity: most
# points of a star
@kernel
def propose_moves(start, stop, chosen, tin, points, objective, capacity, to, shift, gain):
    x, y, z = tin.x, tin.y, tin.z
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    n_channels, most = z.shape[1], objective.n_trials
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    ring_x, ring_y = np.empty(MAX_RING), np.empty(MAX_RING)
    seen_x, seen_y = np.empty(MAX_RING), np.empty(MAX_RING)
    per_area = np.empty(MAX_RING)
    ring_z = np.empty((MAX_RING, n_channels))
    near, side = np.empty(capacity, np.int32), np.empty(capacity, np.int32)
    near_x, near_y = np.empty(capacity), np.empty(capacity)
    near_z = np.empty((capacity, n_channels))
    model = np.empty((n_channels, 9))
    part = np.empty(n_channels)
    trial, trial_error = np.empty(most, np.int64), np.empty(most)
    rests, pulls, dz = np.empty(n_channels), np.empty(n_channels), np.empty(n_channels)
    for row in range(start, stop):
        v = chosen[row]
        to[row], gain[row] = -1, 0.0
        for i in range(n_channels):
            shift[row, i] = 0.0
        if outgoing[v] < 0 or tin.is_locked[v]:
            continue
        size, n_sides = walk_ring(v, origin, twin, outgoing, ring, spoke)
        if size == 0:
            continue
        for k in range(size):
            ring_x[k], ring_y[k] = x[ring[k]] - x[v], y[ring[k]] - y[v]
            for i in range(n_channels):
                ring_z[k, i] = z[ring[k], i] - z[v, i]
        # -- as it is, and the model of what a move does
        model[:] = 0.0
        present, n = 0.0, 0
        for k in range(n_sides):
            following = k + 1 if k + 1 < size else 0
            bx, by, cx, cy = ring_x[k], ring_y[k], ring_x[following], ring_y[following]
            inverse = 1.0 / (bx * cy - by * cx)
            squares = 0.0
            part[:] = 0.0
            face = spoke[k] // 3
            for place in range(points.first[face], points.first[face] + points.n_points[face]):
                p = points.pool[place]
                px, py = points.x[p] - x[v], points.y[p] - y[v]
                near[n], side[n], near_x[n], near_y[n] = p, k, px, py
                at_b, at_c = (px * cy - py * cx) * inverse, (bx * py - by * px) * inverse
                weight = 1.0 - at_b - at_c
                squared = 0.0
                for i in range(n_channels):
                    near_z[n, i] = points.z[p, i] - z[v, i]
                    off = at_b * ring_z[k, i] + at_c * ring_z[following, i] - near_z[n, i]
                    squared += off * off
                present += weighed(squared, objective.is_power)
                stress = squared * squared * squared if objective.is_power else 1.0
                squares += stress * (weight * weight)
                for i in range(n_channels):
                    off = at_b * ring_z[k, i] + at_c * ring_z[following, i] - near_z[n, i]
                    part[i] += stress * (weight * off)
                n += 1
            for i in range(n_channels):
                gx = (ring_z[k, i] * cy - ring_z[following, i] * by) * inverse
                gy = (ring_z[following, i] * bx - ring_z[k, i] * cx) * inverse
                model[i, 0] += squares
                model[i, 1] += squares * gx
                model[i, 2] += squares * gy
                model[i, 3] += squares * (gx * gx)
                model[i, 4] += squares * (gx * gy)
                model[i, 5] += squares * (gy * gy)
                model[i, 6] += part[i]
                model[i, 7] += part[i] * gx
                model[i, 8] += part[i] * gy
        if n == 0 or not present > 0.0:
            continue
        best = present
        if objective.is_free and model[0, 0] > 0.0:
            for i in range(n_channels):
                shift[row, i] = -(model[i, 6] / model[i, 0])
                best -= model[i, 6] * (model[i, 6] / model[i, 0])
        gain[row] = present - best
        if tin.stays[v]:
            continue
        is_outline = n_sides < size
        if is_outline and not is_straight(ring_x[0], ring_y[0], ring_x[size - 1], ring_y[size - 1]):
            continue
        # -- the most promising places
        n_trials = 0
        for q in range(n):
            dx, dy = near_x[q], near_y[q]
            distance = dx * dx + dy * dy
            if distance > objective.reach or near[q] == tin.point[v]:
                continue
            if is_outline and not is_straight(
                ring_x[0] - dx, ring_y[0] - dy, ring_x[size - 1] - dx, ring_y[size - 1] - dy
            ):
                continue
            expected = 0.0
            for i in range(n_channels):
                m = model[i]
                pull = m[1] * dx + m[2] * dy - m[6]
                expected += m[3] * dx * dx + 2.0 * (m[4] * dx * dy) + m[5] * dy * dy
                expected -= 2.0 * (m[7] * dx + m[8] * dy)
                if objective.is_free:
                    expected -= pull * (pull / m[0]) if m[0] > 0.0 else 0.0
                else:
                    expected += near_z[q, i] * (m[0] * near_z[q, i] - 2.0 * pull)
            if n_trials == most and expected >= trial_error[most - 1]:
                continue
            if not is_open(dx, dy, size, n_sides, ring_x, ring_y):
                continue
            k = min(n_trials, most - 1)
            while k > 0 and expected < trial_error[k - 1]:
                trial[k], trial_error[k] = trial[k - 1], trial_error[k - 1]
                k -= 1
            trial[k], trial_error[k] = q, expected
            n_trials = min(n_trials + 1, most)
        # -- tried at all points
        threshold = best - LEAST_GAIN * present
        for t in range(n_trials):
            q = trial[t]
            ux, uy = near_x[q], near_y[q]
            for k in range(size):
                seen_x[k], seen_y[k] = ring_x[k] - ux, ring_y[k] - uy
            for k in range(n_sides):
                following = k + 1 if k + 1 < size else 0
                area = seen_x[k] * seen_y[following] - seen_y[k] * seen_x[following]
                per_area[k] = 1.0 / area
            total, squares, largest = 0.0, 0.0, 0.0
            rests[:] = 0.0
            pulls[:] = 0.0
            for p in range(n):
                px, py = near_x[p] - ux, near_y[p] - uy
                k = find_side(side[p], size, n_sides, seen_x, seen_y, px, py)
                following = k + 1 if k + 1 < size else 0
                at_b = (px * seen_y[following] - py * seen_x[following]) * per_area[k]
                at_c = (seen_x[k] * py - seen_y[k] * px) * per_area[k]
                weight = 1.0 - at_b - at_c
                squares += weight * weight
                squared = 0.0
                for i in range(n_channels):
                    off = at_b * ring_z[k, i] + at_c * ring_z[following, i] - near_z[p, i]
                    if objective.is_free:
                        rests[i] += off * off
                        pulls[i] += weight * off
                    else:
                        off += weight * near_z[q, i]
                        squared += off * off
                        if i == 0:
                            largest = max(largest, squared * points.strictness[near[p]])
                total += weighed(squared, objective.is_power)
            for i in range(n_channels):
                dz[i] = near_z[q, i]
                if objective.is_free:
                    dz[i] = -(pulls[i] / squares)
                    total += rests[i] - pulls[i] * (pulls[i] / squares)
            if total < threshold and largest <= objective.tolerance:
                threshold, to[row], gain[row] = total, near[q], present - total
                for i in range(n_channels):
                    shift[row, i] = dz[i]


# Move vertices (k,) int32 onto the points to (k,), and hand the points of their stars over.
# base (k,) int64, where in the pool there is room for them
@kernel
def move_vertices(start, stop, chosen, to, shift, base, tin, points, capacity):
    x, y, z = tin.x, tin.y, tin.z
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    seen_x, seen_y = np.empty(MAX_RING), np.empty(MAX_RING)
    near, side = np.empty(capacity, np.int32), np.empty(capacity, np.int32)
    faces, cursor = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int64)
    for row in range(start, stop):
        v = chosen[row]
        for i in range(z.shape[1]):
            z[v, i] += shift[row, i]
        if to[row] < 0:
            continue
        size, n_sides = walk_ring(v, tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing, ring, spoke)
        tin.point[v] = to[row]
        x[v], y[v] = points.x[to[row]], points.y[to[row]]
        for k in range(size):
            seen_x[k], seen_y[k] = x[ring[k]] - x[v], y[ring[k]] - y[v]
        n = 0
        for k in range(n_sides):
            faces[k] = face = spoke[k] // 3
            for place in range(points.first[face], points.first[face] + points.n_points[face]):
                p = points.pool[place]
                px, py = points.x[p] - x[v], points.y[p] - y[v]
                near[n], side[n] = p, find_side(k, size, n_sides, seen_x, seen_y, px, py)
                n += 1
        hand_over(near, side, n, faces, n_sides, base[row], cursor, points)
