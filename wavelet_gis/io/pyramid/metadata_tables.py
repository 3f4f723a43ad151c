"""The tables of a pyramid file that describe it in words and figures: metadata, levels, checksums.

Every array has a checksum in its row, and the checksums of all rows, of the levels and of each
piece of metadata are among the metadata. Files of before there were any (which do not name them in
their format) are read without.
"""

from __future__ import annotations

import hashlib
import json
import math
import sqlite3
from collections.abc import Mapping
from typing import Any

from wavelet_core import PyramidError
from wavelet_core.metrics import LevelErrors
from wavelet_gis._fields import LONGEST_JSON, Fields, parse_json
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.geopackage import ordinary_columns, table_names
from wavelet_gis.io.pyramid import array_tables
from wavelet_gis.io.pyramid.array_tables import read_entries
from wavelet_gis.model.geo_pyramid import GeoPyramid

__all__ = [
    "CHECKSUMS",
    "FORMATS_READ",
    "FORMAT_NAME",
    "FORMAT_VERSION",
    "MAX_LEVELS",
    "SCHEMA",
    "TABLES",
    "Contents",
    "checksums_of",
    "read_level_rows",
    "require_tables",
    "write_level_rows",
]

#: Raised by one when a reader of the version before could not read the file. A file that such a
#: reader can read says so: it has the version before.
FORMAT_VERSION = 4

#: The versions that are read. In the first, no pyramid was kept as a record, and what rounding
#: loses was stored in the place of the input's numbers; in the second, no raster had a palette; in
#: the third, a record asked by forecasts alone, and the residuals of rasters had no low bits apart.
FORMATS_READ = (1, 2, 3, 4)

FORMAT_NAME = "terrain-wavelets pyramid"

#: Of the checksums; a reader that does not know the algorithm refuses the file.
CHECKSUMS = "sha256"

#: More levels than this are no pyramid of ours; each would cost tables and memory.
MAX_LEVELS = 1000

_MAX_METADATA = 100

#: A small file has the fewest pages with the tables in this order. That no name is there twice is
#: seen by whoever reads: a constraint would be an index, and a page, each.
SCHEMA = (
    """
CREATE TABLE wavelet_metadata (
  id INTEGER PRIMARY KEY AUTOINCREMENT, name TEXT NOT NULL, value TEXT NOT NULL);
"""
    + array_tables.SCHEMA
    + """
CREATE TABLE wavelet_levels (
  id INTEGER PRIMARY KEY AUTOINCREMENT, level INTEGER NOT NULL, n_vertices INTEGER NOT NULL,
  n_faces INTEGER NOT NULL, rmse_coefficients REAL, rmse_surface REAL, max_error_surface REAL,
  n_uncovered INTEGER);
"""
)

#: With descriptions so short that all four rows of the contents are in one small page.
TABLES = {
    "wavelet_metadata": "Format, CRS, parameters and source of the pyramid (JSON)",
    "wavelet_levels": "Vertices, triangles and errors of each level",
    "wavelet_arrays": "Arrays from which every level is synthesised",
    "wavelet_chunks": "Compressed contents of the arrays",
}

_LEVEL_COLUMNS = (
    "level",
    "n_vertices",
    "n_faces",
    "rmse_coefficients",
    "rmse_surface",
    "max_error_surface",
    "n_uncovered",
)

#: Columns that a reader needs; all of them stored, none generated.
_COLUMNS = {
    "wavelet_metadata": {"name", "value"},
    "wavelet_levels": {"id", *_LEVEL_COLUMNS},
    "wavelet_arrays": {"id", "name", "dtype", "shape", "filter", "chunk_rows"},
    "wavelet_chunks": {"array_id", "sequence", "data"},
}


class Contents:
    """What a file says in words, verified: metadata, figures of the levels, entries of the arrays.

    Raises
    ------
    InputFileError
        When there is no pyramid in the file.
    PyramidError
        When there is one, and it is damaged.
    """

    def __init__(self, connection: sqlite3.Connection) -> None:
        has_checksums = require_tables(connection)
        texts = _read_texts(connection)
        parsed = {name: parse_json(text, f"the metadata {name!r}") for name, text in texts.items()}
        self.metadata = Fields(parsed, "the pyramid")
        self.levels = read_level_rows(connection)
        declares = _require_format(self.metadata)
        is_verified = declares or has_checksums or "checksums" in self.metadata
        if is_verified and not has_checksums:
            raise PyramidError("the checksums of the arrays are missing; the file is damaged.")
        self.entries = read_entries(connection, with_checksums=is_verified)
        if is_verified:
            stored = self.metadata.fields("checksums")
            del texts["checksums"]
            _compare(stored, checksums_of(texts, self.levels, self.entries))
            del self.metadata["checksums"]
        self._check()

    def _check(self) -> None:
        """Check what every reader needs."""
        described = self.metadata.fields("pyramid")
        described.integer("n_levels", 0, MAX_LEVELS)
        described.fields("parameters")
        described.texts("channels")
        CoordinateSystem.from_dict(self.metadata.fields("crs"))
        LocalFrame.from_dict(self.metadata.fields("frame"))
        for name in ("vertical_unit", "source_name"):
            self.metadata.text(name)
        self.metadata.texts("history")


def checksums_of(
    texts: Mapping[str, str],
    levels: tuple[LevelErrors, ...],
    entries: Mapping[str, array_tables.Entry],
) -> dict[str, Any]:
    """Return the checksums of each piece of metadata, of the levels, and of the arrays' table."""
    return {
        "metadata": {name: _digest(text) for name, text in texts.items()},
        "levels": _digest(json.dumps([list(level) for level in levels])),
        "arrays": _digest(
            json.dumps(
                [
                    [name, entry.header.dtype, entry.header.shape, entry.header.filter,
                     entry.header.chunk_rows, entry.checksum]
                    for name, entry in entries.items()
                ]
            )
        ),
    }  # fmt: skip


def _compare(stored: Fields, actual: dict[str, Any]) -> None:
    """Raise unless the checksums are those stored, naming the first part that is another."""
    of_metadata = stored.fields("metadata")
    if changed := {*of_metadata} ^ {*actual["metadata"]}:
        raise PyramidError(f"the metadata {min(changed)!r} was added or removed; {_RESTORE}")
    for name, checksum in actual["metadata"].items():
        if of_metadata[name] != checksum:
            raise PyramidError(f"the checksum of the metadata {name!r} is wrong, {_CHANGED}")
    for name, what in (("levels", "the levels' figures"), ("arrays", "the list of arrays")):
        if stored[name] != actual[name]:
            raise PyramidError(f"the checksum of {what} is wrong, {_CHANGED}")


_RESTORE = "restore the file from a copy, or analyse the input anew."
_CHANGED = f"so this is not what was written; {_RESTORE}"


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def write_level_rows(connection: sqlite3.Connection, geo: GeoPyramid) -> None:
    """Write the figures of each level, finest first; errors only where they were measured."""
    pyramid = geo.pyramid
    rows: list[tuple[float | None, ...]]
    if geo.errors is None:
        rows = [
            (level, pyramid.n_vertices(level), pyramid.n_faces(level), None, None, None, None)
            for level in range(pyramid.n_levels, -1, -1)
        ]
    else:
        rows = [tuple(level) for level in reversed(geo.errors)]
    connection.executemany(
        "INSERT INTO wavelet_levels (level, n_vertices, n_faces, rmse_coefficients, rmse_surface, "
        "max_error_surface, n_uncovered) VALUES (?,?,?,?,?,?,?)",
        rows,
    )


def read_level_rows(connection: sqlite3.Connection) -> tuple[LevelErrors, ...]:
    """Return the figures of the levels in the order of their rows; NaN where there are none."""
    # What is no number is not even fetched; it may be long, and nobody would see it.
    columns = ", ".join(
        f"CASE WHEN TYPEOF({name}) IN ('integer', 'real') THEN {name} END"
        for name in _LEVEL_COLUMNS
    )
    rows = connection.execute(
        f"SELECT {columns} FROM wavelet_levels ORDER BY id LIMIT ?",  # nosec B608
        (MAX_LEVELS + 2,),
    ).fetchall()
    if len(rows) > MAX_LEVELS + 1:
        raise PyramidError(f"the file has more than {MAX_LEVELS} levels; it is damaged.")
    kinds = (int, int, int, float, float, float, int)
    return tuple(
        LevelErrors(*(_figure(value, kind) for value, kind in zip(row, kinds, strict=True)))
        for row in rows
    )


def _figure(value: object, kind: type) -> Any:
    """Return a number for people to read; NaN where there is none, or something else."""
    if isinstance(value, int | float) and math.isfinite(value):
        return kind(value)
    return math.nan


def require_tables(connection: sqlite3.Connection) -> bool:
    """Return whether there are checksums; raise unless the tables hold what they say."""
    if missing := set(TABLES) - table_names(connection):
        raise InputFileError(
            f"this GeoPackage holds no wavelet pyramid (no table {', '.join(sorted(missing))}); "
            "give one that an analysis made."
        )
    columns = {table: ordinary_columns(connection, table) for table in TABLES}
    for table, needed in _COLUMNS.items():
        if missing := needed - columns[table]:
            raise InputFileError(
                f"this GeoPackage holds no wavelet pyramid of ours (no column {min(missing)} in "
                f"{table}); give one that an analysis made."
            )
    return "checksum" in columns["wavelet_arrays"]


def _read_texts(connection: sqlite3.Connection) -> dict[str, str]:
    texts: dict[str, str] = {}
    n_characters = 0
    for name, value in connection.execute("SELECT name, value FROM wavelet_metadata"):
        if not isinstance(name, str) or not isinstance(value, str) or name in texts:
            raise PyramidError(
                f"the metadata {str(name)[:40]!r} are no text, or are there twice; "
                "the file is damaged."
            )
        n_characters += len(name) + len(value)
        if n_characters > 2 * LONGEST_JSON or len(texts) == _MAX_METADATA:
            raise PyramidError("more metadata than any pyramid has; the file is damaged.")
        texts[name] = value
    return texts


def _require_format(metadata: Fields) -> bool:
    """Return whether it declares checksums; raise unless this program reads the format."""
    format_ = metadata.get("format")
    if not isinstance(format_, dict) or format_.get("name") != FORMAT_NAME:
        raise InputFileError("this GeoPackage is no wavelet pyramid of ours.")
    described = Fields(format_, "the format")
    if type(described["version"]) is not int or described["version"] not in FORMATS_READ:
        raise InputFileError(
            f"the file has format version {str(described['version'])[:20]}, this program reads "
            f"{', '.join(map(str, FORMATS_READ))}; update terrain-wavelets."
        )
    described.text("software", 200)
    if described.get("checksums", CHECKSUMS) != CHECKSUMS:
        raise InputFileError(
            f"the file has checksums by {str(described['checksums'])[:20]!r}, this program knows "
            f"{CHECKSUMS}; update terrain-wavelets."
        )
    return "checksums" in described
