"""The tiles of a globe: the geodetic grid of two by one tiles, and positions in whole steps.

Tiles count from the south west (TMS). A vertex of a tile is stored in steps of 1/32767 of the
tile's width and height. All positions here are whole numbers of steps of the finest zoom, counted
from the south west of the earth, so that neighbours and zooms can be compared without rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "POINTS_ACROSS",
    "STEPS",
    "Tile",
    "TileRange",
    "ranges_of",
    "steps_of_degrees",
    "tile_width",
]

#: Steps across a tile, as the format has them.
STEPS = 32767

#: Points of the input along each side of a tile of the finest zoom, where none is asked for.
POINTS_ACROSS = 128


class Tile(NamedTuple):
    """A tile: its zoom, its column from the west, its row from the south."""

    zoom: int
    x: int
    y: int

    def children(self) -> tuple[Tile, Tile, Tile, Tile]:
        """Return the four tiles of the next zoom that cover it."""
        z, x, y = self.zoom + 1, 2 * self.x, 2 * self.y
        return Tile(z, x, y), Tile(z, x + 1, y), Tile(z, x, y + 1), Tile(z, x + 1, y + 1)

    def bounds(self) -> tuple[float, float, float, float]:
        """Return west, south, east and north in degrees."""
        width = tile_width(self.zoom)
        west, south = self.x * width - 180.0, self.y * width - 90.0
        return west, south, west + width, south + width


@dataclass(frozen=True, slots=True)
class TileRange:
    """Tiles of one zoom that form a rectangle; the last column and row are in it.

    Attributes
    ----------
    zoom, first_x, first_y, last_x, last_y : int
    """

    zoom: int
    first_x: int
    first_y: int
    last_x: int
    last_y: int

    def __len__(self) -> int:
        return (self.last_x - self.first_x + 1) * (self.last_y - self.first_y + 1)

    def tiles(self) -> list[Tile]:
        """Return them row by row."""
        return [
            Tile(self.zoom, x, y)
            for y in range(self.first_y, self.last_y + 1)
            for x in range(self.first_x, self.last_x + 1)
        ]


def tile_width(zoom: int) -> float:
    """Return the width, and height, of a tile in degrees."""
    return 180.0 / (1 << zoom)


def steps_of_degrees(
    longitude: NDArray[np.float64], latitude: NDArray[np.float64], zoom: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return positions in steps of the tiles of a zoom, not rounded."""
    per_degree = STEPS / tile_width(zoom)
    return (longitude + 180.0) * per_degree, (latitude + 90.0) * per_degree


def ranges_of(bounds: tuple[float, float, float, float], zoom: int) -> list[TileRange]:
    """Return the tiles of each zoom, from 0 up, that show an area.

    Parameters
    ----------
    bounds : tuple of float
        West, south, east and north of the area in degrees.
    zoom : int
        The finest.

    Returns
    -------
    list of TileRange
        A tile has all four of its children, or none. Zoom 0 has both of its tiles, without which
        viewers show nothing.
    """
    width = tile_width(zoom)
    last_column, last_row = (2 << zoom) - 1, (1 << zoom) - 1
    west, south, east, north = bounds
    first_x = min(max(int((west + 180.0) // width), 0), last_column)
    first_y = min(max(int((south + 90.0) // width), 0), last_row)
    last_x = min(max(int((east + 180.0) // width), 0), last_column)
    last_y = min(max(int((north + 90.0) // width), 0), last_row)
    ranges = []
    for z in range(zoom, 0, -1):
        first_x, first_y, last_x, last_y = first_x & ~1, first_y & ~1, last_x | 1, last_y | 1
        ranges.append(TileRange(z, first_x, first_y, last_x, last_y))
        first_x, first_y, last_x, last_y = (v >> 1 for v in (first_x, first_y, last_x, last_y))
    ranges.append(TileRange(0, 0, 0, 1, 0))
    return ranges[::-1]
