"""The points of a LAZ file decoded where an abort can be survived: in a child process.

The decoder (lazrs, written in Rust) trusts what a file says: a mutated one can make it allocate
34 GB and abort the whole process, or panic through every ``except Exception``. So `decoded` runs
this file as a script, with a limit on memory and time, and reads the records from its output. The
child imports nothing but the decoder; starting it takes some 0.05 s.

Only where no Python can be started (QGIS on some systems is its own interpreter) the decoder runs
in this process, after the same checks of the table of chunks.
"""

from __future__ import annotations

import os
import signal
import struct
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

__all__ = ["DecodeError", "Job", "decode", "decoded", "decoded_in_batches", "interpreter"]

#: Points decoded at a time.
BATCH = 50_000

#: From so many points on the chunks are decoded in threads.
THREADED = 2_000_000
MAX_THREADS = 8

#: Address space of the child, in bytes: what a batch needs a hundred times over.
MEMORY, MEMORY_THREADED = 1 << 30, 4 << 30

#: Seconds of the processor that a child has, and points a second that the slowest one decodes.
PATIENCE, POINTS_A_SECOND = 8, 50_000

#: The clock on the wall may show this many times more: the machine may be busy.
BUSY = 8.0

#: The signal that ends a process whose time is up; Windows has none.
_SIGXCPU = int(getattr(signal, "SIGXCPU", 0))

#: Kinds of compression.
POINTWISE, LAYERED = 1, 3


class DecodeError(Exception):
    """The compressed points cannot be decoded; the text says why, in a few words."""


class Job(NamedTuple):
    """What is decoded.

    path : str
        The LAZ file.
    start : int
        Offset of the compressed points.
    record : bytes
        The record on the compression.
    record_length, n_points : int
        Of the points.
    chunks : tuple of (start, n_bytes, n_points)
        Of a COPC file, the chunks that are wanted; by default all points are.
    """

    path: str
    start: int
    record: bytes
    record_length: int
    n_points: int
    chunks: tuple[tuple[int, int, int], ...] = ()


def decoded(job: Job, out: Any) -> None:
    """Fill `out` with the point records of a LAZ file.

    Parameters
    ----------
    job : Job
        The file and what its header says.
    out : writable buffer
        Of ``n_points * record_length`` bytes.

    Raises
    ------
    DecodeError
        When the decoder fails, dies, takes too much memory or too long.
    """
    python = interpreter()
    view = memoryview(out).cast("B")
    if python is None:
        filled = 0

        def put(piece: Any) -> None:
            nonlocal filled
            view[filled : filled + len(piece)] = piece
            filled += len(piece)

        decode(job, put)
        return
    _in_a_child(python, job, [view])


def decoded_in_batches(job: Job, n_points: int, take: Callable[[memoryview], object]) -> None:
    """Hand the point records of a LAZ file on, so many at a time at most.

    Parameters
    ----------
    job : Job
        The file and what its header says.
    n_points : int
        In a batch.
    take : callable
        Given whole records, in memory that the next batch is decoded into.

    Raises
    ------
    DecodeError
        As `decoded`; what was taken before is of no use then.
    """
    python = interpreter()
    if python is None:
        decode(job, take)
        return
    buffer = memoryview(bytearray(min(n_points, job.n_points) * job.record_length))

    def batches() -> Iterator[memoryview]:
        for start in range(0, job.n_points, n_points):
            batch = buffer[: min(n_points, job.n_points - start) * job.record_length]
            yield batch  # filled meanwhile
            take(batch)

    _in_a_child(python, job, batches())


def interpreter() -> str | None:
    """Return a Python that can run the decoder, None where there is none."""
    candidates = [sys.executable, getattr(sys, "_base_executable", None)]
    for folder in (sys.exec_prefix, sys.base_exec_prefix):
        candidates += [
            os.path.join(folder, "python.exe"),
            os.path.join(folder, "bin", f"python3.{sys.version_info.minor}"),
            os.path.join(folder, "bin", "python3"),
        ]
    for candidate in candidates:
        if not candidate or not Path(candidate).stem.lower().startswith("python"):
            continue
        if os.access(candidate, os.X_OK):
            return candidate
    return None


def decode(job: Job, put: Callable[[Any], object]) -> None:
    """Decode in this process and hand the records to `put`, a batch at a time.

    Raises
    ------
    DecodeError
        When the table of chunks cannot be right, or the decoder fails.
    """
    import lazrs

    if job.chunks:
        _decode_chunks(job, put, lazrs)
        return
    with open(job.path, "rb") as stream:
        check_chunks(job, stream, lazrs)
        stream.seek(job.start)
        is_threaded = job.n_points >= THREADED and job.record[0] != POINTWISE
        kind = lazrs.ParLasZipDecompressor if is_threaded else lazrs.LasZipDecompressor
        batch = BATCH * (20 if is_threaded else 1)
        try:
            decompressor = kind(stream, job.record)
            left = job.n_points
            buffer = bytearray(min(batch, left) * job.record_length)
            while left:
                n_points = min(batch, left)
                piece = memoryview(buffer)[: n_points * job.record_length]
                decompressor.decompress_many(piece)
                put(piece)
                left -= n_points
        except BaseException as error:  # a Rust panic is no Exception
            if isinstance(error, (KeyboardInterrupt, BrokenPipeError)):
                raise
            raise DecodeError(_words(error)) from None


def _decode_chunks(job: Job, put: Callable[[Any], object], lazrs: Any) -> None:
    """Decode the chunks that are wanted, each by itself."""
    with open(job.path, "rb") as stream:
        for start, n_bytes, n_points in job.chunks:
            if n_points * job.record_length > MEMORY // 4:
                raise DecodeError(f"a chunk is said to hold {n_points} points")
            if job.record[0] == LAYERED:
                _check_chunk(job, stream, start, n_bytes)
            stream.seek(start)
            content = _exactly(stream, n_bytes)
            piece = bytearray(n_points * job.record_length)
            try:
                lazrs.decompress_points_with_chunk_table(
                    content, job.record, piece, [(n_points, n_bytes)]
                )
            except BaseException as error:  # a Rust panic is no Exception
                if isinstance(error, KeyboardInterrupt):
                    raise
                raise DecodeError(_words(error)) from None
            put(piece)


def check_chunks(job: Job, stream: BinaryIO, lazrs: Any) -> None:
    """Raise DecodeError when the table of chunks or the chunks' layers cannot be right.

    The decoder makes room for as many chunks, and as large layers, as the file claims.
    """
    if job.record[0] == POINTWISE:
        return
    size = os.fstat(stream.fileno()).st_size
    table = _table_offset(job, stream, size)
    stream.seek(table)
    version, n_chunks = struct.unpack("<II", _exactly(stream, 8))
    (chunk_size,) = struct.unpack_from("<I", job.record, 12)
    n_bytes = table - job.start - 8
    if version != 0 or n_chunks * job.record_length > n_bytes or n_chunks == 0:
        raise DecodeError(f"its table of chunks claims {n_chunks} chunks in {n_bytes} bytes")
    stream.seek(table)
    try:
        chunks = lazrs.read_chunk_table_only(stream, lazrs.LazVlr(job.record))
    except BaseException as error:
        raise DecodeError(f"its table of chunks is damaged: {_words(error)}") from None
    if sum(length for _, length in chunks) > n_bytes:
        raise DecodeError("its chunks are said to be longer than the file")
    is_variable = chunk_size == 0xFFFFFFFF
    n_there = sum(n for n, _ in chunks) if is_variable else n_chunks * chunk_size
    n_least = n_there if is_variable else (n_chunks - 1) * chunk_size + 1
    if not n_least <= job.n_points <= n_there:
        raise DecodeError(
            f"the header announces {job.n_points} points, the compressed chunks hold "
            f"{n_there if is_variable else f'{n_least} to {n_there}'}"
        )
    if job.record[0] == LAYERED:
        _check_layers(job, stream, chunks)


def _table_offset(job: Job, stream: BinaryIO, size: int) -> int:
    stream.seek(job.start)
    (table,) = struct.unpack("<q", _exactly(stream, 8))
    if table == -1:  # written to a pipe: the offset is in the last bytes
        stream.seek(max(size - 8, 0))
        (table,) = struct.unpack("<q", _exactly(stream, 8))
    if not job.start + 8 <= table <= size - 8:
        raise DecodeError(
            f"its table of chunks is said to be at byte {table}, the file has {size}; it is cut "
            "or its header is wrong"
        )
    return int(table)


def _check_layers(job: Job, stream: BinaryIO, chunks: list[tuple[int, int]]) -> None:
    """Hold the sizes of each chunk's layers against the chunk's own, and the points they hold."""
    start, n_there = job.start + 8, 0
    for _, length in chunks:
        if length:
            n_there += _check_chunk(job, stream, start, length)
        start += length
    if n_there != job.n_points:
        raise DecodeError(
            f"the header announces {job.n_points} points, the compressed chunks hold {n_there}"
        )


def _check_chunk(job: Job, stream: BinaryIO, start: int, length: int) -> int:
    """Hold the sizes of a chunk's layers against its own; return how many points it says it has."""
    n_layers = _n_layers(job.record)
    head = job.record_length + 4 + 4 * n_layers
    if length < head:
        raise DecodeError("one of its chunks is shorter than its own head")
    stream.seek(start + job.record_length)
    n_here, *sizes = struct.unpack(f"<{n_layers + 1}I", _exactly(stream, 4 * n_layers + 4))
    if head + sum(sizes) > length:
        raise DecodeError("the layers of one of its chunks are longer than the chunk")
    return int(n_here)


def _n_layers(record: bytes) -> int:
    """Return the number of layers of a chunk: by item nine, one, one or two, one, one a byte."""
    (n_items,) = struct.unpack_from("<H", record, 32)
    items = [struct.unpack_from("<HH", record, 34 + 6 * k) for k in range(n_items)]
    layers = {10: 9, 11: 1, 12: 2, 13: 1}
    return sum(length if kind in (0, 14) else layers[kind] for kind, length in items)


def _exactly(stream: BinaryIO, n_bytes: int) -> bytes:
    content = stream.read(n_bytes)
    if len(content) < n_bytes:
        raise DecodeError("it ends early")
    return content


def _words(error: BaseException) -> str:
    """Return the first line of an error, or its kind."""
    lines = str(error).strip().splitlines()
    return lines[0].rstrip(".") if lines else type(error).__name__


def _in_a_child(python: str, job: Job, views: Iterable[memoryview]) -> None:
    """Fill one view after the other with the records."""
    spec = find_spec("lazrs")
    places = [] if spec is None else list(spec.submodule_search_locations or ())
    home = os.path.dirname(places[0]) if places else ""
    command = [
        python,
        "-I",
        "-X",
        "utf8",
        os.path.abspath(__file__),
        home,
        *(str(number) for number in (job.start, job.record_length, job.n_points)),
        job.record.hex(),
        os.path.abspath(job.path),
    ]
    wanted = b"".join(struct.pack("<3Q", *chunk) for chunk in job.chunks)
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "RUST_BACKTRACE": "0", "RAYON_NUM_THREADS": str(_n_threads())},
        creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
    ) as child:
        assert child.stdout is not None
        assert child.stderr is not None
        said: list[bytes] = []
        listener = threading.Thread(target=_listen, args=(child.stderr, said), daemon=True)
        clock = threading.Timer(BUSY * _seconds(job), child.kill)
        listener.start()
        clock.start()
        assert child.stdin is not None
        with suppress(OSError), child.stdin:  # a child that is gone says why
            child.stdin.write(wanted)
        try:
            is_whole = False
            for view in views:
                if not _is_filled(view, child.stdout):
                    break
            else:
                is_whole = child.wait() == 0
        finally:
            is_late = not clock.is_alive()
            clock.cancel()
            with suppress(OSError):
                child.kill()
            is_late |= child.wait() == -_SIGXCPU
        listener.join(timeout=1.0)
    if not is_whole:
        raise DecodeError(_what_happened(b"".join(said), is_late))


def _is_filled(view: memoryview, pipe: Any) -> bool:
    """Fill a view; return whether there was enough."""
    filled = 0
    while filled < len(view):
        n_read = pipe.readinto(view[filled:])
        if not n_read:
            return False
        filled += n_read
    return True


def _listen(pipe: BinaryIO, said: list[bytes]) -> None:
    """Take what the child says, the first of it only, so that it never waits for us."""
    while piece := pipe.read(4096):
        if len(said) < 4:
            said.append(piece)


def _what_happened(said: bytes, is_late: bool) -> str:
    if is_late:
        return "the decoder takes too long"
    text = said.decode("utf-8", errors="replace")
    for line in text.splitlines():
        if line.startswith(_MARK):
            return line.removeprefix(_MARK)
    return (
        "it makes the decoder ask for too much memory"
        if "alloc" in text
        else "the decoder gives up"
    )


#: Begins the line in which the child says what went wrong, before or after what Rust prints.
_MARK = "laz decoder: "


def _n_threads() -> int:
    return min(os.cpu_count() or 1, MAX_THREADS)


def _seconds(job: Job) -> float:
    return PATIENCE + job.n_points / POINTS_A_SECOND


def _limit(n_bytes: int, seconds: float) -> None:
    """Bound memory and time where the system can: a claim of 34 GB then ends at once."""
    try:
        import resource
    except ImportError:  # Windows
        return
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    if hard != resource.RLIM_INFINITY:
        n_bytes = min(n_bytes, hard)
    with suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_AS, (n_bytes, hard))
    hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
    # Of all threads together. One more for the hard limit: the soft one ends with a signal.
    n_seconds = int(seconds * _n_threads()) + 1
    if hard == resource.RLIM_INFINITY or hard > n_seconds:
        with suppress(OSError, ValueError):
            resource.setrlimit(resource.RLIMIT_CPU, (n_seconds, n_seconds + 1))
    with suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))


def _main(arguments: list[str]) -> int:
    """Decode to standard output: the child's side of `decoded`."""
    home, start, record_length, n_points, record, path = arguments
    chunks = tuple(struct.iter_unpack("<3Q", sys.stdin.buffer.read()))
    job = Job(path, int(start), bytes.fromhex(record), int(record_length), int(n_points), chunks)
    _limit(MEMORY_THREADED if job.n_points >= THREADED else MEMORY, _seconds(job))
    if home:
        sys.path.insert(0, home)
    out = sys.stdout.buffer
    try:
        decode(job, out.write)
        out.flush()
    except (DecodeError, MemoryError, OSError) as error:
        sys.stderr.write(f"\n{_MARK}{_words(error)}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1:]))
