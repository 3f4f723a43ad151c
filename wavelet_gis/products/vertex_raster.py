"""Columns of values at the vertices of a pyramid as the bands of one raster."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, TriangleMesh
from wavelet_core.progress import report, watched_part
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.dem import GridGeometry, grid_bounds
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.lone_vertices import fill_lone_cells
from wavelet_gis.products.rasterise import geometry_over, rasterise

__all__ = ["Bands", "grid_of", "label_band", "point_cell_size", "value_bands"]

#: Cells whose nearest vertices are looked for between two reports.
CELLS_AT_ONCE = 100_000
#: Stored in cells without a label.
NO_LABEL = 255


@dataclass(frozen=True, slots=True)
class Bands:
    """Several rasters on one grid.

    Attributes
    ----------
    values : (n_bands, n_rows, n_columns) float32 or uint8
        NaN, or ``NO_LABEL`` of bytes, where there is nothing.
    names : tuple of str
        One for each band.
    geometry : GridGeometry
        Where the cells are.
    """

    values: NDArray[Any]
    names: tuple[str, ...]
    geometry: GridGeometry

    @property
    def nodata(self) -> float | int:
        """What stands for nothing."""
        return NO_LABEL if self.values.dtype == np.uint8 else float("nan")


def grid_of(geo: GeoPyramid, mesh: TriangleMesh, cell_size: float | None = None) -> GridGeometry:
    """Return the grid on which values of a pyramid are shown.

    Parameters
    ----------
    geo : GeoPyramid
        Its own grid is taken where it was made from a raster and no cell size is given.
    mesh : TriangleMesh
        In the working frame.
    cell_size : float, optional
        In the input's unit of x and y; by default, for points, their spacing.

    Notes
    -----
    A raster's own cell size gives its own grid, to the cell; another one a grid over the raster's
    cells, edge to edge, so that cells of twice the size hold four of them.
    """
    if geo.origin.grid is not None:
        own = geo.origin.grid.geometry
        if not cell_size or _has_cell_size(own, cell_size):
            return own
        return geometry_over(grid_bounds(own), cell_size)
    cell_size = cell_size or None
    vertices = geo.frame.to_file(mesh.vertices)
    (x_min, y_min, _), (x_max, y_max, _) = vertices.min(axis=0), vertices.max(axis=0)
    if cell_size is None:
        cell_size = point_cell_size(geo)
    if cell_size is None:
        cell_size = float(np.sqrt((x_max - x_min) * (y_max - y_min) / max(len(vertices), 1)))
    return geometry_over((x_min, y_min, x_max, y_max), cell_size)


def point_cell_size(geo: GeoPyramid) -> float | None:
    """Return the spacing of the points that a pyramid was made from, in the input's unit.

    None where it was made from something else. Gaps of the cloud do not count: a hull that they
    take half of would give cells that each hold two points.
    """
    points = geo.origin.points
    if points is None or points.spacing is None:
        return None
    return float(points.spacing / np.sqrt(geo.frame.x_scale * geo.frame.y_scale))


def value_bands(
    geo: GeoPyramid,
    mesh: TriangleMesh,
    columns: NDArray[np.float64],
    names: Sequence[str],
    cell_size: float | None = None,
    progress: Progress | None = None,
) -> Bands:
    """Values at the vertices of a mesh, interpolated on its faces, one band a column.

    Parameters
    ----------
    geo : GeoPyramid
        Gives frame and grid.
    mesh : TriangleMesh
        In the working frame.
    columns : (n_vertices, n_bands) float64
        What is shown.
    names : sequence of str
        Of the bands.
    cell_size : float, optional
        See `grid_of`.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    geometry = grid_of(geo, mesh, cell_size)
    values = np.full((len(names), *geometry.shape), np.nan, dtype=np.float32)
    valid = _valid_cells(geo, mesh, cell_size)
    if valid is not None:
        values[:, valid] = columns.T
    else:
        in_file = geo.file_mesh(mesh)
        for k, column in enumerate(columns.T):
            values[k] = fill_lone_cells(
                rasterise(in_file, geometry, column), in_file, geometry, column
            )
            report(progress, (k + 1) / len(values))
    return Bands(values, tuple(names), geometry)


def label_band(
    geo: GeoPyramid,
    mesh: TriangleMesh,
    labels: NDArray[np.integer[Any]],
    name: str,
    cell_size: float | None = None,
    progress: Progress | None = None,
) -> Bands:
    """Labels of vertices as a raster of bytes: each cell has that of the vertex nearest in plan.

    Parameters
    ----------
    geo : GeoPyramid
        Gives frame and grid.
    mesh : TriangleMesh
        The finest one, in the working frame.
    labels : (n_vertices,) int
        0 to 254; anything below 0 is nothing.
    name : str
        Of the band.
    cell_size : float, optional
        See `grid_of`.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    InputFileError
        A label above 254.
    Cancelled
        ``progress`` returned False.
    """
    if labels.max(initial=0) >= NO_LABEL:
        raise InputFileError(
            f"label {labels.max()} does not fit a raster of bytes; use labels of 0 to 254."
        )
    stored = np.where(labels < 0, NO_LABEL, labels).astype(np.uint8)
    geometry = grid_of(geo, mesh, cell_size)
    values = np.full((1, *geometry.shape), NO_LABEL, dtype=np.uint8)
    valid = _valid_cells(geo, mesh, cell_size)
    if valid is not None:
        values[0, valid] = stored
    else:
        from scipy.spatial import cKDTree

        in_file = geo.file_mesh(mesh)
        with watched_part(progress, 0.0, 0.3):
            covered = fill_lone_cells(rasterise(in_file, geometry), in_file, geometry)
        rows, columns = np.nonzero(np.isfinite(covered))
        x, y = geometry.centres(columns, rows)
        local = np.column_stack([geo.frame.local_x(x), geo.frame.local_y(y)])
        report(progress, 0.35)
        vertices = cKDTree(mesh.vertices[:, :2])
        for first in range(0, len(local), CELLS_AT_ONCE):
            report(progress, 0.5 + 0.5 * first / len(local))
            part = slice(first, first + CELLS_AT_ONCE)
            nearest = vertices.query(local[part])[1]
            values[0, rows[part], columns[part]] = stored[nearest]
    report(progress, 1.0)
    return Bands(values, (name,), geometry)


def _valid_cells(
    geo: GeoPyramid, mesh: TriangleMesh, cell_size: float | None
) -> NDArray[np.bool_] | None:
    """Return the cells of the input's own grid, if they are the vertices of the mesh one by one."""
    grid = geo.origin.grid
    if grid is None or (cell_size and not _has_cell_size(grid.geometry, cell_size)):
        return None
    return grid.valid if mesh.n_vertices == geo.origin.n_vertices else None


def _has_cell_size(geometry: GridGeometry, cell_size: float) -> bool:
    a, b, _, d, e, _ = geometry.transform
    sides = (math.hypot(a, d), math.hypot(b, e))
    return all(math.isclose(side, cell_size, rel_tol=1e-6) for side in sides)
