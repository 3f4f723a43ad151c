"""The pyramid file: a GeoPackage whose tables hold all that exact synthesis needs.

Tables, beside the layers that other modules add:

* ``wavelet_metadata`` (name, value): JSON texts: format, pyramid, record, crs, frame, source, ...;
* ``wavelet_levels``: vertices, triangles and errors of each level, for people;
* ``wavelet_arrays`` and ``wavelet_chunks``: arrays of plain numbers, see
  `wavelet_gis.io.pyramid.array_tables`.

docs/reference/format.md describes the format for those who write a reader. Reading trusts nothing:
types, sizes, shapes and index ranges are checked before use.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from typing import Any

from numpy.typing import NDArray

from wavelet_core import Cancelled, Progress, PyramidError, WaveletError
from wavelet_core.lifting.recorded import is_error_guided
from wavelet_core.progress import part_of, report
from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.io.geopackage import (
    PAGE_BYTES,
    SMALL_PAGE_BYTES,
    check_database,
    compact_schema,
    create_geopackage,
    open_for_writing,
    open_untrusted,
    register_attributes_table,
)
from wavelet_gis.io.pyramid.array_tables import (
    INDEX,
    StoredArrays,
    WrittenArrays,
    read_entries,
    write_arrays,
)
from wavelet_gis.io.pyramid.codecs.array_codec import work_of
from wavelet_gis.io.pyramid.metadata_tables import (
    FORMAT_VERSION,
    FORMATS_READ,
    SCHEMA,
    TABLES,
    Contents,
    checksums_of,
    read_level_rows,
    write_level_rows,
)
from wavelet_gis.io.pyramid.pyramid_parts import (
    input_from_parts,
    levels_from_parts,
    pyramid_from_parts,
    pyramid_to_parts,
)
from wavelet_gis.io.pyramid.source_parts import check_source
from wavelet_gis.io.read_back import read_back
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.origin import Origin

__all__ = [
    "FORMATS_READ",
    "FORMAT_VERSION",
    "SHARE_OF_WRITING",
    "read_input",
    "read_levels",
    "read_pyramid",
    "read_summary",
    "write_pyramid",
]

#: Part of the time of writing that is spent before the first array is written: where the pyramid
#: follows from its input, and where the arrays of its steps are listed, which are large.
_SHARE_OF_ENCODING, _SHARE_OF_LISTING = 0.5, 0.1

#: Part of the time of writing that is spent before the file is read back.
SHARE_OF_WRITING = 0.8

#: Arrays of so few bytes, before they are compressed, are written in small pages.
_SMALL_BYTES = 4 << 20

#: The chunks of so few small arrays need no index: for each, all rows are looked at.
_FEW_ARRAYS = 64

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
    share = _SHARE_OF_ENCODING if is_error_guided(geo.pyramid) else _SHARE_OF_LISTING
    metadata, arrays = pyramid_to_parts(geo, part_of(progress, 0.0, share))
    texts = {name: _json(value) for name, value in metadata.items()}
    total = sum(array.nbytes for array in arrays.values())
    is_small = is_alone and total <= _SMALL_BYTES
    create_geopackage(path, SMALL_PAGE_BYTES if is_small else PAGE_BYTES)
    with open_for_writing(path) as connection, _pool() as pool:
        connection.executescript(compact_schema(SCHEMA))
        if not is_small or len(arrays) > _FEW_ARRAYS:
            connection.execute(INDEX)
        for table, description in TABLES.items():
            register_attributes_table(connection, table, description)
        write_level_rows(connection, geo)
        work = sum(map(work_of, arrays.values()))
        of_arrays = part_of(progress, share, SHARE_OF_WRITING)
        write_arrays(connection, arrays, pool, _share_of(work, of_arrays))
        entries = read_entries(connection, with_checksums=True)
        checksums = checksums_of(texts, read_level_rows(connection), entries)
        texts["checksums"] = _json(checksums)
        connection.executemany(
            "INSERT INTO wavelet_metadata (name, value) VALUES (?, ?)", texts.items()
        )
    # SQLite's own check sees the pages; that nothing is missing, the reader itself.
    read_back(path, check_database)
    read_back(path, partial(_read_back, geo=geo, arrays=arrays, total=total, progress=progress))


def read_pyramid(path: str | os.PathLike[str], progress: Progress | None = None) -> GeoPyramid:
    """Return the pyramid in a pyramid file, everything in it checked.

    Parameters
    ----------
    path : path
        A GeoPackage of any origin.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    InputFileError
        When the file is missing, held by another program, no GeoPackage, or holds no pyramid.
    PyramidError
        When its parts are damaged, are not those that were written, or do not fit together.
    """
    with _opened(path) as (contents, arrays):
        return pyramid_from_parts(contents, arrays, progress=progress)


def read_input(path: str | os.PathLike[str], progress: Progress | None = None) -> GeoPyramid:
    """Return what the input comes back from, without the levels where the file allows it.

    Parameters
    ----------
    path : path
        A GeoPackage of any origin.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

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
    with _opened(path) as (contents, arrays):
        return input_from_parts(contents, arrays, progress)


def read_levels(
    path: str | os.PathLike[str], level: int, progress: Progress | None = None
) -> GeoPyramid:
    """Return a pyramid of all levels up to one, or of more, from as little of its file as may be.

    Parameters
    ----------
    path : path
        A GeoPackage of any origin.
    level : int
        The finest that is wanted.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

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
    with _opened(path) as (contents, arrays):
        return levels_from_parts(contents, arrays, level, progress)


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
        contents = Contents(connection)
        check_source(contents.metadata.fields("source"))
        summary = dict(contents.metadata)
        summary["levels"] = [errors._asdict() for errors in contents.levels]
        return summary


def _json(value: object) -> str:
    return json.dumps(value, allow_nan=False, sort_keys=True, separators=(",", ":"))


def _share_of(total: int, progress: Progress | None) -> Callable[[int], None]:
    """Return a function that takes numbers of bytes and reports the share of all that are done."""
    done = 0

    def add(n_bytes: int) -> None:
        nonlocal done
        done += n_bytes
        report(progress, min(done / max(total, 1), 1.0), _CANCELLED)

    return add


def _read_back(
    path: str | os.PathLike[str],
    geo: GeoPyramid,
    arrays: Mapping[str, NDArray[Any]],
    total: int,
    progress: Progress | None,
) -> None:
    """Have the reader take a file that was just written, without room for its arrays."""
    # Arrays are read between levels where these are built again; both count half then.
    shares = {"bytes": 0.0, "levels": 0.0}

    def count(kind: str, share: float) -> None:
        shares[kind] = share
        done = sum(shares.values()) / 2
        report(progress, SHARE_OF_WRITING + (1.0 - SHARE_OF_WRITING) * done, _CANCELLED)

    verified = _share_of(total, lambda share: count("bytes", share))
    try:
        with open_untrusted(path) as connection, _pool() as pool:
            contents = Contents(connection)
            size = os.path.getsize(path)
            read = pyramid_from_parts(
                contents,
                WrittenArrays(connection, pool, contents.entries, size, arrays, verified),
                geo.pyramid,
                lambda share: count("levels", share),
            )
        if geo.origin.grid is not None and not _has_same_parts(read.origin, geo.origin):
            raise PyramidError("the numbers of the raster come back as others.")
        report(progress, 1.0, _CANCELLED)
    except Cancelled:
        raise
    except WaveletError as error:
        raise OutputFileError(
            f"the reader of pyramid files does not take it: {str(error).rstrip('.')}"
        ) from error


def _has_same_parts(origin: Origin, other: Origin) -> bool:
    (fields, arrays), (others, other_arrays) = origin.to_parts(), other.to_parts()
    return (
        fields == others
        and arrays.keys() == other_arrays.keys()
        and all(arrays[name].tobytes() == other_arrays[name].tobytes() for name in arrays)
    )


@contextmanager
def _opened(path: str | os.PathLike[str]) -> Iterator[tuple[Contents, StoredArrays]]:
    """Yield what a file says in words, verified, and its arrays, not read yet."""
    with open_untrusted(path) as connection, _pool() as pool, _naming(path):
        contents = Contents(connection)
        yield contents, StoredArrays(connection, pool, contents.entries, os.path.getsize(path))


@contextmanager
def _naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Name the file in whatever is said of its contents."""
    try:
        yield
    except InputFileError as error:
        raise InputFileError(f"{path}: {error}") from error
    except Cancelled:
        raise
    except WaveletError as error:
        raise PyramidError(f"{path}: {error}") from error
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise PyramidError(
            f"{path}: the description of the pyramid is damaged ({error!r}); analyse the "
            "input anew."
        ) from error


@contextmanager
def _pool() -> Iterator[ThreadPoolExecutor]:
    """Threads for zlib, which lets go of the interpreter; more than a few gain nothing."""
    with ThreadPoolExecutor(max_workers=min(os.cpu_count() or 1, 4)) as pool:
        yield pool
