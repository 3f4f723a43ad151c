"""Which points lie near each other, and the faces that edges between them enclose."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.point_faces import (
    NOT_ASKED,
    classify_pairs,
    count_triangles,
    fill_triangles,
    gather_spokes,
    group_pairs,
    look_up_pairs,
    sort_groups,
    turn_spokes,
)
from .._validate import FloatArray
from ..progress import Progress, part_of, report, watched_part
from .nearest import nearest_points

__all__ = ["NOT_ASKED", "NearPairs", "SortedEdges", "near_pairs", "sorted_edges", "triangles_of"]

#: Share of the time of `near_pairs` after which the nearest points are known: 0.6 of it without a
#: compiler, 0.8 with one.
_OF_NEAREST = 0.7

_CANCELLED = "the work on the faces was cancelled; nothing was kept."


class NearPairs(NamedTuple):
    """Of each point the nearest others.

    nearest : (n, m) int32, by distance, then by index
    classes : (n, m) uint8, how clear it is that they are joined; NOT_ASKED where nobody asks:
        beyond the reach, or where the other one of the two does
    """

    nearest: NDArray[np.int32]
    classes: NDArray[np.uint8]


class SortedEdges(NamedTuple):
    """Edges by their lower ends.

    indptr : (n + 1,) int64; heads : (k,) int32, the higher ends, ascending
    """

    indptr: NDArray[np.int64]
    heads: NDArray[np.int32]

    def rows(self) -> NDArray[np.int32]:
        """Return the edges, ``(k, 2)``, the lower ends first."""
        tails = np.arange(len(self.indptr) - 1, dtype=np.int32)
        return np.column_stack([np.repeat(tails, np.diff(self.indptr)), self.heads])

    def are_joined(
        self, pairs: NearPairs, progress: Progress | None = None
    ) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
        """Return of each pair that is asked about whether it is an edge, and which edges are."""
        joined = np.empty(pairs.classes.shape, dtype=np.uint8)
        is_asked = np.zeros(len(self.heads), dtype=bool)
        with watched_part(progress, 0.0, 1.0, _CANCELLED):
            run_in_ranges(
                look_up_pairs, len(joined), pairs.nearest, pairs.classes, self.indptr, self.heads,
                joined, is_asked,
            )  # fmt: skip
        return joined, is_asked


def near_pairs(
    x: FloatArray, y: FloatArray, n_nearest: int, progress: Progress | None = None
) -> NearPairs:
    """Return the nearest points of each of some points, for docs/reference/format.md, "The input".

    Parameters
    ----------
    x, y : (n,) float64
        Whole numbers, so small that sums of their products are exact; ``n > n_nearest + 1``.
    n_nearest : int
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    n = len(x)
    nearest, reach = nearest_points(
        x, y, n_nearest, _CANCELLED, part_of(progress, 0.0, _OF_NEAREST)
    )
    classes = np.empty((n, n_nearest), dtype=np.uint8)
    with watched_part(progress, _OF_NEAREST, 1.0, _CANCELLED):
        run_in_ranges(classify_pairs, n, x, y, nearest, reach, classes)
    return NearPairs(nearest, classes)


def sorted_edges(pairs: NDArray[np.int32], n_points: int) -> SortedEdges:
    """Return pairs of points as edges, each once.

    Parameters
    ----------
    pairs : (k, 2) int32
        Of points below ``n_points``, in any order, with repetitions.
    n_points : int
    """
    indptr = np.zeros(n_points + 1, dtype=np.int64)
    heads, is_new = np.empty(len(pairs), dtype=np.int32), np.empty(len(pairs), dtype=bool)
    group_pairs(pairs, indptr, heads)
    run_in_ranges(sort_groups, n_points, indptr, heads, is_new)
    before = np.concatenate([[0], np.cumsum(is_new)])
    return SortedEdges(before[indptr], heads[is_new])


def triangles_of(
    x: FloatArray, y: FloatArray, edges: SortedEdges, progress: Progress | None = None
) -> NDArray[np.int32]:
    """Return the triangles of edges with no edge inside, the lowest corner first, sorted.

    Parameters
    ----------
    x, y : (n,) float64
        As for `near_pairs`.
    edges : SortedEdges
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    n, n_spokes = len(x), 2 * len(edges.heads)
    indptr = np.zeros(n + 1, dtype=np.int64)
    heads = np.empty(n_spokes, dtype=np.int32)
    edge_of = np.empty(n_spokes, dtype=np.int32)
    place = np.empty(n_spokes, dtype=np.int32)
    report(progress, 0.0, _CANCELLED)
    gather_spokes(edges.rows(), indptr, heads, edge_of)
    report(progress, 0.1, _CANCELLED)
    with watched_part(progress, 0.1, 0.5, _CANCELLED):
        run_in_ranges(turn_spokes, n, x, y, indptr, heads, edge_of, place)
    report(progress, 0.5, _CANCELLED)
    n_triangles = np.empty(n, dtype=np.int32)
    spokes = (x, y, indptr, heads, edge_of, place)
    with watched_part(progress, 0.5, 0.75, _CANCELLED):
        run_in_ranges(count_triangles, n, *spokes, n_triangles)
    report(progress, 0.75, _CANCELLED)
    first = np.concatenate([[0], np.cumsum(n_triangles, dtype=np.int64)])
    triangles = np.empty((int(first[-1]), 3), dtype=np.int32)
    with watched_part(progress, 0.75, 1.0, _CANCELLED):
        run_in_ranges(fill_triangles, n, *spokes, first, triangles)
    return triangles
