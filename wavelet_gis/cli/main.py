"""The command ``terrain-wavelets``: argument parsing and messages only.

Each command is a module of `wavelet_gis.cli.commands` with ``ORDER`` (its place in the list of
commands), ``HELP``, ``add_arguments(parser)`` and ``run(arguments, console)``; ``GOES_ON`` where a
second start goes on from what an interrupted one has made. A module that is put there is a command;
it imports what it needs when it runs, so that ``--help`` comes at once.
"""

from __future__ import annotations

import argparse
import errno
import importlib
import logging
import os
import pkgutil
import re
import sqlite3
import sys
from collections.abc import Sequence
from types import ModuleType

from wavelet_gis._program import PROGRAM, SCRATCH_PREFIX
from wavelet_gis.cli import commands, interrupts
from wavelet_gis.cli.completion import SHELLS, PrintCompletion
from wavelet_gis.cli.console import Console
from wavelet_gis.cli.flags import flag_names
from wavelet_gis.cli.streams import make_standard_streams_usable
from wavelet_gis.cli.table_help import TableHelp

__all__ = ["argument_parser", "main"]

REFUSED = 1

#: What a system says when a file does not fit; Windows knows no quota.
_NO_ROOM = {errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)}

#: Set to see where an unforeseen error came from.
DEBUG_VARIABLE = "TERRAIN_WAVELETS_DEBUG"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code.

    Parameters
    ----------
    arguments : sequence of str, optional
        Instead of the command line's.

    Returns
    -------
    int
        0 done, 1 refused with one line on standard error, 2 usage, 130 interrupted.
    """
    make_standard_streams_usable()
    try:
        chosen = argument_parser().parse_args(arguments)
        if "check" in chosen:  # of a command, what argparse has no words for
            chosen.check(chosen)
    except SystemExit as stop:  # argparse has said why
        return stop.code if isinstance(stop.code, int) else 2
    console = Console(quiet=chosen.quiet, as_json=chosen.json, name_of=chosen.name_of)
    for library in ("laspy", "rasterio", "pyogrio"):
        # Their complaints come to us as exceptions; printed too they would be noise.
        logging.getLogger(library).addHandler(logging.NullHandler())
        logging.getLogger(library).propagate = False
    with interrupts.Raised():
        return _run(chosen, console)


def _run(chosen: argparse.Namespace, console: Console) -> int:
    before = _state(chosen)
    try:
        from wavelet_core.errors import WaveletError

        with console.shown_once():
            chosen.run(chosen, console)
        interrupts.ending()
        sys.stdout.flush()
        return 0
    except (KeyboardInterrupt, interrupts.Terminated) as stop:
        interrupts.ending()
        return _stopped(stop, chosen, before)
    except BrokenPipeError:
        # The reader of our output has gone (`| head`); what is left to say has no taker.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except MemoryError:
        _complain("there is not enough memory for this input; cut it into tiles, or thin it first")
    except Exception as error:
        if os.environ.get(DEBUG_VARIABLE):
            raise
        if isinstance(error, WaveletError):
            _complain(error.in_words(chosen.name_of))
        elif isinstance(error, OSError | sqlite3.Error):
            _complain(f"the operating system refused: {error}{_remedy(error)}")
        else:
            _complain(
                f"an unforeseen error, {type(error).__name__}: {error}; please report it, with "
                f"what {DEBUG_VARIABLE}=1 prints"
            )
    return REFUSED


def _remedy(error: OSError | sqlite3.Error) -> str:
    """Return what to look at, by the number of the error; empty where only the text says it."""
    if isinstance(error, sqlite3.Error):
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        is_full, is_held = code == sqlite3.SQLITE_FULL, code == sqlite3.SQLITE_BUSY
    else:
        is_full = error.errno in _NO_ROOM
        is_held = False
    if is_full:
        return "; is the disk full?"
    return "; close the other program that has the file open" if is_held else ""


def _stopped(stop: BaseException, chosen: argparse.Namespace, before: _State) -> int:
    """Say that a signal came; one that comes when the output is in place has come too late."""
    is_interrupt = isinstance(stop, KeyboardInterrupt)
    word = "interrupted" if is_interrupt else "terminated"
    ended = interrupts.INTERRUPTED if is_interrupt else interrupts.TERMINATED
    if chosen.goes_on:
        _complain(f"{word}; what was made is kept, and the same command goes on from there")
        return ended
    if _state(chosen) != before:
        print(f"{PROGRAM}: {word} after {chosen.output} was written", file=sys.stderr)
        return 0
    _complain(f"{word}; nothing was written")
    return ended


#: Which file is at the output's path: none, or its inode and time of change.
_State = tuple[int, int] | None


def _state(chosen: argparse.Namespace) -> _State:
    try:
        found = os.stat(chosen.output)
    except (AttributeError, OSError, ValueError):  # a command without output, or nothing there yet
        return None
    return found.st_ino, found.st_mtime_ns


def _complain(message: str) -> None:
    # Writers know the scratch folder only; the user knows the file beside it.
    line = re.sub(rf"\{SCRATCH_PREFIX}[^/\\\\]*[/\\\\]", "", " ".join(message.split()))
    print(f"{PROGRAM}: error: {line}", file=sys.stderr)


def argument_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands."""
    parser = argparse.ArgumentParser(
        prog=PROGRAM,
        description="Terrain as a reversible wavelet pyramid of TINs.",
        epilog=f"'{PROGRAM} COMMAND --help' lists the options of a command.",
    )
    parser.add_argument("--version", action="version", version=f"{PROGRAM} {_version()}")
    parser.add_argument(
        "--print-completion",
        action=PrintCompletion,
        choices=SHELLS,
        metavar="SHELL",
        help=f"print what makes a shell complete the command ({', '.join(SHELLS)}) and exit",
    )
    subparsers = parser.add_subparsers(metavar="COMMAND", required=True)
    parsers = [_add_command(subparsers, name, module) for name, module in _commands()]
    for one in parsers:
        one.set_defaults(name_of=flag_names(one, parsers))
    return parser


def _add_command(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser], name: str, module: ModuleType
) -> argparse.ArgumentParser:
    parser = subparsers.add_parser(
        name, help=module.HELP, description=module.HELP, formatter_class=TableHelp
    )
    module.add_arguments(parser)
    parser.add_argument("--quiet", action="store_true", help="say nothing but errors")
    parser.add_argument("--json", action="store_true", help="print figures as JSON")
    parser.set_defaults(run=module.run, goes_on=getattr(module, "GOES_ON", False))
    return parser


def _commands() -> list[tuple[str, ModuleType]]:
    names = [m.name for m in pkgutil.iter_modules(commands.__path__) if m.name[0] != "_"]
    found = [(name, importlib.import_module(f"{commands.__name__}.{name}")) for name in names]
    return sorted(found, key=lambda command: command[1].ORDER)


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("terrain-wavelets")
    except PackageNotFoundError:
        return "(not installed)"
