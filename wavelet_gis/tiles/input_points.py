"""The points of the input in the tiles of a set, those merged with others among them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.tiles.area import Area
from wavelet_gis.tiles.index import TileIndex
from wavelet_gis.tiles.piece import cells_of
from wavelet_gis.tiles.plan import Piece

__all__ = [
    "InputPoints",
    "is_first_tile",
    "points_beside_vertices",
    "points_of_tile",
    "points_without_surface",
]


class InputPoints(NamedTuple):
    """The input's points in a tile.

    places : (n, 3) float64, with z of 0; those of the vertices first
    heights : (n,) float64
    vertex_heights : (n_vertices,) float64, which are others where points were merged to a mean
    cells : (n,) int64, in the grid of all; -1 where no other tile has them
    """

    places: NDArray[np.float64]
    heights: NDArray[np.float64]
    vertex_heights: NDArray[np.float64]
    cells: NDArray[np.int64]


def points_of_tile(index: TileIndex, tile: Piece, geo: GeoPyramid) -> InputPoints:
    """Return the points of a tile that has a surface.

    Parameters
    ----------
    index : TileIndex
    tile : Piece
    geo : GeoPyramid
        Of the tile, with its origin.
    """
    plan, finest = index.plan, geo.pyramid.mesh(geo.pyramid.n_levels)
    cells, points = cells_of(plan, finest), finest.vertices.copy()
    if geo.origin.points is not None:
        points = geo.origin.points.points_for_errors(finest, geo.frame)
        cells = np.concatenate([cells, cells[geo.origin.points.representative]])
    rows, columns = np.divmod(cells, plan.shape[1])
    cells[~plan.is_shared(tile, rows, columns)] = -1
    heights = points[:, 2].copy()
    points[:, 2] = 0.0
    return InputPoints(points, heights, finest.vertices[:, 2], cells)


def points_without_surface(
    index: TileIndex, area: Area
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.int64]]]:
    """Yield the points of each tile without a surface that are in an area, and their cells.

    See `wavelet_gis.tiles.cloud.restore.loose_points`.
    """
    if index.plan.points is None:
        return
    from wavelet_gis.tiles.cloud.restore import loose_points

    for tile in index.plan.pieces(0):
        if index.records.get(tile, {}).get("status") == "loose" and area.has_piece(tile):
            places, cells = loose_points(index, tile)
            inside = area.has_points(places)
            yield places[inside], cells[inside]


def points_beside_vertices(index: TileIndex, area: Area) -> NDArray[np.float64]:
    """Return the points of an area that no vertex of its finest level is.

    They are those merged with others, and those of tiles without a surface.

    Returns
    -------
    (n, 3) float64
        In the working frame; each once.
    """
    from wavelet_gis.io.pyramid.pyramid_file import read_input

    if index.plan.points is None:
        return np.empty((0, 3))
    found, at = [np.empty((0, 3))], [np.empty(0, np.int64)]
    for tile in index.whole(0):
        if not area.has_piece(tile):
            continue
        points = points_of_tile(index, tile, read_input(index.path(tile)))
        is_vertex = np.zeros(len(points.places), dtype=bool)
        n = len(points.vertex_heights)
        is_vertex[:n] = points.heights[:n] == points.vertex_heights
        beside = ~is_vertex & area.has_points(points.places)
        places = points.places[beside]
        places[:, 2] = points.heights[beside]
        found.append(places)
        at.append(points.cells[beside])
    for places, cells in points_without_surface(index, area):
        found.append(places)
        at.append(cells)
    return np.concatenate(found)[is_first_tile(at)]


def is_first_tile(cells: list[NDArray[np.int64]]) -> NDArray[np.bool_]:
    """Return which points count, of all of several tiles, so that none counts twice.

    Parameters
    ----------
    cells : list of (n,) int64
        By tile, in the grid of all; -1 for points that no other tile has.

    Returns
    -------
    (n_points,) bool
        A cell counts in the first tile that has it, with all the points that are merged there.
    """
    every = np.concatenate([np.empty(0, np.int64), *cells])
    tile = np.repeat(np.arange(len(cells)), [len(part) for part in cells])
    _, first, place = np.unique(every, return_index=True, return_inverse=True)
    counts: NDArray[np.bool_] = (every < 0) | (tile == tile[first][place.ravel()])
    return counts
