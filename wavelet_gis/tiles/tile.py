"""Terrain of any size as a tiled pyramid: stage by stage, from where an earlier run ended."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wavelet_core.errors import OptionError
from wavelet_gis.errors import OutputFileError, TerrainWarning
from wavelet_gis.io.atomic import ensure_folder, new_file
from wavelet_gis.io.read_back import write_text
from wavelet_gis.io.scratch import sweep_own
from wavelet_gis.notes import warn
from wavelet_gis.tiles.cloud.cut import CUT, SOURCES, stamp_of
from wavelet_gis.tiles.cloud.plan import plan_of_clouds
from wavelet_gis.tiles.handover import handover_levels
from wavelet_gis.tiles.index import INDEX, TileIndex, open_index, write_index
from wavelet_gis.tiles.kept_levels import KEPT, drop_levels
from wavelet_gis.tiles.piece import (
    LOOSE,
    PIECES,
    handed_on,
    make_piece,
    read_record,
    sha256_of,
)
from wavelet_gis.tiles.plan import LEVELS, PLAN, TILE, Piece, TilePlan, plan_of_rasters
from wavelet_gis.tiles.runner import Job, records_of, require_dask

__all__ = ["Tiled", "run_plan", "tile_clouds", "tile_rasters"]

#: Called for each piece: with its record, how many are done, how many there are.
OnPiece = Callable[[dict[str, Any], int, int], None]


@dataclass(frozen=True, slots=True)
class Tiled:
    """What came of it.

    Attributes
    ----------
    index : TileIndex
        All that is there now.
    n_made, n_found : int
        Pieces made in this run, and those that were whole before it.
    """

    index: TileIndex
    n_made: int
    n_found: int

    @property
    def failed(self) -> list[dict[str, Any]]:
        """Records of the tiles that were set aside."""
        return [row for row in self.index.records.values() if row["status"] == "failed"]

    def figures(self) -> dict[str, Any]:
        """Return what it is as JSON-able values.

        ``n_pieces`` counts the tiles and groups of all stages that there is a record of, those
        without points and those that were set aside among them; ``n_stages`` the stages.
        """
        plan, records = self.index.plan, self.index.records
        whole = [row for row in records.values() if row["status"] == "whole"]
        size = {"n_rows": plan.shape[0], "n_columns": plan.shape[1]}
        if plan.points is not None:
            size = {"n_files": len(plan.files), "n_points": plan.points.n_points}
        return {
            **size,
            "n_stages": plan.n_stages,
            "n_tiles": len(plan.pieces(0)),
            "n_pieces": len(records),
            "n_made": self.n_made,
            "n_found": self.n_found,
            "n_levels": self.index.n_levels,
            "n_bytes": sum(row["n_bytes"] for row in whole),
            "failed": [
                {"stage": r["stage"], "row": r["row"], "column": r["column"], "reason": r["reason"]}
                for r in self.failed
            ],
        }


def tile_rasters(
    data: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    folder: str | os.PathLike[str],
    *,
    tile: int = TILE,
    levels: int = LEVELS,
    workers: int = 1,
    scheduler: str | None = None,
    overwrite: bool = False,
    on_piece: OnPiece | None = None,
    **options: Any,
) -> Tiled:
    """Turn rasters into a tiled pyramid: one pyramid file for each tile and group, and an index.

    Parameters
    ----------
    data : path or sequence of path
        Rasters of one grid, or a folder of such; no more of them is read at once than a tile.
    folder : path
        A folder to be made, or that of an earlier run with the same input and options, which goes
        on from there: what is whole by its checksum is left as it is.
    tile : int
        Cells along the side of a tile. Neighbours share a line of cells.
    levels : int
        The most of each tile, and of each group but the last. What they hand on is not the last of
        them but the level at which a vertex costs the same error in all pieces.
    workers : int
        Processes that make pieces; each needs some 1,300 bytes for a cell of a tile.
    scheduler : str, optional
        Address of a Dask scheduler instead, whose workers see the same files.
    overwrite : bool
        Whether a tile set of another input, or of other options, may be replaced.
    on_piece : callable, optional
        Called as each piece is made or found: its record, how many are done, and of how many.
    **options
        ``crs``, ``vertical_unit``, ``band``, ``nodata``, ``offline`` and ``wavelets``; see
        `wavelet_gis.tiles.plan.plan_of_rasters`.

    Raises
    ------
    InputFileError
        Input that cannot be read or contradicts itself.
    OutputFileError
        The folder holds something else, or cannot be written.
    OptionError, MissingDependencyError
        Options without a meaning; a scheduler without dask.

    Warns
    -----
    TerrainWarning
        Of tiles that could not be made: they are set aside, and the others go on without them.
    """
    _require_workers(workers, scheduler)
    plan = plan_of_rasters(data, tile=tile, levels=levels, **options)
    return run_plan(plan, folder, workers, scheduler, overwrite=overwrite, on_piece=on_piece)


def tile_clouds(
    data: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    folder: str | os.PathLike[str],
    *,
    tile: float | tuple[float, float] | None = None,
    levels: int = LEVELS,
    workers: int = 1,
    scheduler: str | None = None,
    overwrite: bool = False,
    on_piece: OnPiece | None = None,
    **options: Any,
) -> Tiled:
    """Turn point clouds into a tiled pyramid, as `tile_rasters` does with rasters.

    Parameters
    ----------
    data : path or sequence of path
        LAS, LAZ or COPC files of one point format, or a folder of such; each is read once, a batch
        at a time.
    folder, levels, scheduler, overwrite, on_piece
        See `tile_rasters`.
    tile : float or (float, float), optional
        Side of a tile, or its width and height, in the unit of x and y; by default such that a
        tile has about a million points.
    workers : int
        Processes that make pieces; each needs some 1,000 bytes for a point of a tile.
    **options
        ``crs``, ``vertical_unit``, ``attributes``, ``classes``, ``keep_noise``, ``keep_withheld``,
        ``duplicates`` and ``wavelets``; see `wavelet_gis.tiles.cloud.plan.plan_of_clouds`.

    Raises
    ------
    InputFileError, OutputFileError, OptionError, MissingDependencyError
        As `tile_rasters`.

    Warns
    -----
    TerrainWarning
        Of tiles that could not be made: they are set aside, and the others go on without them.
    """
    _require_workers(workers, scheduler)
    plan = plan_of_clouds(data, tile=tile, levels=levels, **options)
    return run_plan(plan, folder, workers, scheduler, overwrite=overwrite, on_piece=on_piece)


def _require_workers(workers: int, scheduler: str | None) -> None:
    if workers < 1:
        raise OptionError("{0} is {workers}; give at least 1.", "workers", workers=workers)
    if scheduler is not None:
        require_dask()


def run_plan(
    plan: TilePlan,
    folder: str | os.PathLike[str],
    workers: int,
    scheduler: str | None = None,
    *,
    overwrite: bool = False,
    on_piece: OnPiece | None = None,
    make: Callable[[str, Piece, dict[str, str]], dict[str, Any]] = make_piece,
    write: Callable[[TileIndex], None] = write_index,
) -> Tiled:
    """Make all pieces of a plan, stage by stage, and the index.

    Parameters
    ----------
    plan : TilePlan
    folder, workers, scheduler, overwrite, on_piece
        See `tile_rasters`.
    make : callable
        What makes a piece; `wavelet_gis.tiles.piece.make_piece` says how.
    write : callable
        What writes the index.
    """
    place = _prepared(Path(folder).absolute(), plan, overwrite)
    n_total = sum(len(plan.pieces(stage)) for stage in range(plan.n_stages))
    n_made = n_found = 0
    checksum, numbers = plan.checksum, plan.inputs_of_tiles()
    for stage in range(plan.n_stages):
        jobs: list[Job] = []
        needed: set[int] = set()
        parts = _parts(place, plan, stage) if stage > 0 else {}
        for piece in plan.pieces(stage):
            if stage == 0:
                files = (plan.files[number] for number in numbers[piece])
                inputs = {file.path: stamp_of(file) for file in files}
            else:
                inputs = parts[piece]
            record = read_record(place, piece)
            if record is not None and _is_whole(place, checksum, piece, record, inputs):
                n_found += 1
                if on_piece is not None:
                    on_piece(record, n_made + n_found, n_total)
            else:
                jobs.append((make, (str(place), piece, inputs)))
                needed.update(numbers.get(piece, ()))
        if stage == 0 and plan.points is not None:
            _cut(place, plan, sorted(needed), workers, scheduler)
        for record in records_of(jobs, workers, scheduler):
            n_made += 1
            if on_piece is not None:
                on_piece(record, n_made + n_found, n_total)
        if stage > 0:
            drop_levels(place, stage - 1)
    index = open_index(place)
    write(index)
    if plan.points is not None and all(row["status"] != "failed" for row in index.records.values()):
        shutil.rmtree(place / CUT, ignore_errors=True)
    tiled = Tiled(index, n_made, n_found)
    if tiled.failed:
        first = tiled.failed[0]
        warn(
            TerrainWarning,
            "tiles_set_aside",
            "{count} of {n_pieces} pieces could not be made and were set aside, the first at stage "
            "{stage}, row {row}, column {column}: {reason} (fix that and start again; the rest is "
            "kept)",
            stacklevel=4,
            count=len(tiled.failed),
            n_pieces=n_total,
            stage=first["stage"],
            row=first["row"],
            column=first["column"],
            reason=first["reason"].rstrip("."),
        )
    return tiled


def _cut(
    folder: Path, plan: TilePlan, needed: Sequence[int], workers: int, scheduler: str | None
) -> None:
    """Put the points of the files that some tiles need beside one another by tile."""
    from wavelet_gis.tiles.cloud.cut import is_cut, make_cut

    jobs: list[Job] = [
        (make_cut, (str(folder), number)) for number in needed if not is_cut(folder, plan, number)
    ]
    for _ in records_of(jobs, workers, scheduler):
        pass  # what is wrong with one is reported by the tiles that need it


def _prepared(folder: Path, plan: TilePlan, overwrite: bool) -> Path:
    """Return the folder, with the plan in it."""
    is_there = folder.exists() and not (folder.is_dir() and not any(folder.iterdir()))
    if is_there and not (folder / PLAN).is_file():
        raise OutputFileError(
            f"{folder}: this exists and is no folder with a {PLAN}; give another name."
        )
    text = plan.to_json()
    if is_there and (folder / PLAN).read_text("utf-8", errors="replace") != text:
        if not overwrite:
            raise OutputFileError(
                "{path}: this is a tile set of another input or of other options; give another "
                "name, or {0} to replace it.",
                "overwrite",
                path=folder,
            )
        for name in (PIECES, KEPT, CUT, SOURCES):
            shutil.rmtree(folder / name, ignore_errors=True)
        (folder / INDEX).unlink(missing_ok=True)
    ensure_folder(folder)
    stages = [f"{name}/{stage}" for name in (PIECES, KEPT) for stage in range(plan.n_stages)]
    for name in (CUT, SOURCES, *stages):  # what a killed run had begun
        sweep_own(folder / name)
    if not is_there or (folder / PLAN).read_text("utf-8", errors="replace") != text:
        with new_file(folder / PLAN, overwrite=True) as scratch:
            write_text(scratch, text)
    return folder


def _parts(folder: Path, plan: TilePlan, stage: int) -> dict[Piece, dict[str, str]]:
    """Return what the groups of a stage are made from: pieces, checksums, levels to begin with."""
    groups: dict[Piece, list[Piece]] = {}
    records: dict[Piece, dict[str, Any]] = {}
    for group in plan.pieces(stage):
        groups[group] = []
        for part in plan.parts(group):
            record = read_record(folder, part)
            if record is not None and record["status"] == "whole":
                groups[group].append(part)
                records[part] = record
    levels = handover_levels(list(groups.values()), records)
    return {
        group: {part.name: handed_on(records[part]["sha256"], levels[part]) for part in parts}
        for group, parts in groups.items()
    }


def _is_whole(
    folder: Path, checksum: str, piece: Piece, record: dict[str, Any], inputs: dict[str, str]
) -> bool:
    if record.get("plan") != checksum or record.get("inputs") != inputs:
        return False
    if record["status"] not in ("whole", "loose"):
        return bool(record["status"] == "empty")
    suffix = ".gpkg" if record["status"] == "whole" else LOOSE
    path = folder / PIECES / f"{piece.name}{suffix}"
    return path.is_file() and sha256_of(path) == record["sha256"]
