"""Notes: facts about an input and what was done with it, collected in one place.

Whoever finds something out calls `note` or `warn`, wherever in the work that is; whoever runs the
work keeps what was noted with `collected`. So the command line's text and its JSON, the report and
the log in QGIS say the same. A warning is also one of Python's, for scripts.

Examples
--------
>>> with collected() as notes:
...     note("cells_without_data", "{n_cells} cells hold no data", n_cells=12)
>>> notes[0].text, notes[0].figures
('12 cells hold no data', {'n_cells': 12})
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from typing import Any

from wavelet_gis.errors import TerrainWarning

__all__ = ["Note", "collected", "note", "warn"]

_current: ContextVar[list[Note] | None] = ContextVar("notes", default=None)


@dataclass(frozen=True, slots=True)
class Note:
    """One fact about an input, or about what was done with it.

    Attributes
    ----------
    code : str
        Stable name of the kind of fact, for programs.
    template : str
        One sentence, for people, as a template of `str.format`.
    options : tuple of str
        Names of the parameters by which a user can have it otherwise: ``{0}`` and on.
    figures : mapping of str to JSON-able values
        What else the template shows, by name.
    is_warning : bool
        Whether it was raised as a warning too.
    """

    code: str
    template: str
    options: tuple[str, ...] = ()
    figures: Mapping[str, Any] = field(default_factory=dict)
    is_warning: bool = False

    @property
    def text(self) -> str:
        """The sentence, with the names of Python's parameters."""
        return self.in_words(str)

    def in_words(self, name_of: Callable[[str], str]) -> str:
        """Return the sentence with the parameters named as the reader knows them.

        Parameters
        ----------
        name_of : callable
            From the name of a Python parameter to what it is called.
        """
        return self.template.format(*map(name_of, self.options), **self.figures)

    def to_dict(self, name_of: Callable[[str], str] = str) -> dict[str, Any]:
        """Return the note as JSON-able values.

        Parameters
        ----------
        name_of : callable
            See `in_words`.
        """
        return {
            "code": self.code,
            "text": self.in_words(name_of),
            "is_warning": self.is_warning,
            "figures": dict(self.figures),
        }

    @classmethod
    def from_dict(cls, fields: Mapping[str, Any]) -> Note:
        """Return the note that `to_dict` described; its text is taken as it stands.

        A template from a file of unknown origin is never filled in.
        """
        text = str(fields["text"]).replace("{", "{{").replace("}", "}}")
        return cls(
            str(fields["code"]), text, (), dict(fields["figures"]), fields["is_warning"] is True
        )


@contextmanager
def collected() -> Iterator[list[Note]]:
    """Yield a list to which everything noted in the block is added, in this thread.

    A block inside another has a list of its own; what is in it is added to the outer one too.
    """
    outer = _current.get()
    notes: list[Note] = []
    token = _current.set(notes)
    try:
        yield notes
    finally:
        _current.reset(token)
        if outer is not None:
            outer.extend(notes)


def note(code: str, template: str, *options: str, **figures: Any) -> None:
    """Note a fact.

    Parameters
    ----------
    code, template, *options, **figures
        See `Note`.
    """
    _keep(Note(code, template, options, figures))


def warn(
    category: type[TerrainWarning],
    code: str,
    template: str,
    *options: str,
    stacklevel: int = 1,
    **figures: Any,
) -> None:
    """Note a fact and raise it as a warning.

    Parameters
    ----------
    category : type of TerrainWarning
        Which warning.
    code, template, *options, **figures
        See `Note`.
    stacklevel : int
        As that of `warnings.warn`, counted from the caller of this function.
    """
    _keep(Note(code, template, options, figures, is_warning=True))
    warnings.warn(category(template, *options, **figures), stacklevel=stacklevel + 1)


def _keep(entry: Note) -> None:
    """Keep a note where somebody collects them, files by their names alone.

    Notes go into pyramid files, which must not name folders and must be the same wherever they are
    made.
    """
    notes = _current.get()
    if notes is None:
        return
    bare = {
        key: os.path.basename(value)
        for key in ("name", "path")
        if isinstance(value := entry.figures.get(key), str | os.PathLike)
    }
    entry = replace(entry, figures={**entry.figures, **bare})
    notes.append(entry)
