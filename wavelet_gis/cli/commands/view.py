"""``view FILE OUT.html``: the levels of a pyramid in a browser, with a slider."""

from __future__ import annotations

import argparse

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.commands._pages import add_page_arguments, write_page
from wavelet_gis.cli.console import Console

ORDER = 95
HELP = "Write the levels of a pyramid as one HTML page with a slider, which needs no network."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_page_arguments(parser)
    parser.add_argument(
        "--max-vertices",
        type=int,
        metavar="N",
        help="of the finest level that is shown (60,000); a page has some 20 bytes for each",
    )
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.report.level_viewer import level_viewer

    figures = write_page(
        arguments,
        console,
        "levels",
        lambda geo, progress: level_viewer(geo, arguments.max_vertices, progress),
    )
    finest = figures["shown"][-1]
    console.say(
        f"{len(figures['shown'])} of {figures['n_levels'] + 1} levels, up to "
        f"{finest['n_vertices']:,} vertices; {arguments.output}"
    )
    console.figures({"output": str(arguments.output), **figures})
