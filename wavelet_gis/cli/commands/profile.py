"""``profile FILE LINE OUT``: heights along lines at several levels, as a table or a plot."""

from __future__ import annotations

import argparse

from wavelet_gis.cli.commands._options import add_overwrite_argument, length, level_numbers
from wavelet_gis.cli.console import Console
from wavelet_gis.io.formats import any_of, suffix_of

ORDER = 72
HELP = "Write the heights along lines at several levels, as a table, points or a plot."

#: Table, points, plots.
SUFFIXES = (".csv", ".gpkg", ".html", ".svg")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument("line", help="a vector file of one layer of lines, in any CRS")
    parser.add_argument("output", help=f"ending in {any_of(SUFFIXES)}")
    parser.add_argument(
        "--levels",
        type=level_numbers,
        metavar="K,K",
        help="by default the input, those with about a quarter and a twentieth of its vertices, "
        "and the coarsest",
    )
    parser.add_argument(
        "--step",
        type=length,
        metavar="D",
        help="distance between points along the line, in the unit of x and y (metres for a CRS in "
        "degrees); by default the median edge of the input",
    )
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output, new_file
    from wavelet_gis.io.read_back import write_text
    from wavelet_gis.report.profile_plot import PLOT_SUFFIXES, profile_page, profile_svg
    from wavelet_gis.workflows.open import load
    from wavelet_gis.workflows.read_off.profile import profile
    from wavelet_gis.workflows.save import save

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=SUFFIXES,
        inputs=(arguments.file, arguments.line),
    )
    with console.progress("profile") as progress:
        found = profile(
            load(arguments.file),
            arguments.line,
            levels=arguments.levels,
            step=arguments.step,
            progress=progress,
        )
    suffix = suffix_of(arguments.output)
    if suffix in PLOT_SUFFIXES:
        text = profile_page(found) if suffix == ".html" else profile_svg(found)
        with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
            write_text(scratch, text)
    else:
        save(found, arguments.output, overwrite=arguments.overwrite)
    figures = found.figures()
    keys = ("line", "length", "level", "lowest", "highest", "rms_difference", "max_difference")
    console.table(
        ("line", "length", "level", "lowest", "highest", "rms off the finest", "largest"),
        [tuple(row[key] for key in keys) for row in figures["profiles"]],
    )
    console.say(f"{len(found.line)} points; {arguments.output}")
    console.figures({"output": str(arguments.output), **figures})
