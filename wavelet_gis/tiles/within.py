"""The pieces, and their levels, by which a tile set keeps a tolerance.

Of a tile set any pieces fit together that cover it once, whatever their stages and levels: the
border of a group is locked at all its levels, and so is that of the tiles beside it. So each part
of the terrain can be as coarse as the tolerance allows. A group tells its errors against what it
begins with; what counts is the distance of the input's vertices, so these are read, tile by tile.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.accuracy.between_levels import mesh_of_accuracy
from wavelet_core.metrics import surface_errors
from wavelet_gis.tiles.area import Area
from wavelet_gis.tiles.index import TileIndex
from wavelet_gis.tiles.plan import Piece

__all__ = ["Chosen", "pieces_within"]


class Chosen(NamedTuple):
    """A piece as coarse as it may be.

    piece : Piece
    mesh : TriangleMesh, in the working frame
    level : int, of the piece; the finest that is part of it
    errors : (n,) float64, of the vertices of the input in it; NaN where it has no face
    """

    piece: Piece
    mesh: TriangleMesh
    level: int
    errors: NDArray[np.float64]


def pieces_within(index: TileIndex, area: Area, limit: float) -> Iterator[Chosen]:
    """Yield the pieces of an area by which no vertex of the input is farther off.

    Parameters
    ----------
    index : TileIndex
    area : Area
    limit : float
        Vertical distance in the working frame.
    """
    top = index.plan.n_stages - 1
    waiting = [piece for piece in reversed(index.plan.pieces(top)) if area.has_piece(piece)]
    while waiting:
        piece = waiting.pop()
        status = index.records.get(piece, {}).get("status", "missing")
        if status == "whole":
            chosen = (_tile if piece.stage == 0 else _group)(index, area, piece, limit)
            if chosen is not None:
                yield chosen
                continue
        if piece.stage > 0:
            parts = [part for part in index.plan.parts(piece) if area.has_piece(part)]
            waiting += reversed(parts)


def _tile(index: TileIndex, area: Area, piece: Piece, limit: float) -> Chosen:
    """Return a tile, fine where it has to be."""
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

    pyramid = read_pyramid(index.path(piece)).pyramid
    part = mesh_of_accuracy(pyramid, limit)
    finest = pyramid.mesh(pyramid.n_levels).vertices
    return Chosen(piece, part.mesh, part.level, surface_errors(part.mesh, finest))


def _group(index: TileIndex, area: Area, piece: Piece, limit: float) -> Chosen | None:
    """Return the coarsest level of a group that keeps a tolerance; None where none does."""
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid

    pyramid = None
    best: Chosen | None = None
    low, high = 0, int(index.records[piece]["n_levels"])
    level = high  # most tolerances are too strict for it, and the first tile tells
    while low <= high:
        if pyramid is None:
            pyramid = read_pyramid(index.path(piece)).pyramid
        mesh = pyramid.mesh(level)
        errors = _errors_within(index, area, piece, mesh, limit)
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
    index: TileIndex, area: Area, piece: Piece, mesh: TriangleMesh, limit: float
) -> NDArray[np.float64] | None:
    """Return the errors of the input's vertices in a group; None once one is beyond the limit."""
    from wavelet_gis.io.pyramid.pyramid_file import read_input

    found = [np.empty(0)]
    for tile in index.plan.tiles(piece):
        if index.records.get(tile, {}).get("status") != "whole" or not area.has_piece(tile):
            continue
        points = read_input(index.path(tile)).pyramid.mesh(0).vertices
        errors = surface_errors(mesh, points)
        if np.nanmax(np.abs(errors), initial=0.0) > limit:
            return None
        found.append(errors)
    return np.concatenate(found)
