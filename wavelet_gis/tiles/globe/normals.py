"""Normals of vertices, by the slope of the input's surface: the same in all tiles that meet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.tiles.globe.source import SourceSurface
from wavelet_gis.tiles.globe.tile_grid import POINTS_ACROSS, STEPS, Tile, tile_width
from wavelet_gis.tiles.globe.tile_mesh import EARTH_RADIUS, OnTile

__all__ = ["normals_at"]

FloatArray = NDArray[np.float64]


def normals_at(source: SourceSurface, drawn: dict[Tile, OnTile]) -> dict[Tile, FloatArray]:
    """Return unit normals, from the centre of the earth, of the vertices of tiles, ``(n, 3)`` each.

    Parameters
    ----------
    source : SourceSurface
    drawn : dict of Tile to OnTile
        Tiles of one zoom.

    Notes
    -----
    Slopes are taken across some two spacings of the points, and across more on coarse zooms.
    """
    tiles = list(drawn)
    scale = 1 << (source.zoom - tiles[0].zoom)
    plan = np.concatenate(
        [
            np.column_stack([on.u + tile.x * STEPS, on.v + tile.y * STEPS])
            for tile, on in drawn.items()
        ]
    ) * float(scale)
    normals = _normals(source, plan, STEPS / POINTS_ACROSS * max(scale / 8, 1.0))
    ends = np.cumsum([len(on.u) for on in drawn.values()])[:-1]
    return dict(zip(tiles, np.split(normals, ends), strict=True))


def _normals(source: SourceSurface, plan: FloatArray, reach: float) -> FloatArray:
    sides = np.array([[reach, 0], [-reach, 0], [0, reach], [0, -reach]])
    heights = source.heights_at((plan[None] + sides[:, None]).reshape(-1, 2)).reshape(4, -1)
    step = tile_width(source.zoom) / STEPS
    longitude, latitude = np.radians((plan * step - [180.0, 90.0]).T)
    sin_x, cos_x, sin_y, cos_y = (
        np.sin(longitude),
        np.cos(longitude),
        np.sin(latitude),
        np.cos(latitude),
    )
    metres = 2 * reach * np.radians(step) * EARTH_RADIUS
    east = (heights[0] - heights[1]) / (metres * np.maximum(cos_y, 1e-6))
    north = (heights[2] - heights[3]) / metres
    to_east = np.stack([-sin_x, cos_x, np.zeros_like(sin_x)], axis=1)
    to_north = np.stack([-sin_y * cos_x, -sin_y * sin_x, cos_y], axis=1)
    up = np.stack([cos_y * cos_x, cos_y * sin_x, sin_y], axis=1)
    normal = up - east[:, None] * to_east - north[:, None] * to_north
    unit: FloatArray = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    return unit
