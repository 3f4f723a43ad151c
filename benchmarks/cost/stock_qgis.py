"""What every algorithm does in a QGIS without further Python packages: time, memory, response.

    QGIS_PYTHON benchmarks/cost/stock_qgis.py [--packages stock|all] [--only WORD,WORD] [--cancel]
        [--page FILE]

Run it with the Python of QGIS; the plugin is the zip of the last commit. Each case is a process of
its own in which packages that QGIS does not bring are hidden; its input is synthetic terrain of
1,000 x 1,000 cells, or 500,000 points. Seconds are those of the processor, so that other work on
the machine does not count. ``bar`` is the longest time in which the progress bar showed nothing
new, which is a tenth of a percent or another line above it; ``cancel`` the longest without a look
at the cancel button; both of the processor or by the clock, whichever says less. With ``--cancel``
each case is run again and cancelled where it had looked away for longest, and how long it took to
end is said.
``--page docs/howto/qgis.md`` puts the rows into the table there.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import time
import zipfile
from importlib.machinery import PathFinder
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]

#: Modules that QGIS does not bring.
EXTRA = (
    "numba",
    "llvmlite",
    "pythoncdt",
    "laspy",
    "lazrs",
    "laszip",
    "sklearn",
    "trimesh",
    "ezdxf",
    "CGAL",
    "shapely",
)

#: Percent of which `QgsFeedback.setProgress` shows nothing: less is no news.
STEP_OF_BAR = 0.1

#: Name of the case: algorithm, parameters. Words in braces are files that `prepare` has made.
CASES: dict[str, tuple[str, dict[str, object]]] = {
    "Analyse DEM": (
        "analysedem",
        {"INPUT": "{dem}", "OUTPUT": "{out}.gpkg", "COARSE_TIN": "memory:"},
    ),
    "Analyse DEM, the paper's GLMN": (
        "analysedem",
        {
            "INPUT": "{dem}",
            "OUTPUT": "{out}.gpkg",
            "LEVELS": 12,
            "PARTITION": "quadric",
            "PREDICTION": "geometric",
            "UPDATE": "minimum_norm",
        },
    ),
    "Simplify DEM to TIN": ("simplifydem", {"INPUT": "{dem}", "TIN": "memory:"}),
    "Simplify DEM to TIN, no refinement": (
        "simplifydem",
        {"INPUT": "{dem}", "REFINE": 0, "TIN": "memory:"},
    ),
    "The same, largest error 0.5": (
        "simplifydem",
        {
            "INPUT": "{dem}",
            "MAX_ERROR": 0.5,
            "REFINE": 0,
            "RASTER": "{out}.tif",
            "MESH": "{out}.2dm",
        },
    ),
    "Simplify DEM to TIN, tolerance by place": (
        "simplifydem",
        {
            "INPUT": "{dem}",
            "MAX_ERROR": 2.0,
            "ZONES": "{training}",
            "ZONE_FIELD": "class",
            "REFINE": 0,
            "TIN": "memory:",
        },
    ),
    "Simplify DEM to TIN, mesh for a solver": (
        "simplifydem",
        {"INPUT": "{dem}", "REFINE": 0, "MIN_ANGLE": 25.0, "MESH": "{out}.2dm"},
    ),
    "Analyse point cloud, LAS": ("analysepointcloud", {"INPUT": "{las}", "OUTPUT": "{out}.gpkg"}),
    "Analyse point cloud, LAZ": ("analysepointcloud", {"INPUT": "{laz}", "OUTPUT": "{out}.gpkg"}),
    "Analyse points": ("analysetin", {"INPUT": "{points}", "OUTPUT": "{out}.gpkg"}),
    "Analyse points with breaklines": (
        "analysetin",
        {"INPUT": "{points}", "BREAKLINES": "{lines}", "CLIP": "{area}", "OUTPUT": "{out}.gpkg"},
    ),
    "Simplify point cloud to TIN": (
        "simplifypointcloud",
        {"INPUT": "{las}", "REFINE": 0, "TIN": "memory:"},
    ),
    "Thin point cloud": (
        "thinpointcloud",
        {"INPUT": "{las}", "MAX_ERROR": 0.5, "THINNED": "{out}.las"},
    ),
    "Classify ground": ("classifyground", {"INPUT": "{las}", "OUTPUT": "{out}.las"}),
    "Contours of level": (
        "contours",
        {"INPUT": "{pyramid}", "INTERVAL": 2.0, "OUTPUT": "memory:"},
    ),
    "Profile along lines": (
        "profile",
        {"INPUT": "{pyramid}", "LINES": "{lines}", "OUTPUT": "memory:", "PLOT": "{out}.html"},
    ),
    "Slope, aspect and curvature of level": (
        "shapeoflevel",
        {"INPUT": "{pyramid}", "LEVEL": 8, "SLOPE": "{out}.tif", "ASPECT": "{out}_a.tif"},
    ),
    "Difference of level and DEM": (
        "difference",
        {"INPUT": "{pyramid}", "LEVEL": 4, "LESS_DEM": "{dem}", "OUTPUT": "{out}.tif"},
    ),
    "Change by scale": (
        "changebyscale",
        {"INPUT": "{pyramid}", "EARLIER": "{dem}", "OUTPUT": "{out}.tif"},
    ),
    "Mesh quality": ("meshquality", {"INPUT": "{pyramid}", "OUTPUT": "memory:"}),
    "Extract level": (
        "extractlevel",
        {
            "INPUT": "{pyramid}",
            "LEVEL": 0,
            "TIN": "memory:",
            "VERTICES": "memory:",
            "RASTER": "{out}.tif",
            "MESH": "{out}.2dm",
        },
    ),
    "Extract level by largest error": (
        "extractlevel",
        {"INPUT": "{pyramid}", "LEVEL": None, "MAX_ERROR": 1.0, "TIN": "memory:"},
    ),
    "Extract level as GLB": (
        "extractlevel",
        {"INPUT": "{pyramid}", "LEVEL": 0, "MESH": "{out}.glb"},
    ),
    "Extract level as DXF": (
        "extractlevel",
        {"INPUT": "{pyramid}", "LEVEL": 0, "MESH": "{out}.dxf"},
    ),
    "Reconstruct DEM": ("reconstruct", {"INPUT": "{pyramid}", "DEM": "{out}.tif"}),
    "Reconstruct LAS": ("reconstruct", {"INPUT": "{cloud}", "POINT_CLOUD": "{out}.las"}),
    "Reconstruct LAZ": ("reconstruct", {"INPUT": "{cloud}", "POINT_CLOUD": "{out}.laz"}),
    "Terrain for the web": ("webterrain", {"INPUT": "{pyramid}", "OUTPUT": "{out}_tiles"}),
    "Tile DEM": ("tileterrain", {"RASTERS": "{dem}", "TILE": 500, "OUTPUT": "{out}_set"}),
    "Tile point cloud, LAS": (
        "tileterrain",
        {"CLOUDS": "{las}", "TILE": 500.0, "OUTPUT": "{out}_set"},
    ),
    "Extract from tiles": (
        "extractfromtiles",
        {"INPUT": "{tiles}/index.gpkg", "LEVEL": 20, "TIN": "memory:", "RASTER": "{out}.tif"},
    ),
    "Extract from tiles by largest error": (
        "extractfromtiles",
        {"INPUT": "{tiles}/index.gpkg", "MAX_ERROR": 0.5, "TIN": "memory:"},
    ),
    "Filter levels by gains": (
        "filterlevels",
        {"INPUT": "{pyramid}", "GAINS": [3, 0.0], "DEM": "{out}.tif", "DIFFERENCE": "{out}_d.tif"},
    ),
    "Filter levels by size": (
        "filterlevels",
        {"INPUT": "{pyramid}", "SMALLEST_SIZE": 20.0, "DEM": "{out}.tif"},
    ),
    "Filter levels, noise removed": (
        "filterlevels",
        {"INPUT": "{pyramid}", "DENOISE": True, "DEM": "{out}.tif"},
    ),
    "Detail layers": (
        "detaillayers",
        {"INPUT": "{pyramid}", "OUTPUT": "memory:", "ENERGY": "{out}.tif"},
    ),
    "Cluster details": (
        "clusterdetails",
        {"INPUT": "{pyramid}", "RASTER": "{out}.tif", "OUTPUT": "memory:"},
    ),
    "Cluster details, classes learned": (
        "clusterdetails",
        {
            "INPUT": "{pyramid}",
            "LEARN_FROM": "training areas",
            "TRAINING": "{training}",
            "CLASS_FIELD": "class",
            "RASTER": "{out}.tif",
        },
    ),
    "Quality report": ("qualityreport", {"INPUT": "{pyramid}", "OUTPUT": "{out}.html"}),
}

#: What is in no case, and why.
LEFT_OUT = dict.fromkeys(
    (
        "dem_to_coarse_tin",
        "dem_to_denoised_dem",
        "dem_to_hydraulic_mesh",
        "dem_to_landform_clusters",
        "dem_to_simplified_cog",
        "dems_to_change_by_scale",
        "point_cloud_to_contours",
        "point_cloud_to_dem",
    ),
    "a model; its steps are algorithms of these cases, and of QGIS",
)

HEAD = "| Algorithm | time, s | memory, MB | bar, s | cancel, s |\n" + "| --- " * 5 + "|\n"

#: Files of the inputs.
NAMES = {
    "dem": "dem.tif",
    "las": "cloud.las",
    "laz": "cloud.laz",
    "points": "points.gpkg",
    "lines": "lines.gpkg",
    "area": "area.gpkg",
    "training": "training.gpkg",
    "pyramid": "pyramid.gpkg",
    "cloud": "cloud_pyramid.gpkg",
    "tiles": "tiles",
}
#: Run first, with all packages, to make the inputs of the others.
INPUTS: dict[str, tuple[str, dict[str, object]]] = {
    "pyramid": ("analysedem", {"INPUT": "{dem}", "OUTPUT": "{pyramid}"}),
    "cloud": ("analysepointcloud", {"INPUT": "{las}", "OUTPUT": "{cloud}"}),
    "laz": ("reconstruct", {"INPUT": "{cloud}", "POINT_CLOUD": "{laz}"}),
    "tiles": ("tileterrain", {"OUTPUT": "{tiles}", "RASTERS": "{dem}", "TILE": 500}),
}


def terrain(x, y):
    """Return heights of hills with gullies and a little noise."""
    noise = np.random.default_rng(1).normal(0, 0.1, np.shape(x))
    return 300 + 40 * np.sin(x / 90) * np.cos(y / 130) + 4 * np.sin(x / 11 + y / 17) + noise


def write_las(path: Path, xyz) -> None:
    """Write points as LAS 1.2, without any library."""
    offsets, scale = np.floor(xyz.min(axis=0)), 0.001
    records = np.zeros(
        len(xyz),
        [("xyz", "<i4", 3), ("intensity", "<u2"), ("flags", "u1"), ("class", "u1"), ("rest", "V4")],
    )
    records["xyz"] = np.round((xyz - offsets) / scale)
    records["flags"], records["class"] = 0b1001, 2
    low, high = (records["xyz"].min(axis=0), records["xyz"].max(axis=0))
    low, high = low * scale + offsets, high * scale + offsets
    head = struct.pack(
        "<4sHH16sBB32s32sHHHIIBHI",
        b"LASF",
        0,
        1,
        b"",
        1,
        2,
        b"benchmark",
        b"benchmark",
        1,
        2026,
        227,
        227,
        0,
        0,
        20,
        len(xyz),
    )
    head += struct.pack("<5I", len(xyz), 0, 0, 0, 0)
    head += struct.pack("<3d", *[scale] * 3) + struct.pack("<3d", *offsets)
    head += struct.pack("<6d", *np.column_stack([high, low]).ravel())
    path.write_bytes(head + records.tobytes())


def prepare(folder: Path, n: int) -> dict[str, str]:
    """Write the inputs, those that are not there yet, and return their paths."""
    from osgeo import gdal, ogr, osr

    gdal.UseExceptions()
    files = {name: folder / file for name, file in NAMES.items()}
    system = osr.SpatialReference()
    system.ImportFromEPSG(25832)
    corner = np.array([500_000.0, 5_400_000.0])
    if not files["dem"].exists():
        y, x = np.mgrid[:n, :n].astype(float)
        dataset = gdal.GetDriverByName("GTiff").Create(str(files["dem"]), n, n, 1, gdal.GDT_Float32)
        dataset.SetGeoTransform((corner[0], 1.0, 0.0, corner[1] + n, 0.0, -1.0))
        dataset.SetProjection(system.ExportToWkt())
        dataset.GetRasterBand(1).WriteRaster(0, 0, n, n, terrain(x, y).astype("<f4").tobytes())
        dataset = None
    plan = np.random.default_rng(2).uniform(0, n, (n * n // 2, 2))
    xyz = np.column_stack([plan + corner, terrain(*plan.T)])
    if not files["las"].exists():
        write_las(files["las"], xyz)

    def write(name: str, kind: int, wkbs, values=None) -> None:
        if files[name].exists():
            return
        source = ogr.GetDriverByName("GPKG").CreateDataSource(str(files[name]))
        layer = source.CreateLayer(name, system, kind)
        layer.CreateField(ogr.FieldDefn("class", ogr.OFTInteger))
        source.StartTransaction()
        for k, wkb in enumerate(wkbs):
            feature = ogr.Feature(layer.GetLayerDefn())
            feature.SetGeometry(ogr.CreateGeometryFromWkb(wkb))
            feature.SetField("class", 0 if values is None else values[k])
            layer.CreateFeature(feature)
        source.CommitTransaction()
        source = None

    write("points", ogr.wkbPoint25D, (struct.pack("<BI3d", 1, 1001, *p) for p in xyz.tolist()))
    at = np.linspace(0.1 * n, 0.9 * n, 40)
    lines = [
        np.column_stack([at, 0.5 * n + 30 * np.sin(at / 50 + k) + 40 * k]) + corner
        for k in range(5)
    ]
    write(
        "lines",
        ogr.wkbLineString,
        (struct.pack(f"<BII{2 * len(line)}d", 1, 2, len(line), *line.ravel()) for line in lines),
    )

    def square(x: float, y: float, size: float) -> bytes:
        ring = (
            np.array([[x, y], [x + size, y], [x + size, y + size], [x, y + size], [x, y]]) + corner
        )
        return struct.pack("<BIII10d", 1, 3, 1, 5, *ring.ravel())

    write("area", ogr.wkbPolygon, [square(0.05 * n, 0.05 * n, 0.9 * n)])
    places = [(0.1, 0.1), (0.6, 0.2), (0.2, 0.6), (0.7, 0.7), (0.4, 0.4), (0.8, 0.4)]
    squares = [square(x * n, y * n, 0.12 * n) for x, y in places]
    write("training", ogr.wkbPolygon, squares, [1, 2, 1, 2, 1, 2])
    return {name: str(path) for name, path in files.items()}


def hide_packages() -> None:
    """Let no package be found that QGIS does not bring; the plugin's own copies are."""
    installed = PathFinder.find_spec

    def find_spec(name, path=None, target=None):
        is_hidden = name in EXTRA and "vendored" not in str(path)
        return None if is_hidden else installed(name, path, target)

    PathFinder.find_spec = find_spec


def start_qgis(plugins: Path):
    """Start QGIS with the plugin; return the application, which has to be kept."""
    from qgis.core import QgsApplication

    application = QgsApplication([], False)
    application.initQgis()
    sys.path += [os.path.join(QgsApplication.pkgDataPath(), "python", "plugins"), str(plugins)]
    import qgis.utils

    qgis.utils.plugin_paths.append(str(plugins))
    qgis.utils.updateAvailablePlugins()
    assert qgis.utils.loadPlugin("terrain_wavelets")
    assert qgis.utils.startProcessingPlugin("terrain_wavelets")
    return application


def both_times() -> tuple[float, float]:
    """Return seconds of the processor and of the clock.

    Between two moments the lesser of both is as long as a user waits on an idle machine, or longer:
    other programs hold up the clock, and the processor's time is summed over threads.
    """
    return time.process_time(), time.perf_counter()


def new_watch():
    """Return a feedback that notes when the bar moves and when the cancel button is looked at."""
    from qgis.core import QgsProcessingFeedback

    class Watch(QgsProcessingFeedback):
        def __init__(self) -> None:
            super().__init__(False)
            now = both_times()
            self.began, self.moved, self.asked, self.shown = now[0], now, now, -1.0
            self.stage, self.errors = "the start", []
            self.longest = {"moves": (0.0, 0.0, ""), "asks": (0.0, 0.0, "")}

        def gap(self, kind: str, since: tuple[float, float]) -> tuple[float, float]:
            now = both_times()
            waited = min(now[0] - since[0], now[1] - since[1])
            self.longest[kind] = max(
                self.longest[kind], (waited, since[0] - self.began, self.stage)
            )
            return now

        def setProgress(self, percent: float) -> None:
            if abs(percent - self.shown) >= STEP_OF_BAR:
                self.shown = percent
                self.moved = self.gap("moves", self.moved)
            super().setProgress(percent)

        def setProgressText(self, text: str) -> None:
            self.moved = self.gap("moves", self.moved)
            self.stage = text

        def isCanceled(self) -> bool:
            self.asked = self.gap("asks", self.asked)
            return super().isCanceled()

        def reportError(self, error: str, fatalError: bool = False) -> None:
            self.errors.append(error)

        def pushWarning(self, warning: str) -> None:
            pass

    return Watch()


def cancel_after(watch, seconds: float) -> list[float]:
    """Cancel after so many seconds of the processor; return a list that gets the time of it."""
    cancelled: list[float] = []

    def cancel() -> None:
        while time.process_time() - watch.began < seconds:
            time.sleep(0.01)
        cancelled.append(time.process_time())
        watch.cancel()

    if seconds > 0:
        threading.Thread(target=cancel, daemon=True).start()
    return cancelled


def child(arguments: list[str]) -> None:
    """Run one case in this process and print what was seen as JSON."""
    folder, case, packages, cancel_at, n = arguments
    if packages == "stock":
        hide_packages()
    application = start_qgis(Path(folder) / "plugins")
    from qgis.core import QgsProcessingContext

    files = prepare(Path(folder), int(n))
    files["out"] = str(Path(tempfile.mkdtemp(dir=folder)) / "out")
    name, parameters = {**CASES, **INPUTS}[case]
    filled = {
        key: value.format(**files) if isinstance(value, str) else value
        for key, value in parameters.items()
    }
    registry = application.processingRegistry()
    algorithm = registry.algorithmById(f"terrainwavelets:{name}").create()
    context, watch = QgsProcessingContext(), new_watch()
    cancelled = cancel_after(watch, float(cancel_at))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    is_fine, why = algorithm.checkParameterValues(filled, context)
    done = False
    if is_fine:
        try:
            _, done = algorithm.run(filled, context, watch)
        except Exception as error:
            watch.errors.append(str(error))
    ended = time.process_time()
    if not cancelled:
        watch.gap("moves", watch.moved)
        watch.gap("asks", watch.asked)
    print(
        "RESULT"
        + json.dumps(
            {
                "seconds": ended - watch.began,
                "megabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
                "before": before / 1024,
                "refused": "" if done else why or " ".join(watch.errors) or "no reason given",
                "stops": ended - cancelled[0] if cancelled else None,
                **watch.longest,
            }
        ),
        flush=True,
    )
    os._exit(0)  # QGIS crashes at exit while Python holds layers


def run(folder: Path, case: str, packages: str, cancel_at: float, n: int) -> dict:
    """Run one case in a process of its own."""
    environment = {
        **os.environ,
        "QT_QPA_PLATFORM": "offscreen",
        "XDG_RUNTIME_DIR": str(folder / "run"),
        "QGIS_CUSTOM_CONFIG_PATH": str(folder / "profile"),
        "LC_ALL": "C.UTF-8",
    }
    environment.pop("PYTHONPATH", None)
    command = [
        sys.executable,
        __file__,
        "--child",
        str(folder),
        case,
        packages,
        str(cancel_at),
        str(n),
    ]
    done = subprocess.run(
        command, env=environment, cwd=folder, capture_output=True, text=True, check=False
    )
    for line in done.stdout.splitlines():
        if line.startswith("RESULT"):
            return json.loads(line.removeprefix("RESULT"))
    raise SystemExit(f"{case}: {done.stdout}{done.stderr}")


def row_of(case: str, seen: dict) -> str:
    """Return the row of a case in the table."""
    if seen["refused"]:
        missing = re.match(r"missing Python package: ([\w, -]+)\.", seen["refused"])
        assert missing, seen["refused"]
        return f"| {case} | refused: needs {missing[1]} | | | |"
    return (
        f"| {case} | {seen['seconds']:.1f} | {seen['megabytes']:.0f} | {seen['moves'][0]:.1f} "
        f"| {seen['asks'][0]:.1f} |"
    )


def put_into(page: Path, rows: dict[str, str]) -> None:
    """Put rows into the table of a page, which keeps those of cases that were not run."""
    before, table, after = re.split(
        r"(?<=<!-- stock -->\n)|(?=<!-- end of stock -->)", page.read_text()
    )
    there = {line.split(" | ")[0][2:]: line for line in table.splitlines()[2:]}
    lines = [rows.get(case, there.get(case)) for case in CASES]
    page.write_text(before + HEAD + "".join(f"{line}\n" for line in lines if line) + after)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--packages", choices=["stock", "all"], default="stock")
    parser.add_argument(
        "--only",
        default="",
        help="cases with one of these words in their name, with commas between",
    )
    parser.add_argument("--cells", type=int, default=1000, help="rows and columns of the DEM")
    parser.add_argument("--cancel", action="store_true", help="run again, and cancel")
    parser.add_argument(
        "--page", type=Path, help="whose table, between marks, is brought up to date"
    )
    parser.add_argument("--folder", type=Path, help="where inputs are kept, to be used again")
    options = parser.parse_args()
    folder = options.folder or Path(tempfile.mkdtemp(prefix="terrain-wavelets-"))
    for name, mode in (("run", 0o700), ("profile", 0o755), ("plugins", 0o755)):
        (folder / name).mkdir(mode=mode, parents=True, exist_ok=True)
    made = [sys.executable, ROOT / "scripts" / "plugin_zip.py", "--output", folder / "plugin.zip"]
    subprocess.run(made, check=True, stdout=subprocess.DEVNULL)
    shutil.rmtree(folder / "plugins" / "terrain_wavelets", ignore_errors=True)
    zipfile.ZipFile(folder / "plugin.zip").extractall(folder / "plugins")
    for name, (_, parameters) in INPUTS.items():
        made = [value for key, value in parameters.items() if key != "INPUT"]
        if not (folder / NAMES[str(made[0])[1:-1]]).exists():
            seen = run(folder, name, "all", 0.0, options.cells)
            assert not seen["refused"], seen
    print(HEAD, end="")
    rows = {}
    for case in CASES:
        if not any(word.lower() in case.lower() for word in options.only.split(",")):
            continue
        seen = run(folder, case, options.packages, 0.0, options.cells)
        stops = None
        if options.cancel and not seen["refused"]:
            at = max(seen["asks"][1], 0.05) + 0.05
            stops = run(folder, case, options.packages, at, options.cells)["stops"]
        rows[case] = row_of(case, seen)
        print(rows[case], flush=True)
        if stops is not None:
            print(f"    stops after {stops:.1f} s", file=sys.stderr, flush=True)
        for kind in ("moves", "asks"):
            print(f"    {kind}: {seen[kind]}", file=sys.stderr, flush=True)
    if options.page:
        put_into(options.page, rows)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        child(sys.argv[2:])
    main()
