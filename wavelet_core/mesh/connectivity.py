"""From a triangle soup to ordered one-rings."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.connectivity import BOUNDARY, INTERIOR, ISOLATED, PINCH, fill_stars, order_rings
from ..errors import MeshError

__all__ = [
    "BOUNDARY",
    "INTERIOR",
    "ISOLATED",
    "PINCH",
    "Connectivity",
    "build_connectivity",
    "edges_of",
    "stars_of",
]


#: Faces that a message names.
NAMED = 6


class Connectivity(NamedTuple):
    """Stars and ordered one-rings of the vertices of one mesh.

    star_indptr : (n_vertices + 1,) int64; star : (3 n_faces,) int32
        Faces of vertex v are ``star[star_indptr[v]:star_indptr[v + 1]]``.
    ring : (3 n_faces + n_vertices,) int32; ring_size : (n_vertices,) int32
        One-ring of v, counter-clockwise: ``ring[star_indptr[v] + v:][:ring_size[v]]``. On the
        outline it runs from one outline neighbour to the other. Pinch and isolated vertices
        have no ordered ring: their size is 0.
    kind : (n_vertices,) int8
        INTERIOR, BOUNDARY, PINCH (two fans of faces touch here only) or ISOLATED (no face).
    """

    star_indptr: NDArray[np.int64]
    star: NDArray[np.int32]
    ring: NDArray[np.int32]
    ring_size: NDArray[np.int32]
    kind: NDArray[np.int8]

    def one_ring(self, vertex: int) -> NDArray[np.int32]:
        """Return the ordered neighbours of one vertex."""
        base = self.star_indptr[vertex] + vertex
        return self.ring[base : base + self.ring_size[vertex]]


def edges_of(faces: NDArray[np.integer]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the edges of faces, each once.

    Parameters
    ----------
    faces : ndarray of int, shape (n_faces, 3)
        Faces.

    Returns
    -------
    edges : ndarray of int64, shape (n_edges, 2)
        The lower vertex first, in ascending order.
    n_faces : ndarray of int64, shape (n_edges,)
        How many faces have each: 1 on the outline, 2 within.

    Examples
    --------
    >>> edges, n_faces = edges_of(np.array([[0, 1, 2], [2, 1, 3]]))
    >>> edges.tolist(), n_faces.tolist()
    ([[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]], [1, 1, 2, 1, 1])
    """
    tails, heads = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel()
    n = int(tails.max(initial=0)) + 1
    # one number for each edge: rows would be sorted with the interpreter held, for seconds
    sides = np.minimum(tails, heads) * n + np.maximum(tails, heads)
    keys, n_faces = np.unique(sides, return_counts=True)
    return np.column_stack(np.divmod(keys, n)), n_faces


def stars_of(
    faces: NDArray[np.int32], n_vertices: int
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Return the faces around every vertex.

    Parameters
    ----------
    faces : ndarray of int32, shape (n_faces, 3)
        Faces.
    n_vertices : int
        Number of vertices.

    Returns
    -------
    indptr : ndarray of int64, shape (n_vertices + 1,)
    star : ndarray of int32, shape (3 n_faces,)
        Faces of vertex v are ``star[indptr[v]:indptr[v + 1]]``.
    """
    indptr = np.zeros(n_vertices + 1, dtype=np.int64)
    star = np.empty(3 * len(faces), dtype=np.int32)
    fill_stars(faces, indptr, star)
    return indptr, star


def build_connectivity(faces: NDArray[np.int32], n_vertices: int) -> Connectivity:
    """Return stars and one-rings of a triangle soup.

    Parameters
    ----------
    faces : ndarray of int32, shape (n_faces, 3)
        Faces, all of one orientation.
    n_vertices : int
        Number of vertices.

    Raises
    ------
    MeshError
        An edge that more than two faces share, or two faces of opposite orientation.
    """
    star_indptr, star = stars_of(faces, n_vertices)
    ring = np.empty(3 * len(faces) + n_vertices, dtype=np.int32)
    ring_size = np.empty(n_vertices, dtype=np.int32)
    kind = np.empty(n_vertices, dtype=np.int8)
    bad_neighbour = np.empty(n_vertices, dtype=np.int32)
    run_in_ranges(
        order_rings, n_vertices, faces, star_indptr, star, kind, ring, ring_size, bad_neighbour
    )
    if (bad_neighbour >= 0).any():
        vertex = int(np.argmax(bad_neighbour >= 0))
        neighbour = int(bad_neighbour[vertex])
        users = np.unique(star[star_indptr[vertex] : star_indptr[vertex + 1]])
        users = users[(faces[users] == neighbour).any(axis=1)]
        more = f" and {len(users) - NAMED:,} more" if len(users) > NAMED else ""
        raise MeshError(
            f"faces {users[:NAMED].tolist()}{more} share the edge {vertex}-{neighbour} in a way no "
            "surface does (more than two of them, or of opposite orientation); remove or reorient "
            "the offending face.",
            vertex,
        )
    return Connectivity(star_indptr, star, ring, ring_size, kind)
