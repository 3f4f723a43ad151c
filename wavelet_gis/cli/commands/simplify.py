"""``simplify INPUT OUT``: the TIN of a size, or of an accuracy, with the least error."""

from __future__ import annotations

import argparse
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING, Any

from wavelet_gis.cli.commands._options import (
    add_input_arguments,
    add_inputs_argument,
    add_line_arguments,
    add_max_error_argument,
    add_overwrite_argument,
    add_surface_arguments,
    add_wavelet_arguments,
    add_zone_arguments,
    input_files,
    length,
    number_or_text,
    open_given,
    surface_formats,
    surface_options,
    surface_suffixes,
    wavelet_options,
    zone_table,
)
from wavelet_gis.cli.console import Console
from wavelet_gis.cli.table_help import names_from
from wavelet_gis.io.formats import CLOUD_SUFFIXES, suffix_of

if TYPE_CHECKING:
    from wavelet_gis.workflows.simplify import Simplified

ORDER = 50

#: Keywords of `Simplified.for_solver`, of which any asks for a mesh.
SOLVER_OPTIONS = (
    "min_angle",
    "longest_edge",
    "shortest_edge",
    "max_area",
    "size_zones",
    "size_field",
    "area_field",
    "grading",
)
HELP = (
    "Write the TIN of a number of vertices, or of an accuracy, with the least error, as "
    f"{surface_formats()}; of a point cloud also its points that carry that TIN, as LAS or LAZ."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_inputs_argument(parser)
    parser.add_argument(
        "output", help=f"ending in {surface_suffixes()}; or in .las or .laz, for points that stay"
    )
    rule = parser.add_mutually_exclusive_group()
    rule.add_argument("--vertices", type=int, metavar="N", help="keep so many vertices")
    add_max_error_argument(rule, "keep so many that no input vertex is farther off, vertically")
    rule.add_argument(
        "--rmse",
        dest="max_rms",
        type=length,
        metavar="R",
        help="the same for the root mean square error",
    )
    names_from(
        "wavelet_core:NORMS",
        parser.add_argument(
            "--norm",
            metavar="NAME",
            help="which error to keep small, by default the largest with --max-error, else the "
            "mean square",
        ),
    )
    parser.add_argument(
        "--no-fit",
        dest="fit",
        action="store_false",
        help="keep the heights of the pyramid's level instead of fitting them to all input points",
    )
    add_zone_arguments(parser)
    rounds = parser.add_mutually_exclusive_group()
    rounds.add_argument(
        "--refine",
        type=int,
        metavar="N",
        help="rounds that move, replace and reconnect vertices; by default as many as pay, for "
        "points that stay none",
    )
    rounds.add_argument(
        "--no-refine",
        dest="refine",
        action="store_const",
        const=0,
        help="keep places and triangles of the pyramid's level",
    )
    parser.add_argument(
        "--keep-points",
        action="store_true",
        help="vertices are input points, height and all, also where the mean square counts",
    )
    parser.set_defaults(check=partial(_require_rule, parser))
    _add_solver_arguments(parser)
    add_surface_arguments(parser)
    add_input_arguments(parser)
    add_line_arguments(parser)
    add_wavelet_arguments(parser)
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.workflows.lines.errors import line_about
    from wavelet_gis.workflows.save import save
    from wavelet_gis.workflows.simplification.thinning import cloud_to_thin
    from wavelet_gis.workflows.simplify import simplify
    from wavelet_gis.workflows.solver.delaunay import require_cgal
    from wavelet_gis.workflows.solver.sizes import rules_of

    is_thinning = suffix_of(arguments.output) in CLOUD_SUFFIXES
    options, solver = surface_options(arguments), _solver_options(arguments)
    _check_output(arguments, is_thinning, {**options, **solver})
    if solver:
        require_cgal()
        rules_of(**solver).require_sense()
    began = perf_counter()
    terrain = open_given(arguments)
    rounds = arguments.refine
    if is_thinning:
        cloud_to_thin(terrain)
        rounds = rounds or 0  # whose points triangulate as well anew, and sooner
    with console.progress("simplifying") as progress:
        tin = simplify(
            terrain,
            vertices=arguments.vertices,
            max_error=arguments.max_error,
            zones=arguments.zones,
            zone_field=arguments.zone_field,
            max_rms=arguments.max_rms,
            fit=arguments.fit,
            refine=rounds,
            keep_points=arguments.keep_points,
            progress=progress,
            **{**wavelet_options(arguments), "norm": arguments.norm},
        )
    if solver:
        with console.progress("meshing") as progress:
            tin = tin.for_solver(progress=progress, **solver)
    _say_rounds(tin, console)
    if is_thinning:
        with console.progress("thinning") as progress:
            thinned = tin.thinned(tin.limits, progress)
        save(thinned, arguments.output, overwrite=arguments.overwrite)
    else:
        save(tin, arguments.output, overwrite=arguments.overwrite, **options)
    figures = {**tin.figures(), "seconds": round(perf_counter() - began, 3)}
    assert tin.errors is not None
    if is_thinning:
        figures["thinned"] = thinned.figures()
        told, n_points = thinned.errors.told(terrain.vertical_unit), thinned.cloud.n_points
        about = f"{n_points:,} points stay, {told}, by their Delaunay triangles"
    else:
        told = tin.errors.told(terrain.vertical_unit)
        about = (
            f"{figures['n_vertices']:,} of {figures['n_input_vertices']:,} vertices, "
            f"{figures['n_triangles']:,} triangles; {told}"
        )
    console.say(f"{about}; {figures['seconds']:.1f} s; {arguments.output}")
    if tin.quality is not None:
        quality = tin.quality
        console.say(
            f"angles {quality.smallest_angle:.3g} to {quality.largest_angle:.3g} degrees, edges "
            f"{quality.shortest_edge:.4g} to {quality.longest_edge:.4g}, areas to "
            f"{quality.largest_area:.4g}"
        )
    zone_table(tin, console)
    if tin.along_lines is not None:
        console.say(line_about(tin.along_lines, terrain.vertical_unit))
    console.figures({"output": str(arguments.output), **figures})


def _check_output(
    arguments: argparse.Namespace, is_thinning: bool, of_surfaces: dict[str, Any]
) -> None:
    """Refuse, before the long work, an output that cannot be written, or options beside it."""
    from wavelet_core import OptionError
    from wavelet_gis.io.atomic import check_output
    from wavelet_gis.workflows.save import check_surface_output

    where = {"overwrite": arguments.overwrite, "inputs": input_files(arguments)}
    if not is_thinning:
        check_surface_output(arguments.output, **where, **surface_options(arguments))
        return
    check_output(arguments.output, suffixes=CLOUD_SUFFIXES, **where)
    given = [name for name, value in of_surfaces.items() if value not in (None, False)]
    if given:
        raise OptionError(
            "{0} is for a TIN or a raster; leave it out, or give an output such as .gpkg.", given[0]
        )


def _require_rule(parser: argparse.ArgumentParser, given: argparse.Namespace) -> None:
    """End with the usage where nothing says how large or how accurate the TIN is to be."""
    rules = (given.vertices, given.max_error, given.max_rms, given.zones)
    if all(rule is None for rule in rules):
        parser.error("one of --vertices, --max-error, --rmse and --zones is required")


def _add_solver_arguments(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group(
        "mesh for a solver",
        "any of these adds nodes until it holds (needs CGAL: pip install cgal); lengths in the "
        "unit of x and y, or in metres for degrees",
    )
    group.add_argument(
        "--min-angle", type=float, metavar="DEGREES", help="25 by default, 30 at most"
    )
    group.add_argument(
        "--longest-edge",
        type=number_or_text,
        metavar="M",
        help="no edge is longer; by place: a raster, or a formula such as "
        "'where(slope > 20, 5, 50)' of z and slope (degrees)",
    )
    group.add_argument(
        "--shortest-edge", type=length, metavar="M", help="no two vertices of the TIN are nearer"
    )
    group.add_argument(
        "--max-area",
        type=number_or_text,
        metavar="M2",
        help="no triangle is larger; by place in the same way",
    )
    group.add_argument(
        "--size-zones",
        metavar="FILE",
        help="polygons with sizes of their own; the others hold outside",
    )
    group.add_argument(
        "--size-field",
        metavar="NAME",
        help="the field of these with the longest edge, longest_edge by default",
    )
    group.add_argument(
        "--area-field", metavar="NAME", help="the field of these with the largest area"
    )
    group.add_argument(
        "--grading",
        type=length,
        metavar="G",
        help="by how much edges may grow for each unit of distance, from where sizes or the TIN "
        "are finer; such as 0.2",
    )


def _solver_options(arguments: argparse.Namespace) -> dict[str, Any]:
    given = {name: getattr(arguments, name) for name in SOLVER_OPTIONS}
    return {name: value for name, value in given.items() if value is not None}


def _say_rounds(tin: Simplified, console: Console) -> None:
    """Print what each round of the refinement led to."""
    if not tin.rounds:
        return
    names = ["as analysed", *(f"round {k}" for k in range(1, len(tin.rounds)))]
    if tin.is_fitted:
        names[-1] = "heights fitted"
    header = ("", "vertices", "RMSE", "largest error", "moved", "flipped", "replaced", "removed")
    console.table(header, [(name, *here) for name, here in zip(names, tin.rounds, strict=True)])
