"""What the kernels of :mod:`wavelet_core.refinement` share: the TIN, its points, their errors.

Every input point lies in the list of one face. A list is a stretch of the pool; a change writes the
lists of its faces anew, side by side, behind those in use, so that changes of faces that are
nobody else's may run at once. Points keep their order, which is the order of all sums.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._jit import inlined, kernel
from .half_edges import MAX_RING, HalfEdges, walk_ring
from .surface_cost import is_flat


class Tin(NamedTuple):
    """A TIN whose vertices lie on input points.

    mesh : HalfEdges; faces that are gone have the origin -1
    x, y : (n,) float64, z : (n, c) float64, present heights and weighted attributes
    point : (n,) int32, the input point that each vertex lies on
    stays : (n,) bool, keeps its place; is_locked : (n,) bool, keeps its height as well
    """

    mesh: HalfEdges
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]
    point: NDArray[np.int32]
    stays: NDArray[np.bool_]
    is_locked: NDArray[np.bool_]


class Points(NamedTuple):
    """The input, and which of it lies in each face.

    x, y : (n_points,) float64, z : (n_points, c) float64
    strictness : (n_points,) float64, times a squared height error, for the tolerance
    first, n_points : (n_faces,) int64, where in the pool the list of a face is, and how long
    pool : (capacity,) int32
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]
    strictness: NDArray[np.float64]
    first: NDArray[np.int64]
    n_points: NDArray[np.int64]
    pool: NDArray[np.int32]


class Objective(NamedTuple):
    """What a refinement makes small.

    is_power : bool, the eighth power of the error, not its square
    is_free : bool, whether heights are fitted; else a vertex has those of its point
    tolerance : float, the largest squared height error that is legal, times the point's strictness
    reach : float, squared distance that a vertex may move at once
    n_trials : int, how many places of a vertex are tried at all points of its star
    """

    is_power: bool
    is_free: bool
    tolerance: float
    reach: float
    n_trials: int


# What an error counts for, given its square
@inlined
def weighed(squared, is_power):
    if is_power:
        fourth = squared * squared
        return fourth * fourth
    return squared


# chosen (k,) int32; count (k,) int64, filled with the number of points in the star of each
@kernel
def count_star_points(start, stop, chosen, tin, points, count):
    ring = np.empty(MAX_RING, np.int32)
    spoke = np.empty(MAX_RING, np.int32)
    for row in range(start, stop):
        v = chosen[row]
        count[row] = 0
        if tin.mesh.outgoing[v] < 0:
            continue
        _, n_sides = walk_ring(v, tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing, ring, spoke)
        for k in range(n_sides):
            count[row] += points.n_points[spoke[k] // 3]


# Filled for the faces chosen (k,) int64, all of shape (n_faces,) float64: error, what the errors in
# each count for; squared_z, the sum of the squares of those in height; and the largest of these
@kernel
def sum_face_errors(start, stop, chosen, tin, points, objective, error, squared_z, largest):
    x, y, z, origin = tin.x, tin.y, tin.z, tin.mesh.origin
    n_channels = z.shape[1]
    for row in range(start, stop):
        face = chosen[row]
        error[face], squared_z[face], largest[face] = 0.0, 0.0, 0.0
        a, b, c = origin[3 * face], origin[3 * face + 1], origin[3 * face + 2]
        if a < 0:
            continue
        bx, by, cx, cy = x[b] - x[a], y[b] - y[a], x[c] - x[a], y[c] - y[a]
        per_area = 1.0 / (bx * cy - by * cx)
        total, total_z, most = 0.0, 0.0, 0.0
        for k in range(points.first[face], points.first[face] + points.n_points[face]):
            p = points.pool[k]
            px, py = points.x[p] - x[a], points.y[p] - y[a]
            at_b = (px * cy - py * cx) * per_area
            at_c = (bx * py - by * px) * per_area
            squared = 0.0
            for i in range(n_channels):
                off = z[a, i] + at_b * (z[b, i] - z[a, i]) + at_c * (z[c, i] - z[a, i])
                off -= points.z[p, i]
                squared += off * off
                if i == 0:
                    total_z += squared
                    most = max(most, squared)
            total += weighed(squared, objective.is_power)
        error[face], squared_z[face], largest[face] = total, total_z, most


# The first in order take what they need, others that need a part of it come too late.
# order (k,) int64; needs (k, m) int32, vertices or -1; is_taken (n_vertices,) bool; wins (k,) bool
@kernel
def take_in_order(order, needs, is_taken, wins):
    for place in range(order.shape[0]):
        row = order[place]
        wins[row] = True
        for k in range(needs.shape[1]):
            if needs[row, k] >= 0 and is_taken[needs[row, k]]:
                wins[row] = False
        if wins[row]:
            for k in range(needs.shape[1]):
                if needs[row, k] >= 0:
                    is_taken[needs[row, k]] = True


# order (k,) int32, vertices; colour (n,) int8, -1 on entry: filled with the least that no neighbour
# has which comes before
@kernel
def colour_vertices(order, mesh, colour):
    ring = np.empty(MAX_RING, np.int32)
    spoke = np.empty(MAX_RING, np.int32)
    for place in range(order.shape[0]):
        v = order[place]
        size, _ = walk_ring(v, mesh.origin, mesh.twin, mesh.outgoing, ring, spoke)
        used = 0
        for k in range(size):
            if colour[ring[k]] >= 0:
                used |= 1 << colour[ring[k]]
        c = 0
        while used >> c & 1:
            c += 1
        colour[v] = c


# pool: the lists of all faces side by side, in the order of the faces; first (n_faces,) int64,
# filled by the caller
@kernel
def copy_lists(start, stop, points, first, pool):
    for face in range(start, stop):
        for k in range(points.n_points[face]):
            pool[first[face] + k] = points.pool[points.first[face] + k]


# Write the lists of n_faces faces anew, side by side in the pool from `opening` on: of near (n,)
# int32 each point goes to faces[side], side (n,) int32. cursor (>= n_faces,) int64: room to count
@inlined
def hand_over(near, side, n, faces, n_faces, opening, cursor, points):
    for k in range(n_faces):
        cursor[k] = 0
    for q in range(n):
        cursor[side[q]] += 1
    for k in range(n_faces):
        points.first[faces[k]], points.n_points[faces[k]] = opening, cursor[k]
        opening += cursor[k]
        cursor[k] = points.first[faces[k]]
    for q in range(n):
        points.pool[cursor[side[q]]] = near[q]
        cursor[side[q]] += 1


# Is the face of these corners wide enough, and counter-clockwise?
@inlined
def is_wide(ax, ay, bx, by, cx, cy):
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return area > 0.0 and not is_flat(ax, ay, bx, by, cx, cy, area)
