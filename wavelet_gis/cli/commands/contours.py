"""``contours FILE OUT``: contour lines of a level."""

from __future__ import annotations

import argparse

from wavelet_gis.cli.commands._options import add_overwrite_argument, length
from wavelet_gis.cli.console import Console

ORDER = 74
HELP = "Write the contours of one level of a pyramid, the smoother the coarser the level (GPKG)."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument("output", help="ending in .gpkg")
    parser.add_argument(
        "--interval",
        type=length,
        metavar="H",
        help="in the unit of z; by default a round one that gives about twenty",
    )
    parser.add_argument(
        "--level",
        type=int,
        metavar="K",
        help="0 is the coarsest; by default the coarsest whose RMSE is at most a fifth of the "
        "interval",
    )
    parser.add_argument(
        "--base", type=float, default=0.0, metavar="H", help="what intervals are counted from"
    )
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output
    from wavelet_gis.workflows.open import load
    from wavelet_gis.workflows.read_off.contours import contours
    from wavelet_gis.workflows.save import save

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=(".gpkg",),
        inputs=(arguments.file,),
    )
    with console.progress("contours") as progress:
        found = contours(
            load(arguments.file),
            interval=arguments.interval,
            level=arguments.level,
            base=arguments.base,
            progress=progress,
        )
    save(found, arguments.output, overwrite=arguments.overwrite)
    console.say(
        f"{len(found.lines)} contours of level {found.level}, one each {found.interval:g}; "
        f"{arguments.output}"
    )
    console.figures({"output": str(arguments.output), **found.figures()})
