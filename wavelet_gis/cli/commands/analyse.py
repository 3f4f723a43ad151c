"""``analyse INPUT OUT.gpkg``: terrain becomes a pyramid file."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from wavelet_gis.cli.commands._options import (
    add_input_arguments,
    add_inputs_argument,
    add_layers_argument,
    add_line_arguments,
    add_overwrite_argument,
    add_wavelet_arguments,
    input_files,
    open_given,
    wavelet_options,
)
from wavelet_gis.cli.console import Console
from wavelet_gis.io.formats import PYRAMID_SUFFIX

if TYPE_CHECKING:
    from wavelet_gis.workflows.analyse import Analysis

ORDER = 10
HELP = "Turn a DEM, a point cloud or a TIN into a reversible wavelet pyramid in one GeoPackage."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_inputs_argument(parser)
    parser.add_argument("output", help="the pyramid file, ending in .gpkg")
    parser.add_argument("--levels", type=int, metavar="N", help="at most so many levels")
    parser.add_argument(
        "--target-vertices", type=int, metavar="N", help="stop at so many coarse vertices"
    )
    parser.add_argument(
        "--max-error",
        type=float,
        metavar="M",
        help="stop before the largest vertical error at the vertices is above this, in the unit of "
        "z; points that share x and y with a vertex are reported",
    )
    parser.add_argument(
        "--max-rms", type=float, metavar="M", help="the same for the root mean square"
    )
    add_input_arguments(parser)
    add_line_arguments(parser)
    add_wavelet_arguments(parser)
    output = parser.add_argument_group("output")
    add_overwrite_argument(output)  # type: ignore[arg-type]
    add_layers_argument(output)  # type: ignore[arg-type]
    output.add_argument(
        "--no-errors",
        dest="measure",
        action="store_false",
        help="do not measure the errors of the levels",
    )


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output
    from wavelet_gis.progress import Clock
    from wavelet_gis.workflows.analyse import analyse
    from wavelet_gis.workflows.save import save

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=(PYRAMID_SUFFIX,),
        inputs=input_files(arguments),
    )
    clock = Clock()
    clock.stage("read")
    terrain = open_given(arguments)
    read = clock.seconds()
    with console.progress("analysing") as progress:
        analysis = analyse(
            terrain,
            levels=arguments.levels,
            target_vertices=arguments.target_vertices,
            max_error=arguments.max_error,
            max_rms=arguments.max_rms,
            measure=arguments.measure,
            progress=progress,
            **wavelet_options(arguments),
        )
    del terrain  # the input is in the pyramid now; large ones need the memory
    clock = Clock()
    clock.stage("write")
    with console.progress("writing") as progress:
        save(
            analysis,
            arguments.output,
            overwrite=arguments.overwrite,
            layers=arguments.layers,
            progress=progress,
        )
    _report(arguments, analysis, {**read, **analysis.seconds, **clock.seconds()}, console)


def _report(
    arguments: argparse.Namespace, analysis: Analysis, seconds: dict[str, float], console: Console
) -> None:
    import os

    from wavelet_gis.workflows.lines.errors import line_about

    figures = analysis.figures()
    if analysis.geo.errors is not None:
        console.table(
            ("level", "vertices", "triangles", "rmse_coefficients", "rmse_surface", "max_error"),
            [tuple(level)[:6] for level in reversed(analysis.geo.errors)],
        )
    console.say(
        f"{figures['n_vertices']:,} vertices and {figures['n_triangles']:,} triangles in "
        f"{figures['n_levels']} levels down to {figures['n_coarse_vertices']:,} vertices; "
        f"{sum(seconds.values()):.1f} s; {arguments.output}"
    )
    if analysis.along_lines is not None:
        console.say(line_about(analysis.along_lines, analysis.geo.vertical_unit))
    rounded = {name: round(value, 3) for name, value in seconds.items()}
    output = {
        "output": str(arguments.output),
        "output_bytes": os.path.getsize(arguments.output),
    }
    console.figures({**output, **figures, "seconds": rounded})
