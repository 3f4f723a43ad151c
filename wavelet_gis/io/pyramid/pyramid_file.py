"""The pyramid file: a GeoPackage whose tables hold all that exact synthesis needs.

Tables, beside the layers that other modules add:

* ``wavelet_metadata`` (name, value): JSON texts: format, pyramid, record, crs, frame, source, ...;
* ``wavelet_levels``: vertices, triangles and errors of each level, for people;
* ``wavelet_arrays`` and ``wavelet_chunks``: arrays of plain numbers, see
  `wavelet_gis.io.pyramid.array_tables`.

A pyramid that follows from its input is told by that and by few symbols
(`wavelet_gis.io.pyramid.record_parts`), any other by the arrays of its steps. docs/format.md is the
description for those who write a reader.

Every array has a checksum in its row, and the checksums of all rows, of the levels and of each
piece of metadata are among the metadata. Files of before there were any (which do not name them in
their format) are read without.

Reading trusts nothing: types, sizes, shapes and index ranges are checked before use.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import sqlite3
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavelet_core
from wavelet_core import (
    Cancelled,
    Progress,
    Pyramid,
    PyramidError,
    Step,
    TriangleMesh,
    WaveletError,
)
from wavelet_core.lifting.recorded import part_of as part_of_record
from wavelet_core.lifting.recorded import pyramid_of, record_of
from wavelet_core.lifting.signal import SIGNALS
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.metrics import LevelErrors
from wavelet_core.partition.stopping import REASONS, StopRecord
from wavelet_core.progress import report
from wavelet_gis._fields import LONGEST_JSON, Fields, parse_json
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.io.geopackage import (
    PAGE_BYTES,
    SMALL_PAGE_BYTES,
    check_database,
    create_geopackage,
    open_for_writing,
    open_untrusted,
    ordinary_columns,
    register_attributes_table,
    table_names,
)
from wavelet_gis.io.pyramid import array_tables
from wavelet_gis.io.pyramid.array_tables import (
    StoredArrays,
    WrittenArrays,
    read_entries,
    write_arrays,
)
from wavelet_gis.io.pyramid.grid_codec import (
    DIVISORS,
    Residuals,
    decode_grid,
    encode_grid,
    integers_of,
    values_of,
)
from wavelet_gis.io.pyramid.record_parts import (
    faces_from_parts,
    faces_to_parts,
    n_parts,
    record_from_parts,
    record_to_parts,
)
from wavelet_gis.io.read_back import read_back
from wavelet_gis.model.dem import cell_plan
from wavelet_gis.model.exact_restore import CORRECTIONS, number_dtype
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.origin import Origin, origin_from_parts
from wavelet_gis.notes import Note
from wavelet_gis.progress import part_of

__all__ = [
    "FORMATS_READ",
    "FORMAT_VERSION",
    "read_input",
    "read_levels",
    "read_pyramid",
    "read_summary",
    "write_pyramid",
]

#: Raised by one when a reader of the version before could not read the file.
FORMAT_VERSION = 2

#: The versions that are read. In the first, no pyramid was told by a record, and what rounding
#: loses was stored in the place of the input's numbers.
FORMATS_READ = (1, 2)

_FORMAT = "terrain-wavelets pyramid"

#: Of the checksums; a reader that does not know the algorithm refuses the file.
_ALGORITHM = "sha256"

#: More levels than this are no pyramid of ours; each would cost tables and memory.
_MAX_LEVELS = 1000

_MAX_METADATA = 100

_SCHEMA = (
    """
CREATE TABLE wavelet_metadata (
  id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, name TEXT NOT NULL UNIQUE, value TEXT NOT NULL);
CREATE TABLE wavelet_levels (
  id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, level INTEGER NOT NULL,
  n_vertices INTEGER NOT NULL, n_faces INTEGER NOT NULL, rmse_coefficients REAL,
  rmse_surface REAL, max_error_surface REAL, n_uncovered INTEGER);
"""
    + array_tables.SCHEMA
)

_TABLES = {
    "wavelet_metadata": "Format, CRS, parameters and source of the wavelet pyramid (JSON)",
    "wavelet_levels": "Vertices, triangles and errors of each level of resolution",
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

#: Arrays of one step, with the only data type and number of dimensions that each may have.
_STEP_ARRAYS = {
    "odd": ("<i4", 1),
    "target": ("<i4", 1),
    "indptr": ("<i8", 1),
    "indices": ("<i4", 1),
    "weights": ("<f8", 1),
    "details": ("<f8", 2),
}

#: Part of the time of writing that is spent before the first array is written.
_SHARE_OF_TELLING = 0.5

#: Part of the time of writing that is spent before the file is read back.
_SHARE_OF_WRITING = 0.8

#: Arrays of so few bytes, before they are compressed, are written in small pages.
_SMALL_BYTES = 4 << 20

#: A raster's numbers, in memory and in the file.
_GRID_VALUES = f"source/{CORRECTIONS}/values"
_RESIDUALS = "source/residuals"
_BEYOND = "source/beyond"

_CANCELLED = "writing the pyramid was cancelled; nothing was kept."


def write_pyramid(
    path: str | os.PathLike[str],
    geo: GeoPyramid,
    progress: Progress | None = None,
    *,
    is_alone: bool = False,
) -> None:
    """Write a pyramid to a new GeoPackage without spatial layers, and read it back.

    Parameters
    ----------
    path : path
        A file that does not exist yet (write to a scratch file, see `wavelet_gis.io.atomic`).
    geo : GeoPyramid
        What to write.
    progress : callable, optional
        Called with a fraction in [0, 1]; returning False stops with `Cancelled`.
    is_alone : bool
        Whether no layers will be added, so that small pages make a small pyramid smaller.

    Raises
    ------
    OutputFileError
        When the file cannot be written, or its reader does not take it.
    """
    metadata, arrays = _to_parts(geo, part_of(progress, 0.0, _SHARE_OF_TELLING))
    texts = {name: json.dumps(value, allow_nan=False, sort_keys=True) for name, value in
             metadata.items()}  # fmt: skip
    total, done = sum(array.nbytes for array in arrays.values()) or 1, 0
    is_small = is_alone and total <= _SMALL_BYTES
    create_geopackage(path, SMALL_PAGE_BYTES if is_small else PAGE_BYTES)
    with open_for_writing(path) as connection, _pool() as pool:
        connection.executescript(_SCHEMA)
        for table, description in _TABLES.items():
            register_attributes_table(connection, table, description)
        _write_levels(connection, geo)
        for n_bytes in write_arrays(connection, arrays, pool):
            done += n_bytes
            share = _SHARE_OF_TELLING + (_SHARE_OF_WRITING - _SHARE_OF_TELLING) * done / total
            report(progress, share, _CANCELLED)
        entries = read_entries(connection, with_checksums=True)
        checksums = _checksums(texts, _read_levels(connection), entries)
        texts["checksums"] = json.dumps(checksums, sort_keys=True)
        connection.executemany(
            "INSERT INTO wavelet_metadata (name, value) VALUES (?, ?)", texts.items()
        )
    # SQLite's own check sees the pages; that nothing is missing, the reader itself.
    read_back(path, check_database)
    read_back(path, partial(_read_back, geo=geo, arrays=arrays, total=total, progress=progress))


def read_pyramid(path: str | os.PathLike[str]) -> GeoPyramid:
    """Return the pyramid in a pyramid file, everything in it checked.

    Parameters
    ----------
    path : path
        A GeoPackage of any origin.

    Raises
    ------
    InputFileError
        When the file is missing, held by another program, no GeoPackage, or holds no pyramid.
    PyramidError
        When its parts are damaged, are not those that were written, or do not fit together.
    """
    with open_untrusted(path) as connection, _pool() as pool, _naming(path):
        contents = _Contents(connection)
        arrays = StoredArrays(connection, pool, contents.entries, os.path.getsize(path))
        return _from_parts(contents, arrays)


def read_input(path: str | os.PathLike[str]) -> GeoPyramid:
    """Return what the input comes back from, without the levels where the file allows it.

    Parameters
    ----------
    path : path
        A GeoPackage of any origin.

    Returns
    -------
    GeoPyramid
        Of a file that keeps the input's numbers, its pyramid is the finest level alone, and has no
        faces; of any other file, the whole pyramid.

    Raises
    ------
    InputFileError, PyramidError
        As `read_pyramid`.
    """
    with open_untrusted(path) as connection, _pool() as pool, _naming(path):
        contents = _Contents(connection)
        arrays = StoredArrays(connection, pool, contents.entries, os.path.getsize(path))
        if "record" not in contents.metadata:
            return _from_parts(contents, arrays)
        fields = contents.metadata.fields("source")
        _check_source(fields)
        origin = origin_from_parts(fields, _source_arrays(fields, arrays))
        frame = LocalFrame.from_dict(contents.metadata.fields("frame"))
        mesh = origin.kept_mesh(frame, np.empty((0, 3), dtype=np.int32))
        if mesh is None:
            raise PyramidError("the pyramid is told by an input that the file does not hold.")
        described = contents.metadata.fields("pyramid")
        pyramid = Pyramid.from_parts(
            faces=mesh.faces,
            horizontal=mesh.vertices[:, :2],
            coarse=np.hstack([mesh.vertices[:, 2:], mesh.attributes]),
            steps=(),
            channels=("z", *mesh.attribute_names),
            signal="z",
            update=described.text("update"),
            parameters=dict(described.fields("parameters")),
        )
        return _geo_pyramid(contents, pyramid, origin, frame)


def read_summary(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Return the metadata and the levels' figures, without the arrays; quick for any size.

    Raises
    ------
    InputFileError
        When the file is missing, held by another program, no GeoPackage, or holds no pyramid.
    PyramidError
        When the metadata are damaged or not those that were written.
    """
    with open_untrusted(path) as connection, _naming(path):
        contents = _Contents(connection)
        _check_source(contents.metadata.fields("source"))
        summary = dict(contents.metadata)
        summary["levels"] = [errors._asdict() for errors in contents.levels]
        return summary


def _read_back(
    path: str | os.PathLike[str],
    geo: GeoPyramid,
    arrays: Mapping[str, NDArray[Any]],
    total: int,
    progress: Progress | None,
) -> None:
    """Have the reader take a file that was just written, without room for its arrays."""
    done = 0

    def tell(n_bytes: int) -> None:
        nonlocal done
        done += n_bytes
        share = min(done / total, 1.0)
        report(progress, _SHARE_OF_WRITING + (1 - _SHARE_OF_WRITING) * share, _CANCELLED)

    try:
        with open_untrusted(path) as connection, _pool() as pool:
            contents = _Contents(connection)
            size = os.path.getsize(path)
            _from_parts(
                contents,
                WrittenArrays(connection, pool, contents.entries, size, arrays, tell),
                geo.pyramid,
            )
    except Cancelled:
        raise
    except WaveletError as error:
        raise OutputFileError(
            f"the reader of pyramid files does not take it: {str(error).rstrip('.')}"
        ) from error


@contextmanager
def _naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Name the file in whatever is said of its contents."""
    try:
        yield
    except InputFileError as error:
        raise InputFileError(f"{path}: {error}") from error
    except WaveletError as error:
        raise PyramidError(f"{path}: {error}") from error
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise PyramidError(
            f"{path}: the description of the pyramid is damaged ({error!r}); analyse the "
            "input anew."
        ) from error


# -- what goes in, and how it comes out ----------------------------------------------------------


def _to_parts(
    geo: GeoPyramid, progress: Progress | None = None
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    pyramid = geo.pyramid
    source, arrays = geo.origin.to_parts()
    _shrink_source(geo, source, arrays)
    mesh = geo.origin.kept_mesh(geo.frame, pyramid.faces)
    record = None if mesh is None else record_of(pyramid, mesh, progress)
    if record is None:
        told = None
        arrays.update(_listed(pyramid))
    else:
        told, record_arrays = record_to_parts(record)
        arrays.update(record_arrays)
        if geo.origin.points is not None:
            of_faces, face_arrays = faces_to_parts(geo.origin.points.kept_places, pyramid.faces)
            told.update(of_faces)
            arrays.update(face_arrays)
    if pyramid.locked is not None:
        arrays["locked"] = pyramid.locked
    metadata: dict[str, Any] = {
        "format": {
            "name": _FORMAT,
            "version": FORMAT_VERSION,
            "checksums": _ALGORITHM,
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
            "stop": None if pyramid.stop is None else pyramid.stop._asdict(),
        },
        "crs": geo.system.to_dict(),
        "frame": geo.frame.to_dict(),
        "vertical_unit": geo.vertical_unit,
        "source": source,
        "source_name": os.path.basename(geo.source_name),
        "history": list(geo.history),
    }
    if told is not None:
        metadata["record"] = told
    if geo.notes:
        metadata["notes"] = [note.to_dict() for note in geo.notes]
    return metadata, arrays


def _listed(pyramid: Pyramid) -> dict[str, NDArray[Any]]:
    """Return the arrays of a pyramid that does not follow from its input."""
    arrays: dict[str, NDArray[Any]] = {"faces": pyramid.faces, "coarse": pyramid.coarse}
    if pyramid.horizontal is not None:
        arrays["horizontal"] = pyramid.horizontal
    for level, step in enumerate(pyramid.steps):
        for name in _STEP_ARRAYS:
            arrays[f"steps/{level:04d}/{name}"] = getattr(step, name)
    return arrays


def _shrink_source(
    geo: GeoPyramid, source: dict[str, Any], arrays: dict[str, NDArray[Any]]
) -> None:
    """Put in the place of a raster's numbers their residuals."""
    grid = geo.origin.grid
    if grid is not None and _GRID_VALUES in arrays:
        numbers = integers_of(arrays.pop(_GRID_VALUES))
        residuals = encode_grid(numbers.integers, grid.valid)
        arrays[_RESIDUALS], arrays[_BEYOND] = residuals.numbers, residuals.beyond
        source["divisor"] = numbers.divisor
        source["relief_classes"] = list(residuals.classes)


def _source_arrays(
    source: Fields, arrays: StoredArrays, *, with_numbers: bool = True
) -> dict[str, NDArray[Any]]:
    """Return the arrays of the source, a raster's numbers out of their residuals."""
    if "divisor" not in source:
        return arrays.all_named("source/")
    found = {name: arrays.get(name) for name in ("source/valid", "source/holes")}
    if with_numbers:
        residuals = Residuals(
            arrays.get(_RESIDUALS, n_dimensions=1),
            arrays.get(_BEYOND, "<u8", 1),
            tuple(source.integers("relief_classes")),
        )
        n_rows, n_columns = source.integers("shape", 1)
        packed = arrays.get("source/valid", "|u1", 1)
        if len(packed) != -(-n_rows * n_columns // 8):
            raise source.fault("shape is not that of its mask")
        valid = np.unpackbits(packed, count=n_rows * n_columns).reshape(n_rows, n_columns)
        integers = decode_grid(residuals, valid.astype(bool))
        divisor = source.integer("divisor", 0, max(DIVISORS))
        dtype = number_dtype(source.text("dtype"))
        with np.errstate(over="ignore"):
            found[_GRID_VALUES] = values_of(integers, dtype, divisor)
    return found


def _from_parts(
    contents: _Contents, arrays: StoredArrays, written: Pyramid | None = None
) -> GeoPyramid:
    """Return what a file holds; ``written``, if given, is the pyramid that its record told."""
    metadata = contents.metadata
    fields = metadata.fields("source")
    _check_source(fields)
    origin = origin_from_parts(fields, _source_arrays(fields, arrays))
    frame = LocalFrame.from_dict(metadata.fields("frame"))
    if "record" in metadata:
        pyramid = _recorded(contents, arrays, origin, frame, written)
    else:
        pyramid = _from_lists(contents, arrays)
    n_vertices = pyramid.n_vertices(pyramid.n_levels)
    if origin.n_vertices not in (None, n_vertices):
        raise PyramidError(
            f"the source has {origin.n_vertices} vertices, the pyramid {n_vertices}; analyse "
            "the input anew."
        )
    return _geo_pyramid(contents, pyramid, origin, frame)


def _geo_pyramid(
    contents: _Contents, pyramid: Pyramid, origin: Origin, frame: LocalFrame
) -> GeoPyramid:
    metadata, levels = contents.metadata, contents.levels[::-1]
    n_levels = metadata.fields("pyramid").integer("n_levels")
    return GeoPyramid(
        pyramid=pyramid,
        system=CoordinateSystem.from_dict(metadata.fields("crs")),
        frame=frame,
        vertical_unit=metadata.text("vertical_unit"),
        origin=origin,
        source_name=metadata.text("source_name"),
        errors=levels if len(levels) == n_levels + 1 and _are_measured(levels) else None,
        history=tuple(metadata.texts("history")),
        notes=tuple(Note.from_dict(fields) for fields in metadata.objects("notes"))
        if "notes" in metadata
        else (),
    )


def _from_lists(contents: _Contents, arrays: StoredArrays) -> Pyramid:
    """Return a pyramid from the arrays of its steps."""
    described = contents.metadata.fields("pyramid")
    n_levels = described.integer("n_levels", 0, _MAX_LEVELS)
    steps = [
        Step(
            **{
                name: arrays.get(f"steps/{k:04d}/{name}", *kind)
                for name, kind in _STEP_ARRAYS.items()
            }
        )
        for k in range(n_levels)
    ]
    signal = described.choice("signal", tuple(SIGNALS))
    coarse = arrays.get("coarse", "<f8", 2)
    if not len(coarse):
        raise PyramidError("the coarsest level has no vertices; the file is damaged.")
    pyramid = Pyramid.from_parts(
        faces=arrays.get("faces", "<i4", 2),
        horizontal=arrays.get("horizontal", "<f8", 2) if SIGNALS[signal].keeps_plan else None,
        coarse=coarse,
        steps=steps,
        channels=described.texts("channels"),
        signal=signal,
        update=described.text("update"),
        locked=_locked_from(described, arrays),
        parameters=dict(described.fields("parameters")),
        stop=_stop_from(described),
    )
    n_vertices = pyramid.n_vertices(pyramid.n_levels)
    build_connectivity(pyramid.faces.astype(np.int32), n_vertices)  # refuses what is no manifold
    return pyramid


def _locked_from(described: Fields, arrays: StoredArrays) -> NDArray[np.bool_] | None:
    if not described.flag("has_locked"):
        return None
    return arrays.get("locked", "|u1", 1).astype(bool)


def _recorded(
    contents: _Contents,
    arrays: StoredArrays,
    origin: Origin,
    frame: LocalFrame,
    written: Pyramid | None,
) -> Pyramid:
    """Return a pyramid from its record and the input."""
    described = contents.metadata.fields("pyramid")
    faces = None
    if written is not None:
        faces = written.faces
        arrays.all_named("faces")  # verified
    elif origin.points is not None:
        told, places = contents.metadata.fields("record"), origin.points.kept_places
        faces = faces_from_parts(told, arrays, places)
    mesh = origin.kept_mesh(frame, faces)
    if mesh is None:
        raise PyramidError("the pyramid is told by an input that the file does not hold.")
    design = _design_from(described, len(described.texts("channels")))
    record = record_from_parts(contents.metadata.fields("record"), arrays, len(design["channels"]))
    n_steps = sum(len(part.answers.levels) for part in record.parts)
    if n_steps != described.integer("n_levels"):
        raise PyramidError(f"{n_steps} steps for another number of levels; the file is damaged.")
    if mesh.attribute_names != design["channels"][1:]:
        raise PyramidError("channels that are not those of the source; the file is damaged.")
    locked = _locked_from(described, arrays)
    if locked is not None and locked.shape != (mesh.n_vertices,):
        raise PyramidError("a locked mask of another length; the file is damaged.")
    if written is not None:
        return written
    if origin.grid is None:
        _require_surface(mesh)
    with np.errstate(all="ignore"):
        return pyramid_of(record, mesh, locked=locked, stop=_stop_from(described), **design)


def _require_surface(mesh: TriangleMesh) -> None:
    """Raise unless a mesh of unknown origin is one on which steps can be taken."""
    build_connectivity(mesh.faces.astype(np.int32), mesh.n_vertices)
    if mesh.n_faces and not mesh.plan_areas.min() > 0:
        raise PyramidError("a face that is flipped or flat in plan; the file is damaged.")


def _design_from(described: Fields, n_channels: int) -> dict[str, Any]:
    """Return what the steps of a record are taken by, checked."""
    parameters = described.fields("parameters")
    weights = parameters.numbers("attribute_weights", n_channels - 1)
    tolerance = parameters.number("outline_tolerance")
    if tolerance < 0 or any(weight < 0 for weight in weights):
        raise parameters.fault("a weight or a tolerance below 0")
    described.choice("signal", ("z",))
    channels = tuple(described.texts("channels"))
    if channels[:1] != ("z",) or len(set(channels)) != len(channels):
        raise described.fault("channels of no pyramid")
    return {
        "channels": channels,
        "update": described.choice("update", ("minimum_norm", "none")),
        "parameters": dict(parameters),
    }


def read_levels(path: str | os.PathLike[str], level: int) -> GeoPyramid:
    """Return a pyramid of all levels up to one, or of more, from as little of its file as may be.

    Parameters
    ----------
    path : path
        A GeoPackage of any origin.
    level : int
        The finest that is wanted.

    Returns
    -------
    GeoPyramid
        Its own finest level may be that of the file, or a coarser one (``pyramid.part``); its
        origin then cannot be restored.

    Raises
    ------
    InputFileError, PyramidError
        As `read_pyramid`.
    """
    with open_untrusted(path) as connection, _pool() as pool, _naming(path):
        contents = _Contents(connection)
        arrays = StoredArrays(connection, pool, contents.entries, os.path.getsize(path))
        index = _part_with(contents, level)
        if index == 0:
            return _from_parts(contents, arrays)
        return _part_from(contents, arrays, index)


def _part_with(contents: _Contents, level: int) -> int:
    """Return the last part of a file's record that holds a level; 0 for all of the file."""
    metadata = contents.metadata
    if "record" not in metadata or "divisor" not in metadata.fields("source") or level < 0:
        return 0
    record = metadata.fields("record")
    begins = metadata.fields("pyramid").integer("n_levels")
    found = 0
    for index, part in enumerate(record.objects("parts")[: n_parts(record)]):
        if begins >= level:
            found = index
        begins -= len(part.items_of("levels")) // 2
    return found


def _part_from(contents: _Contents, arrays: StoredArrays, index: int) -> GeoPyramid:
    """Return the levels of a raster's pyramid from one of its parts down."""
    metadata = contents.metadata
    described, fields = metadata.fields("pyramid"), Fields(metadata.fields("source"), "the raster")
    fields.pop(CORRECTIONS, None)
    origin = origin_from_parts(fields, _source_arrays(fields, arrays, with_numbers=False))
    frame = LocalFrame.from_dict(metadata.fields("frame"))
    design = _design_from(described, len(described.texts("channels")))
    record = record_from_parts(metadata.fields("record"), arrays, len(design["channels"]), index)
    ids = record.parts[index].ids
    grid = origin.grid
    if ids is None or grid is None or ids[-1] >= (origin.n_vertices or 0):
        raise PyramidError(f"part {index} has vertices that the raster has not.")
    plan = cell_plan(grid.geometry, grid.valid, frame, ids)
    locked = _locked_from(described, arrays)
    if locked is not None and len(locked) != origin.n_vertices:
        raise PyramidError("a locked mask of another length; the file is damaged.")
    with np.errstate(all="ignore"):
        pyramid = part_of_record(
            record, index, plan, locked=None if locked is None else locked[ids], **design
        )
    return _geo_pyramid(contents, pyramid, origin, frame)


def _stop_from(described: Fields) -> StopRecord | None:
    """Return why the analysis ended; files of before do not tell."""
    if described.get("stop") is None:
        return None
    stored = described.fields("stop")
    target = stored["target_vertices"]
    return StopRecord(
        stored.choice("reason", tuple(REASONS)),
        n_vertices=stored.integer("n_vertices"),
        n_locked=stored.integer("n_locked"),
        n_outline=stored.integer("n_outline"),
        n_inner=stored.integer("n_inner"),
        target_vertices=None if target is None else stored.integer("target_vertices"),
    )


def _check_source(fields: Fields) -> None:
    """Check what a summary tells of the source; the rest is checked when it is used."""
    kind = fields.choice("kind", ("raster", "points", "tin"))
    if kind == "raster":
        if len(fields.integers("shape", 1)) != 2:
            raise fields.fault("shape is not that of a raster")
        fields.text("dtype")
    elif kind == "points":
        fields.integer("n_points")
        if fields["classes"] is not None:
            fields.integers("classes")


class _Contents:
    """What a file says in words, verified: metadata, figures of the levels, entries of the arrays.

    Raises
    ------
    InputFileError
        When there is no pyramid in the file.
    PyramidError
        When there is one, and it is damaged.
    """

    def __init__(self, connection: sqlite3.Connection) -> None:
        has_checksums = _require_tables(connection)
        texts = _read_texts(connection)
        parsed = {name: parse_json(text, f"the metadata {name!r}") for name, text in texts.items()}
        self.metadata = Fields(parsed, "the pyramid")
        self.levels = _read_levels(connection)
        declares = _require_format(self.metadata)
        is_verified = declares or has_checksums or "checksums" in self.metadata
        if is_verified and not has_checksums:
            raise PyramidError("the checksums of the arrays are missing; the file is damaged.")
        self.entries = read_entries(connection, with_checksums=is_verified)
        if is_verified:
            stored = self.metadata.fields("checksums")
            del texts["checksums"]
            _compare(stored, _checksums(texts, self.levels, self.entries))
            del self.metadata["checksums"]
        self._check()

    def _check(self) -> None:
        """Check what every reader needs."""
        described = self.metadata.fields("pyramid")
        described.integer("n_levels", 0, _MAX_LEVELS)
        described.fields("parameters")
        described.texts("channels")
        CoordinateSystem.from_dict(self.metadata.fields("crs"))
        LocalFrame.from_dict(self.metadata.fields("frame"))
        for name in ("vertical_unit", "source_name"):
            self.metadata.text(name)
        self.metadata.texts("history")


# -- checksums -----------------------------------------------------------------------------------


def _checksums(
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
        raise PyramidError(f"the metadata {min(changed)!r} came or went; {_RESTORE}")
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
    # What is no number is not even fetched; it may be long, and would be told to nobody.
    columns = ", ".join(
        f"CASE WHEN TYPEOF({name}) IN ('integer', 'real') THEN {name} END"
        for name in _LEVEL_COLUMNS
    )
    rows = connection.execute(
        f"SELECT {columns} FROM wavelet_levels ORDER BY id LIMIT ?",  # nosec B608
        (_MAX_LEVELS + 2,),
    ).fetchall()
    if len(rows) > _MAX_LEVELS + 1:
        raise PyramidError(f"the file has more than {_MAX_LEVELS} levels; it is damaged.")
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


def _require_tables(connection: sqlite3.Connection) -> bool:
    """Raise unless the tables are there and hold what they say; tell if there are checksums."""
    if missing := set(_TABLES) - table_names(connection):
        raise InputFileError(
            f"this GeoPackage holds no wavelet pyramid (no table {', '.join(sorted(missing))}); "
            "give one that an analysis made."
        )
    columns = {table: ordinary_columns(connection, table) for table in _TABLES}
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
            raise PyramidError(f"the metadata {str(name)[:40]!r} are no text; the file is damaged.")
        n_characters += len(name) + len(value)
        if n_characters > 2 * LONGEST_JSON or len(texts) == _MAX_METADATA:
            raise PyramidError("more metadata than any pyramid has; the file is damaged.")
        texts[name] = value
    return texts


def _require_format(metadata: Fields) -> bool:
    """Raise unless the format is one that this program reads; tell if it declares checksums."""
    format_ = metadata.get("format")
    if not isinstance(format_, dict) or format_.get("name") != _FORMAT:
        raise InputFileError("this GeoPackage is no wavelet pyramid of ours.")
    described = Fields(format_, "the format")
    if type(described["version"]) is not int or described["version"] not in FORMATS_READ:
        raise InputFileError(
            f"the file has format version {str(described['version'])[:20]}, this program reads "
            f"{' and '.join(map(str, FORMATS_READ))}; update terrain-wavelets."
        )
    described.text("software", 200)
    if described.get("checksums", _ALGORITHM) != _ALGORITHM:
        raise InputFileError(
            f"the file has checksums by {str(described['checksums'])[:20]!r}, this program knows "
            f"{_ALGORITHM}; update terrain-wavelets."
        )
    return "checksums" in described


@contextmanager
def _pool() -> Iterator[ThreadPoolExecutor]:
    """Threads for zlib, which lets go of the interpreter; more than a few gain nothing."""
    with ThreadPoolExecutor(max_workers=min(os.cpu_count() or 1, 4)) as pool:
        yield pool
