"""``cluster FILE OUT``: vertices grouped by scale signature, or classes learned from labels."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wavelet_gis.cli.commands._options import add_overwrite_argument
from wavelet_gis.cli.console import Console

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wavelet_gis.model.geo_pyramid import GeoPyramid

HELP = "Cluster the vertices by their scales, or learn classes and predict the rest."

RASTER_SUFFIXES = (".tif", ".tiff")
CLOUD_SUFFIXES = (".las", ".laz")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument(
        "output", help="points (.gpkg), a raster (.tif), or with --learn classified .las or .laz"
    )
    clusters = parser.add_argument_group("clusters")
    clusters.add_argument(
        "--count", type=int, metavar="N", help="of clusters; by default found from the data"
    )
    clusters.add_argument(
        "--method",
        choices=("kmeans", "mixture"),
        default="kmeans",
        help="k-means (default) or a mixture of Gaussians",
    )
    clusters.add_argument(
        "--channels",
        type=_names,
        default=(),
        metavar="A,B",
        help="channels whose scales count; by default the geometry",
    )
    learning = parser.add_argument_group("classes")
    learning.add_argument(
        "--learn",
        metavar="las|FILE",
        help="las: from the classes of the points; else from a layer of polygons or points",
    )
    learning.add_argument("--field", default="class", metavar="NAME", help="of the layer's classes")
    learning.add_argument(
        "--unlabelled",
        type=_numbers,
        default=(0, 1),
        metavar="N,N",
        help="LAS classes that are to be predicted; by default 0,1",
    )
    learning.add_argument(
        "--merge",
        type=_pair,
        action="append",
        default=[],
        metavar="N=M",
        help="count class N as M; may be given several times",
    )
    learning.add_argument(
        "--validate",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="tell how well blocks of the map are predicted from the others (default)",
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of samples and starts")
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
    from wavelet_gis.workflows.classify import cluster_summary

    suffix = Path(arguments.output).suffix.lower()
    check_output(
        arguments.output,
        overwrite=arguments.overwrite,
        suffixes=(".gpkg", *RASTER_SUFFIXES, *CLOUD_SUFFIXES),
        inputs=(arguments.file,),
    )
    if suffix in CLOUD_SUFFIXES and arguments.learn is None:
        raise OptionError("clusters are no LAS classes; write .gpkg or .tif, or use --learn.")
    geo = read_pyramid(arguments.file)
    find = _clusters if arguments.learn is None else _classes
    labels, confidence, figures = find(geo, arguments, console)
    with new_file(arguments.output, overwrite=arguments.overwrite) as scratch:
        _write(scratch, geo, labels, confidence, arguments)
    summary = cluster_summary(geo, labels)
    word = "cluster" if arguments.learn is None else "class"
    rows = [
        (row["label"], row["n_vertices"], f"{row['share']:.1%}", *map(float, row["rms"][::-1][:8]))
        for row in summary["clusters"]
    ]
    spacings = [f"rms at {spacing:.3g}" for spacing in summary["spacings"][::-1][:8]]
    console.table((word, "vertices", "share", *spacings), rows)
    console.say(f"{len(rows)} {'clusters' if word == 'cluster' else 'classes'}; {arguments.output}")
    console.figures({"output": str(arguments.output), **figures, **summary})


def _clusters(
    geo: GeoPyramid, arguments: argparse.Namespace, console: Console
) -> tuple[NDArray[np.int64], NDArray[np.float64], dict[str, Any]]:
    from wavelet_core.features.signature import energy_signature
    from wavelet_gis.workflows.classify import cluster_vertices

    with console.progress("spectrum") as progress:
        signature = energy_signature(geo.pyramid, arguments.channels, progress)
    clusters = cluster_vertices(signature, arguments.count, arguments.method, arguments.seed)
    figures = {
        "method": arguments.method,
        "n_clusters": clusters.n_clusters,
        "explained": clusters.explained,
    }
    return clusters.labels, clusters.confidence, figures


def _classes(
    geo: GeoPyramid, arguments: argparse.Namespace, console: Console
) -> tuple[NDArray[np.int64], NDArray[np.float64], dict[str, Any]]:
    from wavelet_gis.workflows.classify import merge_labels
    from wavelet_gis.workflows.labels import labels_from_las, labels_from_layer
    from wavelet_gis.workflows.learn import learn

    is_las = arguments.learn == "las"
    if is_las:
        given = labels_from_las(geo, arguments.unlabelled)
    else:
        given = labels_from_layer(geo, arguments.learn, arguments.field)
    with console.progress("learning") as progress:
        learned = learn(
            geo,
            merge_labels(given, arguments.merge),
            is_las=is_las,
            validate=arguments.validate,
            seed=arguments.seed,
            progress=progress,
        )
    for line in learned.notes:
        console.say(line)
    figures: dict[str, Any] = {
        "n_labelled": learned.n_labelled,
        "left_out": list(learned.left_out),
        "notes": list(learned.notes),
    }
    if learned.validation is not None:
        figures["validation"] = learned.validation.as_dict()
    return learned.labels, learned.confidence, figures


def _write(
    path: str | os.PathLike[str],
    geo: GeoPyramid,
    labels: NDArray[np.int64],
    confidence: NDArray[np.float64],
    arguments: argparse.Namespace,
) -> None:
    from wavelet_gis.io.vector import add_layers
    from wavelet_gis.products.label_layer import label_layer
    from wavelet_gis.products.vertex_raster import label_band, write_bands

    name = "cluster" if arguments.learn is None else "class"
    suffix = Path(path).suffix.lower()
    if suffix in CLOUD_SUFFIXES:
        from wavelet_gis.io.las import write_cloud
        from wavelet_gis.workflows.labels import cloud_with_classes

        own = arguments.unlabelled if arguments.learn == "las" else None
        write_cloud(path, cloud_with_classes(geo, labels, own, arguments.merge))
    elif suffix in RASTER_SUFFIXES:
        mesh = geo.pyramid.synthesise()
        bands = label_band(geo, mesh, labels, name, arguments.cell_size)
        write_bands(path, bands, geo.system.wkt)
    else:
        add_layers(path, [label_layer(geo, labels, confidence, name)], geo.system)


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _numbers(text: str) -> tuple[int, ...]:
    try:
        return tuple(int(part) for part in text.split(",") if part.strip())
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no list of classes such as 0,1") from None


def _pair(text: str) -> tuple[int, int]:
    try:
        source, target = text.split("=")
        return int(source), int(target)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no pair such as 3=5") from None
