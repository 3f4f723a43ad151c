"""From a triangle soup to half-edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.connectivity import MANY_FACES
from .._kernels.half_edges import HalfEdges, find_outgoing, find_twins
from .._threads import run_in_blocks
from .connectivity import build_connectivity, stars_of

__all__ = ["half_edges_of"]


def half_edges_of(faces: NDArray[np.int32], n_vertices: int) -> tuple[HalfEdges, NDArray[np.int8]]:
    """Return the half-edges of faces, and how many fans of faces are around each vertex.

    Parameters
    ----------
    faces : ndarray of int32, shape (n_faces, 3)
        Faces, all of one orientation.
    n_vertices : int
        Number of vertices.

    Returns
    -------
    HalfEdges
        Topology that the kernels walk and change.
    ndarray of int8, shape (n_vertices,)
        0, 1, or 2 for two and more.

    Raises
    ------
    MeshError
        An edge that more than two faces share, or two faces of opposite orientation.
    """
    indptr, star = stars_of(faces, n_vertices)
    if np.diff(indptr).max(initial=0) > MANY_FACES:
        build_connectivity(faces, n_vertices)  # before each face is compared with all others
    mesh = HalfEdges(
        faces.ravel().copy(),
        np.empty(3 * len(faces), dtype=np.int32),
        np.empty(n_vertices, dtype=np.int32),
    )
    run_in_ranges(find_twins, len(faces), indptr, star, mesh)
    n_fans = np.empty(n_vertices, dtype=np.int8)
    run_in_ranges(find_outgoing, n_vertices, indptr, star, mesh, n_fans)
    if _is_no_surface(mesh, n_fans):
        build_connectivity(faces, n_vertices)  # which says where
    return mesh, n_fans


def _is_no_surface(mesh: HalfEdges, n_fans: NDArray[np.int8]) -> bool:
    """Return whether an edge is shared in a way that no surface does.

    Of two half-edges from a to b, only one can be the twin of its twin, unless nothing runs back
    from b to a: then both are open, and there are several fans around a.
    """

    def look(start: int, stop: int) -> tuple[bool, NDArray[np.int64]]:
        twin = mesh.twin[start:stop]
        is_open = twin < 0
        is_mutual = np.take(mesh.twin, twin, mode="clip") == np.arange(start, stop)
        return bool((is_mutual | is_open).all()), start + np.flatnonzero(is_open)

    looks = run_in_blocks(look, len(mesh.twin))
    if not all(are_mutual for are_mutual, _ in looks):
        return True
    half_edge = np.concatenate([np.empty(0, np.int64), *(open_ones for _, open_ones in looks)])
    half_edge = half_edge[n_fans[mesh.origin[half_edge]] > 1]
    head = mesh.origin[half_edge - half_edge % 3 + (half_edge + 1) % 3]
    edges = np.column_stack([mesh.origin[half_edge], head])
    return len(np.unique(edges, axis=0)) < len(edges)
