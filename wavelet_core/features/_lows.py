"""The lowest points of a cloud on a grid, and surfaces through them, as whole arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from .._validate import FloatArray, IntArray
from ..errors import MeshError

__all__ = ["LowGrid", "at_points", "filled_from_coarse", "grid_of_lows", "opened", "slope_of"]

#: Finest cell, in metres: below it the spread of the points' own heights counts, not the ground.
FINEST_CELL = 0.5

#: Cells for each point, at most; more are a stray point far away, or a spacing that is none.
MOST_CELLS_PER_POINT = 400


class LowGrid(NamedTuple):
    """The lowest point of every cell.

    low : (n_rows, n_columns) float64, NaN in cells without points
    row, column : (n_points,) float64, where points are; the centre of the first cell is 0
    cell : (n_points,) int64, flat index
    size : float, side of a cell
    """

    low: FloatArray
    row: FloatArray
    column: FloatArray
    cell: IntArray
    size: float


def grid_of_lows(points: FloatArray) -> LowGrid:
    """Return the lowest points on a grid whose cells hold about one point each.

    Parameters
    ----------
    points : (n_points, 3) float64
        x, y, z; one unit, metres.

    Raises
    ------
    MeshError
        When the points are so scattered that the grid would be nearly empty.
    """
    plan = points[:, :2] - points[:, :2].min(axis=0)
    size = max(_spacing(plan), FINEST_CELL)
    n_columns, n_rows = (max(int(extent // size) + 1, 2) for extent in plan.max(axis=0))
    if n_rows * n_columns > MOST_CELLS_PER_POINT * max(len(points), 1000):
        raise MeshError(
            f"{len(points)} points are scattered over {n_rows} x {n_columns} cells of {size:.3g} m "
            "each, so there is no surface between them; cut stray points off."
        )
    columns, rows = (plan // size).astype(np.int64).T
    cell = rows * n_columns + columns
    low = np.full(n_rows * n_columns, np.inf)
    np.minimum.at(low, cell, points[:, 2])
    low[np.isinf(low)] = np.nan
    at = plan / size - 0.5
    return LowGrid(low.reshape(n_rows, n_columns), at[:, 1], at[:, 0], cell, size)


def _spacing(plan: FloatArray) -> float:
    """Return the side of the square that one point has to itself, empty places left out."""
    extent = plan.max(axis=0)
    spacing = float(np.sqrt(max(float(extent.prod()), 1e-12) / len(plan)))
    if extent.min() < 3.0 * spacing:  # a line of points
        return float(extent.max()) / len(plan)
    while True:
        coarse = 3.0 * spacing
        columns, rows = (plan // coarse).astype(np.int64).T
        n_taken = len(np.unique(rows * (int(extent[0] // coarse) + 1) + columns))
        before, spacing = spacing, coarse * float(np.sqrt(n_taken / len(plan)))
        if spacing > 0.7 * before or spacing < FINEST_CELL:  # no more empty places come to light
            return spacing


def opened(surface: FloatArray, radius: int) -> FloatArray:
    """Return the highest surface below one that no square of ``2 radius + 1`` cells pierces.

    Notes
    -----
    A grey opening with the surface mirrored at the border, where a roof that the border cuts is
    then as wide as it may be.
    """
    result: FloatArray = ndimage.grey_opening(surface, size=2 * radius + 1, mode="reflect")
    return result


def nearest_filled(surface: FloatArray) -> FloatArray:
    """Return a surface whose NaN have the value of the nearest other cell."""
    is_empty = np.isnan(surface)
    if not is_empty.any():
        return surface
    where = ndimage.distance_transform_edt(is_empty, return_distances=False, return_indices=True)
    result: FloatArray = surface[tuple(where)]
    return result


def filled_from_coarse(surface: FloatArray) -> FloatArray:
    """Return a surface whose NaN are filled from coarser levels, each from the next.

    Notes
    -----
    Going down, a cell is the mean of those of its four that are known; going up, unknown ones are
    interpolated between the coarser cells.
    """
    levels = [surface]
    while np.isnan(levels[-1]).any() and max(levels[-1].shape) > 1:
        levels.append(_halved(levels[-1]))
    result = levels.pop()
    for finer in reversed(levels):
        at = [(np.arange(n) - 0.5) / 2 for n in finer.shape]
        rows, columns = np.meshgrid(*at, indexing="ij")
        between = ndimage.map_coordinates(result, [rows, columns], order=1, mode="nearest")
        result = np.where(np.isnan(finer), between, finer)
    return result


def _halved(surface: FloatArray) -> FloatArray:
    n_rows, n_columns = ((n + 1) // 2 for n in surface.shape)
    padded = np.full((2 * n_rows, 2 * n_columns), np.nan)
    padded[: surface.shape[0], : surface.shape[1]] = surface
    fours = padded.reshape(n_rows, 2, n_columns, 2)
    n_known = np.count_nonzero(~np.isnan(fours), axis=(1, 3))
    sums = np.nansum(fours, axis=(1, 3))
    result: FloatArray = np.where(n_known > 0, sums / np.maximum(n_known, 1), np.nan)
    return result


def slope_of(surface: FloatArray, size: float) -> FloatArray:
    """Return the slope of a surface, rise over run."""
    down, across = np.gradient(surface, size)
    slope: FloatArray = np.hypot(down, across)
    return slope


def at_points(surface: FloatArray, grid: LowGrid) -> FloatArray:
    """Return a surface where the points are, interpolated between the centres of cells."""
    result: FloatArray = ndimage.map_coordinates(
        surface, [grid.row, grid.column], order=1, mode="nearest"
    )
    return result


def steps_of_rims(
    labels: IntArray, surface: FloatArray, is_known: NDArray[np.bool_], height: float
) -> tuple[IntArray, IntArray]:
    """Return how many sides of cells are on the rim of each labelled area, and how many are steps.

    Parameters
    ----------
    labels : (n_rows, n_columns) int
        0 outside.
    surface : (n_rows, n_columns) float64
        Heights.
    is_known : (n_rows, n_columns) bool
        Where the height is measured; other sides do not count.
    height : float
        A rise of more than this, from the outside in, is a step.
    """
    n_labels = int(labels.max(initial=0)) + 1
    n_sides = np.zeros(n_labels, dtype=np.int64)
    n_steps = np.zeros(n_labels, dtype=np.int64)
    first, last = slice(None, -1), slice(1, None)
    for inside, outside in (
        ((first, slice(None)), (last, slice(None))),
        ((last, slice(None)), (first, slice(None))),
        ((slice(None), first), (slice(None), last)),
        ((slice(None), last), (slice(None), first)),
    ):
        is_rim = (labels[inside] > 0) & (labels[outside] == 0)
        is_rim &= is_known[inside] & is_known[outside]
        of = labels[inside][is_rim]
        rise = surface[inside][is_rim] - surface[outside][is_rim]
        n_sides += np.bincount(of, minlength=n_labels)
        n_steps += np.bincount(of[rise > height], minlength=n_labels)
    return n_sides, n_steps
