"""How long edges may be, by place: how fast that may grow, and where a mesh exceeds it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from wavelet_core import TriangleMesh
from wavelet_core._validate import distinct
from wavelet_core.mesh.connectivity import edges_of
from wavelet_core.mesh.location import cover_of

__all__ = ["SizeField", "graded", "pieces_within"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Along edges and diagonals of a grid a way is at most so much longer than the straight one.
_DETOUR = 1 / np.cos(np.pi / 8)


def graded(mesh: TriangleMesh, sizes: FloatArray, grading: float) -> FloatArray:
    """Return sizes that grow no faster than a share of the distance, and are no larger.

    Parameters
    ----------
    mesh : TriangleMesh
        The terrain.
    sizes : (n_vertices,) float64
        Above 0; infinite for any.
    grading : float
        By how much sizes may grow for each unit of distance in plan, above 0.

    Returns
    -------
    (n_vertices,) float64
        The least of each vertex's own size and, over all others, of theirs and ``grading`` times
        the distance: the Lipschitz extension of Persson, "Mesh size functions for implicit
        geometries and PDE-based gradient limiting", 2006. The distance is the shortest way over the
        edges of the terrain and across them, shortened so that on a grid none is overrated.
    """
    pairs = np.concatenate([edges_of(mesh.faces)[0], _across_edges(mesh.faces)]).astype(np.int64)
    plan, n = mesh.vertices[:, :2], mesh.n_vertices
    pairs = np.column_stack(divmod(distinct(pairs.min(axis=1) * n + pairs.max(axis=1)), n))
    lengths = np.linalg.norm(plan[pairs[:, 0]] - plan[pairs[:, 1]], axis=1) / _DETOUR
    known = np.flatnonzero(np.isfinite(sizes))
    # One more node, from which every size is as far as it takes to grow to it.
    graph = coo_matrix(
        (
            np.concatenate([lengths, sizes[known] / grading]),
            (
                np.concatenate([pairs[:, 0], np.full(len(known), n)]),
                np.concatenate([pairs[:, 1], known]),
            ),
        ),
        shape=(n + 1, n + 1),
    ).tocsr()
    reached = dijkstra(graph, directed=False, indices=n)[:n]
    return np.minimum(sizes, grading * reached)


def _across_edges(faces: NDArray[np.integer]) -> IntArray:
    """Return the pairs of vertices that two faces have on either side of their common edge."""
    ends = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    beyond = faces[:, [2, 0, 1]].ravel()
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, beyond = ends[order], beyond[order]
    is_shared = (ends[1:] == ends[:-1]).all(axis=1)
    return np.column_stack([beyond[:-1][is_shared], beyond[1:][is_shared]]).astype(np.int64)


def pieces_within(
    points: FloatArray, edges: IntArray, field: SizeField
) -> tuple[FloatArray, IntArray]:
    """Return edges halved until none is longer than the field has it at its ends and middle.

    Parameters
    ----------
    points : (n, 2) float64
    edges : (m, 2) int64
    field : SizeField

    Returns
    -------
    points : (n + k, 2) float64
        The middles follow.
    edges : (m + k, 2) int64
    """
    done, waiting = [np.empty((0, 2), dtype=np.int64)], edges
    while len(waiting):
        middles = (points[waiting[:, 0]] + points[waiting[:, 1]]) / 2
        lengths = np.linalg.norm(points[waiting[:, 0]] - points[waiting[:, 1]], axis=1)
        most = np.minimum(field.at(points[waiting]).min(axis=1), field.at(middles))
        is_long = lengths > most
        done.append(waiting[~is_long])
        new = len(points) + np.arange(np.count_nonzero(is_long))
        points = np.concatenate([points, middles[is_long]])
        first, last = waiting[is_long].T
        waiting = np.concatenate([np.column_stack([first, new]), np.column_stack([new, last])])
    return points, np.concatenate(done)


class _Candidates(NamedTuple):
    """Places for new nodes, and the radius around each in which it is the only one."""

    places: FloatArray
    radii: FloatArray


class SizeField:
    """The longest edge that a mesh may have, by place.

    Parameters
    ----------
    plan : (n, 2) float64
        Vertices of the terrain.
    sizes : (n,) float64
        The longest edge there, above 0; infinite for any.

    Notes
    -----
    A triangle keeps it if no edge is longer than the size at any vertex of the terrain that lies
    in it, nor than that at the vertices nearest to its corners.
    """

    def __init__(self, plan: FloatArray, sizes: FloatArray) -> None:
        self._plan = plan
        self._sizes = sizes
        self._tree = cKDTree(plan)

    def at(self, places: FloatArray) -> FloatArray:
        """Return the size at the nearest vertices of the terrain to places, ``(..., 2)``."""
        return self._sizes[self._tree.query(places)[1]]

    def places_to_add(
        self, points: FloatArray, faces: IntArray, boundaries: FloatArray
    ) -> FloatArray:
        """Return places that make triangles smaller where they exceed it; none if none does.

        Parameters
        ----------
        points : (n, 2) float64
        faces : (m, 3) int64
        boundaries : (k, 2, 2) float64
            Ends of the edges that stay, whole or split.

        Returns
        -------
        (n_places, 2) float64
            Of each triangle, where no other is near, its circumcentre; or the middle of its longest
            edge, where that lies outside or would encroach upon an edge that stays.
        """
        mesh = TriangleMesh(np.column_stack([points, np.zeros(len(points))]), faces)
        corners = points[faces]
        longest = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
        most = self.at(points)[faces].min(axis=1)
        cover = cover_of(mesh, self._plan)
        np.minimum.at(most, cover.face, self._sizes[cover.point])
        found = _candidates(mesh, corners[longest > most], boundaries)
        return found.places[_apart(found)]


def _candidates(mesh: TriangleMesh, corners: FloatArray, boundaries: FloatArray) -> _Candidates:
    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.linalg.norm(sides, axis=2)
    longest = lengths.argmax(axis=1)
    rows = np.arange(len(corners))
    middles = corners[rows, longest] + sides[rows, longest] / 2
    centres = _circumcentres(corners)
    is_inside = np.zeros(len(corners), dtype=bool)
    is_inside[cover_of(mesh, centres).point] = True
    is_inside[_encroaching(centres, boundaries)] = False
    radii = np.linalg.norm(centres - corners[:, 0], axis=1)
    return _Candidates(
        np.where(is_inside[:, None], centres, middles),
        np.where(is_inside, radii, lengths[rows, longest] / 2),
    )


def _circumcentres(corners: FloatArray) -> FloatArray:
    b, c = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    twice = 2 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    b2, c2 = (b**2).sum(axis=1), (c**2).sum(axis=1)
    x = (c[:, 1] * b2 - b[:, 1] * c2) / twice
    y = (b[:, 0] * c2 - c[:, 0] * b2) / twice
    return corners[:, 0] + np.column_stack([x, y])


def _encroaching(places: FloatArray, boundaries: FloatArray) -> IntArray:
    """Return the places that lie in the circle over some edge that stays."""
    import shapely

    middles = boundaries.mean(axis=1)
    radii = np.linalg.norm(boundaries[:, 1] - boundaries[:, 0], axis=1)[:, None] / 2
    boxes = shapely.box(*(middles - radii).T, *(middles + radii).T)
    edge, place = shapely.STRtree(shapely.points(places)).query(boxes)
    is_near = np.linalg.norm(places[place] - middles[edge], axis=1) < radii[edge, 0]
    return np.unique(place[is_near])


def _apart(found: _Candidates) -> IntArray:
    """Return candidates of which none lies within the radius of another, the widest first."""
    if len(found.places) == 0:
        return np.empty(0, dtype=np.int64)
    tree = cKDTree(found.places)
    is_free, chosen = np.ones(len(found.places), dtype=bool), []
    for row in np.argsort(-found.radii, kind="stable").tolist():
        if is_free[row]:
            chosen.append(row)
            is_free[tree.query_ball_point(found.places[row], found.radii[row])] = False
    return np.array(chosen, dtype=np.int64)
