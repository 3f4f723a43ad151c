"""Figs. 5-7: errors over 12 levels of all designs, and the surface at levels 12 and 24."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise, product
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from wavelet_core import Pyramid, analyse

from .clouds import Sample

PREDICTIONS = ("UG", "CL", "GL", "NNLS")
UPDATES = ("MO", "ORMP", "MN")
DESIGNS = tuple(p + u for u, p in product(UPDATES, PREDICTIONS))
LEVELS = 12
#: A face of the input is this share of the extent, so shades are told by the surface alone.
MAX_DRAWN_FACES = 300_000


def run(sample: Sample, one: dict[str, Any], keep: Callable[[], None]) -> None:
    """Find the errors of every level of every design, from the input down.

    Parameters
    ----------
    sample : Sample
    one : dict
        What is known of this cloud, filled in place. Designs that it has are not run again, unless
        they are of another number of points.
    keep : callable
        Called after each design, which takes minutes on a large cloud.
    """
    known = {"figure": sample.figure, "note": sample.note, "n_vertices": sample.mesh.n_vertices}
    if any(one.get(name) != value for name, value in known.items()):
        one.clear()
    one.update(known)
    designs = one.setdefault("designs", {})
    for design in DESIGNS:
        if design not in designs:
            designs[design] = errors_of(sample, design, "xyz")
            keep()
    if "GLMN_z" not in one:
        one["GLMN_z"] = errors_of(sample, "GLMN", "z")
        keep()


def errors_of(sample: Sample, design: str, signal: str, **reading: Any) -> dict[str, Any]:
    """Return the errors of every level of one design, from the input down."""
    begin = perf_counter()
    pyramid = analyse(
        sample.mesh,
        levels=LEVELS,
        partition="quadric",
        prediction=design,
        signal=signal,
        **reading,
    )
    rows = pyramid.errors()[::-1]
    seconds = perf_counter() - begin
    last = rows[-1]
    print(
        f"  {sample.name} {design} {signal}: {last.rmse_coefficients:.4f}, "
        f"{last.rmse_surface:.3f}, {last.n_uncovered:,} not covered, {seconds:.0f} s",
        flush=True,
    )
    return {
        "n_vertices": [row.n_vertices for row in rows],
        "rmse_coefficients": [row.rmse_coefficients for row in rows],
        "rmse_surface": [row.rmse_surface for row in rows],
        "n_uncovered": [row.n_uncovered for row in rows],
        "share_removed": share_removed(pyramid),
        "flipped": flipped(pyramid),
    }


def share_removed(pyramid: Pyramid) -> float:
    """Return the mean share of the vertices that a level removes."""
    counts = [pyramid.n_vertices(level) for level in range(pyramid.n_levels + 1)]
    return float(np.mean([1 - a / b for a, b in pairwise(counts)]))


def flipped(pyramid: Pyramid) -> float:
    """Return the share of the coarsest level's faces that are flipped in plan."""
    areas = pyramid.mesh(0).plan_areas
    return float(np.mean(areas <= 0)) if len(areas) else 0.0


def draw_errors(
    name: str, one: dict[str, Any], readings: dict[str, dict[str, Any]], pictures: Path
) -> None:
    """Draw rmse_coefficients (above) and rmse_surface (below), a column for each update.

    Parameters
    ----------
    name : str
        The cloud's.
    one : dict
        What `run` found of it.
    readings : dict
        What other readings of the partition gave on the same points, drawn as thin lines.
    pictures : Path
        Folder.
    """
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 3, figsize=(10, 5.2), constrained_layout=True, sharex=True)
    for column, update in enumerate(UPDATES):
        for prediction, colour in zip(PREDICTIONS, ("C0", "C1", "C2", "C3"), strict=True):
            design = prediction + update
            others = [r[design] for r in readings.values() if design in r]
            for rows, how in [
                *((rows, {"linewidth": 0.5, "alpha": 0.6}) for rows in others),
                (one["designs"][design], {"label": prediction}),
            ]:
                for axis, kind in zip(
                    axes[:, column], ("rmse_coefficients", "rmse_surface"), strict=True
                ):
                    axis.semilogy(range(1, len(rows[kind])), rows[kind][1:], color=colour, **how)
        axes[0, column].set_title(update)
        axes[1, column].set_xlabel("analysis steps")
        axes[1, column].set_xticks(range(0, LEVELS + 1, 4))
    axes[0, 0].set_ylabel("rmse_coefficients (Eq. 54)")
    axes[1, 0].set_ylabel("rmse_surface, unit of z")
    axes[0, 0].legend(loc="lower right")
    for row in axes:
        low = min(axis.get_ylim()[0] for axis in row)
        high = min(max(axis.get_ylim()[1] for axis in row), 1e3 * low)
        for axis in row:
            axis.set_ylim(low, high)
    figure.savefig(pictures / f"rmse-{name}.png", dpi=70, bbox_inches="tight")
    plt.close(figure)


def draw_levels(sample: Sample, path: Path) -> None:
    """Draw the input and the surfaces after 12 and 24 steps of UGMN, as hillshades."""
    import matplotlib.pyplot as plt

    pyramid = analyse(sample.mesh, levels=24, partition="quadric", prediction="UGMN", signal="z")
    wanted = {pyramid.n_levels, max(pyramid.n_levels - 12, 0), 0}
    meshes = {level: mesh for level, mesh in enumerate(pyramid) if level in wanted}
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.6), constrained_layout=True)
    for axis, level in zip(axes, sorted(wanted, reverse=True), strict=True):
        mesh = meshes[level]
        shade(axis, mesh.vertices, mesh.faces)
        axis.set_title(f"{pyramid.n_levels - level} steps, {mesh.n_vertices:,} vertices")
    figure.savefig(path, dpi=70, bbox_inches="tight")
    plt.close(figure)


def shade(axis: Any, vertices: np.ndarray, faces: np.ndarray, *, by_height: bool = False) -> None:
    """Draw a TIN face by face, as a hillshade, or by height where all is as rough as trees."""
    if len(faces) > MAX_DRAWN_FACES:  # a window that shows as many
        share = np.sqrt(MAX_DRAWN_FACES / len(faces))
        low, extent = vertices[:, :2].min(axis=0), np.ptp(vertices[:, :2], axis=0)
        inside = (vertices[:, :2] <= low + share * extent).all(axis=1)
        faces = faces[inside[faces].all(axis=1)]
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    light = normal @ (np.array([-1.0, 1.0, 1.4]) / np.linalg.norm([1.0, 1.0, 1.4]))
    height = vertices[faces, 2].mean(axis=1)
    low, high = np.quantile(height, [0.02, 0.98]) if by_height else (0.0, 1.0)
    axis.tripcolor(
        vertices[:, 0],
        vertices[:, 1],
        faces,
        facecolors=height if by_height else np.clip(light, 0, 1),
        cmap="gist_earth" if by_height else "gray",
        vmin=low,
        vmax=high,
    )
    drawn = vertices[np.unique(faces)]
    axis.set(
        xlim=(drawn[:, 0].min(), drawn[:, 0].max()), ylim=(drawn[:, 1].min(), drawn[:, 1].max())
    )
    axis.set_aspect("equal")
    axis.set_axis_off()
