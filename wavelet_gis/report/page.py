"""The quality report of a pyramid: one HTML page that needs nothing else, not even a network."""

from __future__ import annotations

import html
import json
import math
from collections.abc import Sequence
from typing import Any

from wavelet_core import Progress
from wavelet_core.progress import part_of, report
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.report.figures import CANCELLED, ReportData, report_data
from wavelet_gis.report.pictures import (
    difference_png,
    exaggeration_of,
    hillshade_png,
    histogram_chart,
    line_chart,
    picture_grid,
)

__all__ = ["report_page"]

#: Share of the time in which the levels are measured; the pictures take the rest.
MEASURED_SHARE = 0.9


def report_page(
    geo: GeoPyramid,
    levels: Sequence[int] | None = None,
    progress: Progress | None = None,
) -> tuple[str, dict[str, Any]]:
    """Return the report as an HTML page, and its figures.

    Parameters
    ----------
    geo : GeoPyramid
        What is reported on.
    levels : sequence of int, optional
        Shown as pictures; by default those with about a quarter and a twentieth of the vertices,
        and the coarsest.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    page : str
        Self-contained: styles, pictures and charts are in it.
    figures : dict
        JSON-able; also in the page, in the element with the id ``figures``.

    Raises
    ------
    OptionError
        A level that the pyramid does not have.
    Cancelled
        ``progress`` returned False.
    """
    data = report_data(geo, levels, part_of(progress, 0.0, MEASURED_SHARE))
    figures = plain(data.figures)
    unit = _unit(geo)
    body = "\n".join(
        [
            _head(figures, unit),
            _pictures(data, figures, unit, part_of(progress, MEASURED_SHARE, 1.0)),
            _charts(figures, unit),
            _level_table(figures, unit),
            _where(figures, unit),
            _triangles(figures),
            _parameters(figures),
        ]
    )
    title = f"Quality of the pyramid of {figures['source']['name']}"
    # "</script" in a name would end the element, whatever the JSON says around it.
    embedded = json.dumps(figures, allow_nan=False).replace("<", "\\u003c")
    page = (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{html.escape(title)}</title><style>{_STYLE}</style></head>\n<body><main>\n"
        f"<h1>{html.escape(title)}</h1>\n{body}\n</main>\n"
        f'<script type="application/json" id="figures">{embedded}</script>\n</body></html>\n'
    )
    return page, figures


def plain(value: Any) -> Any:
    """Return the figures with None for what JSON cannot say: NaN and infinities."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _unit(geo: GeoPyramid) -> str:
    names = {"metre": "m", "foot": "ft", "us_survey_foot": "ft (US)"}
    if geo.vertical_unit not in names and geo.system.kind == "projected":
        return {1.0: "m", 0.3048: "ft"}.get(geo.system.horizontal_unit, "units of z")
    return names.get(geo.vertical_unit, "units of z")


def _head(figures: dict[str, Any], unit: str) -> str:
    source, coarsest = figures["source"], figures["levels"][-1]
    if source["is_exact"]:
        verdict = "The original comes back bit for bit."
    elif figures["history"]:
        verdict = "Altered since the analysis, so the original does not come back."
    else:
        verdict = "The finest level comes back to rounding."
    cards = [
        ("vertices", _count(source["n_vertices"])),
        ("levels", str(source["n_levels"])),
        ("coarsest level", f"{_count(coarsest['n_vertices'])} vertices"),
        ("its RMSE", f"{_number(coarsest['rmse_surface'])} {unit}"),
        ("its largest error", f"{_number(coarsest['max_error_surface'])} {unit}"),
    ]
    inner = "".join(f"<div><b>{html.escape(v)}</b><span>{k}</span></div>" for k, v in cards)
    return (
        f'<p class="lead">{_kind(source)} in {html.escape(str(source["crs"]))}; lifted: '
        f"{html.escape(', '.join(source['channels']))}. {verdict}</p>"
        f'<section class="cards">{inner}</section>'
    )


def _kind(source: dict[str, Any]) -> str:
    return {"raster": "A raster", "points": "A point cloud"}.get(source["kind"], "A TIN")


def _pictures(
    data: ReportData, figures: dict[str, Any], unit: str, progress: Progress | None
) -> str:
    finest_level = figures["source"]["n_levels"]
    finest = data.shown[finest_level]
    grid = picture_grid(finest)
    exaggeration = exaggeration_of(finest, grid)
    rows = {row["level"]: row for row in figures["levels"]}
    shades = [
        _picture(
            hillshade_png(finest, grid, exaggeration),
            f"Input: {_count(finest.n_vertices)} vertices",
            finest_level,
        )
    ]
    differences = []
    for k, (level, errors) in enumerate(data.errors.items(), 1):
        row = rows[level]
        shades.append(
            _picture(
                hillshade_png(data.shown[level], grid, exaggeration),
                f"Level {level}: {_count(row['n_vertices'])} vertices "
                f"({_share(row['vertex_share'])}), RMSE {_number(row['rmse_surface'])} {unit}",
                level,
            )
        )
        limit = row["error_90"] or row["max_error_surface"] or 0.0
        differences.append(
            _picture(
                difference_png(finest, errors, grid, limit),
                f"Input less level {level}: red above, blue below, full colour from "
                f"{_number(limit)} {unit}",
                level,
            )
        )
        report(progress, k / len(data.errors), CANCELLED)
    lit = "Lit from the north-west"
    scale = f", heights times {exaggeration:.2g}" if abs(exaggeration - 1) > 0.005 else ""
    return (
        f'<h2>What is kept, and what is lost</h2><p>{lit}{scale}.</p><div class="grid">'
        f'{"".join(shades)}</div><div class="grid">{"".join(differences)}</div>'
    )


def _picture(uri: str, caption: str, level: int) -> str:
    text = html.escape(caption)
    return (
        f'<figure class="picture"><img src="{uri}" alt="{text}" data-level="{level}">'
        f"<figcaption>{text}</figcaption></figure>"
    )


def _charts(figures: dict[str, Any], unit: str) -> str:
    coarser = [row for row in figures["levels"] if row["level"] < figures["source"]["n_levels"]]
    n_vertices = [float(row["n_vertices"]) for row in coarser]

    def column(name: str) -> list[float]:
        return [math.nan if row[name] is None else float(row[name]) for row in coarser]

    charts = [
        line_chart(
            "Vertical error of the surface",
            n_vertices,
            [
                ("largest", column("max_error_surface")),
                ("90 % are below", column("error_90")),
                ("RMSE", column("rmse_surface")),
            ],
            "vertices of the level",
            unit,
            log_x=True,
            log_y=True,
        ),
        line_chart(
            "Error of the coefficients (Eq. 54, mean form)",
            n_vertices,
            [("RMSE", column("rmse_coefficients"))],
            "vertices of the level",
            "part of the range",
            log_x=True,
        ),
        histogram_chart(
            "Magnitude of the details of each level",
            figures["details"]["bin_edges"],
            [(f"level {row['level']}", row["counts"]) for row in figures["details"]["levels"]][
                ::-1
            ],
            f"magnitude ({unit})",
        ),
        line_chart(
            "Smallest angle of the triangles",
            n_vertices,
            [
                ("median", column("median_smallest_angle")),
                ("95 % are above", column("low_smallest_angle")),
            ],
            "vertices of the level",
            "degrees",
            log_x=True,
        ),
    ]
    return (
        f'<h2>Errors and details</h2><div class="grid charts">{"".join(charts)}</div>'
        "<p>The error of the surface is the vertical distance of every input vertex from the "
        "level's triangles. The error of the coefficients compares the vertices that were kept "
        "with their originals; it is 0 for plain thinning, so it says little by itself.</p>"
    )


def _level_table(figures: dict[str, Any], unit: str) -> str:
    # What matters most comes first: a phone shows the left half of the table.
    header = (
        "level", "vertices", "RMSE", "90\u202f%", "largest", "share", "triangles", "spacing", "open"
    )  # fmt: skip
    rows = [
        (
            str(row["level"]),
            _count(row["n_vertices"]),
            _number(row["rmse_surface"]),
            _number(row["error_90"]),
            _number(row["max_error_surface"]),
            _share(row["vertex_share"]),
            _count(row["n_faces"]),
            _number(row["spacing"]),
            _count(row["n_uncovered"]),
        )
        for row in figures["levels"]
    ]
    return (
        f"<h2>Levels</h2><p>Errors in {html.escape(unit)}; spacing is the median length of the "
        "edges in plan; open counts input vertices that no triangle covers.</p>"
        f"{_table(header, rows)}"
    )


def _where(figures: dict[str, Any], unit: str) -> str:
    parts = ["<h2>Where the error is</h2>"]
    for shown in figures["shown"]:
        quantiles = shown["quantiles"]
        slopes = [
            (
                f"{row['slope_from']:g}° to {row['slope_to']:g}°",
                f"{_share(row['vertex_share'])}",
                _number(row["rmse_surface"]),
                f"{_share(row['squared_error_share'])}",
            )
            for row in shown["by_slope"]
        ]
        worst = [
            (_place(place["x"]), _place(place["y"]), _number(place["z"]), _number(place["error"]))
            for place in shown["worst"]
        ]
        parts.append(
            f"<h3>Level {shown['level']}</h3><p>Half of the input vertices are within "
            f"{_number(quantiles['0.5'])} {unit} of the surface, 90\u202f% within "
            f"{_number(quantiles['0.9'])}, 99\u202f% within {_number(quantiles['0.99'])}; "
            f"on average they lie {_number(abs(shown['bias'] or 0.0))} {unit} "
            f"{'above' if (shown['bias'] or 0.0) >= 0 else 'below'} it.</p>"
            '<div class="grid"><div>'
            + _table(("slope", "vertices", "RMSE", "of squared error"), slopes)
            + "</div><div>"
            + _table(("x", "y", "z", "largest errors"), worst)
            + "</div></div>"
        )
    return "".join(parts)


def _triangles(figures: dict[str, Any]) -> str:
    rows = [
        (
            str(row["level"]),
            _count(row["n_faces"]),
            f"{_number(row['median_smallest_angle'])}°",
            f"{_number(row['low_smallest_angle'])}°",
            _share(row["sliver_share"]),
        )
        for row in figures["levels"]
    ]
    header = ("level", "triangles", "median", "95 % above", "under 10°")
    return (
        "<h2>Triangles</h2><p>The smallest angle of each triangle, in plan.</p>"
        f"{_table(header, rows)}"
    )


def _parameters(figures: dict[str, Any]) -> str:
    source = figures["source"]
    extent = [(axis, *(_place(v) for v in source[axis])) for axis in "xyz"]
    chosen = [(key, json.dumps(value)) for key, value in sorted(figures["parameters"].items())]
    parts = [
        "<h2>Made with</h2>",
        _table(("option of the analysis", "value"), chosen),
        _table(("software", "version"), list(figures["versions"].items())),
        _table(("extent", "from", "to"), extent),
    ]
    if figures["history"]:
        changes = "".join(f"<li>{html.escape(change)}</li>" for change in figures["history"])
        parts.append(f"<h3>Changes since the analysis</h3><ul>{changes}</ul>")
    if figures["notes"]:
        notes = "".join(f"<li>{html.escape(note['text'])}</li>" for note in figures["notes"])
        parts.append(f"<h3>Notes on the input and its analysis</h3><ul>{notes}</ul>")
    return '<div class="made">' + "".join(parts) + "</div>"


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    head = "".join(f"<th>{html.escape(name)}</th>" for name in header)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return (
        f'<div class="scroll" tabindex="0"><table><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def _count(value: int) -> str:
    return f"{value:,}".replace(",", "\u202f")


def _share(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.1f}\u202f%"


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    if value != 0 and abs(value) < 1e-6:
        return f"{value:.1e}"
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def _place(value: float) -> str:
    return f"{value:.6f}" if abs(value) < 400 else f"{value:.1f}"


_STYLE = """
:root{--ink:#1d2327;--soft:#5b666e;--rule:#d9dee2;--paper:#fff;--card:#f4f6f7;
--c0:#b3402e;--c1:#c98a1b;--c2:#1f5f99}
@media (prefers-color-scheme:dark){:root{--ink:#e6eaed;--soft:#9aa7b0;--rule:#384249;
--paper:#14191c;--card:#1e2529;--c0:#ef8a72;--c1:#e5b456;--c2:#79b4ea}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
main{max-width:1180px;margin:0 auto;padding:16px}
h1{font-size:1.5rem;line-height:1.25;margin:.4em 0;overflow-wrap:anywhere}
h2{font-size:1.2rem;margin:1.8em 0 .4em}h3{font-size:1rem;margin:1.4em 0 .2em}
p{max-width:70ch;margin:.4em 0 .9em}.lead{color:var(--soft)}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(140px,1fr));gap:10px}
.cards div{background:var(--card);border-radius:8px;padding:10px 12px}
.cards b{display:block;font-size:1.1rem}.cards span{color:var(--soft);font-size:.85rem}
.grid{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(260px,100%),1fr));gap:18px}
.grid>*{min-width:0}.grid{margin-bottom:14px}.charts{align-items:start;grid-template-columns:repeat(auto-fit,minmax(min(320px,100%),1fr))}
figure{margin:0}figcaption{font-size:.88rem;color:var(--soft);margin:.3em 0}
.chart figcaption{color:var(--ink);font-weight:600}
.picture img{display:block;width:100%;height:auto;background:var(--card);border-radius:4px}
svg{display:block;width:100%;height:auto}
svg text{font-size:11px;fill:var(--soft)}svg .label{fill:var(--ink)}
svg .grid{stroke:var(--rule);stroke-width:1}
.line{fill:none;stroke-width:2}.dot{stroke:none}.area{fill:var(--c2);opacity:.75}
.line.c0{stroke:var(--c0)}.line.c1{stroke:var(--c1)}.line.c2{stroke:var(--c2)}
.dot.c0{fill:var(--c0)}.dot.c1{fill:var(--c1)}.dot.c2{fill:var(--c2)}
.legend{font-size:.8rem;color:var(--soft)}.key{margin-right:1em;white-space:nowrap}
.key i{display:inline-block;width:14px;height:4px;border-radius:2px;margin-right:.4em;
vertical-align:middle}
i.c0{background:var(--c0)}i.c1{background:var(--c1)}i.c2{background:var(--c2)}
.scroll{overflow-x:auto;margin-bottom:1em}
.scroll:focus-visible{outline:3px solid #b35900}
table{border-collapse:collapse;font-size:.88rem;font-variant-numeric:tabular-nums;min-width:100%}
th,td{padding:4px 9px;text-align:right;white-space:nowrap;border-bottom:1px solid var(--rule)}
th:first-child,td:first-child{text-align:left}th{color:var(--soft);font-weight:600}
.made table{min-width:0}.made td{text-align:left}.made th{text-align:left}
@media (max-width:480px){table{font-size:.8rem}th,td{padding:4px 6px}}
@media print{body{font-size:11px}}
""".replace("\n", "")
