"""The pieces, and their levels, by which a tile set keeps a tolerance.

Of a tile set any pieces fit together that cover it once, whatever their stages and levels: the
border of a group is locked at all its levels, and so is that of the tiles beside it. So each part
of the terrain can be as coarse as the tolerance allows. The errors in a group's record are those at
some of the input's points; what counts is the distance of all of them, so these are read, tile by
tile, and with them the points that were merged into one.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, TriangleMesh
from wavelet_core.accuracy.between_levels import mesh_of_accuracy
from wavelet_core.mesh.location import errors_with_border
from wavelet_core.progress import report
from wavelet_gis.tiles.area import Area
from wavelet_gis.tiles.index import TileIndex
from wavelet_gis.tiles.input_points import InputPoints, points_of_tile
from wavelet_gis.tiles.plan import Piece

__all__ = ["Chosen", "PointErrors", "TilePoints", "pieces_within"]


#: Part of its extent by which a point may be beside a mesh by rounding: in a hundred kilometres a
#: tenth of a millimetre.
BESIDE = 1e-9
#: Bytes of the points of tiles that are kept while the levels of a group are tried, and those of
#: its parts: some five tiles of 1,024 × 1,024 cells.
KEPT_BYTES = 1 << 28


class PointErrors(NamedTuple):
    """How far the input's points in a tile are off, those merged with a vertex among them.

    errors : (n,) float64, in the working frame; NaN where no face is
    cells : (n,) int64, in the grid of all, where other tiles have the point too; else -1
    """

    errors: NDArray[np.float64]
    cells: NDArray[np.int64]


class Chosen(NamedTuple):
    """A piece as coarse as it may be.

    piece : Piece
    mesh : TriangleMesh, in the working frame
    level : int, of the piece; the finest that is part of it
    errors : tuple of PointErrors, by tile
    """

    piece: Piece
    mesh: TriangleMesh
    level: int
    errors: tuple[PointErrors, ...]


def pieces_within(
    index: TileIndex, area: Area, limit: float, progress: Progress | None = None
) -> Iterator[Chosen]:
    """Yield the pieces of an area by which no vertex of the input is farther off.

    Parameters
    ----------
    index : TileIndex
    area : Area
    limit : float
        Vertical distance in the working frame.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    top, tiles = index.plan.n_stages - 1, TilePoints(index)
    n_tiles = sum(area.has_piece(tile) for tile in index.plan.pieces(0))
    n_left = n_tiles
    waiting = [piece for piece in reversed(index.plan.pieces(top)) if area.has_piece(piece)]
    while waiting:
        piece = waiting.pop()
        report(progress, 1.0 - n_left / max(n_tiles, 1))
        status = index.records.get(piece, {}).get("status", "missing")
        chosen = None
        if status == "whole":
            chosen = (_tile if piece.stage == 0 else _group)(tiles, area, piece, limit)
            if chosen is not None:
                yield chosen
        if piece.stage == 0 or chosen is not None:
            n_left -= sum(area.has_piece(tile) for tile in index.plan.tiles(piece))
        else:
            parts = [part for part in index.plan.parts(piece) if area.has_piece(part)]
            waiting += reversed(parts)


class TilePoints:
    """The input's points by tile; what is read stays, as far as there is room, for other levels.

    Parameters
    ----------
    index : TileIndex
    room : int
        Bytes that may stay.
    """

    def __init__(self, index: TileIndex, room: int = KEPT_BYTES) -> None:
        self.index = index
        self._room, self._kept = room, dict[Piece, InputPoints]()

    def of_group(self, piece: Piece, area: Area) -> Iterator[InputPoints]:
        """Yield the points of each tile of a group that has a surface in an area."""
        tiles = self.index.plan.tiles(piece)
        # groups come before their parts, so no other one will ask for those beyond this one
        inside = set(tiles)
        self._kept = {tile: points for tile, points in self._kept.items() if tile in inside}
        for tile in tiles:
            record = self.index.records.get(tile, {})
            if record.get("status") == "whole" and area.has_piece(tile):
                yield self._of(tile)

    def _of(self, tile: Piece) -> InputPoints:
        from wavelet_gis.io.pyramid.pyramid_file import read_input

        if tile not in self._kept:
            points = points_of_tile(self.index, tile, read_input(self.index.path(tile)))
            if self._bytes_with(points) > self._room:
                return points
            self._kept[tile] = points
        return self._kept[tile]

    def _bytes_with(self, points: InputPoints) -> int:
        every = (*self._kept.values(), points)
        return sum(column.nbytes for one in every for column in one)


def _tile(tiles: TilePoints, area: Area, piece: Piece, limit: float) -> Chosen:
    """Return a tile, fine where it has to be."""
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

    index = tiles.index
    geo = read_pyramid(index.path(piece))
    part = mesh_of_accuracy(geo.pyramid, limit)
    points = points_of_tile(index, piece, geo)
    errors = _errors_on(part.mesh, points.places)
    counted = _counted(area, part.mesh, points, errors)
    return Chosen(piece, part.mesh, part.level, (counted,))


def _group(tiles: TilePoints, area: Area, piece: Piece, limit: float) -> Chosen | None:
    """Return the coarsest level of a group that keeps a tolerance; None where none does."""
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

    index, pyramid = tiles.index, None
    best: Chosen | None = None
    low, high = 0, int(index.records[piece]["n_levels"])
    level = high  # most tolerances are too strict for it, and the first tile tells
    while low <= high:
        if pyramid is None:
            pyramid = read_pyramid(index.path(piece)).pyramid
        mesh = pyramid.mesh(level)
        errors = _errors_within(tiles, area, piece, mesh, limit)
        if errors is not None:
            best = Chosen(piece, mesh, level, errors)
            high = level - 1
        elif best is None:
            return None
        else:
            low = level + 1
        level = (low + high) // 2
    return best


def _errors_within(
    tiles: TilePoints, area: Area, piece: Piece, mesh: TriangleMesh, limit: float
) -> tuple[PointErrors, ...] | None:
    """Return the errors of the input in a group; None once a vertex of it is beyond the limit.

    One that has no face is beyond any limit.
    """
    found = []
    for points in tiles.of_group(piece, area):
        below = _errors_on(mesh, points.places)
        of_vertices = points.vertex_heights + below[: len(points.vertex_heights)]
        if not (np.abs(of_vertices) <= limit).all():
            return None
        found.append(_counted(area, mesh, points, below))
    return tuple(found)


def _errors_on(mesh: TriangleMesh, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return minus the height of a mesh; beside it by rounding, that of its border."""
    if not mesh.n_vertices:
        return np.full(len(places), np.nan)
    extent = float(np.ptp(mesh.vertices[:, :2], axis=0).max())
    return errors_with_border(mesh, places, BESIDE * extent)


def _counted(
    area: Area, mesh: TriangleMesh, points: InputPoints, below: NDArray[np.float64]
) -> PointErrors:
    """Return the errors of the points that count: those of the area, or under its triangles."""
    if area.is_all:
        return PointErrors(points.heights + below, points.cells)
    used, faces = area.part_of(mesh)
    below = _errors_on(TriangleMesh(mesh.vertices[used], faces), points.places)
    counts = np.isfinite(below) | area.has_points(points.places)
    return PointErrors((points.heights + below)[counts], points.cells[counts])
