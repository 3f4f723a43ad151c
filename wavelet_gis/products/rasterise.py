"""A TIN evaluated on a grid: exact linear interpolation at every cell centre that it covers."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.dem import GridGeometry

__all__ = ["geometry_over", "rasterise"]

#: A centre this far outside a face, in cells, still counts as on its edge.
TOLERANCE = 1e-6

#: Faces, and cells, that are worked on at once; they bound the memory, not the result.
_FACES_AT_ONCE = 1 << 18
_CELLS_AT_ONCE = 1 << 21

#: More cells than this are refused rather than tried.
MAX_CELLS = 2_000_000_000

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def rasterise(
    mesh: TriangleMesh, geometry: GridGeometry, values: FloatArray | None = None
) -> FloatArray:
    """Values of the TIN at the cell centres; NaN where no face covers them.

    Parameters
    ----------
    mesh : TriangleMesh
        In the coordinates of the grid's geometry.
    geometry : GridGeometry
        Size and place of the grid; it may be rotated.
    values : (n_vertices,) float64, optional
        What is interpolated; by default z.

    Returns
    -------
    ndarray of float64, shape (n_rows, n_columns)
        On an edge that two faces share both give the same value.

    Examples
    --------
    >>> from wavelet_core import TriangleMesh
    >>> mesh = TriangleMesh([[0, 0, 0], [4, 0, 4], [0, 4, 0]], [[0, 1, 2]])
    >>> grid = GridGeometry((2, 2), (2.0, 0.0, 0.0, 0.0, -2.0, 4.0))
    >>> rasterise(mesh, grid).tolist()
    [[1.0, nan], [1.0, 3.0]]
    """
    columns, rows = map(_snapped, geometry.cells(mesh.vertices[:, 0], mesh.vertices[:, 1]))
    values = mesh.vertices[:, 2] if values is None else values
    result = np.full(geometry.shape, np.nan)
    flat = result.reshape(-1)
    for start in range(0, mesh.n_faces, _FACES_AT_ONCE):
        faces = mesh.faces[start : start + _FACES_AT_ONCE]
        corners = np.stack([columns[faces], rows[faces]], axis=2)
        of_corner = values[faces]
        for face, row, column in _covered_cells(corners, geometry.shape):
            weights = _barycentric(corners[face], column, row)
            flat[row * geometry.shape[1] + column] = (weights * of_corner[face]).sum(axis=1)
    return result


def geometry_over(bounds: tuple[float, float, float, float], cell_size: float) -> GridGeometry:
    """Return a north-up grid whose cells cover the bounds.

    Parameters
    ----------
    bounds : (x_min, y_min, x_max, y_max)
        To be covered.
    cell_size : float
        Width and height of a cell, in the unit of the bounds.

    Raises
    ------
    InputFileError
        When the cell size is no length, or the grid would be too large.

    Examples
    --------
    >>> geometry_over((0.0, 0.0, 10.0, 4.0), 2.0).shape
    (2, 5)
    """
    x_min, y_min, x_max, y_max = bounds
    if not (np.isfinite(cell_size) and cell_size > 0):
        raise InputFileError(f"the cell size is {cell_size}; give a length above 0.")
    n_columns = max(int(np.ceil((x_max - x_min) / cell_size - 1e-9)), 1)
    n_rows = max(int(np.ceil((y_max - y_min) / cell_size - 1e-9)), 1)
    if n_columns * n_rows > MAX_CELLS:
        raise InputFileError(
            f"a cell size of {cell_size} gives {n_rows} x {n_columns} cells; choose a larger one."
        )
    return GridGeometry((n_rows, n_columns), (cell_size, 0.0, x_min, 0.0, -cell_size, y_max))


def _snapped(positions: FloatArray) -> FloatArray:
    """Put vertices that are cell centres but for rounding on them, so their values come back."""
    nearest = np.rint(positions)
    return np.where(np.abs(positions - nearest) < TOLERANCE, nearest, positions)


def _covered_cells(
    corners: FloatArray, shape: tuple[int, int]
) -> Iterator[tuple[IntArray, IntArray, IntArray]]:
    """Yield face, row and column of every cell centre that a face covers, in batches.

    Each face is cut into its rows and each row into its cells, so the work is what is covered,
    also for slivers that cross the whole grid.
    """
    low = np.ceil(corners[:, :, 1].min(axis=1) - TOLERANCE)
    high = np.floor(corners[:, :, 1].max(axis=1) + TOLERANCE)
    first = np.clip(low, 0, shape[0]).astype(np.int64)
    last = np.clip(high, -1, shape[0] - 1).astype(np.int64)
    for faces, rows in _expanded(first, last):
        left, right = _row_interval(corners[faces], rows)
        from_column = np.clip(np.ceil(left - TOLERANCE), 0, shape[1]).astype(np.int64)
        to_column = np.clip(np.floor(right + TOLERANCE), -1, shape[1] - 1).astype(np.int64)
        for spans, columns in _expanded(from_column, to_column):
            yield faces[spans], rows[spans], columns


def _expanded(first: IntArray, last: IntArray) -> Iterator[tuple[IntArray, IntArray]]:
    """Yield ``(k, first[k] ... last[k])`` for all k, in batches."""
    counts = np.maximum(last - first + 1, 0)
    ends = np.cumsum(counts)
    start = 0
    while start < len(counts):
        before = ends[start - 1] if start else 0
        stop = int(np.searchsorted(ends, before + _CELLS_AT_ONCE, side="right"))
        stop = max(stop, start + 1)
        n = counts[start:stop]
        owner = np.repeat(np.arange(start, stop), n)
        offset = np.arange(len(owner)) - np.repeat(np.cumsum(n) - n, n)
        yield owner, first[owner] + offset
        start = stop


def _row_interval(corners: FloatArray, rows: IntArray) -> tuple[FloatArray, FloatArray]:
    """First and last column that each triangle reaches in a row.

    The interval is spanned by the crossings of the row with the edges; a row just beside the
    triangle is moved onto it.
    """
    left = np.full(len(rows), np.inf)
    right = np.full(len(rows), -np.inf)
    inside = np.clip(rows, corners[:, :, 1].min(axis=1), corners[:, :, 1].max(axis=1))
    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        crosses = (np.minimum(a[:, 1], b[:, 1]) <= inside) & (
            inside <= np.maximum(a[:, 1], b[:, 1])
        )
        rise = b[:, 1] - a[:, 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            along = np.where(rise == 0, 0.0, (inside - a[:, 1]) / rise)
        column = a[:, 0] + np.clip(along, 0, 1) * (b[:, 0] - a[:, 0])
        # Of a level edge both ends count; each is also the end of another edge.
        left = np.where(crosses, np.minimum(left, column), left)
        right = np.where(crosses, np.maximum(right, column), right)
    return left, right


def _barycentric(corners: FloatArray, columns: IntArray, rows: IntArray) -> FloatArray:
    """Weights of the three corners at a cell, within the triangle whatever rounding does."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    u, v = columns - a[:, 0], rows - a[:, 1]
    ab, ac = b - a, c - a
    doubled = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    flat = doubled == 0
    doubled = np.where(flat, 1.0, doubled)
    weight_b = (u * ac[:, 1] - v * ac[:, 0]) / doubled
    weight_c = (ab[:, 0] * v - ab[:, 1] * u) / doubled
    weights = np.column_stack([1 - weight_b - weight_c, weight_b, weight_c])
    weights = np.clip(weights, 0, 1)
    weights[flat] = 1 / 3
    weights /= weights.sum(axis=1, keepdims=True)
    return weights
