"""``tile INPUT… OUTDIR``: rasters or point clouds of any size as a tiled pyramid."""

from __future__ import annotations

import argparse
import os
from time import perf_counter
from typing import Any

from wavelet_gis.cli.commands._options import (
    add_overwrite_argument,
    add_place_arguments,
    add_point_arguments,
    add_raster_arguments,
    length,
)
from wavelet_gis.cli.console import Console

ORDER = 12
GOES_ON = True
HELP = "Turn rasters or clouds of any size into a tiled pyramid; a second start goes on."


#: Options of reading, by the kind of input.
_OF_RASTERS = ("band", "nodata", "offline")
_OF_CLOUDS = ("attributes", "classes", "keep_noise", "keep_withheld", "duplicates")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "input",
        nargs="+",
        help="a raster, several of one grid, or LAS, LAZ or COPC files of one point format, or an "
        "ept.json; or a folder of them",
    )
    parser.add_argument(
        "output", help="a folder to be made, or that of an earlier run, which goes on from there"
    )
    parser.add_argument(
        "--tile",
        type=_side,
        metavar="SIZE",
        help="cells along a side (1024); of point clouds, a length in the unit of x and y, or "
        "width and height as W,H, by default such that a tile has about a million points",
    )
    parser.add_argument(
        "--levels",
        type=int,
        metavar="N",
        help="the most of each tile, and of each group of four but the last (64)",
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers",
        type=int,
        default=os.cpu_count() or 1,
        metavar="N",
        help="processes on this machine; by default one for each processor",
    )
    where.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a Dask scheduler, such as tcp://host:8786"
    )
    group = parser.add_argument_group("input")
    add_raster_arguments(group)
    add_point_arguments(group)
    add_place_arguments(group)
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.formats import is_cloud
    from wavelet_gis.io.names import files_of, joint_name
    from wavelet_gis.tiles.index import INDEX
    from wavelet_gis.tiles.tile import tile_clouds, tile_rasters
    from wavelet_gis.workflows.opening.input_options import CLOUD, RASTER, require_meaning

    files = files_of(arguments.input)
    of_points = is_cloud(files[0])
    given = {name: getattr(arguments, name) for name in (*_OF_RASTERS, *_OF_CLOUDS)}
    require_meaning(joint_name(files), CLOUD if of_points else RASTER, given)
    options = {name: given[name] for name in (_OF_CLOUDS if of_points else _OF_RASTERS)}
    if arguments.levels is not None:
        options["levels"] = arguments.levels
    if arguments.tile is not None:
        options["tile"] = arguments.tile if of_points else _cells(arguments.tile)
    began = perf_counter()
    with console.progress("tiling") as progress:

        def on_piece(record: dict[str, Any], n_done: int, n_total: int) -> None:
            progress(n_done / n_total)

        tiled = (tile_clouds if of_points else tile_rasters)(
            files,
            arguments.output,
            workers=arguments.workers,
            scheduler=arguments.scheduler,
            overwrite=arguments.overwrite,
            on_piece=on_piece,
            crs=arguments.crs,
            vertical_unit=arguments.vertical_unit,
            **options,
        )
    figures = {**tiled.figures(), "seconds": round(perf_counter() - began, 3)}
    if of_points:
        n_files = figures["n_files"]
        size = f"{figures['n_points']:,} points of {n_files:,} file{'s' * (n_files != 1)}"
    else:
        size = f"{figures['n_rows']:,} x {figures['n_columns']:,} cells"
    console.say(
        f"{size} in {figures['n_tiles']:,} tiles, "
        f"{figures['n_levels']} levels in {figures['n_stages']} stages; "
        f"{figures['n_made']:,} pieces made, {figures['n_found']:,} found whole, "
        f"{len(figures['failed']):,} set aside; {figures['seconds']:.1f} s; "
        f"{os.path.join(arguments.output, INDEX)}"
    )
    console.figures({"output": str(arguments.output), **figures})


def _side(text: str) -> float | tuple[float, float]:
    """Return a length, or two."""
    parts = [length(part) for part in text.split(",")]
    if len(parts) > 2:
        raise argparse.ArgumentTypeError(f"{text} is neither a side nor width and height")
    return parts[0] if len(parts) == 1 else (parts[0], parts[1])


def _cells(side: float | tuple[float, float]) -> int:
    """Return a number of cells."""
    from wavelet_core.errors import OptionError

    if isinstance(side, tuple) or side != int(side):
        raise OptionError(
            "{0}: a tile of a raster has a whole number of cells along its side.", "tile"
        )
    return int(side)
