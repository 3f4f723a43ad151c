"""The paper's rates and rankings on real data: what goes per level, which filters err least.

    python benchmarks/quality/paper_rates.py [DATA_FOLDER] [--max-points 120000] [--levels 12]

Clouds are analysed with their class and height above ground as attributes, as in the paper's
section 3, DEMs with elevation alone. ``rmse`` is the mean form of Eq. 54 over columns divided by
their range (``rmse_coefficients``), at the coarsest level. It says how far the kept coefficients
have moved from the input, and nothing about the surface between them.
"""

import argparse
import sys
import warnings
from itertools import product
from pathlib import Path
from time import perf_counter

import numpy as np

from wavelet_core import WaveletError, analyse
from wavelet_gis.workflows.open import CLOUD_SUFFIXES, open_terrain

PREDICTIONS = ("UG", "CL", "GL", "NNLS")
UPDATES = ("MN", "ORMP", "MO")
DESIGNS = tuple(p + u for p, u in product(PREDICTIONS, UPDATES))


def rmse_by_level(pyramid):
    """Return rmse_coefficients of every level, the coarsest first."""
    finest = pyramid.mesh(pyramid.n_levels)
    wanted = np.column_stack([finest.vertices, finest.attributes])
    span = np.ptp(wanted, axis=0)
    span[span == 0] = 1.0
    rmse = []
    for level, mesh in enumerate(pyramid):
        columns = np.column_stack([mesh.vertices, mesh.attributes])
        moved = (columns - wanted[pyramid.vertex_ids(level)]) / span
        rmse.append(np.sqrt(np.mean((moved**2).sum(axis=1))))
    return np.array(rmse)


def mean_share_removed(pyramid):
    """Return the geometric mean of the share of vertices that a level removes."""
    counts = [pyramid.n_vertices(level) for level in range(pyramid.n_levels + 1)]
    return 1 - (counts[0] / counts[-1]) ** (1 / pyramid.n_levels)


def cloud_rows(path, levels):
    """Return {design: (share removed, rmse by level)} of one cloud with class and hag."""
    mesh = open_terrain(path, attributes=("classification", "hag"), carry=False).mesh
    figures = {}
    for design in DESIGNS:
        pyramid = analyse(mesh, levels=levels, partition="quadric", prediction=design, signal="xyz")
        figures[design] = mean_share_removed(pyramid), rmse_by_level(pyramid)
    return mesh.n_vertices, figures


def report_cloud(path, levels):
    n_vertices, figures = cloud_rows(path, levels)
    coarse = {design: rmse[0] for design, (_, rmse) in figures.items()}
    shares = [share for share, _ in figures.values()]
    print(f"\n{path.name}: {n_vertices:,} vertices, class and hag, signal xyz, {levels} levels")
    print(f"  removed a level: {100 * min(shares):.1f} to {100 * max(shares):.1f} %")
    print("  rmse        " + "".join(f"{update:>9}" for update in UPDATES))
    for prediction in PREDICTIONS:
        cells = "".join(f"{coarse[prediction + update]:9.4f}" for update in UPDATES)
        print(f"  {prediction:<12}{cells}")
    geometric, uniform = figures["GLMN"][1], figures["UGMN"][1]
    n_common = min(len(geometric), len(uniform)) - 1  # from the finest level down
    claims = {
        "UG: MN < ORMP < MO": coarse["UGMN"] < coarse["UGORMP"] < coarse["UGMO"],
        "GL: MN lowest": coarse["GLMN"] == min(coarse["GL" + update] for update in UPDATES),
        f"NNLSMN / UGMN = {coarse['NNLSMN'] / coarse['UGMN']:.2f} <= 0.65": (
            coarse["NNLSMN"] <= 0.65 * coarse["UGMN"]
        ),
        "GLMN < UGMN at every level": bool(
            (geometric[::-1][1 : n_common + 1] < uniform[::-1][1 : n_common + 1]).all()
        ),
        "25 to 32 % removed": 0.25 <= min(shares) and max(shares) <= 0.32,
    }
    for claim, holds in claims.items():
        print(f"  {'holds' if holds else 'FAILS'}  {claim}")


def report_dem(path, levels, max_points):
    terrain = open_terrain(path)
    if terrain.mesh.n_vertices > max_points:
        print(f"{path.name:<36} left out: {terrain.mesh.n_vertices:,} vertices")
        return
    shares = []
    for signal in ("z", "xyz"):
        start = perf_counter()
        pyramid = analyse(
            terrain.mesh, levels=levels, partition="quadric", prediction="GLMN", signal=signal
        )
        seconds = perf_counter() - start
        shares.append(f"{signal} {100 * mean_share_removed(pyramid):5.1f} % in {seconds:4.1f} s")
    print(f"{path.name:<36} {terrain.mesh.n_vertices:>9,} vertices   " + "   ".join(shares))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = Path(__file__).resolve().parents[3] / "shared" / "data"
    parser.add_argument("data", nargs="?", type=Path, default=default, help="folder of real data")
    parser.add_argument("--levels", type=int, default=12)
    parser.add_argument("--max-points", type=int, default=120_000, help="leave larger inputs out")
    parser.add_argument("--only", default="", help="inputs whose name contains this")
    arguments = parser.parse_args()
    if not arguments.data.is_dir():
        sys.exit(f"no folder {arguments.data}; name one with DEMs in dems/ and clouds in clouds/")
    warnings.simplefilter("ignore")
    print("DEMs, GLMN: share of the vertices removed by a level, geometric mean")
    for path in sorted((arguments.data / "dems").glob("*.tif")):
        if arguments.only in path.name:
            report_dem(path, arguments.levels, arguments.max_points)
    for path in sorted((arguments.data / "clouds").iterdir()):
        if path.suffix not in CLOUD_SUFFIXES or arguments.only not in path.name:
            continue
        try:
            if count_points(path) <= arguments.max_points:
                report_cloud(path, arguments.levels)
        except WaveletError as error:
            print(f"\n{path.name}: {error}")


def count_points(path):
    """Return the number of points that the header of a LAS file tells."""
    import laspy

    with laspy.open(path) as reader:
        return reader.header.point_count


if __name__ == "__main__":
    main()
