"""A surface of a pyramid evaluated on a grid, as a DEM in the coordinates of the input."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_gis.model.attributes.categories import Categories, nearest_vertices
from wavelet_gis.model.dem import Dem, taken_for_nodata
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.lone_vertices import fill_lone_cells
from wavelet_gis.products.rasterise import rasterise
from wavelet_gis.products.vertex_raster import grid_of

__all__ = ["surface_dem", "surface_difference", "tag_without_clash"]


def surface_dem(
    geo: GeoPyramid,
    mesh: TriangleMesh,
    *,
    cell_size: float | None = None,
    attribute: str | None = None,
    categories: Categories = "nearest",
) -> Dem:
    """Return the values of a mesh of the pyramid at the cell centres of a grid.

    Parameters
    ----------
    geo : GeoPyramid
        Gives the frame, and the grid where it was made from a raster.
    mesh : TriangleMesh
        In the working frame.
    cell_size : float, optional
        Of a grid over the mesh, in the input's unit of x and y. By default the grid of the raster
        that the pyramid was made from, or the spacing of its points; without either, the mean
        spacing of the mesh's vertices. See `wavelet_gis.products.vertex_raster.grid_of`.
    attribute : str, optional
        What to evaluate instead of the elevation.
    categories : {"nearest", "number"}
        A category, such as a class, is that of the nearest vertex, or, as in the paper, a number
        like any other.

    Returns
    -------
    Dem
        Of 64-bit floats where the input was such a raster, else of 32-bit ones. A cell that no face
        covers has the height of a vertex without faces in it; the others hold the input's nodata
        value, or NaN where that would be an elevation.

    Raises
    ------
    OptionError
        When there is no such attribute.
    """
    in_file = geo.file_mesh(mesh, categories=categories)
    values = _attribute_values(in_file, attribute) if attribute else None
    given = geo.origin.grid
    geometry = grid_of(geo, mesh, cell_size)
    grid = fill_lone_cells(rasterise(in_file, geometry, values), in_file, geometry, values)
    if values is not None and attribute in geo.categories and categories == "nearest":
        rows, columns = np.nonzero(np.isfinite(grid))
        x, y = geometry.centres(columns, rows)
        local = np.column_stack([geo.frame.local_x(x), geo.frame.local_y(y)])
        if len(local):
            grid[rows, columns] = values[nearest_vertices(mesh, local)]
    if given is None or given.dtype != np.float64:
        grid = grid.astype(np.float32)
    covered = np.isfinite(grid)
    # The input's tag stands for its stored numbers, which are no elevations where it has a scale.
    wished = None if given is None or given.is_scaled else given.nodata
    tag = tag_without_clash(grid, covered, wished)
    grid[~covered] = tag
    profile = {"options": {"compress": "deflate", "predictor": 3, "tiled": True}}
    return Dem(grid, covered, geometry, tag, profile=profile)


def surface_difference(
    before: GeoPyramid,
    after: GeoPyramid,
    finest: tuple[TriangleMesh, TriangleMesh] | None = None,
) -> Dem:
    """Return the finest surface of one pyramid minus that of another, on the grid of their raster.

    Parameters
    ----------
    before, after : GeoPyramid
        Of the same raster: a pyramid, and the same one filtered; ``after`` less ``before``.
    finest : (TriangleMesh, TriangleMesh), optional
        Their finest meshes, where they have been synthesised already.
    """
    meshes = finest or (before.pyramid.synthesise(), after.pyramid.synthesise())
    old, new = map(surface_dem, (before, after), meshes)
    valid = old.valid & new.valid
    values = np.where(valid, new.values - old.values, np.float32("nan")).astype(np.float32)
    return Dem(values, valid, old.geometry, float("nan"), profile=old.profile)


def tag_without_clash(
    values: NDArray[np.floating[Any]], covered: NDArray[np.bool_], wished: float | int | None
) -> float:
    """Return the nodata value for a raster of floats: the wished one, or NaN where it is data.

    Parameters
    ----------
    values : ndarray of float
        The raster.
    covered : ndarray of bool
        Its cells with data.
    wished : float, int or None
        What the input had.
    """
    if wished is None or abs(float(wished)) > float(np.finfo(values.dtype).max):
        return float("nan")
    is_clash = bool(taken_for_nodata(values[covered], wished).any())
    return float("nan") if is_clash else float(wished)


def _attribute_values(mesh: TriangleMesh, attribute: str) -> np.ndarray:
    if attribute not in mesh.attribute_names:
        raise OptionError(
            f"the pyramid has no attribute {attribute!r}; it has "
            f"{', '.join(mesh.attribute_names) or 'none'}."
        )
    return mesh.attributes[:, mesh.attribute_names.index(attribute)]
