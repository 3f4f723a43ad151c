"""``info FILE``: what a pyramid file holds."""

from __future__ import annotations

import argparse
from typing import Any

from wavelet_gis.cli.console import Console

ORDER = 20
HELP = "Show what a pyramid file holds: source, CRS, parameters, size and errors by level."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", help="a pyramid file")
    parser.add_argument(
        "--triangles",
        action="store_true",
        help="measure the triangles of every level, too: angles, edges and areas in plan",
    )


def run(arguments: argparse.Namespace, console: Console) -> None:
    """Carry the command out."""
    from wavelet_core.errors import PyramidError
    from wavelet_gis.io.pyramid.pyramid_file import read_summary

    summary = read_summary(arguments.file)
    try:
        lines = list(_lines(summary))
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise PyramidError(
            f"{arguments.file}: the description of the pyramid is damaged ({error!r}); analyse "
            "the input anew."
        ) from error
    for line in lines:
        console.say(line)
    keys = (
        "level",
        "n_vertices",
        "n_faces",
        "rmse_coefficients",
        "rmse_surface",
        "max_error_surface",
    )
    console.table(
        ("level", "vertices", "triangles", "rmse_coefficients", "rmse_surface", "max_error"),
        [tuple(level[key] for key in keys) for level in summary["levels"]],
    )
    if arguments.triangles:
        from wavelet_gis.workflows.open import load
        from wavelet_gis.workflows.read_off.quality import LevelQuality, mesh_quality

        with console.progress("triangles") as progress:
            rows = mesh_quality(load(arguments.file), progress=progress)
        console.table([name.replace("_", " ") for name in LevelQuality._fields], rows)
        summary["triangles"] = [row._asdict() for row in rows]
    console.figures(summary)


def _lines(summary: dict[str, Any]) -> list[str]:
    from wavelet_gis.model.exact_restore import CORRECTIONS

    source, pyramid, crs = summary["source"], summary["pyramid"], summary["crs"]
    lines = [f"source      {summary['source_name']} ({_source(source)})"]
    if "checksum" in source:
        exact = "kept to the last bit" if CORRECTIONS in source else "altered since the analysis"
        lines.append(f"original    {exact}")
    parameters = pyramid["parameters"]
    design = ", ".join(
        str(parameters[key]) for key in ("partition", "prediction", "update") if key in parameters
    )
    lines += [
        f"CRS         {crs['name']} ({crs['kind']}), z in {summary['vertical_unit']}",
        f"lifted      {', '.join(map(str, pyramid['channels']))}",
        f"design      {design}",
        f"software    {summary['format']['software']}, format {summary['format']['version']}",
    ]
    lines += [f"change      {change}" for change in summary["history"]]
    lines += [f"note        {note['text']}" for note in summary.get("notes", [])]
    return lines


def _source(source: dict[str, Any]) -> str:
    if source["kind"] == "raster":
        n_rows, n_columns = source["shape"]
        return f"raster of {n_rows} x {n_columns}, {source['dtype'].lstrip('<|')}"
    if source["kind"] == "points":
        text = f"{source['n_points']:,} points"
        if source["classes"] is not None:
            text += f" of classes {', '.join(map(str, source['classes']))}"
        return text
    return "TIN"
