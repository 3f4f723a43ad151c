"""A cloud replicated and jittered, tiled at growing sizes: time by tiles, memory of a process.

    python benchmarks/cost/tiles.py cloud.laz folder --copies 1x1 2x2 2x5 --tile 600 --workers 2

Each size is so many rows and columns of copies of the cloud side by side, each point moved by up to
half a spacing in x and y and by 5 cm in z, so that no two copies are alike; written as LAZ, a file
a copy. Printed by size: points, tiles, processor time of all processes and by point, elapsed time,
the most memory of one process, bytes of all files, the error of the last level; and with
``--untiled`` the same of one process without tiles, which makes a TIN of as many vertices of all
points at once. Processor time is that of all processes, as long as they live.
"""

from __future__ import annotations

import argparse
import json
import math
import shutil
import sys
import time
from pathlib import Path
from typing import Any, TextIO

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


def seconds_by_stage(records: list[dict[str, Any]]) -> list[float]:
    """Return the seconds by the clock that the pieces of each stage took, one after the other."""
    seconds = [0.0] * (1 + max(record["stage"] for record in records))
    for record in records:
        seconds[record["stage"]] += record["seconds"]
    return [round(of_stage, 1) for of_stage in seconds]


def watched(command: list[str], said: TextIO | None = None) -> tuple[float, float, int]:
    """Run a command; return elapsed seconds, processor seconds, most bytes of one process."""
    began = time.perf_counter()
    program = psutil.Popen(command, stdout=said)
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
    parser.add_argument("--copies", nargs="+", default=["1x1", "2x2"], help="rows x columns")
    parser.add_argument("--tile", required=True, help="as the command takes it")
    parser.add_argument("--levels", default="8")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--untiled", action="store_true")
    options = parser.parse_args()
    program = [sys.executable, "-m", "wavelet_gis.cli"]
    for copies in options.copies:
        n_rows, n_columns = map(int, copies.split("x"))
        folder = options.folder / f"copies_{copies}"
        shutil.rmtree(folder, ignore_errors=True)
        (folder / "in").mkdir(parents=True)
        n_points = sum(
            write_copy(options.cloud, folder / "in" / f"{row}_{column}.laz", row, column)
            for row in range(n_rows)
            for column in range(n_columns)
        )
        tile = ["tile", folder / "in", folder / "tiles", "--tile", options.tile, "--quiet"]
        tile += ["--levels", options.levels]
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
            "seconds_of_pieces": seconds_by_stage(records),
        }
        root = max(records, key=lambda record: record["stage"])
        figures |= {"root_vertices": root["sizes"][0], "root_rmse": root["rmse"]}
        print(json.dumps(figures), flush=True)
        if options.untiled:
            whole = ["analyse", folder / "in", folder / "whole.gpkg", "--quiet", "--layers", "none"]
            whole += ["--target-vertices", root["sizes"][0], "--json"]
            with (folder / "whole.json").open("w+") as said:
                elapsed, seconds, most = watched([*program, *map(str, whole)], said)
                said.seek(0)
                levels = json.load(said)["levels"]
            of_whole = {
                "untiled_rmse": levels[0]["rmse_surface"],
                "untiled_seconds": round(elapsed, 1),
                "untiled_processor_seconds": round(seconds, 1),
                "untiled_mb": most >> 20,
            }
            print(json.dumps(of_whole), flush=True)


if __name__ == "__main__":
    main()
