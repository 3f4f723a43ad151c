"""Names of files as GDAL takes them: any that the system allows, and nothing read into them."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.io.formats import (
    CLOUD_SUFFIXES,
    EPT,
    FOLDER_RASTER_SUFFIXES,
    any_of,
    suffix_of,
)

__all__ = [
    "MAX_DATABASE_NAME",
    "file_of",
    "files_of",
    "gdal_path",
    "is_utf8",
    "joint_name",
    "plain_folder",
    "readable",
]

#: Longest path, in bytes, that SQLite opens with room for its ``-journal``; its own limit is 512.
MAX_DATABASE_NAME = 500

#: What begins the name of a sub-dataset: a driver and a colon.
_DRIVER = re.compile(r"[A-Za-z][A-Za-z0-9_]+:")


def file_of(name: str | os.PathLike[str]) -> str | None:
    """Return the file that a name leads to, also the one within a sub-dataset's name.

    Parameters
    ----------
    name : path or str
        Such as ``a.tif``, ``GPKG:a.gpkg:dem``, ``NETCDF:"a.nc":z`` or ``HDF5:"a.h5"://z``.

    Returns
    -------
    str or None
        None where no file of that name is there.
    """
    text = os.fspath(name)
    if os.path.lexists(text):
        return text
    driver = _DRIVER.match(text)
    if driver is None:
        return None
    rest = text[driver.end() :]
    quoted = re.match(r'(?:\d+:)?"([^"]+)"', rest)
    if quoted:
        return quoted[1] if os.path.exists(quoted[1]) else None
    # The file's own name may have colons, so the longest run of parts that exists is it.
    parts = rest.split(":")
    runs = [
        ":".join(parts[start:stop])
        for start in range(len(parts))
        for stop in range(len(parts), start, -1)
    ]
    return next((run for run in runs if os.path.isfile(run)), None)


def files_of(
    data: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
) -> list[str]:
    """Return the files that an input is: one, several, or the terrain files in a folder.

    Parameters
    ----------
    data : path or sequence of path
        Each a file or a folder. In a folder, LAS and LAZ files count, or else rasters, by their
        suffix and in the order of their names; one with an ``ept.json`` is that.

    Raises
    ------
    InputFileError
        A folder with neither or both, no file at all, or one that is named twice.
    """
    given = [data] if isinstance(data, str | os.PathLike) else list(data)
    if not given:
        raise InputFileError("there is no input; name a file or a folder.")
    found: list[str] = []
    for name in (os.fspath(one) for one in given):
        ept = os.path.join(name, EPT)
        if os.path.isfile(ept):
            found.append(ept)
        else:
            found += _in_folder(name) if os.path.isdir(name) else [name]
    seen: set[str] = set()
    for name in found if found[1:] else ():
        real = os.path.realpath(name)
        if real in seen:
            raise InputFileError(f"{name}: this file is named twice; name it once.")
        seen.add(real)
    return found


def _in_folder(name: str) -> list[str]:
    entries = sorted(entry for entry in os.listdir(name) if not entry.startswith("."))
    clouds, rasters = (
        [os.path.join(name, entry) for entry in entries if suffix_of(entry) in suffixes]
        for suffixes in (CLOUD_SUFFIXES, FOLDER_RASTER_SUFFIXES)
    )
    if clouds and rasters:
        raise InputFileError(
            f"{name}: this folder holds point clouds and rasters; name those of one kind."
        )
    if not clouds and not rasters:
        raise InputFileError(
            f"{name}: this folder holds no file ending in "
            f"{any_of((*CLOUD_SUFFIXES, *FOLDER_RASTER_SUFFIXES))}; name the files."
        )
    return clouds or rasters


def joint_name(files: Sequence[str]) -> str:
    """Return the one name by which messages call several files.

    Examples
    --------
    >>> joint_name(["a.laz"]), joint_name(["a.laz", "b.laz", "c.laz"])
    ('a.laz', 'a.laz and 2 more')
    """
    return files[0] if len(files) == 1 else f"{files[0]} and {len(files) - 1} more"


def gdal_path(name: str | os.PathLike[str]) -> Path | str:
    """Return a file's name such that rasterio and GDAL read nothing else into it.

    A file that is there, or will be, is named from the root: ``GPKG:a.tif`` in the working folder
    is then no sub-dataset, ``zip://a`` no archive. Whatever else is left as it came.

    Raises
    ------
    InputFileError
        When the name holds bytes that are no UTF-8, which GDAL cannot take.
    """
    text = os.fspath(name)
    if not os.path.lexists(text) and (text.startswith("/vsi") or file_of(text) is not None):
        return text
    if not is_utf8(text):
        raise InputFileError(
            f"{text!a}: the name is not valid UTF-8, which GDAL cannot open; rename the file."
        )
    # Under a locale without UTF-8 Python holds such names as undecoded bytes.
    return Path(os.fsencode(os.path.join(os.getcwd(), text)).decode("utf-8"))


def is_utf8(name: str | os.PathLike[str]) -> bool:
    """Return whether the bytes of a file's name are UTF-8."""
    try:
        os.fsencode(os.path.abspath(name)).decode("utf-8")
    except UnicodeError:
        return False
    return True


def readable(name: str | os.PathLike[str]) -> str:
    """Return a file's name as text that can be written to any file in UTF-8."""
    return os.fsencode(name).decode("utf-8", "backslashreplace")


@contextmanager
def plain_folder(path: str | os.PathLike[str]) -> Iterator[str]:
    """Yield another name of a file, by way of a link, where pyogrio would misread its own.

    pyogrio takes ``!`` and ``;`` in a path for the syntax of archives and cuts it there, and asks
    Python for files by names that a plain locale cannot encode.

    Raises
    ------
    OutputFileError
        When the system makes no links.
    """
    from pyogrio.util import vsi_path

    name = str(gdal_path(path))
    if vsi_path(name) == name and _is_known_to_the_system(name):
        yield name
        return
    with tempfile.TemporaryDirectory() as folder:
        link = Path(folder) / "folder"
        try:
            link.symlink_to(os.path.dirname(os.path.abspath(path)), target_is_directory=True)
        except OSError as error:
            raise OutputFileError(
                f"{path}: layers cannot be written to a folder of this name ({error.strerror}); "
                "choose one without ! and ;."
            ) from error
        alias = str(link / os.path.basename(name))
        if vsi_path(alias) != alias:
            raise OutputFileError(
                f"{path}: layers cannot be written to a file of this name; leave out ! and ;."
            )
        yield alias


def _is_known_to_the_system(name: str) -> bool:
    try:
        os.fsencode(name)
    except UnicodeError:
        return False
    return True
