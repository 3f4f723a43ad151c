"""Arguments that several commands share, and what they mean."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from wavelet_gis.cli.table_help import names_from
from wavelet_gis.io.formats import (
    MESH_FORMATS,
    MESH_SUFFIXES,
    PYRAMID_SUFFIX,
    RASTER_SUFFIXES,
    any_of,
)

if TYPE_CHECKING:
    from wavelet_gis.model.terrain import Terrain
    from wavelet_gis.workflows.options import WaveletOptions

__all__ = [
    "INPUTS",
    "add_input_arguments",
    "add_inputs_argument",
    "add_line_arguments",
    "add_overwrite_argument",
    "add_place_arguments",
    "add_raster_arguments",
    "add_surface_arguments",
    "add_wavelet_arguments",
    "box",
    "input_files",
    "length",
    "line_options",
    "names",
    "number_or_text",
    "open_given",
    "reading_options",
    "surface_formats",
    "surface_options",
    "surface_suffixes",
    "wavelet_options",
]

#: What can be analysed, for help.
INPUTS = (
    "a raster that GDAL reads; a LAS, LAZ or COPC file or an ept.json; points in a vector layer or "
    "a table (.csv, .xyz); a TIN as a layer of triangles"
)


#: What several files may be, for help.
SEVERAL = "; or several rasters, or LAS files, or a folder of them, that are parts of one"


def add_inputs_argument(parser: argparse.ArgumentParser, others: str = "") -> None:
    """Add one input or several.

    Parameters
    ----------
    parser : ArgumentParser
    others : str
        What the command takes besides, for help.
    """
    parser.add_argument("input", nargs="+", help=f"{others}{INPUTS}{SEVERAL}")


#: Options of how an input is read.
_READING = (
    "layer",
    "z_field",
    "band",
    "attributes",
    "classes",
    "carry",
    "class_channels",
    "crs",
    "vertical_unit",
    "nodata",
    "offline",
    "keep_noise",
    "keep_withheld",
    "duplicates",
    "max_edge",
    "concave",
    "bbox",
    "resolution",
)


def add_raster_arguments(group: argparse._ArgumentGroup) -> None:
    """Add what says how a raster is read."""
    group.add_argument("--band", type=int, metavar="N", help="band of a raster, from 1")
    group.add_argument(
        "--nodata",
        type=_nodata,
        metavar="VALUE",
        help="number that stands for nothing in a raster, as stored (before scale and offset), "
        "instead of the file's; 'none' for none",
    )
    group.add_argument(
        "--offline",
        action="store_true",
        help="refuse a raster that reads from the network, as a VRT may",
    )


def add_place_arguments(group: argparse._ArgumentGroup) -> None:
    """Add what says where an input is, instead of its file."""
    group.add_argument("--crs", metavar="CRS", help="instead of the file's, such as EPSG:2154")
    group.add_argument(
        "--vertical-unit",
        metavar="UNIT",
        help="of z: metre, foot or us_survey_foot; by default what the CRS says, else metre for "
        "degrees and kilometres and the unit of x and y for any other",
    )


def add_point_arguments(group: argparse._ArgumentGroup) -> None:
    """Add what says how a LAS file is read, and which of its points make the surface."""
    group.add_argument(
        "--attributes",
        type=names,
        default=(),
        metavar="A,B",
        help="what to lift along: dimensions of a point cloud (classification, intensity, "
        "return_number, rgb, any extra dimension, hag: height above the class-2 ground), or fields "
        "of points",
    )
    group.add_argument(
        "--classes", type=_classes, metavar="N,N", help="only points of these classes"
    )
    group.add_argument(
        "--keep-noise",
        action="store_true",
        help="let points of the classes 7 and 18 (noise) be part of the surface; by default they "
        "are carried only, and come back",
    )
    group.add_argument(
        "--keep-withheld", action="store_true", help="the same for points with the withheld flag"
    )
    names_from(
        "wavelet_gis.model.points.aside:DUPLICATE_RULES",
        group.add_argument(
            "--duplicates",
            metavar="RULE",
            help="which height points that share x and y have in common, by default the first of",
        ),
    )


def add_input_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of how a DEM or a LAS file is read."""
    group = parser.add_argument_group("input")
    add_raster_arguments(group)
    add_point_arguments(group)
    group.add_argument(
        "--class-channels",
        action="store_true",
        help="lift classes, return numbers and other categories as one channel of 0 and 1 each",
    )
    group.add_argument(
        "--drop-other-dimensions",
        dest="carry",
        action="store_false",
        help="do not carry the dimensions that are not lifted; reconstruct writes them as zero",
    )
    group.add_argument(
        "--max-edge",
        type=_max_edge,
        metavar="LENGTH|auto",
        help="leave triangles with a longer edge out, as gaps of the point cloud; in the unit of x "
        "and y, or metres for a geographic CRS; auto: five times the spacing that 95 %% of the "
        "points keep",
    )
    group.add_argument(
        "--concave",
        action="store_true",
        help="leave out only what such edges open to the outside, so that gaps inside stay closed",
    )
    group.add_argument(
        "--bbox",
        type=box,
        metavar="X,Y,X,Y",
        help="only points of a cloud in this box: smallest x and y, largest x and y; of a COPC "
        "file no more is read",
    )
    group.add_argument(
        "--resolution",
        type=length,
        metavar="D",
        help="of a COPC file or an ept.json only the levels that have points so far apart",
    )
    group.add_argument("--layer", metavar="NAME", help="of a vector file of points or triangles")
    group.add_argument(
        "--z-field", metavar="NAME", help="field with the elevation where its points have no z"
    )
    add_place_arguments(group)


def add_line_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the shapes that a triangulation must respect."""
    group = parser.add_argument_group(
        "lines", "each FILE is a vector file of one layer, in any CRS; what it holds stays"
    )
    group.add_argument(
        "--breaklines",
        metavar="FILE",
        help="lines that become edges of the TIN; those without z are laid on the terrain",
    )
    group.add_argument(
        "--clip", metavar="FILE", help="polygons; only the terrain inside, their rings as edges"
    )
    group.add_argument(
        "--fixed-points", metavar="FILE", help="points that become vertices, laid on it or with z"
    )
    group.add_argument(
        "--line-tolerance",
        type=float,
        metavar="M",
        help="how far such a line may be above or below the terrain for the sake of fewer "
        "vertices, in the unit of z; by default --max-error, else a thousandth of the relief",
    )


def line_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the shapes that are given; without a tolerance of their own, lines have the TIN's."""
    tolerance = arguments.line_tolerance
    if tolerance is None and (arguments.breaklines or arguments.clip):
        tolerance = arguments.max_error if isinstance(arguments.max_error, float) else None
    return {
        "breaklines": arguments.breaklines,
        "clip": arguments.clip,
        "fixed_points": arguments.fixed_points,
        "line_tolerance": tolerance,
    }


def input_files(arguments: argparse.Namespace) -> tuple[str, ...]:
    """Return every file that is read, none of which an output may replace."""
    from wavelet_gis.io.names import files_of

    named = (arguments.breaklines, arguments.clip, arguments.fixed_points)
    files = files_of(arguments.input)
    return (*files, *(path for path in named if path), *tolerance_files(arguments))


def tolerance_files(arguments: argparse.Namespace) -> tuple[str, ...]:
    """Return the files that tolerances and sizes by place come from, and formulas that are none."""
    options = ("zones", "max_error", "size_zones", "longest_edge", "max_area")
    named = (getattr(arguments, option, None) for option in options)
    return tuple(name for name in named if isinstance(name, str))


def add_max_error_argument(rule: Any, help_text: str) -> None:
    """Add the largest error, a number or what gives one by place."""
    rule.add_argument(
        "--max-error",
        type=number_or_text,
        metavar="M",
        help=f"{help_text}; in the unit of z. By place: a raster, or a formula such as "
        "'max(0.1, 0.02 * slope)' of z and slope (degrees). Points that share x and y with a "
        "vertex are reported",
    )


def add_zone_arguments(parser: argparse.ArgumentParser) -> None:
    """Add polygons with a tolerance of their own."""
    group = parser.add_argument_group("tolerance by place")
    group.add_argument(
        "--zones",
        metavar="FILE",
        help="polygons with a largest error of their own; --max-error holds outside",
    )
    group.add_argument(
        "--zone-field",
        metavar="NAME",
        help="the field of the zones that holds it, max_error by default",
    )


def zone_table(surface: Any, console: Any) -> None:
    """Print what came out in each zone of a tolerance by place."""
    if surface.zones:
        header = ("tolerance", "to", "points", "vertices", "RMSE", "largest error")
        console.table(header, list(surface.zones))


def open_given(arguments: argparse.Namespace) -> Terrain:
    """Return the terrain that the input arguments name."""
    from wavelet_gis.workflows.open import open_input

    return open_input(arguments.input, **reading_options(arguments), **line_options(arguments))


def reading_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return what `add_input_arguments` asks, by the names of `wavelet_gis.open`."""
    return {name: getattr(arguments, name) for name in _READING}


def add_wavelet_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the wavelet analysis; names and bounds are the core's matter."""
    group = parser.add_argument_group("wavelets")
    group.add_argument(
        "--design",
        metavar="NAME",
        help="a design of the paper, prediction and update in one, such as GLMN or NNLSMN; with "
        "the paper's partition unless --partition names another",
    )
    for table, flag, help_ in (
        ("PARTITIONS", "--partition", "which vertices are removed at a level"),
        ("PREDICTIONS", "--prediction", "how removed vertices are predicted"),
        ("UPDATES", "--update", "how details are passed on to the vertices kept"),
    ):
        names_from(f"wavelet_core:{table}", group.add_argument(flag, metavar="NAME", help=help_))
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
    group.add_argument(
        "--outline-tolerance",
        type=float,
        metavar="D",
        help="let vertices of the outline and of holes go while the outline stays within this "
        "distance, in the unit of x and y (metres for a CRS in degrees); by default 0",
    )
    group.add_argument(
        "--bending-weight",
        type=float,
        metavar="W",
        help="weight of bending energy in the paper's cost",
    )
    names_from(
        "wavelet_core:QUADRICS",
        group.add_argument(
            "--quadrics",
            metavar="NAME",
            help="of the paper's partition; another reading than the paper's text is the second of",
        ),
    )
    names_from(
        "wavelet_core:COSTS",
        group.add_argument(
            "--cost",
            metavar="NAME",
            help="by which the paper's partition ranks; another reading is the second of",
        ),
    )
    group.add_argument(
        "--attribute-weights",
        type=_weights,
        metavar="W,W",
        help="one for each attribute, against the coordinates",
    )


def wavelet_options(arguments: argparse.Namespace) -> WaveletOptions:
    """Return the wavelet options; what is not given is left to the core's defaults."""
    return {
        "design": arguments.design,
        "partition": arguments.partition,
        "prediction": arguments.prediction,
        "update": arguments.update,
        "signal": arguments.signal,
        "removal_fraction": arguments.removal_fraction,
        "outline_tolerance": arguments.outline_tolerance,
        "bending_weight": arguments.bending_weight,
        "quadrics": arguments.quadrics,
        "cost": arguments.cost,
        "attribute_weights": arguments.attribute_weights,
    }


def add_cell_size_argument(parser: Any, of_points: str = "their mean spacing") -> None:
    """Add the cell size of a raster that is written."""
    parser.add_argument(
        "--cell-size",
        type=length,
        metavar="SIZE",
        help="of a raster, in the unit of the CRS; by default the grid of the input, and for "
        f"points {of_points}",
    )


def add_surface_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of a surface that is written as a raster or as a mesh file."""
    raster = parser.add_argument_group("raster")
    add_cell_size_argument(raster, "their mean spacing at this level")
    raster.add_argument("--attribute", metavar="NAME", help="an attribute instead of the elevation")
    raster.add_argument("--cog", action="store_true", help="write a cloud-optimised GeoTIFF")
    parser.add_argument(
        "--to-crs",
        metavar="CRS",
        help="of a mesh file: a projected CRS, or auto for the UTM zone, which is the default for "
        "an input in degrees",
    )


def surface_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the options of a surface that is written as a raster or as a mesh file."""
    return {name: getattr(arguments, name) for name in ("cell_size", "attribute", "cog", "to_crs")}


def surface_formats() -> str:
    """Return the names of the formats of TINs and rasters, for help."""
    meshes = ", ".join(row.name for row in MESH_FORMATS)
    return f"a TIN (GPKG, {meshes}) or a raster (GeoTIFF, COG)"


def surface_suffixes() -> str:
    """Return the suffixes of TINs and rasters, for help."""
    return any_of((PYRAMID_SUFFIX, *MESH_SUFFIXES, *RASTER_SUFFIXES))


def add_overwrite_argument(parser: argparse.ArgumentParser) -> None:
    """Add the leave to replace an output that exists."""
    parser.add_argument("--overwrite", action="store_true", help="replace an output that exists")


def add_layers_argument(parser: argparse.ArgumentParser, default: str | None = "auto") -> None:
    """Add the choice of the layers of a pyramid file."""
    parser.add_argument(
        "--layers",
        choices=("auto", "all", "coarse", "none"),
        default=default,
        help="vector layers to write beside the pyramid, which is complete without them: the "
        "coarse TIN, up to 50,000 vertices, and the details of the coarser levels, up to 80,000 "
        "features (auto, the default), those of all levels, the coarse TIN only, or none",
    )


def number_or_text(text: str) -> float | str:
    """Return a length, or the text that gives one by place."""
    try:
        return length(text)
    except ValueError:
        return text


def _nodata(text: str) -> float | str:
    if text.lower() == "none":
        return "none"
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number nor 'none'") from None


def length(text: str) -> float:
    """Return a length from the command line."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a length above 0")
    return value


def box(text: str) -> tuple[float, float, float, float]:
    """Return smallest x and y, largest x and y, from the command line."""
    try:
        x_min, y_min, x_max, y_max = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not four numbers such as 0,0,9,9") from None
    return x_min, y_min, x_max, y_max


def level_numbers(text: str) -> tuple[int, ...]:
    """Return a list of levels from the command line."""
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of levels such as 0,4") from None


def names(text: str) -> tuple[str, ...]:
    """Return a list of names from the command line."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _classes(text: str) -> tuple[int, ...]:
    try:
        classes = tuple(int(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of classes such as 2,9") from None
    if not all(0 <= number <= 255 for number in classes):
        raise argparse.ArgumentTypeError("classes are 0 to 255")
    return classes


def _max_edge(text: str) -> float | str:
    if text == "auto":
        return text
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text!r} is neither a length above 0 nor auto")
    return value


def _weights(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a list of numbers such as 1,0.5"
        ) from None
