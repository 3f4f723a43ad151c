"""Progress of a part as that of the whole."""

from __future__ import annotations

from collections.abc import Callable

from wavelet_core import Progress

__all__ = ["part_of"]


def part_of(progress: Progress | None, start: float, stop: float) -> Callable[[float], bool] | None:
    """Return the progress of a part that runs from one fraction of the whole to another.

    Parameters
    ----------
    progress : callable or None
        Of the whole.
    start, stop : float
        Where the part begins and ends, in [0, 1].

    Examples
    --------
    >>> seen = []
    >>> half = part_of(lambda fraction: seen.append(fraction), 0.5, 1.0)
    >>> half(0.5), seen
    (True, [0.75])
    """
    if progress is None:
        return None
    return lambda fraction: progress(start + (stop - start) * fraction) is not False
