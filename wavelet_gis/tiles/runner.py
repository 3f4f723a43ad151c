"""Where pieces and cuts are made: in this process, in others beside it, or on a Dask scheduler.

Few fat tasks, in waves, for each stage its own; what passes from one to the next are files, not
results in memory. A task that is lost, with its worker or its scheduler, is done again from its
inputs, and so is one that was half done: its files are written aside.
"""

from __future__ import annotations

import logging
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from importlib.util import find_spec
from itertools import islice
from multiprocessing import get_context, parent_process
from typing import Any

from wavelet_core._threads import THREADS_VARIABLE
from wavelet_core.errors import MissingDependencyError
from wavelet_gis.errors import OutputFileError

__all__ = ["Job", "records_of", "require_dask"]

#: `wavelet_gis.tiles.piece.make_piece`, or another function that returns a record and can be asked
#: again, and its arguments.
Job = tuple[Callable[..., dict[str, Any]], tuple[Any, ...]]

#: Tasks that a scheduler is given at once; some 50,000 alive are known to stall one.
_WAVE = 10_000

#: Jobs that processes are given at once, each, so that none waits for the next.
_AHEAD = 4

#: Times that all workers may be lost without a piece being made in between.
_MOST_LOSSES = 5


def records_of(
    jobs: Sequence[Job], workers: int, scheduler: str | None
) -> Iterator[dict[str, Any]]:
    """Yield the records of pieces as they are made, in whatever order.

    Parameters
    ----------
    jobs : sequence of Job
    workers : int
        Processes; with 1 the work is done in this one.
    scheduler : str or None
        Address of a Dask scheduler, whose workers see the same files.

    Raises
    ------
    OutputFileError
        Workers are lost again and again, or the scheduler is.
    MissingDependencyError
        A scheduler is named and dask is not installed.
    """
    if scheduler is not None:
        for start in range(0, len(jobs), _WAVE):
            yield from _on_dask(jobs[start : start + _WAVE], scheduler)
    elif workers == 1 or len(jobs) == 1:
        for job in jobs:
            function, arguments = job
            yield function(*arguments)
    else:
        yield from _in_processes(jobs, workers)


def require_dask() -> None:
    """Raise where a scheduler is named and dask is not installed."""
    if find_spec("distributed") is None:
        raise MissingDependencyError(
            "using a scheduler needs dask.distributed; install it with 'pip install distributed', "
            "or leave {0} out.",
            "scheduler",
        )


def _in_processes(jobs: Sequence[Job], workers: int) -> Iterator[dict[str, Any]]:
    left = dict(enumerate(jobs))
    n_losses = 0
    while left:
        n_before = len(left)
        n_processes = min(workers, len(left))
        pool = ProcessPoolExecutor(
            n_processes,
            mp_context=get_context("spawn"),
            initializer=_as_a_worker,
            initargs=(max((os.cpu_count() or 1) // n_processes, 1),),
        )
        try:
            waiting = iter(list(left))
            in_flight: dict[Future[dict[str, Any]], int] = {}
            while True:
                for number in islice(waiting, _AHEAD * workers - len(in_flight)):
                    function, arguments = left[number]
                    in_flight[pool.submit(function, *arguments)] = number
                if not in_flight:
                    break
                for future in wait(in_flight, return_when=FIRST_COMPLETED).done:
                    record = future.result()
                    del left[in_flight.pop(future)]
                    yield record
        except BrokenProcessPool as error:
            n_losses = n_losses + 1 if len(left) == n_before else 0
            if n_losses == _MOST_LOSSES:
                raise OutputFileError(
                    f"the workers were ended {_MOST_LOSSES} times before one of them had made a "
                    "tile; give fewer workers or smaller tiles, if memory is short."
                ) from error
        finally:
            pool.shutdown(cancel_futures=True)


def _as_a_worker(n_threads: int) -> None:
    """Take a share of the cores; leave Ctrl-C to the program, which lets pieces in flight be done.

    Threads of several processes on the same cores wait for one another.
    """
    os.environ.setdefault(THREADS_VARIABLE, str(n_threads))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_program, daemon=True).start()


def _end_with_the_program() -> None:
    """End once the program has: one that is killed tells its workers nothing, and they wait."""
    program = parent_process()
    if program is not None:
        program.join()
        os._exit(1)


def _on_dask(jobs: Sequence[Job], scheduler: str) -> Iterator[dict[str, Any]]:
    from distributed import Client, KilledWorker
    from distributed import as_completed as done
    from distributed.client import FutureCancelledError

    try:
        client = Client(scheduler, timeout="30s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise OutputFileError(
            f"{scheduler}: there is no Dask scheduler at this address ({error}); start one with "
            "'dask scheduler', and workers with 'dask worker'."
        ) from error
    with _unlogged("distributed"), client, client.as_current():
        futures = [client.submit(job[0], *job[1], pure=False, retries=_MOST_LOSSES) for job in jobs]
        try:
            for future in done(futures):
                yield future.result()
                future.release()
        except (FutureCancelledError, OSError) as error:  # make_piece notes what it meets itself
            raise OutputFileError(
                f"{scheduler}: the Dask scheduler is gone; what was made is kept: start one again, "
                "with workers, and the same command goes on from there."
            ) from error
        except KilledWorker as error:
            raise OutputFileError(
                f"{scheduler}: workers were lost again and again with one tile; give them more "
                "memory, or tile anew with smaller tiles; what was made is kept."
            ) from error


@contextmanager
def _unlogged(package: str) -> Iterator[None]:
    """Leave out what a package logs in the block, tracebacks among it; we say it in one line."""
    names = [name for name in logging.root.manager.loggerDict if name.startswith(package)]
    loggers = [logging.getLogger(name) for name in names]
    before = [logger.disabled for logger in loggers]
    for logger in loggers:
        logger.disabled = True
    try:
        yield
    finally:
        for logger, was in zip(loggers, before, strict=True):
            logger.disabled = was
