"""The paper's partition read in other ways: which reading gives which of its claims."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from wavelet_core import analyse

from .clouds import Sample
from .rmse import LEVELS, errors_of
from .salience import SHARPEST, STEPS, curvature, terrain

#: By name: what becomes of the quadrics, what ranks, and the weight of bending energy.
READINGS: dict[str, dict[str, Any]] = {
    "as printed": {},
    "bending at 0.01": {"bending_weight": 0.01},
    "quadrics rebuilt": {"quadrics": "rebuilt"},
    "rebuilt, bending at 0.01": {"quadrics": "rebuilt", "bending_weight": 0.01},
    "cost of the collapse": {"cost": "collapse", "bending_weight": 0.0},
    "cost of the collapse, rebuilt": {
        "cost": "collapse",
        "quadrics": "rebuilt",
        "bending_weight": 0.0,
    },
}
DESIGNS = ("UGMN", "CLMN", "GLMN", "NNLSMN", "LSMN", "LSMO")
SHOWN_STEPS = (4, 8, 12)
#: Cells a side of the DEM on which sharp places are counted.
N_CELLS = 500
#: From this ratio on, "almost twofold" is taken to hold.
ALMOST_TWOFOLD = 1.75


def run(
    samples: Iterable[Sample], data: Path, results: dict[str, Any], keep: Callable[[], None]
) -> None:
    """Find the errors of the designs under every reading, and what sharp places are kept.

    Parameters
    ----------
    samples : iterable of Sample
    data : Path
        Folder of the real data.
    results : dict
        What is known, filled in place; what it has is not run again.
    keep : callable
        Called after each design.
    """
    if "sharp" not in results:
        results["sharp"] = sharp_places(data)
        keep()
    for sample in samples:
        cloud = results.setdefault("clouds", {}).setdefault(sample.name, {})
        if cloud.get("n_vertices") != sample.mesh.n_vertices:
            cloud.clear()
            cloud.update(n_vertices=sample.mesh.n_vertices, note=sample.note)
        for reading, options in READINGS.items():
            designs = cloud.setdefault("readings", {}).setdefault(reading, {})
            for design in DESIGNS:
                if design not in designs:
                    print(f"  {reading}:", end="", flush=True)
                    designs[design] = errors_of(sample, design, "xyz", **options)
                    keep()


def are_whole(results: dict[str, Any]) -> bool:
    """Return whether every design has been run under every reading, and sharp places counted."""
    clouds = results.get("clouds", {}).values()
    rows = [cloud.get("readings", {}).get(name, {}) for cloud in clouds for name in READINGS]
    return bool(rows) and "sharp" in results and all(set(DESIGNS) <= set(row) for row in rows)


def sharp_places(data: Path) -> dict[str, float]:
    """Return how many of the vertices left after 8 steps are sharp, over what chance gives."""
    mesh = terrain(data, N_CELLS)
    weight = curvature(mesh)
    is_sharp = weight >= np.quantile(weight, 1 - SHARPEST)
    kept = {}
    for name, options in {**READINGS, "colouring": None}.items():
        how = {"partition": "colouring"} if options is None else {"partition": "quadric", **options}
        pyramid = analyse(mesh, levels=STEPS, prediction="GLMN", **how)
        kept[name] = float(is_sharp[pyramid.vertex_ids(0)].mean() / is_sharp.mean())
        print(f"  sharp places, {name}: {kept[name]:.3f}", flush=True)
    return kept


def error_table(results: dict[str, Any]) -> list[str]:
    """Return RMSE of the coefficients after 12 steps, by cloud and reading."""
    lines = []
    for name, cloud in results["clouds"].items():
        lines += [
            f"{name}, {cloud['n_vertices']:,} vertices; rmse_coefficients / rmse_surface after "
            "12 steps:",
            "",
            f"| reading | {' | '.join(DESIGNS)} | removed a step |",
            "|---" * (len(DESIGNS) + 2) + "|",
        ]
        for reading, designs in cloud["readings"].items():
            cells = [
                f"{d['rmse_coefficients'][-1]:.3g} / {d['rmse_surface'][-1]:.3g}"
                for d in designs.values()
            ]
            share = designs["GLMN"]["share_removed"]
            lines.append(f"| {reading} | {' | '.join(cells)} | {share:.1%} |")
        lines.append("")
    return lines[:-1]


def claim_table(results: dict[str, Any]) -> list[str]:
    """Return each claim under each reading: the figure on every cloud, and whether it holds."""
    clouds = results["clouds"]
    head = ["claim", *READINGS]
    lines = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    for claim, figures_of, holds in CLAIMS:
        cells = []
        for reading in READINGS:
            figures = [figures_of(cloud["readings"][reading]) for cloud in clouds.values()]
            text = ", ".join(f"{figure:.2f}" for figure in figures)
            cells.append(f"**{text}**" if all(map(holds, figures)) else text)
        lines.append(f"| {claim} | {' | '.join(cells)} |")
    sharp = results["sharp"]
    cells = [
        f"**{sharp[r]:.2f}**" if sharp[r] > max(1.0, sharp["colouring"]) else f"{sharp[r]:.2f}"
        for r in READINGS
    ]
    claim = (
        f"sharp places are kept: more than by chance, and than {sharp['colouring']:.2f}, colouring"
    )
    return [*lines, f"| {claim} | {' | '.join(cells)} |"]


def ratio(worse: str, better: str, step: int = LEVELS):
    """Return a function from a reading's designs to how much more error one has."""

    def figure(designs: dict[str, Any]) -> float:
        errors = [designs[name]["rmse_coefficients"][step] for name in (worse, better)]
        return errors[0] / errors[1]

    return figure


#: What is said, its figure from the designs of a reading, and when it holds.
CLAIMS = (
    *(
        (
            f"GLMN almost twice as accurate as UGMN, {k} steps",
            ratio("UGMN", "GLMN", k),
            lambda x: x >= ALMOST_TWOFOLD,
        )
        for k in SHOWN_STEPS
    ),
    (
        "NNLSMN almost twice as accurate as UGMN, 12 steps",
        ratio("UGMN", "NNLSMN"),
        lambda x: x >= ALMOST_TWOFOLD,
    ),
    ("CLMN no better than UGMN, 12 steps (UGMN / CLMN)", ratio("UGMN", "CLMN"), lambda x: x <= 1.0),
    ("LS has the lowest error with MN (NNLSMN / LSMN)", ratio("NNLSMN", "LSMN"), lambda x: x > 1.0),
    ("LS is unstable with MO (LSMO / LSMN)", ratio("LSMO", "LSMN"), lambda x: x > 2.0),
    (
        "a step removes 25 % at least",
        lambda designs: designs["GLMN"]["share_removed"],
        lambda x: x >= 0.25,
    ),
)
