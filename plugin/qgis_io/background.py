"""Computing in a thread of its own, so that the bar moves and the cancel button answers meanwhile.

Much of the work is done by single calls of numpy, scipy or Qhull that take many seconds and ask
nobody. Here the thread of the algorithm waits for them, and looks at the button all the time. Once
it is pressed the work is left alone: it stops by itself where it next reports its progress, and
what it came to is dropped. So only what computes may run here, nothing that writes or holds layers.
"""

from __future__ import annotations

import contextvars
import queue
import threading
from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING, Any, TypeVar

from ..ui.warning_log import shown_in, shown_now
from .crs_and_progress import require_running

if TYPE_CHECKING:
    from qgis.core import QgsFeedback

Result = TypeVar("Result")

#: Seconds between two looks at the button, and those without news after which the bar creeps on.
LOOK, SILENCE = 0.1, 0.4
#: Share of what is left of its part by which the bar creeps.
CREEP = 0.01
#: Share of what is left at the last word of the work by which the bar may be ahead of it: further
#: ahead, nothing would be seen of what it reports next.
LEAD = 0.25
#: Part of the bar that the work's own fraction drives; what follows its last word has the rest.
WORK_PART = 0.9


class Work:
    """What a computation reports of itself, as its functions take it.

    Each is called in the thread of the work; what it says is passed on in that of the algorithm.
    """

    def __init__(self) -> None:
        self.fraction = 0.0
        self.is_left = False
        self.said: queue.SimpleQueue[tuple[Callable[[str], None], str]] = queue.SimpleQueue()
        self.outcome: list[tuple[bool, Any]] = []

    def progress(self, fraction: float) -> bool:
        """Take a fraction; return False once nobody waits any more."""
        self.fraction = fraction
        return not self.is_left

    def in_log(self, show: Callable[[str], None]) -> Callable[[str], None]:
        """Return a function that hands a text to the thread of the algorithm, which shows it."""
        return lambda text: self.said.put((show, text))

    def pass_on(self) -> None:
        """Show what was said."""
        while not self.said.empty():
            show, text = self.said.get()
            show(text)


def computed(
    feedback: QgsFeedback, function: Callable[[Work], Result], start: float, stop: float
) -> Result:
    """Return what a function computes, while the bar moves and the cancel button is looked at.

    Parameters
    ----------
    feedback : QgsFeedback
        Shows the progress and holds the cancel button.
    function : callable
        Takes a `Work`.
    start, stop : float
        The part of the whole work that this is.

    Raises
    ------
    Cancelled
        The button was pressed.
    """
    work = Work()
    context = contextvars.copy_context()  # notes go to the caller's list, on the caller's engine
    thread = threading.Thread(
        target=context.run, args=(_run, work, function, shown_now()), daemon=True
    )
    thread.start()
    shown, news = 0.0, perf_counter()
    while thread.is_alive():
        thread.join(LOOK)
        now = perf_counter()
        reported = WORK_PART * min(work.fraction, 1.0)
        if reported > shown:
            shown, news = reported, now
        elif now - news > SILENCE:
            goal = reported + (LEAD if reported else 1.0) * (1.0 - reported)
            shown, news = shown + CREEP * max(goal - shown, 0.0), now
        feedback.setProgress(100.0 * (start + (stop - start) * shown))
        work.pass_on()
        try:
            require_running(feedback)
        except BaseException:
            work.is_left = True
            raise
    work.pass_on()
    is_fine, result = work.outcome[0]
    if not is_fine:
        raise result
    feedback.setProgress(100.0 * stop)
    return result


def _run(
    work: Work, function: Callable[[Work], Any], shown: tuple[Any, Callable[[Any], str]] | None
) -> None:
    """Run a function in the thread of the work and keep what it comes to, errors too."""
    try:
        if shown is None:
            work.outcome.append((True, function(work)))
            return
        log, wording = shown
        with shown_in(_Relay(work.in_log(log.pushWarning)), wording):
            work.outcome.append((True, function(work)))
    except BaseException as error:
        work.outcome.append((False, error))


class _Relay:
    """The log, as far as warnings need it."""

    def __init__(self, push: Callable[[str], None]) -> None:
        self._push = push

    def pushWarning(self, warning: str | None) -> None:
        """Have a warning shown by the thread of the algorithm."""
        self._push(warning or "")
