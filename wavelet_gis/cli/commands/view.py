"""``view FILE OUT.html``: the levels of a pyramid in a browser, with a slider."""

from __future__ import annotations

import argparse

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.console import Console

ORDER = 95
HELP = "Write the levels of a pyramid as one HTML page with a slider, which needs no network."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument("output", help="ending in .html or .htm")
    parser.add_argument(
        "--max-vertices",
        type=int,
        metavar="N",
        help="of the finest level that is shown (60,000); a page has some 20 bytes for each",
    )
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output, new_file
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid
    from wavelet_gis.io.read_back import write_text
    from wavelet_gis.report.level_viewer import level_viewer

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=(".html", ".htm"),
        inputs=(arguments.file,),
    )
    geo = read_pyramid(arguments.file)
    with console.progress("levels") as progress:
        page, figures = level_viewer(geo, arguments.max_vertices, progress)
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        write_text(scratch, page)
    finest = figures["shown"][-1]
    console.say(
        f"{len(figures['shown'])} of {figures['n_levels'] + 1} levels, up to "
        f"{finest['n_vertices']:,} vertices; {arguments.output}"
    )
    console.figures({"output": str(arguments.output), **figures})
