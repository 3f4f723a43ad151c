"""Arguments that several commands share, and what they mean."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wavelet_gis.model.terrain import Terrain

__all__ = [
    "add_input_arguments",
    "add_overwrite_argument",
    "add_wavelet_arguments",
    "analysis_options",
    "open_input",
]


def add_input_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what tells how a DEM or a LAS file is read."""
    group = parser.add_argument_group("input")
    group.add_argument("--band", type=int, metavar="N", help="band of a raster, from 1")
    group.add_argument(
        "--attributes",
        type=_names,
        default=(),
        metavar="A,B",
        help="dimensions of a point cloud to lift along: classification, intensity, "
        "return_number, rgb, any extra dimension, hag (height above the class-2 ground)",
    )
    group.add_argument(
        "--class-channels",
        action="store_true",
        help="lift classes, return numbers and other categories as one channel of 0 and 1 each",
    )
    group.add_argument(
        "--classes", type=_classes, metavar="N,N", help="only points of these classes"
    )
    group.add_argument(
        "--drop-other-dimensions",
        action="store_true",
        help="do not carry the dimensions that are not lifted; reconstruct writes them as zero",
    )
    group.add_argument("--crs", metavar="CRS", help="instead of the file's, such as EPSG:2154")
    group.add_argument(
        "--vertical-unit",
        metavar="UNIT",
        help="of z: metre, foot or us_survey_foot; by default what the CRS says, else metre for "
        "a geographic CRS and the unit of x and y for any other",
    )


def open_input(arguments: argparse.Namespace) -> Terrain:
    """Return the terrain that the input arguments name."""
    from wavelet_gis.workflows.open import open_terrain

    return open_terrain(
        arguments.input,
        band=arguments.band,
        attributes=arguments.attributes,
        classes=arguments.classes,
        carry=not arguments.drop_other_dimensions,
        class_channels=arguments.class_channels,
        crs=arguments.crs,
        vertical_unit=arguments.vertical_unit,
    )


def add_wavelet_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the wavelet analysis; names and bounds are the core's matter."""
    group = parser.add_argument_group("wavelets")
    group.add_argument(
        "--design",
        metavar="NAME",
        help="a design of the paper, prediction and update in one, such as GLMN or NNLSMN; with "
        "the paper's partition unless --partition names another",
    )
    group.add_argument("--partition", metavar="NAME", help="which vertices are removed")
    group.add_argument("--prediction", metavar="NAME", help="how removed vertices are predicted")
    group.add_argument("--update", metavar="NAME", help="how details are handed to those kept")
    group.add_argument(
        "--signal", metavar="z|xyz", help="lift elevation and attributes, or x and y too"
    )
    group.add_argument(
        "--removal-fraction",
        type=float,
        metavar="F",
        help="largest share of the vertices that a level may take; smaller ones are slower and "
        "better",
    )
    group.add_argument("--bending-weight", type=float, metavar="W", help="of the paper's cost")
    group.add_argument(
        "--attribute-weights",
        type=_weights,
        metavar="W,W",
        help="one for each attribute, against the coordinates",
    )


def analysis_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the given wavelet options as keywords of `wavelet_core.analyse`.

    What is not given is left to the core's defaults.
    """
    from wavelet_core.errors import OptionError

    options = {
        "partition": arguments.partition,
        "prediction": arguments.prediction,
        "update": arguments.update,
        "signal": arguments.signal,
        "removal_fraction": arguments.removal_fraction,
        "bending_weight": arguments.bending_weight,
        "attribute_weights": arguments.attribute_weights,
    }
    if arguments.design is not None:
        if arguments.prediction is not None or arguments.update is not None:
            raise OptionError(
                "--design names prediction and update; leave out --prediction and --update."
            )
        options["prediction"] = arguments.design
        options["partition"] = arguments.partition or "quadric"
    return {name: value for name, value in options.items() if value is not None}


def add_overwrite_argument(parser: argparse.ArgumentParser) -> None:
    """Add the leave to replace an output that exists."""
    parser.add_argument("--overwrite", action="store_true", help="replace an output that exists")


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _classes(text: str) -> tuple[int, ...]:
    try:
        classes = tuple(int(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no list of classes such as 2,9") from None
    if not all(0 <= number <= 255 for number in classes):
        raise argparse.ArgumentTypeError("classes are 0 to 255")
    return classes


def _weights(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no list of numbers such as 1,0.5") from None
