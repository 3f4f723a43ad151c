"""Memory that a piece of work will take, held against what there is before the work begins."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path
from typing import NamedTuple

from wavelet_gis.errors import InputFileError

#: Bytes a cell to read a raster: its values twice as 64-bit floats at worst, masks, indices.
BYTES_TO_READ_A_CELL = 16

#: Bytes for each cell with data to read a raster and analyse it; 470 were taken at most, for the
#: 9.07 million cells of a DEM of the Pyrenees, the file and its layers included.
BYTES_TO_ANALYSE_A_CELL = 500

#: Bytes that an analysis takes at most beside its input, a vertex, and a vertex and channel beyond
#: z; measured on rasters of 1 to 9 million cells and clouds with up to four attributes.
BYTES_A_VERTEX = 400
BYTES_A_CHANNEL = 120

#: Inputs of fewer vertices are never refused: a wrong figure must not stop small work.
SMALL_INPUT = 1_000_000


def analysis_bytes(n_vertices: int, n_channels: int) -> int:
    """Return what an analysis takes beside its input.

    Examples
    --------
    >>> analysis_bytes(9_070_000, 1) // 10**6
    3628
    """
    return n_vertices * (BYTES_A_VERTEX + BYTES_A_CHANNEL * (n_channels - 1))


def require_memory(n_vertices: int, n_channels: int, available: int | None = None) -> None:
    """Refuse an analysis that will not fit, with the figures.

    Parameters
    ----------
    n_vertices, n_channels : int
        Of the input; z is a channel.
    available : int, optional
        Bytes that there are; by default what the system says, and without that nothing is refused.

    Raises
    ------
    InputFileError
        What there is is less than what it takes.
    """
    free = available_bytes() if available is None else available
    needed = analysis_bytes(n_vertices, n_channels)
    if free is None or n_vertices < SMALL_INPUT or needed <= free:
        return
    raise InputFileError(
        "an analysis of {n_vertices:,} vertices takes some {needed:.1f} GB of memory, and "
        "{free:.1f} GB are free; close other programs, cut the input into tiles, or thin it first.",
        n_vertices=n_vertices,
        needed=needed / 1e9,
        free=free / 1e9,
    )


def require_bytes(n_bytes: int, name: str, what: str, available: int | None = None) -> None:
    """Refuse a raster that needs more memory than there is.

    Parameters
    ----------
    n_bytes : int
        What it needs.
    name : str
        Of the file, for the message.
    what : str
        What needs it, such as ``"4 million cells"``.
    available : int, optional
        Bytes that there are; by default what the system says, and without that nothing is refused.

    Raises
    ------
    InputFileError
        With both figures and the remedy.
    """
    free = available_bytes() if available is None else available
    if free is not None and n_bytes > free:
        raise InputFileError(
            f"{name}: {what} need about {n_bytes / 1e9:,.1f} GB of memory and {free / 1e9:,.1f} "
            "GB are free; cut the raster into tiles (gdal_translate -srcwin), or make it coarser "
            "(gdalwarp -tr) first."
        )


def available_bytes() -> int | None:
    """Return the memory that may still be taken; None where the system does not say."""
    limits = (_of_system(), _of_group(), _of_old_group(), _of_process())
    return min((limit for limit in limits if limit is not None), default=None)


def _of_system() -> int | None:
    if sys.platform == "win32":
        return _of_windows()
    try:
        text = Path("/proc/meminfo").read_text(encoding="ascii")
    except OSError:
        return _of_pages()
    kilobytes = {line.split(":")[0]: int(line.split()[1]) for line in text.splitlines()}
    if "MemAvailable" not in kilobytes:
        return None
    return 1024 * (kilobytes["MemAvailable"] + kilobytes.get("SwapFree", 0))


def _of_pages() -> int | None:
    """Return half of all memory, where the system says no more."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2
    except (ValueError, OSError, AttributeError):
        return None


class _GroupFiles(NamedTuple):
    """What a version of control groups calls its figures of memory.

    limit, used : str, names of files
    cached : str, what the line of ``memory.stat`` begins with
    """

    limit: str
    used: str
    cached: str


_GROUP = _GroupFiles("memory.max", "memory.current", "inactive_file ")
_OLD_GROUP = _GroupFiles("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file ")


def _of_group(root: Path = Path("/sys/fs/cgroup"), own: str | None = None) -> int | None:
    """Return what the control groups of the process have left, as in a container.

    Parameters
    ----------
    root : Path
        Where version 2 of the groups is mounted.
    own : str, optional
        The process's own group, by default as the system says.
    """
    return _least_left(root, _own_group("") if own is None else own, _GROUP)


def _of_old_group(root: Path = Path("/sys/fs/cgroup/memory"), own: str | None = None) -> int | None:
    """Return the same of version 1 of the groups, whose memory is mounted by itself."""
    return _least_left(root, _own_group("memory") if own is None else own, _OLD_GROUP)


def _own_group(controller: str, path: Path = Path("/proc/self/cgroup")) -> str:
    """Return the group of the process that has a controller, "" of version 2; "" without one."""
    try:
        rows = [row.split(":", 2) for row in path.read_text("utf-8").splitlines()]
    except (OSError, ValueError):
        return ""
    found = (row[2] for row in rows if len(row) == 3 and controller in row[1].split(","))
    return next(found, "")


def _least_left(root: Path, own: str, files: _GroupFiles) -> int | None:
    # A group has no more than those around it; inside a container the own one is the root.
    parts = [part for part in own.split("/") if part]
    folders = [root.joinpath(*parts[:n]) for n in range(len(parts) + 1)]
    every = (_left_in(folder, files) for folder in folders)
    return min((left for left in every if left is not None), default=None)


def _left_in(folder: Path, files: _GroupFiles) -> int | None:
    """Return what a control group has left; None where it has no limit.

    Files that are cached count as used, and go as soon as a program needs the memory.
    """
    try:
        limit = (folder / files.limit).read_text(encoding="ascii").strip()
        used = (folder / files.used).read_text(encoding="ascii").strip()
    except OSError:
        return None
    if not (limit.isdigit() and used.isdigit()):
        return None
    try:
        rows = (folder / "memory.stat").read_text(encoding="ascii").splitlines()
    except OSError:
        rows = []
    cached = sum(int(row.split()[1]) for row in rows if row.startswith(files.cached))
    return max(int(limit) - max(int(used) - cached, 0), 0)


def _of_process() -> int | None:
    """Return what the limit of the process's addresses leaves, as ``ulimit -v`` sets it."""
    try:
        import resource
    except ImportError:
        return None
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit == resource.RLIM_INFINITY:
        return None
    try:
        n_pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except OSError:  # no Linux; then the limit is all that is known
        n_pages = 0
    return max(int(limit) - n_pages * resource.getpagesize(), 0)


def _of_windows() -> int | None:
    class Status(ctypes.Structure):
        _fields_ = (
            ("length", ctypes.c_ulong),
            ("load", ctypes.c_ulong),
            *((name, ctypes.c_ulonglong) for name in ("total", "free", "page_total", "page_free",
                                                      "own_total", "own_free", "extended")),
        )  # fmt: skip

    status = Status()
    status.length = ctypes.sizeof(status)
    windows = getattr(ctypes, "windll", None)
    if windows is None or not windows.kernel32.GlobalMemoryStatusEx(ctypes.byref(status)):
        return None
    return int(status.free)
