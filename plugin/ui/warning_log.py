"""Our named warnings shown in the log of the algorithm that raised them."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol, TextIO

_feedbacks = threading.local()
_show_before: Callable[..., None] | None = None


class Warnings(Protocol):
    """A log, as far as warnings go."""

    def pushWarning(self, warning: str | None) -> None:
        """Show a warning."""


@contextmanager
def shown_in(feedback: Warnings, wording: Callable[[Any], str]) -> Iterator[None]:
    """Show our warnings that this thread raises inside the block in its log.

    QGIS runs algorithms in several threads, so Python's own ``catch_warnings``, which swaps the
    handler of the whole process, will not do: one handler is installed, once, and looks up the
    feedback of the thread it is called in. All other warnings go where they went before.

    Parameters
    ----------
    feedback : QgsProcessingFeedback, or what stands for it
        The log.
    wording : callable
        Takes a warning and returns what to show.
    """
    _install()
    outer = getattr(_feedbacks, "current", None)
    _feedbacks.current = (feedback, wording)
    try:
        yield
    finally:
        _feedbacks.current = outer


def shown_now() -> tuple[Warnings, Callable[[Any], str]] | None:
    """Return where this thread's warnings are shown, and how they are worded; None for nowhere."""
    return getattr(_feedbacks, "current", None)


def _install() -> None:
    global _show_before
    from wavelet_core.errors import WaveletWarning
    from wavelet_gis.errors import TerrainWarning

    # Also when the same text comes from the same line again: each run has a log of its own.
    warnings.simplefilter("always", TerrainWarning)
    warnings.simplefilter("always", WaveletWarning)
    if warnings.showwarning is not _show:
        _show_before = warnings.showwarning
        warnings.showwarning = _show


def uninstall() -> None:
    """Put the handler back that was there before."""
    global _show_before
    if warnings.showwarning is _show and _show_before is not None:
        warnings.showwarning = _show_before
    _show_before = None


def _show(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    from wavelet_core.errors import SlowFallbackWarning, WaveletWarning
    from wavelet_gis.errors import TerrainWarning

    current = getattr(_feedbacks, "current", None)
    if current is not None and issubclass(category, SlowFallbackWarning):
        return  # said already, with the remedy for this platform
    if current is not None and issubclass(category, TerrainWarning | WaveletWarning):
        feedback, wording = current
        feedback.pushWarning(wording(message))
    elif _show_before is not None:
        _show_before(message, category, filename, lineno, file, line)
