"""What the commands have in common that write one HTML page about a pyramid."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from wavelet_gis.cli.console import Console

if TYPE_CHECKING:
    from wavelet_core import Progress
    from wavelet_gis.model.geo_pyramid import GeoPyramid

__all__ = ["add_page_arguments", "write_page"]


def add_page_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the pyramid and the page."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument("output", help="ending in .html or .htm")


def write_page(
    arguments: argparse.Namespace,
    console: Console,
    stage: str,
    make: Callable[[GeoPyramid, Progress | None], tuple[str, dict[str, Any]]],
) -> dict[str, Any]:
    """Make a page of the pyramid and write it; return its figures."""
    from wavelet_gis.io.atomic import check_output, new_file
    from wavelet_gis.io.pyramid.pyramid_file import read_pyramid
    from wavelet_gis.io.read_back import write_text

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=(".html", ".htm"),
        inputs=(arguments.file,),
    )
    geo = read_pyramid(arguments.file)
    with console.progress(stage) as progress:
        page, figures = make(geo, progress)
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        write_text(scratch, page)
    return figures
