"""How terrain is cut into tiles, and what holds for all of them: a plan that is kept as JSON."""

from __future__ import annotations

import hashlib
import json
import os
from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from wavelet_core.errors import OptionError
from wavelet_core.lifting.options import AnalysisOptions, resolve_options
from wavelet_gis._fields import Fields
from wavelet_gis.crs.agreement import agreed
from wavelet_gis.crs.frame import CoordinateSystem, Georeference, LocalFrame
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.formats import CLOUD_SUFFIXES, suffix_of
from wavelet_gis.io.names import files_of, gdal_path, joint_name
from wavelet_gis.model.dem import GridGeometry, grid_bounds
from wavelet_gis.model.terrain import frame_of_bounds

__all__ = [
    "LEVELS",
    "PLAN",
    "TILE",
    "Piece",
    "PointLattice",
    "SourceFile",
    "TilePlan",
    "checked_wavelets",
    "ends_of_tiles",
    "plan_of_grids",
    "plan_of_rasters",
]

#: The file of a tile set that holds its plan.
PLAN = "plan.json"

#: Cells along the side of a tile.
TILE = 1024

#: The most levels of a piece, each of which takes some 5 to 20 % of its vertices.
LEVELS = 64

#: Part of its vertices to which a piece goes down, far enough for flat ones; rough pieces hand on a
#: level long before (`wavelet_gis.tiles.handover`). And the largest share of its vertices that a
#: level takes: with 0.25 the level of a quarter of the vertices has up to 1.4 times the RMSE of a
#: TIN made for its size (autzen_trim), with 0.12 up to 1.09, in the same time.
_COARSEST_SHARE, _SHARE_OF_LEVEL = 1 / 32, 0.12

#: Options by which files are read, that a plan has.
_OF_READING = {"band", "nodata", "offline", "attributes", "classes", "keep_noise"}
_OF_READING |= {"keep_withheld", "duplicates"}

#: Options of `wavelet_core.analyse` that leave x and y of the vertices in place.
_WAVELETS = ("norm", "partition", "prediction", "removal_fraction", "update")

_FORMAT = "terrain-wavelets tiles 1"


class Piece(NamedTuple):
    """A tile (stage 0), or the group of up to four pieces of the stage before.

    stage, row, column : int
    """

    stage: int
    row: int
    column: int

    @property
    def name(self) -> str:
        """The name of its files, without suffix."""
        return f"{self.stage}/{self.row:05d}_{self.column:05d}"


class PointLattice(NamedTuple):
    """What a plan of points has besides: its cells are the steps in which coordinates are stored.

    scales, offsets : tuple of float, of x, y and z
    first : (row, column), stored Y and X of the first cell
    ratio : (p, q), a column is p and a row q of a length that is about the same in both
    spacing : int, of the points in that length
    reach : int, as far as a border may be from its line
    n_points : int
    """

    scales: tuple[float, float, float]
    offsets: tuple[float, float, float]
    first: tuple[int, int]
    ratio: tuple[int, int]
    spacing: int
    reach: int
    n_points: int

    @property
    def reach_in_cells(self) -> tuple[int, int]:
        """Rows and columns of the reach."""
        p, q = self.ratio
        return -(-self.reach // q), -(-self.reach // p)


class SourceFile(NamedTuple):
    """A file and where it lies in the grid of all.

    path : str
    row, column : int, of its first cell
    height, width : int, in cells
    n_bytes, changed : int, size and time of its last change, by which it is known again
    """

    path: str
    row: int
    column: int
    height: int
    width: int
    n_bytes: int
    changed: int


@dataclass(frozen=True, slots=True)
class TilePlan:
    """What holds for all pieces.

    Attributes
    ----------
    files : tuple of SourceFile
        The first that has data counts.
    shape : (n_rows, n_columns)
        Of all cells.
    transform : tuple of float
        Of the grid; see `wavelet_gis.model.dem.GridGeometry`.
    rows, columns : tuple of int
        Where tiles end: those cells belong to both tiles.
    levels : int
        The most of each piece but the last.
    reading : dict
        ``band``, ``nodata``, ``offline``; of points ``attributes``, ``classes`` and others.
    wavelets : dict
        Options of the analysis.
    system, frame : dict
        See `wavelet_gis.crs.frame`.
    vertical_unit : str
    points : PointLattice or None
        Of point clouds; None for rasters.
    """

    files: tuple[SourceFile, ...]
    shape: tuple[int, int]
    transform: tuple[float, ...]
    rows: tuple[int, ...]
    columns: tuple[int, ...]
    levels: int
    reading: dict[str, Any]
    wavelets: dict[str, Any]
    system: dict[str, Any]
    frame: dict[str, Any]
    vertical_unit: str
    points: PointLattice | None = None

    @property
    def geometry(self) -> GridGeometry:
        """The grid of all cells."""
        return GridGeometry(self.shape, self.transform)  # type: ignore[arg-type]

    def places(self, rows: np.ndarray, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return x and y of cells; those of points to the bit as the cloud has them.

        A face of three points on one line may be so thin by rounding alone that other rounding
        turns it over.
        """
        if self.points is None:
            return self.geometry.centres(columns.astype(np.float64), rows.astype(np.float64))
        (first_row, first_column), scales = self.points.first, self.points.scales
        x = (columns + first_column) * scales[0] + self.points.offsets[0]
        y = (rows + first_row) * scales[1] + self.points.offsets[1]
        return x, y

    @property
    def coordinate_system(self) -> CoordinateSystem:
        """The CRS of all."""
        return CoordinateSystem.from_dict(self.system)

    @property
    def local_frame(self) -> LocalFrame:
        """The working frame of all."""
        return LocalFrame.from_dict(self.frame)

    @property
    def n_stages(self) -> int:
        """Number of stages; the last has one piece."""
        side = max(len(self.rows), len(self.columns)) - 1
        return 1 + (side - 1).bit_length()

    def pieces(self, stage: int) -> list[Piece]:
        """Return the pieces of a stage, row by row."""
        n_rows, n_columns = self._size(stage)
        return [Piece(stage, row, column) for row in range(n_rows) for column in range(n_columns)]

    def _size(self, stage: int) -> tuple[int, int]:
        """Return the rows and columns of pieces that a stage has."""
        rows, columns = len(self.rows) - 1, len(self.columns) - 1
        return -(-rows // (1 << stage)), -(-columns // (1 << stage))

    def inputs_of(self, piece: Piece) -> list[int]:
        """Return the numbers of the files that may have cells of a tile, or points near it."""
        top, left, bottom, right = self.cells(piece)
        in_rows, in_columns = self._reach()
        return [
            number
            for number, file in enumerate(self.files)
            if file.row <= bottom + in_rows
            and file.row + file.height > top - in_rows
            and file.column <= right + in_columns
            and file.column + file.width > left - in_columns
        ]

    def inputs_of_tiles(self) -> dict[Piece, list[int]]:
        """Return `inputs_of` all tiles, without asking each file for each tile."""
        found: dict[Piece, list[int]] = {piece: [] for piece in self.pieces(0)}
        in_rows, in_columns = self._reach()
        for number, file in enumerate(self.files):
            rows = _tiles_along(self.rows, file.row, file.height, in_rows)
            columns = _tiles_along(self.columns, file.column, file.width, in_columns)
            for row in rows:
                for column in columns:
                    found[Piece(0, row, column)].append(number)
        return found

    def _reach(self) -> tuple[int, int]:
        return (0, 0) if self.points is None else self.points.reach_in_cells

    def parts(self, piece: Piece) -> list[Piece]:
        """Return the pieces of the stage before that a group is made of."""
        n_rows, n_columns = self._size(piece.stage - 1)
        return [
            Piece(piece.stage - 1, row, column)
            for row in range(2 * piece.row, min(2 * piece.row + 2, n_rows))
            for column in range(2 * piece.column, min(2 * piece.column + 2, n_columns))
        ]

    def options_of(self, piece: Piece, n_vertices: int) -> dict[str, Any]:
        """Return the options by which a piece of so many vertices is analysed.

        The only piece of a plan is a pyramid like any other.
        """
        if self.n_stages == 1:
            return dict(self.wavelets)
        options = {
            "levels": LEVELS if piece.stage == self.n_stages - 1 else self.levels,
            "target_vertices": max(int(n_vertices * _COARSEST_SHARE), 3),
            **self.wavelets,
        }
        if self._resolved.partition == "surface":
            options.setdefault("removal_fraction", _SHARE_OF_LEVEL)
        return options

    @property
    def is_error_guided(self) -> bool:
        """Whether pieces are analysed by the errors at points of the input."""
        return self._resolved.is_error_guided

    @property
    def _resolved(self) -> AnalysisOptions:
        return resolve_options(n_attributes=0, **self.wavelets)

    def tiles(self, piece: Piece) -> list[Piece]:
        """Return the tiles that a piece is made of, row by row; of a tile itself."""
        n_rows, n_columns = self._size(0)
        side = 1 << piece.stage
        return [
            Piece(0, row, column)
            for row in range(piece.row * side, min((piece.row + 1) * side, n_rows))
            for column in range(piece.column * side, min((piece.column + 1) * side, n_columns))
        ]

    def cells(self, piece: Piece) -> tuple[int, int, int, int]:
        """Return first row, first column, last row and last column of a piece, all in it."""
        side = 1 << piece.stage
        top, left = self.rows[piece.row * side], self.columns[piece.column * side]
        bottom = self.rows[min((piece.row + 1) * side, len(self.rows) - 1)]
        right = self.columns[min((piece.column + 1) * side, len(self.columns) - 1)]
        return top, left, bottom, right

    def is_shared(self, piece: Piece, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Return which cells lie on a border line with a neighbour, or, of points, within reach."""
        top, left, bottom, right = self.cells(piece)
        reach = self._reach()
        shared: np.ndarray = np.zeros(len(rows), dtype=bool)
        for at, ends, last, within in (
            (rows, (top, bottom), self.rows[-1], reach[0]),
            (columns, (left, right), self.columns[-1], reach[1]),
        ):
            for end in ends:
                if end not in (0, last):
                    shared |= np.abs(at - end) <= within
        return shared

    def to_json(self) -> str:
        """Return the plan as a text, the same for the same plan."""
        fields = {"format": _FORMAT, **asdict(self)}
        fields["files"] = [list(file) for file in self.files]
        fields["points"] = None if self.points is None else self.points._asdict()
        if self.points is None:  # as plans of rasters were before there were others
            fields.pop("points")
        return json.dumps(fields, sort_keys=True, indent=1)

    @property
    def checksum(self) -> str:
        """SHA-256 of the plan without the files, which each tile is asked for itself."""
        fields = json.loads(replace(self, files=()).to_json())
        fields.pop("files")
        return hashlib.sha256(json.dumps(fields, sort_keys=True).encode()).hexdigest()

    @classmethod
    def from_json(cls, text: str, name: str) -> TilePlan:
        """Return the plan of a text.

        Raises
        ------
        InputFileError
            It is damaged, or of another format.
        """
        try:
            raw = json.loads(text)
            stored = Fields(raw, name, InputFileError)
            if stored.text("format") != _FORMAT:
                raise ValueError(f"the format is {raw['format']!r}")
            n_rows, n_columns = stored.integers("shape", 1, 2**31 - 1)
            if not set(stored.fields("reading")) <= _OF_READING:
                raise ValueError(f"it is read by {', '.join(raw['reading'])}")
            resolve_options(n_attributes=0, **checked_wavelets(dict(stored.fields("wavelets"))))
            return cls(
                files=tuple(SourceFile(str(f[0]), *map(int, f[1:])) for f in raw["files"]),
                shape=(n_rows, n_columns),
                transform=tuple(stored.numbers("transform", 6)),
                rows=_ends(stored, "rows", n_rows),
                columns=_ends(stored, "columns", n_columns),
                levels=stored.integer("levels", 1, LEVELS),
                reading=dict(stored.fields("reading")),
                wavelets=dict(stored.fields("wavelets")),
                system=dict(stored.fields("system")),
                frame=dict(stored.fields("frame")),
                vertical_unit=stored.text("vertical_unit"),
                points=None if "points" not in raw else _lattice(stored.fields("points")),
            )
        except (ValueError, KeyError, TypeError, OverflowError, RecursionError) as error:
            raise InputFileError(
                f"{name}: this is no plan of tiles ({error}); tile the input anew."
            ) from error


def plan_of_rasters(
    data: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    tile: int = TILE,
    levels: int = LEVELS,
    crs: str | None = None,
    vertical_unit: str | None = None,
    band: int | None = None,
    nodata: float | str | None = None,
    offline: bool = False,
    wavelets: dict[str, Any] | None = None,
) -> TilePlan:
    """Return the plan by which rasters are tiled; reads no more than their headers.

    Parameters
    ----------
    data : path or sequence of path
        Rasters of one grid, or a folder of such.
    tile : int
        Cells along the side of a tile.
    levels : int
        The most of each tile, and of each group but the last.
    crs, vertical_unit, band, nodata, offline
        See `wavelet_gis.open`.
    wavelets : dict, optional
        Of `wavelet_core.analyse`: ``norm``, ``partition``, ``prediction``, ``removal_fraction`` and
        ``update``.

    Raises
    ------
    InputFileError
        Files that cannot be read, or that contradict each other.
    OptionError
        A size or a number of levels that makes no tiles.
    """
    from wavelet_gis.crs.lookup import coordinate_system

    _require_sizes(tile, levels)
    paths = _raster_paths(data)
    reading = {"band": band, "nodata": nodata, "offline": offline}
    grids, places = _grids_and_places(paths, reading)
    place = agreed(paths, places, any_crs=bool(crs), any_unit=bool(vertical_unit))
    system = coordinate_system(crs) if crs else coordinate_system(place.wkt)
    unit = vertical_unit or place.vertical_unit
    return plan_of_grids(
        paths, grids, system, unit, reading, tile=tile, levels=levels, wavelets=wavelets
    )


def plan_of_grids(
    paths: Sequence[str],
    grids: Sequence[GridGeometry],
    system: CoordinateSystem,
    vertical_unit: str | None,
    reading: dict[str, Any],
    *,
    tile: int = TILE,
    levels: int = LEVELS,
    wavelets: dict[str, Any] | None = None,
) -> TilePlan:
    """Return the plan by which rasters are tiled of which the grids are known.

    Parameters
    ----------
    paths : sequence of str
        Whole paths, for whoever makes tiles.
    grids : sequence of GridGeometry
        The cells of each.
    system : CoordinateSystem
        Of all of them.
    vertical_unit : str or None
    reading : dict
        Options by which they are read: ``band``, ``nodata``, ``offline``.
    tile, levels, wavelets
        See `plan_of_rasters`.

    Raises
    ------
    InputFileError
        Grids that do not fit.
    OptionError
        A size or a number of levels that makes no tiles.
    """
    _require_sizes(tile, levels)
    wavelets = checked_wavelets(wavelets)
    geometry, files = _laid_out(paths, grids)
    frame, unit = frame_of_bounds(joint_name(paths), system, grid_bounds(geometry), vertical_unit)
    n_rows, n_columns = geometry.shape
    return TilePlan(
        files=files,
        shape=geometry.shape,
        transform=geometry.transform,
        rows=ends_of_tiles(n_rows, tile),
        columns=ends_of_tiles(n_columns, tile),
        levels=levels,
        reading=reading,
        wavelets=wavelets,
        system=system.to_dict(),
        frame=frame.to_dict(),
        vertical_unit=unit,
    )


def _require_sizes(tile: int, levels: int) -> None:
    if tile < 8 or not 1 <= levels <= LEVELS:
        raise OptionError(
            "{0} is {tile} and {1} is {levels}; give at least 8 cells, and 1 to {most} levels.",
            "tile",
            "levels",
            tile=tile,
            levels=levels,
            most=LEVELS,
        )


def _raster_paths(data: str | os.PathLike[str] | Sequence[str | os.PathLike[str]]) -> list[str]:
    """Return the files, by their whole paths; refuse clouds among them."""
    paths = [os.path.abspath(path) for path in files_of(data)]
    for path in paths:
        if suffix_of(path) in CLOUD_SUFFIXES:
            raise InputFileError(
                f"{path}: this is a point cloud, the others are rasters; name files of one kind."
            )
    return paths


def _grids_and_places(
    paths: Sequence[str], reading: dict[str, Any]
) -> tuple[list[GridGeometry], list[Georeference]]:
    """Return the cells of each raster, and what it says of its coordinates; one cell is read."""
    import rasterio

    from wavelet_gis.io.raster import CellWindow, read_dem
    from wavelet_gis.io.raster.mosaic import require_alike

    grids, places = [], []
    first = None
    for path in paths:
        head, place = read_dem(path, window=CellWindow(0, 0, 1, 1), **reading)
        first = first or head
        require_alike(paths[0], first, path, head)
        with rasterio.open(gdal_path(path)) as dataset:
            grids.append(GridGeometry(dataset.shape, head.geometry.transform))
        places.append(place)
    return grids, places


def _laid_out(
    paths: Sequence[str], grids: Sequence[GridGeometry]
) -> tuple[GridGeometry, tuple[SourceFile, ...]]:
    """Return the grid of all cells, and where each file lies in it."""
    from wavelet_gis.io.raster.mosaic import first_cell

    corners = np.array(
        [first_cell(paths[0], grids[0], p, g) for p, g in zip(paths, grids, strict=True)]
    )
    low = corners.min(axis=0)
    n_rows, n_columns = (corners + [grid.shape for grid in grids]).max(axis=0) - low
    whole = grids[0].window(int(low[0]), int(low[1]), (int(n_rows), int(n_columns)))
    files = []
    for path, (row, column), grid in zip(paths, (corners - low).tolist(), grids, strict=True):
        stat = os.stat(path)
        files.append(SourceFile(path, row, column, *grid.shape, stat.st_size, stat.st_mtime_ns))
    return whole, tuple(files)


def checked_wavelets(wavelets: dict[str, Any] | None) -> dict[str, Any]:
    """Return the options of the analysis that are given; refuse those that tiles do not have."""
    for name in wavelets or {}:
        if name not in _WAVELETS:
            raise OptionError(f"{name} is no option of tiles; these are: {', '.join(_WAVELETS)}.")
    return {key: value for key, value in (wavelets or {}).items() if value is not None}


def ends_of_tiles(n_cells: int, tile: float) -> tuple[int, ...]:
    """Return the cells where tiles of about equal size begin and end."""
    n_tiles = max(round((n_cells - 1) / tile), 1)
    return tuple(round(k * (n_cells - 1) / n_tiles) for k in range(n_tiles + 1))


def _tiles_along(ends: tuple[int, ...], first: int, length: int, reach: int) -> range:
    """Return the tiles that a file reaches, of a row or a column of them."""
    low = bisect_left(ends, first - reach, 1) - 1
    high = bisect_right(ends, first + length - 1 + reach, 0, len(ends) - 1)
    return range(low, high)


def _ends(stored: Fields, name: str, n_cells: int) -> tuple[int, ...]:
    """Return where tiles end, as a file has it: from the first cell to the last, ascending."""
    ends = stored.integers(name, 0, n_cells - 1)
    is_ascending = all(a < b for a, b in pairwise(ends)) or ends == [0, 0]
    if len(ends) < 2 or (ends[0], ends[-1]) != (0, n_cells - 1) or not is_ascending:
        raise stored.fault(f"{name} do not ascend from 0 to {n_cells - 1}")
    return tuple(ends)


def _pair(stored: Fields, name: str, low: int) -> tuple[int, int]:
    pair = stored.integers(name, low)
    if len(pair) != 2:
        raise stored.fault(f"{name} has {len(pair)} numbers where 2 are due")
    return pair[0], pair[1]


def _lattice(stored: Fields) -> PointLattice:
    return PointLattice(
        scales=tuple(stored.numbers("scales", 3)),  # type: ignore[arg-type]
        offsets=tuple(stored.numbers("offsets", 3)),  # type: ignore[arg-type]
        first=_pair(stored, "first", -(2**32)),
        ratio=_pair(stored, "ratio", 1),
        spacing=stored.integer("spacing", 1),
        reach=stored.integer("reach", 1),
        n_points=stored.integer("n_points", 1),
    )
