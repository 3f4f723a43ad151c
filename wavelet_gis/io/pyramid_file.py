"""The pyramid file: a GeoPackage whose tables hold all that exact synthesis needs.

Tables, beside the layers that other modules add:

* ``wavelet_metadata`` (name, value): JSON texts: format, pyramid, crs, frame, source;
* ``wavelet_levels``: vertices, triangles and errors of each level, for people;
* ``wavelet_arrays`` (name, dtype, shape, filter, chunk_rows) and ``wavelet_chunks`` (array_id,
  sequence, data): arrays of plain numbers, see `wavelet_gis.io.array_codec`.

Reading trusts nothing: types, sizes, shapes and index ranges are checked before use.
"""

from __future__ import annotations

import json
import math
import os
import sqlite3
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

from numpy.typing import NDArray

import wavelet_core
from wavelet_core import Progress, Pyramid, PyramidError, Step
from wavelet_core.metrics import LevelErrors
from wavelet_core.progress import report
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.array_codec import ArrayHeader, decode_array, encode_array, header_of
from wavelet_gis.io.geopackage import (
    create_geopackage,
    open_for_writing,
    open_stranger,
    register_attributes_table,
    table_names,
)
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.origin import origin_from_parts
from wavelet_gis.notes import Note

__all__ = ["FORMAT_VERSION", "read_pyramid", "read_summary", "write_pyramid"]

#: Raised by one when a reader of the version before could not read the file.
FORMAT_VERSION = 1

_FORMAT = "terrain-wavelets pyramid"

#: More levels than this are no pyramid of ours; each would cost tables and memory.
_MAX_LEVELS = 1000

_SCHEMA = """
CREATE TABLE wavelet_metadata (
  id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, name TEXT NOT NULL UNIQUE, value TEXT NOT NULL);
CREATE TABLE wavelet_levels (
  id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, level INTEGER NOT NULL,
  n_vertices INTEGER NOT NULL, n_faces INTEGER NOT NULL, rmse_coefficients REAL,
  rmse_surface REAL, max_error_surface REAL, n_uncovered INTEGER);
CREATE TABLE wavelet_arrays (
  id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, name TEXT NOT NULL UNIQUE, dtype TEXT NOT NULL,
  shape TEXT NOT NULL, filter TEXT NOT NULL, chunk_rows INTEGER NOT NULL);
CREATE TABLE wavelet_chunks (
  id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, array_id INTEGER NOT NULL,
  sequence INTEGER NOT NULL, data BLOB NOT NULL);
CREATE INDEX wavelet_chunks_of_array ON wavelet_chunks (array_id, sequence);
"""

_TABLES = {
    "wavelet_metadata": "Format, CRS, parameters and source of the wavelet pyramid (JSON)",
    "wavelet_levels": "Vertices, triangles and errors of each level of resolution",
    "wavelet_arrays": "Arrays from which every level is synthesised",
    "wavelet_chunks": "Compressed contents of the arrays",
}

#: Arrays of one step, with the only data type that each may have.
_STEP_DTYPES = {
    "odd": "<i4",
    "target": "<i4",
    "indptr": "<i8",
    "indices": "<i4",
    "weights": "<f8",
    "details": "<f8",
}


def write_pyramid(
    path: str | os.PathLike[str], geo: GeoPyramid, progress: Progress | None = None
) -> None:
    """Write a pyramid to a new GeoPackage without spatial layers.

    Parameters
    ----------
    path : path
        A file that does not exist yet (write to a scratch file, see `wavelet_gis.io.atomic`).
    geo : GeoPyramid
        What to write.
    progress : callable, optional
        Called with a fraction in [0, 1]; returning False stops with `Cancelled`.
    """
    metadata, arrays = _to_parts(geo)
    create_geopackage(path)
    with open_for_writing(path) as connection, _pool() as pool:
        connection.executescript(_SCHEMA)
        for table, description in _TABLES.items():
            register_attributes_table(connection, table, description)
        for name, value in metadata.items():
            text = json.dumps(value, allow_nan=False, sort_keys=True)
            connection.execute(
                "INSERT INTO wavelet_metadata (name, value) VALUES (?, ?)", (name, text)
            )
        _write_levels(connection, geo)
        total, done = sum(array.nbytes for array in arrays.values()) or 1, 0
        for name, array in arrays.items():
            _write_array(connection, name, array, pool)
            done += array.nbytes
            report(progress, done / total, "writing the pyramid was cancelled; nothing was kept.")


def read_pyramid(path: str | os.PathLike[str]) -> GeoPyramid:
    """Return the pyramid in a pyramid file, everything in it checked.

    Parameters
    ----------
    path : path
        A GeoPackage of any origin.

    Raises
    ------
    InputFileError
        When the file is missing, no GeoPackage, or holds no pyramid.
    PyramidError
        When its parts are damaged or do not fit together.
    """
    with open_stranger(path) as connection, _pool() as pool:
        metadata = _read_metadata(connection, path)
        try:
            arrays = _Arrays(connection, pool)
            return _from_parts(metadata, arrays, _read_levels(connection))
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            if isinstance(error, PyramidError):
                raise PyramidError(f"{path}: {error}") from error
            raise PyramidError(
                f"{path}: the description of the pyramid is damaged ({error!r}); analyse the "
                "input anew."
            ) from error


def read_summary(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Return the metadata and the levels' figures, without the arrays; quick for any size.

    Raises
    ------
    InputFileError
        When the file is missing, no GeoPackage, or holds no pyramid.
    """
    with open_stranger(path) as connection:
        summary = _read_metadata(connection, path)
        summary["levels"] = [errors._asdict() for errors in _read_levels(connection)]
        return summary


# -- what goes in, and how it comes out ----------------------------------------------------------


def _to_parts(geo: GeoPyramid) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    pyramid = geo.pyramid
    arrays: dict[str, NDArray[Any]] = {"faces": pyramid.faces, "coarse": pyramid.coarse}
    if pyramid.horizontal is not None:
        arrays["horizontal"] = pyramid.horizontal
    if pyramid.locked is not None:
        arrays["locked"] = pyramid.locked
    for level, step in enumerate(pyramid.steps):
        for name in _STEP_DTYPES:
            arrays[f"steps/{level:04d}/{name}"] = getattr(step, name)
    source, source_arrays = geo.origin.to_parts()
    arrays.update(source_arrays)
    metadata: dict[str, Any] = {
        "format": {
            "name": _FORMAT,
            "version": FORMAT_VERSION,
            "software": f"terrain-wavelets {wavelet_core.__version__}",
        },
        "pyramid": {
            "n_levels": pyramid.n_levels,
            "n_vertices": pyramid.n_vertices(pyramid.n_levels),
            "n_faces": len(pyramid.faces),
            "channels": list(pyramid.channels),
            "signal": pyramid.signal,
            "update": pyramid.update,
            "has_locked": pyramid.locked is not None,
            "parameters": dict(pyramid.parameters),
        },
        "crs": geo.system.to_dict(),
        "frame": geo.frame.to_dict(),
        "vertical_unit": geo.vertical_unit,
        "source": source,
        "source_name": os.path.basename(geo.source_name),
        "history": list(geo.history),
    }
    if geo.notes:
        metadata["notes"] = [note.to_dict() for note in geo.notes]
    return metadata, arrays


def _from_parts(
    metadata: dict[str, Any], arrays: _Arrays, levels: tuple[LevelErrors, ...]
) -> GeoPyramid:
    described = metadata["pyramid"]
    n_levels = described["n_levels"]
    if not isinstance(n_levels, int) or not 0 <= n_levels <= _MAX_LEVELS:
        raise PyramidError(f"the file claims {n_levels!r} levels; analyse the input anew.")
    steps = [
        Step(
            **{
                name: arrays.get(f"steps/{k:04d}/{name}", code)
                for name, code in _STEP_DTYPES.items()
            }
        )
        for k in range(n_levels)
    ]
    signal = described["signal"]
    locked = arrays.get("locked", "|u1").astype(bool) if described["has_locked"] else None
    pyramid = Pyramid.from_parts(
        faces=arrays.get("faces", "<i4"),
        horizontal=arrays.get("horizontal", "<f8") if signal == "z" else None,
        coarse=arrays.get("coarse", "<f8"),
        steps=steps,
        channels=[str(name) for name in described["channels"]],
        signal=signal,
        update=described["update"],
        locked=locked,
        parameters=dict(described["parameters"]),
    )
    origin = origin_from_parts(metadata["source"], arrays.all_named("source/"))
    n_vertices = pyramid.n_vertices(pyramid.n_levels)
    if origin.n_vertices not in (None, n_vertices):
        raise PyramidError(
            f"the source has {origin.n_vertices} vertices, the pyramid {n_vertices}; analyse "
            "the input anew."
        )
    return GeoPyramid(
        pyramid=pyramid,
        system=CoordinateSystem.from_dict(metadata["crs"]),
        frame=LocalFrame.from_dict(metadata["frame"]),
        vertical_unit=str(metadata["vertical_unit"]),
        origin=origin,
        source_name=str(metadata["source_name"]),
        errors=levels[::-1] if len(levels) == n_levels + 1 and _are_measured(levels) else None,
        history=tuple(str(line) for line in metadata["history"]),
        notes=tuple(Note.from_dict(fields) for fields in metadata.get("notes", [])),
    )


# -- tables --------------------------------------------------------------------------------------


def _write_levels(connection: sqlite3.Connection, geo: GeoPyramid) -> None:
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


def _read_levels(connection: sqlite3.Connection) -> tuple[LevelErrors, ...]:
    rows = connection.execute(
        "SELECT level, n_vertices, n_faces, rmse_coefficients, rmse_surface, max_error_surface, "
        "n_uncovered FROM wavelet_levels ORDER BY id LIMIT ?",
        (_MAX_LEVELS + 1,),
    ).fetchall()
    kinds = (int, int, int, float, float, float, int)
    return tuple(
        LevelErrors(*(_figure(value, kind) for value, kind in zip(row, kinds, strict=True)))
        for row in rows
    )


def _are_measured(levels: tuple[LevelErrors, ...]) -> bool:
    return all(math.isfinite(value) for level in levels for value in level)


def _figure(value: object, kind: type) -> Any:
    """Return a number for people to read; NaN where there is none, or something else."""
    if isinstance(value, int | float) and math.isfinite(value):
        return kind(value)
    return math.nan


def _read_metadata(connection: sqlite3.Connection, path: str | os.PathLike[str]) -> dict[str, Any]:
    missing = set(_TABLES) - table_names(connection)
    if missing:
        raise InputFileError(
            f"{path}: this GeoPackage holds no wavelet pyramid (no table "
            f"{', '.join(sorted(missing))}); give one that an analysis made."
        )
    metadata = {}
    for name, value in connection.execute("SELECT name, value FROM wavelet_metadata LIMIT 100"):
        try:
            metadata[str(name)] = json.loads(value)
        except (TypeError, ValueError, RecursionError) as error:
            raise PyramidError(
                f"{path}: the metadata {name!r} are no JSON ({error}); the file is damaged."
            ) from error
    format_ = metadata.get("format")
    if not isinstance(format_, dict) or format_.get("name") != _FORMAT:
        raise InputFileError(f"{path}: this GeoPackage is no wavelet pyramid of ours.")
    if format_.get("version") != FORMAT_VERSION:
        raise InputFileError(
            f"{path}: the file has format version {format_.get('version')!r}, this program reads "
            f"{FORMAT_VERSION}; update terrain-wavelets."
        )
    return metadata


def _write_array(
    connection: sqlite3.Connection, name: str, array: NDArray[Any], pool: ThreadPoolExecutor
) -> None:
    header = header_of(array)
    cursor = connection.execute(
        "INSERT INTO wavelet_arrays (name, dtype, shape, filter, chunk_rows) VALUES (?,?,?,?,?)",
        (name, header.dtype, json.dumps(header.shape), header.filter, header.chunk_rows),
    )
    connection.executemany(
        "INSERT INTO wavelet_chunks (array_id, sequence, data) VALUES (?,?,?)",
        (
            (cursor.lastrowid, sequence, chunk)
            for sequence, chunk in enumerate(encode_array(array, pool))
        ),
    )


class _Arrays:
    """The arrays of a file, each read when it is asked for."""

    def __init__(self, connection: sqlite3.Connection, pool: ThreadPoolExecutor) -> None:
        self._connection = connection
        self._pool = pool
        self._headers: dict[str, tuple[int, ArrayHeader]] = {}
        rows = connection.execute(
            "SELECT id, name, dtype, shape, filter, chunk_rows FROM wavelet_arrays LIMIT 100000"
        )
        for array_id, name, dtype, shape, filter_name, chunk_rows in rows:
            header = ArrayHeader.checked(dtype, json.loads(shape), filter_name, chunk_rows)
            self._headers[str(name)] = (array_id, header)

    def get(self, name: str, dtype: str | None = None) -> NDArray[Any]:
        """Return an array, of the data type that it must have."""
        if name not in self._headers:
            raise PyramidError(f"the array {name} is missing; the file is damaged.")
        array_id, header = self._headers[name]
        if dtype is not None and header.dtype != dtype:
            raise PyramidError(
                f"the array {name} holds {header.dtype} where {dtype} is due; the file is damaged."
            )
        n_bytes = self._connection.execute(
            "SELECT COALESCE(SUM(LENGTH(data)), 0) FROM wavelet_chunks WHERE array_id = ?",
            (array_id,),
        ).fetchone()[0]
        try:
            array = decode_array(header, self._chunks(array_id), int(n_bytes), self._pool)
        except PyramidError as error:
            raise PyramidError(f"array {name}: {error}") from error
        array.flags.writeable = False  # so that the pyramid can take it without a copy
        return array

    def all_named(self, prefix: str) -> dict[str, NDArray[Any]]:
        """Return all arrays whose names begin so."""
        return {name: self.get(name) for name in self._headers if name.startswith(prefix)}

    def _chunks(self, array_id: int) -> Iterator[bytes]:
        rows = self._connection.execute(
            "SELECT sequence, data FROM wavelet_chunks WHERE array_id = ? ORDER BY sequence",
            (array_id,),
        )
        for expected, (sequence, data) in enumerate(rows):
            if sequence != expected or not isinstance(data, bytes):
                raise PyramidError(f"chunk {expected} is missing or no bytes; the file is damaged.")
            yield data


@contextmanager
def _pool() -> Iterator[ThreadPoolExecutor]:
    """Threads for zlib, which lets go of the interpreter; more than a few gain nothing."""
    with ThreadPoolExecutor(max_workers=min(os.cpu_count() or 1, 4)) as pool:
        yield pool
