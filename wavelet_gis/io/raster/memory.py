"""How much memory an analysis needs, held against what there is before the work begins."""

from __future__ import annotations

import os
from pathlib import Path

from wavelet_gis.errors import InputFileError

__all__ = ["BYTES_PER_CELL", "BYTES_PER_VERTEX", "available_memory", "require_memory"]

#: Read and mask a raster: its values twice as 64-bit floats at worst, masks and indices.
BYTES_PER_CELL = 16

#: Peak of `analyse` on a grid, in bytes for each cell with data; measured, see the tests.
BYTES_PER_VERTEX = 700


def available_memory() -> int | None:
    """Return the bytes that this process may still take; None where the system does not tell."""
    limits = [limit for limit in (_free_memory(), _group_limit(), _address_limit()) if limit]
    return min(limits, default=None)


def require_memory(n_bytes: int, name: str, what: str, available: int | None = None) -> None:
    """Refuse work that needs more memory than there is.

    Parameters
    ----------
    n_bytes : int
        What the work needs.
    name : str
        Of the file, for the message.
    what : str
        What it is needed for, such as ``"4 million cells"``.
    available : int, optional
        Instead of what the system tells.

    Raises
    ------
    InputFileError
        With both figures and the remedy.
    """
    there = available_memory() if available is None else available
    if there is not None and n_bytes > there:
        raise InputFileError(
            f"{name}: {what} need about {n_bytes / 1e9:,.1f} GB of memory and {there / 1e9:,.1f} "
            "GB are free; cut the raster into tiles (gdal_translate -srcwin), or make it coarser "
            "(gdalwarp -tr) first."
        )


def _free_memory() -> int | None:
    try:
        lines = Path("/proc/meminfo").read_text("ascii").splitlines()
    except OSError:
        try:
            return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        except (AttributeError, ValueError, OSError):
            return None
    kilobytes = {line.split(":")[0]: int(line.split()[1]) for line in lines if " kB" in line}
    return 1024 * (kilobytes.get("MemAvailable", 0) + kilobytes.get("SwapFree", 0)) or None


def _group_limit() -> int | None:
    """Return what a container leaves, by the second version of control groups."""
    try:
        group = Path("/proc/self/cgroup").read_text("utf-8").splitlines()[-1].split("::")[1]
        folder = Path("/sys/fs/cgroup") / group.strip("/")
        return int((folder / "memory.max").read_text()) - int(
            (folder / "memory.current").read_text()
        )
    except (OSError, ValueError, IndexError):
        return None


def _address_limit() -> int | None:
    try:
        import resource
    except ImportError:
        return None
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    return None if limit == resource.RLIM_INFINITY else int(limit)
