"""``difference FILE OUT``: a level less another one or a DEM, or change by scale, as a raster."""

from __future__ import annotations

import argparse

from wavelet_gis.cli.commands._options import add_cell_size_argument, add_overwrite_argument
from wavelet_gis.cli.console import Console
from wavelet_gis.io.formats import RASTER_SUFFIXES, any_of

ORDER = 76
HELP = (
    "Write how far a level is above another level or a DEM, or what has changed at which scale, as "
    "a raster."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument("output", help=f"ending in {any_of(RASTER_SUFFIXES)}")
    parser.add_argument("--level", type=int, metavar="K", help="0, the default, is the coarsest")
    other = parser.add_mutually_exclusive_group()
    other.add_argument(
        "--less-level", type=int, metavar="K", help="another level; by default the input"
    )
    other.add_argument(
        "--less-dem", metavar="FILE", help="a DEM in the CRS of the input, on whose grid it is"
    )
    other.add_argument(
        "--since",
        metavar="FILE",
        help="an earlier survey, a DEM, cloud or TIN in the CRS of the input: how much has risen "
        "since, all of it and by scale, a raster band each",
    )
    add_cell_size_argument(parser)
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output
    from wavelet_gis.workflows.open import load
    from wavelet_gis.workflows.read_off.difference import difference
    from wavelet_gis.workflows.save import save

    files = (arguments.file, *filter(None, [arguments.less_dem, arguments.since]))
    check_output(
        arguments.output, overwrite=arguments.overwrite, suffixes=RASTER_SUFFIXES, inputs=files
    )
    if arguments.since is not None:
        _by_scale(arguments, console)
        return
    found = difference(
        load(arguments.file),
        level=arguments.level or 0,
        less=arguments.less_level if arguments.less_dem is None else arguments.less_dem,
        cell_size=arguments.cell_size,
    )
    save(found, arguments.output, overwrite=arguments.overwrite)
    figures = found.figures()
    console.say(
        f"RMS {figures['rms']:.4g}, mean {figures['mean']:.4g}, {figures['lowest']:.4g} to "
        f"{figures['highest']:.4g} ({found.geo.vertical_unit}); {arguments.output}"
    )
    console.figures({"output": str(arguments.output), **figures})


def _by_scale(arguments: argparse.Namespace, console: Console) -> None:
    from wavelet_core.errors import OptionError
    from wavelet_gis.workflows.open import load
    from wavelet_gis.workflows.read_off.change import change_by_scale
    from wavelet_gis.workflows.save import save

    if arguments.level is not None:
        raise OptionError("{0} and {1} exclude each other; give one.", "level", "since")
    later = load(arguments.file)
    with console.progress("change") as progress:
        change = change_by_scale(later, arguments.since, progress=progress)
    written = save(
        change, arguments.output, overwrite=arguments.overwrite, cell_size=arguments.cell_size
    )
    figures = change.figures()
    console.table(
        ("levels", "spacing", "rms", "lowest", "highest"),
        [
            ("base" if band.levels is None else "{}-{}".format(*band.levels), *band[1:])
            for band in change.bands
        ],
    )
    console.say(
        f"RMS {figures['rms']:.4g}, mean {figures['mean']:.4g}, {figures['lowest']:.4g} to "
        f"{figures['highest']:.4g} ({change.geo.vertical_unit}); {arguments.output}"
    )
    console.figures({"output": str(arguments.output), **figures, **written})
