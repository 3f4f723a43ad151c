"""The work on one piece, by itself in whatever process: a tile, or a group of four.

A tile is an ordinary pyramid of its cells, or of its points, with the vertices on the border that
it shares with its neighbours locked, so that both keep them at every level. A group begins with
a coarse level of each of its parts, put together vertex by vertex; the lines between them are free
now, those around the group are locked. The integrals of the scaling functions go on from the
parts, so that their sum with the coefficients is that of the input at every level of the whole.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Cancelled, Progress, PyramidError, TriangleMesh, WaveletError
from wavelet_core import analyse as core_analyse
from wavelet_core.progress import part_of
from wavelet_gis._fields import holds_fields
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.atomic import new_file
from wavelet_gis.io.read_back import write_bytes, write_text
from wavelet_gis.model.dem import Dem, dem_mesh
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.mesh_origin import MeshOrigin
from wavelet_gis.model.raster_origin import RasterOrigin
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.notes import collected
from wavelet_gis.tiles.kept_levels import keep_levels, kept_levels
from wavelet_gis.tiles.plan import PLAN, Piece, TilePlan
from wavelet_gis.workflows.analyse import analyse
from wavelet_gis.workflows.save import write_pyramid_file

__all__ = [
    "LOOSE",
    "PIECES",
    "Joined",
    "ReadDem",
    "cells_of",
    "handed_on",
    "join",
    "level_handed_on",
    "make_piece",
    "read_record",
    "sha256_of",
]

#: Reads part of a raster, as `wavelet_gis.io.raster.read_dem` does.
ReadDem = Callable[..., tuple[Dem, Any]]

#: Folder of the files of the pieces.
PIECES = "pieces"

#: Suffix of the file of a tile whose points have no surface.
LOOSE = ".points"

#: What GeoPackages are dated by, where it is set.
_EPOCH = "SOURCE_DATE_EPOCH"

_BYTES_AT_ONCE = 1 << 22

#: Points at which the errors of each level of a group of more than four tiles are measured.
POINTS_MEASURED = 200_000

#: Points of the input, in those of a tile, that a group knows besides its vertices. All that four
#: tiles have take 150 bytes for each vertex that a group begins with, whose analysis takes 400.
POINTS_OF_GROUP = 4.0

#: Parts of the time of a piece that have gone when it is written, and of the time of making a
#: group's pyramid when its errors are measured.
BEFORE_WRITING, BEFORE_ERRORS = 0.75, 0.85

#: What a record has, by its status; one that lacks it is damaged, and counts as none.
_FIELDS: dict[str, dict[str, type]] = {
    "whole": {"sha256": str, "n_bytes": int, "n_levels": int, "sizes": list},
    "loose": {"sha256": str, "n_bytes": int},
    "empty": {},
    "failed": {"stage": int, "row": int, "column": int, "reason": str},
}


class Joined(NamedTuple):
    """Meshes of several pieces as one.

    vertices : (n, 3) float64, in the working frame
    faces : (m, 3) int64
    cells : (n,) int64, of the vertices in the grid of all, row by row; ascending
    integrals : (n,) float64
    attributes : (n, k) float64
    names : tuple of str, of the attributes
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    cells: NDArray[np.int64]
    integrals: NDArray[np.float64]
    attributes: NDArray[np.float64]
    names: tuple[str, ...]

    @property
    def mesh(self) -> TriangleMesh:
        """The mesh."""
        return TriangleMesh(self.vertices, self.faces, self.attributes, self.names)


def make_piece(
    folder: str,
    piece: Piece,
    inputs: dict[str, str],
    read: ReadDem | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Make the pyramid of a piece and its record; return the record.

    Parameters
    ----------
    folder : str
        Of the tile set, with its plan.
    piece : Piece
    inputs : dict of str to str
        What it is made from, and a checksum or the like of each, for the record; of the parts of a
        group also the level that it begins with, see `handed_on`.
    read : callable, optional
        What reads rasters; by default `wavelet_gis.io.raster.read_dem`.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    Both files are written aside and renamed, the record last: whoever finds it finds the whole.
    What is wrong with a piece stands in the record, which then names no file.
    """
    path = Path(folder) / PLAN
    plan = TilePlan.from_json(path.read_text("utf-8"), str(path))
    began = perf_counter()
    record: dict[str, Any] = {
        "stage": piece.stage,
        "row": piece.row,
        "column": piece.column,
        "plan": plan.checksum,
        "inputs": inputs,
    }
    place = Path(folder) / PIECES / f"{piece.name}.gpkg"
    place.parent.mkdir(parents=True, exist_ok=True)
    try:
        with collected(), _dated(plan):
            made = _made(folder, plan, piece, inputs, read, part_of(progress, 0.0, BEFORE_WRITING))
            geo = made.geo
            if geo is None and made.points is not None:
                rest = place.with_suffix(LOOSE)
                with new_file(rest, overwrite=True) as scratch:
                    write_bytes(scratch, made.points)
                record |= {"status": "loose", "sha256": sha256_of(rest)}
                record["n_bytes"] = rest.stat().st_size
            elif geo is None:
                record |= {"status": "empty"}
            else:
                with new_file(place, overwrite=True) as scratch:
                    write_pyramid_file(scratch, geo, "none", part_of(progress, BEFORE_WRITING, 1.0))
                record |= {"status": "whole", **_figures(geo), "sha256": sha256_of(place)}
                record["n_bytes"] = place.stat().st_size
                if piece.stage + 1 < plan.n_stages:
                    keep_levels(folder, piece.name, record["sha256"], geo.pyramid)
    except Cancelled:
        raise
    except (WaveletError, OSError) as error:  # a full disk, of whatever kind
        record |= {"status": "failed", "reason": " ".join(str(error).split())}
    record["seconds"] = round(perf_counter() - began, 3)
    with new_file(place.with_suffix(".json"), overwrite=True) as scratch:
        write_text(scratch, json.dumps(record, sort_keys=True))
    return record


@contextmanager
def _dated(plan: TilePlan) -> Iterator[None]:
    """Date files by the newest input, so that a piece made again has the same bytes."""
    if _EPOCH in os.environ:
        yield
        return
    os.environ[_EPOCH] = str(max(file.changed for file in plan.files) // 10**9)
    try:
        yield
    finally:
        del os.environ[_EPOCH]


def read_record(folder: str | os.PathLike[str], piece: Piece) -> dict[str, Any] | None:
    """Return the record of a piece; None where there is none that can be read."""
    path = Path(folder) / PIECES / f"{piece.name}.json"
    try:
        record = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    return record if holds_fields(record, _FIELDS) else None


def sha256_of(path: str | os.PathLike[str]) -> str:
    """Return the SHA-256 of a file."""
    digest = hashlib.sha256()
    with open(path, "rb") as stream:
        while block := stream.read(_BYTES_AT_ONCE):
            digest.update(block)
    return digest.hexdigest()


def cells_of(plan: TilePlan, mesh: TriangleMesh) -> NDArray[np.int64]:
    """Return the cells of the vertices of a mesh, counted row by row in the grid of all.

    Raises
    ------
    PyramidError
        A vertex that is at no cell.
    """
    frame = plan.local_frame
    x, y = frame.file_x(mesh.vertices[:, 0]), frame.file_y(mesh.vertices[:, 1])
    columns, rows = plan.geometry.cells(x, y)
    whole_rows, whole_columns = np.rint(rows), np.rint(columns)
    off = max(np.abs(rows - whole_rows).max(), np.abs(columns - whole_columns).max())
    n_rows, n_columns = plan.shape
    inside = (whole_rows >= 0) & (whole_rows < n_rows)
    inside &= (whole_columns >= 0) & (whole_columns < n_columns)
    if off > 1e-3 or not inside.all():
        raise PyramidError("a piece has vertices that are no cells of the plan; tile anew.")
    cells: NDArray[np.int64] = (whole_rows * n_columns + whole_columns).astype(np.int64)
    return cells


def join(
    plan: TilePlan, meshes: list[TriangleMesh], integrals: list[NDArray[np.float64]]
) -> Joined:
    """Return the meshes of pieces as one, each cell one vertex.

    Parameters
    ----------
    plan : TilePlan
    meshes : list of TriangleMesh
        In the working frame.
    integrals : list of (n_vertices,) float64
        Of their scaling functions.

    Raises
    ------
    PyramidError
        Two pieces that have another height at the same cell.
    """
    cells = [cells_of(plan, mesh) for mesh in meshes]
    unique, first, place = np.unique(np.concatenate(cells), return_index=True, return_inverse=True)
    place = place.ravel()
    signal = np.concatenate([np.hstack([m.vertices[:, 2:], m.attributes]) for m in meshes])
    if (signal[first][place] != signal).any():
        raise PyramidError("two pieces have other heights at the same cell; tile anew.")
    starts = np.cumsum([0, *(mesh.n_vertices for mesh in meshes)])
    faces = np.concatenate(
        [place[start + mesh.faces] for start, mesh in zip(starts[:-1], meshes, strict=True)]
    )
    # A cell that several pieces have was given the integral 1 in each, and counts once.
    counted = np.bincount(place, np.concatenate(integrals)) - (np.bincount(place) - 1.0)
    vertices = np.column_stack([_in_frame(plan, unique), signal[first, 0]])
    return Joined(vertices, faces, unique, counted, signal[first, 1:], meshes[0].attribute_names)


def _in_frame(plan: TilePlan, cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return x and y of cells in the working frame, the same wherever they are asked for."""
    rows, columns = np.divmod(cells, plan.shape[1])
    x, y = plan.places(rows, columns)
    frame = plan.local_frame
    return np.column_stack([frame.local_x(x), frame.local_y(y)])


class _Made(NamedTuple):
    """The pyramid of a piece, or None; then, of a tile, the points in it, where it has some."""

    geo: GeoPyramid | None
    points: bytes | None = None


def _made(
    folder: str,
    plan: TilePlan,
    piece: Piece,
    inputs: dict[str, str],
    read: ReadDem | None,
    progress: Progress | None,
) -> _Made:
    if piece.stage > 0:
        return _Made(_group(folder, plan, piece, inputs, progress))
    if plan.points is None:
        return _Made(_tile(plan, piece, read, progress))
    from wavelet_gis.tiles.cloud.tile import cloud_tile, tile_pyramid

    tile = cloud_tile(folder, plan, piece)
    if tile is None:
        return _Made(None)
    geo = tile_pyramid(plan, piece, tile, progress)
    return _Made(geo, None if geo is not None else tile.points.to_bytes())


def _tile(
    plan: TilePlan, piece: Piece, read: ReadDem | None, progress: Progress | None
) -> GeoPyramid | None:
    """Return the pyramid of a tile; None where it has no data.

    Cells by themselves are vertices without faces, and stay so.
    """
    dem = tile_dem(plan, piece, read)
    if dem is None or not dem.valid.any():
        return None
    mesh = dem_mesh(dem, plan.local_frame)
    top, left, _, _ = plan.cells(piece)
    rows, columns = np.nonzero(dem.valid)
    locked = plan.is_shared(piece, rows + top, columns + left)
    terrain = Terrain(
        piece.name,
        mesh,
        dem,
        RasterOrigin.from_dem(dem),
        plan.coordinate_system,
        plan.local_frame,
        plan.vertical_unit,
    )
    options = plan.options_of(piece, mesh.n_vertices)
    return analyse(terrain, locked=locked, progress=progress, **options).geo


def handed_on(checksum: str, level: int) -> str:
    """Return what a group's record says of a part: its checksum, and the level it begins with."""
    return f"{checksum}@{level}"


def level_handed_on(text: str) -> int:
    """Return the level that `handed_on` was given; tile sets of before began with the coarsest."""
    level = text.partition("@")[2]
    return int(level) if level.isdecimal() else 0


def _group(
    folder: str,
    plan: TilePlan,
    piece: Piece,
    inputs: dict[str, str],
    progress: Progress | None,
) -> GeoPyramid | None:
    """Return the pyramid of a group; None where none of its parts has a surface."""
    from wavelet_gis.io.pyramid.pyramid_file import read_levels

    meshes, integrals = [], []
    for name, text in inputs.items():
        path = Path(folder) / PIECES / f"{name}.gpkg"
        level = level_handed_on(text)
        checksum = sha256_of(path)
        if handed_on(checksum, level) != text:
            raise InputFileError(f"{path}: this is not the file that was made; tile anew.")
        pyramid = kept_levels(folder, name, checksum, level)
        if pyramid is None:
            pyramid = read_levels(path, level).pyramid
        meshes.append(pyramid.mesh(level))
        integrals.append(pyramid.integrals(level))
    if not meshes:
        return None
    whole = join(plan, meshes, integrals)
    points, sample = _points_of(folder, plan, piece, whole.cells)
    rows, columns = np.divmod(whole.cells, plan.shape[1])
    locked = plan.is_shared(piece, rows, columns)
    if plan.points is not None:  # they are on no line, but on the outline near one
        locked &= ~_is_inside(whole.faces, len(whole.cells))
    pyramid = core_analyse(
        whole.mesh,
        locked=locked,
        integrals=whole.integrals,
        points=points if plan.is_error_guided else None,
        progress=part_of(progress, 0.0, BEFORE_ERRORS),
        **plan.options_of(piece, len(whole.cells)),
    )
    geo = GeoPyramid(
        pyramid=pyramid,
        system=plan.coordinate_system,
        frame=plan.local_frame,
        vertical_unit=plan.vertical_unit,
        origin=MeshOrigin(),
        source_name=piece.name,
    )
    # The analysis of a group of four tiles has measured its levels at all points of the input; that
    # of a larger one knows part of them, and all that are its vertices, which would count too much.
    is_all = plan.is_error_guided and piece.stage == 1
    measuring = part_of(progress, BEFORE_ERRORS, 1.0)
    return geo.with_errors(measuring, points=None if is_all else sample)


def _points_of(
    folder: str, plan: TilePlan, piece: Piece, vertices: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the points of the input that a group knows, and x, y, z of those it is measured at.

    It knows about as many as four tiles have: all of them in a group of four tiles, beyond that the
    same part of each, in no order, and those that it has ``vertices`` at, by their cells. Errors
    are measured at a part of them all, in no order either.
    """
    from wavelet_gis.io.pyramid.pyramid_file import read_input

    share = POINTS_OF_GROUP / 4.0**piece.stage
    found, cells = [], []
    for tile in plan.tiles(piece):
        record = read_record(folder, tile)
        if record is None or record["status"] != "whole":
            continue
        mesh = read_input(Path(folder) / PIECES / f"{tile.name}.gpkg").pyramid.mesh(0)
        of_tile = cells_of(plan, mesh)
        is_taken = _scattered(of_tile) < share
        if share < 1.0:
            place = np.minimum(np.searchsorted(vertices, of_tile), len(vertices) - 1)
            is_taken |= vertices[place] == of_tile
        cells.append(of_tile[is_taken])
        found.append(np.hstack([mesh.vertices[:, 2:], mesh.attributes])[is_taken])
    unique, first = np.unique(np.concatenate(cells), return_index=True)  # two tiles have a border
    points = np.hstack([_in_frame(plan, unique), np.concatenate(found)[first]])
    order = _scattered(unique)
    n_known = max(int(np.count_nonzero(order < share)), 1)
    return points, points[order < share * min(POINTS_MEASURED / n_known, 1.0), :3]


def _scattered(cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return a number in [0, 1) for each cell, without order: a Weyl sequence, mixed."""
    key = cells.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    key ^= key >> np.uint64(32)
    return (key * np.uint64(0xD6E8FEB86659FD93) >> np.uint64(11)) / 2.0**53


def _is_inside(faces: NDArray[np.int64], n_vertices: int) -> NDArray[np.bool_]:
    """Return which vertices have faces all around them."""
    tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    directed = np.sort(tails * n_vertices + heads)
    reverse = heads * n_vertices + tails
    at = np.minimum(np.searchsorted(directed, reverse), len(directed) - 1)
    on_outline = directed[at] != reverse
    inside = np.bincount(tails, minlength=n_vertices) > 0
    inside[tails[on_outline]] = False
    inside[heads[on_outline]] = False
    return inside


def tile_dem(plan: TilePlan, piece: Piece, read: ReadDem | None = None) -> Dem | None:
    """Return the cells of a tile, of whatever files have them; None where none has."""
    from wavelet_gis.io.raster import CellWindow, read_dem
    from wavelet_gis.io.raster.mosaic import mosaic

    read = read or read_dem
    top, left, bottom, right = plan.cells(piece)
    names, dems = [], []
    for file in plan.files:
        first_row, last_row = max(top, file.row), min(bottom, file.row + file.height - 1)
        first_column = max(left, file.column)
        last_column = min(right, file.column + file.width - 1)
        if first_row > last_row or first_column > last_column:
            continue
        stat = os.stat(file.path)
        if (stat.st_size, stat.st_mtime_ns) != (file.n_bytes, file.changed):
            raise InputFileError(f"{file.path}: this file has changed since; tile anew.")
        window = CellWindow(
            first_row - file.row,
            first_column - file.column,
            last_row - first_row + 1,
            last_column - first_column + 1,
        )
        dem, _ = read(file.path, window=window, **plan.reading)
        names.append(file.path)
        dems.append(dem)
    if not dems:
        return None
    part = mosaic(names, dems) if dems[1:] else dems[0]
    return _in_place(plan, part, top, left, bottom, right)


def _in_place(plan: TilePlan, part: Dem, top: int, left: int, bottom: int, right: int) -> Dem:
    """Return the cells of a window, of which a part is known, in the grid of all."""
    from dataclasses import replace

    shape = (bottom - top + 1, right - left + 1)
    geometry = plan.geometry.window(top, left, shape)
    if part.values.shape == shape:
        return replace(part, geometry=geometry)
    x, y = part.geometry.centres(np.zeros(1), np.zeros(1))
    columns, rows = geometry.cells(x, y)
    row, column = round(float(rows[0])), round(float(columns[0]))
    nodata = part.nodata
    if nodata is None and part.values.dtype.kind == "f":
        nodata = float("nan")
    values = np.full(shape, 0 if nodata is None else nodata, dtype=part.values.dtype)
    valid = np.zeros(shape, dtype=bool)
    window = (slice(row, row + part.values.shape[0]), slice(column, column + part.values.shape[1]))
    values[window], valid[window] = part.values, part.valid
    return replace(part, values=values, valid=valid, geometry=geometry, nodata=nodata)


def _figures(geo: GeoPyramid) -> dict[str, Any]:
    pyramid, errors = geo.pyramid, geo.errors_at(0)
    coarsest = pyramid.mesh(0)
    figures: dict[str, Any] = {
        "n_levels": pyramid.n_levels,
        "sizes": [pyramid.n_vertices(level) for level in range(len(pyramid))],
    }
    if errors is not None:
        figures |= {"rmse": errors.rmse_surface, "max_error": errors.max_error_surface}
    figures["rmse_by_level"] = [
        0.0 if row is None else float(np.nan_to_num(row.rmse_surface))
        for row in map(geo.errors_at, range(len(pyramid)))
    ]
    figures["n_points"] = float(pyramid.integrals(pyramid.n_levels).sum())
    integral = float(pyramid.integrals(0) @ coarsest.vertices[:, 2])
    return {**figures, "integral": integral}
