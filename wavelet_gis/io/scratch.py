"""Folders that outputs are written in before they appear, and what killed runs left of them."""

from __future__ import annotations

import importlib
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from wavelet_gis._program import SCRATCH_PREFIX
from wavelet_gis.errors import OutputFileError, TerrainWarning
from wavelet_gis.notes import warn

#: None on Windows, which does not remove what is open.
_fcntl: Any = importlib.import_module("fcntl") if os.name == "posix" else None

__all__ = ["scratch_folder", "sweep", "sweep_own"]

#: Seconds after which a folder that nobody holds is taken for the remains of a killed run.
ABANDONED_AFTER = 86_400


@contextmanager
def scratch_folder(beside: Path) -> Iterator[Path]:
    """Yield a new folder beside a file, held while the block runs and removed after it.

    Raises
    ------
    OutputFileError
        When the folder of the file cannot be written.
    """
    try:
        folder = tempfile.mkdtemp(prefix=SCRATCH_PREFIX, dir=beside.parent)
    except OSError as error:
        raise OutputFileError(
            f"{beside.parent}: this folder cannot be written ({error.strerror}); "
            "choose another or change its permissions."
        ) from error
    held = _hold(folder)
    try:
        yield Path(folder)
    finally:
        try:
            shutil.rmtree(folder, ignore_errors=True)
        except BaseException:  # an interrupt half-way
            shutil.rmtree(folder, ignore_errors=True)
            raise
        finally:
            if held is not None:
                os.close(held)


def sweep(folder: Path) -> None:
    """Remove the scratch folders of runs that were killed: a day old, and held by nobody."""
    before = time.time() - ABANDONED_AFTER
    swept = 0
    try:
        remains = [Path(entry.path) for entry in os.scandir(folder) if _is_scratch(entry)]
    except OSError:
        return
    for path in remains:
        held = _hold(path)
        try:
            if (held is not None or _fcntl is None) and _last_change(path) < before:
                shutil.rmtree(path)
                swept += 1
        except OSError:
            continue  # somebody else's, or swept by another run meanwhile
        finally:
            if held is not None:
                os.close(held)
    if swept:
        warn(
            TerrainWarning,
            "scratch_files_removed",
            "{folder}: the scratch files of {runs} that had been killed were removed",
            stacklevel=3,
            folder=os.fspath(folder),
            runs=f"{swept} earlier run{'s' * (swept != 1)}",
        )


def sweep_own(folder: Path) -> None:
    """Remove the scratch folders that nobody holds, however new, of a folder that is all ours."""
    try:
        remains = [Path(entry.path) for entry in os.scandir(folder) if _is_scratch(entry)]
    except OSError:
        return
    for path in remains:
        held = _hold(path)
        if held is not None:
            shutil.rmtree(path, ignore_errors=True)
            os.close(held)


def _is_scratch(entry: os.DirEntry[str]) -> bool:
    return entry.name.startswith(SCRATCH_PREFIX) and entry.is_dir(follow_symlinks=False)


def _last_change(folder: Path) -> float:
    times = [path.lstat().st_mtime for path in (folder, *folder.rglob("*"))]
    return max(times)


def _hold(folder: str | os.PathLike[str]) -> int | None:
    """Return a lock on a folder, as a descriptor; None where another holds it or none is to be had.

    The lock goes with the process, however that ends.
    """
    if _fcntl is None:
        return None
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:
        return None
    try:
        if not stat.S_ISDIR(os.fstat(descriptor).st_mode):
            raise OSError
        _fcntl.flock(descriptor, _fcntl.LOCK_EX | _fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        return None
    return descriptor
