"""Tables of points as text: x, y, z and attributes by column."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.errors import InputFileError

__all__ = ["PointTable", "read_point_table"]

#: Names that the columns of the coordinates go by, in lower case.
_COORDINATES = {
    "x": ("x", "easting", "east", "lon", "longitude"),
    "y": ("y", "northing", "north", "lat", "latitude"),
    "z": ("z", "elevation", "height", "altitude", "h"),
}


#: Characters of a line that are looked at for names.
_LONGEST_LINE = 10_000


class PointTable(NamedTuple):
    """The points of a table.

    points : (n_points, 3) float64, x, y, z
    attributes : (n_points, n_attributes) float64
    attribute_names : tuple of str
    """

    points: NDArray[np.float64]
    attributes: NDArray[np.float64]
    attribute_names: tuple[str, ...]


def read_point_table(path: str | os.PathLike[str], attributes: tuple[str, ...] = ()) -> PointTable:
    """Return the points in a text file, one a line.

    Parameters
    ----------
    path : path
        Columns are apart by commas, semicolons, tabs or blanks. A first line of names says which
        they are; without one the first three are x, y and z. Lines that begin with ``#`` are
        comments, of which one with a name for each column does as well.
    attributes : tuple of str
        Names of the columns to keep beside x, y and z.

    Raises
    ------
    InputFileError
        When the file is missing, is not such a table, or lacks a column.
    """
    name = os.fspath(path)
    try:
        heading, first = _head(path)
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not text"
        raise InputFileError(f"{name}: the table cannot be read ({reason}).") from error
    words = _words(first)
    has_names = not all(map(_is_number, words))
    if not has_names and len(heading) == len(words):
        columns = _columns(name, heading, attributes)
    else:
        columns = _columns(name, words if has_names else [], attributes)
    try:
        with Path(path).open(encoding="utf-8-sig") as stream:
            # Only whole lines are comments: a damaged "301.#94" is no 301.
            lines = (line for line in stream if not line.lstrip().startswith("#"))
            values = np.loadtxt(
                lines,
                delimiter=_separator(first),
                comments=None,
                skiprows=int(has_names),
                usecols=columns,
                ndmin=2,
            )
    except (ValueError, IndexError) as error:
        raise InputFileError(
            f"{name}: this is not a table of numbers by column ({error}); give x, y and z in every "
            "line."
        ) from error
    return PointTable(values[:, :3], values[:, 3:], attributes)


def _head(path: str | os.PathLike[str]) -> tuple[list[str], str]:
    """Return the names in the first comment that has x, y and z, and the first other line."""
    heading: list[str] = []
    with Path(path).open(encoding="utf-8-sig") as stream:
        for line in iter(lambda: stream.readline(_LONGEST_LINE), ""):
            if not line.lstrip().startswith("#"):
                return heading, line
            words = _words(line.lstrip().lstrip("#"))
            lowered = {word.lower() for word in words}
            if not heading and all(lowered.intersection(own) for own in _COORDINATES.values()):
                heading = words
    return heading, ""


def _separator(line: str) -> str | None:
    return next((mark for mark in (",", ";", "\t") if mark in line), None)


def _words(line: str) -> list[str]:
    return [word.strip().strip('"') for word in line.strip().split(_separator(line))]


def _columns(name: str, names: list[str], attributes: tuple[str, ...]) -> list[int]:
    lowered = [word.lower() for word in names]
    if not names:
        if attributes:
            raise InputFileError(
                "{name}: the table has no header line, so {0} cannot be found; leave it out.",
                "attributes",
                name=name,
            )
        return [0, 1, 2]
    chosen = []
    for axis, known in _COORDINATES.items():
        found = [lowered.index(word) for word in known if word in lowered]
        if not found:
            raise InputFileError(
                f"{name}: the table has no column {axis}; it has {', '.join(names)}."
            )
        chosen.append(found[0])
    for wanted in attributes:
        if wanted.lower() not in lowered:
            raise InputFileError(
                f"{name}: the table has no column {wanted!r}; it has {', '.join(names)}."
            )
        chosen.append(lowered.index(wanted.lower()))
    return chosen


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
