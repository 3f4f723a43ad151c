"""Readers on trial: each runs in a child process with a limit of time and of memory.

A worker is kept for many trials, since starting Python takes longer than most of them, and is
replaced when it dies or is too slow. What a trial came to is a `Verdict`.
"""

import multiprocessing
import resource
import sys
import time
import traceback
from typing import NamedTuple

SECONDS = 10.0
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
            outcome, text = self._pipe.recv() if self._pipe.poll(self._seconds) else ("slow", "")
        except EOFError:
            self._process.join()
            outcome, text = "died", f"exit code {self._process.exitcode}"
        elapsed = time.monotonic() - started
        self._left -= 1
        if outcome in ("slow", "died") or not self._left:
            self._stop()
        return Verdict(outcome, text, elapsed)

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
        try:
            pipe.send(("read", str(work(case))))
        except refusals as error:
            text = str(error)
            is_one_line = text.strip() and "\n" not in text
            pipe.send(("refused" if is_one_line else "error", text or "no words"))
        except MemoryError:
            pipe.send(("memory", traceback.format_exc()))
        except BaseException:
            pipe.send(("error", traceback.format_exc()))


def _taken():
    if sys.platform != "linux":
        return 4 << 30
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[0]) * resource.getpagesize()
