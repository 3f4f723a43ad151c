"""``details FILE OUT``: spectra of the vertices, band rasters, shape by scale, the picture."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.console import Console

if TYPE_CHECKING:
    from wavelet_gis.model.geo_pyramid import GeoPyramid

ORDER = 70
HELP = "Write what each band of scales holds: as points (GPKG), raster bands (TIF) or a picture."

LAYER_SUFFIXES = (".gpkg",)
RASTER_SUFFIXES = (".tif", ".tiff")
PICTURE_SUFFIXES = (".png", ".svg", ".pdf")

WHAT = ("energy", "component", "level", "shape")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument("output", help="ending in .gpkg, .tif, .tiff, .png, .svg or .pdf")
    parser.add_argument(
        "--what",
        choices=WHAT,
        default="energy",
        help="energy: root mean square detail around each vertex, one band a level (default); "
        "component: what each level adds, signed; level: at which each vertex went; shape: slope, "
        "aspect and curvatures of the surface of --level",
    )
    parser.add_argument(
        "--level", type=int, metavar="K", help="of --what shape; by default the input itself"
    )
    parser.add_argument(
        "--channel", metavar="NAME", help="of the pyramid's channels; by default the geometry"
    )
    parser.add_argument(
        "--cell-size",
        type=float,
        metavar="SIZE",
        help="of a raster, in the unit of the CRS; by default the grid of the input, and for "
        "points their mean spacing",
    )
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_core.errors import OptionError
    from wavelet_gis.io.atomic import check_output, new_file
    from wavelet_gis.io.pyramid_file import read_pyramid

    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=(*LAYER_SUFFIXES, *RASTER_SUFFIXES, *PICTURE_SUFFIXES),
        inputs=(arguments.file,),
    )
    if arguments.level is not None and arguments.what != "shape":
        raise OptionError("--level is for --what shape; leave it out, or ask for the shape.")
    suffix = Path(arguments.output).suffix.lower()
    geo = read_pyramid(arguments.file)
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        if suffix in RASTER_SUFFIXES:
            figures = _write_raster(scratch, geo, arguments, console)
        elif suffix in LAYER_SUFFIXES:
            figures = _write_layer(scratch, geo, arguments, console)
        else:
            from wavelet_gis.report.plots import plot_details

            plot_details(scratch, geo)
            figures = {}
    _tell(geo, arguments, figures, console)


def _write_raster(
    path: str | os.PathLike[str],
    geo: GeoPyramid,
    arguments: argparse.Namespace,
    console: Console,
) -> dict[str, Any]:
    from wavelet_core.features.shape import SHAPE_NAMES
    from wavelet_core.features.spectrum import vertex_details
    from wavelet_gis.products.vertex_raster import label_band, value_bands, write_bands
    from wavelet_gis.products.vertex_tables import (
        band_names,
        component_columns,
        energy_columns,
        shape_columns,
    )

    mesh = geo.pyramid.mesh(_level(geo, arguments))
    with console.progress("spectrum") as progress:
        if arguments.what == "level":
            levels = vertex_details(geo.pyramid).level
            name = "level at which a vertex went"
            bands = label_band(geo, mesh, levels, name, arguments.cell_size)
        elif arguments.what == "shape":
            columns = shape_columns(mesh)
            bands = value_bands(geo, mesh, columns, SHAPE_NAMES, arguments.cell_size)
        else:
            is_energy = arguments.what == "energy"
            columns_of = energy_columns if is_energy else component_columns
            columns = columns_of(geo, arguments.channel, progress)
            names = band_names(geo, "rms" if is_energy else "component")
            bands = value_bands(geo, mesh, columns, names, arguments.cell_size)
    write_bands(path, bands, geo.system.wkt)
    return {"bands": list(bands.names), "shape": list(bands.geometry.shape)}


def _write_layer(
    path: str | os.PathLike[str],
    geo: GeoPyramid,
    arguments: argparse.Namespace,
    console: Console,
) -> dict[str, Any]:
    from wavelet_gis.io.vector import add_layers
    from wavelet_gis.products.vertex_tables import shape_layer, vertex_layer

    if arguments.what == "shape":
        layer = shape_layer(geo, _level(geo, arguments))
    else:
        with console.progress("spectrum") as progress:
            layer = vertex_layer(geo, arguments.channel, progress)
    add_layers(path, [layer], geo.system)
    return {"layer": layer.name, "n_points": len(layer.geometry)}


def _level(geo: GeoPyramid, arguments: argparse.Namespace) -> int:
    return geo.pyramid.n_levels if arguments.level is None else int(arguments.level)


def _tell(
    geo: GeoPyramid,
    arguments: argparse.Namespace,
    figures: dict[str, Any],
    console: Console,
) -> None:
    import numpy as np

    from wavelet_core.lifting.spacings import level_spacings

    spacings = level_spacings(geo.pyramid)[1:]
    rows = []
    for level, step in enumerate(geo.pyramid.steps):
        magnitude = np.linalg.norm(geo.file_details(step.details), axis=1)
        rms = float(np.sqrt((magnitude**2).mean())) if len(magnitude) else 0.0
        rows.append(
            (level, float(spacings[level]), step.n_odd, rms, float(magnitude.max(initial=0.0)))
        )
    header = ("level", "spacing", "n_details", "rms", "largest")
    console.table(header, rows)
    console.say(f"{arguments.what}; {arguments.output}")
    console.figures(
        {
            "output": str(arguments.output),
            "what": arguments.what,
            "levels": [dict(zip(header, row, strict=True)) for row in rows],
            **figures,
        }
    )
