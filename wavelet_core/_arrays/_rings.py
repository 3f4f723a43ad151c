"""The rings of a connectivity by their size, as dense arrays."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

#: Ring entries that are looked at together: a bound on the memory.
ENTRIES_AT_ONCE = 1 << 19


def by_size(sizes: NDArray[np.integer]) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """Yield each size, and the rows that have it, in blocks."""
    if len(sizes) == 0:
        return
    order = np.argsort(sizes, kind="stable")
    sizes = sizes[order]
    edges = np.flatnonzero(np.diff(sizes, prepend=-1))
    for first, last in zip(edges, [*edges[1:], len(sizes)], strict=True):
        size = int(sizes[first])
        step = max(ENTRIES_AT_ONCE // max(size, 1), 1)
        for start in range(int(first), int(last), step):
            yield size, order[start : min(start + step, int(last))]


def rings(
    vertices: NDArray[np.integer], size: int, indptr: NDArray[np.int64], ring: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Return the rings of vertices that all have ``size`` neighbours, ``(n, size)``."""
    return ring[(indptr[vertices] + vertices)[:, None] + np.arange(size)]
