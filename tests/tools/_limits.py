"""Readers on trial: each runs in a child process with a limit of time and of memory.

A worker is kept for many trials, since starting Python takes longer than most of them, and is
replaced when it dies or is too slow. What a trial came to is a `Verdict`.
"""

import multiprocessing
import os
import resource
import sys
import time
import traceback
from typing import NamedTuple

SECONDS = 10.0  # of the processor
#: The clock on the wall may show this many times more, on a machine with other work to do.
PATIENCE = 8
BYTES = 1 << 30

#: Trials before a worker is replaced, so that what it keeps does not count against a later one.
TRIALS = 500


class Verdict(NamedTuple):
    """What became of a trial.

    outcome : "read", "refused", "error", "slow", "memory" or "died"
    text : the message, or the traceback
    """

    outcome: str
    text: str
    seconds: float


class Trials:
    """Runs ``work(case)`` in a limited child.

    ``work`` is a function of a module; what it returns is the text of a verdict "read", and what
    it raises makes one "refused" if it is of the class ``refusals``, else "error".
    """

    def __init__(self, work, refusals, *, seconds=SECONDS, n_bytes=BYTES):
        self._arguments = (work, refusals, n_bytes)
        self._seconds = seconds
        self._process = None

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self._stop()

    def run(self, case) -> Verdict:
        """Return what became of one case."""
        if self._process is None:
            self._start()
        started = time.monotonic()
        self._pipe.send(case)
        try:
            answered = self._pipe.poll(PATIENCE * self._seconds)
            outcome, text, used = self._pipe.recv() if answered else ("slow", "", self._seconds)
        except EOFError:
            self._process.join()
            outcome, text = "died", f"exit code {self._process.exitcode}"
            used = time.monotonic() - started
        if used > self._seconds:
            outcome = "slow"
        self._left -= 1
        if outcome in ("slow", "died") or not self._left:
            self._stop()
        return Verdict(outcome, text, used)

    def _start(self):
        self._pipe, theirs = multiprocessing.Pipe()
        # Spawned: a child forked beside threads may find their locks held.
        context = multiprocessing.get_context("spawn")
        self._process = context.Process(target=_serve, args=(theirs, *self._arguments), daemon=True)
        self._process.start()
        theirs.close()
        self._left = TRIALS
        if not self._pipe.poll(120):
            raise RuntimeError("the worker does not start")
        self._pipe.recv()

    def _stop(self):
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._pipe.close()
            self._process = None


def _serve(pipe, work, refusals, n_bytes):
    # Addresses that are taken already (libraries, arenas) do not count.
    limit = _taken() + n_bytes
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    pipe.send("ready")
    while True:
        case = pipe.recv()
        began = _processor_time()
        outcome, text = _outcome_of(work, refusals, case)
        pipe.send((outcome, text, _processor_time() - began))


def _outcome_of(work, refusals, case):
    try:
        return "read", str(work(case))
    except refusals as error:
        text = str(error)
        is_one_line = text.strip() and "\n" not in text
        return ("refused" if is_one_line else "error"), text or "no words"
    except MemoryError:
        return "memory", traceback.format_exc()
    except BaseException:
        return "error", traceback.format_exc()


def _processor_time():
    return sum(os.times()[:4])


def _taken():
    if sys.platform != "linux":
        return 4 << 30
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[0]) * resource.getpagesize()
