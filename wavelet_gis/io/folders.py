"""Folders of files that appear whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.scratch import scratch_folder, sweep

__all__ = ["check_folder", "new_folder"]


def check_folder(path: str | os.PathLike[str], marker: str, *, overwrite: bool = False) -> Path:
    """Return the path of a folder that is to be made, once it is known that it may be.

    Parameters
    ----------
    path : path
        Where the folder is wanted.
    marker : str
        A file in every such folder. Only folders with it are replaced.
    overwrite : bool
        Whether one that exists may be replaced.

    Raises
    ------
    OutputFileError
        Something is there that may not be replaced, or the folder around it is missing or cannot
        be written.
    """
    target = Path(path)
    if os.path.lexists(target):
        is_empty = target.is_dir() and not any(target.iterdir())
        if not is_empty and not (target.is_dir() and (target / marker).is_file()):
            raise OutputFileError(
                f"{target}: this exists and is no folder with a {marker}; give another name."
            )
        if not is_empty and not overwrite:
            raise OutputFileError(
                "{path}: this folder exists; give another name, or {0} to replace it.",
                "overwrite",
                path=target,
            )
    parent = target.absolute().parent
    if not parent.is_dir():
        raise OutputFileError(f"{parent}: there is no such folder; create it first.")
    with scratch_folder(target.absolute()):
        pass
    return target


@contextmanager
def new_folder(
    path: str | os.PathLike[str], marker: str, *, overwrite: bool = False
) -> Iterator[Path]:
    """Yield an empty folder beside `path`; moved to `path` when the block ends without an error.

    Parameters
    ----------
    path, marker, overwrite
        See `check_folder`.
    """
    target = check_folder(path, marker, overwrite=overwrite).absolute()
    sweep(target.parent)
    with scratch_folder(target) as scratch:
        folder = scratch / "out"
        folder.mkdir()
        yield folder
        if not (folder / marker).is_file():
            raise OutputFileError(f"{target}: no {marker} was written; please report this.")
        if target.is_dir():
            os.replace(target, scratch / "replaced")
        os.replace(folder, target)
