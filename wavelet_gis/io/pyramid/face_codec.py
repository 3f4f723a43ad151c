"""The faces of points as the few edges that are none of their Delaunay triangulation.

Whoever has the points has, of each, the nearest others, and can tell which of them it is joined to
in a Delaunay triangulation: those with which it lies on a circle that holds no other point. Every
such pair is asked about, by classes of how clear the answer is, and nearly all answers are the
expected one. Edges beyond the nearest points, and triangles of edges that are no faces, are told
one by one. Any triangulation can be told so; one that is not Delaunay takes more bytes.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from wavelet_core.errors import PyramidError

__all__ = ["N_EDGE_CLASSES", "FaceRecord", "decode_faces", "encode_faces"]

#: Nearest points that are looked at. With 12 the far edges are 10 times as many.
N_NEAREST = 16

#: Points that are looked at together: a bound on the memory.
_POINTS_AT_ONCE = 1 << 16

#: Sums of cotangents that are clear, and those that are rounding.
_CLEAR, _TIED = 0.05, 1e-9

#: See `_classes`.
N_EDGE_CLASSES = 8

#: Coordinates beyond this have squares that are no exact floats.
LARGEST_COORDINATE = 2**25


class FaceRecord(NamedTuple):
    """Faces without what the points tell.

    answers : tuple of uint8 arrays, one a class: is the pair joined?
    far : (n, 2) int32, edges between points of which neither is among the other's nearest
    holes : (n,) int64, places, among the triangles of edges, of those that are no faces
    """

    answers: tuple[NDArray[np.uint8], ...]
    far: NDArray[np.int32]
    holes: NDArray[np.int64]


def encode_faces(points: NDArray[np.int64], faces: NDArray[np.integer]) -> FaceRecord | None:
    """Return the record of faces; None where it would not give them back.

    Parameters
    ----------
    points : (n, 2) int64
        X and Y, no two of them equal.
    faces : (m, 3) integers
        Counter-clockwise, as `wavelet_core.mesh.triangulation.canonical_faces` orders them.
    """
    if not _may_be_told(points):
        return None
    edges = _edges_of(faces)
    n = len(points)
    keys = edges[:, 0] * n + edges[:, 1]
    is_told = np.zeros(len(keys), dtype=bool)
    answers: list[list[NDArray[np.uint8]]] = [[] for _ in range(N_EDGE_CLASSES)]
    for pairs, classes in _questions(points):
        pair_keys = pairs.min(axis=1) * n + pairs.max(axis=1)
        place = np.minimum(np.searchsorted(keys, pair_keys), max(len(keys) - 1, 0))
        joined = keys[place] == pair_keys if len(keys) else np.zeros(len(pairs), dtype=bool)
        is_told[place[joined]] = True
        order = np.argsort(classes, kind="stable")
        ends = np.cumsum(np.bincount(classes, minlength=N_EDGE_CLASSES))[:-1]
        for of_class, part in zip(answers, np.split(joined[order], ends), strict=True):
            of_class.append(part.astype(np.uint8))
    triangles = _triangles(points, edges)
    face_keys, triangle_keys = _face_keys(faces, n), _face_keys(triangles, n)
    is_face = np.isin(triangle_keys, face_keys)
    if np.count_nonzero(is_face) != len(faces):
        return None
    if not np.array_equal(triangles[is_face], faces):
        return None
    return FaceRecord(
        tuple(np.concatenate(parts) if parts else np.empty(0, np.uint8) for parts in answers),
        edges[~is_told].astype(np.int32),
        np.flatnonzero(~is_face).astype(np.int64),
    )


def decode_faces(points: NDArray[np.int64], record: FaceRecord) -> NDArray[np.int64]:
    """Return the faces that a record tells.

    Parameters
    ----------
    points : (n, 2) int64
    record : FaceRecord
        Of any origin.

    Raises
    ------
    PyramidError
        It tells no faces on these points.
    """
    _require(_may_be_told(points), "points that have no faces")
    n = len(points)
    used = [0] * N_EDGE_CLASSES
    edges = []
    for pairs, classes in _questions(points):
        counts = np.bincount(classes, minlength=N_EDGE_CLASSES).tolist()
        parts = []
        for k, count in enumerate(counts):
            part = record.answers[k][used[k] : used[k] + count]
            _require(len(part) == count, "questions without an answer")
            used[k] += count
            parts.append(part)
        joined = np.empty(len(pairs), dtype=bool)
        joined[np.argsort(classes, kind="stable")] = np.concatenate(parts) != 0
        edges.append(pairs[joined])
    _require(used == [len(part) for part in record.answers], "answers to no question")
    far = record.far.astype(np.int64)
    _require(
        far.size == 0 or bool(far.min() >= 0 and far.max() < n and (far[:, 0] < far[:, 1]).all()),
        "an edge to no point",
    )
    pairs = np.concatenate([*edges, far])
    _require(len(pairs) <= 3 * n, "more edges than a surface has")
    keys = np.unique(pairs.min(axis=1) * n + pairs.max(axis=1))
    triangles = _triangles(points, np.column_stack(np.divmod(keys, n)))
    is_face = np.ones(len(triangles), dtype=bool)
    holes = record.holes
    _require(
        holes.size == 0 or bool(holes.min() >= 0 and holes.max() < len(triangles)),
        "a hole in no triangle",
    )
    is_face[holes] = False
    return triangles[is_face]


def _may_be_told(points: NDArray[np.int64]) -> bool:
    """Whether sums of products of the points' distances are exact."""
    return len(points) > N_NEAREST + 1 and bool(np.ptp(points, axis=0).max() < LARGEST_COORDINATE)


def _questions(
    points: NDArray[np.int64],
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Yield the pairs that are asked about, and their classes."""
    n = len(points)
    local = (points - points.min(axis=0)).astype(np.float64)
    tree = cKDTree(local, balanced_tree=False, compact_nodes=False)
    reach = np.empty(n)
    nearest = np.empty((n, N_NEAREST), dtype=np.int32)
    for start in range(0, n, _POINTS_AT_ONCE):
        here = slice(start, start + _POINTS_AT_ONCE)
        _, found = tree.query(local[here], k=N_NEAREST + 2, workers=-1)
        squared = ((local[found] - local[here][:, None]) ** 2).sum(axis=2)
        # ties are told apart by the id; those with the last one that was found, left out
        order = np.lexsort((found, squared), axis=1)
        squared = np.take_along_axis(squared, order, axis=1)
        reach[here] = squared[:, -1]
        nearest[here] = np.take_along_axis(found, order, axis=1)[:, 1:-1]
    for start in range(0, n, _POINTS_AT_ONCE):
        ids = np.arange(start, min(start + _POINTS_AT_ONCE, n))
        others = nearest[ids].astype(np.int64)
        offset = local[others] - local[ids][:, None]
        squared = (offset**2).sum(axis=2)
        is_known = squared < reach[ids][:, None]
        asked = is_known & ((ids[:, None] < others) | (squared >= reach[others]))
        classes = _classes(offset[:, :, 0], offset[:, :, 1], squared, is_known)
        first, place = np.nonzero(asked)
        yield np.column_stack([ids[first], others[first, place]]), classes[first, place]


def _classes(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    squared: NDArray[np.float64],
    is_known: NDArray[np.bool_],
) -> NDArray[np.int64]:
    """Return how clear it is that points are joined to their nearest ones, at x and y from them.

    Of all circles through both, one is empty where the angles under which the nearest points on
    either side see the two sum to at most half a turn: where their cotangents sum to 0 or more.
    """
    classes = np.empty(x.shape, dtype=np.int64)
    for j in range(x.shape[1]):
        cross = x[:, j, None] * y - y[:, j, None] * x
        inner = squared - (x[:, j, None] * x + y[:, j, None] * y)
        with np.errstate(divide="ignore", invalid="ignore"):
            cotangent = np.where(is_known, inner / np.abs(cross), np.inf)
        left = np.where(cross > 0, cotangent, np.inf).min(axis=1)
        right = np.where(cross < 0, cotangent, np.inf).min(axis=1)
        is_between = (is_known & (cross == 0) & (inner < 0)).any(axis=1)
        total = left + right
        classes[:, j] = np.select(
            [is_between, np.isinf(total), total < -_CLEAR, total < -_TIED, total <= _TIED,
             total <= _CLEAR],
            [0, 1, 2, 3, 4, 5], 6,
        )  # fmt: skip
    classes[(classes == 6) & (np.arange(x.shape[1]) >= x.shape[1] // 2)] = 7
    return classes


def _edges_of(faces: NDArray[np.integer]) -> NDArray[np.int64]:
    """Return the edges of faces, the lower vertex first, sorted."""
    both = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    n = int(both.max(initial=0)) + 1
    keys = np.unique(both.min(axis=1) * n + both.max(axis=1))
    return np.column_stack(np.divmod(keys, n))


def _triangles(points: NDArray[np.int64], edges: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the triangles of edges with no edge inside, in canonical order.

    Parameters
    ----------
    points : (n, 2) int64
    edges : (k, 2) int64
        The lower vertex first, sorted.
    """
    n = len(points)
    tail = np.concatenate([edges[:, 0], edges[:, 1]])
    head = np.concatenate([edges[:, 1], edges[:, 0]])
    x, y = (points[head] - points[tail]).T.astype(np.float64)
    span = np.abs(x) + np.abs(y)
    turn = np.divide(y, span, out=np.zeros(len(x)), where=span > 0)
    turn = np.where(x >= 0, turn, 2.0 - turn)
    order = np.lexsort((turn, tail))
    tail, head, x, y = tail[order], head[order], x[order], y[order]
    ends = np.cumsum(np.bincount(tail, minlength=n))
    following = np.arange(1, len(tail) + 1)
    last = ends[np.bincount(tail, minlength=n) > 0] - 1
    starts = np.concatenate([[0], last[:-1] + 1]) if len(last) else last
    following[last] = starts
    # the corner at `tail` between `head` and the next one counter-clockwise
    corner = np.column_stack([tail, head, head[following]]) if len(tail) else np.empty((0, 3), int)
    is_convex = x * y[following] - y * x[following] > 0.0 if len(tail) else np.empty(0, bool)
    corner = corner[is_convex]
    if len(corner) == 0:
        return np.empty((0, 3), dtype=np.int64)
    turned = np.argmin(corner, axis=1)[:, None]
    corner = corner[np.arange(len(corner))[:, None], (turned + np.arange(3)) % 3]
    corner = corner[np.lexsort((corner[:, 2], corner[:, 1], corner[:, 0]))]
    same = (corner[1:] == corner[:-1]).all(axis=1)
    # a triangle is one where all of its three corners say so
    thrice = np.flatnonzero(same[1:] & same[:-1])
    return corner[thrice]


def _face_keys(faces: NDArray[np.integer], n: int) -> NDArray[np.int64]:
    """Return one number for each of some canonical faces: two of its edges are enough."""
    wide = faces.astype(np.int64)
    return wide[:, 0] * n + wide[:, 1]


def _require(holds: bool, fault: str) -> None:
    if not holds:
        raise PyramidError(f"the faces have {fault}; the file is damaged.")
