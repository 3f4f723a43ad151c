"""``tile INPUT… OUTDIR``: rasters of any size as a tiled pyramid."""

from __future__ import annotations

import argparse
import os
from time import perf_counter
from typing import Any

from wavelet_gis.cli.commands._options import (
    add_overwrite_argument,
    add_place_arguments,
    add_raster_arguments,
)
from wavelet_gis.cli.console import Console

ORDER = 12
GOES_ON = True
HELP = "Turn rasters of any size into a tiled pyramid, tile by tile; a second start goes on."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "input", nargs="+", help="a raster, several of one grid, or a folder of them"
    )
    parser.add_argument(
        "output", help="a folder to be made, or that of an earlier run, which goes on from there"
    )
    parser.add_argument(
        "--tile", type=int, default=1024, metavar="SIZE", help="cells along a side (1024)"
    )
    parser.add_argument(
        "--levels",
        type=int,
        default=8,
        metavar="N",
        help="of each tile, and of each group of four but the last (8)",
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
    add_place_arguments(group)
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.tiles.index import INDEX
    from wavelet_gis.tiles.tile import tile_rasters

    began = perf_counter()
    with console.progress("tiling") as progress:

        def on_piece(record: dict[str, Any], n_done: int, n_total: int) -> None:
            progress(n_done / n_total)

        tiled = tile_rasters(
            arguments.input,
            arguments.output,
            tile=arguments.tile,
            levels=arguments.levels,
            workers=arguments.workers,
            scheduler=arguments.scheduler,
            overwrite=arguments.overwrite,
            on_piece=on_piece,
            crs=arguments.crs,
            vertical_unit=arguments.vertical_unit,
            band=arguments.band,
            nodata=arguments.nodata,
            offline=arguments.offline,
        )
    figures = {**tiled.figures(), "seconds": round(perf_counter() - began, 3)}
    console.say(
        f"{figures['n_rows']:,} x {figures['n_columns']:,} cells in {figures['n_tiles']:,} tiles, "
        f"{figures['n_levels']} levels in {figures['n_stages']} stages; "
        f"{figures['n_made']:,} pieces made, {figures['n_found']:,} found whole, "
        f"{len(figures['failed']):,} set aside; {figures['seconds']:.1f} s; "
        f"{os.path.join(arguments.output, INDEX)}"
    )
    console.figures({"output": str(arguments.output), **figures})
