"""Out of a tile set: a region at a level, from the pieces that it needs, and the raster again."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_core.progress import report
from wavelet_gis.errors import InputFileError, TerrainWarning
from wavelet_gis.model.dem import Dem
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.mesh_origin import MeshOrigin
from wavelet_gis.model.terrain import Terrain, terrain_of_mesh
from wavelet_gis.notes import warn
from wavelet_gis.tiles.area import Area, Box, area_of
from wavelet_gis.tiles.index import TileIndex, open_index
from wavelet_gis.tiles.input_points import (
    is_first_tile,
    points_beside_vertices,
    points_without_surface,
)
from wavelet_gis.tiles.piece import join
from wavelet_gis.tiles.plan import Piece
from wavelet_gis.tiles.within import PointErrors, pieces_within
from wavelet_gis.workflows.extract import Surface, SurfaceErrors, errors_in_figures
from wavelet_gis.workflows.options import warn_of_error_above

__all__ = ["Region", "extract_region", "restored_raster", "terrain_of_region"]


class Region(NamedTuple):
    """A part of a tile set at one level, or within a tolerance.

    surface : Surface
        The TIN.
    pieces : tuple of Piece
        What was read for it.
    """

    surface: Surface
    pieces: tuple[Piece, ...]


def extract_region(
    index: str | os.PathLike[str] | TileIndex,
    *,
    level: int | None = None,
    max_error: float | None = None,
    bbox: Box | None = None,
    polygon: Any = None,
    progress: Progress | None = None,
) -> Region:
    """Return a region of a tile set at a level, or as coarse as a tolerance allows.

    Only the pieces that it needs are read.

    Parameters
    ----------
    index : path or TileIndex
        ``index.gpkg`` of a tile set, or its folder.
    level : int, optional
        0, the default, is the coarsest of the whole, `TileIndex.n_levels` the input.
    max_error : float, optional
        Instead: a TIN with no vertex of the input in the region farther off, vertically, in the
        input's unit of z; fine only where it has to be, out of pieces of all stages. The vertices
        of the region are read, a tile at a time.
    bbox : tuple of float, optional
        Smallest x and y, largest x and y, in the coordinates of the input. Triangles that reach
        into it are given whole. By default all.
    polygon : path, GeoDataFrame or shapely geometry, optional
        Instead: polygons, in any CRS; or a geometry in the coordinates of the input.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    Cancelled
        ``progress`` returned False.
    InputFileError
        There is no tile set, no such level, or nothing of it in the region.
    OptionError
        A region without an inside, a tolerance below 0, or more than one rule.

    Warns
    -----
    TerrainWarning
        Of pieces in the region that could not be made, so that there are holes.
    """
    found = index if isinstance(index, TileIndex) else open_index(index)
    plan = found.plan
    if level is not None and max_error is not None:
        raise OptionError("give one of {0} and {1}.", "level", "max_error")
    if level is not None and level < 0:
        raise OptionError("{0} is {level}; give 0 or more.", "level", level=level)
    if max_error is not None and not 0 <= max_error < float("inf"):
        raise OptionError(
            "{0} is {max_error}; give a distance of 0 or more.", "max_error", max_error=max_error
        )
    area = area_of(plan, bbox, polygon)
    parts = (
        _at_level(found, area, level or 0, progress)
        if max_error is None
        else _within(found, area, max_error, progress)
    )
    _warn_of_gaps(found, area, parts.stage)
    if not parts.meshes:
        raise InputFileError(
            "{path}: no tile reaches into the region; see the footprints in its index, and give "
            "another {0}.",
            area.option,
            path=found.folder,
        )
    whole = join(plan, parts.meshes, [np.ones(mesh.n_vertices) for mesh in parts.meshes])
    mesh, cells = whole.mesh, whole.cells
    if not area.is_all:
        used, faces = area.part_of(mesh)
        if not len(used):
            raise InputFileError(
                "{path}: there are no triangles in the region; give another {0}.",
                area.option,
                path=found.folder,
            )
        mesh = TriangleMesh(mesh.vertices[used], faces, mesh.attributes[used], whole.names)
        cells = cells[used]
    assert parts.geo is not None
    geo = replace(parts.geo, origin=MeshOrigin(), errors=None, notes=())
    return Region(Surface(geo, mesh, cells, parts.level, parts.errors), tuple(parts.pieces))


class _Parts(NamedTuple):
    """The pieces of a region, each at its level.

    geo : GeoPyramid, of the first; None where there is none
    level : int, of the whole; the finest of its parts
    stage : int, the coarsest that was looked at
    """

    pieces: list[Piece]
    meshes: list[TriangleMesh]
    geo: GeoPyramid | None
    level: int
    stage: int
    errors: SurfaceErrors | None


def _at_level(index: TileIndex, area: Area, level: int, progress: Progress | None) -> _Parts:
    stage, below = index.place_of(level)
    pieces = [piece for piece in index.whole(stage) if area.has_piece(piece)]
    meshes, first = [], None
    for k, piece in enumerate(pieces):
        report(progress, k / len(pieces))
        geo = _loaded(index, piece, below)
        meshes.append(geo.pyramid.mesh(_level(index, piece, below)))
        first = first or geo
    return _Parts(pieces, meshes, first, level, stage, None)


def _within(index: TileIndex, area: Area, max_error: float, progress: Progress | None) -> _Parts:
    z_scale = index.plan.local_frame.z_scale
    chosen = list(pieces_within(index, area, max_error * z_scale, progress))
    pieces = [one.piece for one in chosen]
    of_loose = [
        PointErrors(np.full(len(cells), np.nan), cells)
        for _, cells in points_without_surface(index, area)
    ]
    errors = _errors_of([*chain.from_iterable(one.errors for one in chosen), *of_loose], z_scale)
    if pieces:
        warn_of_error_above(str(index.folder), errors.max_error, None, max_error=max_error)
    return _Parts(
        pieces,
        [one.mesh for one in chosen],
        _loaded(index, pieces[0], index.levels_of(pieces[0].stage)) if pieces else None,
        max(index.levels_in_whole([(one.piece, one.level) for one in chosen]), default=0),
        index.plan.n_stages - 1,
        errors,
    )


def terrain_of_region(
    index: str | os.PathLike[str] | TileIndex,
    *,
    level: int | None = None,
    bbox: Box | None = None,
    polygon: Any = None,
) -> Terrain:
    """Return a region of a tile set as a terrain, to be made anything of that a TIN can be.

    Parameters
    ----------
    index : path or TileIndex
    level : int, optional
        By default the finest, which is all of the input in memory.
    bbox, polygon
        See `extract_region`.
    """
    found = index if isinstance(index, TileIndex) else open_index(index)
    chosen = found.n_levels if level is None else level
    mesh = extract_region(found, level=chosen, bbox=bbox, polygon=polygon).surface.mesh
    plan = found.plan
    terrain = terrain_of_mesh(
        found.folder.name, mesh, plan.coordinate_system, plan.local_frame, plan.vertical_unit
    )
    if chosen < found.n_levels:
        return terrain
    area = area_of(plan, bbox, polygon)
    return replace(terrain, merged=points_beside_vertices(found, area))


def _warn_of_gaps(index: TileIndex, area: Area, stage: int) -> None:
    """Warn where pieces of a stage, or of one before it, are not there."""
    gone = [
        piece
        for k in range(stage + 1)
        for piece in index.plan.pieces(k)
        if index.records.get(piece, {}).get("status", "missing") in ("missing", "failed")
        and area.has_piece(piece)
    ]
    if gone:
        warn(
            TerrainWarning,
            "pieces_missing",
            "{path}: {count} pieces there could not be made, the first at stage {stage}, row "
            "{row}, column {column}, and leave holes (tile again with the same options, which "
            "makes what is missing)",
            stacklevel=3,
            path=str(index.folder),
            count=len(gone),
            **gone[0]._asdict(),
        )


def _errors_of(parts: list[PointErrors], z_scale: float) -> SurfaceErrors:
    """Return the errors of all points in figures, those of several tiles counted once."""
    errors = np.concatenate([np.empty(0), *(part.errors for part in parts)])
    counts = is_first_tile([part.cells for part in parts])
    return errors_in_figures(errors[counts] / z_scale)


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
    tags: list[tuple[tuple[slice, slice], float | int | None]] = []
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
        tags.append((window, dem.nodata))
    if values is None or valid is None or first is None:
        raise InputFileError(f"{found.folder}: no tile has data.")
    nodata = _with_one_nodata(str(found.folder), values, valid, tags)
    if len(plan.files) == 1:  # which comes back with its own tag, if it has none, too
        nodata = first.nodata
    return replace(first, values=values, valid=valid, geometry=plan.geometry, nodata=nodata)


def _with_one_nodata(
    name: str,
    values: NDArray[Any],
    valid: NDArray[np.bool_],
    tags: Sequence[tuple[tuple[slice, slice], float | int | None]],
) -> float | int | None:
    """Put one number for nodata into all that has no data; return it.

    Files may have different ones, which stand in the holes of their tiles: the first that is there
    holds for all, as in a mosaic. What stood in the holes of its own tiles stays.
    """
    from wavelet_gis.io.raster.mosaic import require_free

    nodata = next((tag for _, tag in tags if tag is not None), None)
    if nodata is None and not valid.all() and values.dtype.kind == "f":
        nodata = float("nan")
    if nodata is None:
        return None
    others = [window for window, tag in tags if tag is not None and repr(tag) != repr(nodata)]
    if others:
        require_free(name, nodata, values[valid])
    for window in others:
        values[window][~valid[window]] = nodata
    outside = np.ones(values.shape, dtype=bool)
    for window, _ in tags:
        outside[window] = False
    values[outside] = nodata
    return nodata


def _level(index: TileIndex, piece: Piece, below: int) -> int:
    """Return the level of a piece that is so far below its finest, or its last one in the whole."""
    return max(int(index.records[piece]["n_levels"]) - below, index.coarsest_of(piece))


def _loaded(index: TileIndex, piece: Piece, below: int) -> GeoPyramid:
    from wavelet_gis.io.pyramid.pyramid_file import read_levels

    return read_levels(index.path(piece), _level(index, piece, below))
