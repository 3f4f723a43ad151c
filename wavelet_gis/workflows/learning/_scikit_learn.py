"""What clustering and learning share: scikit-learn, its threads, samples and blocks of rows."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import MissingDependencyError
from wavelet_core.progress import Progress, report

__all__ = [
    "FloatArray",
    "IntArray",
    "blocks_of",
    "few_threads",
    "half_of_the_cores",
    "require_sklearn",
    "sample_of",
]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Vertices that are predicted between two looks at whether to stop.
PREDICTED_AT_ONCE = 50_000


def sample_of(n_items: int, n_wanted: int, generator: np.random.Generator) -> IntArray:
    if n_items <= n_wanted:
        return np.arange(n_items)
    return np.sort(generator.choice(n_items, n_wanted, replace=False))


def blocks_of(n_items: int, progress: Progress | None) -> Iterator[slice]:
    """Yield the rows of each block that is predicted at once; ``progress`` may stop it."""
    for first in range(0, max(n_items, 1), PREDICTED_AT_ONCE):
        report(progress, first / max(n_items, 1))
        yield slice(first, min(first + PREDICTED_AT_ONCE, n_items))


@contextmanager
def few_threads(at_most: int) -> Iterator[None]:
    """Keep scikit-learn's threads from waiting for each other.

    With as many OpenMP threads as cores, boosting took over fifty times as long on a machine
    with other work to do, since its threads spin while they wait. Only libraries that are loaded
    already can be told.
    """
    import sklearn.ensemble  # noqa: F401
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=at_most):
        yield


def half_of_the_cores() -> int:
    return max((os.cpu_count() or 2) // 2, 1)


def require_sklearn() -> None:
    try:
        import sklearn  # noqa: F401
    except ImportError as error:
        raise MissingDependencyError(
            "learning classes needs scikit-learn; install it with 'pip install scikit-learn'."
        ) from error
