"""``filter FILE OUT``: smooth, sharpen, isolate a range of scales, or take out noise."""

from __future__ import annotations

import argparse

from wavelet_gis.cli.commands._options import add_layers_argument, add_overwrite_argument
from wavelet_gis.cli.console import Console

ORDER = 60
HELP = "Change chosen scales of a pyramid or take out noise; write a DEM, a LAS file or a pyramid."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument(
        "output",
        help="ending in .gpkg for a pyramid; else a raster or a point cloud, as the input was",
    )
    _add_scales(parser.add_argument_group("scales"))
    _add_noise(parser.add_argument_group("noise"))
    add_overwrite_argument(parser)
    add_layers_argument(parser, default=None)


def _add_scales(scales: argparse._ArgumentGroup) -> None:
    """Add what scales are changed by."""
    scales.add_argument(
        "--gain",
        dest="gains",
        type=_gain,
        action="append",
        default=[],
        metavar="LEVEL=G",
        help="multiply the details of a level: 0 drops them, 2 doubles them; again for others",
    )
    kept = scales.add_mutually_exclusive_group()
    kept.add_argument(
        "--band",
        dest="levels",
        type=_levels,
        metavar="LO:HI",
        help="keep the details of these levels only",
    )
    kept.add_argument(
        "--band-metres",
        dest="metres",
        type=_metres,
        metavar="LO:HI",
        help="keep details of this size on the ground only (median edge length of the mesh they "
        "belong to), in metres where the CRS states its unit, else in its own; 'info' and "
        "'details' list the sizes. An open end is left empty, as in 10:",
    )
    scales.add_argument(
        "--no-coarse",
        dest="drop_coarse",
        action="store_true",
        help="leave out the coarsest surface too, so that the details remain by themselves",
    )


def _add_noise(noise: argparse._ArgumentGroup) -> None:
    """Add what noise is taken out by."""
    noise.add_argument(
        "--denoise",
        type=_sigma,
        nargs="?",
        const=True,  # to be estimated
        default=False,
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
        "the CRS states its unit; auto estimates it. By default the noise is white",
    )
    noise.add_argument(
        "--local-noise", action="store_true", help="the noise differs by place: measure it there"
    )
    noise.add_argument(
        "--outliers", action="store_true", help="replace values that stand out of their ring first"
    )
    noise.add_argument(
        "--stripes",
        metavar="rows|columns|NAME",
        help="take out an offset for each row or column of a raster, or for each value of a "
        "dimension of points, such as the flight lines of point_source_id",
    )
    noise.add_argument(
        "--pyramids",
        dest="n_pyramids",
        type=int,
        metavar="N",
        help="average over so many pyramids in random order (default 4); 0: threshold the "
        "details of a single one, which is quick and leaves traces of its triangles",
    )
    noise.add_argument(
        "--channel",
        dest="channels",
        action="append",
        metavar="NAME",
        help="to take noise from (default z); again for others",
    )


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.io.atomic import check_output
    from wavelet_gis.workflows.filtering import filter_pyramid
    from wavelet_gis.workflows.open import load, origin_kind
    from wavelet_gis.workflows.reconstruct import check_restored_output
    from wavelet_gis.workflows.save import save

    check_output(arguments.output, overwrite=arguments.overwrite, inputs=(arguments.file,))
    check_restored_output(
        arguments.output,
        origin_kind(arguments.file),
        or_pyramid=True,
        overwrite=arguments.overwrite,
    )
    analysis = load(arguments.file)
    with console.progress("filtering") as progress:
        filtered = filter_pyramid(
            analysis,
            gains=arguments.gains,
            levels=arguments.levels,
            metres=arguments.metres,
            drop_coarse=arguments.drop_coarse,
            denoise=arguments.denoise,
            n_pyramids=arguments.n_pyramids,
            channels=arguments.channels and tuple(arguments.channels),
            noise_range=arguments.noise_range,
            local_noise=arguments.local_noise,
            outliers=arguments.outliers,
            stripes=arguments.stripes,
            progress=progress,
        )
    layers = {} if arguments.layers is None else {"layers": arguments.layers}
    save(filtered, arguments.output, overwrite=arguments.overwrite, **layers)
    for line in filtered.changes:
        console.say(line)
    console.say(str(arguments.output))
    console.figures({"output": str(arguments.output), **filtered.figures()})


def _gain(text: str) -> tuple[int, float]:
    level, _, gain = text.partition("=")
    try:
        return int(level), float(gain)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not LEVEL=G, such as 5=0.5") from None


def _levels(text: str) -> tuple[int, int]:
    low, _, high = text.partition(":")
    try:
        return int(low), int(high)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not LO:HI, such as 2:4") from None


def _metres(text: str) -> tuple[float, float]:
    low, colon, high = text.partition(":")
    try:
        if not colon:
            raise ValueError
        return float(low or 0.0), float(high or "inf")
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not LO:HI, such as 5:50 or 10:") from None


def _range(text: str) -> float | str:
    if text == "auto":
        return "estimate"
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is neither a length nor auto") from None


def _sigma(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number") from None
