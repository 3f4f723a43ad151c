"""Gaps of scattered points: faces that span where nothing was measured."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from .._kernels.geometry import measure_faces
from .._threads import run_in_blocks
from .._validate import FloatArray, IntArray
from ..errors import MeshError, OptionError

__all__ = ["GAP_FACTOR", "PointGaps", "faces_within", "gaps_of"]

#: An edge this many times as long as the spacing that 95 % of the points keep spans a gap. On five
#: clouds, whole and with a hole cut out that is 20 such spacings wide: 5 takes 0.2 to 1.7 % of the
#: triangles of the whole and leaves the hole open; 3 takes 0.6 to 3.1 %; 8 closes up to 5 % of it.
GAP_FACTOR = 5.0

_BLOCK = 1 << 20


class PointGaps(NamedTuple):
    """How densely points lie, and where they do not.

    length : float
        An edge from this length on spans a gap.
    spacing : float
        Side of the square that one point has to itself, gaps left out.
    share : float
        Part of the triangulated area in faces with an edge of more than twice `length`.
    """

    length: float
    spacing: float
    share: float


def gaps_of(plan: FloatArray, faces: IntArray) -> PointGaps:
    """Return how densely scattered points lie.

    Parameters
    ----------
    plan : ndarray, shape (n_points, 2)
        Horizontal coordinates.
    faces : ndarray of int, shape (n_faces, 3)
        Their Delaunay faces.

    Notes
    -----
    **Our choice:** an edge spans a gap from `GAP_FACTOR` times the 95th percentile of the distance
    between a point and its nearest neighbour, which is the shortest of its Delaunay edges. In dense
    forest, and on tiles with the usual overlaps, that takes less than 1 % of the area for gaps; in
    towns with canals, the water.
    """
    nearest = np.full(len(plan), np.inf)
    longest, doubled = np.empty(len(faces)), np.empty(len(faces))
    for start in range(0, len(faces), _BLOCK):
        stop = min(start + _BLOCK, len(faces))
        measure_faces(start, stop, plan, faces, nearest, longest, doubled)
    nearest, longest, areas = np.sqrt(nearest), np.sqrt(longest), doubled / 2
    length = GAP_FACTOR * float(np.percentile(nearest[np.isfinite(nearest)], 95))
    is_dense = longest <= length
    if not is_dense.any():  # a handful of points
        is_dense[:] = True
    is_used = np.zeros(len(plan), dtype=bool)

    def use(start: int, stop: int) -> None:
        for corner in faces[start:stop].T:
            is_used[corner[is_dense[start:stop]]] = True

    run_in_blocks(use, len(faces))
    return PointGaps(
        length=length,
        spacing=float(np.sqrt(areas[is_dense].sum() / np.count_nonzero(is_used))),
        share=float(areas[longest > 2 * length].sum() / areas.sum()),
    )


def faces_within(
    plan: FloatArray, faces: IntArray, max_edge: float, *, from_outline: bool = False
) -> IntArray:
    """Return the faces that span no gap.

    Parameters
    ----------
    plan : ndarray, shape (n_points, 2)
        Horizontal coordinates.
    faces : ndarray of int, shape (n_faces, 3)
        Of a triangulation.
    max_edge : float
        A longer edge spans a gap.
    from_outline : bool
        Leave out only what is reached from outside across longer edges: the outline becomes
        concave and gaps inside stay closed. Otherwise every face with a longer edge goes.

    Raises
    ------
    OptionError
        `max_edge` is not positive.
    MeshError
        No face is left.
    """
    if not max_edge > 0:
        raise OptionError("{0} is {given}; give a length above 0.", "max_edge", given=max_edge)
    is_long = _is_long(plan, faces, max_edge)
    gone = _open_to_outside(faces, is_long, len(plan)) if from_outline else is_long.any(axis=1)
    if gone.all():
        raise MeshError(
            "every face has an edge longer than {0} = {given:g}, so no surface is left; give a "
            "larger one.",
            None,
            "max_edge",
            given=max_edge,
        )
    return faces[~gone]


def _is_long(plan: FloatArray, faces: IntArray, max_edge: float) -> NDArray[np.bool_]:
    """Return which edges of the faces are longer, the k-th from corner k to the next."""
    is_long = np.empty((len(faces), 3), dtype=bool)
    for start in range(0, len(faces), _BLOCK):
        corners = plan[faces[start : start + _BLOCK]]
        sides = np.roll(corners, -1, axis=1) - corners
        is_long[start : start + _BLOCK] = np.hypot(sides[..., 0], sides[..., 1]) > max_edge
    return is_long


def _open_to_outside(
    faces: IntArray, is_long: NDArray[np.bool_], n_points: int
) -> NDArray[np.bool_]:
    """Return which faces are reached from outside across long edges."""
    n_faces = len(faces)
    starts, ends = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    keys = np.minimum(starts, ends) * np.int64(n_points) + np.maximum(starts, ends)
    order = np.argsort(keys, kind="stable")
    is_shared = np.zeros(len(keys), dtype=bool)
    is_shared[order[:-1]] = keys[order[:-1]] == keys[order[1:]]
    first = np.flatnonzero(is_shared[order])
    face, other = order[first] // 3, order[first + 1] // 3
    crossed = is_long.ravel()[order[first]]
    is_inner = np.zeros(len(keys), dtype=bool)
    is_inner[order[first]] = is_inner[order[first + 1]] = True
    entries = np.flatnonzero(~is_inner & is_long.ravel()) // 3
    rows = np.concatenate([face[crossed], entries])
    columns = np.concatenate([other[crossed], np.full(len(entries), n_faces)])
    links = coo_matrix((np.ones(len(rows), bool), (rows, columns)), (n_faces + 1, n_faces + 1))
    label: NDArray[np.int32] = connected_components(links, directed=False)[1]
    return label[:n_faces] == label[n_faces]
