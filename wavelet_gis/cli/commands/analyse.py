"""``analyse INPUT OUT.gpkg``: a DEM or a point cloud becomes a pyramid file."""

from __future__ import annotations

import argparse
from itertools import chain
from time import perf_counter
from typing import TYPE_CHECKING, Any

from wavelet_gis.cli.commands._options import (
    add_input_arguments,
    add_overwrite_argument,
    add_wavelet_arguments,
    analysis_options,
    open_input,
)
from wavelet_gis.cli.console import Console

if TYPE_CHECKING:
    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.model.terrain import Terrain

ORDER = 10
HELP = "Turn a DEM or a LAS/LAZ file into a reversible wavelet pyramid in one GeoPackage."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("input", help="a raster that GDAL reads, or a LAS, LAZ or COPC file")
    parser.add_argument("output", help="the pyramid file, ending in .gpkg")
    parser.add_argument("--levels", type=int, metavar="N", help="at most so many levels")
    parser.add_argument(
        "--target-vertices", type=int, metavar="N", help="stop at so many coarse vertices"
    )
    parser.add_argument(
        "--max-error",
        type=float,
        metavar="M",
        help="stop before the largest vertical error is above this, in the unit of z",
    )
    parser.add_argument(
        "--max-rms", type=float, metavar="M", help="the same for the root mean square"
    )
    add_input_arguments(parser)
    add_wavelet_arguments(parser)
    output = parser.add_argument_group("output")
    add_overwrite_argument(output)  # type: ignore[arg-type]
    output.add_argument(
        "--layers",
        choices=("all", "coarse", "none"),
        default="all",
        help="vector layers to write: coarse TIN and details (the default), the coarse TIN only, "
        "or none; the pyramid is complete without them and a quarter as large",
    )
    output.add_argument(
        "--no-errors", action="store_true", help="do not measure the errors of the levels"
    )


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_core import analyse
    from wavelet_gis.io.atomic import check_output, new_file

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=(".gpkg",),
        inputs=(arguments.input,),
    )
    clock = _Clock()
    terrain = open_input(arguments)
    _tell_frame(terrain, console)
    clock.lap("read")
    unit = terrain.frame.z_scale
    rules = {
        "levels": arguments.levels,
        "target_vertices": arguments.target_vertices,
        "max_error": None if arguments.max_error is None else arguments.max_error * unit,
        "max_rms": None if arguments.max_rms is None else arguments.max_rms * unit,
    }
    with console.progress("analysing") as progress:
        pyramid = analyse(terrain.mesh, **rules, **analysis_options(arguments), progress=progress)
    clock.lap("analyse")
    geo = terrain.geo_pyramid(pyramid)
    clock.lap("verify")
    if not arguments.no_errors:
        geo = geo.with_errors()
        clock.lap("errors")
    n_triangles = terrain.mesh.n_faces
    del terrain, pyramid  # the input is in the pyramid now; large ones need the memory
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        _write(scratch, geo, console, arguments.layers)
    clock.lap("write")
    _report(arguments, geo, n_triangles, clock.laps, console)


def _write(path: Any, geo: GeoPyramid, console: Console, layers: str) -> None:
    from wavelet_gis.io.pyramid_file import write_pyramid
    from wavelet_gis.io.vector import add_layers
    from wavelet_gis.products.layers import coarse_layers, detail_layers

    with console.progress("writing") as progress:
        write_pyramid(path, geo, progress)
    if layers == "none":
        return
    details = detail_layers(geo) if layers == "all" else ()
    with console.progress("layers"):
        add_layers(path, chain(coarse_layers(geo), details), geo.system)


def _tell_frame(terrain: Terrain, console: Console) -> None:
    if terrain.system.kind == "geographic":
        frame = terrain.frame
        console.say(
            f"{terrain.system.name} is geographic: working in a local metric frame, "
            f"{frame.x_scale:.1f} m a unit of longitude and {frame.y_scale:.1f} m of latitude; "
            "results stay in the input's coordinates"
        )


def _report(
    arguments: argparse.Namespace,
    geo: GeoPyramid,
    n_triangles: int,
    laps: dict[str, float],
    console: Console,
) -> None:
    import os

    pyramid = geo.pyramid
    n_vertices, n_coarse = pyramid.n_vertices(pyramid.n_levels), pyramid.n_vertices(0)
    if geo.errors is not None:
        console.table(
            ("level", "vertices", "triangles", "rmse_coefficients", "rmse_surface", "max_error"),
            [tuple(level)[:6] for level in geo.errors],
        )
    console.say(
        f"{n_vertices:,} vertices and {n_triangles:,} triangles in {pyramid.n_levels} levels down "
        f"to {n_coarse:,} vertices; {sum(laps.values()):.1f} s; {arguments.output}"
    )
    console.figures(
        {
            "output": str(arguments.output),
            "output_bytes": os.path.getsize(arguments.output),
            "n_vertices": n_vertices,
            "n_triangles": n_triangles,
            "n_levels": pyramid.n_levels,
            "n_coarse_vertices": n_coarse,
            "channels": list(pyramid.channels),
            "parameters": dict(pyramid.parameters),
            "levels": [level._asdict() for level in geo.errors or ()],
            "seconds": {name: round(seconds, 3) for name, seconds in laps.items()},
        }
    )


class _Clock:
    """Seconds of each part of the work."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = perf_counter()

    def lap(self, name: str) -> None:
        now = perf_counter()
        self.laps[name] = now - self._last
        self._last = now
