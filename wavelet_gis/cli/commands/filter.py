"""``filter FILE OUT``: smooth, sharpen, isolate a band of scales, or take out noise."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.console import Console

if TYPE_CHECKING:
    from wavelet_gis.model.geo_pyramid import GeoPyramid

HELP = "Change chosen scales of a pyramid or take out noise; write a DEM, a LAS file or a pyramid."

#: Stands for the standard deviation of the noise where it is not given.
ESTIMATED = True


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument(
        "output",
        help="ending in .gpkg for a pyramid; else a raster or a point cloud, as the input was",
    )
    scales = parser.add_argument_group("scales")
    scales.add_argument(
        "--gain",
        type=_gain,
        action="append",
        default=[],
        metavar="LEVEL=G",
        help="multiply the details of a level: 0 drops them, 2 doubles them; again for others",
    )
    band = scales.add_mutually_exclusive_group()
    band.add_argument(
        "--band", type=_levels, metavar="LO:HI", help="keep the details of these levels only"
    )
    band.add_argument(
        "--band-metres",
        type=_metres,
        metavar="LO:HI",
        help="keep details of this size on the ground only (median edge length of the mesh they "
        "belong to), in metres where the CRS tells its unit, else in its own; 'info' and "
        "'details' list the sizes. An open end is left empty, as in 10:",
    )
    scales.add_argument(
        "--no-coarse",
        action="store_true",
        help="leave out the coarsest surface too, so that the bands remain by themselves",
    )
    noise = parser.add_argument_group("noise")
    noise.add_argument(
        "--denoise",
        type=_sigma,
        nargs="?",
        const=ESTIMATED,
        metavar="SIGMA",
        help="take out noise of this standard deviation, in the unit of z; estimated where "
        "it is not given. Before any gain",
    )
    noise.add_argument(
        "--noise-range",
        type=_range,
        default=0.0,
        metavar="LENGTH|auto",
        help="distance at which the correlation of the noise has fallen to 1/e, in metres where "
        "the CRS tells its unit; auto estimates it. By default the noise is white",
    )
    noise.add_argument(
        "--local-noise", action="store_true", help="the noise differs by place: measure it there"
    )
    noise.add_argument(
        "--outliers", action="store_true", help="replace values that stand out of their ring first"
    )
    noise.add_argument(
        "--pyramids",
        type=int,
        default=8,
        metavar="N",
        help="average over so many pyramids in random order (default 8); 0: threshold the "
        "details of a single one, which is quick and leaves traces of its triangles",
    )
    noise.add_argument(
        "--channel",
        action="append",
        metavar="NAME",
        help="to take noise from (default z); again for others",
    )
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_core.errors import OptionError
    from wavelet_gis.io.atomic import check_output, new_file
    from wavelet_gis.io.pyramid_file import read_pyramid
    from wavelet_gis.workflows.filtering import (
        change_between,
        chosen_gains,
        denoised_record,
        scaled_record,
    )

    check_output(arguments.output, overwrite=arguments.overwrite, inputs=(arguments.file,))
    asks_scales = bool(arguments.gain or arguments.band or arguments.band_metres)
    asks_noise = arguments.noise_range != 0.0 or arguments.local_noise or arguments.outliers
    if asks_noise and arguments.denoise is None:
        raise OptionError(
            "--noise-range, --local-noise and --outliers tell of noise; give --denoise too."
        )
    if not asks_scales and not arguments.no_coarse and arguments.denoise is None:
        raise OptionError("nothing to change; give --gain, --band, --band-metres or --denoise.")
    geo = read_pyramid(arguments.file)
    _check_suffix(arguments.output, geo)
    gains = chosen_gains(geo, arguments.gain, levels=arguments.band, metres=arguments.band_metres)
    changed = geo
    figures: dict[str, Any] = {}
    if arguments.denoise is not None:
        with console.progress("denoising") as progress:
            changed, sigmas = denoised_record(
                changed,
                None if arguments.denoise is ESTIMATED else arguments.denoise,
                channels=tuple(arguments.channel or ("z",)),
                n_pyramids=arguments.pyramids,
                noise_range=arguments.noise_range,
                local_noise=arguments.local_noise,
                outliers=arguments.outliers,
                progress=progress,
            )
        figures = {"sigma": sigmas, "n_pyramids": arguments.pyramids}
    if asks_scales or arguments.no_coarse:
        changed = scaled_record(changed, gains, drops_coarse=arguments.no_coarse)
        figures["gains"] = gains
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        _write(scratch, arguments.output, changed, console)
    for line in changed.history[len(geo.history) :]:
        console.say(line)
    console.say(str(arguments.output))
    rms, largest = change_between(geo, changed)
    console.figures(
        {
            "output": str(arguments.output),
            **figures,
            "rms_change": rms,
            "largest_change": largest,
        }
    )


def _write(scratch: str | os.PathLike[str], output: str, geo: GeoPyramid, console: Console) -> None:
    if Path(output).suffix.lower() == ".gpkg":
        from wavelet_gis.io.pyramid_file import write_pyramid
        from wavelet_gis.io.vector import add_layers
        from wavelet_gis.products.layers import coarse_layers, detail_layers

        with console.progress("writing") as progress:
            write_pyramid(scratch, geo, progress)
        add_layers(scratch, [*coarse_layers(geo), *detail_layers(geo)], geo.system)
        return
    from wavelet_core import TriangleMesh
    from wavelet_gis.cli.commands.extract import write_tin
    from wavelet_gis.io.las import write_cloud
    from wavelet_gis.io.raster import write_dem
    from wavelet_gis.model.dem import Dem

    changed = geo.restore()
    if isinstance(changed, Dem):
        write_dem(scratch, changed, geo.system.wkt)
    elif isinstance(changed, TriangleMesh):
        write_tin(scratch, geo, geo.pyramid.synthesise(), geo.pyramid.n_levels)
    else:
        write_cloud(scratch, changed)


def _check_suffix(output: str, geo: GeoPyramid) -> None:
    """Refuse an output of another kind than the input was, before the long work."""
    from wavelet_gis.errors import OutputFileError
    from wavelet_gis.io.meshes import MESH_SUFFIXES
    from wavelet_gis.workflows.open import CLOUD_SUFFIXES

    suffix = Path(output).suffix.lower()
    if suffix == ".gpkg":
        return
    fits, wanted = {
        "points": (suffix in CLOUD_SUFFIXES, "a point cloud; give .las, .laz"),
        "tin": (suffix in MESH_SUFFIXES, "a TIN; give .ply, .2dm, .obj"),
        "raster": (
            suffix not in (*CLOUD_SUFFIXES, *MESH_SUFFIXES, ""),
            "a raster; give .tif",
        ),
    }[geo.source.kind]
    if not fits:
        raise OutputFileError(
            f"{output}: the pyramid was made from {wanted} or, for a pyramid, .gpkg."
        )


def _gain(text: str) -> tuple[int, float]:
    level, _, gain = text.partition("=")
    try:
        return int(level), float(gain)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no LEVEL=G such as 5=0.5") from None


def _levels(text: str) -> tuple[int, int]:
    low, _, high = text.partition(":")
    try:
        return int(low), int(high)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no LO:HI such as 2:4") from None


def _metres(text: str) -> tuple[float, float]:
    low, colon, high = text.partition(":")
    try:
        if not colon:
            raise ValueError
        return float(low or 0.0), float(high or "inf")
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no LO:HI such as 5:50 or 10:") from None


def _range(text: str) -> float | str:
    if text == "auto":
        return "estimate"
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no length, nor auto") from None


def _sigma(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no number") from None
