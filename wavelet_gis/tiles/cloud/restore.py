"""The files that tiles of points were made from, written again from the tiles."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from wavelet_gis._fields import Fields
from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.io.atomic import new_file
from wavelet_gis.io.las.cloud_reader import laspy_header, masks_aside, require_laspy
from wavelet_gis.io.las.cloud_writer import record_array, write_records
from wavelet_gis.io.las.layout import parse_layout
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.tiles.cloud.cut import SOURCES, CutPoints, record_dtype, source_record
from wavelet_gis.tiles.cloud.tile import FILE, ROW
from wavelet_gis.tiles.index import TileIndex
from wavelet_gis.tiles.piece import LOOSE, PIECES, sha256_of
from wavelet_gis.tiles.plan import Piece
from wavelet_gis.workflows.reconstruct import reconstruct

__all__ = ["loose_points", "n_chosen", "names_of_sources", "restore_source"]


def names_of_sources(index: TileIndex) -> list[str]:
    """Return a name for each input, that of its file; where two have the same, with a number.

    Names that differ in capitals only are the same to some systems.
    """
    names: list[str] = []
    taken: set[str] = set()
    for file in index.plan.files:
        stem, suffix = os.path.splitext(os.path.basename(file.path))
        if stem.lower().endswith(".copc"):
            stem = stem[:-5]
        name, k = f"{stem}{suffix}", 2
        while name.casefold() in taken:
            name, k = f"{stem}_{k}{suffix}", k + 1
        names.append(name)
        taken.add(name.casefold())
    return names


def n_chosen(index: TileIndex, number: int) -> tuple[int, int]:
    """Return how many points of an input the tiles have, and how many it had.

    Parameters
    ----------
    index : TileIndex
    number : int
        Of the input in the plan.

    Raises
    ------
    InputFileError
        It was not cut.
    """
    source = _source_of(index, number)
    return source.integer("n_points"), source.integer("n_in_file")


def restore_source(
    index: TileIndex, number: int, path: str | os.PathLike[str], *, overwrite: bool = False
) -> int:
    """Write one of the inputs again, from the tiles that have its points; return how many.

    Parameters
    ----------
    index : TileIndex
    number : int
        Of the input in the plan.
    path : path
        ``.las`` or ``.laz``. A LAS file comes back byte for byte; of a LAZ file every point, in its
        place, and all that is around the points.
    overwrite : bool
        Whether a file that exists there may be replaced.

    Raises
    ------
    InputFileError
        A tile is missing, or not all of the points are in the tiles.
    PyramidError
        A tile's checksum is another.
    OutputFileError
        The file cannot be written.
    """
    folder, source = index.folder, _source_of(index, number)
    n_points = source.integer("n_points")
    if n_points == 0:
        raise InputFileError(
            f"{folder}: no point of {index.plan.files[number].path} was chosen; there is nothing "
            "to write."
        )
    head = folder / SOURCES / f"{number:05d}.head"
    tail = (folder / SOURCES / f"{number:05d}.tail").read_bytes()
    layout = parse_layout(str(head), head.read_bytes())
    if n_points > layout.n_points:
        raise source.fault(f"n_points is {n_points}, the file had {layout.n_points}")
    dtype = record_dtype(folder, number)
    shifts = source.integers("shift", -(2**32), 2**32)
    with (
        new_file(path, overwrite=overwrite) as scratch,
        tempfile.TemporaryFile(dir=scratch.parent) as room,
    ):
        try:
            _make_room(room, n_points * dtype.itemsize)
        except OSError as error:
            raise OutputFileError(f"{path}: there is no room for the points ({error}).") from error
        records: NDArray[Any] = np.memmap(room, dtype, "r+", shape=(n_points,))
        is_there = np.zeros(n_points, dtype=bool)
        for part in _parts(index, number, dtype):
            rows = part.row[part.file == number]
            if len(rows) and (rows.min() < 0 or rows.max() >= n_points):
                raise InputFileError(f"{folder}: a tile has points that no input has; tile anew.")
            of_file = part.records[part.file == number].copy()
            for axis, shift in zip("XYZ", shifts, strict=True):
                of_file[axis] = of_file[axis].astype(np.int64) - shift
            records[rows] = of_file
            is_there[rows] = True
        if not is_there.all():
            raise InputFileError(
                f"{folder}: {np.count_nonzero(~is_there)} points of "
                f"{index.plan.files[number].path} are in no tile; tile anew."
            )
        write_records(
            scratch,
            layout,
            records,
            tail,
            None if source["tail_at"] is None else source.integer("tail_at"),
            is_altered=n_points != source.integer("n_in_file"),
        )
    return n_points


def loose_points(index: TileIndex, piece: Piece) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the points of a tile that have no surface, and their cells in the grid of all.

    Parameters
    ----------
    index : TileIndex
    piece : Piece
        A tile whose record says ``loose``.

    Returns
    -------
    places : (n, 3) float64
        In the working frame; without what is left aside, such as noise.
    cells : (n,) int64
    """
    plan = index.plan
    lattice, reading, frame = plan.points, plan.reading, plan.local_frame
    assert lattice is not None
    number = plan.inputs_of(piece)[0]
    head = index.folder / SOURCES / f"{number:05d}.head"
    layout = parse_layout(str(head), head.read_bytes())
    points = _loose(index, piece, record_dtype(index.folder, number))
    records = require_laspy().PackedPointRecord(
        points.records, laspy_header(str(head), layout).point_format
    )
    withheld, noise = masks_aside(
        records, reading["classes"], reading["keep_noise"], reading["keep_withheld"]
    )
    used = points.records[~(withheld | noise)]
    rows = used["Y"].astype(np.int64) - lattice.first[0]
    columns = used["X"].astype(np.int64) - lattice.first[1]
    x, y = plan.places(rows, columns)
    z = used["Z"] * lattice.scales[2] + lattice.offsets[2]
    places = np.column_stack([frame.local_x(x), frame.local_y(y), frame.local_z(z)])
    return places, rows * plan.shape[1] + columns


def _source_of(index: TileIndex, number: int) -> Fields:
    """Return the record of the cut of an input."""
    name = index.plan.files[number].path
    record = source_record(index.folder, number)
    if record is None or record["status"] != "whole":
        raise InputFileError(
            f"{index.folder}: {name} was not cut; tile again with the same options, which makes "
            "what is missing."
        )
    return Fields(record, f"the cut of {name}", InputFileError)


def _make_room(room: IO[bytes], n_bytes: int) -> None:
    """Let a file have so many bytes on the disk, where the system can promise them.

    On a disk that is full, writing to a map of bytes that are not there ends by a signal.
    """
    room.truncate(n_bytes)
    try:
        os.posix_fallocate(room.fileno(), 0, n_bytes)
    except AttributeError:  # Windows and macOS
        return
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.EOPNOTSUPP):  # such a file system
            raise


def _parts(index: TileIndex, number: int, dtype: np.dtype[Any]) -> Iterator[CutPoints]:
    """Yield the points of the tiles that an input has points in."""
    from wavelet_gis.io.pyramid.pyramid_file import read_input

    for piece, numbers in index.plan.inputs_of_tiles().items():
        if number not in numbers:
            continue
        record = index.records.get(piece, {})
        status = record.get("status", "missing")
        if status == "empty":
            continue
        if status == "loose":
            yield _loose(index, piece, dtype)
            continue
        if status != "whole":
            raise _missing(index, piece, status)
        cloud = reconstruct(read_input(index.path(piece))).original
        assert isinstance(cloud, PointCloud)
        yield CutPoints(record_array(cloud), cloud.carried[FILE], cloud.carried[ROW])


def _loose(index: TileIndex, piece: Piece, dtype: np.dtype[Any]) -> CutPoints:
    """Return the points of a tile that have no surface, as they came."""
    path = index.folder / PIECES / f"{piece.name}{LOOSE}"
    if not path.is_file() or sha256_of(path) != index.records[piece]["sha256"]:
        raise _missing(index, piece, "not the file that was made")
    return CutPoints.from_bytes(path.read_bytes(), dtype)


def _missing(index: TileIndex, piece: Piece, what: str) -> InputFileError:
    return InputFileError(
        f"{Path(index.folder)}: the tile in row {piece.row}, column {piece.column} is {what}; "
        "tile again with the same options, which makes what is missing."
    )
