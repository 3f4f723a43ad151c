"""``extract FILE OUT``: one level, or any size between two, as a TIN, a mesh file or a raster."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from wavelet_gis.cli.commands._options import (
    add_max_error_argument,
    add_overwrite_argument,
    add_surface_arguments,
    add_zone_arguments,
    box,
    surface_formats,
    surface_options,
    surface_suffixes,
    tolerance_files,
    zone_table,
)
from wavelet_gis.cli.console import Console

if TYPE_CHECKING:
    from wavelet_gis.workflows.extract import Surface

ORDER = 30
HELP = (
    f"Write one level of a pyramid, or the mesh of a size or an accuracy, as {surface_formats()}."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file, or the index.gpkg of a tile set")
    parser.add_argument("output", help=f"ending in {surface_suffixes()}")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--level", type=int, metavar="K", help="0, the default, is the coarsest")
    which.add_argument(
        "--vertices", type=int, metavar="N", help="just so many: a level, or part of the step below"
    )
    add_max_error_argument(which, "the least with no input vertex farther off, vertically")
    add_zone_arguments(parser)
    parser.add_argument(
        "--bbox",
        type=box,
        metavar="X,Y,X,Y",
        help="of a tile set: smallest x and y, largest x and y, in the coordinates of the input; "
        "only the tiles there are read",
    )
    parser.add_argument(
        "--polygon",
        metavar="FILE",
        help="the same with the polygons of a vector file, in any CRS",
    )
    parser.add_argument(
        "--refine",
        type=int,
        metavar="N",
        default=0,
        help="with --max-error: rounds that move and reconnect vertices and take out what the "
        "tolerance allows; vertices are then input points. By default none",
    )
    parser.add_argument(
        "--categories",
        choices=("nearest", "number"),
        default="nearest",
        help="classes and other categories are those of the nearest input vertex (default), or, "
        "as in the paper, the numbers that the filters made of them",
    )
    add_surface_arguments(parser)
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.tiles.index import is_index
    from wavelet_gis.workflows.save import check_surface_output, save

    options = surface_options(arguments)
    polygons = () if arguments.polygon is None else (arguments.polygon,)
    check_surface_output(
        arguments.output,
        overwrite=arguments.overwrite,
        inputs=(arguments.file, *tolerance_files(arguments), *polygons),
        **options,
    )
    surface = _of_tiles(arguments) if is_index(arguments.file) else _of_pyramid(arguments)
    cells = save(
        surface,
        arguments.output,
        overwrite=arguments.overwrite,
        categories=arguments.categories,
        **options,
    )
    errors = ""
    if surface.errors is not None:
        errors = f"; {surface.errors.told(surface.geo.vertical_unit)}"
    figures = {"level": surface.level, **surface.figures(), **cells}
    shape = f", {cells['n_rows']} x {cells['n_columns']} cells" if cells else ""
    console.say(
        f"level {surface.level}: {figures['n_vertices']:,} vertices, "
        f"{figures['n_triangles']:,} triangles{shape}{errors}; {arguments.output}"
    )
    zone_table(surface, console)
    console.figures({"output": str(arguments.output), **figures})


def _of_pyramid(arguments: argparse.Namespace) -> Surface:
    from wavelet_core.errors import OptionError
    from wavelet_gis.workflows.extract import extract
    from wavelet_gis.workflows.open import load

    for name in ("bbox", "polygon"):
        if getattr(arguments, name) is not None:
            raise OptionError("{0} is for tile sets, and this is one pyramid; leave it out.", name)
    rules = (arguments.vertices, arguments.max_error, arguments.zones)
    between = any(rule is not None for rule in rules)
    return extract(
        load(arguments.file, level=None if between else arguments.level or 0),
        level=arguments.level,
        vertices=arguments.vertices,
        max_error=arguments.max_error,
        zones=arguments.zones,
        zone_field=arguments.zone_field,
        refine=arguments.refine,
    )


def _of_tiles(arguments: argparse.Namespace) -> Surface:
    from wavelet_core.errors import OptionError
    from wavelet_gis.tiles.read import extract_region

    for name in ("vertices", "zones", "zone_field", "refine"):
        if getattr(arguments, name):
            raise OptionError("{0} is for one pyramid, and this is a tile set; leave it out.", name)
    if isinstance(arguments.max_error, str):
        raise OptionError("{0} of a tile set is one number; give a distance.", "max_error")
    return extract_region(
        arguments.file,
        level=arguments.level,
        max_error=arguments.max_error,
        bbox=arguments.bbox,
        polygon=arguments.polygon,
    ).surface
