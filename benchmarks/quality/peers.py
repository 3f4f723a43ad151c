"""Simplified terrain against its peers: error, validity, time and memory, in one run.

usage: python benchmarks/quality/peers.py DEM [DEM ...] [--keep 0.25,0.1,0.02,0.005] [--size 1025]
       [--peers ours,vtk,...] [--output peers.jsonl] [--plot peers.png]
       python benchmarks/quality/peers.py --table peers.jsonl [--plot peers.png] [--markdown]

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
LIMIT_SECONDS = 180  # of processor time


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


#: A result with so many times the vertices that were asked for is marked, and never the best.
MOST_MORE = 1.05

#: What the picture calls them.
LABELS = {"ours refined": "ours, the default", "ours fitted": "ours, --no-refine"}


# -- what came out --------------------------------------------------------------------------------


# x, y in cells; surface and covered (n_rows, n_columns): filled. Counts flipped and flat faces.
@njit(cache=True)
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


def _limit_time() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (LIMIT_SECONDS, LIMIT_SECONDS))


def run_all(arguments: argparse.Namespace) -> None:
    """Measure each peer on each DEM in a process of its own; append a line of JSON for each."""
    for dem in arguments.dems:
        for keep in arguments.keep:
            for peer in arguments.peers:
                task = [sys.executable, __file__, "--one", json.dumps([peer, dem, keep])]
                task += ["--size", str(arguments.size)]
                done = subprocess.run(
                    task, capture_output=True, text=True, check=False, preexec_fn=_limit_time
                )
                lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
                why = (done.stderr.strip().splitlines() or [f"no answer in {LIMIT_SECONDS} s"])[-1]
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


def of_dem(results: list[dict], dem: str, peer: str) -> list[dict]:
    """Return the results of a peer on a DEM, the smallest TIN first."""
    mine = [r for r in results if r["dem"] == dem and r["peer"] == peer and r["rmse"] > 0]
    return sorted(mine, key=lambda r: r["n_vertices"])


def to_error(results: list[dict], rmse: float) -> tuple[float, float]:
    """Return vertices and processor seconds to an error, between results by logarithms; or NaN."""
    ordered = sorted(results, key=lambda r: r["rmse"])
    if len(ordered) < 2 or not ordered[0]["rmse"] <= rmse <= ordered[-1]["rmse"]:
        return np.nan, np.nan
    errors = np.log([r["rmse"] for r in ordered])
    figures = (np.log([r[name] for r in ordered]) for name in ("n_vertices", "cpu_seconds"))
    n_vertices, seconds = (float(np.exp(np.interp(np.log(rmse), errors, f))) for f in figures)
    return n_vertices, seconds


def markdown(results: list[dict]) -> None:
    """Print RMSE and processor time of all, and what the first of ours takes to their errors."""
    peers = [peer for peer in PEERS if any(r["peer"] == peer for r in results)]
    dems = sorted({r["dem"] for r in results})
    first = next(peer for peer in ("ours refined", *peers) if peer in peers)
    print("| DEM | kept | " + " | ".join(peers) + " |\n" + "|---" * (len(peers) + 2) + "|")
    for dem in dems:
        for keep in sorted({r["keep"] for r in results if r["dem"] == dem}, reverse=True):
            here = {r["peer"]: r for r in results if r["dem"] == dem and r["keep"] == keep}
            best = min(r["rmse"] for r in here.values() if _times_asked(r) <= MOST_MORE)
            cells = [_cell(here[peer], best) if peer in here else "–" for peer in peers]
            print(f"| {dem} | {100 * keep:g} % | " + " | ".join(cells) + " |")
    print(f"\n{first}, of the vertices and of the processor time of each, to its error:\n")
    for dem in dems:
        for figures in (r for p in peers if p != first for r in of_dem(results, dem, p)):
            n, seconds = to_error(of_dem(results, dem, first), figures["rmse"])
            shares = n / figures["n_vertices"], seconds / max(figures["cpu_seconds"], 0.01)
            if np.isfinite(n):
                name = f"{dem} {figures['keep']:.2%} {figures['peer']}"
                print(f"{name}: {shares[0]:.2f}, {shares[1]:.2f}")


def _times_asked(figures: dict) -> float:
    return figures["n_vertices"] / (figures["keep"] * figures["n_nodes"])


def _cell(figures: dict, best: float) -> str:
    rmse = f"{figures['rmse']:.3g}"
    more = _times_asked(figures)
    times = f" (×{more:.1f})" if more > MOST_MORE else ""
    bold = f"**{rmse}**" if figures["rmse"] == best else rmse
    return f"{bold} / {figures['cpu_seconds']:.2g}{times}"


def plot(results: list[dict], path: str) -> None:
    """Draw error against vertices and against processor time, one column a DEM."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.ticker import NullFormatter

    dems = sorted({r["dem"] for r in results})
    size = (5.2 * len(dems), 8.4)
    figure, axes = pyplot.subplots(2, len(dems), figsize=size, squeeze=False, layout="constrained")
    peers = [peer for peer in PEERS if any(r["peer"] == peer for r in results)]
    others = [peer for peer in peers if not peer.startswith("ours")]
    grey = pyplot.get_cmap("tab10").colors
    colours = dict(zip(others, grey[1:3] + grey[4:], strict=False))
    colours |= dict(
        zip([p for p in peers if p not in others], ("#b91c1c", "#111827"), strict=False)
    )
    for column, dem in enumerate(dems):
        for peer in peers:
            mine = of_dem(results, dem, peer)
            is_ours = peer not in others
            style = {
                "color": colours.get(peer, "#9ca3af"),
                "marker": "o" if is_ours else "s",
                "ms": 5 if is_ours else 3.5,
                "lw": 2.4 if is_ours else 1.1,
                "zorder": 3 if is_ours else 2,
                "label": LABELS.get(peer, peer) if column == 0 else None,
            }
            rmse = [r["rmse"] for r in mine]
            axes[0, column].loglog([r["n_vertices"] for r in mine], rmse, **style)
            style["label"] = None
            axes[1, column].loglog([r["cpu_seconds"] for r in mine], rmse, **style)
        axes[0, column].set_title(f"{dem}, {mine[0]['n_nodes']:,} nodes", fontsize=10)
        axes[0, column].set_xlabel("vertices")
        axes[1, column].set_xlabel("processor time (s)")
    for ax in axes.flat:
        ax.grid(which="both", color="#e5e7eb", linewidth=0.5)
        ax.set_ylabel("RMSE at all nodes (m)")
        ax.xaxis.set_minor_formatter(NullFormatter())
    figure.legend(loc="outside lower center", ncols=3, fontsize=9)
    figure.savefig(path, dpi=90)


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
    parser.add_argument("--markdown", action="store_true")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        peer, dem, keep = json.loads(arguments.one)
        print(json.dumps(measure(peer, dem, arguments.size, keep)))
        return
    if not arguments.table:
        run_all(arguments)
    results = table(arguments.table or arguments.output)
    if arguments.markdown:
        markdown(results)
    if arguments.plot:
        plot(results, arguments.plot)


if __name__ == "__main__":
    main()
