"""The cut: the points of a file put beside one another by tile, read once and a batch at a time.

For each input there is, while tiles are made, a file ``cut/00003.points``: the records of one tile
after the other, of each batch, with the rows that they have in the input. A tile gets the points
within `PointLattice.reach` of it too, from which it finds its borders. What the input is written
back with stays: ``sources/00003.head``, ``.tail`` and a record, ``.json``.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import WaveletError
from wavelet_gis._fields import holds_fields
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.atomic import new_file
from wavelet_gis.io.las.batches import each_batch, read_head
from wavelet_gis.io.las.cloud_reader import laspy_header, require_laspy
from wavelet_gis.io.las.layout import parse_layout
from wavelet_gis.io.read_back import recorded_stream, write_bytes, write_text
from wavelet_gis.notes import collected
from wavelet_gis.tiles.cloud.plan import shift_of
from wavelet_gis.tiles.plan import PLAN, Piece, SourceFile, TilePlan

__all__ = [
    "CUT",
    "SOURCES",
    "CutPoints",
    "is_cut",
    "make_cut",
    "points_of",
    "record_dtype",
    "source_record",
    "stamp_of",
]

#: Folders of the cut, which is thrown away at the end, and of what is kept of the inputs.
CUT, SOURCES = "cut", "sources"

#: What a record has, by its status; one that lacks it is damaged, and counts as none.
_FIELDS: dict[str, dict[str, type]] = {
    "whole": {"n_points": int, "n_in_file": int, "n_bytes": int, "shift": list, "slices": list},
    "failed": {"reason": str},
}

#: Points read at once.
_BATCH = 1_000_000


class CutPoints(NamedTuple):
    """The points in and around a tile, in the order of the files.

    records : (n,) structured array, as the files store them, with the coordinates of the first
    file : (n,) int32, which file each is of
    row : (n,) int64, its row there
    """

    records: NDArray[Any]
    file: NDArray[np.int32]
    row: NDArray[np.int64]

    def to_bytes(self) -> bytes:
        """Return all of it as bytes, for `from_bytes`."""
        return b"".join(
            np.ascontiguousarray(column).tobytes()
            for column in (self.file.astype("<i4"), self.row.astype("<i8"), self.records)
        )

    @classmethod
    def from_bytes(cls, content: bytes, dtype: np.dtype[Any]) -> CutPoints:
        """Return the points that `to_bytes` wrote.

        Parameters
        ----------
        content : bytes
        dtype : dtype
            Of the records.
        """
        n_points = len(content) // (12 + dtype.itemsize)
        file = np.frombuffer(content, "<i4", n_points)
        row = np.frombuffer(content, "<i8", n_points, 4 * n_points)
        return cls(np.frombuffer(content, dtype, n_points, 12 * n_points), file, row)


def stamp_of(file: SourceFile) -> str:
    """Return size and time of an input, by which it is known again."""
    return f"{file.n_bytes} bytes of {file.changed}"


def source_record(folder: str | os.PathLike[str], number: int) -> dict[str, Any] | None:
    """Return the record of an input's cut; None where there is none that can be read."""
    try:
        record = json.loads((Path(folder) / SOURCES / f"{number:05d}.json").read_text("utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    return record if holds_fields(record, _FIELDS) else None


def is_cut(folder: str | os.PathLike[str], plan: TilePlan, number: int) -> bool:
    """Return whether the points of an input are there by tile, all of them."""
    record = source_record(folder, number)
    points = Path(folder) / CUT / f"{number:05d}.points"
    return (
        record is not None
        and record["status"] == "whole"
        and record.get("plan") == plan.checksum
        and record.get("input") == stamp_of(plan.files[number])
        and points.is_file()
        and points.stat().st_size == record["n_bytes"]
    )


def make_cut(folder: str, number: int) -> dict[str, Any]:
    """Cut an input by tiles, and return the record.

    Parameters
    ----------
    folder : str
        Of the tile set, with its plan.
    number : int
        Of the input in the plan.

    Notes
    -----
    As with pieces, files are written aside and renamed, the record last, and what is wrong is noted
    in the record.
    """
    path = Path(folder) / PLAN
    plan = TilePlan.from_json(path.read_text("utf-8"), str(path))
    file = plan.files[number]
    record: dict[str, Any] = {"plan": plan.checksum, "input": stamp_of(file), "source": file.path}
    for name in (CUT, SOURCES):
        (Path(folder) / name).mkdir(exist_ok=True)
    try:
        with collected():
            record |= {"status": "whole", **_cut(Path(folder), plan, number)}
    except (WaveletError, OSError) as error:  # a full disk, of whatever kind
        record |= {"status": "failed", "reason": " ".join(str(error).split())}
    kept = Path(folder) / SOURCES / f"{number:05d}.json"
    with new_file(kept, overwrite=True) as scratch:
        write_text(scratch, json.dumps(record, sort_keys=True))
    return record


def _cut(folder: Path, plan: TilePlan, number: int) -> dict[str, Any]:
    lattice, file = plan.points, plan.files[number]
    assert lattice is not None
    stat = os.stat(file.path)
    if (stat.st_size, stat.st_mtime_ns) != (file.n_bytes, file.changed):
        raise InputFileError(f"{file.path}: this file has changed since; tile anew.")
    head = read_head(file.path)
    first = head if number == 0 else read_head(plan.files[0].path)
    shift = shift_of(plan.files[0].path, first, file.path, head)
    header = laspy_header(file.path, head.layout)
    laspy, classes = require_laspy(), plan.reading["classes"]
    slices: list[tuple[int, int, int, int]] = []
    n_rows = offset = 0
    place = folder / CUT / f"{number:05d}.points"
    with new_file(place, overwrite=True) as scratch, recorded_stream(scratch) as stream:

        def take(batch: NDArray[Any]) -> None:
            nonlocal n_rows, offset
            rows, columns = _cells(plan, batch, shift)
            _require_inside(file, rows, columns)
            if classes is not None:
                points = laspy.PackedPointRecord(batch, header.point_format)
                chosen = np.isin(np.array(points["classification"]), classes)
                batch, rows, columns = batch[chosen], rows[chosen], columns[chosen]
            for piece, members in _by_tile(plan, rows, columns):
                stream.write((n_rows + members).astype("<i8").tobytes())
                stream.write(batch[members].tobytes())
                slices.append((piece.row, piece.column, offset, len(members)))
                offset += len(members) * (8 + batch.dtype.itemsize)
            n_rows += len(batch)

        each_batch(file.path, head.layout, _BATCH, take)
    for suffix, content in ((".head", head.layout.block), (".tail", head.tail)):
        kept = folder / SOURCES / f"{number:05d}{suffix}"
        with new_file(kept, overwrite=True) as scratch:
            write_bytes(scratch, content)
    return {
        "n_points": n_rows,
        "n_in_file": head.layout.n_points,
        "n_bytes": offset,
        "tail_at": head.tail_at,
        "shift": shift.tolist(),
        "slices": slices,
    }


def _cells(
    plan: TilePlan, records: NDArray[Any], shift: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    assert plan.points is not None
    first_row, first_column = plan.points.first
    rows = records["Y"].astype(np.int64) + (int(shift[1]) - first_row)
    columns = records["X"].astype(np.int64) + (int(shift[0]) - first_column)
    return rows, columns


def _require_inside(file: SourceFile, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> None:
    inside = (rows >= file.row) & (rows < file.row + file.height)
    inside &= (columns >= file.column) & (columns < file.column + file.width)
    if not inside.all():
        raise InputFileError(
            f"{file.path}: {np.count_nonzero(~inside)} points or more lie outside of the bounds "
            "that the header states, by which tiles are cut; repair the header first (lasinfo "
            "-repair), or get the file again."
        )


def _by_tile(
    plan: TilePlan, rows: NDArray[np.int64], columns: NDArray[np.int64]
) -> list[tuple[Piece, NDArray[np.int64]]]:
    """Return for each tile which points are in it or within reach of it, ascending."""
    assert plan.points is not None
    if len(rows) == 0:  # a batch in which no point is of the chosen classes
        return []
    within = plan.points.reach_in_cells
    spans = []
    for at, ends, reach in ((rows, plan.rows, within[0]), (columns, plan.columns, within[1])):
        inner = np.array(ends[1:-1], dtype=np.int64)
        spans.append(
            (
                np.searchsorted(inner, at - reach, side="left"),
                np.searchsorted(inner, at + reach, side="right"),
            )
        )
    # A tile is wider than twice the reach, so a point is within reach of two in each direction.
    numbers, members = [], []
    n_columns = len(plan.columns) - 1
    everyone = np.arange(len(rows))
    for i in (0, 1):
        for j in (0, 1):
            is_one = np.ones(len(rows), dtype=bool)
            if i:
                is_one &= spans[0][1] > spans[0][0]
            if j:
                is_one &= spans[1][1] > spans[1][0]
            numbers.append((spans[0][i] * n_columns + spans[1][j])[is_one])
            members.append(everyone[is_one])
    tile, member = np.concatenate(numbers), np.concatenate(members)
    order = np.lexsort((member, tile))
    tile, member = tile[order], member[order]
    starts = np.flatnonzero(np.diff(tile, prepend=-1))
    return [
        (Piece(0, int(tile[start]) // n_columns, int(tile[start]) % n_columns), part)
        for start, part in zip(starts, np.split(member, starts[1:]), strict=True)
    ]


def points_of(
    folder: str | os.PathLike[str], plan: TilePlan, piece: Piece, numbers: Sequence[int]
) -> CutPoints | None:
    """Return the points in and around a tile; None where there are none.

    Parameters
    ----------
    folder : path
        Of the tile set.
    plan : TilePlan
    piece : Piece
        A tile.
    numbers : sequence of int
        Of the inputs that reach it.

    Raises
    ------
    InputFileError
        An input could not be cut, for the reason that its record gives.
    """
    parts: list[NDArray[Any]] = []
    rows: list[NDArray[np.int64]] = []
    files: list[NDArray[np.int32]] = []
    for number in numbers:
        slices = _slices_of(folder, number)
        here = slices.by_tile.get((piece.row, piece.column))
        if here is None:
            continue
        dtype = record_dtype(folder, number)
        path = Path(folder) / CUT / f"{number:05d}.points"
        with open(path, "rb") as stream:
            for offset, n_points in here:
                stream.seek(offset)
                rows.append(np.fromfile(stream, "<i8", n_points))
                part = np.fromfile(stream, dtype, n_points)
                if len(part) < n_points:
                    raise InputFileError(f"{path}: the file ends early; start again.")
                for axis, shift in zip("XYZ", slices.shift, strict=True):
                    part[axis] = _moved(plan, number, part[axis], shift)
                parts.append(part)
                files.append(np.full(n_points, number, np.int32))
    if not parts:
        return None
    return CutPoints(np.concatenate(parts), np.concatenate(files), np.concatenate(rows))


class _Slices(NamedTuple):
    """Where the points of each tile are in the cut of an input.

    shift : list of int, what its stored X, Y and Z differ by from those of the first
    by_tile : dict of (row, column) to a list of (offset, n_points), one for each batch
    """

    shift: list[int]
    by_tile: dict[tuple[int, int], list[tuple[int, int]]]


def _slices_of(folder: str | os.PathLike[str], number: int) -> _Slices:
    """Return the slices of an input, looked up in its record once for all its tiles."""
    try:
        stat = os.stat(Path(folder) / SOURCES / f"{number:05d}.json")
    except FileNotFoundError as error:
        raise InputFileError("it was not cut") from error
    return _read_slices(os.fspath(folder), number, stat.st_size, stat.st_mtime_ns)


@lru_cache(maxsize=32)
def _read_slices(folder: str, number: int, n_bytes: int, changed: int) -> _Slices:
    """Return the slices of an input out of a record of that size and time."""
    record = source_record(folder, number)
    if record is None or record["status"] != "whole":
        raise InputFileError("it was not cut" if record is None else record["reason"])
    by_tile: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for row, column, offset, n_points in record["slices"]:
        by_tile.setdefault((row, column), []).append((offset, n_points))
    return _Slices(record["shift"], by_tile)


def _moved(plan: TilePlan, number: int, stored: NDArray[np.int32], shift: int) -> NDArray[np.int32]:
    moved = stored.astype(np.int64) + shift
    limits = np.iinfo(np.int32)
    if shift and len(moved) and (moved.min() < limits.min or moved.max() > limits.max):
        raise InputFileError(
            f"{plan.files[number].path}: it lies too far from {plan.files[0].path} for one file in "
            "steps like theirs; give files that are nearer to one another."
        )
    return moved.astype(np.int32)


def record_dtype(folder: str | os.PathLike[str], number: int) -> np.dtype[Any]:
    """Return the dtype of the records of an input that was cut."""
    path = Path(folder) / SOURCES / f"{number:05d}.head"
    layout = parse_layout(str(path), path.read_bytes())
    dtype: np.dtype[Any] = laspy_header(str(path), layout).point_format.dtype()
    return dtype
