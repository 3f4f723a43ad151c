"""Kernels of :mod:`wavelet_core.partition.error_guided`: the cheapest collapse of a vertex.

The cost of a vertex is worked out in the order of the functions below: the outline rule, the legal
targets, the error of the star under the fan of each target, and what the update does to it. Work
on the star of one vertex v is done in coordinates relative to v, in these arrays:

- ring, spoke (MAX_RING,) int32: from half_edges.walk_ring
- ring_x, ring_y (MAX_RING,), ring_z (MAX_RING, c) float64: where the ring lies
- near_x, near_y (capacity,), near_z (capacity, c) float64: the points of the star
- fan_x, fan_y (MAX_RING,), slope_x, slope_y (MAX_RING, c) float64: the fan of faces around one
  neighbour over the rest of the ring: that rest, from the neighbour, and the gradients of the faces
- order (MAX_RING,) int32: positions in the ring of the legal targets, the most promising first
- cover (MAX_RING,) int64, cover_weights (2, MAX_RING): where v lies in the fan of each target

They are passed one by one: as a NamedTuple each use of one would count references (measured:
twice the time).
"""

import math
from typing import NamedTuple

import numpy as np

from ._jit import inlined, kernel
from .half_edges import MAX_RING, meets_link_condition, walk_ring
from .lattice import on_lattice
from .outline import CUTS, FLATNESS_TOLERANCE, STAYS, nearest_on_edge, outline_rule

LEAST_SQUARES = 0
LARGEST = 1
# With the largest error as the norm, the mean square ranks targets of the same largest error
# apart: it may add this share of the largest error. From none to a thousandth makes no difference
# above 0.1 % on five DEMs, a tenth is 2 % worse: it only decides where errors are equal.
TIE_SHARE = 1e-3
# Costs closer to each other than this part of the sum of squares that they are differences of are
# equal: some 1e5 times what rounding leaves, so that equal costs seldom fall on either side of a
# step (see docs/topics/surface.md).
RELATIVE_STEP = 2.0**-34
# The same for sums that single-precision moments enter.
MOMENT_STEP = 2.0**-20
# no face of the fan holds v (rounding on the outline)
NONE = -1


class Limits(NamedTuple):
    """By what, and up to what, collapses are judged.

    norm : int, LEAST_SQUARES or LARGEST
    tolerance : float, the largest squared height error that is legal
    cutoff : float, costs above need not be exact
    height_step : float, differences of heights below are rounding
    """

    norm: int
    tolerance: float
    cutoff: float
    height_step: float


# How far two sums over n points may lie apart by rounding alone, where they are about `squared`
@inlined
def step_of(n, squared, height_step):
    return height_step * (2.0 * math.sqrt(n * squared) + n * height_step) + RELATIVE_STEP * squared


# Put the ring of v in place. Returns the square of twice its radius.
@inlined
def place_ring(v, size, ring, x, y, z, ring_x, ring_y, ring_z):
    diameter = 0.0
    vx, vy = x[v], y[v]
    for k in range(size):
        u = ring[k]
        rx, ry = x[u] - vx, y[u] - vy
        ring_x[k], ring_y[k] = rx, ry
        diameter = max(diameter, 4.0 * (rx * rx + ry * ry))
        for i in range(z.shape[1]):
            ring_z[k, i] = z[u, i]
    return diameter


# Are all neighbours locked, so that none could take a share of the detail?
@inlined
def is_enclosed(size, ring, locked):
    for k in range(size):  # noqa: SIM110 (numba compiles no generators)
        if not locked[ring[k]]:
            return False
    return True


# May the fan around ring[j] be laid over the rest of the ring? Returns the neighbour that precedes
# the face with v in it, counter-clockwise, and the weights at v of the other two corners; or NONE.
@inlined
def cover_from(j, size, is_outline, ring_x, ring_y, diameter):
    ax, ay = ring_x[j], ring_y[j]
    k = j + 1 if j + 1 < size else 0
    before = ax * ring_y[k] - ay * ring_x[k]
    found, at_b, at_c = NONE, 0.0, 0.0
    for t in range(size - 2):
        following = k + 1 if k + 1 < size else 0
        bx, by, cx, cy = ring_x[k], ring_y[k], ring_x[following], ring_y[following]
        behind = ax * cy - ay * cx
        area = bx * cy - by * cx + before - behind  # doubled
        if area <= FLATNESS_TOLERANCE * diameter and is_flat(ax, ay, bx, by, cx, cy, area):
            return NONE, 0.0, 0.0
        # on the outline, v may lie beside the fan
        begins = before >= 0.0 or (is_outline and t == 0)
        ends = behind <= 0.0 or (is_outline and t == size - 3)
        if begins and ends and found == NONE:
            found, at_b, at_c = k, max(-behind, 0.0) / area, max(before, 0.0) / area
        k, before = following, behind
    return found, at_b, at_c


# Is the face (a, b, c) with that doubled area thinner than the tolerance, or flipped?
@inlined
def is_flat(ax, ay, bx, by, cx, cy, area):
    longest = max(
        (bx - ax) ** 2 + (by - ay) ** 2,
        max((cx - bx) ** 2 + (cy - by) ** 2, (ax - cx) ** 2 + (ay - cy) ** 2),
    )
    return area <= FLATNESS_TOLERANCE * longest


# Weights of a point on the outline edge from ring[0] to ring[size - 1], a share `along` of it, in
# the fan around whichever of the two ring[j] is: as cover_from returns them
@inlined
def cover_on_edge(j, size, along):
    if j == 0:
        return size - 2, 0.0, along
    return 0, 1.0 - along, 0.0


# The legal targets of v, those first that leave the least error at v itself (which bounds the error
# of the star from below), then the nearest, then the first: order, own_error, cover and
# cover_weights are filled. Returns their number.
#
# rule: from outline_rule; only: the one ring entry to look at, or NONE; is_barred (MAX_RING,) bool:
# those that the link condition forbids; measured: (n, c) of input
@inlined
def legal_targets(
    v, size, rule, along, only, is_barred, ring, ring_x, ring_y, ring_z, diameter, measured,
    tolerance, height_step, order, own_error, distance, cover, cover_weights,
):  # fmt: skip
    n_legal = 0
    is_outline = rule != NONE
    for j in range(0, size, size - 1 if is_outline else 1):
        if is_barred[j] or (only != NONE and ring[j] != only):
            continue
        b, at_b, at_c = cover_from(j, size, is_outline, ring_x, ring_y, diameter)
        if b == NONE:
            continue
        if rule == CUTS:
            b, at_b, at_c = cover_on_edge(j, size, along)
        cover[j], cover_weights[0, j], cover_weights[1, j] = b, at_b, at_c
        c = b + 1 if b + 1 < size else 0
        here, here_z = 0.0, 0.0
        for i in range(ring_z.shape[1]):
            a_z = ring_z[j, i]
            error = (a_z + at_b * (ring_z[b, i] - a_z) + at_c * (ring_z[c, i] - a_z)) - measured[
                v, i
            ]
            here += error * error
            if i == 0:
                here_z = here
        if here_z > tolerance:
            continue
        own_error[j] = here
        distance[j] = ring_x[j] ** 2 + ring_y[j] ** 2
        k = n_legal
        while k > 0 and comes_before(j, order[k - 1], own_error, distance, ring, height_step):
            order[k] = order[k - 1]
            k -= 1
        order[k] = j
        n_legal += 1
    return n_legal


# Is the fan around ring[j] the better one to start with? What differs by rounding is equal.
@inlined
def comes_before(j, other, own_error, distance, ring, height_step):
    if not are_tied(own_error[j], own_error[other], height_step):
        return own_error[j] < own_error[other]
    if not are_tied(distance[j], distance[other], 0.0):
        return distance[j] < distance[other]
    return ring[j] < ring[other]


# Two squares, of errors of single points: about what step_of says, without its root
@inlined
def are_tied(a, b, height_step):
    larger, squared_step = max(a, b), height_step * height_step
    tied = 4.0 * squared_step * (larger + squared_step) + (RELATIVE_STEP * larger) ** 2
    return (a - b) * (a - b) <= tied


# Collect the points of the star of v; those that the outline leaves outside, where it cuts, are
# judged at the nearest place of the new outline edge.
@inlined
def collect_points(
    v, size, n_sides, rule, spoke, x, y, ring_x, ring_y, first_point, n_points_of, x_of, y_of, z_of,
    near_x, near_y, near_z,
):  # fmt: skip
    n_points = 0
    vx, vy = x[v], y[v]
    for k in range(n_sides):
        face = spoke[k] // 3
        for p in range(first_point[face], first_point[face] + n_points_of[face]):
            px, py = x_of[p] - vx, y_of[p] - vy
            if rule == CUTS:
                px, py, _ = nearest_on_edge(
                    px, py, ring_x[0], ring_y[0], ring_x[size - 1],
                    ring_y[size - 1],
                )  # fmt: skip
            near_x[n_points], near_y[n_points] = px, py
            for i in range(z_of.shape[1]):
                near_z[n_points, i] = z_of[p, i]
            n_points += 1


# Lay the fan around ring[j]. Returns whether it spans half a turn or more.
@inlined
def lay_fan(j, size, ring_x, ring_y, ring_z, fan_x, fan_y, slope_x, slope_y):
    ax, ay = ring_x[j], ring_y[j]
    k = j
    for t in range(size - 1):
        k = k + 1 if k + 1 < size else 0
        fan_x[t], fan_y[t] = ring_x[k] - ax, ring_y[k] - ay
    is_wide = False
    k = j + 1 if j + 1 < size else 0
    for t in range(size - 2):
        following = k + 1 if k + 1 < size else 0
        bx, by, cx, cy = fan_x[t], fan_y[t], fan_x[t + 1], fan_y[t + 1]
        per_area = 1.0 / (bx * cy - by * cx)
        if fan_x[0] * cy - fan_y[0] * cx <= 0.0:
            is_wide = True
        for i in range(ring_z.shape[1]):
            to_b = (ring_z[k, i] - ring_z[j, i]) * per_area
            to_c = (ring_z[following, i] - ring_z[j, i]) * per_area
            slope_x[t, i] = to_b * cy - to_c * by
            slope_y[t, i] = to_c * bx - to_b * cx
        k = following
    return is_wide


# Which face of that fan holds the point at (x, y) from its centre?
@inlined
def find_wedge(n_wedges, is_wide, fan_x, fan_y, x, y):
    if is_wide:  # the side of a single ray says nothing across half a turn
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
    j, size, n_points, near_x, near_y, near_z, ring_x, ring_y, ring_z, fan_x, fan_y, slope_x,
    slope_y, by_sum, bound,
    squared, largest,
):  # fmt: skip
    is_wide = lay_fan(j, size, ring_x, ring_y, ring_z, fan_x, fan_y, slope_x, slope_y)
    largest_z = 0.0
    ax, ay = ring_x[j], ring_y[j]
    for p in range(n_points):
        x, y = near_x[p] - ax, near_y[p] - ay
        t = find_wedge(size - 2, is_wide, fan_x, fan_y, x, y)
        here = 0.0
        for i in range(ring_z.shape[1]):
            error = ring_z[j, i] + slope_x[t, i] * x + slope_y[t, i] * y - near_z[p, i]
            here += error * error
            if i == 0:
                largest_z = max(largest_z, here)
        squared += here
        largest = max(largest, here)
        if (squared if by_sum else largest) > bound:
            break
    return squared, largest, largest_z


# The legal target that leaves the least error in the star, and that error; the ring position is
# NONE where no target stays below `bound`, and the last value says whether the bound was met.
# Targets whose errors differ by rounding are equal, and the first in order is taken.
@inlined
def best_target(
    size, n_legal, n_points, order, own_error, near_x, near_y, near_z, ring_x, ring_y, ring_z,
    fan_x, fan_y, slope_x, slope_y, by_sum, bound, tolerance, height_step,
):  # fmt: skip
    best, found = bound, NONE
    is_cut = own_error[order[0]] >= bound
    for k in range(n_legal):
        j = order[k]
        total, largest, largest_z = own_error[j], own_error[j], 0.0
        if total >= best:
            break
        if n_points > 0:
            total, largest, largest_z = fan_error(
                j, size, n_points, near_x, near_y, near_z, ring_x, ring_y, ring_z, fan_x, fan_y,
                slope_x, slope_y, by_sum,
                best, total, largest,
            )  # fmt: skip
        if not by_sum:
            total = largest * (1.0 + TIE_SHARE * (1.0 - largest / max(total, 1e-300)))
        if total >= best:
            is_cut = True
            continue
        if found != NONE and best - total <= step_of(n_points + 1, best, height_step):
            continue
        if largest_z <= tolerance:
            best, found = total, j
    return found, best, is_cut


# Share the detail of v out among the corners of the face that covers it, as the update does;
# ring_z moves along. Returns the change of the squared errors outside the star of v, v itself
# included, and how large the terms of that sum are which are known in single precision.
#
# j, b, at_b, at_c: the corners of the face, by their ring positions, and the weights of b and c
@inlined
def update_corners(
    v, j, b, at_b, at_c, size, n_sides, ring, spoke, ring_z, z, measured, integrals, locked,
    slope, weight, vertex_slope, vertex_weight, detail,
):  # fmt: skip
    c = b + 1 if b + 1 < size else 0
    at_a = 1.0 - at_b - at_c
    share_a = free_integral(ring[j], at_a, integrals[v], integrals, locked)
    share_b = free_integral(ring[b], at_b, integrals[v], integrals, locked)
    share_c = free_integral(ring[c], at_c, integrals[v], integrals, locked)
    norm_squared = share_a**2 + share_b**2 + share_c**2
    factor = integrals[v] / norm_squared if norm_squared > 0.0 else 0.0
    own_share = factor * (at_a * share_a + at_b * share_b + at_c * share_c)
    change, terms = 0.0, 0.0
    for i in range(ring_z.shape[1]):
        fit = at_a * ring_z[j, i] + at_b * ring_z[b, i] + at_c * ring_z[c, i]
        detail[i] = z[v, i] - fit
        change += (fit + own_share * detail[i] - measured[v, i]) ** 2
    # of one type also where the loop that calls this is run by Python
    for corner, share in ((np.int64(j), share_a), (np.int64(b), share_b), (np.int64(c), share_c)):
        u = ring[corner]
        following, preceding = star_corners(corner, size, n_sides, spoke)
        stiffness = vertex_weight[u]
        if following >= 0:
            stiffness -= weight[following]
        if preceding >= 0:
            stiffness -= weight[preceding]
        for i in range(ring_z.shape[1]):
            rate = vertex_slope[u, i]
            if following >= 0:
                rate -= slope[following, i]
            if preceding >= 0:
                rate -= slope[preceding, i]
            shift = factor * share * detail[i]
            change += (2.0 * rate + stiffness * shift) * shift
            terms += abs(shift) * (2.0 * abs(rate) + vertex_weight[u] * abs(shift))
            ring_z[corner, i] += shift
    return change, terms


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


# The cost of the best legal collapse of each vertex of todo (k,) int32, and its target.
#
# mesh, surface, points, moments, outline, limits: the NamedTuples of those names; moments are empty
# without update. vertices: VertexState, of which cost, target, is_stale and is_new are filled.
# squared (m,) float64: present squared errors of the faces.
# Where only heights have changed (not is_new), the target stays the one that it was.
@kernel
def collapse_costs(
    start, stop, todo, mesh, surface, points, moments, vertices, squared, outline, limits
):
    # taken apart here, since each use of a NamedTuple's array counts references
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    x, y, z, measured = surface.x, surface.y, surface.z, surface.measured
    first_point, n_points_of = points.start, points.n_points
    x_of, y_of, z_of = points.x, points.y, points.z
    slope, weight = moments.slope, moments.weight
    vertex_slope, vertex_weight = moments.vertex_slope, moments.vertex_weight
    stays, locked, integrals = vertices.stays, vertices.locked, vertices.integrals
    cost, target = vertices.cost, vertices.target
    is_stale, is_new = vertices.is_stale, vertices.is_new
    tolerance, cutoff, height_step = limits.tolerance, limits.cutoff, limits.height_step
    n_channels = z.shape[1]
    with_update = weight.shape[0] > 0
    by_sum = limits.norm == LEAST_SQUARES
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    ring_x, ring_y, ring_z = (
        np.empty(MAX_RING),
        np.empty(MAX_RING),
        np.empty((MAX_RING, n_channels)),
    )
    fan_x, fan_y = np.empty(MAX_RING), np.empty(MAX_RING)
    slope_x, slope_y = np.empty((MAX_RING, n_channels)), np.empty((MAX_RING, n_channels))
    order, own_error, distance = (
        np.empty(MAX_RING, np.int32),
        np.empty(MAX_RING),
        np.empty(MAX_RING),
    )
    cover, cover_weights = np.empty(MAX_RING, np.int64), np.empty((2, MAX_RING))
    is_barred = np.zeros(MAX_RING, np.bool_)
    detail = np.empty(n_channels)
    capacity = 256
    q = start
    while q < stop:
        near_x, near_y = np.empty(capacity), np.empty(capacity)
        near_z = np.empty((capacity, n_channels))
        while q < stop:
            v = todo[q]
            q += 1
            known = target[v]
            keeps_target = with_update and by_sum and not is_new[v] and known >= 0
            is_stale[v], is_new[v] = False, False
            cost[v], target[v] = np.inf, -1
            if stays[v]:
                continue
            size, n_sides = walk_ring(v, origin, twin, outgoing, ring, spoke)
            if size < 3 or is_enclosed(size, ring, locked):
                continue
            n_points = 0
            before_it = 0.0  # what the star's errors are now
            for k in range(n_sides):
                n_points += n_points_of[spoke[k] // 3]
                before_it += squared[spoke[k] // 3]
            if n_points > capacity:  # again, with more room
                is_stale[v], is_new[v], target[v] = True, not keeps_target, known
                capacity = 2 * n_points
                q -= 1
                break
            for i in range(n_channels):
                before_it += (z[v, i] - measured[v, i]) ** 2
            diameter = place_ring(v, size, ring, x, y, z, ring_x, ring_y, ring_z)
            rule, along = NONE, 0.0
            if n_sides < size:
                rule, along = outline_rule(v, size, ring, ring_x, ring_y, outline)
                if rule == STAYS:
                    continue
            n_legal = legal_targets(
                v, size, rule, along, known if keeps_target else NONE, is_barred, ring, ring_x,
                ring_y, ring_z,
                diameter, measured, tolerance, height_step, order, own_error, distance, cover,
                cover_weights,
            )  # fmt: skip
            if n_legal == 0:
                is_barred[:size] = False
                continue
            bound = cutoff + before_it if by_sum else cutoff
            if n_points > 0 and (keeps_target or own_error[order[0]] < bound):
                collect_points(
                    v, size, n_sides, rule, spoke, x, y, ring_x, ring_y, first_point,
                    n_points_of, x_of,
                    y_of, z_of, near_x, near_y, near_z,
                )  # fmt: skip
            if keeps_target:
                j, best, is_cut = order[0], 0.0, False
            else:
                j, best, is_cut = best_target(
                    size, n_legal, n_points, order, own_error, near_x, near_y, near_z, ring_x,
                    ring_y, ring_z, fan_x, fan_y, slope_x, slope_y, by_sum, bound, tolerance,
                    height_step,
                )  # fmt: skip
            if j != NONE and not meets_link_condition(
                ring[j], ring, 0, size, n_sides, origin, twin, outgoing
            ):
                is_barred[j] = True  # once more, without that target
                is_stale[v], is_new[v] = True, True
                q -= 1
                continue
            is_barred[:size] = False
            if j == NONE:
                if is_cut and cutoff < np.inf:
                    cost[v] = cutoff  # a lower bound only
                    is_stale[v], is_new[v] = True, True
                continue
            target[v] = ring[j]
            if not by_sum:
                cost[v] = on_lattice(best, step_of(1, best, height_step))
                continue
            if not with_update:
                step = step_of(n_points + 1, before_it + best, height_step)
                cost[v] = on_lattice(best - before_it, step)
                continue
            change, terms = update_corners(
                v, j, cover[j], cover_weights[0, j], cover_weights[1, j], size, n_sides, ring,
                spoke, ring_z, z, measured, integrals, locked, slope, weight, vertex_slope,
                vertex_weight, detail,
            )  # fmt: skip
            here = change - before_it
            if n_points > 0:
                here = fan_error(
                    j, size, n_points, near_x, near_y, near_z, ring_x, ring_y, ring_z, fan_x,
                    fan_y, slope_x, slope_y, True,
                    cutoff, here, 0.0,
                )[0]  # fmt: skip
            step = step_of(n_points + 1, before_it + abs(here), height_step) + MOMENT_STEP * terms
            is_stale[v] = here > cutoff  # a lower bound only
            cost[v] = cutoff if is_stale[v] else on_lattice(here, step)
