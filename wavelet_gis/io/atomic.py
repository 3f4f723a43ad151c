"""Outputs that appear whole, or not at all: files and folders, on the disk and read back."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from wavelet_core.errors import WaveletError
from wavelet_gis.errors import CrsWarning, OutputFileError
from wavelet_gis.io.companions import (
    is_ours,
    own_companions,
    refuse_companions,
    warn_of_foreign_files,
)
from wavelet_gis.io.names import MAX_DATABASE_NAME, file_of, is_utf8
from wavelet_gis.io.read_back import Check, checks_below, checks_of, require_sound_file
from wavelet_gis.io.scratch import scratch_folder, sweep
from wavelet_gis.notes import warn

__all__ = ["check_folder", "check_output", "ensure_folder", "new_file", "new_folder"]

#: What the file is called in the scratch folder: no library stumbles over it.
_SCRATCH_STEM = "out"

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
        If the path is a folder or a device, exists without `overwrite`, has another suffix, is
        one of the inputs, has companions in the way (see `wavelet_gis.io.companions`), is a name
        that the system or a library refuses, or its folder is missing or cannot be written.
    """
    target = Path(path)
    exists = _exists(target)
    if suffixes and target.suffix.lower() not in suffixes:
        raise OutputFileError(
            f"{target}: the name of the output must end in {' or '.join(suffixes)}; "
            "its suffix chooses the format."
        )
    if target.name.lower().endswith(".copc.laz"):
        raise OutputFileError(
            f"{target}: COPC is not written; end the name in .laz only, and make a COPC of that "
            "file (pdal translate a.laz a.copc.laz)."
        )
    for source in inputs:
        read = file_of(source)
        if exists and read is not None and os.path.exists(read) and os.path.samefile(target, read):
            raise OutputFileError(
                f"{target}: the output is the input itself; give it another name."
            )
    if exists and not overwrite:
        raise OutputFileError(_EXISTS, "overwrite", path=target)
    _refuse_link_to_nothing(target, overwrite=overwrite)
    place = _place(target)
    if not place.parent.is_dir():
        raise OutputFileError(f"{place.parent}: there is no such folder; create it first.")
    if target.suffix.lower() == ".gpkg" and len(os.fsencode(place.absolute())) > MAX_DATABASE_NAME:
        raise OutputFileError(
            f"{target.name}: SQLite cannot open a path of more than {MAX_DATABASE_NAME} "
            "bytes; choose a shorter one."
        )
    refuse_companions(place, overwrite=overwrite)
    # Asking the file system is the only test that holds for root, for read-only mounts and
    # for access lists alike.
    with scratch_folder(place):
        pass
    return target


@contextmanager
def new_file(path: str | os.PathLike[str], *, overwrite: bool = False) -> Iterator[Path]:
    """Yield a path to write to, in a scratch folder beside `path`; moved to `path` on success.

    Before the move the file is synced to the disk and read back, by the checks that its writers
    gave to `wavelet_gis.io.read_back.read_back`. Whatever else a writer leaves in the scratch
    folder (a ``.prj`` or ``.aux.xml`` beside the file) is moved along, the named file last, and
    companions of the file that is replaced go. When the block or a check raises, also for Ctrl-C,
    nothing is left and an existing file is untouched. A link is written through; a file that is
    replaced keeps its mode and owner.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from wavelet_gis.io.read_back import write_text
    >>> folder = Path(tempfile.mkdtemp())
    >>> with new_file(folder / "a.txt") as scratch:
    ...     write_text(scratch, "whole")
    >>> [p.name for p in folder.iterdir()]
    ['a.txt']
    """
    target = check_output(path, overwrite=overwrite)
    place = _place(target)
    sweep(place.parent)
    with scratch_folder(place) as folder:
        suffix = target.suffix if re.fullmatch(r"\.[A-Za-z0-9]+", target.suffix) else ""
        scratch = folder / f"{_SCRATCH_STEM}{suffix}"
        with _named(scratch, target), checks_of(scratch) as checks:
            yield scratch
            if not scratch.is_file():
                raise OutputFileError(f"{target}: the writer produced no file; please report this.")
            made = sorted(p for p in folder.iterdir() if p != scratch)
            for file in (*made, scratch):
                _sync(file)
            _verify(scratch, target, checks)
        _settle(scratch, made, place, overwrite=overwrite)
    warn_of_foreign_files(place)


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
    _refuse_link_to_nothing(target, overwrite=overwrite)
    place = _place(target)
    if os.path.lexists(place):
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
    parent = place.absolute().parent
    if not parent.is_dir():
        raise OutputFileError(f"{parent}: there is no such folder; create it first.")
    with scratch_folder(place.absolute()):
        pass
    return target


def ensure_folder(path: str | os.PathLike[str]) -> Path:
    """Return the path of a folder that files are added to, made if it was not there.

    Raises
    ------
    OutputFileError
        A file is there, or a link to nothing, or the folder around it is missing.
    """
    target = Path(path)
    if target.is_symlink() and not target.exists():
        raise OutputFileError(
            f"{target}: this is a link to {os.readlink(target)}, which is not there; make that "
            "folder first."
        )
    if target.exists() and not target.is_dir():
        raise OutputFileError(f"{target}: this is a file; name a folder.")
    if not target.absolute().parent.is_dir():
        raise OutputFileError(f"{target.parent}: there is no such folder; create it first.")
    target.mkdir(exist_ok=True)
    return target


@contextmanager
def new_folder(
    path: str | os.PathLike[str], marker: str, *, overwrite: bool = False
) -> Iterator[Path]:
    """Yield an empty folder beside `path`; moved to `path` when the block ends without an error.

    As with `new_file` all that was written there is synced to the disk and read back before, a
    link is written through, and a folder that is replaced keeps its mode and owner.

    Parameters
    ----------
    path, marker, overwrite
        See `check_folder`.
    """
    target = check_folder(path, marker, overwrite=overwrite)
    place = _place(target).absolute()
    sweep(place.parent)
    with scratch_folder(place) as scratch:
        folder = scratch / "out"
        folder.mkdir()
        with _named(folder, target), checks_below(folder) as checks:
            yield folder
            if not (folder / marker).is_file():
                raise OutputFileError(f"{target}: no {marker} was written; please report this.")
            _settle_below(folder, target, checks)
        _keep_owner(folder, place)
        aside = scratch / "replaced"
        try:
            if place.is_dir():
                os.replace(place, aside)
            os.replace(folder, place)
        except BaseException:
            if aside.is_dir() and not place.exists():
                os.replace(aside, place)
            raise
        _sync_folder(place.parent)


def _settle_below(folder: Path, target: Path, checks: dict[str, list[Check]]) -> None:
    """Sync and check all that was written in a scratch folder."""
    for place, _, names in os.walk(folder, topdown=False):
        for name in names:
            file = Path(place, name)
            _sync(file)
            _verify(file, target / file.relative_to(folder), checks.get(str(file), []))
        _sync_folder(Path(place))


def _refuse_link_to_nothing(target: Path, *, overwrite: bool) -> None:
    if target.is_symlink() and not target.exists() and not overwrite:
        raise OutputFileError(
            "{path}: this is a link to {goal}, which is not there; give another name, or {0} to "
            "write what it points to.",
            "overwrite",
            path=target,
            goal=os.readlink(target),
        )


def _exists(target: Path) -> bool:
    """Return whether a regular file is there; refuse anything else, and names that cannot be."""
    try:
        mode = os.stat(target).st_mode
    except (FileNotFoundError, NotADirectoryError):
        mode = 0
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise OutputFileError(
            f"{str(target)[:200]!a}: the system refuses this name ({reason}); choose another."
        ) from error
    if not is_utf8(target):
        raise OutputFileError(
            f"{str(target)!a}: the name is not UTF-8, which GDAL cannot write; choose another."
        )
    if stat.S_ISDIR(mode):
        raise OutputFileError(f"{target}: this is a folder; name a file in it.")
    if mode and not stat.S_ISREG(mode):
        raise OutputFileError(f"{target}: this is a device or a pipe; name a file.")
    return mode != 0


def _place(target: Path) -> Path:
    """Return where the file really goes: what a link points to."""
    if not target.is_symlink():
        return target
    place = Path(os.path.realpath(target))
    if place.is_symlink():
        raise OutputFileError(f"{target}: this link points to itself; remove it first.")
    return place


@contextmanager
def _named(scratch: Path, target: Path) -> Iterator[None]:
    """Let errors name the file that the user named, not the scratch file."""
    try:
        yield
    except Exception as error:

        def in_place(part: object) -> object:
            if isinstance(part, str | os.PathLike):
                return os.fspath(part).replace(os.fspath(scratch), os.fspath(target))
            return part

        error.args = tuple(map(in_place, error.args))
        if isinstance(error, WaveletError):
            error.template = str(in_place(error.template))
            error.values = {name: in_place(value) for name, value in error.values.items()}
        if isinstance(error, OSError) and error.filename is not None:
            error.filename = in_place(error.filename)
        raise


def _sync(path: Path) -> None:
    """Wait until a file is on the disk; what does not fit there raises here."""
    with open(path, "rb+") as stream:
        os.fsync(stream.fileno())


def _sync_folder(folder: Path) -> None:
    # Windows opens no folders, and some file systems sync none; the file's own sync is done.
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _verify(scratch: Path, target: Path, checks: list[Check]) -> None:
    if not checks:
        raise OutputFileError(
            f"{target}: the writer gave no way to check the file; please report this."
        )
    for check in checks:
        require_sound_file(scratch, check, target)


def _settle(scratch: Path, made: list[Path], place: Path, *, overwrite: bool) -> None:
    """Move a file and its companions to their place, and stale companions out of it."""
    finals = {file: place.with_name(place.stem + file.name[len(_SCRATCH_STEM) :]) for file in made}
    stale = own_companions(place) if overwrite else []
    for file, final in list(finals.items()):
        if not os.path.lexists(final) or final in stale or is_ours(final, place):
            continue
        if final.suffix == ".prj":
            _warn_of_prj(file, final, place)
            del finals[file]
        else:
            raise OutputFileError(_EXISTS, "overwrite", path=final)
    if os.path.lexists(place) and not overwrite:
        raise OutputFileError(_EXISTS, "overwrite", path=place)
    lone_prj = place.with_suffix(".prj")
    if lone_prj not in finals.values() and place.exists() and is_ours(lone_prj, place):
        stale.append(lone_prj)
    _keep_owner(scratch, place)
    changed = scratch.stat()
    for file in finals:
        os.utime(file, ns=(changed.st_atime_ns, changed.st_mtime_ns))
    # Out of the way first: a database with another one's -wal is destroyed when it is opened.
    aside = scratch.parent / "replaced"
    aside.mkdir()
    moved = []
    try:
        for old in stale:
            os.replace(old, aside / old.name)
            moved.append(old)
        for file, final in finals.items():
            os.replace(file, final)
        os.replace(scratch, place)
    except BaseException:
        for old in moved:
            os.replace(aside / old.name, old)
        raise
    _sync_folder(place.parent)


def _warn_of_prj(made: Path, final: Path, place: Path) -> None:
    text = made.read_text("utf-8", errors="replace")
    name = re.search(r'\["([^"]*)"', text)
    code = re.search(r'(?:AUTHORITY|ID)\["(\w+)",\s*"?(\w+)"?\]\]\s*$', text)
    crs = (name[1] if name else "") + (f" ({code[1]}:{code[2]})" if code else "")
    warn(
        CrsWarning,
        "prj_of_another_file",
        "{prj} belongs to another file and is left as it is; the CRS of {output} is {crs}",
        stacklevel=4,
        prj=final.name,
        output=place.name,
        crs=crs,
    )


def _keep_owner(scratch: Path, place: Path) -> None:
    """Give the new file the mode and, where the system lets us, the owner of the old one."""
    try:
        old, new = place.stat(), scratch.stat()
    except FileNotFoundError:
        return
    if hasattr(os, "chown") and (old.st_uid, old.st_gid) != (new.st_uid, new.st_gid):
        with suppress(OSError):
            os.chown(scratch, -1, old.st_gid)
        with suppress(OSError):
            os.chown(scratch, old.st_uid, -1)
    with suppress(OSError):
        os.chmod(scratch, stat.S_IMODE(old.st_mode))
    if hasattr(os, "listxattr"):
        # Access lists; some file systems have none.
        with suppress(OSError):
            for name in os.listxattr(place):
                os.setxattr(scratch, name, os.getxattr(place, name))
