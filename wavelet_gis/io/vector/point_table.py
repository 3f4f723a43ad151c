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
        they are; without one the first three are x, y and z.
    attributes : tuple of str
        Names of the columns to keep beside x, y and z.

    Raises
    ------
    InputFileError
        When the file is missing, is not such a table, or lacks a column.
    """
    name = os.fspath(path)
    try:
        with Path(path).open(encoding="utf-8-sig") as stream:
            first = stream.readline(10_000)
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not text"
        raise InputFileError(f"{name}: the table cannot be read ({reason}).") from error
    separator = next((mark for mark in (",", ";", "\t") if mark in first), None)
    words = [word.strip().strip('"') for word in first.strip().split(separator)]
    has_names = not all(map(_is_number, words))
    columns = _columns(name, words if has_names else [], attributes)
    try:
        with Path(path).open(encoding="utf-8-sig") as stream:
            # Only whole lines are comments: a damaged "301.#94" is no 301.
            lines = (line for line in stream if not line.lstrip().startswith("#"))
            values = np.loadtxt(
                lines,
                delimiter=separator,
                comments=None,
                skiprows=int(has_names and not first.lstrip().startswith("#")),
                usecols=columns,
                ndmin=2,
            )
    except (ValueError, IndexError) as error:
        raise InputFileError(
            f"{name}: this is not a table of numbers by column ({error}); give x, y and z in every "
            "line."
        ) from error
    return PointTable(values[:, :3], values[:, 3:], attributes)


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
