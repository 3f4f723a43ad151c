"""The index of a tile set: a GeoPackage with the footprint of every piece, beside the plan."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.io.atomic import new_file
from wavelet_gis.io.geopackage import check_database, check_rows
from wavelet_gis.io.names import plain_folder
from wavelet_gis.io.read_back import read_back, room_at
from wavelet_gis.model.dem import grid_bounds
from wavelet_gis.products.wkb import boxes_wkb
from wavelet_gis.tiles.piece import PIECES, level_handed_on, read_record
from wavelet_gis.tiles.plan import PLAN, Piece, TilePlan

__all__ = [
    "INDEX",
    "LAYER",
    "TileIndex",
    "check_index",
    "footprints",
    "index_fields",
    "is_index",
    "open_index",
    "write_index",
]

INDEX = "index.gpkg"

#: Its layer.
LAYER = "tiles"


@dataclass(frozen=True, slots=True)
class TileIndex:
    """A tile set that is there.

    Attributes
    ----------
    folder : Path
    plan : TilePlan
    records : dict of Piece to dict
        Of all pieces that have been tried.
    """

    folder: Path
    plan: TilePlan
    records: dict[Piece, dict[str, Any]]

    def path(self, piece: Piece) -> Path:
        """Return the pyramid file of a piece."""
        return self.folder / PIECES / f"{piece.name}.gpkg"

    def whole(self, stage: int) -> list[Piece]:
        """Return the pieces of a stage that are there."""
        return [
            piece
            for piece in self.plan.pieces(stage)
            if self.records.get(piece, {}).get("status") == "whole"
        ]

    def coarsest_of(self, piece: Piece) -> int:
        """Return the level of a piece that the group above begins with; 0 where there is none."""
        above = Piece(piece.stage + 1, piece.row // 2, piece.column // 2)
        inputs = self.records.get(above, {}).get("inputs", {})
        return level_handed_on(str(inputs.get(piece.name, "")))

    def levels_of(self, stage: int) -> int:
        """Return the number of levels of a stage; 0 where it has no piece."""
        return max(
            (self.records[p]["n_levels"] - self.coarsest_of(p) for p in self.whole(stage)),
            default=0,
        )

    @property
    def n_levels(self) -> int:
        """Number of levels of the whole; 0 is the coarsest, this the input."""
        return sum(self.levels_of(stage) for stage in range(self.plan.n_stages))

    def place_of(self, level: int) -> tuple[int, int]:
        """Return the stage that has a level of the whole, and how far below its finest that is."""
        below = self.n_levels - level
        if not 0 <= level <= self.n_levels:
            raise InputFileError(
                f"{self.folder}: there is no level {level}; the levels are 0 to {self.n_levels}."
            )
        stage = 0
        while below > self.levels_of(stage):
            below -= self.levels_of(stage)
            stage += 1
        return stage, below

    def levels_in_whole(self, levels: Sequence[tuple[Piece, int]]) -> list[int]:
        """Return the levels of the whole that levels of pieces are."""
        by_stage = [self.levels_of(stage) for stage in range(self.plan.n_stages)]
        finest = [sum(by_stage[stage:]) for stage in range(self.plan.n_stages)]
        return [
            finest[piece.stage] - (int(self.records[piece]["n_levels"]) - level)
            for piece, level in levels
        ]


def is_index(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is the index of a tile set."""
    file = Path(path)
    return file.name == INDEX and (file.parent / PLAN).is_file()


def open_index(path: str | os.PathLike[str]) -> TileIndex:
    """Return the tile set that an index, or its folder, belongs to.

    Raises
    ------
    InputFileError
        There is none, or its plan is damaged.
    """
    file = Path(path)
    folder = file if file.is_dir() else file.parent
    try:
        text = (folder / PLAN).read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputFileError(
            f"{path}: there is no tile set here ({PLAN} cannot be read); name its {INDEX}."
        ) from error
    plan = TilePlan.from_json(text, str(folder / PLAN))
    checksum, records = plan.checksum, {}
    for stage in range(plan.n_stages):
        for piece in plan.pieces(stage):
            record = read_record(folder, piece)
            if record is not None and record.get("plan") == checksum:
                records[piece] = record
    return TileIndex(folder, plan, records)


def index_fields(index: TileIndex) -> dict[str, NDArray[Any]]:
    """Return the fields of the layer ``tiles``, a row for each piece that has been tried."""
    pieces = list(index.records)
    rows = [index.records[piece] for piece in pieces]
    return {
        "stage": np.array([piece.stage for piece in pieces], np.int32),
        "row": np.array([piece.row for piece in pieces], np.int32),
        "column": np.array([piece.column for piece in pieces], np.int32),
        "status": np.array([row["status"] for row in rows], object),
        "reason": np.array([row.get("reason", "") for row in rows], object),
        "file": np.array(
            [
                f"{PIECES}/{piece.name}.gpkg" if row["status"] == "whole" else ""
                for piece, row in zip(pieces, rows, strict=True)
            ],
            object,
        ),
        "n_bytes": np.array([row.get("n_bytes", 0) for row in rows], np.int64),
        "n_levels": np.array([row.get("n_levels", 0) for row in rows], np.int32),
        "n_coarse": np.array([row.get("sizes", [0])[0] for row in rows], np.int64),
        "n_fine": np.array([row.get("sizes", [0])[-1] for row in rows], np.int64),
        "rmse": np.array([row.get("rmse", np.nan) for row in rows]),
        "max_error": np.array([row.get("max_error", np.nan) for row in rows]),
        "sha256": np.array([row.get("sha256", "") for row in rows], object),
    }


def footprints(index: TileIndex) -> NDArray[Any]:
    """Return the footprints of those pieces, ``(n,)`` bytes objects of well-known binary."""
    boxes = np.array([_bounds(index.plan, piece) for piece in index.records]).reshape(-1, 4)
    return boxes_wkb(boxes)


def write_index(index: TileIndex) -> None:
    """Write the GeoPackage of a tile set: the layer ``tiles``, one footprint a piece."""
    from pyogrio.errors import DataLayerError, DataSourceError, FeatureError
    from pyogrio.raw import write

    fields = index_fields(index)
    with new_file(index.folder / INDEX, overwrite=True) as scratch:
        try:
            with plain_folder(scratch) as name, warnings.catch_warnings():
                warnings.filterwarnings("ignore", "'crs' was not provided")  # nor has the input one
                write(
                    name,
                    footprints(index),
                    list(fields.values()),
                    list(fields),
                    layer=LAYER,
                    driver="GPKG",
                    geometry_type="Polygon",
                    crs=index.plan.coordinate_system.wkt,
                )
        except (DataSourceError, DataLayerError, FeatureError) as error:
            raise OutputFileError(
                f"{index.folder / INDEX}: the index cannot be written, the pieces are there; "
                f"{room_at(index.folder)}."
            ) from error
        check_index(scratch, len(index.records))


def check_index(path: Path, n_rows: int) -> None:
    """Read an index back that was just written."""
    read_back(path, check_database)
    read_back(path, partial(check_rows, n_rows={LAYER: n_rows}))


def _bounds(plan: TilePlan, piece: Piece) -> tuple[float, float, float, float]:
    top, left, bottom, right = plan.cells(piece)
    return grid_bounds(plan.geometry.window(top, left, (bottom - top + 1, right - left + 1)))
