"""``njit`` with numba, and a plain-Python stand-in without it.

The kernels release the GIL and are run over ranges of their index space by
Python threads (:func:`run_in_ranges`) rather than by numba's ``prange``: numba's
threading layers are not safe to enter from several threads at once, which is what
happens inside QGIS, and a range-wise kernel gives the same bytes for any number
of threads.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import os
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from ..errors import OptionError, SlowFallbackWarning

#: Set to any non-empty value to run without numba even where it is installed.
DISABLE_VARIABLE = "TERRAIN_WAVELETS_NO_NUMBA"
#: Number of threads for the kernels; all cores when unset.
THREADS_VARIABLE = "TERRAIN_WAVELETS_THREADS"
#: Above this many vertices the plain-Python kernels are refused: they take about
#: half a millisecond a vertex and level.
MAX_VERTICES_WITHOUT_NUMBA = 50_000

_numba: Any = None
if not os.environ.get(DISABLE_VARIABLE):
    with contextlib.suppress(ImportError):
        import numba as _numba

HAS_NUMBA = _numba is not None

_warned = False


def njit(function: Callable[..., Any]) -> Any:
    """Compile ``function`` with numba where it is there; cached on disk where it can be."""
    if _numba is None:
        return function
    try:
        compiled = _numba.njit(cache=True, nogil=True)(function)
    except RuntimeError:  # no writable place for the cache
        return _numba.njit(nogil=True)(function)
    # Numba takes cached code for good while the file of the function itself is unchanged, though
    # kernels of other files are compiled into it: a change in any of them must void it.
    with contextlib.suppress(AttributeError):
        index = compiled._cache._cache_file
        index._source_stamp = (index._source_stamp, _stamp_of_all_kernels())
    return compiled


def inlined(function: Callable[..., Any]) -> Any:
    """Compile ``function`` into its callers: a call with many arrays costs more than its work.

    Measured: costing a collapse took 1.7 times as long with plain calls.
    """
    if _numba is None:
        return function
    return _numba.njit(forceinline=True, nogil=True, error_model="numpy")(function)


@functools.cache
def _stamp_of_all_kernels() -> tuple[tuple[str, int, int], ...]:
    """Name, time of change and size of every file of kernels."""
    files = sorted(Path(__file__).parent.glob("*.py"))
    return tuple((file.name, file.stat().st_mtime_ns, file.stat().st_size) for file in files)


def announce_fallback(n_vertices: int) -> None:
    """Warn once that numba is absent; refuse what would take hours without it.

    Raises
    ------
    OptionError
        For more than ``MAX_VERTICES_WITHOUT_NUMBA`` vertices without numba.
    """
    global _warned
    if HAS_NUMBA:
        return
    if n_vertices > MAX_VERTICES_WITHOUT_NUMBA:
        raise OptionError(
            f"{n_vertices} vertices are too many without numba (at most "
            f"{MAX_VERTICES_WITHOUT_NUMBA}); install it with 'pip install numba' or thin the input."
        )
    if not _warned:
        _warned = True
        warnings.warn(
            "numba is not installed: the kernels run as plain Python, some hundred times slower; "
            "'pip install numba' mends it.",
            SlowFallbackWarning,
            stacklevel=3,
        )


def n_threads() -> int:
    """Threads for the kernels: the environment's wish, else the number of cores."""
    wish = os.environ.get(THREADS_VARIABLE, "")
    if wish.isdigit() and int(wish) > 0:
        return int(wish)
    return os.cpu_count() or 1


def run_in_ranges(kernel: Callable[..., Any], n_items: int, *arguments: Any) -> None:
    """Run ``kernel(start, stop, *arguments)`` over ``[0, n_items)``, in threads.

    Every item must write only its own results, so that the split does not matter.
    """
    threads = n_threads()
    if not HAS_NUMBA or threads == 1 or n_items < 4096:
        kernel(0, n_items, *arguments)
        return
    n_ranges = 4 * threads
    bounds = [n_items * k // n_ranges for k in range(n_ranges + 1)]
    kernel(0, 0, *arguments)  # compiled once, before the threads race for it
    with ThreadPoolExecutor(threads) as pool:
        jobs = [
            pool.submit(kernel, start, stop, *arguments)
            for start, stop in itertools.pairwise(bounds)
        ]
        for job in jobs:
            job.result()
