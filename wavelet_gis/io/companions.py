"""Files beside an output that readers take for part of it, and whose they are.

=================================  ==============================================================
``a.gpkg-wal`` ``-shm`` ``-journal``  the output's own; of another database they destroy it
``a.tif.ovr`` ``.msk`` ``.aux.xml``   the output's own; they show another raster
``a.prj`` ``a.hdr``                   ours only if written with the output that is replaced
``a.tfw`` ``a.lax`` and others        somebody else's; named, never touched
=================================  ==============================================================
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from wavelet_gis.errors import OutputFileError, TerrainWarning
from wavelet_gis.notes import warn

__all__ = ["holders", "is_ours", "own_companions", "refuse_companions", "warn_of_foreign_files"]

_OF_DATABASES = ("-wal", "-shm", "-journal")
_OF_RASTERS = (".ovr", ".msk", ".msk.ovr", ".aux.xml")

#: Suffixes of outputs that GDAL's companions do not belong to.
_NO_RASTERS = (
    *(".gpkg", ".ply", ".obj", ".2dm", ".slf", ".stl", ".glb", ".xml", ".dxf"),
    *(".las", ".laz", ".html", ".htm", ".json", ".pdf", ".svg"),
)

#: Formats that cannot be read without a header beside them.
_HEADERS = dict.fromkeys((".bil", ".bip", ".bsq", ".flt"), ".hdr")

#: Files of these kinds own a ``.prj`` of their stem.
_OWNERS_OF_PRJ = (
    ".shp",
    ".dbf",
    ".shx",
    ".asc",
    ".bil",
    ".bip",
    ".bsq",
    ".flt",
    ".grd",
    ".2dm",
    ".slf",
)

#: What other programs put beside a raster or a cloud under its stem.
_FOREIGN = {
    ".tif": (".tfw", ".wld", ".aux", ".rrd"),
    ".tiff": (".tfw", ".wld", ".aux", ".rrd"),
    ".las": (".lax",),
    ".laz": (".lax",),
}


def own_companions(target: Path) -> list[Path]:
    """Return the companions of an output that are there, by its full name."""
    suffix = target.suffix.lower()
    if suffix == ".gpkg":
        endings: tuple[str, ...] = (*_OF_DATABASES, ".aux.xml")
    elif suffix in _NO_RASTERS:
        endings = ()
    else:
        endings = _OF_RASTERS
    beside = (target.with_name(target.name + ending) for ending in endings)
    return [path for path in beside if os.path.lexists(path)]


def refuse_companions(target: Path, *, overwrite: bool) -> None:
    """Refuse an output whose companions stand in the way, before the long work.

    Raises
    ------
    OutputFileError
        Without `overwrite`, when there are some; with it, when another program has the database
        open; when a header that the format needs belongs to something else.
    """
    found = own_companions(target)
    if found and not overwrite:
        raise OutputFileError(
            "{path}: this file would be taken for a part of {output}; give another name, or {0} "
            "to remove it.",
            "overwrite",
            path=found[0],
            output=target.name,
        )
    if target.suffix.lower() == ".gpkg" and target.exists():
        processes = holders([target, *found])
        if processes is None and any(path.name.endswith("-shm") for path in found):
            raise OutputFileError(
                f"{target}: another program may have it open ({found[0].name} is beside it); close "
                f"it there, or remove {found[0].name}."
            )
        if processes:
            raise OutputFileError(
                f"{target}: another program has it open (process "
                f"{', '.join(map(str, processes))}); close it there first."
            )
    header = _HEADERS.get(target.suffix.lower())
    if header and target.with_suffix(header).exists():
        beside = target.with_suffix(header)
        if not (overwrite and is_ours(beside, target)):
            raise OutputFileError(
                f"{beside}: this file exists, and {target.name} needs one of that name; give "
                "another name."
            )


def is_ours(companion: Path, target: Path) -> bool:
    """Return whether a file of the stem of an output that is there was written together with it.

    The two then have one time of change, to the nanosecond (`wavelet_gis.io.atomic.new_file` sees
    to it), and nothing else of that stem could own it.
    """
    if companion.suffix.lower() == ".prj":
        for suffix in _OWNERS_OF_PRJ:
            for owner in (companion.with_suffix(suffix), companion.with_suffix(suffix.upper())):
                if owner.exists() and owner.name.lower() != target.name.lower():
                    return False
    try:
        return companion.stat().st_mtime_ns == target.stat().st_mtime_ns
    except OSError:
        return False


def warn_of_foreign_files(target: Path) -> None:
    """Name files beside a new output that may have been made for the one before."""
    endings = _FOREIGN.get(target.suffix.lower(), ())
    found = [target.with_suffix(ending) for ending in endings]
    names = [path.name for path in found if path.exists()]
    if names:
        warn(
            TerrainWarning,
            "companion_of_old_output",
            "{files} beside {output} is left as it was and may not describe the new file; remove "
            "it if it was made for the old one",
            stacklevel=3,
            files=", ".join(names),
            output=target.name,
        )


def holders(paths: list[Path]) -> list[int] | None:
    """Return the processes that have a database open and locked; None where that is not known.

    Read from Linux's table of locks: opening the file to ask would, by the rules of POSIX, drop
    the locks that this very process (QGIS, say) holds on it.
    """
    try:
        lines = Path("/proc/locks").read_text("ascii").splitlines()
    except OSError:
        return None
    files = set()
    for path in paths:
        if path.name.endswith("-journal") or not path.exists():
            continue
        status = path.stat()
        place = f"{os.major(status.st_dev):02x}:{os.minor(status.st_dev):02x}:{status.st_ino}"
        files.add(place)
    found = set()
    for line in lines:
        match = re.search(r"POSIX\s+\S+\s+\S+\s+(-?\d+)\s+(\S+)\s", line)
        if match and match[2] in files:
            found.add(int(match[1]))
    return sorted(found)
