"""A table of what an option may name: nothing but its rows knows the names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol, TypeVar

from .errors import OptionError


class Row(Protocol):
    """What every row gives the lists of a command line, a dialog and the documentation."""

    @property
    def name(self) -> str:
        """The full name, which parameters and files keep."""

    @property
    def help(self) -> str:
        """One line, without a full stop."""


RowT = TypeVar("RowT", bound=Row)


class Table(dict[str, RowT]):
    """The rows by their full names, in the order in which lists show them.

    Parameters
    ----------
    option : str
        The parameter whose values the rows are.
    rows : iterable of Row
        Each with a name of its own; rows with a ``short`` name are found by that too.
    """

    def __init__(self, option: str, rows: Iterable[RowT]) -> None:
        super().__init__((row.name, row) for row in rows)
        self.option = option

    def find(self, name: object) -> RowT:
        """Return the row of a full or short name, in capitals or not.

        Raises
        ------
        OptionError
            There is none.
        """
        row = self.look_up(name)
        if row is None:
            raise OptionError(
                "{0} is {given}; give one of {choices}.",
                self.option,
                given=repr(name),
                choices=", ".join(map(_both_names, self.values())),
            )
        return row

    def chosen(self, name: object) -> RowT:
        """Return the row of a name, the first where it is None.

        Raises
        ------
        OptionError
            There is none of that name.
        """
        return next(iter(self.values())) if name is None else self.find(name)

    def look_up(self, name: object) -> RowT | None:
        """Return the row of a full or short name, in capitals or not; None where there is none."""
        if not isinstance(name, str):
            return None
        wanted = name.strip().lower()
        return next(
            (row for row in self.values() if wanted in (row.name.lower(), short_name(row).lower())),
            None,
        )


def short_name(row: Row) -> str:
    """Return the short name of a row; its full one where it has no other."""
    return getattr(row, "short", "") or row.name


def _both_names(row: Row) -> str:
    short = short_name(row)
    return row.name if short == row.name else f"{row.name} ({short})"
