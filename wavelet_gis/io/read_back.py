"""What was written is read again before it may take the place of anything.

A full disk does not always raise: GDAL fails when it closes a file, after rasterio has stopped
listening. Every writer therefore says, with `read_back`, how its file is checked, and
`wavelet_gis.io.atomic` takes no file that nobody can check.
"""

from __future__ import annotations

import os
import shutil
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import IO, Any, NamedTuple

from wavelet_core.errors import Cancelled
from wavelet_gis.errors import OutputFileError

__all__ = [
    "Check",
    "checks_below",
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

#: The same of the files in scratch folders, by the paths of the folders.
_pending_below: dict[str, dict[str, list[Check]]] = {}


@contextmanager
def checks_of(path: str | os.PathLike[str]) -> Iterator[list[Check]]:
    """Yield the list that gathers the checks of a scratch file while the block runs."""
    key = os.fspath(path)
    _pending[key] = []
    try:
        yield _pending[key]
    finally:
        del _pending[key]


@contextmanager
def checks_below(folder: str | os.PathLike[str]) -> Iterator[dict[str, list[Check]]]:
    """Yield the table that gathers the checks of all files in a scratch folder, by their paths."""
    key = os.fspath(folder)
    _pending_below[key] = {}
    try:
        yield _pending_below[key]
    finally:
        del _pending_below[key]


def read_back(path: str | os.PathLike[str], check: Check) -> None:
    """Have a written and closed file checked: before it is moved to its place, or else at once.

    Parameters
    ----------
    path : path
        The file, from `wavelet_gis.io.atomic.new_file` or any other.
    check : callable
        Takes the path and raises, with the reason, when the file is not as it should be.
    """
    waiting = _waiting(os.fspath(path))
    if waiting is None:
        require_sound_file(path, check)
    elif check not in waiting:  # a database may have had several writers
        waiting.append(check)


def _waiting(path: str) -> list[Check] | None:
    """Return the list that a file's checks wait in, None where nothing waits."""
    if path in _pending:
        return _pending[path]
    for folder, checks in _pending_below.items():
        if path.startswith(folder + os.sep):
            return checks.setdefault(path, [])
    return None


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
    read_back(path, recorded.written.check)


class _Written(NamedTuple):
    """The size and the checksum of what was written."""

    size: int = 0
    checksum: int = 0

    def with_block(self, block: bytes) -> _Written:
        return _Written(self.size + len(block), zlib.crc32(block, self.checksum))

    def check(self, path: str | os.PathLike[str]) -> None:
        found = _Written()
        with open(path, "rb") as stream:
            while block := stream.read(_BYTES_AT_ONCE):
                found = found.with_block(block)
        if found.size != self.size:
            raise OutputFileError(f"{found.size} bytes are there of {self.size}")
        if found != self:
            raise OutputFileError("its bytes differ from those written")


class _Recorded:
    """A stream that remembers the size and the checksum of what went through it."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self.written = _Written()

    def write(self, content: Any) -> int:
        data = content.encode("utf-8") if isinstance(content, str) else bytes(content)
        self.written = self.written.with_block(data)
        return self._stream.write(data)

    def writelines(self, lines: Any) -> None:
        for line in lines:
            self.write(line)


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
