"""How far a work has come: the progress of a part as that of the whole, and seconds."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from wavelet_core import Progress

__all__ = ["Clock", "part_of"]


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


class Clock:
    """Seconds of each part of a work."""

    def __init__(self, on_stage: Callable[[str], None] | None = None) -> None:
        self._on_stage = on_stage
        self._began: list[tuple[str, float]] = []

    def stage(self, name: str) -> None:
        """Begin the part of this name."""
        self._began.append((name, perf_counter()))
        if self._on_stage is not None:
            self._on_stage(name)

    def seconds(self) -> dict[str, float]:
        """Return what each part took, the last until now."""
        ends = [start for _, start in self._began[1:]] + [perf_counter()]
        return {name: end - start for (name, start), end in zip(self._began, ends, strict=True)}
