"""Several DEMs of one grid as one, each cell of which is a cell of a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_gis._memory import require_bytes
from wavelet_gis.errors import InputFileError, RasterWarning
from wavelet_gis.model.dem import Dem, GridGeometry
from wavelet_gis.notes import note, warn

__all__ = ["first_cell", "mosaic", "require_alike", "require_free"]

#: How far cells of two files may be apart that are to be the same, in parts of a cell.
_SAME_CELL = 1e-3

Window = tuple[slice, slice]


def mosaic(names: Sequence[str], dems: Sequence[Dem]) -> Dem:
    """Return the DEM that several files are parts of.

    Parameters
    ----------
    names : sequence of str
        Of the files, for messages.
    dems : sequence of Dem
        With cells of one size in one grid. Where two have a cell in common, the first that has
        data there counts; where they differ it is warned of.

    Raises
    ------
    InputFileError
        Cells of another size, grid or type, or a gap without a number for nodata.
    """
    first = dems[0]
    for name, dem in zip(names[1:], dems[1:], strict=True):
        require_alike(names[0], first, name, dem)
    corners = np.array(
        [
            first_cell(names[0], first.geometry, name, dem.geometry)
            for name, dem in zip(names, dems, strict=True)
        ]
    )
    shapes = np.array([dem.geometry.shape for dem in dems])
    low, high = corners.min(axis=0), (corners + shapes).max(axis=0)
    n_rows, n_columns = (int(side) for side in high - low)
    require_bytes(
        n_rows * n_columns * (first.values.itemsize + 2),
        f"{names[0]} and {len(names) - 1} more",
        f"{n_rows} x {n_columns} cells",
    )
    values = np.zeros((n_rows, n_columns), dtype=first.values.dtype)
    valid = np.zeros((n_rows, n_columns), dtype=bool)
    n_differing, largest = 0, 0.0
    for dem, corner in zip(dems, corners - low, strict=True):
        window = (
            slice(int(corner[0]), int(corner[0]) + dem.geometry.shape[0]),
            slice(int(corner[1]), int(corner[1]) + dem.geometry.shape[1]),
        )
        count, difference = _differences(values[window], valid[window], dem)
        n_differing, largest = n_differing + count, max(largest, difference)
        is_new = dem.valid & ~valid[window]
        values[window][is_new] = dem.values[is_new]
        valid[window] |= is_new
    if n_differing:
        warn(
            RasterWarning,
            "overlap_differs",
            "{name} and {n_others} more: {count} cells that files have in common differ, by up to "
            "{largest:.4g}; those of the file named first count",
            stacklevel=3,
            name=names[0],
            n_others=len(names) - 1,
            count=f"{n_differing:,}",
            largest=largest,
        )
    nodata = _filled(names[0], first, values, valid)
    row, column = (int(k) for k in low)
    note(
        "mosaic",
        "{name} and {n_others} more: one raster of {n_rows} x {n_columns} cells",
        name=names[0],
        n_others=len(names) - 1,
        n_rows=n_rows,
        n_columns=n_columns,
    )
    return replace(
        first,
        values=values,
        valid=valid,
        geometry=first.geometry.window(row, column, (n_rows, n_columns)),
        nodata=nodata,
    )


def require_alike(name: str, first: Dem, other_name: str, other: Dem) -> None:
    """Refuse a raster whose numbers mean something else than those of the first.

    Parameters
    ----------
    name, other_name : str
        For the message.
    first, other : Dem

    Raises
    ------
    InputFileError
        They are of another type, or have another scale or offset.
    """
    pairs = (
        ("numbers of type", first.values.dtype.name, other.values.dtype.name),
        ("the scale", first.scale, other.scale),
        ("the offset", first.offset, other.offset),
    )
    for what, here, there in pairs:
        if here != there:
            raise InputFileError(
                f"{other_name}: this has {what} {there}, and {name} {here}; make them alike first "
                "(gdal_translate)."
            )


def first_cell(
    name: str, grid: GridGeometry, other_name: str, other: GridGeometry
) -> tuple[int, int]:
    """Return row and column, in one grid, of the first cell of a raster of the same cells.

    Parameters
    ----------
    name, other_name : str
        For the message.
    grid, other : GridGeometry

    Raises
    ------
    InputFileError
        The cells are others.
    """
    columns, rows = (
        np.array([0.0, other.shape[1] - 1.0, 0.0]),
        np.array([0.0, 0.0, other.shape[0] - 1.0]),
    )
    at_columns, at_rows = grid.cells(*other.centres(columns, rows))
    off = np.abs(
        [at_columns - np.rint(at_columns[0]) - columns, at_rows - np.rint(at_rows[0]) - rows]
    )
    if not off.max() <= _SAME_CELL:
        raise InputFileError(
            f"{other_name}: its cells are not those of the grid of {name} (other size, or shifted "
            f"by up to {off.max():.3g} cells); warp them to one grid first (gdalwarp -tap)."
        )
    return int(np.rint(at_rows[0])), int(np.rint(at_columns[0]))


def _differences(values: NDArray[Any], valid: NDArray[np.bool_], dem: Dem) -> tuple[int, float]:
    """Return how many cells with data in both differ, and the largest difference."""
    both = valid & dem.valid
    here, there = values[both].astype(np.float64), dem.values[both].astype(np.float64)
    differs = here != there
    return int(np.count_nonzero(differs)), float(
        np.abs(here - there).max(initial=0.0) * abs(dem.scale)
    )


def _filled(
    name: str, first: Dem, values: NDArray[Any], valid: NDArray[np.bool_]
) -> float | int | None:
    """Put the number for nodata where no file has data; return it."""
    nodata = first.nodata
    if valid.all():
        return nodata
    if nodata is None:
        if values.dtype.kind != "f":
            raise InputFileError(
                f"{name}: there are gaps between the files, or holes in them, and no number that "
                "stands for nodata; set one first (gdal_edit.py -a_nodata)."
            )
        nodata = float("nan")
    require_free(name, nodata, values[valid])
    values[~valid] = nodata
    return nodata


def require_free(name: str, nodata: float | int, elevations: NDArray[Any]) -> None:
    """Refuse a number for nodata that is an elevation as well.

    Parameters
    ----------
    name : str
        Of the file that it comes from.
    nodata : float or int
    elevations : array
        As stored.

    Raises
    ------
    InputFileError
        With the remedy.
    """
    if (elevations == nodata).any():
        raise InputFileError(
            f"{name}: its nodata value {nodata} is an elevation in another of the files; make them "
            "alike first (gdalwarp -dstnodata)."
        )
