"""A TIN evaluated on a grid: exact linear interpolation at every cell centre that it covers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.mesh.location import cover_of
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.dem import GridGeometry

__all__ = ["geometry_over", "rasterise"]

#: A vertex this near to a cell centre, in cells, is on it but for rounding.
TOLERANCE = 1e-6

#: Cells that are worked on at once: a bound on the memory.
_CELLS_AT_ONCE = 1 << 21

#: More cells than this are refused rather than tried.
MAX_CELLS = 2_000_000_000

FloatArray = NDArray[np.float64]


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
    # in cells, so that vertices on cell centres have whole numbers and give their values back
    in_cells = TriangleMesh(np.column_stack([columns, rows, values]), mesh.faces)
    n_rows, n_columns = geometry.shape
    result = np.full(geometry.shape, np.nan)
    rows_at_once = max(_CELLS_AT_ONCE // n_columns, 1)
    for first in range(0, n_rows, rows_at_once):
        last = min(first + rows_at_once, n_rows)
        row, column = np.divmod(np.arange((last - first) * n_columns), n_columns)
        centres = np.column_stack([column, row + first]).astype(np.float64)
        cover = cover_of(in_cells, centres)
        a, b, c = in_cells.faces[cover.face].T
        at_b, at_c = np.clip(cover.at_b, 0.0, 1.0), np.clip(cover.at_c, 0.0, 1.0)
        at_a = np.clip(1.0 - cover.at_b - cover.at_c, 0.0, 1.0)
        block = (at_a * values[a] + at_b * values[b] + at_c * values[c]) / (at_a + at_b + at_c)
        result[first:last].reshape(-1)[cover.point] = block
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
