"""What a command says, and where: lines, figures, warnings, a progress bar."""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO

from wavelet_gis._program import PROGRAM

if TYPE_CHECKING:  # the core takes a while to import, which a mistyped command need not wait for
    from wavelet_core import Progress
    from wavelet_gis.notes import Note

__all__ = ["Console"]


class Console:
    """The way out for everything that a command has to say.

    Parameters
    ----------
    quiet : bool
        Nothing but errors and, if asked for, figures.
    as_json : bool
        Figures as one JSON object on standard output instead of lines for people.
    name_of : callable
        From the name of a parameter to that of its flag.
    """

    def __init__(
        self,
        *,
        quiet: bool = False,
        as_json: bool = False,
        name_of: Callable[[str], str] = str,
    ) -> None:
        self._quiet = quiet
        self._as_json = as_json
        self._name_of = name_of
        self._notes: list[Note] = []
        self._n_shown = 0
        self._held_warnings: list[str] = []

    def say(self, line: str) -> None:
        """Print a line for people."""
        if not self._quiet and not self._as_json:
            print(line)

    def figures(self, values: Mapping[str, Any]) -> None:
        """Print the figures of the command and what was noted, if JSON was asked for."""
        if self._as_json:
            noted = [note.to_dict(self._name_of) for note in self._notes]
            # Those that a pyramid file holds come first; the figures have them already.
            notes = [*values.get("notes", ()), *noted]
            print(json.dumps(_plain({**values, "notes": notes})))

    def table(self, header: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
        """Print a table with right-aligned columns."""
        cells = [[_cell(value) for value in row] for row in rows]
        widths = [max(map(len, column)) for column in zip(header, *cells, strict=True)]
        for line in [list(header), *cells]:
            aligned = (cell.rjust(width) for cell, width in zip(line, widths, strict=True))
            self.say("  ".join(aligned))

    @contextmanager
    def progress(self, what: str) -> Iterator[Progress]:
        """Yield a function that takes a fraction and moves a bar, seen on a terminal only."""
        self._tell()
        if self._quiet or not sys.stderr.isatty():
            yield lambda fraction: True
            return
        from tqdm import tqdm

        form = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}"
        with tqdm(total=1.0, desc=what, bar_format=form, leave=False, file=sys.stderr) as bar:

            def move(fraction: float) -> bool:
                bar.update(max(min(fraction, 1.0) - bar.n, 0.0))
                return True

            yield move

    @contextmanager
    def shown_once(self) -> Iterator[None]:
        """Show each note and warning of the block as one line; none when quiet.

        Warnings go to standard error, other notes to standard output. They are held until the long
        work begins or the command is done: input that is refused gets one line, which says what is
        wrong, and no others beside it.
        """
        from wavelet_core.errors import SlowFallbackWarning, UnstableDesignWarning
        from wavelet_gis.errors import TerrainWarning
        from wavelet_gis.notes import collected

        def show(
            message: Warning | str,
            category: type[Warning],
            filename: str,
            lineno: int,
            file: TextIO | None = None,
            line: str | None = None,
        ) -> None:
            is_ours = isinstance(message, TerrainWarning)
            text = message.in_words(self._name_of) if is_ours else str(message)  # type: ignore[union-attr]
            self._held_warnings.append(" ".join(text.split()))

        with warnings.catch_warnings(), collected() as self._notes:
            # What libraries warn of is for developers; ours is for the user, each once.
            warnings.simplefilter("ignore")
            warnings.simplefilter("always", TerrainWarning)
            warnings.simplefilter("always", UnstableDesignWarning)
            warnings.simplefilter("once", SlowFallbackWarning)
            warnings.showwarning = show
            yield
        self._tell()

    def _tell(self) -> None:
        for note in self._notes[self._n_shown :]:
            if not note.is_warning:
                self.say(note.in_words(self._name_of))
        self._n_shown = len(self._notes)
        if not self._quiet:
            for text in self._held_warnings:
                print(f"{PROGRAM}: warning: {text}", file=sys.stderr)
        self._held_warnings.clear()


def _cell(value: object) -> str:
    if isinstance(value, float):
        return "-" if value != value else f"{value:.4g}"
    return f"{value:,}" if isinstance(value, int) else str(value)


def _plain(value: Any) -> Any:
    """JSON knows neither NaN nor numpy's numbers."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))):
        return None
    return value
