"""``extract FILE OUT --level K``: one level as a TIN, a mesh file or a raster."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from wavelet_gis.commands._options import add_overwrite_argument
from wavelet_gis.console import Console

if TYPE_CHECKING:
    from wavelet_core import TriangleMesh
    from wavelet_gis.record import PyramidRecord

HELP = "Write one level of a pyramid as a TIN (GPKG, PLY, 2DM, OBJ) or a raster (GeoTIFF, COG)."

RASTER_SUFFIXES = (".tif", ".tiff")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument("output", help="ending in .gpkg, .ply, .2dm, .obj, .tif or .tiff")
    parser.add_argument(
        "--level", type=int, default=0, metavar="K", help="0, the default, is the coarsest"
    )
    raster = parser.add_argument_group("raster")
    raster.add_argument(
        "--cell-size",
        type=float,
        metavar="SIZE",
        help="in the unit of the CRS; by default the grid of the input, and for points their "
        "mean spacing at this level",
    )
    raster.add_argument("--attribute", metavar="NAME", help="an attribute instead of the elevation")
    raster.add_argument("--cog", action="store_true", help="write a cloud-optimised GeoTIFF")
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_core.errors import OptionError
    from wavelet_gis.atomic import check_output, new_file
    from wavelet_gis.meshfiles import MESH_SUFFIXES
    from wavelet_gis.pyramid_file import read_pyramid

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=(".gpkg", *MESH_SUFFIXES, *RASTER_SUFFIXES),
        inputs=(arguments.file,),
    )
    is_raster = Path(arguments.output).suffix.lower() in RASTER_SUFFIXES
    if not is_raster and (arguments.cell_size or arguments.attribute or arguments.cog):
        raise OptionError(
            "--cell-size, --attribute and --cog are for rasters; give an output ending in .tif."
        )
    record = read_pyramid(arguments.file)
    mesh = record.pyramid.mesh(arguments.level)
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        if is_raster:
            figures = write_raster(scratch, record, mesh, arguments)
        else:
            write_tin(scratch, record, mesh, arguments.level)
            figures = {}
    sizes = {
        "level": arguments.level,
        "n_vertices": mesh.n_vertices,
        "n_triangles": mesh.n_faces,
        **figures,
    }
    shape = f", {figures['n_rows']} x {figures['n_columns']} cells" if figures else ""
    console.say(
        f"level {arguments.level}: {mesh.n_vertices:,} vertices, {mesh.n_faces:,} triangles"
        f"{shape}; {arguments.output}"
    )
    console.figures({"output": str(arguments.output), **sizes})


def write_tin(
    path: str | os.PathLike[str], record: PyramidRecord, mesh: TriangleMesh, level: int
) -> None:
    """Write a mesh of the pyramid as GeoPackage layers or as a mesh file, by the suffix."""
    from wavelet_gis.layers import tin_layers
    from wavelet_gis.meshfiles import write_mesh
    from wavelet_gis.vector import add_layers

    if Path(path).suffix.lower() == ".gpkg":
        ids = record.pyramid.vertex_ids(level)
        add_layers(path, tin_layers(record, mesh, ids, f"level_{level:02d}"), record.system)
    else:
        write_mesh(path, record.file_mesh(mesh), record.system.wkt)


def write_raster(
    path: str | os.PathLike[str],
    record: PyramidRecord,
    mesh: TriangleMesh,
    arguments: argparse.Namespace,
) -> dict[str, int]:
    """Write a mesh of the pyramid as a raster; return its size and the cells without data."""
    import numpy as np

    from wavelet_core.errors import OptionError
    from wavelet_gis.dem import Dem, RasterSource
    from wavelet_gis.raster import write_cog, write_dem
    from wavelet_gis.rasterise import geometry_over, rasterise

    in_file = record.file_mesh(mesh)
    values = None
    if arguments.attribute:
        if arguments.attribute not in mesh.attribute_names:
            raise OptionError(
                f"the pyramid has no attribute {arguments.attribute!r}; it has "
                f"{', '.join(mesh.attribute_names) or 'none'}."
            )
        values = in_file.attributes[:, mesh.attribute_names.index(arguments.attribute)]
    low, high = in_file.vertices.min(axis=0), in_file.vertices.max(axis=0)
    source = record.source
    if isinstance(source, RasterSource) and arguments.cell_size is None:
        geometry = source.geometry
    else:
        area = (high[0] - low[0]) * (high[1] - low[1])
        size = arguments.cell_size or float(np.sqrt(area / mesh.n_vertices))
        geometry = geometry_over((low[0], low[1], high[0], high[1]), size)
    grid = rasterise(in_file, geometry, values)
    is_wide = isinstance(source, RasterSource) and source.dtype == np.float64
    grid = grid if is_wide else grid.astype(np.float32)
    covered = np.isfinite(grid)
    nodata = source.nodata if isinstance(source, RasterSource) else None
    usable = nodata is not None and abs(float(nodata)) <= float(np.finfo(grid.dtype).max)
    tag = float(nodata) if usable and nodata is not None else float("nan")
    grid[~covered] = tag
    profile = {"options": {"compress": "deflate", "predictor": 3, "tiled": True}}
    dem = Dem(grid, covered, geometry, tag, profile=profile)
    (write_cog if arguments.cog else write_dem)(path, dem, record.system.wkt)
    return {
        "n_rows": geometry.shape[0],
        "n_columns": geometry.shape[1],
        "n_uncovered": int(np.count_nonzero(~covered)),
    }
