r"""Kernels of :mod:`wavelet_core.refinement`: edges that lie better across their quadrangle.

The edge from a to b, with c on its left and d on its right, becomes the edge from c to d::

          c                      c
        /   \                  / | \
      a ----- b      to       a   |   b
        \   /                  \ | /
          d                      d
"""

import numpy as np

from ._jit import inlined, kernel
from .half_edges import after, before
from .refine_tin import is_wide, weighed

#: An edge is turned only where the error of its two faces falls by more than this part of it,
#: which keeps rounding from turning edges back and forth. From 0 to 0.01 the RMSE is the same to
#: 0.3 % (benchmarks/quality/constants.py).
LEAST_GAIN = 1e-6


# a, b, c, d of a half-edge inside the mesh
@inlined
def corners_of(half_edge, origin, twin):
    other = twin[half_edge]
    return (
        origin[half_edge], origin[other], origin[before(half_edge)], origin[before(other)]
    )  # fmt: skip


# half_edges (k,) int32, of each edge the lower one; error (n_faces,) float64 as of sum_face_errors;
# gain (k,) float64, filled: by how much the error falls, 0 where the edge has to stay
@kernel
def gains_of_flips(start, stop, half_edges, tin, points, objective, error, gain):
    x, y, z, origin, twin = tin.x, tin.y, tin.z, tin.mesh.origin, tin.mesh.twin
    n_channels = z.shape[1]
    slope_x, slope_y = np.empty((2, n_channels)), np.empty((2, n_channels))
    for row in range(start, stop):
        gain[row] = 0.0
        half_edge = half_edges[row]
        faces = (half_edge // 3, twin[half_edge] // 3)
        present = error[faces[0]] + error[faces[1]]
        if not present > 0.0:
            continue
        a, b, c, d = corners_of(half_edge, origin, twin)
        if tin.is_locked[a] and tin.is_locked[b]:
            continue
        if not (
            is_wide(x[a], y[a], x[d], y[d], x[c], y[c])
            and is_wide(x[d], y[d], x[b], y[b], x[c], y[c])
        ):
            continue
        dx, dy = x[d] - x[c], y[d] - y[c]
        for side in range(2):
            u = a if side == 0 else b
            ux, uy = x[u] - x[c], y[u] - y[c]
            per_area = 1.0 / (ux * dy - uy * dx)
            for i in range(n_channels):
                to_u, to_d = z[u, i] - z[c, i], z[d, i] - z[c, i]
                slope_x[side, i] = (to_u * dy - to_d * uy) * per_area
                slope_y[side, i] = (to_d * ux - to_u * dx) * per_area
        total, largest = 0.0, 0.0
        for face in faces:
            for place in range(points.first[face], points.first[face] + points.n_points[face]):
                p = points.pool[place]
                px, py = points.x[p] - x[c], points.y[p] - y[c]
                side = 1 if dx * py - dy * px >= 0.0 else 0
                squared = 0.0
                for i in range(n_channels):
                    off = z[c, i] + slope_x[side, i] * px + slope_y[side, i] * py - points.z[p, i]
                    squared += off * off
                    if i == 0:
                        largest = max(largest, squared * points.strictness[p])
                total += weighed(squared, objective.is_power)
        if total < present - LEAST_GAIN * present and largest <= objective.tolerance:
            gain[row] = present - total


# Turn edges that have no vertex of their quadrangles in common. base (k,) int64: where in the pool
# there is room for the points of their faces
@kernel
def flip_edges(start, stop, half_edges, base, tin, points):
    x, y, origin, twin, outgoing = tin.x, tin.y, tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    for row in range(start, stop):
        half_edge = half_edges[row]
        other = twin[half_edge]
        a, b, c, d = corners_of(half_edge, origin, twin)
        first_face, second_face = half_edge // 3, other // 3
        dx, dy = x[d] - x[c], y[d] - y[c]
        n_first = 0
        for turn in range(2):  # those beside a, then those beside b
            place_in_pool = base[row] + n_first
            n_here = 0
            for face in (first_face, second_face):
                for place in range(points.first[face], points.first[face] + points.n_points[face]):
                    p = points.pool[place]
                    px, py = points.x[p] - x[c], points.y[p] - y[c]
                    if (dx * py - dy * px >= 0.0) == (turn == 1):
                        points.pool[place_in_pool + n_here] = p
                        n_here += 1
            if turn == 0:
                n_first = n_here
            else:
                points.first[first_face], points.n_points[first_face] = base[row], n_first
                points.first[second_face] = base[row] + n_first
                points.n_points[second_face] = n_here
        beyond_bc, beyond_ca = twin[after(half_edge)], twin[before(half_edge)]
        beyond_ad, beyond_db = twin[after(other)], twin[before(other)]
        # the first face becomes (a, d, c), the second one (d, b, c)
        f, g = 3 * first_face, 3 * second_face
        origin[f], origin[f + 1], origin[f + 2] = a, d, c
        origin[g], origin[g + 1], origin[g + 2] = d, b, c
        twin[f], twin[f + 1], twin[f + 2] = beyond_ad, g + 2, beyond_ca
        twin[g], twin[g + 1], twin[g + 2] = beyond_db, beyond_bc, f + 1
        if beyond_ad >= 0:
            twin[beyond_ad] = f
        if beyond_ca >= 0:
            twin[beyond_ca] = f + 2
        if beyond_db >= 0:
            twin[beyond_db] = g
        if beyond_bc >= 0:
            twin[beyond_bc] = g + 1
        # a vertex of the outline names the half-edge without a twin
        if is_of(outgoing[a], f, g):
            outgoing[a] = f
        if is_of(outgoing[b], f, g):
            outgoing[b] = g + 1
        if is_of(outgoing[c], f, g):
            outgoing[c] = f + 2
        if is_of(outgoing[d], f, g):
            outgoing[d] = g


# Does the half-edge belong to one of the faces with these first half-edges?
@inlined
def is_of(half_edge, f, g):
    return half_edge - half_edge % 3 in (f, g)
