"""Outputs that appear whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from wavelet_gis._program import SCRATCH_PREFIX
from wavelet_gis.errors import OutputFileError

__all__ = ["check_output", "new_file"]

_EXISTS = "{path}: this file exists; give another name, or {0} to replace it."


def check_output(
    path: str | os.PathLike[str],
    *,
    overwrite: bool = False,
    suffixes: tuple[str, ...] = (),
    inputs: tuple[str | os.PathLike[str], ...] = (),
) -> Path:
    """Return the output's path, once it is known that it may be written.

    Called before the long work, so that a refusal comes at once and not after an hour.

    Parameters
    ----------
    path : path
        Where the output is wanted.
    overwrite : bool
        Whether a file that exists there may be replaced.
    suffixes : tuple of str
        Suffixes that the output may have, lower case with the dot; empty for any.
    inputs : tuple of path
        Files that are being read, which the output must not replace.

    Raises
    ------
    OutputFileError
        If the path is a folder, exists without `overwrite`, has another suffix, is one of the
        inputs, or its folder is missing or cannot be written.
    """
    target = Path(path)
    if target.is_dir():
        raise OutputFileError(f"{target}: this is a folder; name a file in it.")
    if suffixes and target.suffix.lower() not in suffixes:
        raise OutputFileError(
            f"{target}: the name of the output must end in {' or '.join(suffixes)}; "
            "its suffix chooses the format."
        )
    for source in inputs:
        if target.exists() and os.path.exists(source) and os.path.samefile(target, source):
            raise OutputFileError(
                f"{target}: the output is the input itself; give it another name."
            )
    if target.exists() and not overwrite:
        raise OutputFileError(_EXISTS, "overwrite", path=target)
    if not target.parent.is_dir():
        raise OutputFileError(f"{target.parent}: there is no such folder; create it first.")
    # Asking the file system is the only test that holds for root, for read-only mounts and
    # for access lists alike.
    with _scratch_folder(target):
        pass
    return target


@contextmanager
def new_file(path: str | os.PathLike[str], *, overwrite: bool = False) -> Iterator[Path]:
    """Yield a path to write to, in a scratch folder beside `path`; moved to `path` on success.

    Whatever else the writer leaves in the scratch folder (a ``.prj`` or ``.aux.xml`` beside
    the file) is moved along, the named file last. When the block raises, also for Ctrl-C,
    nothing is left and an existing file is untouched.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> folder = Path(tempfile.mkdtemp())
    >>> with new_file(folder / "a.txt") as scratch:
    ...     _ = scratch.write_text("whole")
    >>> [p.name for p in folder.iterdir()]
    ['a.txt']
    """
    target = check_output(path, overwrite=overwrite)
    with _scratch_folder(target) as folder:
        scratch = folder / target.name
        yield scratch
        if not scratch.is_file():
            raise OutputFileError(f"{target}: the writer produced no file; please report this.")
        companions = sorted(p for p in folder.iterdir() if p != scratch)
        for made in [*companions, scratch]:
            final = target.parent / made.name
            if final.exists() and not overwrite:
                raise OutputFileError(_EXISTS, "overwrite", path=final)
        for made in [*companions, scratch]:
            os.replace(made, target.parent / made.name)


@contextmanager
def _scratch_folder(target: Path) -> Iterator[Path]:
    try:
        folder = tempfile.mkdtemp(prefix=SCRATCH_PREFIX, dir=target.parent)
    except OSError as error:
        raise OutputFileError(
            f"{target.parent}: this folder cannot be written ({error.strerror}); "
            "choose another or change its permissions."
        ) from error
    try:
        yield Path(folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
