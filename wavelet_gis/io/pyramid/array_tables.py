"""Arrays in two tables of a SQLite file: what each is, and its chunks.

``wavelet_arrays`` (name, dtype, shape, filter, chunk_rows, checksum) has a row for each array, and
``wavelet_chunks`` (array_id, sequence, data) its contents; see
`wavelet_gis.io.pyramid.codecs.array_codec`. The first table is read and judged whole before the
second is touched, so that a reader's memory is bounded by the size of the file and not by what the
file claims.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import groupby
from typing import Any, NamedTuple

from numpy.typing import NDArray

from wavelet_core.errors import PyramidError
from wavelet_gis._fields import parse_json
from wavelet_gis.io.pyramid.codecs.array_codec import (
    FILTERS,
    MAX_EXPANSION,
    ArrayHeader,
    Tally,
    array_checksum,
    closest_header,
    decode_array,
    decode_blocks,
    encode_array,
    header_of,
    in_order,
)

__all__ = [
    "INDEX",
    "SCHEMA",
    "Entry",
    "StoredArrays",
    "WrittenArrays",
    "read_entries",
    "write_arrays",
]

SCHEMA = """
CREATE TABLE wavelet_chunks (
  id INTEGER PRIMARY KEY AUTOINCREMENT, array_id INTEGER NOT NULL, sequence INTEGER NOT NULL,
  data BLOB NOT NULL);
CREATE TABLE wavelet_arrays (
  id INTEGER PRIMARY KEY AUTOINCREMENT, name TEXT NOT NULL, dtype TEXT NOT NULL,
  shape TEXT NOT NULL, filter TEXT NOT NULL, chunk_rows INTEGER NOT NULL, checksum TEXT);
"""

#: For a file of many chunks, or of large ones; a few small ones are found without.
INDEX = "CREATE INDEX wavelet_chunks_of_array ON wavelet_chunks (array_id, sequence);"

#: More arrays than this are no pyramid of ours, which have six a level and some for the source.
MOST_ARRAYS = 20_000

#: An array of no more chunks is packed by one thread.
_CHUNKS_IN_A_THREAD = 2

#: Characters in the name of an array, or in its shape.
LONGEST_NAME = 200

#: All arrays together may expand to so many times the file, beyond the allowance. A plane, of all
#: terrains the one that shrinks most, has 10; long runs of nodata take the allowance.
MOST_EXPANSION = 64
ALLOWANCE_BYTES = 256 << 20


class Entry(NamedTuple):
    """A row of ``wavelet_arrays``: its id, what it says of the array, and the checksum.

    The checksum is None in files of before there were any.
    """

    array_id: int
    header: ArrayHeader
    checksum: str | None


def write_arrays(
    connection: sqlite3.Connection,
    arrays: Mapping[str, NDArray[Any]],
    pool: ThreadPoolExecutor,
    packed: Callable[[int], None],
) -> None:
    """Write arrays, each as small as it can be.

    Parameters
    ----------
    connection : sqlite3.Connection
        To a file that has the tables.
    arrays : mapping of str to array
        By name.
    pool : ThreadPoolExecutor
        Compresses.
    packed : callable
        Called with bytes that were compressed; those of an array are `work_of` it.
    """
    for name, header, chunks, checksum in _packed_arrays(arrays, pool, packed):
        cursor = connection.execute(
            "INSERT INTO wavelet_arrays (name, dtype, shape, filter, chunk_rows, checksum) "
            "VALUES (?,?,?,?,?,?)",
            (
                name,
                header.dtype,
                json.dumps(header.shape),
                header.filter,
                header.chunk_rows,
                checksum,
            ),
        )
        connection.executemany(
            "INSERT INTO wavelet_chunks (array_id, sequence, data) VALUES (?,?,?)",
            ((cursor.lastrowid, sequence, chunk) for sequence, chunk in enumerate(chunks)),
        )


class _PackedArray(NamedTuple):
    """What the two tables say of an array."""

    name: str
    header: ArrayHeader
    chunks: Iterable[bytes]
    checksum: str


def _packed_arrays(
    arrays: Mapping[str, NDArray[Any]], pool: ThreadPoolExecutor, packed: Callable[[int], None]
) -> Iterator[_PackedArray]:
    """Yield arrays packed, in order: those of many chunks chunk by chunk, others side by side."""
    for is_long, group in groupby(arrays.items(), lambda item: _is_long(item[1])):
        if is_long:
            for name, array in group:
                checksum = pool.submit(array_checksum, header_of(array), [array])
                header, chunks = _smallest(array, pool, packed)
                yield _PackedArray(name, header, chunks, checksum.result())
        else:
            tally = Tally(packed)
            yield from in_order(partial(_packed_whole, tally), group, pool, tally)


def _is_long(array: NDArray[Any]) -> bool:
    return header_of(array).n_chunks > _CHUNKS_IN_A_THREAD


def _packed_whole(tally: Tally, item: tuple[str, NDArray[Any]]) -> _PackedArray:
    """Pack an array in one thread, which stops where its work is no longer wanted."""
    name, array = item
    header, chunks = _smallest(array, None, tally)
    return _PackedArray(name, header, list(chunks), array_checksum(header, [array]))


def _smallest(
    array: NDArray[Any], pool: ThreadPoolExecutor | None, packed: Callable[[int], None]
) -> tuple[ArrayHeader, Iterable[bytes]]:
    """Return the header of an array and its chunks, never smaller than a reader believes."""
    header = closest_header(array, pool, packed)
    chunks = encode_array(array, pool, header, packed)
    if not FILTERS[header.filter].is_lzma:
        return header, chunks
    kept = list(chunks)
    if header.n_bytes <= MAX_EXPANSION * sum(map(len, kept)):
        return header, kept
    plain = header_of(array)
    # These bytes count already; counted again, the bar would be at its end too early.
    return plain, encode_array(array, pool, plain, lambda n_bytes: packed(0))


def read_entries(connection: sqlite3.Connection, *, with_checksums: bool) -> dict[str, Entry]:
    """Return what the file says of each array, by name, in the order of the table.

    Parameters
    ----------
    connection : sqlite3.Connection
        To a file of unknown origin.
    with_checksums : bool
        Whether the table has the column, which older files have not.

    Raises
    ------
    PyramidError
        When a row is none that this package writes, or there are too many.
    """
    checksum_column = "checksum" if with_checksums else "NULL"
    rows = connection.execute(
        # One of two constants; nothing of the file's is in the statement.
        f"SELECT id, name, dtype, shape, filter, chunk_rows, {checksum_column} "  # nosec B608
        "FROM wavelet_arrays ORDER BY id LIMIT ?",
        (MOST_ARRAYS + 1,),
    )
    entries: dict[str, Entry] = {}
    for array_id, name, dtype, shape, filter_name, chunk_rows, checksum in rows:
        is_named = isinstance(name, str) and len(name) <= LONGEST_NAME and name not in entries
        if type(array_id) is not int or not is_named:
            raise PyramidError(
                f"the array {str(name)[:40]} has no number, no name or another's name; "
                "the file is damaged."
            )
        if with_checksums and not isinstance(checksum, str):
            raise PyramidError(f"the array {name} has no checksum; the file is damaged.")
        if not isinstance(shape, str) or len(shape) > LONGEST_NAME:
            raise PyramidError(f"the array {name} has no shape; the file is damaged.")
        sizes = parse_json(shape, f"the shape of the array {name}")
        header = ArrayHeader.checked(dtype, sizes, filter_name, chunk_rows)
        entries[name] = Entry(array_id, header, checksum)
    if len(entries) > MOST_ARRAYS:
        raise PyramidError(
            f"the file names more than {MOST_ARRAYS} arrays, which no pyramid has; it is damaged."
        )
    if len({entry.array_id for entry in entries.values()}) != len(entries):
        raise PyramidError("two arrays have the same number; the file is damaged.")
    return entries


class StoredArrays:
    """The arrays of a file of unknown origin, each read when it is asked for.

    Parameters
    ----------
    connection : sqlite3.Connection
    pool : ThreadPoolExecutor
        Expands.
    entries : dict of str to Entry
        From `read_entries`.
    file_bytes : int
        Size of the file.

    Raises
    ------
    PyramidError
        When the arrays claim more than a file of that size can hold.
    """

    def __init__(
        self,
        connection: sqlite3.Connection,
        pool: ThreadPoolExecutor,
        entries: dict[str, Entry],
        file_bytes: int,
    ) -> None:
        self._connection = connection
        self._pool = pool
        self._entries = entries
        claimed = sum(entry.header.n_bytes for entry in entries.values())
        if claimed > ALLOWANCE_BYTES + MOST_EXPANSION * file_bytes:
            raise PyramidError(
                f"the arrays claim {claimed:,} bytes out of a file of {file_bytes:,}, more than "
                "those of any pyramid; the file is damaged."
            )
        self._sizes = {
            array_id: sizes
            for array_id, *sizes in connection.execute(
                # The limit has the lengths taken before the rows are sorted, where there is no
                # index. The data themselves would be sorted otherwise, at any length.
                "SELECT array_id, COUNT(*), SUM(n), MAX(n), SUM(is_other) FROM ("
                "SELECT array_id, LENGTH(data) AS n, TYPEOF(data) <> 'blob' AS is_other "
                "FROM wavelet_chunks LIMIT -1) GROUP BY array_id"
            )
        }
        stored = sum(n_bytes or 0 for _, n_bytes, _, _ in self._sizes.values())
        if stored > file_bytes:
            raise PyramidError(
                f"the chunks claim {stored:,} bytes in a file of {file_bytes:,}; "
                "the file is damaged."
            )

    def get(
        self, name: str, dtype: str | None = None, n_dimensions: int | None = None
    ) -> NDArray[Any]:
        """Return an array, of the data type and number of dimensions that it must have."""
        if name not in self._entries:
            raise PyramidError(f"the array {name} is missing; the file is damaged.")
        entry = self._entries[name]
        if dtype is not None and entry.header.dtype != dtype:
            raise PyramidError(
                f"the array {name} holds {entry.header.dtype} where {dtype} is due; "
                "the file is damaged."
            )
        if n_dimensions is not None and len(entry.header.shape) != n_dimensions:
            raise PyramidError(
                f"the array {name} has the shape {entry.header.shape} where {n_dimensions} "
                "dimensions are due; the file is damaged."
            )
        try:
            return self._read(name, entry)
        except PyramidError as error:
            raise PyramidError(f"array {name}: {error}") from error

    def all_named(self, prefix: str) -> dict[str, NDArray[Any]]:
        """Return all arrays whose names begin so."""
        return {name: self.get(name) for name in self._entries if name.startswith(prefix)}

    def _read(self, name: str, entry: Entry) -> NDArray[Any]:
        n_bytes = self._checked_size(entry)
        array = decode_array(entry.header, self._chunks(entry.array_id), n_bytes, self._pool)
        if entry.checksum is not None:
            self._compare(entry, array_checksum(entry.header, [array]))
        array.flags.writeable = False  # so that the pyramid can take it without a copy
        return array

    def _checked_size(self, entry: Entry) -> int:
        """Return the compressed size, once number and lengths of the chunks are those due."""
        n_chunks, n_bytes, longest, n_others = self._sizes.get(entry.array_id, (0, 0, 0, 0))
        if n_chunks != entry.header.n_chunks or n_others:
            raise PyramidError(
                f"{n_chunks} chunks, {n_others} of them no bytes, where {entry.header.n_chunks} "
                "are due; the file is damaged."
            )
        if longest > entry.header.longest_chunk:
            raise PyramidError(
                f"a chunk of {longest} bytes for {entry.header.chunk_bytes}; the file is damaged."
            )
        return int(n_bytes)

    def _compare(self, entry: Entry, checksum: str) -> None:
        if checksum != entry.checksum:
            raise PyramidError(
                "its checksum is wrong, so these are not the numbers that were written; restore "
                "the file from a copy, or analyse the input anew."
            )

    def _chunks(self, array_id: int) -> Iterator[bytes]:
        rows = self._connection.execute(
            "SELECT sequence, data FROM wavelet_chunks WHERE array_id = ? ORDER BY sequence",
            (array_id,),
        )
        for expected, (sequence, data) in enumerate(rows):
            if sequence != expected or not isinstance(data, bytes):
                raise PyramidError(f"chunk {expected} is missing or no bytes; the file is damaged.")
            yield data


class WrittenArrays(StoredArrays):
    """The arrays of a file just written, whose reader is given those in memory.

    Every chunk is read from the file, expanded and compared by its checksum; what is handed out
    are the arrays that were written, so that a file is verified without room for its contents.

    Parameters
    ----------
    connection, pool, entries, file_bytes
        As for `StoredArrays`.
    originals : mapping of str to array
        What was written.
    verified : callable
        Called with the bytes of each piece that is verified.
    """

    def __init__(
        self,
        connection: sqlite3.Connection,
        pool: ThreadPoolExecutor,
        entries: dict[str, Entry],
        file_bytes: int,
        originals: Mapping[str, NDArray[Any]],
        verified: Callable[[int], None],
    ) -> None:
        super().__init__(connection, pool, entries, file_bytes)
        self._originals = originals
        self._verified = verified

    def _read(self, name: str, entry: Entry) -> NDArray[Any]:
        self._checked_size(entry)
        blocks = decode_blocks(entry.header, self._chunks(entry.array_id), self._pool)
        self._compare(entry, array_checksum(entry.header, self._watched(blocks)))
        return self._originals[name].astype(entry.header.dtype, copy=False)

    def _watched(self, blocks: Iterable[NDArray[Any]]) -> Iterator[NDArray[Any]]:
        for block in blocks:
            yield block
            self._verified(block.nbytes)
