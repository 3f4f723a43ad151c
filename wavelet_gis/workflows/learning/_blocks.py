"""Rows of large arrays: samples to learn from, and blocks to work on."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from wavelet_core.progress import Progress, report

__all__ = ["FloatArray", "IntArray", "blocks_of", "sample_of"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Vertices that are predicted between two looks at whether to stop.
PREDICTED_AT_ONCE = 50_000


def sample_of(n_items: int, n_wanted: int, generator: np.random.Generator) -> IntArray:
    """Return the rows of a random sample, all where there are no more."""
    if n_items <= n_wanted:
        return np.arange(n_items)
    return np.sort(generator.choice(n_items, n_wanted, replace=False))


def blocks_of(n_items: int, progress: Progress | None) -> Iterator[slice]:
    """Yield the rows of each block that is predicted at once; ``progress`` may stop it."""
    for first in range(0, max(n_items, 1), PREDICTED_AT_ONCE):
        report(progress, first / max(n_items, 1))
        yield slice(first, min(first + PREDICTED_AT_ONCE, n_items))
