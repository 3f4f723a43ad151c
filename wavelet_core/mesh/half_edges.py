"""From a triangle soup to half-edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.half_edges import HalfEdges, find_outgoing, find_twins
from .connectivity import stars_of

__all__ = ["half_edges_of"]


def half_edges_of(faces: NDArray[np.int32], n_vertices: int) -> tuple[HalfEdges, NDArray[np.int8]]:
    """Return the half-edges of faces, and how many fans of faces are around each vertex.

    Parameters
    ----------
    faces : ndarray of int32, shape (n_faces, 3)
        Faces of a manifold, all of one orientation.
    n_vertices : int
        Number of vertices.

    Returns
    -------
    HalfEdges
        Topology that the kernels walk and change.
    ndarray of int8, shape (n_vertices,)
        0, 1, or 2 for two and more.
    """
    indptr, star = stars_of(faces, n_vertices)
    mesh = HalfEdges(
        faces.ravel().copy(),
        np.empty(3 * len(faces), dtype=np.int32),
        np.empty(n_vertices, dtype=np.int32),
    )
    run_in_ranges(find_twins, len(faces), indptr, star, mesh)
    n_fans = np.empty(n_vertices, dtype=np.int8)
    run_in_ranges(find_outgoing, n_vertices, indptr, star, mesh, n_fans)
    return mesh, n_fans
