"""``cluster FILE OUT``: vertices grouped by scale signature, or classes learned from labels."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from wavelet_gis.cli.commands._options import add_cell_size_argument, add_overwrite_argument, names
from wavelet_gis.cli.console import Console
from wavelet_gis.cli.table_help import names_from

if TYPE_CHECKING:
    from wavelet_gis.workflows.analyse import Analysis
    from wavelet_gis.workflows.learning.cluster import Labelled

ORDER = 80
HELP = "Cluster the vertices by their scales, or learn classes and predict the rest."


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
    names_from(
        "wavelet_gis.workflows.learning.clustering:CLUSTERINGS",
        clusters.add_argument("--method", metavar="NAME", help="by default the first of"),
    )
    clusters.add_argument(
        "--channels",
        type=names,
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
        help="say how well blocks of the map are predicted from the others (default)",
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of samples and starts")
    add_cell_size_argument(parser)
    add_overwrite_argument(parser)


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_gis.workflows.learning.cluster import check_label_output
    from wavelet_gis.workflows.open import load
    from wavelet_gis.workflows.save import save

    is_learned = arguments.learn is not None
    check_label_output(
        arguments.output,
        is_learned=is_learned,
        overwrite=arguments.overwrite,
        inputs=(arguments.file,),
    )
    find = _classes if is_learned else _clusters
    labelled = find(load(arguments.file), arguments, console)
    save(labelled, arguments.output, overwrite=arguments.overwrite, cell_size=arguments.cell_size)
    figures = labelled.figures()
    _tell(labelled, figures, arguments.output, console)
    console.figures({"output": str(arguments.output), **figures})


def _clusters(analysis: Analysis, arguments: argparse.Namespace, console: Console) -> Labelled:
    from wavelet_gis.workflows.learning.cluster import cluster

    with console.progress("clustering") as progress:
        return cluster(
            analysis,
            count=arguments.count,
            method=arguments.method,
            channels=arguments.channels,
            seed=arguments.seed,
            progress=progress,
        )


def _classes(analysis: Analysis, arguments: argparse.Namespace, console: Console) -> Labelled:
    from wavelet_gis.workflows.learning.cluster import classify
    from wavelet_gis.workflows.learning.labels import labels_from_las, labels_from_layer

    if arguments.learn == "las":
        given = labels_from_las(analysis.geo, arguments.unlabelled)
    else:
        given = labels_from_layer(analysis.geo, arguments.learn, arguments.field)
    with console.progress("learning") as progress:
        return classify(
            analysis,
            given,
            is_las=arguments.learn == "las",
            unlabelled=arguments.unlabelled,
            merges=arguments.merge,
            validate=arguments.validate,
            seed=arguments.seed,
            progress=progress,
        )


def _tell(labelled: Labelled, figures: dict[str, Any], output: str, console: Console) -> None:
    validation = labelled.validation
    if validation is not None:
        console.table(
            ("class", *(f"as {c}" for c in validation.classes)),
            [
                (c, *map(int, row))
                for c, row in zip(validation.classes, validation.confusion, strict=True)
            ],
        )
    rows = [
        (row["label"], row["n_vertices"], f"{row['share']:.1%}", *map(float, row["rms"][::-1][:8]))
        for row in figures["clusters"]
    ]
    spacings = [f"rms at {spacing:.3g}" for spacing in figures["spacings"][::-1][:8]]
    console.table((labelled.name, "vertices", "share", *spacings), rows)
    plural = {"cluster": "clusters", "class": "classes"}[labelled.name]
    console.say(f"{len(rows)} {plural}; {output}")


def _numbers(text: str) -> tuple[int, ...]:
    try:
        return tuple(int(part) for part in text.split(",") if part.strip())
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of classes such as 0,1") from None


def _pair(text: str) -> tuple[int, int]:
    try:
        source, target = text.split("=")
        return int(source), int(target)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a pair such as 3=5") from None
