"""Figs. 5-7: errors over 12 levels of all designs, and the surface at levels 12 and 24."""

from __future__ import annotations

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


def run(sample: Sample, pictures: Path) -> dict[str, Any]:
    """Return errors of every level of every design, from the input down, and draw them."""
    designs = {}
    for design in DESIGNS:
        begin = perf_counter()
        pyramid = analyse(
            sample.mesh, levels=LEVELS, partition="quadric", prediction=design, signal="xyz"
        )
        rows = pyramid.errors()[::-1]
        designs[design] = {
            "n_vertices": [row.n_vertices for row in rows],
            "rmse_coefficients": [row.rmse_coefficients for row in rows],
            "rmse_surface": [row.rmse_surface for row in rows],
            "share_removed": share_removed(pyramid),
            "flipped": flipped(pyramid),
        }
        seconds = perf_counter() - begin
        last = rows[-1]
        print(
            f"  {sample.name} {design}: {last.rmse_coefficients:.4f}, "
            f"{last.rmse_surface:.3f}, {seconds:.0f} s",
            flush=True,
        )
    in_plan = analyse(
        sample.mesh, levels=LEVELS, partition="quadric", prediction="GLMN", signal="z"
    )
    fixed = in_plan.errors()[::-1]
    draw_errors(sample, designs, pictures / f"rmse-{sample.name}.png")
    draw_levels(sample, pictures / f"levels-{sample.name}.png")
    return {
        "figure": sample.figure,
        "note": sample.note,
        "n_vertices": sample.mesh.n_vertices,
        "designs": designs,
        "GLMN_z": {
            "n_vertices": [row.n_vertices for row in fixed],
            "rmse_surface": [row.rmse_surface for row in fixed],
        },
    }


def share_removed(pyramid: Pyramid) -> float:
    """Return the mean share of the vertices that a level removes."""
    counts = [pyramid.n_vertices(level) for level in range(pyramid.n_levels + 1)]
    return float(np.mean([1 - a / b for a, b in pairwise(counts)]))


def flipped(pyramid: Pyramid) -> float:
    """Return the share of the coarsest level's faces that are flipped in plan."""
    areas = pyramid.mesh(0).plan_areas
    return float(np.mean(areas <= 0)) if len(areas) else 0.0


def draw_errors(sample: Sample, designs: dict[str, Any], path: Path) -> None:
    """Draw rmse_coefficients (above) and rmse_surface (below), a column for each update."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 3, figsize=(10, 5.2), constrained_layout=True, sharex=True)
    for column, update in enumerate(UPDATES):
        for prediction in PREDICTIONS:
            rows = designs[prediction + update]
            for axis, name in zip(
                axes[:, column], ("rmse_coefficients", "rmse_surface"), strict=True
            ):
                axis.semilogy(range(1, len(rows[name])), rows[name][1:], label=prediction)
        axes[0, column].set_title(update)
        axes[1, column].set_xlabel("analysis steps")
    axes[0, 0].set_ylabel("rmse_coefficients (Eq. 54)")
    axes[1, 0].set_ylabel("rmse_surface, unit of z")
    axes[0, 2].legend()
    for row in axes:
        low = min(axis.get_ylim()[0] for axis in row)
        high = min(max(axis.get_ylim()[1] for axis in row), 1e3 * low)
        for axis in row:
            axis.set_ylim(low, high)
    figure.savefig(path, dpi=70, bbox_inches="tight")
    plt.close(figure)


def draw_levels(sample: Sample, path: Path) -> None:
    """Draw the input and the surfaces after 12 and 24 steps of UGMN, coloured by z."""
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


def shade(axis: Any, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Draw a hillshade of a TIN, rasterised face by face."""
    if len(faces) > MAX_DRAWN_FACES:  # a window that shows as many
        share = np.sqrt(MAX_DRAWN_FACES / len(faces))
        low, extent = vertices[:, :2].min(axis=0), np.ptp(vertices[:, :2], axis=0)
        inside = (vertices[:, :2] <= low + share * extent).all(axis=1)
        faces = faces[inside[faces].all(axis=1)]
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    light = normal @ (np.array([-1.0, 1.0, 1.4]) / np.linalg.norm([1.0, 1.0, 1.4]))
    axis.tripcolor(
        vertices[:, 0],
        vertices[:, 1],
        faces,
        facecolors=np.clip(light, 0, 1),
        cmap="gray",
        vmin=0,
        vmax=1,
    )
    drawn = vertices[np.unique(faces)]
    axis.set(
        xlim=(drawn[:, 0].min(), drawn[:, 0].max()), ylim=(drawn[:, 1].min(), drawn[:, 1].max())
    )
    axis.set_aspect("equal")
    axis.set_axis_off()
