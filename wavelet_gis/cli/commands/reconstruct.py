"""``reconstruct FILE OUT``: the DEM, the point cloud or the TIN as it came."""

from __future__ import annotations

import argparse

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.console import Console

ORDER = 40
HELP = "Give back the DEM or the LAS/LAZ file that a pyramid was made from, bit for bit."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file, or the index.gpkg of a tile set")
    parser.add_argument("output", help="a raster, such as .tif, or .las or .laz, as the input was")
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output
    from wavelet_gis.tiles.index import is_index
    from wavelet_gis.workflows.open import origin_kind
    from wavelet_gis.workflows.reconstruct import check_restored_output, reconstruct_file
    from wavelet_gis.workflows.save import save

    check_output(arguments.output, overwrite=arguments.overwrite, inputs=(arguments.file,))
    if is_index(arguments.file):
        _of_tiles(arguments, console)
        return
    check_restored_output(
        arguments.output, origin_kind(arguments.file), overwrite=arguments.overwrite
    )
    restored = reconstruct_file(arguments.file)
    save(restored, arguments.output, overwrite=arguments.overwrite)
    verdict = (
        "checksum verified, the original" if restored.is_exact else "not the original, but altered"
    )
    console.say(f"{restored.size}, {verdict}; {arguments.output}")
    console.figures({"output": str(arguments.output), **restored.figures()})


def _of_tiles(arguments: argparse.Namespace, console: Console) -> None:
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.io.raster import write_dem
    from wavelet_gis.tiles.index import open_index
    from wavelet_gis.tiles.read import restored_raster
    from wavelet_gis.workflows.reconstruct import check_restored_output

    check_restored_output(arguments.output, "raster", overwrite=arguments.overwrite)
    index = open_index(arguments.file)
    dem = restored_raster(index)
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        write_dem(scratch, dem, index.plan.coordinate_system.wkt)
    size = f"{dem.geometry.shape[0]} x {dem.geometry.shape[1]} cells"
    console.say(f"{size}, checksums of all tiles verified, the original; {arguments.output}")
    console.figures(
        {"output": str(arguments.output), "kind": "raster", "is_exact": True, "size": size}
    )
