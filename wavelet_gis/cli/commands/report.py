"""``report FILE OUT.html``: the quality of a pyramid on one page."""

from __future__ import annotations

import argparse

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.commands._pages import add_page_arguments, write_page
from wavelet_gis.cli.console import Console

ORDER = 90
HELP = "Write the quality report of a pyramid: one HTML page that needs no network."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_page_arguments(parser)
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
    from wavelet_gis.report.page import report_page

    figures = write_page(
        arguments,
        console,
        "report",
        lambda geo, progress: report_page(geo, arguments.level, progress),
    )
    coarsest = figures["levels"][-1]
    console.say(
        f"{figures['source']['n_levels']} levels down to {coarsest['n_vertices']:,} vertices, RMSE "
        f"{coarsest['rmse_surface']:.4g}; {arguments.output}"
    )
    console.figures({"output": str(arguments.output), **figures})
