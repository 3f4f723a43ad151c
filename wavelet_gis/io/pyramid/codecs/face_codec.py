"""The faces of points as the few edges that are none of their Delaunay triangulation.

Whoever has the points has, of each, the nearest others, and knows which of them it is joined to
in a Delaunay triangulation: those with which it lies on a circle that holds no other point. Every
such pair is asked about, by classes of how clear the answer is, and nearly all answers are the
expected one. Edges beyond the nearest points, and triangles of edges that are no faces, are
listed one by one. Any triangulation can be stored so; one that is not Delaunay takes more bytes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core._threads import run_in_blocks
from wavelet_core.errors import PyramidError
from wavelet_core.mesh.point_faces import (
    SortedEdges,
    near_pairs,
    sorted_edges,
    triangles_of,
)
from wavelet_core.progress import part_of, report, watched_part

__all__ = ["N_EDGE_CLASSES", "FaceRecord", "decode_faces", "encode_faces"]

#: Nearest points that are looked at. With 12 the far edges are 10 times as many.
N_NEAREST = 16

#: See docs/reference/format.md, and `wavelet_core._kernels.point_faces.class_of_pair`.
N_EDGE_CLASSES = 8

#: Coordinates beyond this have squares that are no exact floats.
LARGEST_COORDINATE = 2**25

_CANCELLED = "the work on the faces was cancelled; nothing was kept."

#: Shares of the time after which the edges are sorted, and every pair is answered for.
_OF_EDGES, _OF_PAIRS = 0.05, 0.75


class FaceRecord(NamedTuple):
    """Faces without what follows from the points.

    answers : tuple of uint8 arrays, one a class: is the pair joined?
    far : (n, 2) int32, edges between points of which neither is among the other's nearest
    holes : (n,) int64, places, among the triangles of edges, of those that are no faces
    """

    answers: tuple[NDArray[np.uint8], ...]
    far: NDArray[np.int32]
    holes: NDArray[np.int64]


def encode_faces(
    points: NDArray[np.int64], faces: NDArray[np.integer], progress: Progress | None = None
) -> FaceRecord | None:
    """Return the record of faces; None where it would not give them back.

    Parameters
    ----------
    points : (n, 2) int64
        X and Y, no two of them equal.
    faces : (m, 3) integers
        Counter-clockwise, as `wavelet_core.mesh.triangulation.canonical_faces` orders them.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    if not _can_be_encoded(points):
        return None
    n = len(points)
    x, y = _local(points)
    with watched_part(progress, 0.0, _OF_EDGES, _CANCELLED):
        edges = sorted_edges(_sides(faces), n)
    report(progress, _OF_EDGES, _CANCELLED)
    answers, far = _answers_by(x, y, edges, part_of(progress, _OF_EDGES, _OF_PAIRS))
    triangles = triangles_of(x, y, edges, part_of(progress, _OF_PAIRS, 1.0))
    is_face = _are_among(faces, triangles, n)
    if np.count_nonzero(is_face) != len(faces) or not np.array_equal(triangles[is_face], faces):
        return None
    return FaceRecord(answers, far, np.flatnonzero(~is_face).astype(np.int64))


def decode_faces(
    points: NDArray[np.int64], record: FaceRecord, progress: Progress | None = None
) -> NDArray[np.int64]:
    """Return the faces that a record describes.

    Parameters
    ----------
    points : (n, 2) int64
    record : FaceRecord
        Of any origin.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    PyramidError
        It describes no faces on these points.
    """
    _require(_can_be_encoded(points), "points that have no faces")
    x, y = _local(points)
    edges = _edges_from(x, y, record, part_of(progress, 0.0, _OF_PAIRS))
    triangles = triangles_of(x, y, edges, part_of(progress, _OF_PAIRS, 1.0))
    is_face = np.ones(len(triangles), dtype=bool)
    holes = record.holes
    _require(
        holes.size == 0 or bool(holes.min() >= 0 and holes.max() < len(triangles)),
        "a hole in no triangle",
    )
    is_face[holes] = False
    return triangles[is_face].astype(np.int64)


def _sides(faces: NDArray[np.integer]) -> NDArray[np.int32]:
    corners = faces.astype(np.int32)
    return np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])


def _answers_by(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    edges: SortedEdges,
    progress: Progress | None,
) -> tuple[tuple[NDArray[np.uint8], ...], NDArray[np.int32]]:
    """Return the answers to all questions, and the edges that nobody asks about."""
    pairs = near_pairs(x, y, N_NEAREST, part_of(progress, 0.0, 0.9))
    joined, is_asked = edges.are_joined(pairs, part_of(progress, 0.9, 0.95))
    answers = []
    for of_class in range(N_EDGE_CLASSES):
        report(progress, 0.95 + 0.05 * of_class / N_EDGE_CLASSES, _CANCELLED)
        answers.append(_of_class(joined, pairs.classes, of_class))
    return tuple(answers), edges.rows()[~is_asked]


def _of_class(
    joined: NDArray[np.uint8], classes: NDArray[np.uint8], of_class: int
) -> NDArray[np.uint8]:
    """Return the answers to the questions of one class, in the order of the points."""

    def select(start: int, stop: int) -> NDArray[np.uint8]:
        here = slice(start, stop)
        return joined[here][classes[here] == of_class]

    return np.concatenate([joined[:0].ravel(), *run_in_blocks(select, len(joined))])


def _edges_from(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    record: FaceRecord,
    progress: Progress | None,
) -> SortedEdges:
    """Return the edges that a record of any origin describes."""
    n = len(x)
    pairs = near_pairs(x, y, N_NEAREST, part_of(progress, 0.0, 0.9))
    joined = np.zeros(pairs.classes.shape, dtype=bool)
    for of_class, answers in enumerate(record.answers):
        report(progress, 0.9 + 0.1 * of_class / N_EDGE_CLASSES, _CANCELLED)
        asked = pairs.classes == of_class
        n_asked = int(np.count_nonzero(asked))
        _require(len(answers) >= n_asked, "questions without an answer")
        _require(len(answers) == n_asked, "answers to no question")
        joined[asked] = answers != 0
    far = record.far.astype(np.int64)
    _require(
        far.size == 0 or bool(far.min() >= 0 and far.max() < n and (far[:, 0] < far[:, 1]).all()),
        "an edge to no point",
    )
    _require(int(np.count_nonzero(joined)) + len(far) <= 3 * n, "more edges than a surface has")
    tail, place = np.nonzero(joined)
    near = np.column_stack([tail.astype(np.int32), pairs.nearest[tail, place]])
    return sorted_edges(np.concatenate([near, far.astype(np.int32)]), n)


def _can_be_encoded(points: NDArray[np.int64]) -> bool:
    """Whether sums of products of the points' distances are exact."""
    return len(points) > N_NEAREST + 1 and bool(np.ptp(points, axis=0).max() < LARGEST_COORDINATE)


def _local(points: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return x and y from the lowest ones, as doubles that hold them exactly."""
    x, y = (points - points.min(axis=0)).T.astype(np.float64)
    return np.ascontiguousarray(x), np.ascontiguousarray(y)


def _are_among(
    faces: NDArray[np.integer], triangles: NDArray[np.int32], n: int
) -> NDArray[np.bool_]:
    """Return which triangles have the first two corners of a face, which are enough."""
    of_triangles, of_faces = _keys(triangles, n), _keys(faces, n)
    is_face = np.zeros(len(triangles), dtype=bool)
    if len(triangles):
        place = np.minimum(np.searchsorted(of_triangles, of_faces), len(triangles) - 1)
        is_face[place[of_triangles[place] == of_faces]] = True
    return is_face


def _keys(corners: NDArray[np.integer], n: int) -> NDArray[np.int64]:
    return corners[:, 0].astype(np.int64) * n + corners[:, 1]


def _require(holds: bool, fault: str) -> None:
    if not holds:
        raise PyramidError(f"the faces have {fault}; the file is damaged.")
