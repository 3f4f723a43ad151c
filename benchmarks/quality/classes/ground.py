"""Ground filters against reference classes: type I, type II and total error, by survey.

Usage: python benchmarks/quality/classes/ground.py [--data FOLDER] [--output FILE] [--only NAME]
       python benchmarks/quality/classes/ground.py [--data FOLDER] --picture FILE

Ten surveys with reference classes, seven countries. Each filter runs at two to four settings; the
setting by which it is judged on one survey is the one with the least mean total error on the nine
others, so no filter has seen what it is judged on. "Best" is the setting that only the answers
tell. Needs, besides the project and laspy, ``cloth-simulation-filter``, ``pysmrf`` and
``whitebox-workflows``; filters whose package is missing are left out, and that is said.

Points of class 2 (and 8, model key points of old files) are ground. Water, artificial points and
overlap, points that nobody has classified (class 0) and classes that the standard does not define
are not judged. Some references mark a part of the ground only: those where points of other classes
lie within 0.3 m of the reference ground in more than 0.3 times its number. There, unmarked points
within 0.5 m of it are not judged.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path
from typing import NamedTuple

import laspy
import numpy as np

from wavelet_core.features.ground import ground_points
from wavelet_gis.model.attributes.ground import height_above_ground

FOOT = 0.3048

#: Of a survey of a square kilometre, on which some filters take minutes, the square in the middle.
LARGEST_SIDE = 400.0

#: name: (pattern, metres in a unit)
SURVEYS = {
    "Herault, suburb, 26/m²": ("clouds/ign_tiles_*.laz", 1.0),
    "Brittany, country, 0.3/m²": ("clouds/ign_semis_2023_0292_6833_289k.laz", 1.0),
    "Poitou, fields, 8/m²": ("clouds/ign_lidarhd_700k.laz", 1.0),
    "Delft, town, 15/m²": ("clouds/ahn3_delft_640k.laz", 1.0),
    "Afghanistan, mountain, 1/m²": ("clouds/mountain_utm42_38k.las", 1.0),
    "Nebraska, trees, 85/m²": ("nasty/wkt_and_geotiff.las", FOOT),
    "Pennsylvania, wood, 0.7/m²": ("nasty/old_pointwise.laz", FOOT),
    "Quebec, forest, 1/m²": ("clouds/Topography.laz", 1.0),
    "British Columbia, forest, 12/m²": ("clouds/bcts_1.laz", 1.0),
    "Oregon, suburb, 2/m²": ("clouds/autzen_trim.las", FOOT),
}

GROUND_CLASSES = (2, 8)
NOT_JUDGED = (0, 7, 9, 12, 18, 65, 66)
LAST_OF_OLD_FILES = 9  # LAS 1.0 defines no class beyond water


class Cloud(NamedTuple):
    """A survey.

    points : (n, 3) float64, metres
    returns : (n, 2), number of the return and of returns
    is_ground : (n,) bool
    is_judged : (n,) bool
    is_partial : bool, whether the reference marks a part of the ground only
    """

    points: np.ndarray
    returns: np.ndarray
    is_ground: np.ndarray
    is_judged: np.ndarray
    is_partial: bool


def read(folder: Path, pattern: str, unit: float, side: float) -> Cloud:
    """Return a survey, or the square in its middle."""
    parts = []
    for path in sorted(folder.glob(pattern)):
        las = laspy.read(path)
        classes = np.array(las.classification, dtype=np.int64)
        if las.header.version.minor == 0:
            classes[classes > LAST_OF_OLD_FILES] = 0
        returns = np.column_stack([las.return_number, las.number_of_returns])
        parts.append((np.column_stack([las.x, las.y, las.z]) * unit, classes, returns))
    points, classes, returns = (np.concatenate(column) for column in zip(*parts, strict=True))
    points -= np.floor(points.min(axis=0))
    off = np.abs(points[:, :2] - 0.5 * points[:, :2].max(axis=0)).max(axis=1)
    is_used = ~np.isin(classes, (7, 18)) & (off <= 0.5 * side)
    points, classes, returns = points[is_used], classes[is_used], returns[is_used]
    is_ground = np.isin(classes, GROUND_CLASSES)
    is_judged = ~np.isin(classes, NOT_JUDGED)
    above = np.abs(height_above_ground(points, is_ground))
    is_other = is_judged & ~is_ground
    is_partial = np.count_nonzero(is_other & (above < 0.3)) > 0.3 * np.count_nonzero(is_ground)
    if is_partial:
        is_judged &= is_ground | (above > 0.5)
    return Cloud(points, returns, is_ground, is_judged, bool(is_partial))


# -- the filters: each yields settings, and runs one ---------------------------------------------


def our_settings() -> Iterator[dict]:
    """Return settings, the defaults first."""
    for largest, slope in product((60.0, 120.0), (0.1, 0.05)):
        yield {"largest_object": largest, "least_slope": slope}


def ours(cloud: Cloud, setting: dict) -> np.ndarray:
    """Run ours."""
    return ground_points(cloud.points, **setting)


def csf_settings() -> Iterator[dict]:
    """Return settings, the defaults of CloudCompare's plugin first."""
    for rigidness, smooth in ((2, False), (3, False), (1, True), (2, True)):
        yield {"resolution": 2.0, "rigidness": rigidness, "smooth": smooth}


def csf(cloud: Cloud, setting: dict) -> np.ndarray:
    """Run the cloth simulation filter."""
    import CSF

    cloth = CSF.CSF()
    cloth.params.bSloopSmooth = setting["smooth"]
    cloth.params.cloth_resolution = setting["resolution"]
    cloth.params.rigidness = setting["rigidness"]
    cloth.params.class_threshold = 0.5
    cloth.params.interations = 500  # the library's spelling
    cloth.setPointCloud(cloud.points)
    ground, other = CSF.VecInt(), CSF.VecInt()
    cloth.do_filtering(ground, other, exportCloth=False)
    return _mask(np.array(ground, dtype=np.int64), len(cloud.points))


def smrf_settings() -> Iterator[dict]:
    """Return settings, the paper's defaults first."""
    for slope, height in ((0.15, 0.5), (0.15, 0.3), (0.3, 0.5)):
        yield {"slope_threshold": slope, "windows": 18, "elevation_threshold": height}


def smrf(cloud: Cloud, setting: dict) -> np.ndarray:
    """Run the simple morphological filter, on cells of 1 m."""
    import pysmrf

    found = pysmrf.classify(*cloud.points.T.copy(), cellsize=1.0, **setting)
    return np.asarray(found.is_ground, dtype=bool)


def whitebox_settings() -> Iterator[dict]:
    """Return settings, the defaults first."""
    for slope, height in ((15.0, 0.15), (30.0, 0.3)):
        yield {"slope_threshold": slope, "elev_threshold": height}


def whitebox(cloud: Cloud, setting: dict) -> np.ndarray:
    """Run Whitebox's improved ground point filter; files in and out are not in its time."""
    import whitebox_workflows

    with tempfile.TemporaryDirectory() as folder:
        _write(Path(folder) / "in.las", cloud)
        environment = whitebox_workflows.WbEnvironment()
        environment.working_directory, environment.max_procs = folder, 1
        run = environment.lidar.filtering_classification.improved_ground_point_filter
        lidar = environment.read_lidar("in.las")
        began = time.process_time()
        found = run(input=lidar, classify=True, **setting)
        whitebox.seconds = time.process_time() - began
        environment.write_lidar(found, "out.las")
        las = laspy.read(Path(folder) / "out.las")
    rows = np.rint(las.gps_time).astype(np.int64)
    return _mask(rows[np.array(las.classification) == 2], len(cloud.points))


def _write(path: Path, cloud: Cloud) -> None:
    header = laspy.LasHeader(point_format=1, version="1.2")
    header.scales = [0.001] * 3
    las = laspy.LasData(header)
    las.x, las.y, las.z = cloud.points.T
    las.return_number, las.number_of_returns = np.minimum(cloud.returns.T, 7)
    las.gps_time = np.arange(len(cloud.points), dtype=np.float64)  # which point it was
    las.write(path)


def _mask(rows: np.ndarray, n: int) -> np.ndarray:
    mask = np.zeros(n, dtype=bool)
    mask[rows] = True
    return mask


FILTERS: dict[str, tuple[str, Callable, Callable]] = {
    "ours": ("wavelet_core", our_settings, ours),
    "SMRF": ("pysmrf", smrf_settings, smrf),
    "CSF": ("CSF", csf_settings, csf),
    "Whitebox": ("whitebox_workflows", whitebox_settings, whitebox),
}


# -- judged ----------------------------------------------------------------------------------------


def errors(cloud: Cloud, found: np.ndarray) -> dict[str, float]:
    """Return type I (ground refused), type II (other accepted) and total error, in per cent."""
    truth, found = cloud.is_ground[cloud.is_judged], found[cloud.is_judged]
    return {
        "type_1": 100.0 * float(np.mean(~found[truth])),
        "type_2": 100.0 * float(np.mean(found[~truth])),
        "total": 100.0 * float(np.mean(found != truth)),
    }


def run_all(clouds: dict[str, Cloud], name: str, results: dict) -> None:
    """Run one filter at all settings on all surveys."""
    _, settings, run = FILTERS[name]
    for survey, cloud in clouds.items():
        rows = []
        for setting in settings():
            began = time.process_time()
            found = run(cloud, setting)
            seconds = getattr(run, "seconds", time.process_time() - began)
            rows.append({"setting": setting, "seconds": seconds, **errors(cloud, found)})
        results[survey]["filters"][name] = rows
        totals = [row["total"] for row in rows]
        print(f"{name}, {survey}: default {totals[0]:.2f}, best {min(totals):.2f}", flush=True)


def held_out(results: dict, name: str, survey: str) -> dict:
    """Return the row of the setting that is best on all other surveys."""
    totals = [
        [row["total"] for row in result["filters"][name]]
        for other, result in results.items()
        if other != survey
    ]
    return results[survey]["filters"][name][int(np.argmin(np.mean(totals, axis=0)))]


def as_markdown(results: dict) -> str:
    """Return the tables."""
    names = [name for name in FILTERS if all(name in r["filters"] for r in results.values())]
    lines = [
        "| survey | " + " | ".join(names) + " |",
        "| --- |" + " --- |" * len(names),
    ]
    columns: dict[str, list[dict]] = {name: [] for name in names}
    for survey, result in results.items():
        rows = [held_out(results, name, survey) for name in names]
        least = min(row["total"] for row in rows)
        cells = []
        for name, row in zip(names, rows, strict=True):
            columns[name].append(row)
            total = f"{row['total']:.1f}"
            total = f"**{total}**" if row["total"] == least else total
            cells.append(f"{row['type_1']:.1f} / {row['type_2']:.1f} / {total}")
        star = " *" if result["is_partial"] else ""
        lines.append(f"| {survey}{star} | " + " | ".join(cells) + " |")
    means = [
        [np.mean([row[k] for row in columns[name]]) for name in names]
        for k in ("type_1", "type_2", "total")
    ]
    lines.append(
        "| mean, settings from the others | "
        + " | ".join(
            "{:.1f} / {:.1f} / {:.1f}".format(*column) for column in zip(*means, strict=True)
        )
        + " |"
    )
    for title, pick in (
        ("mean total, default setting", lambda rows: rows[0]["total"]),
        ("mean total, best of its settings", lambda rows: min(row["total"] for row in rows)),
    ):
        cells = [np.mean([pick(r["filters"][name]) for r in results.values()]) for name in names]
        lines.append(f"| {title} | " + " | ".join(f"{cell:.1f}" for cell in cells) + " |")
    for title, of_all in (("median total", np.median), ("largest total", np.max)):
        cells = [of_all([row["total"] for row in columns[name]]) for name in names]
        lines.append(f"| {title} | " + " | ".join(f"{cell:.1f}" for cell in cells) + " |")
    n_points = sum(result["n_points"] for result in results.values())
    seconds = [1e6 / n_points * sum(row["seconds"] for row in columns[name]) for name in names]
    lines.append(
        "| CPU seconds a million points | " + " | ".join(f"{s:.1f}" for s in seconds) + " |"
    )
    return "\n".join(lines)


#: Surveys in the picture.
SHOWN = ("Brittany, country, 0.3/m²", "Delft, town, 15/m²", "Afghanistan, mountain, 1/m²")


def draw(path: Path, clouds: dict[str, Cloud]) -> None:
    """Draw where our defaults are right and wrong."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    kinds = (
        ("ground, found", "#d6d3d1"),
        ("other, found", "#86a789"),
        ("ground, refused (type I)", "#dc2626"),
        ("other, accepted (type II)", "#1d4ed8"),
    )
    figure, axes = pyplot.subplots(1, len(SHOWN), figsize=(11, 4.2), layout="constrained")
    for axis, name in zip(axes, SHOWN, strict=True):
        cloud = clouds[name]
        found, truth = ground_points(cloud.points), cloud.is_ground
        for (label, colour), mask in zip(
            kinds, (found & truth, ~found & ~truth, ~found & truth, found & ~truth), strict=True
        ):
            x, y, _ = cloud.points[mask & cloud.is_judged].T
            axis.plot(x, y, ",", color=colour, label=label, rasterized=True)
        axis.set(aspect="equal", xticks=[], yticks=[])
        axis.set_title(name, loc="left", fontsize=11)
    handles = [
        pyplot.Line2D([], [], marker="s", linestyle="", color=colour, label=label)
        for label, colour in kinds
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False)
    figure.savefig(path, dpi=80)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    here = Path(__file__).resolve().parents[3]
    parser.add_argument("--data", type=Path, default=here.parent / "shared" / "data")
    parser.add_argument("--output", type=Path, help="read first, where it exists")
    parser.add_argument("--only", choices=tuple(FILTERS), help="run one filter, keep the others")
    parser.add_argument("--picture", type=Path, help="draw where ours is right, and end")
    parser.add_argument("--table", action="store_true", help="print that of --output, and end")
    arguments = parser.parse_args()
    if arguments.table:
        print(as_markdown(json.loads(arguments.output.read_text(encoding="utf-8"))))
        return
    side = np.inf if arguments.picture else LARGEST_SIDE
    clouds = {name: read(arguments.data, *what, side) for name, what in SURVEYS.items()}
    if arguments.picture:
        draw(arguments.picture, clouds)
        return
    results: dict = {}
    if arguments.output and arguments.output.exists():
        results = json.loads(arguments.output.read_text(encoding="utf-8"))
    for name, cloud in clouds.items():
        result = results.setdefault(name, {"filters": {}})
        result["n_points"], result["is_partial"] = len(cloud.points), cloud.is_partial
        result["n_judged"] = int(np.count_nonzero(cloud.is_judged))
        result["n_ground"] = int(np.count_nonzero(cloud.is_ground))
    for name, (package, *_) in FILTERS.items():
        if arguments.only and name != arguments.only:
            continue
        try:
            __import__(package)
        except ImportError:
            print(f"{name} is left out: {package} is not installed")
            continue
        run_all(clouds, name, results)
        if arguments.output:
            arguments.output.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    print(as_markdown(results))


if __name__ == "__main__":
    main()
