"""Performance from commit to commit, as ratios to a fixed piece of work of the same run.

    python benchmarks/cost/history.py                    measure this tree, add it to history.json
    python benchmarks/cost/history.py --tree OTHER_TREE  measure another checkout
    python benchmarks/cost/history.py --picture          draw docs/images/history.png

Seconds are of the processor, all threads together; the fixed work (sorting, gathering and summing
five million doubles with numpy) runs before and after, and figures are multiples of it, so that a
slower or a busier machine changes them little. Kernels are compiled before. What a tree cannot do
is left out. It measures; it does not judge.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
RESULTS = Path(__file__).resolve().parent / "history.json"
PICTURE = ROOT / "docs" / "images" / "history.png"

WORK = r"""
import json, sys, time, warnings
warnings.simplefilter("ignore")
import numpy as np
import wavelet_core as wc

def hills(n):
    y, x = np.mgrid[:n, :n]
    noise = np.random.default_rng(1).normal(0, 0.5, (n, n))
    z = 30 * np.sin(x / 17) + 20 * np.cos(y / 23) + noise
    return wc.TriangleMesh.from_grid(z, x=10.0 * np.arange(n), y=10.0 * np.arange(n))

def fixed():
    rng = np.random.default_rng(0)
    values, places = rng.random(5_000_000), rng.integers(0, 5_000_000, 5_000_000)
    began = time.process_time()
    np.add.reduceat(np.sort(values)[places], np.arange(0, 5_000_000, 7))
    return time.process_time() - began

mesh, small, middle = hills(500), hills(200), hills(110)
WORKS = {
    "analyse, to 10 %": lambda m: wc.analyse(m, target_vertices=m.n_vertices // 10),
    "analyse, GLMN, 12 levels": lambda m: wc.analyse(m, prediction="GLMN", levels=12),
    "synthesis": lambda m: PYRAMIDS[m.n_vertices].synthesise(),
    "denoise": lambda m: wc.denoise(m, 1.0),
    "refine at 10 %": lambda m: wc.refine(
        PYRAMIDS[m.n_vertices].mesh(0), m, PYRAMIDS[m.n_vertices].vertex_ids(0), rounds=4
    ),
}
PYRAMIDS = {}
figures, kernel = {}, [fixed()]
for name, work in WORKS.items():
    full = small if name == "denoise" else mesh
    try:
        for m in (middle, full):
            if name in ("synthesis", "refine at 10 %") and m.n_vertices not in PYRAMIDS:
                PYRAMIDS[m.n_vertices] = wc.analyse(m, target_vertices=m.n_vertices // 10)
        work(middle)  # compiled
        began = time.process_time()
        work(full)
        figures[name] = time.process_time() - began
    except Exception as error:
        print(f"{name}: {type(error).__name__}: {error}", file=sys.stderr)
    kernel.append(fixed())
reference = min(kernel)
ratios = {name: seconds / reference for name, seconds in figures.items()}
print(json.dumps({"reference": reference, "ratios": ratios}))
"""


def measured(tree: Path) -> dict[str, Any]:
    """Return the entry of a checkout."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "TERRAIN_WAVELETS_ENGINE": "compiled"}
    said = subprocess.run(
        [sys.executable, "-c", WORK], cwd=tree, env=environment, stdout=subprocess.PIPE, check=True
    )
    git = ["git", "-C", str(tree), "log", "-1", "--format=%h %ci"]
    commit, when = subprocess.check_output(git, text=True).strip().split(" ", 1)
    return {"commit": commit, "when": when, **json.loads(said.stdout)}


def kept() -> list[dict[str, Any]]:
    """Return the entries so far, the oldest commit first."""
    return json.loads(RESULTS.read_text("utf-8")) if RESULTS.exists() else []


def keep(entry: dict[str, Any]) -> None:
    """Add an entry, in the place of one of the same commit."""
    entries = [other for other in kept() if other["commit"] != entry["commit"]] + [entry]
    entries.sort(key=lambda other: other["when"])
    RESULTS.parent.mkdir(exist_ok=True)
    RESULTS.write_text(json.dumps(entries, indent=1) + "\n", "utf-8")


def draw() -> None:
    """Draw one line for each piece of work, over the commits."""
    import matplotlib.pyplot as plt

    entries = kept()
    names = list(dict.fromkeys(name for entry in entries for name in entry["ratios"]))
    figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
    markers = "osD^v"
    for name, marker in zip(names, markers, strict=False):
        points = [(k, e["ratios"][name]) for k, e in enumerate(entries) if name in e["ratios"]]
        axes.plot(*zip(*points, strict=True), marker=marker, label=name)
    axes.set_xticks(
        range(len(entries)), [f"{e['commit']}\n{e['when'][:10]}" for e in entries], fontsize=8
    )
    axes.set_yscale("log")
    axes.set_ylabel("processor time, multiples of the fixed work")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    figure.savefig(PICTURE, dpi=110, metadata={"Software": None})


def main() -> None:
    """Measure or draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tree", type=Path, default=ROOT, help="a checkout, by default this one")
    parser.add_argument("--picture", action="store_true", help="draw; measure nothing")
    arguments = parser.parse_args()
    if arguments.picture:
        draw()
        return
    entry = measured(arguments.tree.resolve())
    keep(entry)
    told = ", ".join(f"{name} {ratio:.1f}" for name, ratio in entry["ratios"].items())
    print(f"{entry['commit']} of {entry['when'][:10]}: {told} (1 = {entry['reference']:.2f} s)")


if __name__ == "__main__":
    main()
