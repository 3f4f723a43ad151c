"""A surface of a pyramid evaluated on a grid, as a DEM in the coordinates of the input."""

from __future__ import annotations

import numpy as np

from wavelet_core import TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_gis.model.attributes.categories import Categories, nearest_vertices
from wavelet_gis.model.dem import Dem, GridGeometry
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.rasterise import geometry_over, rasterise
from wavelet_gis.products.vertex_raster import point_cell_size

__all__ = ["surface_dem", "surface_difference"]


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
        spacing of the mesh's vertices.
    attribute : str, optional
        What to evaluate instead of the elevation.
    categories : {"nearest", "number"}
        A category, such as a class, is that of the nearest vertex, or, as in the paper, a number
        like any other.

    Returns
    -------
    Dem
        Of 64-bit floats where the input was such a raster, else of 32-bit ones; cells that no face
        covers hold the input's nodata value, or NaN.

    Raises
    ------
    OptionError
        When there is no such attribute.
    """
    in_file = geo.file_mesh(mesh, categories=categories)
    values = _attribute_values(in_file, attribute) if attribute else None
    given = geo.origin.grid
    if given is not None and not cell_size:
        geometry = given.geometry
    else:
        geometry = _geometry(in_file, cell_size or point_cell_size(geo))
    grid = rasterise(in_file, geometry, values)
    if values is not None and attribute in geo.categories and categories == "nearest":
        rows, columns = np.nonzero(np.isfinite(grid))
        x, y = geometry.centres(columns, rows)
        local = np.column_stack([geo.frame.local_x(x), geo.frame.local_y(y)])
        if len(local):
            grid[rows, columns] = values[nearest_vertices(mesh, local)]
    if given is None or given.dtype != np.float64:
        grid = grid.astype(np.float32)
    covered = np.isfinite(grid)
    tag = float("nan")
    if given is not None and given.nodata is not None:
        largest = float(np.finfo(grid.dtype).max)
        tag = float(given.nodata) if abs(float(given.nodata)) <= largest else tag
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


def _geometry(mesh: TriangleMesh, cell_size: float | None) -> GridGeometry:
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    area = (high[0] - low[0]) * (high[1] - low[1])
    size = cell_size or float(np.sqrt(area / mesh.n_vertices))
    return geometry_over((low[0], low[1], high[0], high[1]), size)


def _attribute_values(mesh: TriangleMesh, attribute: str) -> np.ndarray:
    if attribute not in mesh.attribute_names:
        raise OptionError(
            f"the pyramid has no attribute {attribute!r}; it has "
            f"{', '.join(mesh.attribute_names) or 'none'}."
        )
    return mesh.attributes[:, mesh.attribute_names.index(attribute)]
