"""``reconstruct FILE OUT``: the DEM or the point cloud as it came."""

from __future__ import annotations

import argparse
from pathlib import Path

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.console import Console

ORDER = 40
HELP = "Give back the DEM or the LAS/LAZ file that a pyramid was made from, bit for bit."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument("output", help="a raster, such as .tif, or .las or .laz, as the input was")
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_core import TriangleMesh
    from wavelet_gis.cli.commands.extract import write_tin
    from wavelet_gis.errors import OutputFileError
    from wavelet_gis.io.atomic import check_output, new_file
    from wavelet_gis.io.meshes import MESH_SUFFIXES
    from wavelet_gis.io.pyramid_file import read_pyramid, read_summary
    from wavelet_gis.io.raster import write_dem
    from wavelet_gis.model.dem import Dem
    from wavelet_gis.workflows.open import CLOUD_SUFFIXES

    check_output(arguments.output, overwrite=arguments.overwrite, inputs=(arguments.file,))
    suffix = Path(arguments.output).suffix.lower()
    kind = str(read_summary(arguments.file).get("source", {}).get("kind"))
    fits = {
        "points": suffix in CLOUD_SUFFIXES,
        "tin": suffix in (".gpkg", *MESH_SUFFIXES),
    }.get(kind, suffix not in (*CLOUD_SUFFIXES, *MESH_SUFFIXES, ".gpkg", ""))
    if not fits:
        wanted = {
            "points": "a point cloud; give an output ending in .las or .laz",
            "tin": "a TIN; give an output ending in .gpkg, .ply, .2dm or .obj",
        }.get(kind, "a raster; give an output ending in .tif")
        raise OutputFileError(f"{arguments.output}: the pyramid was made from {wanted}.")
    geo = read_pyramid(arguments.file)
    original = geo.restore()
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        if isinstance(original, Dem):
            write_dem(scratch, original, geo.system.wkt)
            size = f"{original.geometry.shape[0]} x {original.geometry.shape[1]} cells"
        elif isinstance(original, TriangleMesh):
            write_tin(scratch, geo, geo.pyramid.synthesise(), geo.pyramid.n_levels)
            size = f"{original.n_faces:,} triangles"
        else:
            from wavelet_gis.io.las import write_cloud

            write_cloud(scratch, original)
            size = f"{original.n_points:,} points"
    is_exact = geo.source.is_exact
    verdict = "checksum verified, the original" if is_exact else "not the original, but altered"
    console.say(f"{size}, {verdict}; {arguments.output}")
    console.figures(
        {"output": str(arguments.output), "kind": kind, "is_exact": is_exact, "size": size}
    )
