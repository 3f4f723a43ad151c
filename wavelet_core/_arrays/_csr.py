"""Rows of different lengths in one array."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def expanded(
    first: NDArray[np.integer], counts: NDArray[np.integer]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the row, and the place ``first[row] + k``, of every entry of rows of such counts."""
    counts = counts.astype(np.int64)
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    row = np.repeat(np.arange(len(counts)), counts)
    place = np.arange(total) + np.repeat(first.astype(np.int64) - (ends - counts), counts)
    return row, place


def summed(
    row: NDArray[np.int64], values: NDArray[np.float64], start: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return ``start`` with the values of each row added to it, one after the other.

    ``bincount`` adds in order, as a loop would; ``reduceat`` pairs and so rounds otherwise. It
    begins at 0, though, and -0 added to that is 0: rows of nothing but -0 stay that, as in a loop.
    """
    n = len(start)
    rows = np.concatenate([np.arange(n), row])
    weights = np.concatenate([start, values])
    total = np.bincount(rows, weights, minlength=n).astype(np.float64, copy=False)
    is_minus = np.signbit(start) & (total == 0.0)
    if is_minus.any():
        is_minus[row[(values != 0.0) | ~np.signbit(values)]] = False
        total[is_minus] = -0.0
    return total


def blocks(sizes: NDArray[np.integer], limit: int) -> list[slice]:
    """Return slices of consecutive rows whose sizes sum to about ``limit`` at most."""
    if len(sizes) == 0:
        return []
    block = np.cumsum(sizes, dtype=np.int64) // limit
    starts = np.flatnonzero(np.diff(block, prepend=-1))
    stops = [*starts[1:], len(sizes)]
    return [slice(int(a), int(b)) for a, b in zip(starts, stops, strict=True)]
