"""Results into files, whole or not at all.

What needs rasterio or pyogrio is imported where it is written, so that QGIS, which writes rasters
and vectors itself, can use all else.
"""

from __future__ import annotations

import os
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_gis.io.atomic import check_output, new_file
from wavelet_gis.io.formats import (
    MESH_SUFFIXES,
    PYRAMID_SUFFIX,
    RASTER_SUFFIXES,
    suffix_of,
)
from wavelet_gis.model.attributes.categories import Categories
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.layers import Layers, check_layers, pyramid_layers

__all__ = [
    "Layers",
    "Writable",
    "check_surface_output",
    "save",
    "write_pyramid_file",
    "write_surface_raster",
    "write_tin",
]

Path = str | os.PathLike[str]


class Writable(Protocol):
    """A result that writes itself into a new file."""

    def write(self, path: Path, **options: Any) -> Any:
        """Write to a path that does not exist, in the format of its suffix."""


def save(result: Any, path: Path, *, overwrite: bool = False, **options: Any) -> Any:
    """Write what a workflow returned to a file, whole or not at all; the suffix is the format.

    Parameters
    ----------
    result : Analysis, Surface, Reconstruction, Filtered, Details or Labelled
        What to write.
    path : path
        Where to.
    overwrite : bool
        Whether a file that exists there may be replaced.
    **options
        Of the result's own ``write``, such as ``layers`` or ``cell_size``.

    Returns
    -------
    dict or None
        Figures of what was written, if the result has some.

    Raises
    ------
    OptionError
        Something that no workflow returned.
    OutputFileError
        A suffix that does not fit, a file that exists, or a folder that cannot be written.
    """
    write = getattr(result, "write", None)
    if write is None:
        raise OptionError(
            f"a {type(result).__name__} cannot be saved; give what a function of wavelet_gis "
            "returned."
        )
    with new_file(path, overwrite=overwrite) as scratch:
        return write(scratch, **options)


def check_surface_output(
    path: Path,
    *,
    overwrite: bool = False,
    inputs: tuple[Path, ...] = (),
    cell_size: float | None = None,
    attribute: str | None = None,
    cog: bool = False,
    to_crs: str | None = None,
) -> None:
    """Refuse, before the long work, an output that a surface cannot be written to.

    Parameters
    ----------
    path : path
        Where the surface is wanted: a TIN or a raster, by its suffix.
    overwrite, inputs
        See `wavelet_gis.io.atomic.check_output`.
    cell_size, attribute, cog
        Options of a raster.
    to_crs
        Of a mesh file.

    Raises
    ------
    OutputFileError
        See `wavelet_gis.io.atomic.check_output`.
    OptionError
        Options of a raster, or of a mesh file, for an output that is not one.
    """
    suffixes = (PYRAMID_SUFFIX, *MESH_SUFFIXES, *RASTER_SUFFIXES)
    check_output(path, overwrite=overwrite, suffixes=suffixes, inputs=inputs)
    is_raster = suffix_of(path) in RASTER_SUFFIXES
    if not is_raster and (cell_size is not None or attribute or cog):
        raise OptionError(
            "{0}, {1} and {2} are for rasters; give an output ending in .tif.",
            "cell_size",
            "attribute",
            "cog",
        )
    if to_crs and suffix_of(path) not in MESH_SUFFIXES:
        raise OptionError(
            "{0} is for mesh files; give an output such as .ply, or leave it out.", "to_crs"
        )


def write_pyramid_file(
    path: Path, geo: GeoPyramid, layers: Layers = "auto", progress: Progress | None = None
) -> None:
    """Write a pyramid and its layers to a new GeoPackage.

    Parameters
    ----------
    path : path
        A file that does not exist yet.
    geo : GeoPyramid
        What to write.
    layers : {"auto", "all", "coarse", "none"}
        Vector layers beside the pyramid, which is complete without them; see
        `wavelet_gis.products.layers.pyramid_layers`.
    progress : callable, optional
        Called with a fraction in [0, 1]; returning False stops with `Cancelled`.

    Raises
    ------
    OutputFileError
        A name that does not end in ``.gpkg``.
    """
    from wavelet_gis.io.pyramid.pyramid_file import write_pyramid

    check_layers(layers)
    check_output(path, overwrite=True, suffixes=(PYRAMID_SUFFIX,))
    write_pyramid(path, geo, progress, is_alone=layers == "none")
    if layers == "none":
        return
    from wavelet_gis.io.vector.vector_writer import add_layers

    add_layers(path, pyramid_layers(geo, layers), geo.system)


def write_tin(
    path: Path,
    geo: GeoPyramid,
    mesh: TriangleMesh,
    vertex_ids: NDArray[np.int64],
    name: str,
    to_crs: str | None = None,
    categories: Categories = "nearest",
) -> None:
    """Write a mesh of a pyramid as GeoPackage layers or as a mesh file, by the suffix.

    Parameters
    ----------
    path : path
        A file that does not exist yet.
    geo : GeoPyramid
        Gives the frame and the CRS.
    mesh : TriangleMesh
        In the working frame.
    vertex_ids : (n_vertices,) int64
        Ids of its vertices in the input.
    name : str
        What the layers' names begin with.
    to_crs : str, optional
        Of a mesh file; see `wavelet_gis.products.plane_mesh.plane_mesh`, which notes what is other
        than in the input.
    categories : {"nearest", "number"}
        See `wavelet_gis.model.geo_pyramid.GeoPyramid.file_mesh`.
    """
    if suffix_of(path) == PYRAMID_SUFFIX:
        from wavelet_gis.io.vector.vector_writer import add_layers
        from wavelet_gis.products.layers import tin_layers

        add_layers(path, tin_layers(geo, mesh, vertex_ids, name, categories), geo.system)
    else:
        from wavelet_gis.io.mesh import meshes
        from wavelet_gis.products.plane_mesh import plane_mesh

        placed = plane_mesh(geo, mesh, to_crs, categories)
        meshes.write_mesh(path, placed.mesh, placed.system.wkt)


def write_surface_raster(
    path: Path,
    geo: GeoPyramid,
    mesh: TriangleMesh,
    *,
    cell_size: float | None = None,
    attribute: str | None = None,
    cog: bool = False,
    categories: Categories = "nearest",
) -> dict[str, int]:
    """Write a mesh of a pyramid as a raster; return its size and the cells without data.

    Parameters
    ----------
    path : path
        A file that does not exist yet.
    geo : GeoPyramid
        Gives the frame, the CRS, and the grid where it was made from a raster.
    mesh : TriangleMesh
        In the working frame.
    cell_size, attribute, categories
        See `wavelet_gis.products.level_raster.surface_dem`.
    cog : bool
        Whether it is a cloud-optimised GeoTIFF.
    """
    from wavelet_gis.io.raster import write_cog, write_dem
    from wavelet_gis.products.level_raster import surface_dem

    dem = surface_dem(geo, mesh, cell_size=cell_size, attribute=attribute, categories=categories)
    (write_cog if cog else write_dem)(path, dem, geo.system.wkt)
    n_rows, n_columns = dem.geometry.shape
    return {
        "n_rows": n_rows,
        "n_columns": n_columns,
        "n_uncovered": int(np.count_nonzero(~dem.valid)),
    }
