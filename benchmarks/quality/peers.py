"""Simplified terrain against its peers: error, validity, time and memory, in one run.

usage: python benchmarks/quality/peers.py DEM [DEM ...] [--keep 0.25,0.1,0.02,0.005] [--size 1025]
       [--peers ours,vtk,...] [--output peers.jsonl] [--plot peers.png]
       python benchmarks/quality/peers.py --table peers.jsonl [--plot peers.png]

Each measurement has a process of its own: one call on a 65 x 65 corner to load and compile, then
the call that is measured. Errors are vertical, at every node of the DEM, by a rasteriser that
shares nothing with the package; a node that no triangle covers is judged by the surface at the
nearest one that has some. Peers that take a number of faces are asked for twice the number
of vertices. Needs the extra "bench": pip install -e ".[bench]"
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np
from numba import njit
from scipy.ndimage import distance_transform_edt

CELL = 30.0
LIMIT_SECONDS = 180


def elevations(path: str, size: int) -> np.ndarray:
    """Return the upper left corner of a DEM, at most ``size`` on a side, without voids."""
    import rasterio

    with rasterio.open(path) as dataset:
        band = dataset.read(1, masked=True).astype(np.float64)
    z = band.filled(np.nan)[:size, :size]
    side = min(z.shape)
    z = np.ascontiguousarray(z[:side, :side])
    if not np.isfinite(z).all():
        raise SystemExit(f"{path}: there are voids in the upper left {side} x {side} cells")
    return z


def grid(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and faces of a square DEM with cells of CELL."""
    n_rows, n_columns = z.shape
    row, column = np.mgrid[0:n_rows, 0:n_columns]
    vertices = np.column_stack([CELL * column.ravel(), CELL * row.ravel(), z.ravel()])
    a = (np.arange(n_rows - 1)[:, None] * n_columns + np.arange(n_columns - 1)).ravel()
    faces = np.stack(
        [
            np.column_stack([a, a + 1, a + n_columns + 1]),
            np.column_stack([a, a + n_columns + 1, a + n_columns]),
        ],
        axis=1,
    )
    return vertices, faces.reshape(-1, 3).astype(np.int32)


# -- the peers: (z, vertices, faces, n_vertices) -> (vertices, faces), or a raster ----------------


def ours(z, vertices, faces, n, **options):
    from wavelet_core import TriangleMesh, analyse

    mesh = analyse(TriangleMesh(vertices, faces), target_vertices=n, **options).mesh(0)
    return mesh.vertices, mesh.faces


def ours_refined(z, vertices, faces, n, rounds=None, keep_points=False, **options):
    """Return what `simplify` gives: the level refined, its heights fitted."""
    from wavelet_core import TriangleMesh, analyse, finished

    original = TriangleMesh(vertices, faces)
    pyramid = analyse(original, target_vertices=n, **options)
    mesh = finished(pyramid, original, rounds=rounds, keep_points=keep_points).mesh
    return mesh.vertices, mesh.faces


def ours_fitted(z, vertices, faces, n):
    return ours_refined(z, vertices, faces, n, rounds=0)


def ours_kept(z, vertices, faces, n):
    return ours_refined(z, vertices, faces, n, keep_points=True, update="none")


def ours_max_refined(z, vertices, faces, n):
    return ours_refined(z, vertices, faces, n, norm="max")


def ours_max(z, vertices, faces, n):
    return ours(z, vertices, faces, n, norm="max")


def ours_paper(z, vertices, faces, n):
    return ours(z, vertices, faces, n, partition="quadric")


def fast_simplification(z, vertices, faces, n):
    import fast_simplification

    return fast_simplification.simplify(vertices, faces, target_count=2 * n)


def pyfqmr(z, vertices, faces, n):
    import pyfqmr

    simplifier = pyfqmr.Simplify()
    simplifier.setMesh(vertices, faces)
    simplifier.simplify_mesh(target_count=2 * n, aggressiveness=7, verbose=0)
    return simplifier.getMesh()[:2]


def meshoptimizer(z, vertices, faces, n):
    import meshoptimizer

    positions = np.ascontiguousarray(vertices - vertices.mean(axis=0), dtype=np.float32)
    indices = np.ascontiguousarray(faces.ravel(), dtype=np.uint32)
    result = np.zeros_like(indices)
    count = meshoptimizer.simplify(
        result, indices, positions, target_index_count=6 * n, target_error=1.0
    )
    used, inverse = np.unique(result[:count].astype(np.int64), return_inverse=True)
    return vertices[used], inverse.reshape(-1, 3)


def qslim(z, vertices, faces, n):
    import igl

    arrays = np.asfortranarray(vertices), np.asfortranarray(faces, dtype=np.int32)
    return igl.qslim(*arrays, 2 * n)[:2]


def opengl_decimate(z, vertices, faces, n, metric="quadric"):
    from opengl_decimate import SimplifyOptions, simplify

    origin = vertices.mean(axis=0)
    positions = (vertices - origin).astype(np.float32)
    options = SimplifyOptions(target_count=2 * n, metric=metric)
    result = simplify({"POSITION": positions}, faces.ravel().astype(np.uint32), options)
    moved = np.asarray(result.attributes["POSITION"], dtype=np.float64) + origin
    return moved, np.asarray(result.indices).reshape(-1, 3)


def opengl_probabilistic(z, vertices, faces, n):
    return opengl_decimate(z, vertices, faces, n, metric="probabilistic")


def vtk(z, vertices, faces, n):
    import pyvista

    mesh = pyvista.PolyData.from_regular_faces(vertices, faces).decimate(1 - 2 * n / len(faces))
    return np.asarray(mesh.points, dtype=float), mesh.faces.reshape(-1, 4)[:, 1:]


def pydelatin(z, vertices, faces, n):
    from pydelatin import Delatin

    tin = Delatin(z.astype(np.float32), max_error=0, max_points=n)
    points = np.array(tin.vertices, dtype=float)
    row = len(z) - 1 - points[:, 1] if _is_upside_down(z, points) else points[:, 1]
    return np.column_stack([CELL * points[:, 0], CELL * row, points[:, 2]]), np.array(tin.triangles)


def _is_upside_down(z, points):
    column, row = points[:, 0].astype(int), points[:, 1].astype(int)
    as_is = np.abs(z[row, column] - points[:, 2]).sum()
    return np.abs(z[len(z) - 1 - row, column] - points[:, 2]).sum() < as_is


def pymartini(z, vertices, faces, n):
    from pymartini import Martini

    side = 2 ** int(np.log2(len(z) - 1)) + 1
    if side != len(z):
        raise SystemExit("martini needs a side of a power of two and one more")
    tile = Martini(side).create_tile(z.astype(np.float32))
    low, high, best = 0.0, float(np.ptp(z)), None
    for _ in range(22):
        error = (low + high) / 2
        points, triangles = tile.get_mesh(error)
        points = np.asarray(points).reshape(-1, 2).astype(np.int64)
        if best is None or abs(len(points) - n) < abs(len(best[0]) - n):
            best = (points, np.asarray(triangles).reshape(-1, 3).astype(np.int64))
        low, high = (error, high) if len(points) > n else (low, error)
    points, triangles = best
    heights = z[points[:, 1], points[:, 0]]
    return np.column_stack([CELL * points, heights]), triangles


def subsample(z, vertices, faces, n):
    kept = np.round(np.linspace(0, len(z) - 1, max(round(n**0.5), 2))).astype(int)
    points, triangles = grid(z[np.ix_(kept, kept)])
    column, row = np.meshgrid(kept, kept)
    points[:, :2] = CELL * np.column_stack([column.ravel(), row.ravel()])
    return points, triangles


def wavelet97(z, vertices, faces, n):
    """Keep the n largest coefficients of the biorthogonal 9/7 transform: a raster, no TIN."""
    import pywt

    coefficients = pywt.wavedec2(z, "bior4.4", mode="symmetric", level=6)
    flat, slices = pywt.coeffs_to_array(coefficients)
    threshold = np.partition(np.abs(flat).ravel(), -n)[-n]
    kept = np.where(np.abs(flat) >= threshold, flat, 0.0)
    back = pywt.array_to_coeffs(kept, slices, output_format="wavedec2")
    return pywt.waverec2(back, "bior4.4", mode="symmetric")[: z.shape[0], : z.shape[1]]


PEERS: dict[str, Callable] = {
    "ours": ours,
    "ours fitted": ours_fitted,
    "ours refined": ours_refined,
    "ours points kept": ours_kept,
    "ours max": ours_max,
    "ours max refined": ours_max_refined,
    "ours paper": ours_paper,
    "libigl qslim": qslim,
    "opengl-decimate": opengl_decimate,
    "opengl-decimate probabilistic": opengl_probabilistic,
    "VTK quadric": vtk,
    "fast-simplification": fast_simplification,
    "pyfqmr": pyfqmr,
    "meshoptimizer": meshoptimizer,
    "pydelatin": pydelatin,
    "pymartini": pymartini,
    "CDF 9/7 wavelet": wavelet97,
    "regular subsample": subsample,
}


# -- what came out --------------------------------------------------------------------------------


# x, y in cells; surface and covered (n_rows, n_columns): filled. Counts flipped and flat faces.
@njit
def lay_faces(x, y, z, faces, surface, covered, inside):
    n_flipped, n_flat = 0, 0
    for f in range(faces.shape[0]):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        area = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])
        if abs(area) < 1e-9:
            n_flat += 1
            continue
        if area < 0:
            n_flipped += 1
        first = max(int(np.ceil(min(y[a], y[b], y[c]) - 1e-9)), 0)
        last = min(int(np.floor(max(y[a], y[b], y[c]) + 1e-9)), surface.shape[0] - 1)
        left = max(int(np.ceil(min(x[a], x[b], x[c]) - 1e-9)), 0)
        right = min(int(np.floor(max(x[a], x[b], x[c]) + 1e-9)), surface.shape[1] - 1)
        for row in range(first, last + 1):
            for column in range(left, right + 1):
                at_a = ((x[b] - column) * (y[c] - row) - (x[c] - column) * (y[b] - row)) / area
                at_b = ((x[c] - column) * (y[a] - row) - (x[a] - column) * (y[c] - row)) / area
                at_c = 1.0 - at_a - at_b
                least = min(at_a, at_b, at_c)
                if least >= -1e-9:
                    surface[row, column] = at_a * z[a] + at_b * z[b] + at_c * z[c]
                    covered[row, column] += 1
                    if least > 1e-6:
                        inside[row, column] += 1
    return n_flipped, n_flat


def extended(surface: np.ndarray, covered: np.ndarray) -> np.ndarray:
    """Return the surface with the height of the nearest covered node where it covers none."""
    if covered.all():
        return surface
    nearest = distance_transform_edt(~covered, return_distances=False, return_indices=True)
    return surface[tuple(nearest)]


def judge(z: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> dict[str, float]:
    """Return size, errors and faults of a TIN over the nodes of a DEM."""
    x, y, heights = (np.ascontiguousarray(c, dtype=np.float64) for c in np.asarray(vertices).T)
    faces = np.ascontiguousarray(np.asarray(faces).reshape(-1, 3), dtype=np.int64)
    covered, inside = np.zeros(z.shape, np.int32), np.zeros(z.shape, np.int32)
    surface = np.full(z.shape, np.nan)
    arguments = (x / CELL, y / CELL, heights, faces, surface, covered, inside)
    n_flipped, n_flat = lay_faces(*arguments)
    n_flipped = min(n_flipped, len(faces) - n_flat - n_flipped)
    error = (extended(surface, covered > 0) - z).ravel()
    on_node = np.abs(vertices[:, :2] / CELL - np.round(vertices[:, :2] / CELL)).max(axis=1) < 1e-6
    return {
        "n_vertices": len(np.unique(faces)),
        "n_faces": len(faces),
        "rmse": float(np.sqrt(np.mean(error**2))),
        "max_error": float(np.abs(error).max()),
        "n_flipped": int(n_flipped),
        "n_flat": int(n_flat),
        "n_uncovered": int((covered == 0).sum()),
        "n_overlapped": int((inside > 1).sum()),
        "n_off_node": int((~on_node).sum()),
    }


def measure(peer: str, dem: str, size: int, keep: float) -> dict[str, object]:
    """Run one peer once and return what came out."""
    z = elevations(dem, size)
    n = int(keep * z.size)
    corner = np.ascontiguousarray(z[:65, :65])
    PEERS[peer](corner, *grid(corner), 1000)
    vertices, faces = grid(z)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began, cpu = perf_counter(), os.times()
    result = PEERS[peer](z, vertices, faces, n)
    seconds, after = perf_counter() - began, os.times()
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    figures: dict[str, object] = {
        "peer": peer,
        "dem": Path(dem).name,
        "n_nodes": z.size,
        "keep": keep,
        "seconds": seconds,
        "cpu_seconds": after.user + after.system - cpu.user - cpu.system,
        "mib_per_million": grown / 1024 / (z.size / 1e6),
    }
    if isinstance(result, np.ndarray):
        error = np.abs(result - z)
        return figures | {
            "n_vertices": n,
            "rmse": float(np.sqrt((error**2).mean())),
            "max_error": float(error.max()),
        }
    return figures | judge(z, *result)


def run_all(arguments: argparse.Namespace) -> None:
    """Measure each peer on each DEM in a process of its own; append a line of JSON for each."""
    for dem in arguments.dems:
        for keep in arguments.keep:
            for peer in arguments.peers:
                task = [sys.executable, __file__, "--one", json.dumps([peer, dem, keep])]
                task += ["--size", str(arguments.size)]
                try:
                    done = subprocess.run(
                        task, capture_output=True, text=True, timeout=LIMIT_SECONDS, check=False
                    )
                    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
                    why = (done.stderr.strip().splitlines() or ["no answer"])[-1]
                except subprocess.TimeoutExpired:
                    lines, why = [], f"no answer in {LIMIT_SECONDS} s"
                if not lines:
                    print(f"{peer} on {Path(dem).name} at {keep:.2%}: {why}", file=sys.stderr)
                    continue
                with open(arguments.output, "a", encoding="utf-8") as stream:
                    stream.write(lines[-1] + "\n")
                print(row(json.loads(lines[-1])), flush=True)


def row(figures: dict) -> str:
    """Return one line of the table."""
    faults = "   ".join(
        f"{name[2:]} {figures[name]}"
        for name in ("n_flipped", "n_flat", "n_uncovered", "n_overlapped", "n_off_node")
        if figures.get(name)
    )
    return (
        f"{figures['dem'][:22]:22s} {figures['keep']:6.2%} {figures['peer']:24s}"
        f"{figures['n_vertices']:9,d} {figures['rmse']:9.4f} {figures['max_error']:9.3f} "
        f"{figures['seconds']:7.2f} s {figures['mib_per_million']:6.0f} MiB/M  {faults}"
    )


def table(path: str) -> list[dict]:
    """Print a file of results, best first for each DEM and size; return its lines."""
    results = [json.loads(line) for line in Path(path).read_text().splitlines()]
    results.sort(key=lambda r: (r["dem"], -r["keep"], r["rmse"]))
    for figures in results:
        print(row(figures))
    return results


def plot(results: list[dict], path: str) -> None:
    """Draw error against vertices and against time, one column a DEM."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    dems = sorted({r["dem"] for r in results})
    size = (4.2 * len(dems), 7.5)
    figure, axes = pyplot.subplots(2, len(dems), figsize=size, squeeze=False, layout="constrained")
    colours = dict(zip(PEERS, pyplot.get_cmap("tab20").colors, strict=False))
    labelled: set[str] = set()
    for column, dem in enumerate(dems):
        for peer in PEERS:
            mine = [r for r in results if r["dem"] == dem and r["peer"] == peer and r["rmse"] > 0]
            if not mine:
                continue
            mine.sort(key=lambda r: r["n_vertices"])
            style = {
                "color": colours[peer],
                "marker": "o",
                "ms": 3.5,
                "lw": 2.4 if peer.startswith("ours") else 1.1,
                "label": None if peer in labelled else peer,
            }
            labelled.add(peer)
            rmse = [r["rmse"] for r in mine]
            axes[0, column].loglog([r["n_vertices"] for r in mine], rmse, **style)
            axes[1, column].loglog([r["seconds"] for r in mine], rmse, **style | {"label": None})
        axes[0, column].set_title(dem, fontsize=9)
        axes[0, column].set_xlabel("vertices (or coefficients)")
        axes[1, column].set_xlabel("seconds")
    for line in axes:
        line[0].set_ylabel("RMSE at all nodes")
    figure.legend(loc="outside lower center", ncols=4, fontsize=8)
    figure.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dems", nargs="*")
    parser.add_argument("--size", type=int, default=1025)
    numbers = lambda text: [float(part) for part in text.split(",")]  # noqa: E731
    parser.add_argument("--keep", type=numbers, default=[0.25, 0.1, 0.02, 0.005])
    parser.add_argument("--peers", type=lambda text: text.split(","), default=list(PEERS))
    parser.add_argument("--output", default="peers.jsonl")
    parser.add_argument("--table")
    parser.add_argument("--plot")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        peer, dem, keep = json.loads(arguments.one)
        print(json.dumps(measure(peer, dem, arguments.size, keep)))
        return
    if not arguments.table:
        run_all(arguments)
    results = table(arguments.table or arguments.output)
    if arguments.plot:
        plot(results, arguments.plot)


if __name__ == "__main__":
    main()
