"""``report FILE OUT.html``: the quality of a pyramid on one page."""

from __future__ import annotations

import argparse

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.console import Console

ORDER = 90
HELP = "Write the quality report of a pyramid: one HTML page that needs no network."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument("output", help="ending in .html or .htm")
    parser.add_argument(
        "--level",
        type=int,
        action="append",
        metavar="K",
        help="a level to show as a picture; may be given several times. By default those with "
        "about a quarter and a twentieth of the vertices, and the coarsest",
    )
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output, new_file
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid
    from wavelet_gis.io.read_back import write_text
    from wavelet_gis.report.page import report_page

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=(".html", ".htm"),
        inputs=(arguments.file,),
    )
    geo = read_pyramid(arguments.file)
    with console.progress("report") as progress:
        page, figures = report_page(geo, arguments.level, progress)
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        write_text(scratch, page)
    coarsest = figures["levels"][-1]
    console.say(
        f"{figures['source']['n_levels']} levels down to {coarsest['n_vertices']:,} vertices, RMSE "
        f"{coarsest['rmse_surface']:.4g}; {arguments.output}"
    )
    console.figures({"output": str(arguments.output), **figures})
