"""Where the time and the memory of `analyse` into a file go: a table of its stages.

    python benchmarks/cost/stages.py DEM_OR_CLOUD [--layers auto|all|coarse|none] [--read]

Seconds are of the processor, over all threads, and hold inner stages (indented) once more. Memory
is the resident set of the process at its largest during the stage, the libraries included. With
``--read`` the file is then read in the ways that commands do, each in a process of its own. It
measures; it does not judge.
"""

from __future__ import annotations

import argparse
import functools
import importlib
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import psutil

#: Module, function or method, and what the table calls it; two blanks more for each step inside.
STAGES = (
    ("wavelet_gis.workflows.analyse", "core_analyse", "  analysis"),
    ("wavelet_core.partition._mutable_level", "SurfaceLevel.rank", "    costs of collapses"),
    ("wavelet_core.partition._mutable_level", "SurfaceLevel.independent", "    choice"),
    ("wavelet_core.lifting.recorded", "Recorder.look", "    record: questions answered"),
    ("wavelet_core.lifting.recorded", "Recorder.took", "    record: later parts"),
    (
        "wavelet_core.partition._mutable_level",
        "SurfaceLevel.remove",
        "    collapses, points, update",
    ),
    ("wavelet_core.lifting.pyramid", "Pyramid.synthesise", "  verifying: synthesis"),
    ("wavelet_gis.model.geo_pyramid", "GeoPyramid.with_errors", "  errors of the levels"),
    ("wavelet_gis.io.pyramid.pyramid_parts", "shrink_source", "  residuals of the input"),
    ("wavelet_gis.io.pyramid.pyramid_parts", "record_of", "  record of the steps"),
    ("wavelet_gis.io.pyramid.pyramid_parts", "faces_to_parts", "  faces of the points"),
    ("wavelet_gis.io.pyramid.pyramid_file", "read_back", "  reading back"),
    ("wavelet_gis.products.layers", "pyramid_layers", "  layers"),
)

#: What is done with a file, as a user would; `{file}` is its path.
READS = {
    "info": "wg.io.pyramid.pyramid_file.read_summary({file!r})",
    "reconstruct": "wg.workflows.reconstruct.reconstruct_file({file!r})",
    "extract --level 0": "wg.extract(wg.load({file!r}, level=0))",
    "load": "wg.load({file!r})",
    "details, figures": "wg.details(wg.load({file!r})).figures()",
}


class Table:
    """Processor seconds and largest memory, by stage."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.bytes: dict[str, int] = {}
        self._open: list[str] = []
        self._process = psutil.Process()
        threading.Thread(target=self._watch, daemon=True).start()

    def _watch(self) -> None:
        while True:
            size = self._process.memory_info().rss
            for stage in list(self._open):
                self.bytes[stage] = max(self.bytes.get(stage, 0), size)
            time.sleep(0.01)

    def timed(self, stage: str, work: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function, its time and memory kept under a name."""

        @functools.wraps(work)
        def run(*arguments: Any, **options: Any) -> Any:
            self.seconds.setdefault(stage, 0.0)
            self._open.append(stage)
            start = time.process_time()
            try:
                return work(*arguments, **options)
            finally:
                self.seconds[stage] += time.process_time() - start
                self._open.pop()

        return run

    def show(self) -> None:
        """Print it."""
        print("| stage | processor, s | memory, GB |\n|---|---|---|")
        for stage, seconds in self.seconds.items():
            name = stage.replace("  ", "&nbsp;&nbsp;", stage.count("  "))
            print(f"| {name} | {seconds:.1f} | {self.bytes.get(stage, 0) / 1e9:.2f} |")


def measure(path: Path, layers: str, target: Path) -> None:
    """Analyse a file into a pyramid file, and print the table."""
    import wavelet_gis as wg

    table = Table()
    for module_name, name, stage in STAGES:
        *owners, last = name.split(".")
        owner = functools.reduce(getattr, owners, importlib.import_module(module_name))
        setattr(owner, last, table.timed(stage, getattr(owner, last)))
    started, clock = time.process_time(), time.perf_counter()
    terrain = table.timed("reading", wg.open)(path)
    analysis = table.timed("analysis and errors", wg.analyse)(terrain)
    table.timed("writing", wg.save)(analysis, target, layers=layers)
    print(
        f"{path.name}, layers {layers}: {terrain.mesh.n_vertices:,} vertices, "
        f"{time.process_time() - started:.0f} s of the processor, "
        f"{time.perf_counter() - clock:.0f} s by the clock at a load of {os.getloadavg()[0]:.1f} "
        f"on {os.cpu_count()} cores, {target.stat().st_size / 1e6:.1f} MB\n"
    )
    table.show()


def measure_reads(file: Path) -> None:
    """Print what reading the file takes in each of the ways."""
    print("\n| | processor, s | memory, GB |\n|---|---|---|")
    for name, expression in READS.items():
        code = (
            "import json, re, time, warnings; warnings.simplefilter('ignore')\n"
            "import wavelet_gis as wg, wavelet_gis.io.pyramid.pyramid_file\n"
            "import wavelet_gis.workflows.reconstruct\n"
            f"start = time.process_time(); {expression.format(file=str(file))}\n"
            "status = open('/proc/self/status').read()\n"
            "peak = 1024 * int(re.search(r'VmHWM:\\s+(\\d+)', status)[1])\n"
            "print(json.dumps([time.process_time() - start, peak]))"
        )
        run = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        )
        seconds, peak = json.loads(run.stdout)
        print(f"| {name} | {seconds:.1f} | {peak / 1e9:.2f} |", flush=True)


def main() -> None:
    """Measure one file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("path", type=Path)
    parser.add_argument("--layers", default="auto", choices=("auto", "all", "coarse", "none"))
    parser.add_argument("--read", action="store_true", help="also read the file")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "pyramid.gpkg"
        measure(arguments.path, arguments.layers, target)
        if arguments.read:
            measure_reads(target)


if __name__ == "__main__":
    main()
