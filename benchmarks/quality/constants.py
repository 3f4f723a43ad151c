"""What the constants of partition, refinement and denoising are worth, with others beside them.

    python benchmarks/quality/constants.py DEM... [--cells 300] [--only NAME...]

Of each DEM the middle is taken. For each value of a constant: the mean, over the DEMs, of the
figure that the constant is there for and of the processor's time, over those of the value in use.
The figure is an error, or a number of vertices at a tolerance, so lower is better. The tables in
docs/topics/surface.md and docs/topics/filtering.md are made by this.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
import rasterio

from wavelet_core import Pyramid, TriangleMesh, analyse, denoise, refine
from wavelet_core._arrays import refine_flip, refine_move, refine_replace, surface_cost
from wavelet_core._kernels._jit import engine
from wavelet_core.features.shape import surface_shape
from wavelet_core.filtering.noise import by_place, outliers
from wavelet_core.metrics import surface_errors
from wavelet_core.partition import _mutable_level, error_guided

Measure = Callable[[TriangleMesh], float]


class Trial(NamedTuple):
    """A constant, the values that are tried, and what for.

    The engine of whole arrays reads constants when it runs; compiled kernels have them built in.
    """

    module: Any
    name: str
    values: tuple[float, ...]
    what: str
    measure: Measure
    engine: str = "compiled"


def error_at(mesh: TriangleMesh, pyramid: Pyramid, norm: str) -> float:
    """Return the error of the coarsest level at all input points."""
    errors = np.abs(surface_errors(pyramid[0], mesh.vertices))
    return float(np.nanmax(errors) if norm == "max" else np.sqrt(np.nanmean(errors**2)))


def to_size(share: float, norm: str = "rms") -> Measure:
    """Return the error of so large a share of the vertices."""

    def measure(mesh: TriangleMesh) -> float:
        size = int(share * mesh.n_vertices)
        return error_at(mesh, analyse(mesh, target_vertices=size, norm=norm), norm)

    return measure


def of_levels(mesh: TriangleMesh) -> float:
    """Return RMSE times share of the vertices after 12 levels.

    The RMSE of a good TIN is about inverse to the number of its vertices, so this weighs levels of
    unlike sizes against each other.
    """
    pyramid = analyse(mesh, levels=12)
    return error_at(mesh, pyramid, "rms") * pyramid[0].n_vertices / mesh.n_vertices


def to_tolerance(share_of_relief: float, **options: Any) -> Measure:
    """Return the vertices that a tolerance takes, given as a part of the standard deviation."""

    def measure(mesh: TriangleMesh) -> float:
        tolerance = share_of_relief * float(mesh.vertices[:, 2].std())
        return float(analyse(mesh, max_error=tolerance, **options)[0].n_vertices)

    return measure


def refined_to(share: float) -> Measure:
    """Return the RMSE of so large a share of the vertices after three rounds of refinement."""

    def measure(mesh: TriangleMesh) -> float:
        pyramid = analyse(mesh, target_vertices=int(share * mesh.n_vertices))
        coarse = refine(pyramid[0], mesh, vertex_ids=pyramid.vertex_ids(0), rounds=3)
        return coarse.rounds[-1].rmse

    return measure


def noise_of_mesh(mesh: TriangleMesh, share_of_relief: float = 0.02) -> tuple[Any, float]:
    """Return normal noise, and its deviation: a part of that of the heights."""
    sigma = share_of_relief * float(mesh.vertices[:, 2].std())
    return np.random.default_rng(1).normal(0, sigma, mesh.n_vertices), sigma


def of_outliers(mesh: TriangleMesh) -> float:
    """Return outliers missed, and other values taken for some, for each of those put in.

    One vertex in 200 is off by 8 to 30 standard deviations of the noise that all have.
    """
    rng = np.random.default_rng(2)
    noise, sigma = noise_of_mesh(mesh)
    n_out = mesh.n_vertices // 200
    put_in = rng.choice(mesh.n_vertices, n_out, replace=False)
    off = rng.uniform(8, 30, n_out) * rng.choice([-1, 1], n_out) * sigma
    values = mesh.vertices[:, 2] + noise
    values[put_in] += off
    found, _ = outliers.without_outliers(mesh, values, sigma)
    return len(np.setxor1d(found, put_in)) / n_out


def of_noise_by_place(mesh: TriangleMesh) -> float:
    """Return the RMSE after denoising where the noise grows with the slope, sixfold."""
    noise, _ = noise_of_mesh(mesh)
    slope = surface_shape(mesh).slope
    strength = 0.5 + 2.5 * np.clip(slope / np.percentile(slope, 95), 0, 1)
    vertices = mesh.vertices.copy()
    vertices[:, 2] += noise * strength
    noisy = TriangleMesh(vertices, mesh.faces)
    clean = denoise(noisy, local_noise=True, n_pyramids=2)
    return float(np.sqrt(np.mean((clean.vertices[:, 2] - mesh.vertices[:, 2]) ** 2)))


TRIALS = (
    Trial(_mutable_level, "CHEAPEST_PART", (2, 4, 8, 16, 32, 64), "RMSE at 2 %", to_size(0.02)),
    Trial(error_guided, "COST_MARGIN", (1.1, 1.5, 2.0, 4.0), "RMSE at 2 %", to_size(0.02)),
    Trial(
        error_guided, "FULL_SHARE_COST_MARGIN", (1.5, 2.0, 4.0, 8.0),
        "RMSE x size after 12 levels", of_levels,
    ),
    Trial(
        error_guided, "N_ATTEMPTS", (1, 2, 4, 6, 8), "vertices at a tolerance, with update",
        to_tolerance(0.05, norm="max", update="minimum_norm"),
    ),
    Trial(
        surface_cost, "TIE_SHARE", (0.0, 1e-5, 1e-3, 1e-1), "largest error at 5 %",
        to_size(0.05, "max"), "arrays",
    ),
    Trial(
        refine_replace, "N_INSERTIONS", (1, 2, 4, 8), "RMSE at 5 %, refined",
        refined_to(0.05), "arrays",
    ),
    Trial(
        refine_flip, "LEAST_GAIN", (0.0, 1e-6, 1e-3, 1e-2), "RMSE at 5 %, refined",
        refined_to(0.05), "arrays",
    ),
    Trial(
        refine_move, "LEAST_GAIN", (0.0, 1e-4, 1e-3, 1e-2), "RMSE at 5 %, refined",
        refined_to(0.05), "arrays",
    ),
    Trial(
        outliers, "OUTLIER_DEVIATIONS", (3.0, 4.0, 5.0, 6.0, 8.0), "wrong for each outlier",
        of_outliers,
    ),
    Trial(
        outliers, "OUTLIER_RELIEF", (0.25, 0.5, 1.0, 2.0), "wrong for each outlier", of_outliers,
    ),
    Trial(
        by_place, "VERTICES_OF_BLOCK", (9, 16, 25, 49, 100), "RMSE after denoising",
        of_noise_by_place,
    ),
    Trial(
        by_place, "BLUR_OF_BLOCKS", (0.25, 0.5, 1.0, 2.0), "RMSE after denoising",
        of_noise_by_place,
    ),
)  # fmt: skip


def middle_of(path: str, n_cells: int) -> TriangleMesh:
    """Return the TIN of the middle of a raster, in cells as the unit of x and y."""
    with rasterio.open(path) as dataset:
        elevation = dataset.read(1, masked=True).astype(float).filled(np.nan)
    row, column = (max((n - n_cells) // 2, 0) for n in elevation.shape)
    elevation = elevation[row : row + n_cells, column : column + n_cells]
    n_rows, n_columns = elevation.shape
    return TriangleMesh.from_grid(elevation, x=np.arange(n_columns), y=np.arange(n_rows)[::-1])


@contextmanager
def with_value(trial: Trial, value: float):
    """Give a constant another value for a while."""
    before = getattr(trial.module, trial.name)
    setattr(trial.module, trial.name, value)
    try:
        yield
    finally:
        setattr(trial.module, trial.name, before)


def measured(trial: Trial, mesh: TriangleMesh, value: float) -> tuple[float, float]:
    """Return the figure and the seconds of one value on one DEM."""
    with with_value(trial, value), engine(trial.engine):
        start = time.process_time()
        figure = trial.measure(mesh)
        return figure, time.process_time() - start


def main() -> None:
    """Print a table a constant."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dems", nargs="+")
    parser.add_argument("--cells", type=int, default=300, help="width of the middle")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="of the constants")
    arguments = parser.parse_args()
    meshes = [middle_of(path, arguments.cells) for path in arguments.dems]
    for trial in TRIALS:
        if arguments.only and trial.name not in arguments.only:
            continue
        in_use = getattr(trial.module, trial.name)
        measured(trial, meshes[0], in_use)  # compiles
        found = {
            value: np.array([measured(trial, mesh, value) for mesh in meshes])
            for value in trial.values
        }
        name = f"{trial.module.__name__.rpartition('.')[2]}.{trial.name}"
        print(f"\n| `{name}` | {trial.what} | worst DEM | time |\n|---|---|---|---|")
        for value, figures in found.items():
            ratio = figures / found[in_use]
            mark = " (in use)" if value == in_use else ""
            print(
                f"| {value:g}{mark} | {ratio[:, 0].mean():.4f} | {ratio[:, 0].max():.4f} | "
                f"{ratio[:, 1].mean():.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
