"""Kernels of :mod:`wavelet_core.partition.error_guided`: which candidates go, and how."""

import numpy as np

from ._jit import inlined, kernel
from .half_edges import MAX_RING, after, before, collapse, meets_link_condition, walk_ring

CANDIDATE = 1
TAKEN = 2
# after the place of any vertex
OUT_OF_QUESTION = np.uint64(2**64 - 1)


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


# Which of the vertices still in question come before all such neighbours?
# active (k,) int32; place (n,) uint64, all different, OUT_OF_QUESTION for the others; wins (k,)
# bool, filled; rival (n,) int32, kept from call to call: a neighbour that came before, at first
# the vertex itself. While it is in question, the others need not be looked at.
@kernel
def find_first(start, stop, active, mesh, place, wins, rival):
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    for q in range(start, stop):
        v = active[q]
        if place[rival[v]] >= place[v]:
            rival[v] = neighbour_before(v, origin, twin, outgoing, place)
        wins[q] = rival[v] == v


# A neighbour of v that comes before it; v itself if there is none
@inlined
def neighbour_before(v, origin, twin, outgoing, place):
    half_edge, own = outgoing[v], place[v]
    for _ in range(MAX_RING):
        u = origin[after(half_edge)]
        if place[u] < own:
            return u
        last = before(half_edge)
        half_edge = twin[last]
        if half_edge < 0:
            return origin[last] if place[origin[last]] < own else v
        if half_edge == outgoing[v]:
            break
    return v


# Take the winners and their neighbours out of question
@kernel
def take_first(start, stop, active, wins, mesh, place):
    origin, twin, outgoing = mesh.origin, mesh.twin, mesh.outgoing
    ring, spoke = np.empty(MAX_RING, np.int32), np.empty(MAX_RING, np.int32)
    for q in range(start, stop):
        if wins[q]:
            size, _ = walk_ring(active[q], origin, twin, outgoing, ring, spoke)
            for k in range(size):
                place[ring[k]] = OUT_OF_QUESTION
            place[active[q]] = OUT_OF_QUESTION


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
