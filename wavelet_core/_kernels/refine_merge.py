r"""Kernels of :mod:`wavelet_core.refinement`: an edge shrinks to one vertex, on any input point.

The faces around the two ends of an edge make a polygon, whose sides are the rim; a fan around an
input point takes their place, so that two vertices go and one comes::

        o --- o --- o               o --- o --- o
       / \   / \   / \             /  \   |   /  \
      o --- a --- b --- o    to   o ----- p ----- o
       \   / \   / \   /           \  /   |   \  /
        o --- o --- o               o --- o --- o
"""

import numpy as np

from ._jit import inlined, kernel
from .half_edges import after
from .outline import is_straight
from .refine_move import find_side, is_open
from .refine_tin import hand_over

#: Polygons of more sides than this stay as they are: they claim too much of the TIN.
MAX_RIM = 26
#: Points are tried whose squared distance from the middle of the edge is at most so many times that
#: of its ends. On corners of five DEMs 1 leaves 3 % and 4 leaves 1 % more vertices, without a limit
#: 0.1 % fewer are left for a fifth more time.
SQUARED_REACH = 16.0


# The rim of the polygon around a half-edge, counter-clockwise: rim (MAX_RIM,) int32, filled with
# its half-edges. Where an end is on the outline, the rim is a path from the outline to the outline.
# Returns their number, 0 where the edge has to stay; and the end that lives on, on the outline if
# one of them is
@inlined
def walk_rim(half_edge, origin, twin, outgoing, rim):
    a, b = origin[half_edge], origin[after(half_edge)]
    a_is_outline, b_is_outline = twin[outgoing[a]] < 0, twin[outgoing[b]] < 0
    kept = b if b_is_outline else a
    if a_is_outline and b_is_outline and twin[half_edge] >= 0:
        return 0, kept  # two parts of the outline would meet
    here = after(outgoing[kept])
    if origin[here] == a or origin[here] == b:
        here = after(here)
    n = 0
    while True:
        while origin[after(here)] == a or origin[after(here)] == b:  # runs to the inside
            if twin[here] < 0:
                return n, kept
            here = after(twin[here])
        if n > 0 and here == rim[0]:
            return n, kept
        if n == MAX_RIM:
            return 0, kept
        rim[n] = here
        n += 1
        here = after(here)


# ring (MAX_RIM + 1,) int32, filled: the vertices of the rim. Returns their number: that of its
# half-edges, and one more where it is a path
@inlined
def list_ring(rim, n_sides, origin, ring):
    for k in range(n_sides):
        ring[k] = origin[rim[k]]
    ring[n_sides] = origin[after(rim[n_sides - 1])]
    return n_sides if ring[n_sides] == ring[0] else n_sides + 1


# n_points (k,) int64, filled: of the polygon around each of half_edges (k,) int32, 0 where the edge
# has to stay
@kernel
def count_polygon_points(start, stop, half_edges, tin, points, n_points):
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    rim = np.empty(MAX_RIM, np.int32)
    for row in range(start, stop):
        half_edge = half_edges[row]
        n_points[row] = 0
        if tin.is_locked[origin[half_edge]] or tin.is_locked[origin[after(half_edge)]]:
            continue
        n_sides, _ = walk_rim(half_edge, origin, twin, outgoing, rim)
        if n_sides == 0:
            continue
        for k in range(n_sides):
            n_points[row] += points.n_points[rim[k] // 3]
        n_points[row] += points.n_points[half_edge // 3]
        if twin[half_edge] >= 0:
            n_points[row] += points.n_points[twin[half_edge] // 3]


# needs (k, MAX_RIM + 3) int32, filled: of each of half_edges (k,) int32 the end that lives on, the
# other one, the vertices of the rim, then -1
@kernel
def list_polygons(start, stop, half_edges, mesh, needs):
    origin = mesh.origin
    rim, ring = np.empty(MAX_RIM, np.int32), np.empty(MAX_RIM + 1, np.int32)
    for row in range(start, stop):
        half_edge = half_edges[row]
        a, b = origin[half_edge], origin[after(half_edge)]
        n_sides, kept = walk_rim(half_edge, origin, mesh.twin, mesh.outgoing, rim)
        size = list_ring(rim, n_sides, origin, ring)
        needs[row, 0], needs[row, 1] = kept, a if kept == b else b
        for k in range(2, needs.shape[1]):
            needs[row, k] = ring[k - 2] if k - 2 < size else -1


# For each of half_edges (k,) int32, with n_points (k,) int64 as of count_polygon_points: to (k,)
# int32, the point that serves best in place of both ends, -1 if none keeps the tolerance; cost (k,)
# float64, what that adds to the squared errors. error (n_faces,) float64 as of sum_face_errors;
# capacity: most points of a polygon
@kernel
def propose_merges(
    start, stop, half_edges, n_points, tin, points, objective, error, capacity, to, cost
):
    x, y, z, origin, twin = tin.x, tin.y, tin.z, tin.mesh.origin, tin.mesh.twin
    outgoing = tin.mesh.outgoing
    n_channels = z.shape[1]
    rim, ring = np.empty(MAX_RIM, np.int32), np.empty(MAX_RIM + 1, np.int32)
    rim_x, rim_y = np.empty(MAX_RIM + 1), np.empty(MAX_RIM + 1)
    seen_x, seen_y = np.empty(MAX_RIM + 1), np.empty(MAX_RIM + 1)
    slope_x, slope_y = np.empty((MAX_RIM, n_channels)), np.empty((MAX_RIM, n_channels))
    near, side = np.empty(capacity, np.int32), np.empty(capacity, np.int32)
    near_x, near_y = np.empty(capacity), np.empty(capacity)
    for row in range(start, stop):
        half_edge = half_edges[row]
        to[row], cost[row] = -1, np.inf
        if n_points[row] == 0:
            continue
        n_sides, kept = walk_rim(half_edge, origin, twin, outgoing, rim)
        gone = origin[half_edge] if kept != origin[half_edge] else origin[after(half_edge)]
        size = list_ring(rim, n_sides, origin, ring)
        if meets_itself(ring, size):
            continue
        for k in range(size):
            rim_x[k], rim_y[k] = x[ring[k]] - x[kept], y[ring[k]] - y[kept]
        gone_x, gone_y = x[gone] - x[kept], y[gone] - y[kept]
        if size > n_sides and not (
            is_straight(rim_x[0], rim_y[0], rim_x[size - 1], rim_y[size - 1])
            and (
                twin[outgoing[gone]] >= 0
                or is_straight(
                    rim_x[0] - gone_x, rim_y[0] - gone_y,
                    rim_x[size - 1] - gone_x, rim_y[size - 1] - gone_y,
                )
            )
        ):  # fmt: skip
            continue
        # -- the points, the ends of the edge among them
        present, n = 0.0, 0
        here, there = 0, 0
        for k in range(n_sides + 2):
            inner = rim[k] if k < n_sides else half_edge if k == n_sides else twin[half_edge]
            if inner < 0:
                continue
            face = inner // 3
            present += error[face]
            for place in range(points.first[face], points.first[face] + points.n_points[face]):
                p = points.pool[place]
                near[n], side[n] = p, k if k < n_sides else 0
                near_x[n], near_y[n] = points.x[p] - x[kept], points.y[p] - y[kept]
                if p == tin.point[kept]:
                    here = n
                if p == tin.point[gone]:
                    there = n
                n += 1
        reach = SQUARED_REACH * (0.25 * (gone_x * gone_x + gone_y * gone_y))
        least = np.inf
        for q in range(n):
            ux, uy = near_x[q], near_y[q]
            dx, dy = ux - 0.5 * gone_x, uy - 0.5 * gone_y
            if dx * dx + dy * dy > reach or not is_open(ux, uy, size, n_sides, rim_x, rim_y):
                continue
            for k in range(size):
                seen_x[k], seen_y[k] = rim_x[k] - ux, rim_y[k] - uy
            if size > n_sides and not is_straight(
                seen_x[0], seen_y[0], seen_x[size - 1], seen_y[size - 1]
            ):
                continue
            at = near[q]
            for k in range(n_sides):
                following = k + 1 if k + 1 < size else 0
                area = seen_x[k] * seen_y[following] - seen_y[k] * seen_x[following]
                for i in range(n_channels):
                    to_b = (z[ring[k], i] - points.z[at, i]) / area
                    to_c = (z[ring[following], i] - points.z[at, i]) / area
                    slope_x[k, i] = to_b * seen_y[following] - to_c * seen_y[k]
                    slope_y[k, i] = to_c * seen_x[k] - to_b * seen_x[following]
            # Most places break the tolerance at an end of the edge, or where the one tried before
            # did: those are looked at first, which changes nothing but the time.
            total, keeps = 0.0, True
            for turn in range(-2, n):
                m = here if turn == -2 else there if turn == -1 else turn
                p = near[m]
                px, py = near_x[m] - ux, near_y[m] - uy
                k = find_side(side[m], size, n_sides, seen_x, seen_y, px, py)
                squared = 0.0
                for i in range(n_channels):
                    off = points.z[at, i] + slope_x[k, i] * px + slope_y[k, i] * py - points.z[p, i]
                    squared += off * off
                    if i == 0 and squared * points.strictness[p] > objective.tolerance:
                        keeps = False
                if not keeps:
                    if turn >= 0:
                        here, there = m, here
                    break
                if turn >= 0:
                    total += squared
                    if total >= least:
                        break
            if keeps and total < least:
                least = total
                to[row], cost[row] = at, total - present


# Does a vertex come twice in ring (>= size,) int32?
@inlined
def meets_itself(ring, size):
    for k in range(1, size):
        for j in range(k):
            if ring[j] == ring[k]:
                return True
    return False


# Shrink edges whose polygons have no vertex in common to the points to (k,) int32. base (k,) int64:
# room in the pool; capacity: most points of a polygon
@kernel
def merge_edges(start, stop, half_edges, to, base, tin, points, capacity):
    x, y, z = tin.x, tin.y, tin.z
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    rim, ring = np.empty(MAX_RIM, np.int32), np.empty(MAX_RIM + 1, np.int32)
    beyond = np.empty(MAX_RIM, np.int32)
    seen_x, seen_y = np.empty(MAX_RIM + 1), np.empty(MAX_RIM + 1)
    near, side = np.empty(capacity, np.int32), np.empty(capacity, np.int32)
    faces, cursor = np.empty(MAX_RIM, np.int32), np.empty(MAX_RIM, np.int64)
    for row in range(start, stop):
        half_edge, at = half_edges[row], to[row]
        other = twin[half_edge]
        n_sides, v = walk_rim(half_edge, origin, twin, outgoing, rim)
        gone = origin[half_edge] if v != origin[half_edge] else origin[after(half_edge)]
        x[v], y[v], tin.point[v] = points.x[at], points.y[at], at
        for i in range(z.shape[1]):
            z[v, i] = points.z[at, i]
        size = list_ring(rim, n_sides, origin, ring)
        for k in range(size):
            seen_x[k], seen_y[k] = x[ring[k]] - x[v], y[ring[k]] - y[v]
        n = 0
        for k in range(n_sides + 2):
            inner = rim[k] if k < n_sides else half_edge if k == n_sides else other
            if inner < 0:
                continue
            face = inner // 3
            for place in range(points.first[face], points.first[face] + points.n_points[face]):
                p = points.pool[place]
                px, py = points.x[p] - x[v], points.y[p] - y[v]
                hint = k if k < n_sides else 0
                near[n], side[n] = p, find_side(hint, size, n_sides, seen_x, seen_y, px, py)
                n += 1
        for k in range(n_sides):
            faces[k] = rim[k] // 3
        hand_over(near, side, n, faces, n_sides, base[row], cursor, points)
        # -- a vertex of the rim that names a half-edge within it names one of the fan's
        for k in range(size):
            face = outgoing[ring[k]] // 3
            is_within = face == half_edge // 3 or (other >= 0 and face == other // 3)
            for j in range(n_sides):
                is_within = is_within or face == rim[j] // 3
            if is_within:
                named = 3 * (rim[k] // 3) if k < n_sides else 3 * (rim[k - 1] // 3) + 1
                outgoing[ring[k]] = named
        for k in range(n_sides):
            beyond[k] = twin[rim[k]]
        # -- faces (ring[k], ring[k + 1], v)
        for k in range(n_sides):
            f = 3 * (rim[k] // 3)
            following = k + 1 if k + 1 < size else 0
            origin[f], origin[f + 1], origin[f + 2] = ring[k], ring[following], v
            twin[f] = beyond[k]
            if beyond[k] >= 0:
                twin[beyond[k]] = f
            twin[f + 1] = 3 * (rim[following] // 3) + 2 if following < n_sides else -1
            preceding = k - 1 if k > 0 else n_sides - 1
            twin[f + 2] = 3 * (rim[preceding] // 3) + 1 if k > 0 or size == n_sides else -1
        outgoing[v] = 3 * (rim[0] // 3) + 2
        outgoing[gone] = -1
        for half in range(2):
            inner = half_edge if half == 0 else other
            if inner >= 0:
                f = 3 * (inner // 3)
                points.n_points[f // 3] = 0
                for corner in range(3):
                    origin[f + corner], twin[f + corner] = -1, -1
