"""Arrays of plain numbers as compressed chunks, read back with every claim checked.

A chunk holds a block of rows: the difference of each row from the one before (integers only), the
bytes shuffled so that the first bytes of all numbers come first, then zlib. Differences and
shuffling make faces, indices and smooth weights small; nothing but numbers can be stored.
"""

from __future__ import annotations

import hashlib
import math
import zlib
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import islice
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import PyramidError

__all__ = [
    "ArrayHeader",
    "array_checksum",
    "decode_array",
    "decode_blocks",
    "encode_array",
    "header_of",
]

#: Uncompressed bytes in a chunk, at most. Small enough to be undone in memory twice over.
CHUNK_BYTES = 4 << 20

#: Chunks beyond this are refused: a file must not choose how much memory its reader takes.
#: Several are undone at once, and each takes its size four times over.
MAX_CHUNK_BYTES = 2 * CHUNK_BYTES

#: zlib level: on pyramids of real DEMs 6 took 1.1 to 5 times the time for 0.4 to 10 % fewer bytes.
COMPRESSION_LEVEL = 1

#: zlib cannot expand by more than this (1032:1, from its format), so larger claims are false.
MAX_EXPANSION = 1040

_DTYPES = {
    np.dtype(code).str: np.dtype(code)
    for code in ("|u1", "|i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f4", "<f8")
}

#: Numbers in an array, at most.
_MOST_NUMBERS = 1 << 40

Filter = Literal["shuffle", "delta_shuffle"]


@dataclass(frozen=True, slots=True)
class ArrayHeader:
    """What a reader must know of an array before its first chunk.

    Attributes
    ----------
    dtype : str
        Little-endian numpy code, such as ``<f8``.
    shape : tuple of int
        One or two dimensions.
    filter : {"shuffle", "delta_shuffle"}
        What was done before zlib.
    chunk_rows : int
        Rows in every chunk but the last.
    """

    dtype: str
    shape: tuple[int, ...]
    filter: Filter
    chunk_rows: int

    @property
    def n_bytes(self) -> int:
        """Uncompressed size."""
        return math.prod(self.shape) * np.dtype(self.dtype).itemsize

    @property
    def chunk_bytes(self) -> int:
        """Uncompressed size of the largest chunk."""
        row_bytes = math.prod(self.shape[1:]) * np.dtype(self.dtype).itemsize
        return min(self.chunk_rows, self.shape[0]) * row_bytes

    @property
    def n_chunks(self) -> int:
        """Number of chunks."""
        return -(-self.shape[0] // self.chunk_rows) if self.n_bytes else 0

    @property
    def longest_chunk(self) -> int:
        """Most bytes that a compressed chunk may have; zlib adds a little to what has no order."""
        return self.chunk_bytes + self.chunk_bytes // 1000 + 1024

    @classmethod
    def checked(
        cls, dtype: object, shape: object, filter_name: object, chunk_rows: object
    ) -> ArrayHeader:
        """Return a header from the values in a file of unknown origin.

        Raises
        ------
        PyramidError
            When one of them is nothing that this package writes.
        """
        sizes = tuple(shape) if isinstance(shape, list | tuple) else ()
        is_shape = len(sizes) in (1, 2) and all(
            type(n) is int and 0 <= n <= _MOST_NUMBERS for n in sizes
        )
        is_sound = (
            isinstance(dtype, str)
            and dtype in _DTYPES
            and is_shape
            and math.prod(sizes) < _MOST_NUMBERS
            and filter_name in ("shuffle", "delta_shuffle")
            and type(chunk_rows) is int
            and 1 <= chunk_rows <= _MOST_NUMBERS
        )
        if not is_sound:
            claim = " ".join(str(value)[:40] for value in (dtype, shape, filter_name, chunk_rows))
            raise PyramidError(
                f"an array is declared as {claim}, which no pyramid file holds; "
                "the file is damaged."
            )
        header = cls(str(dtype), sizes, cast(Filter, filter_name), cast(int, chunk_rows))
        if header.chunk_bytes > MAX_CHUNK_BYTES:
            raise PyramidError(
                f"an array declares chunks of {header.chunk_bytes} bytes, more than any pyramid "
                "file holds; the file is damaged."
            )
        return header


def header_of(array: NDArray[Any]) -> ArrayHeader:
    """Return the header under which `encode_array` stores an array."""
    dtype = np.dtype(np.uint8) if array.dtype == bool else array.dtype.newbyteorder("<")
    if dtype.str not in _DTYPES or array.ndim not in (1, 2):
        raise PyramidError(
            f"an array of {array.dtype} with {array.ndim} dimensions cannot be stored; "
            "use integers or floats of up to 8 bytes in one or two dimensions."
        )
    row_bytes = max(dtype.itemsize * math.prod(array.shape[1:]), 1)
    rows = max(CHUNK_BYTES // row_bytes, 1)
    filter_name: Filter = "delta_shuffle" if dtype.kind in "iu" else "shuffle"
    return ArrayHeader(dtype.str, tuple(array.shape), filter_name, rows)


def encode_array(array: NDArray[Any], pool: ThreadPoolExecutor | None = None) -> Iterator[bytes]:
    """Yield the compressed chunks of an array, in order.

    Parameters
    ----------
    array : integers, floats or booleans, one or two dimensions
        What to store. Booleans become bytes.
    pool : ThreadPoolExecutor, optional
        Compresses several chunks at once; the result is the same.
    """
    header = header_of(array)
    starts = range(0, header.shape[0], header.chunk_rows) if header.n_bytes else range(0)
    blocks = (array[start : start + header.chunk_rows] for start in starts)
    return _in_order(lambda block: _pack(block, header), blocks, pool)


def decode_array(
    header: ArrayHeader,
    chunks: Iterable[bytes],
    compressed_bytes: int,
    pool: ThreadPoolExecutor | None = None,
) -> NDArray[Any]:
    """Return the array, its chunks having been checked one by one.

    Parameters
    ----------
    header : ArrayHeader
        Checked before; see `ArrayHeader.checked`.
    chunks : iterable of bytes
        In order.
    compressed_bytes : int
        Their total, known before they are read, so that no memory is given on a false claim.
    pool : ThreadPoolExecutor, optional
        Expands several chunks at once.

    Raises
    ------
    PyramidError
        When the chunks are too few, too many, damaged, or expand to another size than declared.
    """
    if header.n_bytes > MAX_EXPANSION * compressed_bytes:
        raise PyramidError(
            f"an array claims {header.n_bytes} bytes out of {compressed_bytes} compressed ones, "
            "more than compression can hold; the file is damaged."
        )
    array = np.empty(header.shape, dtype=header.dtype)
    start = 0
    for block in decode_blocks(header, chunks, pool):
        array[start : start + len(block)] = block
        start += len(block)
    return array


def decode_blocks(
    header: ArrayHeader, chunks: Iterable[bytes], pool: ThreadPoolExecutor | None = None
) -> Iterator[NDArray[Any]]:
    """Yield an array's blocks of rows, in order; see `decode_array`.

    Parameters
    ----------
    header : ArrayHeader
        Checked before.
    chunks : iterable of bytes
        In order.
    pool : ThreadPoolExecutor, optional
        Expands several chunks at once.
    """
    n_chunks = 0
    for block in _in_order(lambda job: _unpack(job, header), enumerate(chunks), pool):
        yield block
        n_chunks += 1
    if n_chunks != header.n_chunks:
        raise PyramidError(
            f"an array has {n_chunks} chunks where {header.n_chunks} are due; the file is damaged."
        )


def array_checksum(header: ArrayHeader, blocks: Iterable[NDArray[Any]]) -> str:
    """Return the checksum of an array: of its data type, its shape and its numbers.

    Parameters
    ----------
    header : ArrayHeader
        What it is stored as.
    blocks : iterable of arrays
        Its rows, in one block or in several; the checksum is the same.

    Examples
    --------
    >>> array = np.arange(6, dtype=np.int32)
    >>> whole = array_checksum(header_of(array), [array])
    >>> whole == array_checksum(header_of(array), [array[:2], array[2:]])
    True
    """
    digest = hashlib.sha256()
    digest.update(f"{header.dtype} {header.shape} ".encode())
    for block in blocks:
        plain = np.ascontiguousarray(block, dtype=header.dtype)
        digest.update(plain.reshape(-1).view(np.uint8).data)
    return digest.hexdigest()


def _pack(block: NDArray[Any], header: ArrayHeader) -> bytes:
    dtype = np.dtype(header.dtype)
    block = np.ascontiguousarray(block, dtype=dtype)
    if header.filter == "delta_shuffle":
        bits = block.view(f"<u{dtype.itemsize}")
        block = bits.copy()
        block[1:] -= bits[:-1]  # wraps round, and so does the sum that undoes it
    shuffled = block.reshape(-1).view(np.uint8).reshape(-1, dtype.itemsize).T
    return zlib.compress(np.ascontiguousarray(shuffled).data, COMPRESSION_LEVEL)


def _unpack(job: tuple[int, bytes], header: ArrayHeader) -> NDArray[Any]:
    index, chunk = job
    dtype = np.dtype(header.dtype)
    n_rows = min(header.chunk_rows, header.shape[0] - index * header.chunk_rows)
    shape = (n_rows, *header.shape[1:])
    if n_rows <= 0:
        raise PyramidError("an array has more chunks than are due; the file is damaged.")
    raw = _expand(chunk, math.prod(shape) * dtype.itemsize)
    plain = np.ascontiguousarray(np.frombuffer(raw, np.uint8).reshape(dtype.itemsize, -1).T)
    if header.filter == "delta_shuffle":
        steps = plain.reshape(-1).view(f"<u{dtype.itemsize}").reshape(shape)
        return np.cumsum(steps, axis=0, dtype=steps.dtype).view(dtype)
    return plain.reshape(-1).view(dtype).reshape(shape)


def _expand(chunk: bytes, n_bytes: int) -> bytes:
    """Expand a chunk to exactly the bytes that are due, never to more."""
    expander = zlib.decompressobj()
    try:
        raw = expander.decompress(chunk, n_bytes)
        # The end marker may still be due; one more byte than due would be a bomb's first.
        surplus = b"" if expander.eof else expander.decompress(expander.unconsumed_tail, 1)
    except zlib.error as error:
        raise PyramidError(f"a chunk cannot be expanded ({error}); the file is damaged.") from error
    if len(raw) != n_bytes or surplus or not expander.eof or expander.unused_data:
        raise PyramidError(
            f"a chunk does not expand to the {n_bytes} bytes that are due; the file is damaged."
        )
    return raw


def _in_order(
    work: Callable[[Any], Any], jobs: Iterable[Any], pool: ThreadPoolExecutor | None
) -> Iterator[Any]:
    """Yield the results in the order of the jobs, at most a few jobs ahead of the reader."""
    if pool is None:
        yield from map(work, jobs)
        return
    remaining = iter(jobs)
    waiting = [pool.submit(work, job) for job in islice(remaining, 4)]
    while waiting:
        yield waiting.pop(0).result()
        waiting.extend(pool.submit(work, job) for job in islice(remaining, 1))
