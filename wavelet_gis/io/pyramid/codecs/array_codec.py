"""Arrays of plain numbers as compressed chunks, read back with every claim checked.

A chunk holds a block of rows, made small by one of the `FILTERS`: the differences of each row from
the one before, once or twice; the bytes shuffled so that the first bytes of all numbers come first;
then zlib or LZMA. Nothing but numbers can be stored.
"""

from __future__ import annotations

import hashlib
import lzma
import math
import threading
import zlib
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import PyramidError

__all__ = [
    "ArrayHeader",
    "Tally",
    "array_checksum",
    "closest_header",
    "decode_array",
    "decode_blocks",
    "encode_array",
    "header_of",
    "in_order",
    "unzigzag",
    "work_of",
    "zigzag",
]

#: Uncompressed bytes in a chunk, at most. Small enough to be undone in memory twice over.
CHUNK_BYTES = 4 << 20

#: Chunks beyond this are refused: a file must not choose how much memory its reader takes.
#: Several are undone at once, and each takes its size four times over.
MAX_CHUNK_BYTES = 2 * CHUNK_BYTES

#: zlib level: on pyramids of real DEMs 6 took 1.1 to 5 times the time for 0.4 to 10 % fewer bytes.
COMPRESSION_LEVEL = 1

#: zlib cannot expand by more than this (1032:1, from its format), and what LZMA makes smaller is
#: written with zlib, so larger claims are false.
MAX_EXPANSION = 1040

#: LZMA as it is read: without its contexts of positions and of the byte before, since residuals are
#: stored, whose order already is that of their size.
LZMA_FILTERS = [{"id": lzma.FILTER_LZMA2, "dict_size": 1 << 20, "lc": 0, "lp": 0, "pb": 0}]

#: As it is written. Residuals repeat nothing that is far away: on the arrays of a LAZ and of three
#: DEMs this takes 0.6 of the time of a dictionary of 1 MiB with four trials, and a quarter of that
#: of preset 6, for 0.2 and 0.1 % fewer bytes (`benchmarks/cost/lzma_options.py`).
WRITTEN_LZMA_FILTERS = [
    {
        **LZMA_FILTERS[0], "dict_size": 1 << 16,
        "mode": lzma.MODE_NORMAL, "nice_len": 32, "mf": lzma.MF_HC3, "depth": 1,
    }
]  # fmt: skip

#: LZMA takes six times as long as zlib, so it must save this part of its bytes.
LEAST_SAVING = 1 / 32

#: LZMA takes so many bytes at a time, so that it can be stopped; it makes the same of them.
_PIECE_BYTES = 1 << 17

#: Seconds after which a thread that waits for others reports what they have done.
_LOOK = 0.1

#: Rows by which the filter of an array is chosen, in so many stretches, evenly apart. The 65,536
#: rows in the middle take two and a half times as long, for files of 19 pyramids that were 0.2 %
#: smaller on average, 0.9 % at most.
_SAMPLE_ROWS, _STRETCHES = 1 << 14, 4

_DTYPES = {
    np.dtype(code).str: np.dtype(code)
    for code in ("|u1", "|i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f4", "<f8")
}

#: Numbers in an array, at most.
_MOST_NUMBERS = 1 << 40


class Filter(NamedTuple):
    """What is done to a block before it is compressed, and by what it is.

    n_differences : int, how often each row is replaced by its difference from the one before
    is_zigzag : bool, whether negative numbers become odd ones, and floats are first taken for
        integers of the same order
    is_lzma : bool, else zlib
    """

    n_differences: int
    is_zigzag: bool
    is_lzma: bool


#: By the name in the file. All of them shuffle the bytes.
FILTERS = {
    "shuffle": Filter(0, is_zigzag=False, is_lzma=False),
    "delta_shuffle": Filter(1, is_zigzag=False, is_lzma=False),
    "lzma": Filter(0, is_zigzag=False, is_lzma=True),
    "zigzag_lzma": Filter(0, is_zigzag=True, is_lzma=True),
    "delta_lzma": Filter(1, is_zigzag=True, is_lzma=True),
    "delta2_lzma": Filter(2, is_zigzag=True, is_lzma=True),
}


#: Takes a number of bytes.
Packed = Callable[[int], None]


class Tally:
    """The bytes that several threads have compressed, reported by the one that waits for them.

    Parameters
    ----------
    packed : callable, optional
        Called with those since it was called before; where it is another tally, it counts them, and
        what stops it stops this one.
    """

    def __init__(self, packed: Packed | None = None) -> None:
        self._packed = packed
        self._n_bytes = 0
        self._lock = threading.Lock()
        self._is_stopped = False

    @property
    def is_stopped(self) -> bool:
        """Whether what is still compressed is wanted by nobody."""
        whole = self._packed
        return self._is_stopped or (isinstance(whole, Tally) and whole.is_stopped)

    def stop(self) -> None:
        """Let those who compress know that they may end."""
        self._is_stopped = True

    def __call__(self, n_bytes: int) -> None:
        """Count bytes."""
        with self._lock:
            self._n_bytes += n_bytes

    def report(self) -> None:
        """Say how many there are since it was asked before."""
        with self._lock:
            n_bytes, self._n_bytes = self._n_bytes, 0
        if self._packed is not None:
            self._packed(n_bytes)


@dataclass(frozen=True, slots=True)
class ArrayHeader:
    """What a reader must know of an array before its first chunk.

    Attributes
    ----------
    dtype : str
        Little-endian numpy code, such as ``<f8``.
    shape : tuple of int
        One or two dimensions.
    filter : str
        A name out of `FILTERS`.
    chunk_rows : int
        Rows in every chunk but the last.
    """

    dtype: str
    shape: tuple[int, ...]
    filter: str
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
            and isinstance(filter_name, str)
            and filter_name in FILTERS
            and type(chunk_rows) is int
            and 1 <= chunk_rows <= _MOST_NUMBERS
        )
        if not is_sound:
            claim = " ".join(repr(value)[:40] for value in (dtype, shape, filter_name, chunk_rows))
            raise PyramidError(
                f"an array is declared as {claim}, which no pyramid file holds; "
                "the file is damaged."
            )
        header = cls(str(dtype), sizes, str(filter_name), int(str(chunk_rows)))
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
    filter_name = "delta_shuffle" if dtype.kind in "iu" else "shuffle"
    return ArrayHeader(dtype.str, tuple(array.shape), filter_name, rows)


def closest_header(
    array: NDArray[Any], pool: ThreadPoolExecutor | None = None, packed: Packed | None = None
) -> ArrayHeader:
    """Return the header under which an array takes few bytes for the time, judged by part of it.

    Parameters
    ----------
    array : integers, floats or booleans, one or two dimensions
    pool, packed : optional
        As for `encode_array`.
    """
    header = header_of(array)
    sample = _sample(array)
    if not sample.nbytes:
        return header
    tally = Tally(packed)

    def size(name: str) -> int:
        return len(_pack(sample, replace(header, filter=name), tally))

    sizes = dict(zip(FILTERS, in_order(size, FILTERS, pool, tally), strict=True))

    def judged(name: str) -> tuple[float, str]:
        return sizes[name] * (1.0 + LEAST_SAVING * FILTERS[name].is_lzma), name

    return replace(header, filter=min(sizes, key=judged))


def work_of(array: NDArray[Any]) -> int:
    """Return the bytes that are compressed for an array, by `closest_header` and then as it is."""
    return array.nbytes + len(FILTERS) * _sample(array).nbytes


def _sample(array: NDArray[Any]) -> NDArray[Any]:
    if len(array) <= _SAMPLE_ROWS:
        return array
    rows = _SAMPLE_ROWS // _STRETCHES
    starts = (len(array) - rows) * np.arange(_STRETCHES) // (_STRETCHES - 1)
    return np.concatenate([array[start : start + rows] for start in starts])


def encode_array(
    array: NDArray[Any],
    pool: ThreadPoolExecutor | None = None,
    header: ArrayHeader | None = None,
    packed: Packed | None = None,
) -> Iterator[bytes]:
    """Yield the compressed chunks of an array, in order.

    Parameters
    ----------
    array : integers, floats or booleans, one or two dimensions
        What to store. Booleans become bytes.
    pool : ThreadPoolExecutor, optional
        Compresses several chunks at once; the result is the same.
    header : ArrayHeader, optional
        Under which; by default that of `header_of`.
    packed : callable, optional
        Called, in the thread that takes the chunks, with the bytes that were compressed since it
        was called before. It may raise, to stop.
    """
    header = header_of(array) if header is None else header
    starts = range(0, header.shape[0], header.chunk_rows) if header.n_bytes else range(0)
    blocks = (array[start : start + header.chunk_rows] for start in starts)
    tally = Tally(packed)
    return in_order(lambda block: _pack(block, header, tally), blocks, pool, tally)


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
    for block in in_order(lambda job: _unpack(job, header), enumerate(chunks), pool, Tally()):
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


def in_order(
    work: Callable[[Any], Any],
    jobs: Iterable[Any],
    pool: ThreadPoolExecutor | None,
    tally: Tally,
) -> Iterator[Any]:
    """Yield the results in the order of the jobs, at most a few jobs ahead of the reader.

    Parameters
    ----------
    work : callable
        Takes a job. In a thread of the pool it may look at ``tally.is_stopped``.
    jobs : iterable
        Taken in the thread of the reader.
    pool : ThreadPoolExecutor, optional
        Works on several at once.
    tally : Tally
        Reported to while the reader waits, and stopped when it has enough.
    """
    if pool is None:
        for job in jobs:
            result = work(job)
            tally.report()
            yield result
        return
    remaining = iter(jobs)
    waiting: list[Future[Any]] = [pool.submit(work, job) for job in islice(remaining, 4)]
    try:
        while waiting:
            while not waiting[0].done():
                wait(waiting[:1], timeout=_LOOK)
                tally.report()
            yield waiting.pop(0).result()
            waiting.extend(pool.submit(work, job) for job in islice(remaining, 1))
        tally.report()
    finally:  # who stops before the end need not wait for the others
        tally.stop()
        for job in waiting:
            job.cancel()


def _pack(block: NDArray[Any], header: ArrayHeader, tally: Tally) -> bytes:
    dtype, steps = np.dtype(header.dtype), FILTERS[header.filter]
    bits = np.ascontiguousarray(block, dtype=dtype).view(f"<u{dtype.itemsize}")
    if steps.is_zigzag:
        bits = _in_order_of_value(bits, dtype)
    for _ in range(steps.n_differences):
        differences = bits.copy()
        differences[1:] -= bits[:-1]  # wraps round, and so does the sum that undoes it
        bits = differences
    if steps.is_zigzag:
        bits = zigzag(bits)
    shuffled = bits.reshape(-1).view(np.uint8).reshape(-1, dtype.itemsize).T
    raw = np.ascontiguousarray(shuffled).reshape(-1).data
    if steps.is_lzma:
        return _lzma(raw, tally)
    packed = zlib.compress(raw, COMPRESSION_LEVEL)
    tally(raw.nbytes)
    return packed


def _lzma(raw: memoryview, tally: Tally) -> bytes:
    """Compress in pieces; nothing comes of it where it is stopped."""
    packer = lzma.LZMACompressor(lzma.FORMAT_RAW, filters=WRITTEN_LZMA_FILTERS)
    packed = []
    for start in range(0, raw.nbytes, _PIECE_BYTES):
        if tally.is_stopped:
            return b""
        piece = raw[start : start + _PIECE_BYTES]
        packed.append(packer.compress(piece))
        tally(piece.nbytes)
    packed.append(packer.flush())
    return b"".join(packed)


def _unpack(job: tuple[int, bytes], header: ArrayHeader) -> NDArray[Any]:
    index, chunk = job
    dtype, steps = np.dtype(header.dtype), FILTERS[header.filter]
    n_rows = min(header.chunk_rows, header.shape[0] - index * header.chunk_rows)
    shape = (n_rows, *header.shape[1:])
    if n_rows <= 0:
        raise PyramidError("an array has more chunks than are due; the file is damaged.")
    raw = _expand(chunk, math.prod(shape) * dtype.itemsize, is_lzma=steps.is_lzma)
    plain = np.ascontiguousarray(np.frombuffer(raw, np.uint8).reshape(dtype.itemsize, -1).T)
    bits = plain.reshape(-1).view(f"<u{dtype.itemsize}").reshape(shape)
    if steps.is_zigzag:
        bits = unzigzag(bits)
    for _ in range(steps.n_differences):
        bits = np.cumsum(bits, axis=0, dtype=bits.dtype)
    if steps.is_zigzag:
        bits = _in_order_of_value(bits, dtype)
    return bits.view(dtype)


def _in_order_of_value(bits: NDArray[Any], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Return floats as integers of the same order, and those as floats again; integers as is."""
    if dtype.kind != "f":
        return bits
    signed = bits.view(f"<i{dtype.itemsize}")
    low = np.iinfo(signed.dtype).max
    return (signed ^ ((signed >> (8 * dtype.itemsize - 1)) & low)).view(bits.dtype)


def zigzag(bits: NDArray[Any]) -> NDArray[Any]:
    """Return the bits of 0, -1, 1, -2, ..., unsigned, as 0, 1, 2, 3, ..."""
    signed = bits.view(f"<i{bits.dtype.itemsize}")
    return ((signed << 1) ^ (signed >> (8 * bits.dtype.itemsize - 1))).view(bits.dtype)


def unzigzag(bits: NDArray[Any]) -> NDArray[Any]:
    """Return 0, 1, 2, 3, ... as the bits of 0, -1, 1, -2, ..."""
    one = bits.dtype.type(1)
    return (bits >> one) ^ (~(bits & one) + one)


def _expand(chunk: bytes, n_bytes: int, *, is_lzma: bool) -> bytes:
    """Expand a chunk to exactly the bytes that are due, never to more."""
    try:
        raw, is_all = _expand_lzma(chunk, n_bytes) if is_lzma else _expand_zlib(chunk, n_bytes)
    except (zlib.error, lzma.LZMAError) as error:
        raise PyramidError(f"a chunk cannot be expanded ({error}); the file is damaged.") from error
    if len(raw) != n_bytes or not is_all:
        raise PyramidError(
            f"a chunk does not expand to the {n_bytes} bytes that are due; the file is damaged."
        )
    return raw


def _expand_zlib(chunk: bytes, n_bytes: int) -> tuple[bytes, bool]:
    expander = zlib.decompressobj()
    raw = expander.decompress(chunk, n_bytes)
    # The end marker may still be due; one more byte than due would be a bomb's first.
    surplus = b"" if expander.eof else expander.decompress(expander.unconsumed_tail, 1)
    return raw, not surplus and expander.eof and not expander.unused_data


def _expand_lzma(chunk: bytes, n_bytes: int) -> tuple[bytes, bool]:
    expander = lzma.LZMADecompressor(lzma.FORMAT_RAW, filters=LZMA_FILTERS)
    raw = b""
    while len(raw) <= n_bytes and not expander.eof:
        more = expander.decompress(b"" if raw else chunk, n_bytes - len(raw) + 1)
        raw += more
        if not more and expander.needs_input:
            break
    return raw, expander.eof and not expander.unused_data
