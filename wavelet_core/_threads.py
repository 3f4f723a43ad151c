"""How many threads there are, and work on whole arrays in them, block by block.

One statement on arrays of millions spends most of its time on memory that it fetches for the first
time, on one core. Blocks that fit into the cache do not, and the cores share them. The blocks are
the same for any number of threads, so sums over them are too.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from .errors import OptionError

__all__ = [
    "THREADS_VARIABLE",
    "centre_of",
    "minus",
    "n_threads",
    "put_rows",
    "rows_at",
    "run_in_blocks",
]

#: Number of threads for all work; all cores when unset.
THREADS_VARIABLE = "TERRAIN_WAVELETS_THREADS"

#: Items of a block: half a megabyte of float64.
BLOCK = 1 << 16

Result = TypeVar("Result")


def n_threads() -> int:
    """Return how many threads work is shared by: the environment's wish, else the number of cores.

    Raises
    ------
    OptionError
        The environment wishes for what is no number of threads.
    """
    wish = os.environ.get(THREADS_VARIABLE, "").strip()
    if not wish:
        return os.cpu_count() or 1
    if not (wish.isascii() and wish.isdigit() and int(wish) > 0):
        raise OptionError(
            f"{THREADS_VARIABLE} is {wish!r}; give a whole number of 1 or more, or leave the "
            "variable out."
        )
    return int(wish)


def run_in_blocks(
    work: Callable[[int, int], Result], n_items: int, at_once: int = BLOCK
) -> list[Result]:
    """Return what ``work(start, stop)`` gives for each block of ``[0, n_items)``, in order."""
    bounds = [*range(0, n_items, at_once), n_items] if n_items else [0]
    blocks = list(itertools.pairwise(bounds))
    if len(blocks) < 2 or n_threads() == 1:
        return [work(start, stop) for start, stop in blocks]
    with ThreadPoolExecutor(n_threads()) as pool:
        return list(pool.map(lambda block: work(*block), blocks))


def centre_of(columns: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the middle of the range of each column, and the range: ``(n_columns,)`` both."""

    def bounds(start: int, stop: int) -> NDArray[np.float64]:
        block = columns[start:stop].T
        return np.array([(column.min(), column.max()) for column in block]).reshape(-1, 2)

    low, high = np.moveaxis(np.array(run_in_blocks(bounds, len(columns))), 2, 0)
    least = low.min(axis=0)
    extent = high.max(axis=0) - least
    return least + extent / 2, extent


def rows_at(array: NDArray[Any], places: NDArray[np.integer]) -> NDArray[Any]:
    """Return ``array[places]``, all of which are in range."""
    rows = np.empty((len(places), *array.shape[1:]), dtype=array.dtype)

    def fetch(start: int, stop: int) -> None:
        np.take(array, places[start:stop], axis=0, out=rows[start:stop], mode="clip")

    run_in_blocks(fetch, len(places))
    return rows


def put_rows(array: NDArray[Any], places: NDArray[np.integer], rows: NDArray[Any]) -> None:
    """Write ``array[places] = rows``; all places are in range, and no two the same."""

    def put(start: int, stop: int) -> None:
        array[places[start:stop]] = rows[start:stop]

    run_in_blocks(put, len(places))


def minus(array: NDArray[np.float64], row: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``array - row`` for two dimensions."""
    difference = np.empty(array.shape)

    def subtract(start: int, stop: int) -> None:
        np.subtract(array[start:stop], row, out=difference[start:stop])

    run_in_blocks(subtract, len(array))
    return difference
