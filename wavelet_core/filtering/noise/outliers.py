"""Values that stand out of their surroundings and are no part of the terrain."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..._validate import FloatArray, IntArray
from ...mesh.triangle_mesh import TriangleMesh
from ..undecimated import rings
from .rounding import NO_ROUNDING, Rounding

#: An outlier is so many standard deviations of the noise, plus so many times the relief of its
#: ring, above the second highest of its neighbours or below the second lowest. With one vertex in
#: 200 off by 8 to 30 deviations, 4 deviations or half the relief make 16 and 30 % fewer mistakes on
#: average of four DEMs, but 1.2 and 1.4 times as many in the roughest, where they take relief for
#: outliers; 6 deviations or twice the relief make 1.3 and 1.7 times as many everywhere
#: (benchmarks/quality/constants.py).
OUTLIER_DEVIATIONS, OUTLIER_RELIEF, OUTLIER_RELIEF_OF_OUTLINE = 5.0, 1.0, 4.0
#: Looks for outliers: each sees those that others stood beside.
OUTLIER_PASSES = 5
#: Those that most values take, for the progress.
EXPECTED_PASSES = 2
#: Vertices whose neighbours are put in order at once.
ROWS_OF_RANKS = 50_000
#: Vertices of fewer neighbours, at corners, are none.
LEAST_NEIGHBOURS = 4
#: Rounds in which an outlier is filled from its neighbours.
FILL_ROUNDS = 20


def without_outliers(
    mesh: TriangleMesh,
    values: FloatArray,
    sigma: float | None = None,
    rounding: Rounding = NO_ROUNDING,
    tick: Callable[[], None] = lambda: None,
) -> tuple[IntArray, FloatArray]:
    """Return the vertices that stand out of their rings, and the values with those filled.

    Parameters
    ----------
    mesh : TriangleMesh
    values : ndarray, shape (n_vertices,)
    sigma : float, optional
        Standard deviation of the noise; by default estimated.
    rounding : Rounding
        That of the values.
    tick : callable
        Called now and then; it may raise, to stop.

    Notes
    -----
    An outlier is above the second highest of its neighbours, or below the second lowest, by more
    than 5 sigma and the relief of the ring between those two; at an outline, where all neighbours
    may lie downhill, above the highest by four times the relief. So a bank, a crest or a summit is
    none, nor is one of two outliers side by side a reason to keep the other.
    """
    n = mesh.n_vertices
    if n == 0 or not len(mesh.faces):
        return np.empty(0, np.int64), values
    around = rings(mesh, tick)
    keeps = around.rows != around.indices
    row, column = around.rows[keeps], around.indices[keeps]
    del around, keeps
    tick()
    deviation = rounding.deviation(mesh, values) if sigma is None else sigma
    # At an outline all neighbours may lie downhill.
    is_inside = np.bincount(row, minlength=n) == np.bincount(mesh.faces.ravel(), minlength=n)
    tick()
    relief_counts = np.where(is_inside, OUTLIER_RELIEF, OUTLIER_RELIEF_OF_OUTLINE)
    rank = np.where(is_inside, 2, 1)
    is_out = np.zeros(n, dtype=bool)
    for _ in range(OUTLIER_PASSES):
        good = ~is_out[column]
        lowest, highest = _low_and_high(row[good], values[column[good]], rank, tick)
        known = np.isfinite(highest) & np.isfinite(lowest)
        relief = np.where(known, np.maximum(highest - lowest, 0.0), np.inf)
        excess = np.maximum(values - highest, lowest - values)
        least = OUTLIER_DEVIATIONS * deviation + relief_counts * relief
        new = known & ~is_out & (excess > least)
        if not new.any():
            break
        is_out |= new
    found = np.flatnonzero(is_out)
    return found, _filled(row, column, values, is_out) if len(found) else values


def _low_and_high(
    row: IntArray, values: FloatArray, rank: IntArray, tick: Callable[[], None]
) -> tuple[FloatArray, FloatArray]:
    """Return the values of a rank, 1 the outmost, from below and from above, of each row.

    Infinite, so that nothing stands out, where a row has too few.
    """
    n = len(rank)
    low, high = np.full(n, np.inf), np.full(n, -np.inf)
    counts = np.bincount(row, minlength=n)
    ends = np.concatenate([[0], np.cumsum(counts)])
    for first in range(0, n, ROWS_OF_RANKS):
        here = np.arange(first, min(first + ROWS_OF_RANKS, n))
        part = slice(int(ends[first]), int(ends[here[-1] + 1]))
        in_order = values[part][np.lexsort((values[part], row[part]))]
        here = here[counts[here] >= LEAST_NEIGHBOURS]
        low[here] = in_order[ends[here] - part.start + rank[here] - 1]
        high[here] = in_order[ends[here + 1] - part.start - rank[here]]
        tick()
    return low, high


def _filled(row: IntArray, column: IntArray, values: FloatArray, is_out: np.ndarray) -> FloatArray:
    """Return values with the outliers at the mean of their neighbours, also through others."""
    n, filled = len(values), values.copy()
    here = is_out[row]
    row, column = row[here], column[here]
    is_known = ~is_out
    for _ in range(FILL_ROUNDS):
        weight = is_known[column].astype(np.float64)
        count = np.bincount(row, weight, n)
        total = np.bincount(row, weight * filled[column], n)
        now = is_out & (count > 0)
        filled[now] = total[now] / count[now]
        is_known |= now
    return filled
