"""Seconds that the parts of a work take."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from wavelet_gis._allocator import give_memory_back

__all__ = ["Clock"]


class Clock:
    """Seconds of each part of a work."""

    def __init__(self, on_stage: Callable[[str], None] | None = None) -> None:
        self._on_stage = on_stage
        self._began: list[tuple[str, float]] = []

    def stage(self, name: str) -> None:
        """Begin the part of this name."""
        give_memory_back()
        self._began.append((name, perf_counter()))
        if self._on_stage is not None:
            self._on_stage(name)

    def seconds(self) -> dict[str, float]:
        """Return what each part took, the last until now."""
        ends = [start for _, start in self._began[1:]] + [perf_counter()]
        return {name: end - start for (name, start), end in zip(self._began, ends, strict=True)}
