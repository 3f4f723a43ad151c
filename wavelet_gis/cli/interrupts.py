"""What SIGINT (Ctrl-C) and SIGTERM do to the program, from its first line to its last.

=====================  =================================================================
while                  a signal
=====================  =================================================================
the program starts     ends it at once: there is nothing to clean up
a command runs         raises `Interrupted` or `Terminated`, which unwind: scratch files go
it ends                is ignored: what is done is done, and the exit code says so
=====================  =================================================================

A signal that was ignored when the program started, as a shell has it for SIGINT of its background
jobs, stays ignored. Nothing heavy is imported here, so that the first of the three begins early.
"""

from __future__ import annotations

import os
import signal
import sys

from wavelet_gis._program import PROGRAM

TYPE_CHECKING = False  # `typing` takes a while to load
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, TracebackType
    from typing import Any

__all__ = [
    "INTERRUPTED",
    "TERMINATED",
    "Interrupted",
    "Raised",
    "Terminated",
    "ending",
    "quit_at_once",
]

#: Exit codes, as shells give them: 128 and the number of the signal.
INTERRUPTED, TERMINATED = 130, 143

#: Seconds after which a signal is sent again that came where nothing can be raised.
_AGAIN = 0.05


class Interrupted(KeyboardInterrupt):
    """SIGINT came while a command ran."""


class Terminated(BaseException):
    """SIGTERM came while a command ran; no error, so that nothing but cleaning up stops it."""


def quit_at_once() -> None:
    """Let a signal end the process with one line: for the time before there is work to undo."""
    _install(_quit)


class Raised:
    """Raise a signal as `Interrupted` or `Terminated` in a ``with`` block; undone after it.

    What is raised in a callback of a C library, such as the compiler's, is ignored by Python; the
    signal is sent again then.

    Where `quit_at_once` came before, the process is ours and about to end: signals then stay
    ignored after the block.
    """

    def __enter__(self) -> None:
        self._before = _install(_raise)
        self._ignored = sys.unraisablehook
        sys.unraisablehook = _sent_again(self._ignored)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        sys.unraisablehook = self._ignored
        if _quit not in self._before.values():
            for number, handler in self._before.items():
                signal.signal(number, handler)


def ending() -> None:
    """Ignore signals from here on: the work is done, or is being undone."""
    _install(signal.SIG_IGN)


def _install(handler: Any) -> dict[signal.Signals, Any]:
    """Set a handler for both signals where they are not ignored; return what was there."""
    before: dict[signal.Signals, Any] = {}
    for number in (signal.SIGINT, signal.SIGTERM):
        current = signal.getsignal(number)
        if current is signal.SIG_IGN:
            continue
        try:
            signal.signal(number, handler)
        except ValueError:  # not the main thread, where signals never come
            return {}
        before[number] = current
    return before


def _quit(number: int, frame: FrameType | None) -> None:
    word, code = (
        ("interrupted", INTERRUPTED) if number == signal.SIGINT else ("terminated", TERMINATED)
    )
    os.write(2, f"{PROGRAM}: error: {word}; nothing was written\n".encode())
    os._exit(code)


def _raise(number: int, frame: FrameType | None) -> None:
    raise Interrupted if number == signal.SIGINT else Terminated


def _sent_again(otherwise: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Return what hears of exceptions that are ignored; others than ours are left as they were."""

    def hear(ignored: Any) -> None:
        if not isinstance(ignored.exc_value, Interrupted | Terminated):
            otherwise(ignored)
            return
        import threading  # here, since it takes a while to load

        is_interrupt = isinstance(ignored.exc_value, Interrupted)
        number = signal.SIGINT if is_interrupt else signal.SIGTERM
        main = threading.main_thread().ident  # which Python has signals in
        if hasattr(signal, "pthread_kill") and main is not None:
            timer = threading.Timer(_AGAIN, signal.pthread_kill, (main, number))
        else:
            timer = threading.Timer(_AGAIN, signal.raise_signal, (number,))
        timer.daemon = True
        timer.start()

    return hear
