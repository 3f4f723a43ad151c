"""Which share of the kept vertices differs after a shift of the datum or a change of unit.

    python benchmarks/quality/invariance.py DEM... [--size 300] [--row R] [--column C]

For a crop of each DEM and for two partitions: the share that differs when 0.1 m or 100 m are added
to all heights, and when they are given in feet.
"""

import argparse
import warnings
from pathlib import Path

import numpy as np
import rasterio

from wavelet_core import TriangleMesh, analyse

CHANGES = (lambda z: z + 0.1, lambda z: z + 100.0, lambda z: z / 0.3048)


def kept(z, options):
    """Return the ids of the vertices of the coarsest level."""
    x, y = np.arange(z.shape[1]), np.arange(z.shape[0])[::-1]
    return set(analyse(TriangleMesh.from_grid(z, x=x, y=y), **options).vertex_ids(0).tolist())


def main():
    """Print one row of a table for each DEM and partition."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dems", nargs="+")
    parser.add_argument("--size", type=int, default=300)
    parser.add_argument("--row", type=int, default=0)
    parser.add_argument("--column", type=int, default=0)
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    for path in arguments.dems:
        with rasterio.open(path) as dataset:
            z = dataset.read(1, masked=True).astype(float).filled(np.nan)
        first, left = arguments.row, arguments.column
        z = z[first : first + arguments.size, left : left + arguments.size]
        for options in (
            {"partition": "surface", "target_vertices": z.size // 10},
            {"partition": "quadric", "target_vertices": z.size // 20},
        ):
            reference = kept(z, options)
            shares = [len(reference - kept(c(z), options)) / len(reference) for c in CHANGES]
            cells = " | ".join(f"{100 * share:.2f} %" for share in shares)
            print(f"| {Path(path).stem} | {options['partition']} | {cells} |", flush=True)


if __name__ == "__main__":
    main()
