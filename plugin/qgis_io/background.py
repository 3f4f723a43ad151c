"""Computing in a thread of its own, so that the bar moves and the cancel button answers meanwhile.

Much of the work is done by single calls of numpy, scipy or Qhull that take many seconds and ask
nobody. Here the thread of the algorithm waits for them, and looks at the button all the time. Once
it is pressed the work is left alone: it stops by itself where it next reports its progress, and
what it came to is dropped. So only what computes may run here, or writes aside and cleans up when
it is stopped; nothing that holds layers.
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

#: Seconds between two looks at the button, and those without a step after which the clock makes
#: one.
LOOK, SILENCE = 0.1, 0.8
#: Seconds without a look beyond which the program was held up, as while a computer sleeps: that
#: time says nothing of the work's pace.
HELD = 1.0
#: Part of QGIS's bar below which it shows nothing new (`QgsFeedback.setProgress`): a step.
LEAST = 0.001
#: How far, of what a work has left, the clock's steps may lead what was reported, so that some of
#: the bar is left for the end; in narrow parts so many steps that are seen. Of work that has said
#: nothing for so many seconds they may lead by more.
AHEAD, STEPS_AHEAD = 0.05, 8
LONG_SILENCE, FAR_AHEAD = 2.0, 0.25
#: How far, and in narrow parts how many steps, before the work's first word.
FIRST_AHEAD, FIRST_STEPS_AHEAD = 0.8, 20
#: Shares of what is left: what a step of the clock may take, and what it adds where it leads by
#: more, before the first word and after it.
STEP_OF_LEFT, FIRST_TRICKLE, TRICKLE = 0.05, 0.01, 0.0002
#: Part of the bar that the work's own fraction drives; what follows its last word has the rest.
WORK_PART = 0.98


class Bar:
    """Where the bar stands: it moves evenly, so that what is left of it lasts as long as the work.

    What the work has reported, and when it began, say how long the rest will take; that grows while
    the work is silent. In that time the bar runs through what is left of it, so that it neither
    rests between two reports nor waits for the work to catch up.

    Parameters
    ----------
    now : float
        Seconds, at which the work begins.
    width : float
        How much of QGIS's bar it has.
    """

    def __init__(self, now: float, width: float = 1.0) -> None:
        self._least = LEAST / max(width, LEAST)
        self._shown, self._reported = 0.0, 0.0
        self._seen = 0.0
        self._moved = now - SILENCE / 2  # what goes before may have shown nothing for a while
        self._began, self._looked, self._heard = now, now, now

    def at(self, fraction: float, now: float) -> float:
        """Return where it stands, in [0, 1].

        Parameters
        ----------
        fraction : float
            What the work last reported.
        now : float
            Seconds.
        """
        held = now - self._looked - HELD
        if held > 0.0:
            self._began, self._heard = self._began + held, self._heard + held
            self._looked += held
        reported = WORK_PART * min(fraction, 1.0)
        if reported > self._reported:
            self._reported, self._heard = reported, now
        left = 1.0 - self._shown
        if self._reported > 0.0:
            remaining = (1.0 - self._reported) / self._reported * (now - self._began)
            self._shown += left * min((now - self._looked) / max(remaining, LOOK), 1.0)
        self._looked = now
        if now - self._moved > SILENCE:
            most = STEP_OF_LEFT * left
            if self._reported == 0.0 and left > 2.0 * self._least:
                most = max(most, 1.01 * self._least)
            self._shown += min(self._step(now), most)
            self._moved = now
        if self._shown - self._seen >= self._least:
            self._seen, self._moved = self._shown, now
        return self._shown

    def _step(self, now: float) -> float:
        """Return what the clock adds where nothing new was seen for a while."""
        is_silent = now - self._heard > LONG_SILENCE
        left = 1.0 - self._reported
        # early, what is reported says little of what is left, and there is room
        ahead = (FAR_AHEAD if is_silent else max(AHEAD, FAR_AHEAD * left)) * left
        ahead = max(ahead, STEPS_AHEAD * self._least)
        if self._reported == 0.0:
            ahead = max(ahead, min(FIRST_AHEAD, FIRST_STEPS_AHEAD * self._least))
        if self._shown < self._reported + ahead:
            return 1.01 * self._least
        trickle = TRICKLE if self._reported > 0.0 else FIRST_TRICKLE
        return trickle * (1.0 - self._shown)


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

    def isCanceled(self) -> bool:
        """Return whether nobody waits any more, as a `QgsFeedback` says it."""
        return self.is_left

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
    bar = Bar(perf_counter(), stop - start)
    while thread.is_alive():
        thread.join(LOOK)
        shown = bar.at(work.fraction, perf_counter())
        feedback.setProgress(100.0 * (start + (stop - start) * shown))
        work.pass_on()
        try:
            require_running(feedback)
        except BaseException:
            work.is_left = True
            raise
    work.pass_on()
    is_fine, result = work.outcome.pop()
    if not is_fine:
        try:
            raise result
        finally:
            del result  # it would hold itself, and all that the work held, by this frame
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
