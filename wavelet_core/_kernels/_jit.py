"""One kernel, three engines: compiled by numba, on whole arrays, and as plain loops.

A kernel is written as loops. With numba they are compiled; without it, its twin in
:mod:`wavelet_core._arrays` does the same on whole arrays of numpy, for which every sum is taken in
the same order: the bytes are the same. The loops themselves, run by Python, are the oracle that
tests hold both against; in use they run only for the two kernels without a twin, those of the
NNLS and least squares predictions. docs/topics/engines.md is the user's version of this.

Squares are written as products there: Python's ``x**2`` is one of the C library's powers, which may
be off by the last bit.

The kernels release the GIL and are run over ranges of their index space by Python threads
(:func:`run_in_ranges`) rather than by numba's ``prange``: numba's threading layers are not safe to
enter from several threads at once, which is what happens inside QGIS, and a range-wise kernel gives
the same bytes for any number of threads.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import itertools
import os
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from .._threads import n_threads
from ..errors import OptionError, SlowFallbackWarning
from ..progress import report_share
from ._calls import called_past_leak

#: Set to any non-empty value to run without numba even where it is installed.
DISABLE_VARIABLE = "TERRAIN_WAVELETS_NO_NUMBA"
#: One of ``ENGINES``, instead of the fastest that is there.
ENGINE_VARIABLE = "TERRAIN_WAVELETS_ENGINE"
ENGINES = ("compiled", "arrays", "loops")
#: Above this many items a kernel without a twin is refused where it would run as plain loops: they
#: take a fraction of a millisecond an item.
MAX_LOOPS = 50_000
#: Inputs with more vertices than this make the program mention that numba would be faster.
ANNOUNCED_FROM = 100_000
#: Items of a compiled step after which it reports how far it is.
_ITEMS_BETWEEN_REPORTS = 1 << 17
#: Inputs of up to so many vertices are done on whole arrays before numba, which takes some 25 s to
#: compile the kernels the first time ever, would have begun.
SMALL_INPUT = 10_000

_numba: Any = None
if not os.environ.get(DISABLE_VARIABLE):
    with contextlib.suppress(ImportError):
        import numba as _numba

HAS_NUMBA = _numba is not None

_chosen: ContextVar[str | None] = ContextVar("terrain_wavelets_engine", default=None)


def current_engine() -> str:
    """Return the name of the engine that kernels run on now.

    Raises
    ------
    OptionError
        The environment names one that there is not, or that is not to be had.
    """
    name = (
        _chosen.get() or os.environ.get(ENGINE_VARIABLE) or ("compiled" if HAS_NUMBA else "arrays")
    )
    if name not in ENGINES:
        raise OptionError(f"{ENGINE_VARIABLE} is {name!r}; give one of {', '.join(ENGINES)}.")
    if name == "compiled" and not HAS_NUMBA:
        raise OptionError(
            f"{ENGINE_VARIABLE} is 'compiled' but numba is not there; install it or leave the "
            "variable out."
        )
    return name


@contextlib.contextmanager
def engine(name: str) -> Iterator[None]:
    """Run kernels on the named engine inside a ``with`` block."""
    token = _chosen.set(name)
    try:
        current_engine()  # refuses what is not to be had
        yield
    finally:
        _chosen.reset(token)


def fitting_engine(n_vertices: int) -> contextlib.AbstractContextManager[None]:
    """Return the engine for a piece of work: whole arrays for small inputs while numba is cold."""
    is_free = not (_chosen.get() or os.environ.get(ENGINE_VARIABLE))
    if is_free and HAS_NUMBA and n_vertices <= SMALL_INPUT and not _is_compiled():
        return engine("arrays")
    return contextlib.nullcontext()


def _is_compiled() -> bool:
    """Whether a kernel has been compiled, in this process or into the cache of one before."""
    return any(step.is_compiled for step in _steps)


_steps: list[Kernel] = []


class Kernel:
    """A step that the algorithms call, in the form of the present engine."""

    def __init__(self, loops: Callable[..., Any]) -> None:
        functools.update_wrapper(self, loops)
        self.loops = loops
        self.compiled = njit(loops)
        self.call = called_past_leak(self.compiled, _numba)
        _steps.append(self)

    @property
    def is_compiled(self) -> bool:
        """Whether it need not be compiled before it runs, as far as numba lets one see."""
        try:
            index = Path(self.compiled._cache._cache_file._index_path)
        except AttributeError:
            return False
        return bool(self.compiled.signatures) or index.exists()

    @functools.cached_property
    def arrays(self) -> Callable[..., Any] | None:
        """The twin on whole arrays; None for the few kernels that have none."""
        name = self.loops.__module__.rpartition(".")[2]
        try:
            module = importlib.import_module(f"..._arrays.{name}", __name__)
        except ModuleNotFoundError:
            return None
        return getattr(module, self.loops.__name__, None)

    def __call__(self, *arguments: Any) -> Any:
        """Run it on the present engine, over all of its items."""
        name = current_engine()
        if name == "compiled":
            return self.call(*arguments)
        if name == "arrays" and self.arrays is not None:
            return self.arrays(*arguments)
        return self.loops(*arguments)


_announced = False


def announce_engine(n_vertices: int) -> None:
    """Say once, for an input of some size, that numba would be faster."""
    global _announced
    if not _announced and not HAS_NUMBA and n_vertices > ANNOUNCED_FROM:
        _announced = True
        warnings.warn(
            "numba is not installed: the work takes two to seven times as long, and 6 to 17 times "
            "to refine a TIN within a tolerance, with the same result; 'pip install numba' speeds "
            "it up.",
            SlowFallbackWarning,
            stacklevel=3,
        )


def kernel(function: Callable[..., Any]) -> Kernel:
    """Make a step of the engines out of its loops."""
    return Kernel(function)


def njit(function: Callable[..., Any]) -> Any:
    """Compile ``function`` with numba where it is there; cached on disk where it can be."""
    if _numba is None:
        return function
    try:
        compiled = _numba.njit(cache=True, nogil=True)(function)
    except RuntimeError:  # no writable place for the cache
        return _numba.njit(nogil=True)(function)
    # Numba takes cached code for good while the file of the function itself is unchanged, though
    # kernels of other files are compiled into it: a change in any of them must void it. The version
    # is compared before the rest of an index is unpickled, which fails on classes that have gone.
    with contextlib.suppress(AttributeError):
        index = compiled._cache._cache_file
        index._version = (index._version, _stamp_of_all_kernels())
        _name_after_numba(index)
    return compiled


def _name_after_numba(index: Any) -> None:
    """Give each version of numba files of its own: those of QGIS and of pip may share the package.

    An index is written before the code that it names. In between another process finds what the
    other version has left there, and cannot read it.
    """
    version = f"-numba{_numba.__version__}"
    index._index_name = index._index_name.replace(".nbi", f"{version}.nbi")
    index._index_path = os.path.join(index._cache_path, index._index_name)
    index._data_name_pattern = index._data_name_pattern.replace(".{", f"{version}.{{")


def inlined(function: Callable[..., Any]) -> Any:
    """Compile ``function`` into its callers: a call with many arrays costs more than its work.

    Measured: costing a collapse took 1.7 times as long with plain calls. Nor are the references to
    its arrays counted (``_nrt``), since it makes none and its callers hold them all: counting them
    in each call took two fifths of that time.
    """
    if _numba is None:
        return function
    return _numba.njit(forceinline=True, nogil=True, error_model="numpy", _nrt=False)(function)


@functools.cache
def _stamp_of_all_kernels() -> tuple[tuple[str, int, int], ...]:
    """Name, time of change and size of every file of kernels."""
    files = sorted(Path(__file__).parent.glob("*.py"))
    return tuple((file.name, file.stat().st_mtime_ns, file.stat().st_size) for file in files)


def run_in_ranges(step: Kernel, n_items: int, *arguments: Any, called: str = "") -> None:
    """Run ``step(start, stop, *arguments)`` over ``[0, n_items)``; compiled, in threads.

    Every item must write only its own results, so that the split does not matter. ``called`` is
    what users know the step by.

    Raises
    ------
    OptionError
        For a kernel that could only run as plain loops, over more than ``MAX_LOOPS`` items.
    """
    name = current_engine()
    if name == "arrays" and step.arrays is None and n_items > MAX_LOOPS:
        raise OptionError(
            f"{called or step.loops.__name__} over {n_items} vertices is too slow without numba "
            f"(at most {MAX_LOOPS}); install numba, or choose another prediction or a smaller "
            "input."
        )
    threads = n_threads()
    if name != "compiled" or n_items < 4096:
        step(0, n_items, *arguments)
        return
    run = step.call
    n_ranges = max(4 * threads, n_items // _ITEMS_BETWEEN_REPORTS)
    bounds = [n_items * k // n_ranges for k in range(n_ranges + 1)]
    run(0, 0, *arguments)  # compiled once, before the threads race for it
    if threads == 1:
        for k, (start, stop) in enumerate(itertools.pairwise(bounds)):
            run(start, stop, *arguments)
            report_share((k + 1) / n_ranges)
        return
    with ThreadPoolExecutor(threads) as pool:
        jobs = [
            pool.submit(run, start, stop, *arguments) for start, stop in itertools.pairwise(bounds)
        ]
        try:
            for k, job in enumerate(jobs):
                job.result()
                report_share((k + 1) / n_ranges)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
