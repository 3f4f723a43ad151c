"""Out of a tile set: a region at a level, from the pieces that it needs, and the raster again."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.dem import Dem
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.mesh_origin import MeshOrigin
from wavelet_gis.tiles.index import TileIndex, open_index
from wavelet_gis.tiles.piece import join
from wavelet_gis.tiles.plan import Piece, TilePlan
from wavelet_gis.workflows.extract import Surface

__all__ = ["Region", "extract_region", "restored_raster"]

Box = tuple[float, float, float, float]


class Region(NamedTuple):
    """A part of a tile set at one level.

    surface : Surface
        The TIN.
    pieces : tuple of Piece
        What was read for it.
    """

    surface: Surface
    pieces: tuple[Piece, ...]


def extract_region(
    index: str | os.PathLike[str] | TileIndex, *, level: int = 0, bbox: Box | None = None
) -> Region:
    """Return a region of a tile set at a level; only the pieces that it needs are read.

    Parameters
    ----------
    index : path or TileIndex
        ``index.gpkg`` of a tile set, or its folder.
    level : int
        0 is the coarsest of the whole, `TileIndex.n_levels` the input.
    bbox : tuple of float, optional
        Smallest x and y, largest x and y, in the coordinates of the input. Triangles that reach
        into it are given whole. By default all.

    Raises
    ------
    InputFileError
        There is no tile set, no such level, or nothing of it in the region.
    OptionError
        A region without an inside.
    """
    found = index if isinstance(index, TileIndex) else open_index(index)
    if level < 0:
        raise OptionError("{0} is {level}; give 0 or more.", "level", level=level)
    if bbox is not None and not (bbox[0] < bbox[2] and bbox[1] < bbox[3]):
        raise OptionError(
            "{0} is {bbox}; give the smallest x and y, then the largest.", "bbox", bbox=list(bbox)
        )
    stage, below = found.place_of(level)
    pieces = [piece for piece in found.whole(stage) if _reaches(found.plan, piece, bbox)]
    geos = [_loaded(found, piece, below) for piece in pieces]
    meshes = [
        geo.pyramid.mesh(_level(found, piece, below))
        for piece, geo in zip(pieces, geos, strict=True)
    ]
    if not meshes:
        raise InputFileError(
            "{path}: no tile reaches into the region; see the footprints in its index, and give "
            "another {0}.",
            "bbox",
            path=found.folder,
        )
    whole = join(found.plan, meshes, [np.ones(mesh.n_vertices) for mesh in meshes])
    vertices, faces, cells = whole.vertices, whole.faces, whole.cells
    attributes = whole.attributes
    if bbox is not None:
        places = found.plan.local_frame.to_file(vertices)[:, :2][faces]
        reaches = (places.min(axis=1) <= bbox[2:]) & (places.max(axis=1) >= bbox[:2])
        used, faces = np.unique(faces[reaches.all(axis=1)], return_inverse=True)
        vertices, faces, cells = vertices[used], faces.reshape(-1, 3), cells[used]
        attributes = attributes[used]
        if not len(faces):
            raise InputFileError(
                "{path}: there are no triangles in the region; give another {0}.",
                "bbox",
                path=found.folder,
            )
    mesh = TriangleMesh(vertices, faces, attributes, whole.names)
    geo = replace(geos[0], origin=MeshOrigin(), errors=None, notes=())
    return Region(Surface(geo, mesh, cells, level), tuple(pieces))


def restored_raster(index: str | os.PathLike[str] | TileIndex) -> Dem:
    """Return the raster that a tile set was made from, each tile synthesised exactly.

    Parameters
    ----------
    index : path or TileIndex
        ``index.gpkg`` of a tile set, or its folder.

    Raises
    ------
    InputFileError
        There is no tile set, or a tile of it is missing.
    PyramidError
        A tile's checksum is another.
    """
    from wavelet_gis.io.pyramid.pyramid_file import read_input
    from wavelet_gis.workflows.reconstruct import reconstruct

    found = index if isinstance(index, TileIndex) else open_index(index)
    plan = found.plan
    if plan.points is not None:
        raise InputFileError(
            f"{found.folder}: these are tiles of point clouds, not of a raster; use restore_source."
        )
    values = valid = first = None
    for piece in plan.pieces(0):
        status = found.records.get(piece, {}).get("status", "missing")
        if status == "empty":
            continue
        if status != "whole":
            raise InputFileError(
                f"{found.folder}: the tile in row {piece.row}, column {piece.column} is {status}; "
                "tile again with the same options, which makes what is missing."
            )
        dem = reconstruct(read_input(found.path(piece))).original
        assert isinstance(dem, Dem)
        if values is None or valid is None or first is None:
            first = dem
            values = np.zeros(plan.shape, dtype=dem.values.dtype)
            valid = np.zeros(plan.shape, dtype=bool)
        top, left, bottom, right = plan.cells(piece)
        window = (slice(top, bottom + 1), slice(left, right + 1))
        values[window], valid[window] = dem.values, dem.valid
    if values is None or valid is None or first is None:
        raise InputFileError(f"{found.folder}: no tile has data.")
    nodata = first.nodata
    if nodata is None and not valid.all() and values.dtype.kind == "f":
        nodata = float("nan")
    if nodata is not None:
        outside = np.ones(plan.shape, dtype=bool)
        for piece in found.whole(0):
            top, left, bottom, right = plan.cells(piece)
            outside[top : bottom + 1, left : right + 1] = False
        values[outside] = nodata
    return replace(first, values=values, valid=valid, geometry=plan.geometry, nodata=nodata)


def _level(index: TileIndex, piece: Piece, below: int) -> int:
    """Return the level of a piece that is so far below its finest, or its coarsest."""
    return max(int(index.records[piece]["n_levels"]) - below, 0)


def _loaded(index: TileIndex, piece: Piece, below: int) -> GeoPyramid:
    from wavelet_gis.io.pyramid.pyramid_file import read_levels

    return read_levels(index.path(piece), _level(index, piece, below))


def _reaches(plan: TilePlan, piece: Piece, bbox: Box | None) -> bool:
    """Return whether the cells of a piece, or its border, reach into a box."""
    if bbox is None:
        return True
    top, left, bottom, right = plan.cells(piece)
    if plan.points is not None:
        in_rows, in_columns = plan.points.reach_in_cells
        top, left, bottom, right = (
            top - in_rows,
            left - in_columns,
            bottom + in_rows,
            right + in_columns,
        )
    x, y = plan.geometry.centres(
        np.array([left, right, right, left], dtype=np.float64),
        np.array([top, top, bottom, bottom], dtype=np.float64),
    )
    return bool(
        x.min() <= bbox[2] and x.max() >= bbox[0] and y.min() <= bbox[3] and y.max() >= bbox[1]
    )
