"""Algorithms at random, with random options, on real layers, for hours in one QGIS.

    QGIS_PYTHON tests/tools/random_qgis.py --data FOLDER --minutes 240 [--seed 0]

FOLDER holds DEMs and clouds (``*.tif``, ``*.las``, ``*.laz``), which are copied first, those of at
most ``--megabytes``. Each run takes an algorithm or a model of the provider, draws its parameters,
and every fifth one is cancelled at some moment. After it its outputs are deleted. What must not be:
a crash, a traceback, a cancel that takes longer than two seconds, a file that stays in the
temporary folder or beside the outputs, memory that grows after the first quarter. One line a run
goes to the log; the table at the end tells what was seen.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import gc
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

#: Seconds in which a cancel must be answered.
PATIENCE = 2.0
#: Seconds in which work that was cancelled must have stopped and cleaned up behind the scenes.
STOPS_WITHIN = 30.0
#: Megabytes by which the memory may grow after warm-up, in parts of what it was.
GROWTH = 0.05

#: Bounds of numbers, by the name of the parameter; others are drawn from their own bounds.
RANGES = {
    "LEVELS": (1, 12),
    "LEVEL": (0, 6),
    "LESS_LEVEL": (0, 6),
    "FIRST_LEVEL": (0, 4),
    "LAST_LEVEL": (2, 8),
    "VERTICES": (50, 5000),
    "VERTICES_WANTED": (500, 5000),
    "MAX_ERROR": (0.5, 30.0),
    "RMSE": (0.5, 20.0),
    "INTERVAL": (5.0, 100.0),
    "STEP": (5.0, 200.0),
    "CELL_SIZE": (0.0, 0.0),  # degrees and metres are both among the layers
    "PYRAMIDS": (0, 2),
    "REFINE": (0, 2),
    "COUNT": (2, 6),
    "MAX_EDGE": (0.0, 50.0),
    "OUTLINE_TOLERANCE": (0.0, 5.0),
    "SMALLEST_SIZE": (20.0, 200.0),
    "LARGEST_SIZE": (200.0, 2000.0),
    "SIZE": (20.0, 200.0),
    "BASE": (-5.0, 5.0),
    "MIN_ANGLE": (0.0, 25.0),
}
#: Words that parameters of text are drawn from.
WORDS = {"LEVELS": ["", "0", "0,1", "0,1,2", "x"], "CLASSES": ["", "2", "2,9", "1,2,5", "no"]}


def resident() -> float:
    """Return the memory of this process in megabytes, once malloc has given back what is free.

    It keeps what large arrays leave, and takes it again for others of the same size: no leak, and
    of inputs of many sizes no steady state either.
    """
    with contextlib.suppress(OSError, AttributeError):  # the GNU C library alone has it
        ctypes.CDLL(None).malloc_trim(0)
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


class Bench:
    """A QGIS with layers, and the pyramids that were made so far."""

    def __init__(self, folder: Path, seed: int) -> None:
        from qgis.core import QgsApplication, QgsProcessingUtils, QgsProject

        self.folder, self.draw = folder, random.Random(seed)
        self.dems = sorted(map(str, (folder / "data").glob("*.tif")))
        clouds = [*(folder / "data").glob("*.las"), *(folder / "data").glob("*.laz")]
        self.clouds = sorted(map(str, clouds))
        self.pyramids: list[str] = []
        self.tiles: list[str] = []
        registry = QgsApplication.processingRegistry()
        provider = registry.providerById("terrainwavelets")
        self.algorithms = sorted(a.name() for a in provider.algorithms())
        self.registry = registry
        self.temporary = Path(QgsProcessingUtils.tempFolder())
        self.project = QgsProject.instance()
        #: How often a parameter leaves its default; where all do, options contradict one another.
        self.boldness = 0.25

    def raster(self):
        from qgis.core import QgsRasterLayer

        path = self.draw.choice(self.dems)
        return QgsRasterLayer(path, Path(path).stem)

    def vector(self, kinds):
        """Return a layer of random lines, polygons or points over a random DEM."""
        from qgis.core import QgsFeature, QgsGeometry, QgsVectorLayer, QgsWkbTypes

        over = self.raster()
        box, crs = over.extent(), over.crs()
        is_line = any("Line" in kind for kind in kinds)
        is_area = any("Polygon" in kind for kind in kinds)
        word = "LineString" if is_line else "Polygon" if is_area else "PointZ"
        layer = QgsVectorLayer(f"{word}?field=class:integer&field=limit:double", "drawn", "memory")
        layer.setCrs(crs)

        def place():
            x = box.xMinimum() + self.draw.uniform(0.1, 0.9) * box.width()
            y = box.yMinimum() + self.draw.uniform(0.1, 0.9) * box.height()
            return x, y

        features = []
        for k in range(300 if word == "PointZ" else self.draw.randint(1, 4)):
            feature = QgsFeature(layer.fields())
            if word == "PointZ":
                x, y = place()
                text = f"PointZ ({x} {y} {self.draw.uniform(0, 100)})"
            elif word == "LineString":
                corners = ", ".join(f"{x} {y}" for x, y in (place() for _ in range(3)))
                text = f"LineString ({corners})"
            else:
                (a, b), (c, d) = place(), place()
                text = f"Polygon (({a} {b}, {c} {b}, {c} {d}, {a} {d}, {a} {b}))"
            feature.setGeometry(QgsGeometry.fromWkt(text))
            feature.setAttributes([k % 3, self.draw.uniform(0.5, 20)])
            features.append(feature)
        layer.dataProvider().addFeatures(features)
        assert QgsWkbTypes.isSingleType(layer.wkbType())
        return layer

    def value(self, parameter, name: str):
        """Return a random value for a parameter; None leaves it open."""
        kind, draw = parameter.type(), self.draw
        is_optional = bool(parameter.flags() & parameter.Flag.FlagOptional)
        if is_optional and draw.random() < 0.8:
            return None
        if parameter.defaultValue() is not None and draw.random() >= self.boldness:
            return parameter.defaultValue()
        if kind == "file":
            files = self.clouds if "cloud" in name else self.pyramids
            files = self.tiles if "tiles" in name else files
            return draw.choice(files) if files else None
        if kind == "raster":
            return self.raster()
        if kind in ("source", "vector"):
            types = [str(t) for t in parameter.dataTypes()]
            names = {"1": "Line", "2": "Polygon", "0": "Point"}
            return self.vector([names.get(t, t) for t in types])
        if kind == "number":
            low, high = RANGES.get(
                parameter.name(), (max(parameter.minimum(), 0.0), min(parameter.maximum(), 10.0))
            )
            if low == high:
                return None if is_optional else parameter.defaultValue()
            is_whole = parameter.dataType() == parameter.Type.Integer
            return draw.randint(int(low), int(high)) if is_whole else draw.uniform(low, high)
        if kind == "boolean":
            return draw.random() < 0.5
        if kind == "enum":
            options = parameter.options()
            if parameter.allowMultiple():
                return draw.sample(options, draw.randint(0, min(2, len(options))))
            return draw.choice(options) if parameter.usesStaticStrings() else 0
        if kind == "string":
            return draw.choice(WORDS.get(parameter.name(), [""]))
        if kind == "matrix":
            return [draw.randint(0, 3), draw.uniform(0, 2)]
        if kind == "field":
            return draw.choice(["class", "limit"])
        return parameter.defaultValue()

    def parameters(self, algorithm, outputs: Path):
        """Return random parameters of an algorithm, with outputs in a folder."""
        found = {}
        for parameter in algorithm.parameterDefinitions():
            if not parameter.isDestination():
                value = self.value(parameter, algorithm.name())
                if value is not None:
                    found[parameter.name()] = value
                continue
            is_optional = bool(parameter.flags() & parameter.Flag.FlagOptional)
            if is_optional and self.draw.random() < 0.4:
                continue
            kinds = {"sink": ".gpkg", "rasterDestination": ".tif", "folderDestination": ""}
            suffix = kinds.get(parameter.type())
            if suffix is None:
                filters = parameter.fileFilter().split(";;")
                suffix = "." + self.draw.choice(filters).split("*.")[1].split(")")[0].split(" ")[0]
            where = str(outputs / f"{parameter.name()}{suffix}")
            is_temporary = self.draw.random() < 0.3
            found[parameter.name()] = "TEMPORARY_OUTPUT" if is_temporary else where
        if algorithm.name() == "tileterrain":
            found.update(self.tiles_input())
        return found

    def tiles_input(self):
        """Return DEMs or clouds for tiles, whose sides are such that there are some dozens."""
        if self.draw.random() < 0.5:
            return {"RASTERS": [self.draw.choice(self.dems)], "TILE": self.draw.randint(150, 400)}
        beside = [path for path in self.clouds if "_tiles_" in path]  # files of one survey
        clouds = beside if beside and self.draw.random() < 0.3 else [self.draw.choice(self.clouds)]
        return {"CLOUDS": clouds}

    def run(self, number: int):
        """Run one algorithm and return what was seen."""
        from qgis.core import (
            QgsApplication,
            QgsProcessingContext,
            QgsProcessingFeedback,
            QgsProcessingModelAlgorithm,
        )

        name = "tileterrain" if not self.tiles else self.draw.choice(self.algorithms)
        name = "analysedem" if len(self.pyramids) < 2 else name
        algorithm = self.registry.algorithmById(f"terrainwavelets:{name}").create()
        outputs = Path(tempfile.mkdtemp(dir=self.folder, prefix="out"))
        self.boldness = self.draw.choice([0.03, 0.25])
        parameters = self.parameters(algorithm, outputs)
        told = []

        class Log(QgsProcessingFeedback):
            def reportError(self, error, fatalError=False):
                told.append(error)

            def pushWarning(self, warning):
                pass

        context, log = QgsProcessingContext(), Log(False)
        context.setProject(self.project)
        shown = {
            k: v if isinstance(v, (str, int, float, list)) else str(v)
            for k, v in parameters.items()
        }
        print(f"{number} {name} {json.dumps(shown)}", flush=True)
        before = {path.name for path in self.temporary.iterdir()}
        cancelled = []
        timer = None
        if self.draw.random() < 0.2 and len(self.pyramids) >= 2:

            def cancel(log=log):
                cancelled.append(time.perf_counter())
                log.cancel()

            timer = threading.Timer(self.draw.uniform(0.05, 6.0), cancel)
            timer.start()
        outcome, why = "done", ""
        results = {}
        began = time.perf_counter()
        try:
            is_fine, message = algorithm.checkParameterValues(parameters, context)
            if is_fine:
                results, is_done = algorithm.run(parameters, context, log)
                if not is_done:
                    outcome, why = "refused", " ".join(told)
            else:
                outcome, why = "refused", message
        except Exception as error:
            outcome, why = "refused", f"{type(error).__name__} {error} {' '.join(told)}"
        ended = time.perf_counter()
        if timer is not None:
            timer.cancel()
        answer = None
        if cancelled and cancelled[0] < ended:
            outcome, answer = "cancelled", ended - cancelled[0]
        if "Traceback" in why or "Error " in why.split(" ")[0]:
            outcome = "traceback"
        if outcome == "done" and name == "analysedem" and len(self.pyramids) < 6:
            kept = self.folder / f"pyramid{len(self.pyramids)}.gpkg"
            made = results.get("OUTPUT")
            if made and os.path.isfile(made):
                shutil.copy(made, kept)
                self.pyramids.append(str(kept))
        if outcome == "done" and name == "tileterrain" and len(self.tiles) < 4:
            kept = self.folder / f"tiles{len(self.tiles)}"
            shutil.copytree(results["OUTPUT"], kept)
            self.tiles.append(str(kept / "index.gpkg"))
        is_model = isinstance(algorithm, QgsProcessingModelAlgorithm)
        self.project.clear()
        del results, context, log, algorithm
        gc.collect()
        QgsApplication.processEvents()  # connections to files are closed by timers, a minute later
        for thread in threading.enumerate():  # work that was left alone still stops and cleans up
            if thread.daemon:
                thread.join(STOPS_WITHIN)
        known = {os.path.basename(str(v)).split(".")[0] for v in parameters.values()}
        strays = [
            path.name
            for path in outputs.iterdir()
            if path.name.split(".")[0] not in known and not path.name.endswith(".aux.xml")
        ]
        # nothing half written; tiles are resumed, and of models QGIS keeps the steps that are done
        if outcome != "done" and name != "tileterrain" and not is_model:
            strays += [path.name for path in outputs.rglob("*") if path.is_file()]
        strays += [
            path.name
            for path in self.temporary.parent.glob("*terrain-wavelets*")
            if path != self.folder and path.stat().st_mtime > self.started
        ]
        for path in self.temporary.iterdir():  # QGIS's own, of temporary outputs
            if path.name not in before:
                shutil.rmtree(path, ignore_errors=True)
        shutil.rmtree(outputs, ignore_errors=True)
        return {
            "number": number,
            "name": name,
            "outcome": outcome,
            "why": " ".join(why.split())[:300],
            "seconds": round(ended - began, 2),
            "answer": answer and round(answer, 2),
            "strays": sorted(set(strays)),
            "megabytes": round(resident()),
        }

    started = 0.0


def child(folder: Path, seed: int, until: float, first: int) -> None:
    """Run in this process until a time, one line of JSON a run into the log."""
    from qgis.core import QgsApplication

    application = QgsApplication([], True)
    application.initQgis()
    sys.path += [
        os.path.join(QgsApplication.pkgDataPath(), "python", "plugins"),
        str(folder / "plugins"),
    ]
    import qgis.utils
    from processing.core.Processing import Processing

    Processing.initialize()
    qgis.utils.plugin_paths.append(str(folder / "plugins"))
    qgis.utils.updateAvailablePlugins()
    assert qgis.utils.loadPlugin("terrain_wavelets")
    assert qgis.utils.startProcessingPlugin("terrain_wavelets")
    bench = Bench(folder, seed)
    bench.started = time.time()
    number = first
    with open(folder / "log.jsonl", "a", encoding="utf-8") as log:
        while time.time() < until:
            seen = bench.run(number)
            log.write(json.dumps(seen) + "\n")
            log.flush()
            number += 1
    os._exit(0)  # QGIS crashes at exit while Python holds layers


def table(rows: list[dict]) -> None:
    """Print what was seen."""
    names = sorted({row["name"] for row in rows})
    print("| algorithm | runs | done | refused | cancelled | slowest answer, s |")
    print("| --- " * 6 + "|")
    for name in names:
        own = [row for row in rows if row["name"] == name]
        count = Counter(row["outcome"] for row in own)
        slowest = max((row["answer"] for row in own if row["answer"]), default=0.0)
        print(
            f"| {name} | {len(own)} | {count['done']} | {count['refused']} | {count['cancelled']} "
            f"| {slowest or ''} |"
        )
    for row in rows:
        if row["outcome"] == "traceback" or row["strays"] or (row["answer"] or 0) > PATIENCE:
            print(json.dumps(row))
    quarter = len(rows) // 4
    if quarter >= 4:
        # of each quarter the least: what large inputs take comes and goes
        parts = [rows[k * quarter : (k + 1) * quarter] for k in range(4)]
        least = [min(row["megabytes"] for row in part) for part in parts]
        print("least memory of each quarter, MB:", *least)
        print(
            f"growth after the first quarter: {least[-1] / least[1] - 1:+.1%} (limit {GROWTH:.0%})"
        )
    refusals = Counter((row["name"], row["why"]) for row in rows if row["outcome"] == "refused")
    for (name, why), n in sorted(refusals.items()):
        print(f"{n} {name}: {why}")


def main() -> None:
    """Start QGIS, and again where it dies, until the time is over."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True, action="append")
    parser.add_argument("--minutes", type=float, default=240.0)
    parser.add_argument("--megabytes", type=float, default=1.5, help="largest file that is taken")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="random-qgis-"))
    (folder / "run").mkdir(mode=0o700)
    for name in ("data", "plugins", "profile", "temporary"):
        (folder / name).mkdir()
    for source in options.data:
        for path in sorted(source.glob("*.[tl]*")):
            is_wanted = path.suffix in (".tif", ".las", ".laz")
            if is_wanted and path.stat().st_size < options.megabytes * 1e6:
                (folder / "data" / path.name).write_bytes(path.read_bytes())
    if not list((folder / "data").glob("*.tif")) or not list((folder / "data").glob("*.la[sz]")):
        parser.error(
            "--data: DEMs and clouds of at most --megabytes are both needed; name their folders"
        )
    (folder / "plugins" / "terrain_wavelets").symlink_to(ROOT, target_is_directory=True)
    environment = {
        **os.environ,
        "QT_QPA_PLATFORM": "offscreen",
        "XDG_RUNTIME_DIR": str(folder / "run"),
        "QGIS_CUSTOM_CONFIG_PATH": str(folder / "profile"),
        "TMPDIR": str(folder / "temporary"),
        "LC_ALL": "C.UTF-8",
        "PYTHONFAULTHANDLER": "1",
        "GDAL_CACHEMAX": "64",  # megabytes; else blocks of rasters fill a twentieth of the memory
    }
    environment.pop("PYTHONPATH", None)
    until, log, deaths = time.time() + 60 * options.minutes, folder / "log.jsonl", []
    print(folder, flush=True)
    while time.time() < until:
        n_done = len(log.read_text().splitlines()) if log.exists() else 0
        done = subprocess.run(
            [
                sys.executable,
                __file__,
                "--child",
                folder,
                str(options.seed + n_done),
                str(until),
                str(n_done),
            ],
            env=environment,
            check=False,
        )
        if done.returncode != 0:
            why = signal.Signals(-done.returncode).name if done.returncode < 0 else done.returncode
            deaths.append(f"after run {n_done}: {why}")
            print("DIED", deaths[-1], flush=True)
            if len(deaths) > 20:
                break
    table([json.loads(line) for line in log.read_text().splitlines()])
    print(f"QGIS died {len(deaths)} times", *deaths, sep="\n")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        child(Path(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4]), int(sys.argv[5]))
    main()
