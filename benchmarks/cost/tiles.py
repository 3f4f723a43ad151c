"""A cloud replicated and jittered, tiled at growing sizes: time by tiles, memory of a process.

    python benchmarks/cost/tiles.py cloud.laz folder --copies 1 4 9 --tile 600 --workers 2

Each size is n x n copies of the cloud side by side, each point moved by up to half a spacing in x
and y and by 5 cm in z, so that no two copies are alike; written as LAZ, one file a copy. Printed by
size: points, tiles, processor time of all processes and by point, elapsed time, the most memory of
one process, bytes of all files; and with ``--untiled`` the same of one process without tiles.
Processor time is that of the pieces, which the tile sets record, and of the cut.
"""

from __future__ import annotations

import argparse
import json
import math
import shutil
import sys
import time
from pathlib import Path

import laspy
import numpy as np
import psutil


def write_copy(source: Path, path: Path, row: int, column: int) -> int:
    """Write one copy of a cloud at its place, a million points at a time; return how many."""
    rng = np.random.default_rng([row, column])
    with laspy.open(source) as reader:
        header = reader.header
        size = np.ceil(header.maxs - header.mins)
        spacing = math.sqrt(size[0] * size[1] / header.point_count)
        shift = np.rint(size[:2] * (column, row) / header.scales[:2]).astype(np.int64)
        reach = (0.5 * spacing / header.scales[:2]).astype(np.int64)
        ends = np.rint([header.mins[:2], header.maxs[:2]] / header.scales[:2]).astype(np.int64)
        ends -= np.rint(header.offsets[:2] / header.scales[:2]).astype(np.int64)
        made = laspy.LasHeader(version=header.version, point_format=header.point_format)
        made.offsets, made.scales, made.vlrs = header.offsets, header.scales, header.vlrs
        with laspy.open(path, "w", header=made, do_compress=True) as writer:
            for points in reader.chunk_iterator(1_000_000):
                for k, axis in enumerate("XY"):
                    moved = points.array[axis] + rng.integers(-reach[k], reach[k] + 1, len(points))
                    points.array[axis] = np.clip(moved, ends[0, k], ends[1, k]) + shift[k]
                points.array["Z"] += rng.integers(-5, 6, len(points)).astype(np.int32)
                writer.write_points(points)
        return int(header.point_count)


def watched(command: list[str]) -> tuple[float, float, int]:
    """Run a command; return elapsed seconds, processor seconds, most bytes of one process."""
    began = time.perf_counter()
    program = psutil.Popen(command)
    seconds: dict[int, float] = {}
    most = 0
    while program.poll() is None:
        try:
            family = [program, *program.children(recursive=True)]
        except psutil.Error:
            break
        for process in family:
            try:
                times = process.cpu_times()
                most = max(most, process.memory_info().rss)
            except psutil.Error:
                continue
            seconds[process.pid] = times.user + times.system
        time.sleep(0.05)
    if program.wait() != 0:
        raise SystemExit(f"{' '.join(command)} failed")
    return time.perf_counter() - began, sum(seconds.values()), most


def main() -> None:
    """Measure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cloud", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--copies", type=int, nargs="+", default=[1, 4], help="squares")
    parser.add_argument("--tile", type=float, required=True)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--untiled", action="store_true")
    options = parser.parse_args()
    program = [sys.executable, "-m", "wavelet_gis.cli"]
    for n_copies in options.copies:
        side = math.isqrt(n_copies)
        folder = options.folder / f"copies_{n_copies}"
        shutil.rmtree(folder, ignore_errors=True)
        (folder / "in").mkdir(parents=True)
        n_points = sum(
            write_copy(options.cloud, folder / "in" / f"{row}_{column}.laz", row, column)
            for row in range(side)
            for column in range(side)
        )
        tile = ["tile", folder / "in", folder / "tiles", "--tile", options.tile, "--quiet"]
        elapsed, seconds, most = watched(
            [*program, *map(str, tile), "--workers", str(options.workers)]
        )
        records = [json.loads(p.read_text()) for p in (folder / "tiles/pieces").rglob("*.json")]
        n_bytes = sum(record.get("n_bytes", 0) for record in records)
        figures = {
            "points": n_points,
            "tiles": sum(record["stage"] == 0 for record in records),
            "pieces": len(records),
            "failed": sum(record["status"] == "failed" for record in records),
            "seconds": round(elapsed, 1),
            "processor_seconds": round(seconds, 1),
            "microseconds_a_point": round(seconds / n_points * 1e6, 1),
            "most_mb": most >> 20,
            "bytes_a_point": round(n_bytes / n_points, 1),
        }
        if options.untiled:
            whole = ["analyse", folder / "in", folder / "whole.gpkg", "--quiet", "--layers", "none"]
            elapsed, seconds, most = watched([*program, *map(str, whole)])
            figures |= {
                "untiled_seconds": round(elapsed, 1),
                "untiled_processor_seconds": round(seconds, 1),
                "untiled_mb": most >> 20,
            }
        print(json.dumps(figures), flush=True)


if __name__ == "__main__":
    main()
