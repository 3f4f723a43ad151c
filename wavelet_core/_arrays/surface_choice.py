"""Which candidates go, on whole arrays; see :mod:`wavelet_core._kernels.surface_choice`."""

from __future__ import annotations

import numpy as np

from .._kernels.surface_choice import CANDIDATE, OUT_OF_QUESTION, TAKEN
from ._csr import expanded
from .half_edges import after, before, rings_of


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


def find_first(start, stop, active, mesh, place, wins, rival):
    ring = rings_of(active, mesh).ring
    around = np.where(ring >= 0, place[ring], OUT_OF_QUESTION)
    wins[:] = around.min(axis=1, initial=OUT_OF_QUESTION) > place[active]


def take_first(start, stop, active, wins, mesh, place):
    taken = active[wins]
    ring = rings_of(taken, mesh).ring
    place[ring[ring >= 0]] = OUT_OF_QUESTION
    place[taken] = OUT_OF_QUESTION


def measure_rings(start, stop, odd, mesh, size):
    size[:] = rings_of(odd, mesh).size


def record_rings(start, stop, odd, target, mesh, indptr, ring, ring_faces):
    rings = rings_of(odd, mesh)
    j = np.argmax(rings.ring == target[:, None], axis=1)
    row, place = expanded(np.zeros(len(odd), np.int64), rings.size)
    column = (place + j[row]) % rings.size[row]
    ring[:] = rings.ring[row, column]
    ring_faces[:] = np.where(column < rings.n_sides[row], rings.spoke[row, column] // 3, -1)


def check_links(start, stop, odd, target, mesh, is_linked):
    rings = rings_of(odd, mesh)
    for size, n_sides in np.unique(np.column_stack([rings.size, rings.n_sides]), axis=0):
        rows = np.flatnonzero((rings.size == size) & (rings.n_sides == n_sides))
        is_linked[rows] = are_linked(rings.ring[rows, :size], target[rows], n_sides, mesh)


def are_linked(ring, target, n_sides, mesh):
    """Return of each ring whether it shares with the target's only the two beside the target."""
    n, size = ring.shape
    shared = np.zeros(n, dtype=np.int64)
    active, half_edge = np.arange(n), mesh.outgoing[target]
    opening = half_edge
    while len(active):
        last = before(half_edge)
        u = mesh.origin[after(half_edge)]
        shared[active] += (ring[active] == u[:, None]).any(axis=1)
        half_edge = mesh.twin[last]
        is_open = half_edge < 0
        ends = active[is_open]
        u = mesh.origin[last[is_open]]
        shared[ends] += (ring[ends] == u[:, None]).any(axis=1)
        goes_on = ~is_open & (half_edge != opening[active])
        active, half_edge = active[goes_on], half_edge[goes_on]
    return shared == (2 if n_sides == size else 1)


def collapse_all(odd, indptr, ring, ring_faces, mesh, vertex_lives, face_lives, is_taken):
    size = np.diff(indptr)
    row, place = expanded(indptr[:-1], size)
    check_links(0, len(odd), odd, ring[indptr[:-1]], mesh, is_taken)
    _refuse_doubled_edges(odd, indptr, ring, ring_faces, mesh, row, place, is_taken)
    vertex_lives[odd[is_taken]] = False
    a = ring[indptr[:-1]]
    with_face = is_taken[row] & (ring_faces >= 0)
    faces, source, onto = ring_faces[with_face], odd[row[with_face]], a[row[with_face]]
    for corner in range(3):
        half_edge = 3 * faces + corner
        is_it = mesh.origin[half_edge] == source
        mesh.origin[half_edge[is_it]] = onto[is_it]
    k = place - indptr[row]
    closes = np.flatnonzero(with_face & ((k == 0) | (k == size[row] - 1)))
    apex = np.where(
        k[closes] == 0, ring[np.minimum(place[closes] + 1, len(ring) - 1)], ring[place[closes]]
    )
    face_lives[ring_faces[closes]] = False
    _close_faces(ring_faces[closes], apex, mesh, face_lives)


def _refuse_doubled_edges(odd, indptr, ring, ring_faces, mesh, row, place, is_taken):
    """Refuse what an edge forbids that a collapse before it in the list has made.

    No two odd vertices are neighbours, so a collapse takes no edge between vertices that stay; it
    only makes edges from its target to the rest of its ring but the two beside the target. Of two
    that make one, the first does. As the link condition, this looks around one fan of the target.
    """
    n = len(mesh.outgoing)
    a = ring[indptr[:-1]]
    joins = is_taken[row] & (place > indptr[row])
    is_beside = ((place == indptr[row] + 1) & (ring_faces[indptr[row]] >= 0)) | (
        (place == indptr[row + 1] - 1) & (ring_faces[place] >= 0)
    )
    spokes = a[row].astype(np.int64) * n + ring[place]
    makes = joins & ~is_beside
    mirrored = ring[place[makes]].astype(np.int64) * n + a[row[makes]]
    keys, makers = np.concatenate([spokes[makes], mirrored]), np.tile(row[makes], 2)
    order = np.argsort(keys, kind="stable")
    keys, makers = keys[order], makers[order]
    low = np.searchsorted(keys, spokes[joins], side="left")
    high = np.searchsorted(keys, spokes[joins], side="right")
    which, entry = expanded(low, high - low)
    later, earlier = row[joins][which], makers[entry]
    differs = earlier < later
    later, earlier = later[differs], earlier[differs]
    is_seen = (rings_of(a[later], mesh).ring == odd[earlier][:, None]).any(axis=1)
    later, earlier = later[is_seen], earlier[is_seen]
    order = np.lexsort((earlier, later))
    for second, first in zip(later[order].tolist(), earlier[order].tolist(), strict=True):
        if is_taken[second] and is_taken[first]:
            is_taken[second] = False


def _close_faces(faces, apex, mesh, face_lives):
    """Let the two sides at the apex of each closed face meet, and those beyond them."""
    half_edge = 3 * faces.astype(np.int64)
    for corner in range(3):
        half_edge = np.where(
            mesh.origin[3 * faces + corner] == apex, 3 * faces.astype(np.int64) + corner, half_edge
        )
    beyond = np.full(len(mesh.twin), -1, dtype=np.int64)  # the other of the two sides
    beyond[half_edge], beyond[before(half_edge)] = before(half_edge), half_edge
    live = (3 * np.flatnonzero(face_lives)[:, None] + np.arange(3)).ravel()
    twin = mesh.twin[live].astype(np.int64)
    open_ = np.flatnonzero((twin >= 0) & ~face_lives[twin // 3])
    while len(open_):
        twin[open_] = mesh.twin[beyond[twin[open_]]]
        open_ = open_[(twin[open_] >= 0) & ~face_lives[twin[open_] // 3]]
    mesh.twin[live] = twin
