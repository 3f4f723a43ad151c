"""Memory that was freed: kept for the next array, or handed back to the system."""

from __future__ import annotations

import ctypes
import sys

#: Numbers of limits in `mallopt` of the GNU C library, and what they are set to: arrays of up to so
#: many bytes, such as five columns of ten million numbers, come from memory that was freed before,
#: of which an eighth of a gigabyte may lie idle at its end. Of larger ones what is freed fits
#: nothing else: ten million points took 7.9 GiB, and 8.7 with a whole gigabyte; with a quarter, 0.1
#: GiB less, but a quarter more time of the system.
_M_MMAP_THRESHOLD, _LARGEST_REUSED = -3, 448 << 20
_M_TRIM_THRESHOLD, _MOST_IDLE = -1, 1 << 27

_keeps_freed = False


def keep_freed_memory() -> None:
    """Let this process use the memory of large arrays again, for programs of our own alone.

    The GNU C library hands the memory of every array above 32 MB back to the system at once, which
    clears it before it is used anew: a sixth of the time of an analysis of millions of vertices.
    Larger ones than `_LARGEST_REUSED` still go back. Elsewhere nothing changes.
    """
    global _keeps_freed
    library = _c_library()
    if library is not None and not _keeps_freed:
        library.mallopt(_M_MMAP_THRESHOLD, _LARGEST_REUSED)
        library.mallopt(_M_TRIM_THRESHOLD, _MOST_IDLE)
        _keeps_freed = True


def give_memory_back() -> None:
    """Hand back what is free, between parts of the work that need different arrays."""
    library = _c_library()
    if _keeps_freed and library is not None:
        library.malloc_trim(0)


def _c_library() -> ctypes.CDLL | None:
    if not sys.platform.startswith("linux"):
        return None
    library = ctypes.CDLL(None)
    return library if hasattr(library, "mallopt") and hasattr(library, "malloc_trim") else None
