"""Kernels of :mod:`wavelet_core.partition.questions`: which collapse looks the best from nearby.

A forecast knows the present heights of a vertex and of its ring, and no more: not the points of the
faces. So whoever has the level has its forecasts, before it is known what goes.
"""

import numpy as np

from ._jit import inlined, kernel, njit
from .half_edges import MAX_RING, walk_ring
from .outline import STAYS, outline_rule
from .surface_cost import NONE, is_enclosed, legal_targets, place_ring

# the code of "no forecast"; those of forecasts are lower
NO_FORECAST = 0xFFFF


# Room for what `targets_in_order` fills, in the order of its arguments; see surface_cost.
@njit
def workspace(n_channels):
    return (
        np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32), np.empty(MAX_RING),
        np.empty(MAX_RING), np.empty((MAX_RING, n_channels)), np.zeros(MAX_RING, np.bool_),
        np.empty(MAX_RING, np.int32), np.empty(MAX_RING), np.empty(MAX_RING),
        np.empty(MAX_RING, np.int64), np.empty((2, MAX_RING)),
    )  # fmt: skip


# The legal targets of v, the best first: order and own_error are filled; returns their number, and
# that of the neighbours.
@inlined
def targets_in_order(
    v, origin, twin, outgoing, x, y, z, stays, locked, outline, height_step, ring, spoke, ring_x,
    ring_y, ring_z, is_barred, order, own_error, distance, cover, cover_weights,
):  # fmt: skip
    if stays[v]:
        return 0, 0
    size, n_sides = walk_ring(v, origin, twin, outgoing, ring, spoke)
    if size < 3 or is_enclosed(size, ring, locked):
        return 0, size
    diameter = place_ring(v, size, ring, x, y, z, ring_x, ring_y, ring_z)
    rule, along = NONE, 0.0
    if n_sides < size:
        rule, along = outline_rule(v, size, ring, ring_x, ring_y, outline)
        if rule == STAYS:
            return 0, size
    n_legal = legal_targets(
        v, size, rule, along, NONE, is_barred, ring, ring_x, ring_y, ring_z, diameter, z, np.inf,
        height_step, order, own_error, distance, cover, cover_weights,
    )  # fmt: skip
    return n_legal, size


# The upper half of a number in single precision, which keeps the order; bits (1,) uint32 is single
# (1,) float32 seen otherwise
@inlined
def coded(squared, negligible, single, bits):
    if squared <= negligible:
        return 0
    single[0] = squared
    if not single[0] < np.inf:
        return NO_FORECAST
    return bits[0] >> 16


# best, second (n,) uint16 of all vertices, filled for those of todo (k,) int32: the codes of the
# squared detail that the best legal collapse of each leaves, and of the next best. Up to
# `negligible` it is nothing. n_around (n,) uint8: the number of neighbours.
@kernel
def forecast_collapses(
    start, stop, todo, mesh, surface, stays, locked, outline, height_step, negligible, best, second,
    n_around,
):  # fmt: skip
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    x, y, z = surface.x, surface.y, surface.z
    (
        ring, spoke, ring_x, ring_y, ring_z, is_barred, order, own_error, distance, cover,
        cover_weights,
    ) = workspace(z.shape[1])  # fmt: skip
    single = np.zeros(1, np.float32)
    bits = single.view(np.uint32)
    for q in range(start, stop):
        v = todo[q]
        n_legal, size = targets_in_order(
            v, origin, twin, outgoing, x, y, z, stays, locked, outline, height_step, ring, spoke,
            ring_x, ring_y, ring_z, is_barred, order, own_error, distance, cover, cover_weights,
        )  # fmt: skip
        best[v] = second[v] = NO_FORECAST
        n_around[v] = min(size, 255)
        if n_legal > 0:
            best[v] = coded(own_error[order[0]], negligible, single, bits)
        if n_legal > 1:
            second[v] = coded(own_error[order[1]], negligible, single, bits)


# rank (k,) int32: places among the legal targets; target (k,) int32: those targets. Where rank is
# negative it is filled from target, else target from rank; -1 is left where there is no such.
@kernel
def match_targets(
    start, stop, odd, mesh, surface, stays, locked, outline, height_step, rank, target
):
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    x, y, z = surface.x, surface.y, surface.z
    (
        ring, spoke, ring_x, ring_y, ring_z, is_barred, order, own_error, distance, cover,
        cover_weights,
    ) = workspace(z.shape[1])  # fmt: skip
    for q in range(start, stop):
        n_legal, _ = targets_in_order(
            odd[q], origin, twin, outgoing, x, y, z, stays, locked, outline, height_step, ring,
            spoke, ring_x, ring_y, ring_z, is_barred, order, own_error, distance, cover,
            cover_weights,
        )  # fmt: skip
        if rank[q] >= 0:
            target[q] = ring[order[rank[q]]] if rank[q] < n_legal else -1
        else:
            for k in range(n_legal):
                if ring[order[k]] == target[q]:
                    rank[q] = k
