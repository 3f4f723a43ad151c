"""scikit-learn, and its threads."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from wavelet_core.errors import MissingDependencyError

__all__ = ["few_threads", "half_of_the_cores", "require_sklearn"]


@contextmanager
def few_threads(at_most: int) -> Iterator[None]:
    """Keep scikit-learn's threads from waiting for each other.

    With as many OpenMP threads as cores, boosting took over fifty times as long on a machine
    with other work to do, since its threads spin while they wait. Only libraries that are loaded
    already can be said.
    """
    import sklearn.ensemble  # noqa: F401
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=at_most):
        yield


def half_of_the_cores() -> int:
    """Return how many threads leave the machine to others as well."""
    return max((os.cpu_count() or 2) // 2, 1)


def require_sklearn() -> None:
    """Raise unless scikit-learn is installed."""
    try:
        import sklearn  # noqa: F401
    except ImportError as error:
        raise MissingDependencyError(
            "learning classes needs scikit-learn; install it with 'pip install scikit-learn'."
        ) from error
