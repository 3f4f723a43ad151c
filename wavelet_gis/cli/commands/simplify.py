"""``simplify INPUT OUT``: the TIN of a size, or of an accuracy, with the least error."""

from __future__ import annotations

import argparse
from time import perf_counter

from wavelet_gis.cli.commands._options import (
    add_input_arguments,
    add_overwrite_argument,
    add_wavelet_arguments,
    analysis_options,
    open_input,
)
from wavelet_gis.cli.commands.extract import (
    add_raster_arguments,
    is_raster_output,
    length,
    write_raster,
    write_tin,
)
from wavelet_gis.cli.console import Console

HELP = (
    "Write the TIN of a number of vertices, or of an accuracy, with the least error: GPKG, PLY, "
    "2DM, OBJ, STL, GLB, LandXML (.xml), DXF; or the raster of that TIN (GeoTIFF, COG)."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("input", help="a raster that GDAL reads, or a LAS, LAZ or COPC file")
    parser.add_argument("output", help="a TIN or a raster, by its suffix")
    rule = parser.add_mutually_exclusive_group(required=True)
    rule.add_argument("--vertices", type=int, metavar="N", help="keep so many vertices")
    rule.add_argument(
        "--max-error",
        type=length,
        metavar="M",
        help="keep so many that no input point is further off, vertically; in the unit of z",
    )
    rule.add_argument(
        "--rmse", type=length, metavar="R", help="the same for the root mean square error"
    )
    parser.add_argument(
        "--norm",
        choices=("rms", "max"),
        help="keep the mean square or the largest error small; max with --max-error, else rms",
    )
    parser.add_argument(
        "--no-fit",
        action="store_true",
        help="keep the heights of the pyramid's level instead of fitting them to all input points",
    )
    add_raster_arguments(parser)
    add_input_arguments(parser)
    add_wavelet_arguments(parser)
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    import numpy as np

    from wavelet_core import analyse
    from wavelet_core.accuracy.fitted_heights import fitted
    from wavelet_core.mesh.location import surface_errors
    from wavelet_core.partition.outline import area_change
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.model.geo_pyramid import GeoPyramid

    is_raster = is_raster_output(arguments, arguments.input)
    began = perf_counter()
    terrain = open_input(arguments)
    unit = terrain.frame.z_scale
    rules = {
        "target_vertices": arguments.vertices,
        "max_error": None if arguments.max_error is None else arguments.max_error * unit,
        "max_rms": None if arguments.rmse is None else arguments.rmse * unit,
    }
    options = analysis_options(arguments)
    if arguments.norm is not None:
        options["norm"] = arguments.norm
    with console.progress("simplifying") as progress:
        pyramid = analyse(terrain.mesh, **rules, **options, progress=progress)
    mesh = pyramid.mesh(0)
    if not arguments.no_fit and pyramid.parameters["norm"] == "rms":
        mesh = fitted(mesh, terrain.mesh)
    errors = surface_errors(mesh, terrain.mesh.vertices) / unit
    covered = errors[np.isfinite(errors)]
    geo = GeoPyramid(
        pyramid=pyramid,
        system=terrain.system,
        frame=terrain.frame,
        vertical_unit=terrain.vertical_unit,
        source=terrain.source,
        source_name=terrain.name,
    )
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        if is_raster:
            write_raster(scratch, geo, mesh, arguments)
        else:
            write_tin(scratch, geo, mesh, 0)
    figures = {
        "output": str(arguments.output),
        "n_input_vertices": terrain.mesh.n_vertices,
        "n_vertices": mesh.n_vertices,
        "n_triangles": mesh.n_faces,
        "rmse": float(np.sqrt(np.mean(covered**2))) if len(covered) else 0.0,
        "max_error": float(np.abs(covered).max(initial=0.0)),
        "n_levels": pyramid.n_levels,
        "stopped_by": pyramid.stop.reason if pyramid.stop else None,
        "area_change": area_change(terrain.mesh, mesh),
        "seconds": round(perf_counter() - began, 3),
    }
    console.say(
        f"{figures['n_vertices']:,} of {figures['n_input_vertices']:,} vertices, "
        f"{figures['n_triangles']:,} triangles; RMSE {figures['rmse']:.4g}, largest error "
        f"{figures['max_error']:.4g} ({terrain.vertical_unit}) at all input points; "
        f"{figures['seconds']:.1f} s; {arguments.output}"
    )
    if pyramid.stop and pyramid.stop.misses_target:
        console.say(str(pyramid.stop))
    if arguments.outline_tolerance:
        console.say(
            f"the outline moved by at most {arguments.outline_tolerance:g}; the area changed by "
            f"{figures['area_change']:.4g} (square of the unit of x and y)"
        )
    console.figures(figures)
