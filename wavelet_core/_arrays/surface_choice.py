"""Which candidates go, on whole arrays; see :mod:`wavelet_core._kernels.surface_choice`."""

from __future__ import annotations

import numpy as np

from .._kernels.surface_choice import CANDIDATE, TAKEN
from ._csr import expanded
from .half_edges import after, find_twins, rings_of, set_outgoing


def find_cheapest(start, stop, active, mesh, state, cost, key, wins):
    wins[:] = False
    asked = np.flatnonzero(state[active] == CANDIDATE)
    v = active[asked]
    ring = rings_of(v, mesh).ring
    rivals = (ring >= 0) & (state[ring] == CANDIDATE)
    own = cost[v][:, None]
    wins_over = (cost[ring] < own) | ((cost[ring] == own) & (key[ring] < key[v][:, None]))
    wins[asked] = ~(rivals & wins_over).any(axis=1)


def take_cheapest(start, stop, active, wins, mesh, state):
    taken = active[wins]
    ring = rings_of(taken, mesh).ring
    state[ring[ring >= 0]] = 0
    state[taken] = TAKEN


def measure_rings(start, stop, odd, mesh, size):
    size[:] = rings_of(odd, mesh).size


def record_rings(start, stop, odd, target, mesh, indptr, ring, ring_faces):
    rings = rings_of(odd, mesh)
    j = np.argmax(rings.ring == target[:, None], axis=1)
    row, place = expanded(np.zeros(len(odd), np.int64), rings.size)
    column = (place + j[row]) % rings.size[row]
    ring[:] = rings.ring[row, column]
    ring_faces[:] = np.where(column < rings.n_sides[row], rings.spoke[row, column] // 3, -1)


def collapse_all(odd, indptr, ring, ring_faces, mesh, vertex_lives, face_lives, stamp, is_taken):
    size = np.diff(indptr)
    row, place = expanded(indptr[:-1], size)
    is_taken[:] = _keeps_links(odd, indptr, ring, ring_faces, mesh, face_lives, row, place)
    taken = np.flatnonzero(is_taken)
    vertex_lives[odd[taken]] = False
    a = ring[indptr[:-1]]
    with_face = is_taken[row] & (ring_faces >= 0)
    faces, source, onto = ring_faces[with_face], odd[row[with_face]], a[row[with_face]]
    for corner in range(3):
        half_edge = 3 * faces + corner
        is_it = mesh.origin[half_edge] == source
        mesh.origin[half_edge[is_it]] = onto[is_it]
    k = place - indptr[row]
    closes = with_face & ((k == 0) | (k == size[row] - 1))
    face_lives[ring_faces[closes]] = False
    _link_again(mesh, face_lives)


def _keeps_links(odd, indptr, ring, ring_faces, mesh, face_lives, row, place):
    """Link condition of every collapse, those before it in the list counted as done."""
    size = np.diff(indptr)
    a = ring[indptr[:-1]]
    n = len(mesh.outgoing)
    n_sides = np.bincount(row[ring_faces >= 0], minlength=len(odd))
    needed = np.where(n_sides == size, 2, 1)
    # edges of the level that leave a target
    half_edges = (3 * np.flatnonzero(face_lives)[:, None] + np.arange(3)).ravel()
    tail, head = mesh.origin[half_edges], mesh.origin[after(half_edges)]
    is_target = np.zeros(n, dtype=bool)
    is_target[a] = True
    tail, head = np.concatenate([tail, head]), np.concatenate([head, tail])
    asked = is_target[tail]
    edges = np.unique(tail[asked].astype(np.int64) * n + head[asked])
    spokes = a[row].astype(np.int64) * n + ring[place]
    is_edge = _contains(edges, spokes)
    shared = np.bincount(row[is_edge], minlength=len(odd))
    keeps = shared == needed
    # edges that the collapses make; two that share one, or both ends of one, may be in each
    # other's way, and are decided in order
    makes = keeps[row] & ~is_edge & (place > indptr[row])
    made = spokes[makes]
    maker = row[makes]
    mirrored = ring[place[makes]].astype(np.int64) * n + a[maker]
    keys, makers = np.concatenate([made, mirrored]), np.concatenate([maker, maker])
    order = np.argsort(keys, kind="stable")
    keys, makers = keys[order], makers[order]
    low = np.searchsorted(keys, made, side="left")
    high = np.searchsorted(keys, made, side="right")
    which, entry = expanded(low, high - low)
    contested, other = maker[which], makers[entry]
    is_earlier = other < contested
    contested, other = contested[is_earlier], other[is_earlier]
    order = np.lexsort((other, contested))
    for w, v in zip(contested[order].tolist(), other[order].tolist(), strict=True):
        if keeps[w] and keeps[v]:
            keeps[w] = False
    return keeps


def _contains(sorted_keys, keys):
    place = np.searchsorted(sorted_keys, keys)
    return sorted_keys[np.minimum(place, len(sorted_keys) - 1)] == keys


def _link_again(mesh, face_lives):
    faces = np.flatnonzero(face_lives)
    half_edges = (3 * faces[:, None] + np.arange(3)).ravel()
    live = mesh._replace(
        origin=mesh.origin[half_edges], twin=np.empty(len(half_edges), dtype=np.int32)
    )
    find_twins(0, 0, None, None, live)
    mesh.twin[half_edges] = np.where(live.twin >= 0, half_edges[live.twin], -1)
    set_outgoing(half_edges, mesh)
