"""``terrain INPUT OUTDIR``: quantized-mesh tiles for globes."""

from __future__ import annotations

import argparse
from typing import Any

from wavelet_gis.cli.commands._options import (
    add_input_arguments,
    add_inputs_argument,
    add_overwrite_argument,
    length,
    reading_options,
)
from wavelet_gis.cli.console import Console

ORDER = 97
HELP = "Write a terrain, or a pyramid, as quantized-mesh tiles for globes such as CesiumJS."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_inputs_argument(parser, "a pyramid file, or the index.gpkg of a tile set; ")
    parser.add_argument("output", help="a folder, with layer.json and the tiles of all zooms")
    parser.add_argument(
        "--level", type=int, metavar="K", help="of a pyramid or a tile set, else its finest"
    )
    parser.add_argument(
        "--max-zoom",
        dest="zoom",
        type=int,
        metavar="Z",
        help="the finest; by default tiles have some 128 points along each side there",
    )
    parser.add_argument(
        "--max-error",
        type=length,
        metavar="M",
        help="largest vertical error at the points of the input, metres, of the finest zoom; twice "
        "that for the next and so on; by default a tenth of the spacing of the points",
    )
    parser.add_argument(
        "--fill",
        type=float,
        default=0.0,
        metavar="HEIGHT",
        help="of the ground beyond the data, metres (0)",
    )
    parser.add_argument(
        "--normals", action="store_true", help="write normals too, for light and shade"
    )
    add_input_arguments(parser)
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.errors import InputFileError
    from wavelet_gis.io.atomic import check_folder
    from wavelet_gis.tiles.globe.tileset import LAYER, terrain_tiles
    from wavelet_gis.tiles.index import is_index
    from wavelet_gis.tiles.read import terrain_of_region
    from wavelet_gis.workflows.open import open_pyramid_or_input
    from wavelet_gis.workflows.opening.input_options import PYRAMID, require_meaning

    check_folder(arguments.output, LAYER, overwrite=arguments.overwrite)
    if len(arguments.input) == 1 and is_index(arguments.input[0]):
        given = reading_options(arguments)
        require_meaning(arguments.input[0], PYRAMID, given)
        for name in ("crs", "vertical_unit"):
            if given[name]:
                raise InputFileError(
                    "{path}: a tile set knows its own, and {0} is for other input; leave it out.",
                    name,
                    path=arguments.input[0],
                )
        data: Any = terrain_of_region(arguments.input[0], level=arguments.level)
    else:
        data = open_pyramid_or_input(
            arguments.input, level=arguments.level, **reading_options(arguments)
        )
    with console.progress("tiling") as progress:
        tiles = terrain_tiles(
            data,
            arguments.output,
            zoom=arguments.zoom,
            max_error=arguments.max_error,
            fill=arguments.fill,
            normals=arguments.normals,
            overwrite=arguments.overwrite,
            progress=progress,
        )
    console.table(
        ("zoom", "tiles", "vertices", "bytes", "promised (m)", "largest error (m)", "uncovered"),
        list(map(tuple, tiles.zooms)),
    )
    figures = tiles.figures()
    console.say(f"{figures['n_tiles']:,} tiles, {figures['n_bytes']:,} bytes; {arguments.output}")
    console.figures({"output": str(arguments.output), **figures})
