"""What was written is read again before it may take the place of anything.

A full disk does not always raise: GDAL fails when it closes a file, after rasterio has stopped
listening. Every writer therefore says, with `read_back`, how its file is checked, and
`wavelet_gis.io.atomic.new_file` takes no file that nobody can check.
"""

from __future__ import annotations

import os
import shutil
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import IO, Any

from wavelet_core.errors import Cancelled
from wavelet_gis.errors import OutputFileError

__all__ = [
    "Check",
    "checks_of",
    "read_back",
    "recorded_stream",
    "require_sound_file",
    "room_at",
    "write_bytes",
    "write_text",
]

#: Reads the file again; raises when it is not what was to be written.
Check = Callable[[str | os.PathLike[str]], None]

_BYTES_AT_ONCE = 1 << 22

#: Checks of the scratch files that are being written, by their paths.
_pending: dict[str, list[Check]] = {}


@contextmanager
def checks_of(path: str | os.PathLike[str]) -> Iterator[list[Check]]:
    """Yield the list that gathers the checks of a scratch file while the block runs."""
    key = os.fspath(path)
    _pending[key] = []
    try:
        yield _pending[key]
    finally:
        del _pending[key]


def read_back(path: str | os.PathLike[str], check: Check) -> None:
    """Have a written and closed file checked: before it is moved to its place, or else at once.

    Parameters
    ----------
    path : path
        The file, from `wavelet_gis.io.atomic.new_file` or any other.
    check : callable
        Takes the path and raises, with the reason, when the file is not as it should be.
    """
    waiting = _pending.get(os.fspath(path))
    if waiting is None:
        require_sound_file(path, check)
    elif check not in waiting:  # a database may have had several writers
        waiting.append(check)


def require_sound_file(
    path: str | os.PathLike[str], check: Check, target: str | os.PathLike[str] | None = None
) -> None:
    """Check a file that was written.

    Parameters
    ----------
    path : path
        The file.
    check : callable
        See `read_back`.
    target : path, optional
        The file that it is to become, for the message.

    Raises
    ------
    OutputFileError
        With what is wrong, and how much room there is.
    """
    try:
        check(path)
    except (MemoryError, Cancelled):
        raise
    except Exception as error:
        name = target or path
        raise OutputFileError(
            f"{name}: what was written does not read back as it should ({error}), so it was "
            f"discarded; {room_at(os.path.dirname(os.path.abspath(name)))}."
        ) from error


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file in UTF-8, to be read back."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write a file, to be read back."""
    with recorded_stream(path) as stream:
        stream.write(content)


@contextmanager
def recorded_stream(path: str | os.PathLike[str]) -> Iterator[IO[Any]]:
    """Yield a stream into a new file, for bytes and text in UTF-8, that is to be read back.

    For writers that go from the first byte to the last.
    """
    with open(path, "wb") as raw:
        recorded = _Recorded(raw)
        yield recorded  # type: ignore[misc]
    read_back(path, recorded.check)


class _Recorded:
    """A stream that remembers the size and the checksum of what went through it."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self._size = 0
        self._checksum = 0

    def write(self, content: Any) -> int:
        data = content.encode("utf-8") if isinstance(content, str) else bytes(content)
        self._size += len(data)
        self._checksum = zlib.crc32(data, self._checksum)
        return self._stream.write(data)

    def writelines(self, lines: Any) -> None:
        for line in lines:
            self.write(line)

    def check(self, path: str | os.PathLike[str]) -> None:
        size = checksum = 0
        with open(path, "rb") as stream:
            while block := stream.read(_BYTES_AT_ONCE):
                size += len(block)
                checksum = zlib.crc32(block, checksum)
        if size != self._size:
            raise OutputFileError(f"{size} bytes are there of {self._size}")
        if checksum != self._checksum:
            raise OutputFileError("its bytes differ from those written")


def room_at(folder: str | os.PathLike[str]) -> str:
    """Return a sentence on the room that is left in a folder."""
    try:
        free = shutil.disk_usage(folder).free
    except OSError:
        return "check the disk"
    text = f"{free / 1e6:,.1f} MB are free there"
    try:
        import resource
    except ImportError:  # not POSIX, where there is no such limit
        return text
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    if limit != resource.RLIM_INFINITY:
        text += f" and files are limited to {limit / 1e6:,.3f} MB (ulimit -f)"
    return text
