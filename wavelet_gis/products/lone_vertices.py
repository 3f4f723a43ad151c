"""Vertices without a triangle on a grid: a cell whose height is known has it, surface or not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_gis.model.dem import GridGeometry

__all__ = ["fill_lone_cells", "lone_vertices"]


def lone_vertices(mesh: TriangleMesh) -> NDArray[np.int64]:
    """Return the vertices that no face uses."""
    is_lone = np.ones(mesh.n_vertices, dtype=bool)
    is_lone[mesh.faces.reshape(-1)] = False
    return np.flatnonzero(is_lone)


def fill_lone_cells(
    grid: NDArray[np.float64],
    mesh: TriangleMesh,
    geometry: GridGeometry,
    values: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Write the values of vertices that no face uses into the cells that they lie in.

    A single cell among holes and a strip one cell wide have no triangles, yet their heights are
    known.

    Parameters
    ----------
    grid : (n_rows, n_columns) float64
        From `wavelet_gis.products.rasterise.rasterise`, NaN where no face covers it; filled.
    mesh : TriangleMesh
        In the coordinates of the grid's geometry.
    geometry : GridGeometry
        Of the grid.
    values : (n_vertices,) float64, optional
        What is shown; by default z.

    Returns
    -------
    ndarray of float64
        The grid.
    """
    lone = lone_vertices(mesh)
    if not len(lone):
        return grid
    columns, rows = geometry.cells(mesh.vertices[lone, 0], mesh.vertices[lone, 1])
    column, row = np.rint(columns), np.rint(rows)
    inside = (row >= 0) & (row < grid.shape[0]) & (column >= 0) & (column < grid.shape[1])
    # The nearest to a cell's centre is written last, and so is what stays.
    order = np.argsort(-np.hypot(columns - column, rows - row), kind="stable")
    order = order[inside[order]]
    at = row[order].astype(np.int64), column[order].astype(np.int64)
    known = (mesh.vertices[:, 2] if values is None else values)[lone[order]]
    empty = np.isnan(grid[at])
    grid[at[0][empty], at[1][empty]] = known[empty]
    return grid
