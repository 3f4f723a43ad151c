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

WHAT = ("energy", "component", "level", "shape")


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
        "shape: slope, aspect and curvatures of the surface of --level",
    )
    parser.add_argument(
        "--level", type=int, metavar="K", help="of --what shape; by default the input itself"
    )
    parser.add_argument(
        "--channel", metavar="NAME", help="of the pyramid's channels; by default the geometry"
    )
    add_cell_size_argument(parser)
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output, new_file
    from wavelet_gis.workflows.details import check_level_of, details
    from wavelet_gis.workflows.open import load
    from wavelet_gis.workflows.save import save

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=SUFFIXES,
        inputs=(arguments.file,),
    )
    check_level_of(arguments.what, arguments.level)
    found = details(
        load(arguments.file), what=arguments.what, level=arguments.level, channel=arguments.channel
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
