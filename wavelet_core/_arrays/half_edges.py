"""Whole-array half-edges; see :mod:`wavelet_core._kernels.half_edges`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._kernels.half_edges import MAX_RING, HalfEdges
from ..progress import report_share


class Rings(NamedTuple):
    """One-rings of some vertices, one row a vertex; -1 where a row has ended.

    ring, spoke : (n, width) int32
        Neighbours, counter-clockwise, and the half-edges to them.
    size, n_sides : (n,) int64
        As ``walk_ring`` returns them.
    """

    ring: NDArray[np.int32]
    spoke: NDArray[np.int32]
    size: NDArray[np.int64]
    n_sides: NDArray[np.int64]


def before(half_edge):
    """Return the half-edge before each, in its face."""
    return half_edge - 1 + 3 * (half_edge % 3 == 0)


def after(half_edge):
    """Return the half-edge after each, in its face."""
    return half_edge + 1 - 3 * (half_edge % 3 == 2)


def rings_of(vertices: NDArray[np.integer], mesh: HalfEdges) -> Rings:
    """Walk around all vertices at once; none of them may be isolated."""
    n = len(vertices)
    opening = mesh.outgoing[vertices]
    ring, spoke = np.full((n, 8), -1, np.int32), np.full((n, 8), -1, np.int32)
    size, n_sides = np.zeros(n, np.int64), np.zeros(n, np.int64)
    active, half_edge = np.arange(n), opening
    for k in range(MAX_RING - 1):
        if len(active) == 0:
            break
        if k + 2 > ring.shape[1]:
            wider = ((0, 0), (0, 8))
            ring, spoke = (np.pad(a, wider, constant_values=-1) for a in (ring, spoke))
        last = before(half_edge)
        ring[active, k] = mesh.origin[after(half_edge)]
        spoke[active, k] = half_edge
        half_edge = mesh.twin[last]
        is_open, is_closed = half_edge < 0, half_edge == opening[active]
        ends = active[is_open]
        ring[ends, k + 1] = mesh.origin[last[is_open]]
        size[ends], n_sides[ends] = k + 2, k + 1
        size[active[is_closed]], n_sides[active[is_closed]] = k + 1, k + 1
        goes_on = ~(is_open | is_closed)
        active, half_edge = active[goes_on], half_edge[goes_on]
    ring[active], spoke[active] = -1, -1  # too many neighbours
    width = int(size.max(initial=0))
    return Rings(ring[:, :width], spoke[:, :width], size, n_sides)


def find_twins(start, stop, indptr, star, mesh):
    origin = mesh.origin.astype(np.int64)
    half_edges = np.arange(len(origin))
    head = origin[after(half_edges)]
    n = int(origin.max(initial=0)) + 1
    # neighbours in this order are twins: no search, which takes four times as long on scattered ids
    edge = np.minimum(origin, head) * n + np.maximum(origin, head)
    report_share(0.1)
    order = np.argsort(edge, kind="stable")
    report_share(0.6)
    sizes = np.diff(np.flatnonzero(np.diff(edge[order], prepend=-1, append=-1)))
    first = np.cumsum(sizes) - sizes
    report_share(0.8)
    mesh.twin[:] = -1
    one, other = order[first[sizes == 2]], order[first[sizes == 2] + 1]
    mesh.twin[one], mesh.twin[other] = other, one
    # two of one direction, or more than two: what no manifold has
    is_odd_one = np.repeat(sizes > 2, sizes)
    alike = origin[one] == origin[other]
    _find_some_twins(
        np.sort(np.concatenate([order[is_odd_one], one[alike], other[alike]])),
        origin * n + head,
        head * n + origin,
        mesh,
    )


def _find_some_twins(half_edges, key, mirrored, mesh):
    """Find the twins of half-edges among themselves, the first where there are several."""
    if len(half_edges) == 0:
        return
    order = half_edges[np.argsort(key[half_edges], kind="stable")]
    place = np.searchsorted(key[order], mirrored[half_edges])
    twin = order[np.minimum(place, len(order) - 1)]
    mesh.twin[half_edges] = np.where(key[twin] == mirrored[half_edges], twin, -1)


def find_outgoing(start, stop, indptr, star, mesh, n_fans):
    n_vertices = len(mesh.outgoing)
    degree = np.diff(indptr)
    set_outgoing(np.arange(len(mesh.origin)), mesh)
    report_share(0.3)
    is_open = mesh.twin < 0
    n_open = np.bincount(mesh.origin[is_open], minlength=n_vertices)
    walked = np.zeros(n_vertices, dtype=np.int64)
    active = np.flatnonzero(degree > 0)
    half_edge = mesh.outgoing[active]
    while len(active):
        walked[active] += 1
        half_edge = mesh.twin[before(half_edge)]
        goes_on = (half_edge >= 0) & (half_edge != mesh.outgoing[active])
        goes_on &= walked[active] < degree[active]
        active, half_edge = active[goes_on], half_edge[goes_on]
        report_share(1.0 - 0.7 * len(active) / n_vertices)
    n_fans[:] = np.where(degree == 0, 0, np.where((walked == degree) & (n_open < 2), 1, 2))


def set_outgoing(half_edges, mesh):
    """Let every vertex name its first half-edge, or the last without a twin; -1 without any."""
    mesh.outgoing[:] = -1
    backwards = half_edges[::-1]
    mesh.outgoing[mesh.origin[backwards]] = backwards  # the first is written last
    opening = half_edges[mesh.twin[half_edges] < 0]
    mesh.outgoing[mesh.origin[opening]] = opening


def renew_outgoing(mesh, face_lives):
    set_outgoing((3 * np.flatnonzero(face_lives)[:, None] + np.arange(3)).ravel(), mesh)


def moved(half_edge, face_position):
    return np.where(half_edge >= 0, 3 * face_position[half_edge // 3] + half_edge % 3, -1)


def pack_faces(start, stop, faces, position, face_position, mesh, packed):
    half_edges = (3 * faces[:, None] + np.arange(3)).ravel()
    packed.origin[:] = position[mesh.origin[half_edges]]
    packed.twin[:] = moved(mesh.twin[half_edges], face_position)


def pack_vertices(start, stop, vertices, face_position, mesh, packed):
    packed.outgoing[:] = moved(mesh.outgoing[vertices], face_position)
