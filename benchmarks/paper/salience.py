"""Fig. 8: what 8 steps keep of ridges, with the cost and without it; and how noise changes it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import rasterio

from wavelet_core import Pyramid, TriangleMesh, analyse
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.mesh.curvature import squared_curvature_sums
from wavelet_core.mesh.location import surface_errors

from .rmse import shade

STEPS = 8
VARIANTS = {
    "quadric and bending": {"partition": "quadric"},
    "quadric alone": {"partition": "quadric", "bending_weight": 0.0},
    "colouring": {"partition": "colouring"},
    "random order": {"partition": "random"},
}
SHARPEST = 0.05


def terrain(data: Path, size: int) -> TriangleMesh:
    """Return a window of the 1 m LiDAR DEM with ``size`` cells a side."""
    with rasterio.open(data / "dems" / "TM1_564_146_1m.tif") as file:
        z = file.read(1)[:size, :size].astype(float)
    return TriangleMesh.from_grid(z, x=np.arange(float(size)), y=-np.arange(float(size)))


def curvature(mesh: TriangleMesh) -> np.ndarray:
    """Return the root of the squared principal curvatures at every vertex."""
    faces = mesh.faces.astype(np.int32)
    points = mesh.vertices - mesh.vertices.mean(axis=0)
    sums = squared_curvature_sums(points, faces, build_connectivity(faces, mesh.n_vertices))
    return np.sqrt(np.clip(sums, 0, np.quantile(sums, 0.999)))


def run(data: Path, pictures: Path, size: int = 900) -> dict[str, Any]:
    """Return sizes and errors after 8 steps, and draw the surfaces."""
    mesh = terrain(data, size)
    weight = curvature(mesh)
    sharp = weight >= np.quantile(weight, 1 - SHARPEST)
    figures: dict[str, Any] = {"n_vertices": mesh.n_vertices, "n_faces": mesh.n_faces}
    coarse = {}
    for design in ("GLMN", "UGMN"):
        for name, options in VARIANTS.items():
            pyramid = analyse(mesh, levels=STEPS, prediction=design, **options)
            level = pyramid.mesh(0)
            error = surface_errors(level, mesh.vertices)
            figures[f"{design}, {name}"] = {
                "n_vertices": level.n_vertices,
                "n_faces": level.n_faces,
                "rmse_surface": rms(error),
                "rmse_by_curvature": float(np.sqrt(np.average(error**2, weights=weight))),
                "rmse_sharpest": rms(error[sharp]),
                "sharpest_kept": float(sharp[pyramid.vertex_ids(0)].mean()),
            }
            if design == "GLMN":
                coarse[name] = level
            print(f"  {design} {name}: {figures[f'{design}, {name}']}", flush=True)
    draw(mesh, coarse, pictures / "salience.png")
    return figures


def draw(mesh: TriangleMesh, coarse: dict[str, TriangleMesh], path: Path) -> None:
    """Draw the same window of the input and of two coarse surfaces."""
    import matplotlib.pyplot as plt

    shown = {"input": mesh} | {k: coarse[k] for k in ("quadric and bending", "colouring")}
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.6), constrained_layout=True)
    for axis, (name, one) in zip(axes, shown.items(), strict=True):
        inside = (np.abs(one.vertices[:, :2] - [300, -300]) <= 150).all(axis=1)
        shade(axis, one.vertices, one.faces[inside[one.faces].all(axis=1)])
        axis.set_title(f"{name}\n{one.n_faces:,} triangles", fontsize=9)
    figure.savefig(path, dpi=70, bbox_inches="tight")
    plt.close(figure)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.nanmean(values**2)))


def removal_level(pyramid: Pyramid) -> np.ndarray:
    """Return for every input vertex the number of steps that it survived."""
    survived = np.zeros(pyramid.n_vertices(pyramid.n_levels))
    for level in range(pyramid.n_levels):
        survived[pyramid.vertex_ids(level)] += 1
    return survived


def run_noise(data: Path, size: int = 400) -> list[dict[str, Any]]:
    """Return how noise in z changes which vertices stay, and the error to the clean surface."""
    mesh = terrain(data, size)
    rng = np.random.default_rng(0)
    sharp = curvature(mesh)
    sharp = sharp >= np.quantile(sharp, 1 - SHARPEST)
    relief = float(np.ptp(mesh.vertices[:, 2]))
    rows = []
    clean = {
        name: removal_level(analyse(mesh, levels=STEPS, prediction="GLMN", **options))
        for name, options in VARIANTS.items()
    }
    for share in (0.0, 0.0003, 0.001, 0.003, 0.01):
        noise = rng.normal(0, share * relief, mesh.n_vertices)
        z = mesh.vertices[:, 2] + noise
        noisy = TriangleMesh(np.column_stack([mesh.vertices[:, :2], z]), mesh.faces)
        for name, options in VARIANTS.items():
            pyramid = analyse(noisy, levels=STEPS, prediction="GLMN", **options)
            survived = removal_level(pyramid)
            kept, kept_clean = survived == STEPS, clean[name] == STEPS
            rows.append(
                {
                    "noise": share * relief,
                    "partition": name,
                    "same_vertices": float((kept & kept_clean).sum() / (kept | kept_clean).sum()),
                    "sharpest_kept": float(sharp[kept].mean()),
                    "rmse_to_clean": rms(surface_errors(pyramid.mesh(0), mesh.vertices)),
                }
            )
            print(f"  {rows[-1]}", flush=True)
    return rows
