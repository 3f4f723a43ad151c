"""The tables of ``docs/science/paper-experiments.md``, set in place between their marks."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from . import readings
from .rmse import PREDICTIONS, UPDATES


def fill(page: Path, results: dict[str, Any]) -> None:
    """Replace what stands between ``<!-- name -->`` and ``<!-- end -->`` by the fresh tables."""
    text = page.read_text("utf-8")
    for name, lines in tables(results).items():
        pattern = rf"(<!-- {re.escape(name)} -->\n).*?(<!-- end -->)"
        text = re.sub(
            pattern, lambda m, lines=lines: m[1] + "\n".join(lines) + "\n" + m[2], text, flags=re.S
        )
    page.write_text(text, "utf-8")


def tables(results: dict[str, Any]) -> dict[str, list[str]]:
    """Return the lines of every table whose experiment has been run."""
    made = {}
    whole = {k: v for k, v in results.get("rmse", {}).items() if "GLMN_z" in v}
    for name, one in whole.items():
        made[f"rmse {name}"] = rmse_table(one)
    if whole:
        made["rates"] = rate_table(whole)
    if "salience" in results:
        made["salience"] = salience_table(results["salience"])
    if "noise" in results:
        made["noise"] = noise_table(results["noise"])
    if "frequency" in results:
        made["frequency"] = frequency_table(results["frequency"])
    if readings.are_whole(results.get("readings", {})):
        made["reading errors"] = readings.error_table(results["readings"])
        made["readings"] = readings.claim_table(results["readings"])
    return made


def markdown(header: list[str], rows: list[list[str]]) -> list[str]:
    return [
        "| " + " | ".join(header) + " |",
        "| " + " | ".join(["---"] + ["---:"] * (len(header) - 1)) + " |",
        *("| " + " | ".join(row) + " |" for row in rows),
    ]


def rmse_table(one: dict[str, Any]) -> list[str]:
    """Errors after 4, 8 and 12 steps, coefficients / surface."""
    steps = (4, 8, 12)
    rows = []
    for update in UPDATES:
        for prediction in PREDICTIONS:
            design = one["designs"][prediction + update]
            cells = [
                f"{number(design['rmse_coefficients'], k)} / {number(design['rmse_surface'], k)}"
                for k in steps
            ]
            rows.append([prediction + update, *cells, *left_over(design)])
    fixed = one["GLMN_z"]
    cells = [f"- / {number(fixed['rmse_surface'], k)}" for k in steps]
    rows.append(["GLMN, z only", *cells, *left_over(fixed)])
    head = ["design", *(f"{k} steps" for k in steps), "flipped at 12", "not covered at 12"]
    return [f"{one['n_vertices']:,} vertices; {one['note']}.", "", *markdown(head, rows)]


def left_over(design: dict[str, Any]) -> tuple[str, str]:
    """Return which share of the faces is flipped, and how many points are not covered."""
    return f"{100 * design['flipped']:.1f} %", f"{design['n_uncovered'][-1]:,}"


def number(values: list[float], step: int) -> str:
    if step >= len(values):
        return "-"
    return f"{values[step]:.3g}" if values[step] < 1e4 else f"{values[step]:.0e}"


def rate_table(results: dict[str, Any]) -> list[str]:
    rows = []
    for name, one in sorted(results.items(), key=lambda item: item[1]["figure"]):
        shares = [100 * design["share_removed"] for design in one["designs"].values()]
        rows.append([name, one["figure"], f"{min(shares):.1f} to {max(shares):.1f} %"])
    return markdown(["cloud", "stands for", "removed a step, least and most of 12 designs"], rows)


def salience_table(one: dict[str, Any]) -> list[str]:
    rows = [
        [
            name,
            f"{v['n_faces']:,}",
            f"{v['rmse_surface']:.3f}",
            f"{v['rmse_by_curvature']:.3f}",
            f"{v['rmse_sharpest']:.3f}",
            f"{100 * v['sharpest_kept']:.1f} %",
        ]
        for name, v in one.items()
        if isinstance(v, dict)
    ]
    head = [
        "design, partition",
        "triangles",
        "rmse_surface, m",
        "weighted by curvature",
        "at the sharpest 5 %",
        "of the vertices left, sharpest",
    ]
    first = f"{one['n_vertices']:,} vertices, {one['n_faces']:,} triangles before."
    return [first, "", *markdown(head, rows)]


def noise_table(rows: list[dict[str, Any]]) -> list[str]:
    head = [
        "partition",
        "noise, m",
        "same vertices left",
        "sharpest among them",
        "rmse_surface to clean, m",
    ]
    cells = [
        [
            row["partition"],
            f"{row['noise']:.3f}",
            f"{100 * row['same_vertices']:.0f} %",
            f"{100 * row['sharpest_kept']:.1f} %",
            f"{row['rmse_to_clean']:.3f}",
        ]
        for row in sorted(rows, key=lambda row: row["partition"])
    ]
    return markdown(head, cells)


def frequency_table(results: dict[str, Any]) -> list[str]:
    rows = [
        [
            name,
            str(step["step"]),
            f"{step['n_left']:,}",
            f"{step['median']:.3f}",
            f"{step['p99']:.2f}",
            f"{step['with_relief']:.2f}",
        ]
        for name, one in results.items()
        for step in one["steps"]
    ]
    head = [
        "terrain",
        "step",
        "vertices left",
        "median detail, m",
        "99th percentile, m",
        "rank correlation with relief",
    ]
    return markdown(head, rows)
