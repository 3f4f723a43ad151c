"""What each round of refinement gains, and what all of them cost beside the analysis.

usage: python benchmarks/quality/refinement_rounds.py DEM[:ROW,COLUMN,SIZE] ... [--keep 0.1,0.02]

Of each DEM, or a square of it, processor seconds of the analysis and of the refinement, and the
RMSE at all nodes as analysed and after each round, as a share of that of the coarsest level with
fitted heights; where a round has more vertices than the end, by how many times is said. Degrees
are taken as metres by their length in the middle of the DEM. A small input runs first, so that
nothing is compiled in what is timed.
"""

from __future__ import annotations

import argparse
import math
from time import process_time

import numpy as np
import rasterio
from rasterio.windows import Window

from wavelet_core import TriangleMesh, analyse, finished, fitted, synthetic
from wavelet_core.metrics import surface_errors

#: Metres of a degree of latitude.
DEGREE = 111_320.0


def mesh_of(text: str) -> TriangleMesh:
    """Return the mesh of a DEM, or of a square of it."""
    path, _, square = text.partition(":")
    with rasterio.open(path) as dataset:
        window = None
        if square:
            row, column, size = map(int, square.split(","))
            window = Window(column, row, size, size)
        read = dataset.read(1, window=window, masked=True)
        dx, dy = abs(dataset.transform.a), abs(dataset.transform.e)
        if dataset.crs is not None and dataset.crs.is_geographic:
            _, latitude = dataset.xy(dataset.height // 2, dataset.width // 2)
            dx, dy = dx * DEGREE * math.cos(math.radians(latitude)), dy * DEGREE
    rows, columns = read.shape
    valid = ~np.ma.getmaskarray(read)
    z = np.where(valid, read.data, 0.0).astype(float)
    return TriangleMesh.from_grid(z, x=np.arange(columns) * dx, y=np.arange(rows) * dy, valid=valid)


def times(ratio: float) -> str:
    """Return by how many times there are more vertices than in the end."""
    return f" (×{ratio:.2f})" if ratio > 1 else ""


def main() -> None:
    """Print a row for each DEM and size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dems", nargs="+", metavar="DEM[:ROW,COLUMN,SIZE]")
    parser.add_argument("--keep", default="0.1,0.02", help="parts of the vertices")
    options = parser.parse_args()
    small = synthetic.hills(150, 150)
    finished(analyse(small, target_vertices=900), small)
    print("| DEM | nodes | kept | analysis, s | refinement, s | as analysed, then by round |")
    print("|---|---|---|---|---|---|")
    for text in options.dems:
        dem = mesh_of(text)
        for keep in map(float, options.keep.split(",")):
            began = process_time()
            pyramid = analyse(dem, target_vertices=round(keep * dem.n_vertices))
            analysed = process_time()
            found = finished(pyramid, dem)
            seconds = analysed - began, process_time() - analysed
            coarse = fitted(pyramid.mesh(0), dem)
            rmse = math.sqrt(np.nanmean(surface_errors(coarse, dem.vertices) ** 2))
            rounds = " ".join(
                f"{here.rmse / rmse:.3f}{times(here.n_vertices / coarse.n_vertices)}"
                for here in found.rounds
            )
            print(
                f"| {text} | {dem.n_vertices:,} | {100 * keep:g} % | {seconds[0]:.1f} "
                f"| {seconds[1]:.1f} | {rounds} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
