"""How long work tells how far it is, and how it is stopped."""

from __future__ import annotations

from collections.abc import Callable

from .errors import Cancelled

#: Called with a fraction in [0, 1]; the work stops with :class:`Cancelled` when it returns False.
Progress = Callable[[float], bool | None]


def report(
    progress: Progress | None,
    fraction: float,
    message: str = "the work was cancelled; nothing was kept.",
) -> None:
    """Tell a fraction, where somebody wants to know.

    Parameters
    ----------
    progress : callable, optional
    fraction : float
        Of the work, in [0, 1].
    message : str
        Of the error, if the work is to stop.

    Raises
    ------
    Cancelled
        ``progress`` returned False.
    """
    if progress is not None and progress(fraction) is False:
        raise Cancelled(message)


def part_of(progress: Progress | None, start: float, stop: float) -> Progress | None:
    """Return the progress of a part of the work, which runs from ``start`` to ``stop`` of it."""
    if progress is None:
        return None
    return lambda fraction: progress(start * (1.0 - fraction) + stop * fraction)
