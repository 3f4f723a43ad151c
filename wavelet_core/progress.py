"""How long-running work reports its progress, and how it is stopped."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from contextvars import ContextVar

import numpy as np

from .errors import Cancelled

#: What an error says of work that was stopped.
CANCELLED = "the work was cancelled; nothing was kept."

#: Called with a fraction in [0, 1]; the work stops with :class:`Cancelled` when it returns False.
Progress = Callable[[float], bool | None]


def report(
    progress: Progress | None,
    fraction: float,
    message: str = CANCELLED,
) -> None:
    """Pass a fraction on to the caller's progress function, if there is one.

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
    if progress is None:
        return
    answer = progress(fraction)
    if isinstance(answer, bool | np.bool_) and not answer:  # None, as of most functions, goes on
        raise Cancelled(message)


def part_of(progress: Progress | None, start: float, stop: float) -> Progress | None:
    """Return the progress of a part of the work, which runs from ``start`` to ``stop`` of it.

    Examples
    --------
    >>> seen = []
    >>> half = part_of(seen.append, 0.5, 1.0)
    >>> half(0.5), seen
    (None, [0.75])
    """
    if progress is None:
        return None
    return lambda fraction: progress(start * (1.0 - fraction) + stop * fraction)


_watching: ContextVar[Callable[[float], None] | None] = ContextVar("watching", default=None)


@contextmanager
def watched(look: Callable[[float], None]) -> Iterator[None]:
    """Have the long steps inside a ``with`` block report how far they are.

    Parameters
    ----------
    look : callable
        Called with the share of a step that is done, in [0, 1]; it may raise, to stop.
    """
    token = _watching.set(look)
    try:
        yield
    finally:
        _watching.reset(token)


def watched_part(
    progress: Progress | None, start: float = 0.0, stop: float = 1.0, message: str = CANCELLED
) -> AbstractContextManager[None]:
    """Have the long steps inside a ``with`` block report a part of the work's progress.

    Several steps there each begin anew; what is reported does not run back.

    Parameters
    ----------
    progress : callable, optional
    start, stop : float
        Where the part begins and ends, in [0, 1].
    message : str
        Of the error, if the work is to stop.
    """
    if progress is None:
        return nullcontext()
    highest = start

    def look(share: float) -> None:
        nonlocal highest
        highest = max(highest, start + (stop - start) * share)
        report(progress, highest, message)

    return watched(look)


def report_share(share: float) -> None:
    """Report how much of this step is done to whoever watches it, if anybody does."""
    look = _watching.get()
    if look is not None:
        look(share)


class Meter:
    """Progress of work that is done in many small steps, each of which may be the last.

    Parameters
    ----------
    progress : callable, optional
    message : str
        Of the error, if the work is to stop.
    """

    def __init__(self, progress: Progress | None, message: str) -> None:
        self._progress, self._message = progress, message
        self._start, self._stop, self._wanted, self._done = 0.0, 0.0, 1, 0

    def begin(self, start: float, stop: float, n_steps: int) -> None:
        """Begin a part of the work, of about so many steps, and report that."""
        self._start, self._stop = max(start, self._reported), stop
        self._wanted, self._done = max(n_steps, 1), 0
        report(self._progress, self._reported, self._message)

    def tick(self) -> None:
        """Report that a step is done."""
        self._done += 1
        report(self._progress, self._reported, self._message)

    def part(self, fraction: float) -> bool:
        """Take the place of ``progress`` in a step that reports its own fraction."""
        span = (self._stop - self._start) / self._wanted
        report(self._progress, min(self._reported + fraction * span, self._stop), self._message)
        return True

    @property
    def _reported(self) -> float:
        share = min(self._done / self._wanted, 1.0)
        return self._start + share * (self._stop - self._start)
