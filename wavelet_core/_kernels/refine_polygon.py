r"""Kernels of :mod:`wavelet_core.refinement`: a vertex goes, the best triangles take its place.

A half-edge collapse lays a fan around one of the neighbours; there are many more triangulations of
the polygon that they make, such as this one, which is no fan::

        c ----- b               c ----- b
       / \     / \             / |    / | \
      /   \   /   \           /  |   /  |  \
     d ---- v ---- a    to   d   |  /   |   a
      \   /   \   /           \  | /    |  /
       \ /     \ /             \ |/     | /
        e ----- f               e ----- f

The best one is put together from those of its parts, by dynamic programming (G. T. Klincsek,
"Minimal triangulations of polygonal domains", Annals of Discrete Mathematics 9, 1980): the part
between the places i and k of the ring is a triangle (i, j, k), and the parts from i to j and from
j to k.
"""

import numpy as np

from ._jit import inlined, kernel
from .half_edges import MAX_RING, after, walk_ring
from .outline import is_straight
from .refine_tin import hand_over, is_wide

#: Vertices with more neighbours than this are left to the collapses. On corners of five DEMs 8
#: leaves 0.4 % more vertices.
MAX_POLYGON = 10
#: Where no point has a tolerance to keep, the best triangles are those for every second, third ...
#: point of a star, so many at most; what they cost is the sum over all.
N_JUDGES = 128
#: Barycentric weights down to this are those of a point within a triangle: rounding may leave none
#: at all for one on an edge otherwise.
WITHIN = -1e-9


# For each of chosen (k,) int32: corners (k, MAX_POLYGON - 2, 3) int8, filled: of the triangles that
# best take the place of its star the places in its ring, -1 if none keep the tolerance; cost (k,)
# float64, what that adds to the squared errors. error (n_faces,) float64 as of sum_face_errors;
# capacity: most points of a star
@kernel
def propose_polygons(start, stop, chosen, tin, points, objective, error, capacity, corners, cost):
    x, y, z = tin.x, tin.y, tin.z
    n_channels = z.shape[1]
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    near = np.empty(capacity, np.int32)
    least = np.empty((MAX_POLYGON, MAX_POLYGON))
    middle = np.empty((MAX_POLYGON, MAX_POLYGON), np.int8)
    is_side = np.empty((MAX_POLYGON, MAX_POLYGON), np.bool_)
    at = np.empty(3)
    for row in range(start, stop):
        v = chosen[row]
        cost[row] = np.inf
        corners[row] = -1
        if tin.mesh.outgoing[v] < 0 or tin.is_locked[v]:
            continue
        size, n_sides = walk_ring(v, tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing, ring, spoke)
        if size < 3 or size > MAX_POLYGON:
            continue
        first, last = ring[0], ring[size - 1]
        if n_sides < size and not is_straight(
            x[first] - x[v], y[first] - y[v], x[last] - x[v], y[last] - y[v]
        ):
            continue
        present, n = 0.0, 0
        for k in range(n_sides):
            face = spoke[k] // 3
            present += error[face]
            for place in range(points.first[face], points.first[face] + points.n_points[face]):
                near[n] = points.pool[place]
                n += 1
        stride = 1 + (n - 1) // N_JUDGES if objective.tolerance == np.inf and n > 0 else 1
        # -- parts of the ring, the smaller first
        for i in range(size - 1):
            least[i, i + 1] = 0.0
        worst = 0
        for length in range(2, size):
            for i in range(size - length):
                k = i + length
                least[i, k] = np.inf
                for j in range(i + 1, k):
                    total = least[i, j] + least[j, k]
                    a, b, c = ring[i], ring[j], ring[k]
                    if total >= least[i, k] or not is_wide(x[a], y[a], x[b], y[b], x[c], y[c]):
                        continue
                    # most triangles break the tolerance where the one before did: looked at first
                    for turn in range(-1, n):
                        if turn % stride and turn >= 0:
                            continue
                        m = worst if turn < 0 else turn
                        p = near[m]
                        weights_at(a, b, c, p, tin, points, at)
                        if min(at[0], min(at[1], at[2])) < WITHIN:
                            continue
                        squared, squared_z = squared_error(a, b, c, p, tin, points, at, n_channels)
                        if squared_z * points.strictness[p] > objective.tolerance:
                            total, worst = np.inf, m
                            break
                        if turn >= 0:
                            total += squared
                            if total >= least[i, k]:
                                break
                    if total < least[i, k]:
                        least[i, k], middle[i, k] = total, j
        if not least[0, size - 1] < np.inf:
            continue
        # -- its triangles, and each point in the one that holds it best
        is_side[:size, :size] = False
        is_side[0, size - 1] = True
        n_faces = 0
        for length in range(size - 1, 1, -1):
            for i in range(size - length):
                k = i + length
                if is_side[i, k]:
                    j = middle[i, k]
                    corners[row, n_faces, 0] = i
                    corners[row, n_faces, 1] = j
                    corners[row, n_faces, 2] = k
                    is_side[i, j] = is_side[j, k] = True
                    n_faces += 1
        total, keeps = 0.0, True
        for m in range(n):
            p = near[m]
            t = find_triangle(p, n_faces, corners, row, ring, tin, points, at)
            a, b, c = (
                ring[corners[row, t, 0]], ring[corners[row, t, 1]], ring[corners[row, t, 2]]
            )  # fmt: skip
            weights_at(a, b, c, p, tin, points, at)
            squared, squared_z = squared_error(a, b, c, p, tin, points, at, n_channels)
            keeps = keeps and squared_z * points.strictness[p] <= objective.tolerance
            total += squared
        if keeps:
            cost[row] = total - present
        else:
            corners[row] = -1


# Barycentric weights (3,) of a point in a triangle
@inlined
def weights_at(a, b, c, p, tin, points, at):
    x, y = tin.x, tin.y
    bx, by, cx, cy = x[b] - x[a], y[b] - y[a], x[c] - x[a], y[c] - y[a]
    px, py = points.x[p] - x[a], points.y[p] - y[a]
    area = bx * cy - by * cx
    at[1], at[2] = (px * cy - py * cx) / area, (bx * py - by * px) / area
    at[0] = 1.0 - at[1] - at[2]


# Squared error of a point under a triangle: of all channels, and of the height
@inlined
def squared_error(a, b, c, p, tin, points, at, n_channels):
    z = tin.z
    squared, squared_z = 0.0, 0.0
    for i in range(n_channels):
        off = z[a, i] + at[1] * (z[b, i] - z[a, i]) + at[2] * (z[c, i] - z[a, i])
        off -= points.z[p, i]
        squared += off * off
        if i == 0:
            squared_z = squared
    return squared, squared_z


# Which triangle holds a point best: the one whose least weight is the largest
@inlined
def find_triangle(p, n_faces, corners, row, ring, tin, points, at):
    found, most = 0, -np.inf
    for t in range(n_faces):
        a, b, c = ring[corners[row, t, 0]], ring[corners[row, t, 1]], ring[corners[row, t, 2]]
        weights_at(a, b, c, p, tin, points, at)
        least = min(at[0], min(at[1], at[2]))
        if least > most:
            found, most = t, least
    return found


# Take vertices out whose stars have no vertex in common, and lay the triangles corners (k,
# MAX_POLYGON - 2, 3) int8, as of propose_polygons. base (k,) int64: room in the pool
@kernel
def lay_polygons(start, stop, chosen, corners, base, tin, points, capacity):
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    near, side = np.empty(capacity, np.int32), np.empty(capacity, np.int32)
    faces, cursor = np.empty(MAX_POLYGON, np.int32), np.empty(MAX_POLYGON, np.int64)
    across = np.empty((MAX_POLYGON, MAX_POLYGON), np.int32)
    at = np.empty(3)
    for row in range(start, stop):
        v = chosen[row]
        size, n_sides = walk_ring(v, origin, twin, outgoing, ring, spoke)
        n_faces = size - 2
        n = 0
        for k in range(n_sides):
            faces[k] = face = spoke[k] // 3
            for place in range(points.first[face], points.first[face] + points.n_points[face]):
                p = points.pool[place]
                near[n] = p
                side[n] = find_triangle(p, n_faces, corners, row, ring, tin, points, at)
                n += 1
        hand_over(near, side, n, faces, n_faces, base[row], cursor, points)
        # -- across[i, k]: what the triangle on the side from i to k meets there
        for k in range(size):
            following = k + 1 if k + 1 < size else 0
            beyond = twin[after(spoke[k])] if k < n_sides else -1
            across[min(k, following), max(k, following)] = beyond
            face = outgoing[ring[k]] // 3
            for j in range(n_sides):
                if spoke[j] // 3 == face:
                    outgoing[ring[k]] = -1  # named below
        for t in range(n_faces):
            i, j, k = corners[row, t, 0], corners[row, t, 1], corners[row, t, 2]
            f = 3 * (spoke[t] // 3)  # the face (ring[k], ring[i], ring[j])
            origin[f], origin[f + 1], origin[f + 2] = ring[k], ring[i], ring[j]
            for side_of in range(3):
                tail = k if side_of == 0 else i if side_of == 1 else j
                head = i if side_of == 0 else j if side_of == 1 else k
                is_rim = head - tail == 1 or (tail == size - 1 and head == 0)
                meets = across[min(tail, head), max(tail, head)]
                if is_rim or side_of == 0:
                    twin[f + side_of] = meets
                    if meets >= 0:
                        twin[meets] = f + side_of
                else:
                    across[tail, head] = f + side_of
                if is_rim and outgoing[ring[tail]] < 0:
                    outgoing[ring[tail]] = f + side_of
        outgoing[v] = -1
        for t in range(n_faces, n_sides):
            f = 3 * (spoke[t] // 3)
            points.n_points[f // 3] = 0
            for corner in range(3):
                origin[f + corner], twin[f + corner] = -1, -1
