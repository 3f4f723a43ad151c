"""What libraries print on standard error by themselves, heard instead of shown."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["silent_libraries"]

#: So much of what was said is kept.
_MOST_HEARD = 65_536


@contextmanager
def silent_libraries() -> Iterator[list[str]]:
    """Keep what GDAL and libtiff print off standard error, their errors come to us anyway.

    Yields
    ------
    list of str
        Empty; holds the lines that were printed when the block has ended.
    """
    lines: list[str] = []
    try:
        kept = os.dup(2)
    except OSError:  # standard error is closed
        yield lines
        return
    with tempfile.TemporaryFile() as heard:
        os.dup2(heard.fileno(), 2)
        try:
            yield lines
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            heard.seek(0)
            text = heard.read(_MOST_HEARD).decode("utf-8", errors="replace")
            lines += [line.strip() for line in text.splitlines() if line.strip()]
