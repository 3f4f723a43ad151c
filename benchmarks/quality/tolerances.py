"""Vertices that a largest error takes, beside those of pydelatin.

    python benchmarks/quality/tolerances.py DEM... [--cells 600] [--parts 0.1,0.5,2]

Of each DEM the upper left corner is taken, at most so many cells on a side, and as tolerances so
many per cent of the relief there. Each line has the vertices of pydelatin, and the share of them
that ours takes as analysed and refined, with the processor time of both; the last line has the
means. Errors are those at every node, by the rasteriser of peers.py, which shares nothing with the
package; a fault, or an error beyond the tolerance, ends the run. Needs the extra "bench".
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from peers import elevations, grid, judge
from pydelatin import Delatin

from wavelet_core import TriangleMesh, analyse, finished

#: What rounding may add to a tolerance, as a part of it.
ROUNDING = 1e-9
FAULTS = ("n_flipped", "n_flat", "n_uncovered", "n_overlapped", "n_off_node")


def checked(z: np.ndarray, mesh: TriangleMesh, tolerance: float) -> int:
    """Return the vertices of a TIN without a fault that keeps the tolerance at every node."""
    figures = judge(z, mesh.vertices, mesh.faces)
    faults = {name: figures[name] for name in FAULTS if figures[name]}
    if faults or figures["max_error"] > tolerance * (1.0 + ROUNDING):
        raise SystemExit(f"{figures['max_error']} beyond {tolerance}, or faults: {faults}")
    return mesh.n_vertices


def measure(z: np.ndarray, tolerance: float) -> tuple[int, float, float, float, float]:
    """Return pydelatin's vertices, our shares of them, and processor seconds."""
    theirs = len(Delatin(z.astype(np.float32), max_error=tolerance).vertices)
    original = TriangleMesh(*grid(z))
    began = time.process_time()
    pyramid = analyse(original, max_error=tolerance)
    analysed = time.process_time()
    refined = finished(pyramid, original).mesh
    done = time.process_time()
    shares = [checked(z, mesh, tolerance) / theirs for mesh in (pyramid.mesh(0), refined)]
    return theirs, *shares, analysed - began, done - analysed


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dems", nargs="+")
    parser.add_argument("--cells", type=int, default=600)
    numbers = lambda text: [float(part) for part in text.split(",")]  # noqa: E731
    parser.add_argument("--parts", type=numbers, default=[0.1, 0.5, 2.0])
    arguments = parser.parse_args()
    corner = elevations(arguments.dems[0], 65)
    measure(corner, 0.01 * float(np.ptp(corner)))  # compiles, or loads what is compiled
    columns = "{:24s}{:>8s}{:>10s}{:>11s}{:>10s}{:>9s}{:>10s}{:>9s}"
    names = ("of relief", "pydelatin", "analysed", "refined", "s", "refining", "s")
    print(columns.format("DEM", *names))
    rows = []
    for dem in arguments.dems:
        z = elevations(dem, arguments.cells)
        for part in arguments.parts:
            theirs, *figures = measure(z, part / 100.0 * float(np.ptp(z)))
            rows.append(figures)
            print(line(Path(dem).stem, f"{part:g} %", f"{theirs:,d}", figures), flush=True)
    print(line("mean", "", "", [float(mean) for mean in np.mean(rows, axis=0)]))


def line(dem: str, part: str, theirs: str, figures: list[float]) -> str:
    """Return one line of the table."""
    shares, seconds = figures[:2], figures[2:]
    numbers = "".join(f"{share:11.3f}" for share in shares)
    numbers += "".join(f"{second:10.2f}" for second in seconds)
    return f"{dem[:23]:24s}{part:>8s}{theirs:>10s}{numbers}"


if __name__ == "__main__":
    main()
