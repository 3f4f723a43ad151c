"""Standard streams that can be written to, whatever the shell handed over."""

from __future__ import annotations

import os
import sys

__all__ = ["make_standard_streams_usable"]


def make_standard_streams_usable() -> None:
    """Open what is closed to nowhere, and let no character be one too many for a terminal.

    With a closed stream its number would go to the next file that is opened, an output perhaps,
    and what libraries print would end up in it.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free: this one
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
