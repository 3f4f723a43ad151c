"""``extract FILE OUT``: one level, or any size between two, as a TIN, a mesh file or a raster."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.console import Console

if TYPE_CHECKING:
    from wavelet_core import TriangleMesh
    from wavelet_core._validate import IntArray
    from wavelet_core.accuracy.between_levels import PartialMesh
    from wavelet_gis.model.geo_pyramid import GeoPyramid

HELP = (
    "Write one level of a pyramid, or the mesh of a size or an accuracy, as a TIN (GPKG, PLY, 2DM, "
    "OBJ, STL, GLB, LandXML, DXF) or a raster (GeoTIFF, COG)."
)

RASTER_SUFFIXES = (".tif", ".tiff")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument(
        "output", help="ending in .gpkg, .ply, .2dm, .obj, .stl, .glb, .xml, .dxf, .tif or .tiff"
    )
    which = parser.add_mutually_exclusive_group()
    which.add_argument(
        "--level", type=int, default=0, metavar="K", help="0, the default, is the coarsest"
    )
    which.add_argument(
        "--vertices", type=int, metavar="N", help="just so many: a level, or part of the step below"
    )
    which.add_argument(
        "--max-error",
        type=length,
        metavar="M",
        help="the least with no input vertex further off, vertically; in the unit of z",
    )
    parser.add_argument(
        "--categories",
        choices=("nearest", "number"),
        default="nearest",
        help="classes and other categories are those of the nearest input vertex (default), or, "
        "as in the paper, the numbers that the filters made of them",
    )
    add_raster_arguments(parser)
    add_overwrite_argument(parser)


def add_raster_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of a TIN that is written as a raster."""
    raster = parser.add_argument_group("raster")
    raster.add_argument(
        "--cell-size",
        type=length,
        metavar="SIZE",
        help="in the unit of the CRS; by default the grid of the input, and for points their "
        "mean spacing at this level",
    )
    raster.add_argument("--attribute", metavar="NAME", help="an attribute instead of the elevation")
    raster.add_argument("--cog", action="store_true", help="write a cloud-optimised GeoTIFF")


def is_raster_output(arguments: argparse.Namespace, source: str) -> bool:
    """Return whether the output is a raster, once it is one that may be written.

    Parameters
    ----------
    arguments : argparse.Namespace
        With the output and the options of a raster.
    source : str
        The file that is read, which the output may not replace.

    Raises
    ------
    OutputFileError
        An output that is there already, of another suffix, or the source itself.
    OptionError
        Options of a raster for what is none.
    """
    from wavelet_core.errors import OptionError
    from wavelet_gis.io.atomic import check_output
    from wavelet_gis.io.meshes import MESH_SUFFIXES

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=(".gpkg", *MESH_SUFFIXES, *RASTER_SUFFIXES),
        inputs=(source,),
    )
    is_raster = Path(arguments.output).suffix.lower() in RASTER_SUFFIXES
    if not is_raster and (arguments.cell_size is not None or arguments.attribute or arguments.cog):
        raise OptionError(
            "--cell-size, --attribute and --cog are for rasters; give an output ending in .tif."
        )
    return is_raster


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.io.pyramid_file import read_pyramid

    is_raster = is_raster_output(arguments, arguments.file)
    geo = read_pyramid(arguments.file)
    mesh, vertex_ids, level = _wanted(geo, arguments)
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        if is_raster:
            figures = write_raster(scratch, geo, mesh, arguments)
        else:
            write_tin(scratch, geo, mesh, level, vertex_ids, arguments.categories)
            figures = {}
    sizes = {
        "level": level,
        "n_vertices": mesh.n_vertices,
        "n_triangles": mesh.n_faces,
        **figures,
    }
    shape = f", {figures['n_rows']} x {figures['n_columns']} cells" if figures else ""
    console.say(
        f"level {level}: {mesh.n_vertices:,} vertices, {mesh.n_faces:,} triangles"
        f"{shape}; {arguments.output}"
    )
    console.figures({"output": str(arguments.output), **sizes})


def _wanted(geo: GeoPyramid, arguments: argparse.Namespace) -> PartialMesh:
    from wavelet_core.accuracy.between_levels import PartialMesh, mesh_of_accuracy, mesh_of_size

    pyramid = geo.pyramid
    if arguments.vertices is not None:
        return mesh_of_size(pyramid, arguments.vertices)
    if arguments.max_error is not None:
        return mesh_of_accuracy(pyramid, arguments.max_error * geo.frame.z_scale)
    mesh = pyramid.mesh(arguments.level)
    return PartialMesh(mesh, pyramid.vertex_ids(arguments.level), arguments.level)


def length(text: str) -> float:
    """Return a length from the command line."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is no length above 0")
    return value


def write_tin(
    path: str | os.PathLike[str],
    geo: GeoPyramid,
    mesh: TriangleMesh,
    level: int,
    vertex_ids: IntArray | None = None,
    categories: Literal["nearest", "number"] = "nearest",
) -> None:
    """Write a mesh of the pyramid as GeoPackage layers or as a mesh file, by the suffix.

    ``vertex_ids`` are needed where the mesh is between two levels.
    """
    from wavelet_gis.io.meshes import write_mesh
    from wavelet_gis.io.vector import add_layers
    from wavelet_gis.products.layers import tin_layers

    if Path(path).suffix.lower() == ".gpkg":
        ids = geo.pyramid.vertex_ids(level) if vertex_ids is None else vertex_ids
        layers = tin_layers(geo, mesh, ids, f"level_{level:02d}", categories)
        add_layers(path, layers, geo.system)
    else:
        write_mesh(path, geo.file_mesh(mesh, categories=categories), geo.system.wkt)


def write_raster(
    path: str | os.PathLike[str],
    geo: GeoPyramid,
    mesh: TriangleMesh,
    arguments: argparse.Namespace,
) -> dict[str, int]:
    """Write a mesh of the pyramid as a raster; return its size and the cells without data."""
    import numpy as np

    from wavelet_gis.io.raster import write_cog, write_dem
    from wavelet_gis.products.level_raster import surface_dem

    dem = surface_dem(
        geo,
        mesh,
        cell_size=arguments.cell_size,
        attribute=arguments.attribute,
        categories=getattr(arguments, "categories", "nearest"),
    )
    (write_cog if arguments.cog else write_dem)(path, dem, geo.system.wkt)
    return {
        "n_rows": dem.geometry.shape[0],
        "n_columns": dem.geometry.shape[1],
        "n_uncovered": int(np.count_nonzero(~dem.valid)),
    }
