"""Random DEMs and clouds through analyse, info, extract, simplify and reconstruct.

    python tests/tools/random_terrain.py --dems 1000 --clouds 500 --seed 0

Whatever analyse writes must be read, and must come back: a raster bit for bit with mask, nodata
and tags, a cloud byte for byte. Every error that is printed must be what `second_opinion`, which
shares nothing with the package, finds at all input points. A refusal is one line, and only of
input that holds no surface.
"""

import argparse
import contextlib
import io
import json
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
if __name__ == "__main__":
    sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

from gis.samples import assert_same_raster, write_tif  # noqa: E402
from tools.second_opinion import read_ply, second_opinion  # noqa: E402

from wavelet_gis.cli.main import main as command  # noqa: E402

#: How a refusal of input without a surface ends.
NO_SURFACE = (
    "there is no surface",
    "every cell of the raster is nodata",
    "too few to triangulate",
    "lie on one line",
    "no point is left",
    "a surface needs at least three",
)

#: Slack of an error against the second opinion, in parts of the relief.
SLACK = 1e-7


class FaultError(AssertionError):
    """Something that must not be."""


def random_dem(path, rng):
    """Write a DEM with holes, flat parts and single cells; return its valid points."""
    n_rows, n_columns = (int(n) for n in rng.integers(2, 61, 2))
    y, x = np.mgrid[0:n_rows, 0:n_columns]
    z = 200 + 30 * np.sin(x / rng.uniform(2, 20)) * np.cos(y / rng.uniform(2, 20))
    z += rng.choice([0.0, 0.1, 3.0]) * rng.standard_normal(z.shape)
    if rng.random() < 0.4:  # a lake, a plateau
        z = np.maximum(z, rng.uniform(180, 220))
    if rng.random() < 0.1:
        z[:] = 150.0
    dtype = str(rng.choice(["float32", "float64", "int16", "uint16", "uint8", "int32"]))
    z = np.clip(np.round(z), 1, 254).astype(dtype) if dtype[0] != "f" else z.astype(dtype)
    hole = _holes(z.shape, rng)
    options = {}
    if dtype[0] == "f" and rng.random() < 0.3:
        z[hole] = np.nan
    else:
        options["nodata"] = 0 if dtype[0] == "u" else -9999.0
        z[hole] = options["nodata"]
    side = float(rng.choice([0.5, 1.0, 10.0, 33.3652]))
    import rasterio

    south = rng.random() < 0.2
    place = rasterio.Affine(side, 0.0, 5e5, 0.0, side if south else -side, 5.1e6)
    options["compress"] = str(rng.choice(["deflate", "none", "lzw"]))
    write_tif(path, z, transform=place, **options)
    rows, columns = np.nonzero(~hole)
    east, north = 5e5 + side * (columns + 0.5), 5.1e6 + place.e * (rows + 0.5)
    return np.column_stack([east, north, z[rows, columns].astype(float)])


def _holes(shape, rng):
    hole = np.zeros(shape, dtype=bool)
    share = rng.uniform(0.0, 0.6)
    kind = rng.choice(["none", "specks", "blobs", "strips", "islands"])
    if kind == "specks":
        hole = rng.random(shape) < share
    elif kind == "blobs":
        y, x = np.mgrid[0 : shape[0], 0 : shape[1]]
        for _ in range(200):
            if hole.mean() >= share:
                break
            at = rng.uniform(0, 1, 2) * shape
            hole |= (y - at[0]) ** 2 + (x - at[1]) ** 2 < rng.uniform(1, 8) ** 2
    elif kind == "strips":
        for _ in range(200):
            if hole.mean() >= share:
                break
            axis, width = int(rng.integers(0, 2)), int(rng.integers(1, 4))
            start = int(rng.integers(0, shape[axis]))
            hole[(slice(None),) * axis + (slice(start, start + width),)] = True
    elif kind == "islands":  # single cells and strips one cell wide
        hole[:] = True
        hole[: shape[0] // 2, : shape[1] // 2] = False
        hole[rng.random(shape) < 0.02] = False
        hole[int(rng.integers(0, shape[0]))] = False
    return hole


def random_cloud(path, rng):
    """Write a LAS file with duplicates, gaps and noise; return the points of its surface."""
    import laspy

    version, point_format = [("1.2", 3), ("1.2", 0), ("1.3", 1), ("1.4", 6), ("1.4", 7)][
        int(rng.integers(0, 5))
    ]
    n = int(rng.integers(3, 1500))
    header = laspy.LasHeader(version=version, point_format=point_format)
    header.scales = np.full(3, float(rng.choice([0.01, 0.001, 0.25])))
    header.offsets = np.array([5e5, 5.1e6, float(rng.choice([0.0, 100.0]))])
    plan = rng.uniform(0, 100, (n, 2))
    gap = rng.choice(["none", "strip", "half", "clusters", "lattice"])
    if gap == "strip":
        plan[:, 0] = np.where(plan[:, 0] > 40, plan[:, 0] + 200, plan[:, 0])
    elif gap == "half":
        plan = plan[: max(3, n // 2)] * [0.2, 1.0]
    elif gap == "clusters":
        plan = plan / 20 + rng.integers(0, 4, (n, 2)) * 60
    elif gap == "lattice":
        plan = np.round(plan / 4) * 4
    n = len(plan)
    shared = rng.random(n) < rng.choice([0.0, 0.05, 0.5])
    plan[shared] = plan[rng.integers(0, n, shared.sum())]
    las = laspy.LasData(header)
    las.x, las.y = 5e5 + plan[:, 0], 5.1e6 + plan[:, 1]
    las.z = 300 + 20 * np.sin(plan[:, 0] / 30) + rng.choice([0.0, 0.2, 8.0]) * rng.random(n)
    classes = rng.choice([1, 2, 5, 7, 18], n, p=[0.3, 0.4, 0.2, 0.05, 0.05]).astype(np.uint8)
    las.classification = classes
    las.withheld = rng.random(n) < 0.03
    las.intensity = rng.integers(0, 65536, n).astype(np.uint16)
    las.return_number = np.ones(n, np.uint8)
    las.write(path)
    used = ~np.isin(classes, (7, 18)) & ~np.asarray(las.withheld, dtype=bool)
    return np.column_stack([las.x, las.y, las.z])[used]


def run(*arguments):
    """Run a command; return its exit code, what it printed, and its complaint."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = command([str(argument) for argument in arguments])
    return code, out.getvalue(), err.getvalue()


def done(*arguments):
    """Return what a command prints as JSON; it must succeed."""
    code, out, err = run(*arguments, "--json")
    if code != 0:
        raise FaultError(f"{arguments[0]} ends with {code}: {err}")
    return json.loads(out)


def compare(what, figures, opinion, relief):
    """Hold printed errors against the second opinion."""
    slack = SLACK * max(relief, 1.0)
    names = (("rmse", "rmse"), ("rmse_surface", "rmse"), ("max_error", "largest"),
             ("max_error_surface", "largest"), ("n_points_uncovered", "n_uncovered"))  # fmt: skip
    if "level" in figures and "rmse_surface" in figures:  # of a raster it counts cells
        names = (*names, ("n_uncovered", "n_uncovered"))
    for name, other in names:
        if name in figures and abs(figures[name] - getattr(opinion, other)) > slack:
            raise FaultError(
                f"{what}: {name} is {figures[name]!r}, and the second opinion {opinion}"
            )


def try_one(folder, kind, rng):
    """Take one random terrain through the commands; return what became of it."""
    source = folder / ("a.tif" if kind == "dem" else "a.las")
    points = (random_dem if kind == "dem" else random_cloud)(source, rng)
    relief = float(np.ptp(points[:, 2])) if len(points) else 0.0
    pyramid = folder / "p.gpkg"
    levels = ["--levels", int(rng.integers(1, 9))] if rng.random() < 0.7 else []
    layers = ["--layers", str(rng.choice(["all", "coarse", "none"]))]
    code, _, err = run("analyse", source, pyramid, *levels, *layers, "--quiet")
    if code != 0:
        if err.count("\n") != 1 or not any(words in err for words in NO_SURFACE):
            raise FaultError(f"analyse ends with {code}: {err}")
        if pyramid.exists():
            raise FaultError("a refused analyse leaves a file")
        return "refused"
    told = done("info", pyramid)["levels"]
    chosen = told[int(rng.integers(0, len(told)))]
    level = chosen["level"]
    figures = done("extract", pyramid, folder / "l.ply", "--level", level)
    mesh = read_ply(folder / "l.ply")
    opinion = second_opinion(*mesh, points)
    compare(f"info, level {level}", chosen, opinion, relief)
    compare(f"extract, level {level}", figures, opinion, relief)
    done("extract", pyramid, folder / "l.tif", "--level", level)
    size = max(3, len(mesh[0]) - int(rng.integers(0, 5)))
    limit = max(relief, 0.1) * float(rng.choice([0.01, 0.1, 0.5]))
    for rule in (["--max-error", limit], ["--vertices", size]):
        figures = (
            done("extract", pyramid, folder / "e.ply", *rule) if rule[0] == "--max-error" else {}
        )
        if figures:
            opinion = second_opinion(*read_ply(folder / "e.ply"), points)
            compare(f"extract {rule}", figures, opinion, relief)
        figures = done("simplify", source, folder / "s.ply", *rule, "--overwrite")
        opinion = second_opinion(*read_ply(folder / "s.ply"), points)
        compare(f"simplify {rule}", figures, opinion, relief)
        if kind == "dem" and rule[0] == "--max-error" and opinion.largest > limit * (1 + 1e-9):
            raise FaultError(f"--max-error {limit} gives {opinion}")
    back = folder / f"back{source.suffix}"
    done("reconstruct", pyramid, back)
    if kind == "dem":
        assert_same_raster(source, back)
    elif back.read_bytes() != source.read_bytes():
        raise FaultError("the cloud that comes back is another")
    return "came back"


def trials(kind, count, seed):
    """Yield the number of each trial, and what became of it or the fault."""
    for number in range(count):
        rng = np.random.default_rng([seed, number, kind == "cloud"])
        with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                yield number, try_one(Path(name), kind, rng), None
            except Exception as fault:
                yield number, "fault", fault


def main():
    """Run the trials and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dems", type=int, default=1000)
    parser.add_argument("--clouds", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    n_faults = 0
    for kind, count in (("dem", arguments.dems), ("cloud", arguments.clouds)):
        counts, began = Counter(), time.monotonic()
        for number, outcome, fault in trials(kind, count, arguments.seed):
            counts[outcome] += 1
            if fault is not None:
                n_faults += 1
                text = f"{type(fault).__name__}: {fault}"
                print(f"{kind} {number}: {text[:600]}", flush=True)
            if (number + 1) % 100 == 0 or number + 1 == count:
                seconds = time.monotonic() - began
                print(f"{number + 1} {kind}s: {dict(counts)}; {seconds:.0f} s", flush=True)
    return 1 if n_faults else 0


if __name__ == "__main__":
    sys.exit(main())
