"""Which parts of a COPC file hold the points of a box at a resolution.

A COPC file is a LAZ file whose chunks are the nodes of an octree: those of level 0 are few points
of all, each level beneath has twice the density. Its first VLR says where the tree lies, its pages
(EVLRs) where each node's points do. What they say is held against the file's size.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple

from wavelet_gis.errors import InputFileError
from wavelet_gis.io.las.layout import LasLayout
from wavelet_gis.io.las.octree import MOST_LEVELS, Box, finest_level, reaches_into

__all__ = ["Chunk", "chunks_within", "is_copc"]

#: Centre, half of the side, spacing of the points at level 0, offset and bytes of the first page.
_INFO = struct.Struct("<5d2Q")

#: Level, x, y, z, offset, bytes, points; -1 points for a page of further entries.
_ENTRY = struct.Struct("<4iQ2i")


class Chunk(NamedTuple):
    """Compressed points: where they begin in the file, bytes, points."""

    start: int
    n_bytes: int
    n_points: int


def is_copc(layout: LasLayout) -> bool:
    """Return whether a file says that it is COPC."""
    first = layout.vlrs[0] if layout.vlrs else None
    return (
        first is not None
        and (first.user_id, first.record_id) == ("copc", 1)
        and first.end - first.data_start >= _INFO.size
    )


def chunks_within(
    name: str,
    layout: LasLayout,
    stream: BinaryIO,
    bbox: Box | None,
    resolution: float | None,
) -> list[Chunk]:
    """Return the chunks whose nodes reach into a box, down to a resolution, as they lie.

    Parameters
    ----------
    name : str
        Of the file, for messages.
    layout : LasLayout
    stream : BinaryIO
        The open file.
    bbox : tuple of float or None
        Smallest x and y, largest x and y; None for all.
    resolution : float or None
        Spacing of the points that is enough, in the unit of x and y; None for all levels.

    Raises
    ------
    InputFileError
        The tree says what cannot be.
    """
    x, y, _, half, spacing, page, n_bytes = _INFO.unpack_from(
        layout.block, layout.vlrs[0].data_start
    )
    if not (half > 0 and spacing > 0):
        raise _damaged(name, f"a tree of side {2 * half:g} with points {spacing:g} apart")
    finest = finest_level(spacing, resolution)
    found = []
    size = os.fstat(stream.fileno()).st_size
    for level, column, row, chunk in _entries(name, stream, size, page, n_bytes):
        side = 2 * half / 2**level
        west, south = x - half + column * side, y - half + row * side
        is_wanted = level <= finest and chunk.n_points > 0
        if is_wanted and reaches_into(west, south, (side, side), bbox):
            found.append(chunk)
    if sum(chunk.n_points for chunk in found) > layout.n_points:
        raise _damaged(name, f"more points in the tree than the {layout.n_points} of the header")
    return sorted(found)


def _entries(
    name: str, stream: BinaryIO, size: int, page: int, n_bytes: int
) -> Iterator[tuple[int, int, int, Chunk]]:
    """Yield level, column, row and chunk of all nodes, page by page."""
    pages, seen = [(page, n_bytes)], set()
    while pages:
        start, n_bytes = pages.pop()
        if start in seen or n_bytes % _ENTRY.size or not 0 < start <= start + n_bytes <= size:
            raise _damaged(name, f"a page of {n_bytes} bytes at byte {start} of {size}")
        seen.add(start)
        stream.seek(start)
        for level, column, row, _, offset, length, n_points in _ENTRY.iter_unpack(
            stream.read(n_bytes)
        ):
            if n_points == -1:
                pages.append((offset, length))
                continue
            if not (0 <= level < MOST_LEVELS and n_points >= 0 and length >= 0):
                raise _damaged(name, f"a node of level {level} with {n_points} points")
            if offset + length > size:
                raise _damaged(name, f"points at byte {offset} of {size}")
            yield level, column, row, Chunk(offset, length, n_points)


def _damaged(name: str, what: str) -> InputFileError:
    return InputFileError(
        f"{name}: the tree of this COPC file is damaged ({what}); get the file again, or read all "
        "of it as LAZ."
    )
