"""Kernels of :mod:`wavelet_core.partition.error_guided`: which candidates go, and how."""

import numpy as np

from ._jit import kernel
from .half_edges import MAX_RING, collapse, meets_link_condition, walk_ring

CANDIDATE = 1
TAKEN = 2


# Which of the candidates still in question are cheaper than all such neighbours?
# active (k,) int32; state (n,) int8; cost (n,) float64; key (n,) uint32; wins (k,) bool, filled
@kernel
def find_cheapest(start, stop, active, mesh, state, cost, key, wins):
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for q in range(start, stop):
        v = active[q]
        wins[q] = False
        if state[v] != CANDIDATE:
            continue
        wins[q] = True
        size, _ = walk_ring(v, origin, twin, outgoing, ring, spoke)
        for k in range(size):
            u = ring[k]
            if state[u] == CANDIDATE and (
                cost[u] < cost[v] or (cost[u] == cost[v] and key[u] < key[v])
            ):
                wins[q] = False
                break


# Take the winners, rule their neighbours out
@kernel
def take_cheapest(start, stop, active, wins, mesh, state):
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for q in range(start, stop):
        if not wins[q]:
            continue
        size, _ = walk_ring(active[q], origin, twin, outgoing, ring, spoke)
        for k in range(size):
            state[ring[k]] = 0
        state[active[q]] = TAKEN


# size (n_odd,) int64, filled
@kernel
def measure_rings(start, stop, odd, mesh, size):
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for row in range(start, stop):
        size[row] = walk_ring(odd[row], origin, twin, outgoing, ring, spoke)[0]


# ring, ring_faces (indptr[-1],) int32, filled: from the target on, NO_INDEX where no face follows
@kernel
def record_rings(start, stop, odd, target, mesh, indptr, ring, ring_faces):
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    around, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for row in range(start, stop):
        size, n_sides = walk_ring(odd[row], origin, twin, outgoing, around, spoke)
        j = 0
        while around[j] != target[row]:
            j += 1
        for k in range(indptr[row], indptr[row + 1]):
            ring[k] = around[j]
            ring_faces[k] = spoke[j] // 3 if j < n_sides else -1
            j = j + 1 if j + 1 < size else 0


# Which collapses meet the link condition on the present mesh? is_linked (n_odd,) bool, filled
@kernel
def check_links(start, stop, odd, target, mesh, is_linked):
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for row in range(start, stop):
        size, n_sides = walk_ring(odd[row], origin, twin, outgoing, ring, spoke)
        is_linked[row] = meets_link_condition(
            target[row], ring, 0, size, n_sides, origin, twin, outgoing
        )


# Collapse all that the link condition allows, also against the edges made just before.
# is_taken (n_odd,) bool, filled
@kernel
def collapse_all(odd, indptr, ring, ring_faces, mesh, vertex_lives, face_lives, is_taken):
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    for row in range(odd.shape[0]):
        base, size = indptr[row], indptr[row + 1] - indptr[row]
        n_sides = 0
        for k in range(base, base + size):
            n_sides += ring_faces[k] >= 0
        is_taken[row] = meets_link_condition(
            ring[base], ring, base, size, n_sides, origin, twin, outgoing
        )
        if is_taken[row]:
            collapse(odd[row], ring, ring_faces, base, size, origin, twin, outgoing, face_lives)
            vertex_lives[odd[row]] = False
