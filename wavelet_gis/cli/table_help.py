"""Help texts that name the rows of a table, which is imported when they are shown."""

from __future__ import annotations

import argparse
from importlib import import_module

__all__ = ["TableHelp", "names_from"]


class TableHelp(argparse.HelpFormatter):
    """Adds the names that an argument may have, from the table it was given by `names_from`."""

    def _get_help_string(self, action: argparse.Action) -> str | None:
        table = getattr(action, "table", None)
        if table is None or action.help is None:
            return action.help
        module, name = table.split(":")
        rows = getattr(import_module(module), name).values()
        names = ", ".join(_both_names(row.name, getattr(row, "short", "")) for row in rows)
        return f"{action.help}: {names}".replace("%", "%%")


def names_from(table: str, action: argparse.Action) -> None:
    """Let the help of an argument list the rows of a table.

    Parameters
    ----------
    table : str
        Its module and name, such as ``wavelet_core:PREDICTIONS``.
    action : argparse.Action
        What ``add_argument`` returned.
    """
    action.table = table  # type: ignore[attr-defined]


def _both_names(name: str, short: str) -> str:
    return f"{name} ({short})" if short and short.lower() != name.lower() else name
