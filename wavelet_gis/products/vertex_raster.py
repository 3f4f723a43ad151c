"""Columns of values at the vertices of a pyramid as the bands of one raster."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_gis.errors import InputFileError
from wavelet_gis.model.dem import GridGeometry
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.rasterise import geometry_over, rasterise

__all__ = ["Bands", "grid_of", "label_band", "point_cell_size", "value_bands", "write_bands"]

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
    """
    if geo.origin.grid is not None and cell_size is None:
        return geo.origin.grid.geometry
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
    """
    geometry = grid_of(geo, mesh, cell_size)
    values = np.full((len(names), *geometry.shape), np.nan, dtype=np.float32)
    valid = _valid_cells(geo, mesh, cell_size)
    if valid is not None:
        values[:, valid] = columns.T
    else:
        in_file = geo.file_mesh(mesh)
        for band, column in zip(values, columns.T, strict=True):
            band[:] = rasterise(in_file, geometry, column)
    return Bands(values, tuple(names), geometry)


def label_band(
    geo: GeoPyramid,
    mesh: TriangleMesh,
    labels: NDArray[np.integer[Any]],
    name: str,
    cell_size: float | None = None,
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

    Raises
    ------
    InputFileError
        A label above 254.
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
        rows, columns = np.nonzero(np.isfinite(rasterise(in_file, geometry)))
        x, y = geometry.centres(columns, rows)
        local = np.column_stack([geo.frame.local_x(x), geo.frame.local_y(y)])
        if len(local):
            nearest = cKDTree(mesh.vertices[:, :2]).query(local)[1]
            values[0, rows, columns] = stored[nearest]
    return Bands(values, (name,), geometry)


def write_bands(path: str | os.PathLike[str], bands: Bands, wkt: str | None) -> None:
    """Write bands to a GeoTIFF, each with its name.

    Parameters
    ----------
    path : path
        A file that does not exist yet.
    bands : Bands
        What to write.
    wkt : str or None
        The CRS.
    """
    import rasterio
    from rasterio.transform import Affine

    n_bands, n_rows, n_columns = bands.values.shape
    with rasterio.open(
        os.fspath(path),
        "w",
        driver="GTiff",
        count=n_bands,
        height=n_rows,
        width=n_columns,
        dtype=bands.values.dtype.name,
        crs=wkt,
        transform=Affine(*bands.geometry.transform),
        nodata=bands.nodata,
        compress="deflate",
        tiled=True,
        predictor=3 if bands.values.dtype.kind == "f" else 1,
        bigtiff="if_safer",
    ) as dataset:
        for k, (band, name) in enumerate(zip(bands.values, bands.names, strict=True), start=1):
            dataset.write(band, k)
            dataset.set_band_description(k, name)


def _valid_cells(
    geo: GeoPyramid, mesh: TriangleMesh, cell_size: float | None
) -> NDArray[np.bool_] | None:
    """Return the cells of the input's own grid, if they are the vertices of the mesh one by one."""
    grid = geo.origin.grid
    if grid is None or cell_size is not None:
        return None
    return grid.valid if mesh.n_vertices == geo.origin.n_vertices else None
