"""``reconstruct FILE OUT``: the DEM, the point cloud or the TIN as it came."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.console import Console

if TYPE_CHECKING:
    from wavelet_gis.tiles.index import TileIndex

ORDER = 40
HELP = "Give back the DEM or the LAS/LAZ file that a pyramid was made from, bit for bit."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file, or the index.gpkg of a tile set")
    parser.add_argument(
        "output",
        help="a raster, such as .tif, or .las or .laz, as the input was; a folder for the several "
        "clouds of a tile set",
    )
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output
    from wavelet_gis.tiles.index import is_index
    from wavelet_gis.workflows.open import origin_kind
    from wavelet_gis.workflows.reconstruct import check_restored_output, reconstruct_file
    from wavelet_gis.workflows.save import save

    if is_index(arguments.file):
        _of_tiles(arguments, console)
        return
    check_output(arguments.output, overwrite=arguments.overwrite, inputs=(arguments.file,))
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
    from wavelet_gis.io.atomic import check_output, new_file
    from wavelet_gis.io.raster import write_dem
    from wavelet_gis.tiles.index import open_index
    from wavelet_gis.tiles.read import restored_raster
    from wavelet_gis.workflows.reconstruct import check_restored_output

    index = open_index(arguments.file)
    if index.plan.points is not None:
        _of_cloud_tiles(arguments, console, index)
        return
    check_output(arguments.output, overwrite=arguments.overwrite, inputs=(arguments.file,))
    check_restored_output(arguments.output, "raster", overwrite=arguments.overwrite)
    dem = restored_raster(index)
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        write_dem(scratch, dem, index.plan.coordinate_system.wkt)
    size = f"{dem.geometry.shape[0]} x {dem.geometry.shape[1]} cells"
    console.say(f"{size}, checksums of all tiles verified, the original; {arguments.output}")
    console.figures(
        {"output": str(arguments.output), "kind": "raster", "is_exact": True, "size": size}
    )


def _of_cloud_tiles(arguments: argparse.Namespace, console: Console, index: TileIndex) -> None:
    from wavelet_gis.errors import OutputFileError
    from wavelet_gis.io.atomic import check_output, ensure_folder
    from wavelet_gis.tiles.cloud.restore import n_chosen, names_of_sources, restore_source
    from wavelet_gis.workflows.reconstruct import check_restored_output

    output, names = Path(arguments.output), names_of_sources(index)
    is_one = len(names) == 1
    if is_one:
        check_output(output, overwrite=arguments.overwrite, inputs=(arguments.file,))
        check_restored_output(output, "points", overwrite=arguments.overwrite)
        places = [output]
    else:
        if output.exists() and not output.is_dir():
            raise OutputFileError(
                f"{output}: this is a file, and the tiles are of {len(names)} clouds; name a "
                "folder."
            )
        ensure_folder(output)
        places = [output / name for name in names]
        for place, file in zip(places, index.plan.files, strict=True):
            check_output(place, overwrite=arguments.overwrite, inputs=(file.path,))
    counts = [n_chosen(index, number) for number in range(len(names))]
    # Of a file in which no point was chosen there is nothing to write.
    numbers = [number for number, (n_here, _) in enumerate(counts) if n_here] or [0]
    n_points = 0
    with console.progress("reconstructing") as progress:
        for k, number in enumerate(numbers):
            n_points += restore_source(index, number, places[number], overwrite=arguments.overwrite)
            progress((k + 1) / len(numbers))
    files = "" if is_one else f" in {len(numbers):,} file{'s' * (len(numbers) != 1)}"
    size = f"{n_points:,} points{files}"
    n_left_out = sum(n_in_file for _, n_in_file in counts) - n_points
    verdict = f"without {n_left_out:,} of other classes" if n_left_out else "the original"
    console.say(f"{size}, checksums of all tiles verified, {verdict}; {arguments.output}")
    console.figures(
        {
            "output": str(arguments.output),
            "kind": "points",
            "is_exact": n_left_out == 0,
            "size": size,
        }
    )
