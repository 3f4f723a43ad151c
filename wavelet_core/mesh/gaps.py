"""Gaps of scattered points: faces that span where nothing was measured."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from .._validate import FloatArray, IntArray
from ..errors import MeshError, OptionError

__all__ = ["GAP_FACTOR", "area_share", "faces_within", "gap_length", "point_spacing"]

#: An edge this many times as long as the spacing that 95 % of the points keep spans a gap.
GAP_FACTOR = 5.0


def gap_length(plan: FloatArray, faces: IntArray) -> float:
    """Return the length from which an edge of a Delaunay triangulation spans a gap.

    Parameters
    ----------
    plan : ndarray, shape (n_points, 2)
        Horizontal coordinates.
    faces : ndarray of int, shape (n_faces, 3)
        Their Delaunay faces.

    Notes
    -----
    **Our choice:** `GAP_FACTOR` times the 95th percentile of the distance from a point to its
    nearest neighbour, which is the shortest of its Delaunay edges.
    """
    lengths = _edge_lengths(plan, faces)
    nearest = np.full(len(plan), np.inf)
    for k in range(3):
        np.minimum.at(nearest, faces[:, k], lengths[:, k])
        np.minimum.at(nearest, faces[:, (k + 1) % 3], lengths[:, k])
    return GAP_FACTOR * float(np.percentile(nearest[np.isfinite(nearest)], 95))


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
        raise OptionError(f"max_edge must be a length above 0, and is {max_edge}.")
    is_long = _edge_lengths(plan, faces) > max_edge
    gone = _open_to_outside(faces, is_long, len(plan)) if from_outline else is_long.any(axis=1)
    if gone.all():
        raise MeshError(
            f"every face has an edge longer than max_edge = {max_edge:g}, so no surface is left; "
            "give a larger one."
        )
    return faces[~gone]


def area_share(plan: FloatArray, faces: IntArray, max_edge: float) -> float:
    """Return the share of the triangulated area in faces with an edge longer than `max_edge`."""
    areas = _doubled_areas(plan, faces)
    is_gap = (_edge_lengths(plan, faces) > max_edge).any(axis=1)
    total = float(areas.sum())
    return float(areas[is_gap].sum()) / total if total else 0.0


def point_spacing(plan: FloatArray, faces: IntArray, max_edge: float) -> float:
    """Return the side of the square that one point has to itself, gaps left out.

    Parameters
    ----------
    plan : ndarray, shape (n_points, 2)
        Horizontal coordinates.
    faces : ndarray of int, shape (n_faces, 3)
        Their Delaunay faces.
    max_edge : float
        A longer edge spans a gap, as `gap_length` gives it.
    """
    within = faces[(_edge_lengths(plan, faces) <= max_edge).all(axis=1)]
    if len(within) == 0:
        within = faces
    area = float(_doubled_areas(plan, within).sum()) / 2
    return float(np.sqrt(area / len(np.unique(within))))


def _doubled_areas(plan: FloatArray, faces: IntArray) -> FloatArray:
    a, b, c = (plan[faces[:, k]] for k in range(3))
    doubled = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    return np.abs(doubled)


def _edge_lengths(plan: FloatArray, faces: IntArray) -> FloatArray:
    """Return the length of each face's edges, the k-th from corner k to the next."""
    sides = plan[np.roll(faces, -1, axis=1)] - plan[faces]
    return np.hypot(sides[..., 0], sides[..., 1])


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
