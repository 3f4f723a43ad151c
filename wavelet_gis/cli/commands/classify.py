"""``classify INPUT OUT --ground``: a point cloud with its ground points marked."""

from __future__ import annotations

import argparse
from time import perf_counter

from wavelet_gis.cli.commands._options import (
    add_overwrite_argument,
    add_place_arguments,
    length,
)
from wavelet_gis.cli.console import Console
from wavelet_gis.io.formats import CLOUD_SUFFIXES, any_of

ORDER = 82
HELP = "Mark the ground points of a cloud, without training: class 2, all others 1."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "input",
        nargs="+",
        help="a LAS, LAZ or COPC file or an ept.json; or several that are parts of one cloud",
    )
    parser.add_argument("output", help=f"ending in {any_of(CLOUD_SUFFIXES)}")
    parser.add_argument(
        "--ground",
        action="store_true",
        required=True,
        help="what is classified: the ground; all else of the file stays as it is",
    )
    parser.add_argument(
        "--largest-object",
        type=length,
        metavar="M",
        help="width of the largest building, in metres (60); wider ones are taken for ground",
    )
    parser.add_argument(
        "--least-slope",
        type=length,
        metavar="S",
        help="rise over run that the ground may have everywhere (0.1); more on slopes, by itself",
    )
    parser.add_argument(
        "--height-tolerance",
        type=length,
        metavar="M",
        help="points so far from the ground's surface are part of it, in metres (0.15)",
    )
    add_place_arguments(parser.add_argument_group("input"))
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output
    from wavelet_gis.io.names import files_of
    from wavelet_gis.workflows.ground import classify_ground
    from wavelet_gis.workflows.save import save

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=CLOUD_SUFFIXES,
        inputs=tuple(files_of(arguments.input)),
    )
    names = ("largest_object", "least_slope", "height_tolerance")
    given = {name: getattr(arguments, name) for name in names}
    began = perf_counter()
    with console.progress("classifying") as progress:
        found = classify_ground(
            arguments.input,
            crs=arguments.crs,
            vertical_unit=arguments.vertical_unit,
            progress=progress,
            **{name: value for name, value in given.items() if value is not None},
        )
    save(found, arguments.output, overwrite=arguments.overwrite)
    figures = {**found.figures(), "seconds": round(perf_counter() - began, 3)}
    aside = f", {figures['n_aside']:,} left as they were" if figures["n_aside"] else ""
    console.say(
        f"{figures['n_ground']:,} of {figures['n_points']:,} points are ground{aside}; "
        f"{figures['seconds']:.1f} s; {arguments.output}"
    )
    console.figures({"output": str(arguments.output), **figures})
