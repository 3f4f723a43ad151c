"""The array engine against the compiled one: time, memory, and whether the bytes are the same.

    python benchmarks/cost/engines.py [--large]
    python benchmarks/cost/engines.py --real [--data ../shared/data] [--results FILE.json]

Each run is a process of its own, whose kernels are in numba's cache; ratios are within one run of
this script. Seconds are of the processor, all threads together, which other work on the machine
hardly touches; ``whole`` is the process, imports included. Memory is what the work adds to that of
the input mesh. With ``--results`` the figures of real inputs are kept after each,
and those that the file holds are printed and not run again: it may be stopped and run in parts.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

DESIGNS = {
    "10 %": "target_vertices=mesh.n_vertices // 10",
    "tolerance": "max_error=tolerance",
    "levels": "",
    "GLMN": "prediction='GLMN', levels=12",
}

WORK = """
import hashlib, json, resource, sys, time
import numpy as np
import wavelet_core as wc
name, n, design = sys.argv[1], int(sys.argv[2]), sys.argv[3]
if name == "synthetic":
    y, x = np.mgrid[:n, :n]
    noise = np.random.default_rng(1).normal(0, 0.5, (n, n))
    z = 30 * np.sin(x / 17) + 20 * np.cos(y / 23) + noise
    mesh = wc.TriangleMesh.from_grid(z, x=10.0 * np.arange(n), y=10.0 * np.arange(n))
else:
    import wavelet_gis as wg
    mesh = wg.open(name).mesh
    if mesh.n_vertices > 1_100_000:
        print("{}")
        sys.exit(0)
tolerance = 0.02 * float(np.ptp(mesh.vertices[:, 2]))
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
busy = time.process_time()
if design == "denoise":
    result = wc.denoise(mesh, 1.0)
    digest = hashlib.sha256(result.vertices.tobytes()).hexdigest()
    size = result.n_vertices
else:
    pyramid = eval(f"wc.analyse(mesh, {design})")
    seen = hashlib.sha256()
    for step in pyramid.steps:
        for array in (step.odd, step.target, step.indices, step.weights, step.details):
            seen.update(array.tobytes())
    digest, size = seen.hexdigest(), pyramid.n_vertices(0)
used = time.process_time() - busy
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps({"n": mesh.n_vertices, "left": size, "used": used, "digest": digest,
                  "bytes": 1024 * (peak - before) / mesh.n_vertices}))
"""


def run(engine: str, name: str, n: int, design: str) -> dict:
    """Return the figures of one piece of work on one engine."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "TERRAIN_WAVELETS_ENGINE": engine}
    if engine == "arrays":
        environment["TERRAIN_WAVELETS_NO_NUMBA"] = "1"
    began = sum(os.times()[2:4])
    said = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", WORK, name, str(n), design],
        env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    figures = json.loads(said.stdout)
    return {**figures, "whole": sum(os.times()[2:4]) - began} if figures else {}


def compare(name: str, n: int, label: str, design: str) -> None:
    """Print one row."""
    run("compiled", name, n, design)  # into numba's cache
    ours, theirs = run("compiled", name, n, design), run("arrays", name, n, design)
    same = "same" if ours["digest"] == theirs["digest"] else "DIFFER"
    print(
        f"| {Path(name).stem} | {label} | {ours['n']:,} | {ours['left']:,} | "
        f"{ours['used']:.1f} | {theirs['used']:.1f} | "
        f"{theirs['used'] / ours['used']:.1f} | {theirs['whole']:.1f} | "
        f"{theirs['bytes']:.0f} | {same} |",
        flush=True,
    )


def real_inputs(folder: Path) -> list[Path]:
    """Return the DEMs and clouds, the smallest first, without those far too large."""
    paths = [*folder.glob("dems/*.tif"), *folder.glob("clouds/*.la[sz]")]
    small = [path for path in paths if path.stat().st_size < 2e7]
    return sorted(small, key=lambda path: path.stat().st_size)


def compare_real(folder: Path, label: str, results: Path | None) -> None:
    """Print rows of real inputs."""
    kept = json.loads(results.read_text("utf-8")) if results and results.exists() else {}
    for path in real_inputs(folder):
        key = f"{path.name}, {label}"
        if key not in kept:
            run("compiled", str(path), 0, DESIGNS[label])  # into numba's cache
            kept[key] = {
                engine: run(engine, str(path), 0, DESIGNS[label])
                for engine in ("compiled", "arrays")
            }
            if results:
                results.write_text(json.dumps(kept, indent=1) + "\n", "utf-8")
        ours, theirs = kept[key]["compiled"], kept[key]["arrays"]
        if not ours:  # above a million vertices
            continue
        same = "same" if ours["digest"] == theirs["digest"] else "DIFFER"
        print(
            f"| {path.name} | {label} | {ours['n']:,} | {ours['left']:,} | {ours['used']:.1f} | "
            f"{theirs['used']:.1f} | {theirs['used'] / ours['used']:.1f} | {same} |",
            flush=True,
        )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument("--large", action="store_true", help="a million vertices as well")
    parser.add_argument("--real", action="store_true", help="every DEM and cloud up to a million")
    parser.add_argument("--results", type=Path, help="keep figures of real inputs here")
    parser.add_argument("--design", choices=DESIGNS, default="10 %", help="of those")
    arguments = parser.parse_args()
    head = "| input | design | vertices | left | compiled, s | arrays, s | ratio | "
    head += "result |" if arguments.real else "whole process, s | bytes a vertex | result |"
    print(head + "\n" + "| --- " * (head.count("|") - 1) + "|")
    for n in () if arguments.real else (100, 500, *((1000,) if arguments.large else ())):
        for label, design in {**DESIGNS, "denoise": "denoise"}.items():
            compare("synthetic", n, label, design)
    if arguments.real:
        compare_real(arguments.data, arguments.design, arguments.results)


if __name__ == "__main__":
    main()
