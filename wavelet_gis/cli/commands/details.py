"""``details FILE OUT``: spectra of the vertices, rasters by level, shape by scale, the picture."""

from __future__ import annotations

import argparse
from typing import Any

from wavelet_gis.cli.commands._options import add_cell_size_argument, add_overwrite_argument
from wavelet_gis.cli.console import Console
from wavelet_gis.io.formats import (
    PICTURE_SUFFIXES,
    PYRAMID_SUFFIX,
    RASTER_SUFFIXES,
    any_of,
    suffix_of,
)

ORDER = 70
HELP = "Write what the details of each level hold, as points (GPKG), a raster (TIF) or a picture."

SUFFIXES = (PYRAMID_SUFFIX, *RASTER_SUFFIXES, *PICTURE_SUFFIXES)

WHAT = (
    "energy",
    "component",
    "level",
    "shape",
    "landforms",
    "residual",
    "roughness",
    "deviation",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument("output", help=f"ending in {any_of(SUFFIXES)}")
    parser.add_argument(
        "--what",
        choices=WHAT,
        default="energy",
        help="energy: root mean square detail around each vertex, one raster band per level "
        "(default); component: what each level adds, signed; level: at which each vertex went; "
        "shape: slope, aspect and curvatures at the scale of --level; landforms: planar "
        "ground, pits, channels, passes, ridges and peaks (0 to 5); residual: height above the "
        "mean of surroundings of the size of --level; roughness: degrees between the surface and "
        "the smooth one of each scale; deviation: standard deviations above the surroundings at "
        "each scale; of both first the strongest of all scales and the spacing where it is",
    )
    parser.add_argument(
        "--level",
        type=int,
        metavar="K",
        help="of shape and landforms, by default the input itself; of residual, by default the "
        "coarsest",
    )
    parser.add_argument(
        "--level-metres",
        dest="metres",
        type=float,
        metavar="M",
        help="instead of --level: the one whose spacing on the ground is nearest to this, in "
        "metres where the CRS states its unit, else in its own; 'details' lists the spacings",
    )
    parser.add_argument(
        "--fit",
        choices=("windows", "surface"),
        help="of shape and landforms: windows: to all that lies within windows of the distance, "
        "two and a half spacings wide (default); surface: to the neighbours of each vertex on the "
        "surface of the level, as extract writes it",
    )
    parser.add_argument(
        "--flat-slope",
        type=float,
        metavar="DEGREES",
        help="of landforms: ground that slopes more is no pit, pass or peak (1)",
    )
    parser.add_argument(
        "--flat-curvature",
        type=float,
        metavar="C",
        help="of landforms: what curves less is straight, in one over the unit of length (0.0001)",
    )
    parser.add_argument(
        "--channel", metavar="NAME", help="of the pyramid's channels; by default the geometry"
    )
    add_cell_size_argument(parser)
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output, new_file
    from wavelet_gis.workflows.details import check_options_of, details
    from wavelet_gis.workflows.open import load
    from wavelet_gis.workflows.save import save

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=SUFFIXES,
        inputs=(arguments.file,),
    )
    of_level = {"level": arguments.level, "metres": arguments.metres}
    flat = {"flat_slope": arguments.flat_slope, "flat_curvature": arguments.flat_curvature}
    check_options_of(arguments.what, **of_level)
    check_options_of(arguments.what, **flat)
    check_options_of(arguments.what, fit=arguments.fit)
    found = details(
        load(arguments.file),
        what=arguments.what,
        channel=arguments.channel,
        fit=arguments.fit,
        **of_level,
        **flat,
    )
    written: dict[str, Any] = {}
    if suffix_of(arguments.output) in PICTURE_SUFFIXES:
        from wavelet_gis.report.plots import plot_details

        with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
            plot_details(scratch, found.geo)
    else:
        with console.progress("details") as progress:
            written = save(
                found,
                arguments.output,
                overwrite=arguments.overwrite,
                cell_size=arguments.cell_size,
                progress=progress,
            )
    console.table(("level", "spacing", "n_details", "rms", "largest"), found.levels())
    console.say(f"{arguments.what}; {arguments.output}")
    console.figures({"output": str(arguments.output), **found.figures(), **written})
