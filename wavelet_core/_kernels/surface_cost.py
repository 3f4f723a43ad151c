"""Kernels of :mod:`wavelet_core.partition.error_guided`: the cheapest collapse of a vertex."""

import numpy as np

from ._jit import inlined, kernel
from .half_edges import MAX_RING, walk_ring

# new faces thinner than this part of their longest edge squared are refused
FLATNESS_TOLERANCE = 1e-9
# an outline vertex is collinear with its outline neighbours below this, relative likewise
COLLINEAR_TOLERANCE = 1e-9
LEAST_SQUARES = 0
LARGEST = 1
# share of the largest error that the sum of squares may add to it, to tell equal ones apart
TIE_SHARE = 1e-3
# no face of the fan holds v (rounding on the outline)
NONE = -1

# Work on the star of one vertex v, in coordinates relative to v, uses these arrays:
#
# ring, spoke (MAX_RING,) int32: from half_edges.walk_ring; rx, ry (MAX_RING,), rz (MAX_RING, c)
# fan_x, fan_y, slope_x, slope_y: the fan of faces around one neighbour a over the rest of the ring:
#     the rest of the ring from a (MAX_RING,), and the gradients of the faces (MAX_RING, c)
# px, py (capacity,), pz (capacity, c): the points of the star
#
# They are passed one by one: as a NamedTuple each use of one would count references (measured:
# twice the time).


# May the fan around ring[j] be laid over the rest of the ring? Returns the neighbour that precedes
# the face with v in it, counter-clockwise, and the weights at v of the other two corners; or NONE.
@inlined
def cover_from(j, size, is_outline, rx, ry, diameter):
    ax, ay = rx[j], ry[j]
    k = j + 1 if j + 1 < size else 0
    before = ax * ry[k] - ay * rx[k]
    found, at_b, at_c = NONE, 0.0, 0.0
    for t in range(size - 2):
        following = k + 1 if k + 1 < size else 0
        behind = ax * ry[following] - ay * rx[following]
        area = rx[k] * ry[following] - ry[k] * rx[following] + before - behind  # doubled
        if area <= FLATNESS_TOLERANCE * diameter and is_flat(j, k, following, rx, ry, area):
            return NONE, 0.0, 0.0
        # on the outline, v may lie beside the fan by a rounding error
        begins = before >= 0.0 or (is_outline and t == 0)
        ends = behind <= 0.0 or (is_outline and t == size - 3)
        if begins and ends and found == NONE:
            found, at_b, at_c = k, max(-behind, 0.0) / area, max(before, 0.0) / area
        k, before = following, behind
    return found, at_b, at_c


# Is the face (a, b, c) with that doubled area thinner than the tolerance, or flipped?
@inlined
def is_flat(a, b, c, rx, ry, area):
    longest = max(
        (rx[b] - rx[a]) ** 2 + (ry[b] - ry[a]) ** 2,
        max(
            (rx[c] - rx[b]) ** 2 + (ry[c] - ry[b]) ** 2,
            (rx[a] - rx[c]) ** 2 + (ry[a] - ry[c]) ** 2,
        ),
    )
    return area <= FLATNESS_TOLERANCE * longest


# Lay that fan. Returns whether it spans half a turn or more.
@inlined
def lay_fan(j, size, rx, ry, rz, fan_x, fan_y, slope_x, slope_y):
    ax, ay = rx[j], ry[j]
    k = j
    for t in range(size - 1):
        k = k + 1 if k + 1 < size else 0
        fan_x[t], fan_y[t] = rx[k] - ax, ry[k] - ay
    is_wide = False
    k = j + 1 if j + 1 < size else 0
    for t in range(size - 2):
        following = k + 1 if k + 1 < size else 0
        per_area = 1.0 / (fan_x[t] * fan_y[t + 1] - fan_y[t] * fan_x[t + 1])
        if fan_x[0] * fan_y[t + 1] - fan_y[0] * fan_x[t + 1] <= 0.0:
            is_wide = True
        for i in range(rz.shape[1]):
            to_b = (rz[k, i] - rz[j, i]) * per_area
            to_c = (rz[following, i] - rz[j, i]) * per_area
            slope_x[t, i] = to_b * fan_y[t + 1] - to_c * fan_y[t]
            slope_y[t, i] = to_c * fan_x[t] - to_b * fan_x[t + 1]
        k = following
    return is_wide


# Which face of that fan holds the point at (x, y) from its centre?
@inlined
def find_wedge(n_wedges, is_wide, fan_x, fan_y, x, y):
    if is_wide:  # the side of a single ray tells nothing across half a turn
        for t in range(n_wedges):
            if fan_x[t] * y - fan_y[t] * x >= 0.0 and fan_x[t + 1] * y - fan_y[t + 1] * x <= 0.0:
                return t
    wedge = 0
    for t in range(1, n_wedges):  # without branches, which would be mispredicted
        wedge += fan_x[t] * y - fan_y[t] * x > 0.0
    return wedge


# Sum of squared errors of the points of the star under the fan around ring[j], over all channels,
# added to `squared`; the largest one, and that of heights alone. It ends early above `bound`,
# which is on the sum or on the largest.
@inlined
def fan_error(
    j, size, n_points, px, py, pz, rx, ry, rz, fan_x, fan_y, slope_x, slope_y, by_sum, bound,
    squared, largest,
):  # fmt: skip
    is_wide = lay_fan(j, size, rx, ry, rz, fan_x, fan_y, slope_x, slope_y)
    n_channels = rz.shape[1]
    largest_z = 0.0
    ax, ay = rx[j], ry[j]
    for p in range(n_points):
        x, y = px[p] - ax, py[p] - ay
        t = find_wedge(size - 2, is_wide, fan_x, fan_y, x, y)
        here = 0.0
        for i in range(n_channels):
            error = rz[j, i] + slope_x[t, i] * x + slope_y[t, i] * y - pz[p, i]
            here += error * error
            if i == 0:
                largest_z = max(largest_z, here)
        squared += here
        largest = max(largest, here)
        if (squared if by_sum else largest) > bound:
            break
    return squared, largest, largest_z


# The cost of the best legal collapse of each vertex of todo (k,) int32, and its target.
#
# mesh, surface, points: HalfEdges, Surface, FacePoints; stays, locked (n,) bool
# squared (m,) float64; moments: Moments, empty without update; integrals (n,) float64
# tolerance: of squared height errors; cutoff: costs above need not be exact
# cost (n,) float64, target (n,) int32, is_stale, is_new (n,) bool: filled. Where only heights have
# changed (not is_new), the target stays the one that it was.
@kernel
def collapse_costs(
    start, stop, todo, mesh, surface, points, stays, locked, squared, moments, integrals, norm,
    tolerance, cutoff, cost, target, is_stale, is_new,
):  # fmt: skip
    # taken apart here, since each use of a NamedTuple's array counts references
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    x, y, z, measured = surface.x, surface.y, surface.z, surface.measured
    first_point, n_points_of = points.start, points.n_points
    point_x, point_y, point_z = points.x, points.y, points.z
    slope, weight = moments.slope, moments.weight
    vertex_slope, vertex_weight = moments.vertex_slope, moments.vertex_weight
    n_channels = z.shape[1]
    with_update = weight.shape[0] > 0
    by_sum = norm == LEAST_SQUARES
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    rx, ry, rz = np.empty(MAX_RING), np.empty(MAX_RING), np.empty((MAX_RING, n_channels))
    fan_x, fan_y = np.empty(MAX_RING), np.empty(MAX_RING)
    slope_x, slope_y = np.empty((MAX_RING, n_channels)), np.empty((MAX_RING, n_channels))
    own, order = np.empty(MAX_RING), np.empty(MAX_RING, np.int32)
    cover, cover_b, cover_c = np.empty(MAX_RING, np.int64), np.empty(MAX_RING), np.empty(MAX_RING)
    detail = np.empty(n_channels)
    capacity = 256
    q = start
    while q < stop:
        px, py, pz = np.empty(capacity), np.empty(capacity), np.empty((capacity, n_channels))
        while q < stop:
            v = todo[q]
            q += 1
            keeps_target = with_update and not is_new[v] and target[v] >= 0
            known = target[v]
            is_stale[v], is_new[v] = False, False
            cost[v], target[v] = np.inf, -1
            if stays[v]:
                continue
            size, n_sides = walk_ring(v, origin, twin, outgoing, ring, spoke)
            if size < 3:
                continue
            is_enclosed = True  # no neighbour may take a share of the detail
            for k in range(size):
                is_enclosed = is_enclosed and locked[ring[k]]
            if is_enclosed:
                continue
            n_points = 0
            before_it = 0.0
            for k in range(n_sides):
                n_points += n_points_of[spoke[k] // 3]
                before_it += squared[spoke[k] // 3]
            if n_points > capacity:  # again, with more room
                is_stale[v], is_new[v], target[v] = True, not keeps_target, known
                capacity = 2 * n_points
                q -= 1
                break
            vx, vy = x[v], y[v]
            diameter = 0.0
            for k in range(size):
                u = ring[k]
                rx[k], ry[k] = x[u] - vx, y[u] - vy
                diameter = max(diameter, 4.0 * (rx[k] * rx[k] + ry[k] * ry[k]))  # squared
                for i in range(n_channels):
                    rz[k, i] = z[u, i]
            for i in range(n_channels):
                before_it += (z[v, i] - measured[v, i]) ** 2
            step = 1
            if n_sides < size:
                if not is_straight(rx[0], ry[0], rx[size - 1], ry[size - 1]):
                    continue
                step = size - 1

            # each legal target, and the error that v itself would have: a bound on all
            n_legal = 0
            for j in range(0, size, step):
                if keeps_target and ring[j] != known:
                    continue
                b, at_b, at_c = cover_from(j, size, n_sides < size, rx, ry, diameter)
                if b == NONE:
                    continue
                cover[j], cover_b[j], cover_c[j] = b, at_b, at_c
                c = b + 1 if b + 1 < size else 0
                here, here_z = 0.0, 0.0
                for i in range(n_channels):
                    error = (
                        rz[j, i] + at_b * (rz[b, i] - rz[j, i]) + at_c * (rz[c, i] - rz[j, i])
                    ) - measured[v, i]
                    here += error * error
                    if i == 0:
                        here_z = here
                if here_z > tolerance:
                    continue
                own[j] = here
                k = n_legal
                while k > 0 and comes_before(j, order[k - 1], own, rx, ry):
                    order[k] = order[k - 1]
                    k -= 1
                order[k] = j
                n_legal += 1
            if n_legal == 0:
                continue

            # the target that leaves the least error in the star
            best = cutoff + before_it if by_sum else cutoff
            j = -1
            is_cut = own[order[0]] >= best
            if n_points > 0 and (keeps_target or not is_cut):
                n_points = 0
                for k in range(n_sides):
                    face = spoke[k] // 3
                    for p in range(first_point[face], first_point[face] + n_points_of[face]):
                        px[n_points], py[n_points] = point_x[p] - vx, point_y[p] - vy
                        for i in range(n_channels):
                            pz[n_points, i] = point_z[p, i]
                        n_points += 1
            if keeps_target:
                j = order[0]
            else:
                for k in range(n_legal):
                    candidate = order[k]
                    total, largest, largest_z = own[candidate], own[candidate], 0.0
                    if total >= best:
                        break
                    if n_points > 0:
                        total, largest, largest_z = fan_error(
                            candidate, size, n_points, px, py, pz, rx, ry, rz, fan_x, fan_y,
                            slope_x, slope_y, by_sum, best, total, largest,
                        )  # fmt: skip
                    if not by_sum:
                        total = largest * (1.0 + TIE_SHARE * (1.0 - largest / max(total, 1e-300)))
                    if total >= best:
                        is_cut = True
                    elif largest_z <= tolerance:
                        best, j = total, candidate
                if j < 0:
                    if is_cut and cutoff < np.inf:
                        cost[v] = cutoff  # a lower bound only
                        is_stale[v], is_new[v] = True, True
                    continue
            target[v] = ring[j]
            if not (by_sum and with_update):
                cost[v] = best - before_it if by_sum else best
                continue

            # the same once the update has shared out the detail among the corners
            b, at_b, at_c = cover[j], cover_b[j], cover_c[j]
            c = b + 1 if b + 1 < size else 0
            at_a = 1.0 - at_b - at_c
            share_a = free_integral(ring[j], at_a, integrals[v], integrals, locked)
            share_b = free_integral(ring[b], at_b, integrals[v], integrals, locked)
            share_c = free_integral(ring[c], at_c, integrals[v], integrals, locked)
            norm_squared = share_a**2 + share_b**2 + share_c**2
            factor = integrals[v] / norm_squared if norm_squared > 0.0 else 0.0
            own_share = factor * (at_a * share_a + at_b * share_b + at_c * share_c)
            here = -before_it
            for i in range(n_channels):
                fit = at_a * rz[j, i] + at_b * rz[b, i] + at_c * rz[c, i]
                detail[i] = z[v, i] - fit
                here += (fit + own_share * detail[i] - measured[v, i]) ** 2
            for corner, share in ((j, share_a), (b, share_b), (c, share_c)):
                u = ring[corner]
                following, preceding = star_corners(corner, size, n_sides, spoke)
                stiffness = vertex_weight[u]
                if following >= 0:
                    stiffness -= weight[following]
                if preceding >= 0:
                    stiffness -= weight[preceding]
                for i in range(n_channels):
                    rate = vertex_slope[u, i]
                    if following >= 0:
                        rate -= slope[following, i]
                    if preceding >= 0:
                        rate -= slope[preceding, i]
                    shift = factor * share * detail[i]
                    here += (2.0 * rate + stiffness * shift) * shift
                    rz[corner, i] += shift
            if n_points > 0:
                here = fan_error(
                    j, size, n_points, px, py, pz, rx, ry, rz, fan_x, fan_y, slope_x, slope_y, True,
                    cutoff, here, 0.0,
                )[0]  # fmt: skip
            cost[v] = min(here, cutoff)
            is_stale[v] = here > cutoff  # a lower bound only


# Is the fan around ring[j] the better one to start with?
@inlined
def comes_before(j, other, own, rx, ry):
    if own[j] == own[other]:
        return rx[j] ** 2 + ry[j] ** 2 < rx[other] ** 2 + ry[other] ** 2
    return own[j] < own[other]


# Integral of u's scaling function on the coarser level; 0 if u takes no part in the update
@inlined
def free_integral(u, weight, integral, integrals, locked):
    return 0.0 if locked[u] else integrals[u] + weight * integral


# Half-edges that leave ring[k] in the faces of the star after and before it; -1 where none
@inlined
def star_corners(k, size, n_sides, spoke):
    following, preceding = -1, -1
    if k < n_sides:
        following = spoke[k] + 1 if spoke[k] % 3 < 2 else spoke[k] - 2
    last = k - 1 if k > 0 else size - 1
    if last < n_sides:
        preceding = spoke[last] - 1 if spoke[last] % 3 > 0 else spoke[last] + 2
    return following, preceding


# Does the outline run straight through the origin, from p to q?
@inlined
def is_straight(px, py, qx, qy):
    dx, dy = qx - px, qy - py
    return (
        abs(px * qy - py * qx) <= COLLINEAR_TOLERANCE * (dx * dx + dy * dy)
        and px * qx + py * qy < 0.0
    )
