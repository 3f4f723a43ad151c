"""Sizes and errors of the levels that the defaults of ``analyse`` give, as a table.

    python benchmarks/quality/default_levels.py DEM... [--levels N]
        [--max-cells 1500000] [--curve FILE]

For each DEM: its cells with a height, how many of them have relief (some neighbour in the TIN is
higher or lower), and the size and the RMSE at all input cells of six levels, the coarsest first.
``--curve`` also writes the size and RMSE of every level as JSON lines.
"""

import argparse
import json
import time
import warnings
from pathlib import Path

import numpy as np
import rasterio

from wavelet_core import TriangleMesh, analyse
from wavelet_core.metrics import surface_errors

N_SHOWN = 6


def mesh_of(path):
    """Return the TIN of a raster's first band, in cells as the unit of x and y."""
    with rasterio.open(path) as dataset:
        elevation = dataset.read(1, masked=True).astype(float).filled(np.nan)
    n_rows, n_columns = elevation.shape
    return TriangleMesh.from_grid(elevation, x=np.arange(n_columns), y=np.arange(n_rows)[::-1])


def n_with_relief(mesh):
    """Return the number of vertices with a neighbour of another height."""
    z = mesh.vertices[:, 2]
    has_relief = np.zeros(mesh.n_vertices, dtype=bool)
    for i in range(3):
        a, b = mesh.faces[:, i], mesh.faces[:, (i + 1) % 3]
        differs = z[a] != z[b]
        has_relief[a[differs]] = True
        has_relief[b[differs]] = True
    return int(has_relief.sum())


def measured(path, levels):
    """Return the figures of one DEM."""
    mesh = mesh_of(path)
    start = time.perf_counter()
    pyramid = analyse(mesh, levels=levels)
    seconds = time.perf_counter() - start
    curve = []
    for coarse in pyramid:
        errors = surface_errors(coarse, mesh.vertices)
        curve.append((coarse.n_vertices, float(np.sqrt(np.nanmean(errors**2)))))
    return {
        "dem": Path(path).stem,
        "n_vertices": mesh.n_vertices,
        "n_relief": n_with_relief(mesh),
        "n_levels": pyramid.n_levels,
        "seconds": round(seconds, 1),
        "curve": curve,
    }


def row_of(figures):
    """Return the row of the table."""
    shown = np.unique(np.linspace(0, figures["n_levels"], N_SHOWN).round().astype(int))
    cells = [
        f"{level}: {figures['curve'][level][0]:,} / {figures['curve'][level][1]:.3g}"
        for level in shown
    ]
    share = figures["curve"][0][0] / max(figures["n_relief"], 1)
    head = [
        figures["dem"],
        f"{figures['n_vertices']:,}",
        f"{figures['n_relief']:,}",
        f"{100 * share:.2g} %",
    ]
    return "| " + " | ".join(head + cells) + " |"


def main():
    """Measure each DEM and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dems", nargs="+")
    parser.add_argument("--levels", type=int)
    parser.add_argument("--max-cells", type=int, default=1_500_000)
    parser.add_argument("--curve")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    print("| DEM | cells | with relief | coarsest | " + "level: vertices / RMSE | " * N_SHOWN)
    print("|---" * (4 + N_SHOWN) + "|")
    for path in arguments.dems:
        if mesh_of(path).n_vertices > arguments.max_cells:
            continue
        figures = measured(path, arguments.levels)
        print(row_of(figures), flush=True)
        if arguments.curve:
            with open(arguments.curve, "a", encoding="utf-8") as file:
                file.write(json.dumps(figures) + "\n")


if __name__ == "__main__":
    main()
