"""What libraries print or log by themselves, heard instead of shown."""

from __future__ import annotations

import logging
import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["silent_libraries"]

#: How GDAL's log lines begin: the class of the error, and where it was.
_CLASS = re.compile(r"^CPLE_\w+(?: in )?:?\s*")

#: Names that a library did not find in a data base of its own are no matter of the file.
_OF_THE_LIBRARY = "proj.db"

#: So much of what was said is kept.
_MOST_HEARD = 65_536


class _Listener(logging.Handler):
    """Keeps the warnings that rasterio logs of what GDAL says."""

    def __init__(self, lines: list[str]) -> None:
        super().__init__(logging.WARNING)
        self._lines = lines

    def emit(self, record: logging.LogRecord) -> None:
        line = _CLASS.sub("", " ".join(record.getMessage().split()))
        if _is_about_the_file(line):
            self._lines.append(line)


@contextmanager
def silent_libraries() -> Iterator[list[str]]:
    """Keep what GDAL and libtiff print off standard error; their errors come to us anyway.

    Yields
    ------
    list of str
        Empty; when the block has ended, the lines that were printed, or logged as warnings.
    """
    lines: list[str] = []
    listener, logger = _Listener(lines), logging.getLogger("rasterio")
    logger.addHandler(listener)
    try:
        with _printed(lines):
            yield lines
    finally:
        logger.removeHandler(listener)


@contextmanager
def _printed(lines: list[str]) -> Iterator[None]:
    try:
        kept = os.dup(2)
    except OSError:  # standard error is closed
        yield
        return
    with tempfile.TemporaryFile() as heard:
        os.dup2(heard.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            heard.seek(0)
            text = heard.read(_MOST_HEARD).decode("utf-8", errors="replace")
            lines += [line.strip() for line in text.splitlines() if _is_about_the_file(line)]


def _is_about_the_file(line: str) -> bool:
    return bool(line.strip()) and _OF_THE_LIBRARY not in line
