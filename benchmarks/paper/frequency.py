"""Figs. 9-10: five steps, and whether strong details sit where the terrain is abrupt."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import rasterio
from scipy.stats import spearmanr

from wavelet_core import TriangleMesh, analyse
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_gis.workflows.open import open_terrain

from .rmse import shade

STEPS = 5


def samples(data: Path) -> dict[str, TriangleMesh]:
    """Return the volcanic cloud and a mountain window of SRTM with about as many vertices."""
    with rasterio.open(data / "dems" / "srtm1_N48W125_utm10_30m.tif") as file:
        whole = file.read(1).astype(float)
    valid = whole > 0
    window = max(  # the window with the most relief, all of it land
        (np.ptp(whole[r : r + 281, c : c + 281]), r, c)
        for r in range(0, whole.shape[0] - 281, 140)
        for c in range(0, whole.shape[1] - 281, 140)
        if valid[r : r + 281, c : c + 281].all()
    )
    z = whole[window[1] : window[1] + 281, window[2] : window[2] + 281]
    axis = 30.0 * np.arange(281)
    return {
        "reunion_volcanic_60k": open_terrain(
            data / "clouds" / "reunion_volcanic_60k.laz", carry=False
        ).mesh,
        "srtm1_N48W125_utm10_30m": TriangleMesh.from_grid(z, x=axis, y=axis[::-1]),
    }


def local_relief(mesh: TriangleMesh) -> np.ndarray:
    """Return the spread of z over the one-ring of every vertex."""
    faces = mesh.faces.astype(np.int32)
    connectivity = build_connectivity(faces, mesh.n_vertices)
    z = mesh.vertices[:, 2]
    low, high = z.copy(), z.copy()
    for k in range(3):
        np.minimum.at(low, faces[:, k], z[faces].min(axis=1))
        np.maximum.at(high, faces[:, k], z[faces].max(axis=1))
    assert len(connectivity.kind) == len(z)
    return high - low


def run(data: Path, pictures: Path) -> dict[str, Any]:
    """Return counts and detail strengths of every step, and draw meshes and details."""
    figures: dict[str, Any] = {}
    for name, mesh in samples(data).items():
        pyramid = analyse(mesh, levels=STEPS, partition="quadric", prediction="GLMN")
        relief = local_relief(mesh)
        rows = []
        for level in range(pyramid.n_levels - 1, -1, -1):
            detail = pyramid.detail(level)
            rows.append(
                {
                    "step": pyramid.n_levels - level,
                    "n_left": pyramid.n_vertices(level),
                    "n_details": len(detail.magnitude),
                    "median": float(np.median(detail.magnitude)),
                    "p99": float(np.quantile(detail.magnitude, 0.99)),
                    "with_relief": float(
                        spearmanr(detail.magnitude, relief[detail.vertex_ids]).statistic
                    ),
                }
            )
        figures[name] = {"n_vertices": mesh.n_vertices, "steps": rows}
        print(f"  {name}: {figures[name]}", flush=True)
        draw(mesh, pyramid, pictures / f"frequency-{name.split('_')[0]}.png")
    return figures


def draw(mesh: TriangleMesh, pyramid: Any, path: Path) -> None:
    """Draw the input, the third and the fifth step, and the strongest details of all steps."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 4, figsize=(12, 3.3), constrained_layout=True)
    top = pyramid.n_levels
    is_grid = np.prod([len(np.unique(mesh.vertices[:, k])) for k in (0, 1)]) == mesh.n_vertices
    for axis, level in zip(axes, (top, max(top - 3, 0), 0), strict=False):
        one = pyramid.mesh(level)
        shade(axis, one.vertices, one.faces, by_height=not is_grid)
        axis.set_title(f"{top - level} steps, {one.n_vertices:,} vertices", fontsize=9)
    for level in range(pyramid.n_levels):
        detail = pyramid.detail(level)
        strong = detail.magnitude >= np.quantile(detail.magnitude, 0.9)
        x, y = detail.positions[strong, :2].T
        size = 30 * (detail.magnitude[strong] / detail.magnitude[strong].max()) ** 1.5
        axes[3].scatter(
            x, y, size, c=np.full(len(x), level), vmin=0, vmax=top - 1, cmap="viridis", lw=0
        )
    axes[3].set_aspect("equal")
    axes[3].set_axis_off()
    axes[3].set_title("strongest tenth of the details", fontsize=9)
    figure.savefig(path, dpi=70, bbox_inches="tight")
    plt.close(figure)
