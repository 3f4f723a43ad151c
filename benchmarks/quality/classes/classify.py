"""What the spectra add to the classification of LiDAR points, and a ground filter beside it.

Usage: python benchmarks/quality/classes/classify.py [--data FOLDER] [--output FILE.json] [--rows N]

Three clouds with real classes, ground, vegetation (or, in AHN, "other") and building. Folds are
blocks of the map (the tiles themselves for the IGN tiles). Each set of features is learned and
predicted alike; the cloth simulation filter sees the same points and is shown at the best of its
settings, which it has chosen with the help of the answers.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import laspy
import numpy as np

from wavelet_core import TriangleMesh, analyse
from wavelet_core.features.signature import Signature, plain_features, scale_features
from wavelet_core.mesh.triangulation import merge_duplicates
from wavelet_gis.workflows.learning.classification import spatial_folds, validate_classes
from wavelet_gis.workflows.learning.labels import merge_labels

ATTRIBUTES = ("intensity", "return_number", "number_of_returns")
GROUND = 2

#: name: (pattern, merged classes, levels, cloth resolutions)
CLOUDS = {
    "IGN tiles, Herault (suburb, 27 points/m2)": (
        "ign_tiles_*.laz",
        [(3, 5), (4, 5)],
        26,
        (0.5, 1.0, 2.0),
    ),
    "AHN3, Delft (town, 15 points/m2)": ("ahn3_delft_640k.laz", [(1, 5)], 26, (0.5, 1.0, 2.0)),
    "IGN, Brittany (country, 0.3 points/m2)": (
        "ign_semis_2023_0292_6833_289k.laz",
        [(3, 5), (4, 5)],
        18,
        (1.0, 2.0, 5.0),
    ),
}


def read(folder: Path, pattern: str):
    """Return points, classes, attributes and file number of all files of a pattern."""
    parts = []
    for number, path in enumerate(sorted(folder.glob(pattern))):
        las = laspy.read(path)
        attributes = np.column_stack([np.array(las[name]) for name in ATTRIBUTES])
        points = np.column_stack([las.x, las.y, las.z])
        classes = np.array(las.classification, dtype=np.int64)
        parts.append((points, classes, attributes.astype(float), np.full(len(points), number)))
    points, classes, attributes, tile = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    kept = merge_duplicates(points).kept
    return points[kept], classes[kept], attributes[kept], tile[kept]


def feature_sets(points, attributes, levels):
    """Return each set of features by name, and the seconds that the spectra took."""
    mesh = TriangleMesh.from_points(points, attributes, ATTRIBUTES)
    bare = TriangleMesh(mesh.vertices, mesh.faces)
    options = {"levels": levels, "partition": "random", "prediction": "plane"}
    start = time.perf_counter()
    # The same random order with and without attributes, so the levels are the same.
    pyramid = analyse(mesh, **options)
    scales = scale_features(pyramid)
    seconds = time.perf_counter() - start
    plain = plain_features(pyramid)
    of_z = scale_features(analyse(bare, **options))
    return {
        "without spectra": plain,
        "spectra of z alone": of_z,
        "without + spectra of z": plain.joined_to(of_z),
        "without + all spectra": plain.joined_to(scales),
    }, seconds


def ground_filter(points, is_ground, resolutions):
    """Return the figures of the cloth simulation filter at its best setting."""
    import CSF

    best = None
    for resolution in resolutions:
        for rigidness in (1, 2, 3):
            cloth = CSF.CSF()
            cloth.params.bSloopSmooth = False
            cloth.params.cloth_resolution = resolution
            cloth.params.rigidness = rigidness
            cloth.params.class_threshold = 0.5
            cloth.params.interations = 300  # the library's spelling
            start = time.perf_counter()
            cloth.setPointCloud(points - points.min(axis=0))
            ground, other = CSF.VecInt(), CSF.VecInt()
            cloth.do_filtering(ground, other, exportCloth=False)
            seconds = time.perf_counter() - start
            predicted = np.zeros(len(points), dtype=bool)
            predicted[np.array(ground, dtype=int)] = True
            figures = binary_figures(
                np.array(
                    [
                        [np.sum(~is_ground & ~predicted), np.sum(~is_ground & predicted)],
                        [np.sum(is_ground & ~predicted), np.sum(is_ground & predicted)],
                    ]
                )
            )
            figures |= {"resolution": resolution, "rigidness": rigidness, "seconds": seconds}
            if best is None or figures["f1"] > best["f1"]:
                best = figures
    return best


def binary_figures(confusion):
    """Return accuracy, F1 of ground and kappa of a 2 x 2 matrix (other, ground)."""
    total = confusion.sum()
    accuracy = np.trace(confusion) / total
    chance = (confusion.sum(axis=0) * confusion.sum(axis=1)).sum() / total**2
    f1 = 2 * confusion[1, 1] / (confusion[1].sum() + confusion[:, 1].sum())
    return {
        "accuracy": float(accuracy),
        "f1": float(f1),
        "kappa": float((accuracy - chance) / (1 - chance)),
    }


def ground_against_rest(validation):
    """Return the figures of ground against all else out of a confusion matrix."""
    ground = np.array([c == GROUND for c in validation.classes])
    m = validation.confusion
    return binary_figures(
        np.array(
            [
                [m[~ground][:, ~ground].sum(), m[~ground][:, ground].sum()],
                [m[ground][:, ~ground].sum(), m[ground][:, ground].sum()],
            ]
        )
    )


def run_cloud(folder: Path, name: str, n_rows: int):
    pattern, merges, levels, resolutions = CLOUDS[name]
    points, classes, attributes, tile = read(folder, pattern)
    labels = merge_labels(classes, merges)
    labels[~np.isin(labels, (2, 5, 6))] = -1
    folds = tile if tile.max() else spatial_folds(points[:, :2])
    sets, seconds = feature_sets(points, attributes, levels)
    known = np.flatnonzero(labels >= 0)
    rows = np.sort(np.random.default_rng(0).permutation(known)[:n_rows])
    result = {
        "n_points": len(points),
        "n_judged": len(rows),
        "n_folds": len(np.unique(folds)),
        "seconds_of_spectra": seconds,
        "sets": {},
    }
    for set_name, features in sets.items():
        some = Signature(features.names, features.values[rows])
        validation = validate_classes(some, labels[rows], folds[rows])
        figures = validation.as_dict() | {"n_features": len(features.names)}
        figures["ground"] = ground_against_rest(validation)
        result["sets"][set_name] = figures
        f1 = "  ".join(f"{c}: {v:.3f}" for c, v in validation.f1.items())
        print(f"{name}: {set_name}: {validation.accuracy:.3f}  {f1}", flush=True)
    result["ground_filter"] = ground_filter(points[known], labels[known] == GROUND, resolutions)
    print(f"{name}: cloth simulation filter: {result['ground_filter']}", flush=True)
    return result


def as_markdown(results) -> str:
    """Return the tables of the results."""
    lines = []
    for name, result in results.items():
        lines += [
            f"**{name}**, {result['n_points']:,} vertices, {result['n_judged']:,} judged, "
            f"{result['n_folds']} folds:",
            "",
            "| learned from | columns | accuracy | F1 ground | F1 vegetation | F1 building |",
            "| --- | --- | --- | --- | --- | --- |",
        ]
        for set_name, figures in result["sets"].items():
            f1 = " | ".join(f"{figures['f1'][c]:.3f}" for c in ("2", "5", "6"))
            lines.append(
                f"| {set_name} | {figures['n_features']} | {figures['accuracy']:.3f} | {f1} |"
            )
        last = list(result["sets"].values())[-1]
        lines += [
            "",
            "| true (with all spectra) | as ground | as vegetation | as building |",
            "| --- | --- | --- | --- |",
        ]
        for row_name, row in zip(
            ("ground", "vegetation", "building"), last["confusion"], strict=True
        ):
            lines.append(f"| {row_name} | " + " | ".join(f"{n:,}" for n in row) + " |")
        lines += [
            "",
            "| ground against the rest | accuracy | F1 | kappa |",
            "| --- | --- | --- | --- |",
        ]
        for set_name, figures in result["sets"].items():
            lines.append(f"| {set_name} | {_three(figures['ground'])} |")
        cloth = result["ground_filter"]
        setting = f"{cloth['resolution']:g}, rigidness {cloth['rigidness']}"
        lines += [f"| cloth simulation filter (resolution {setting}) | {_three(cloth)} |", ""]
    return "\n".join(lines)


def _three(figures) -> str:
    return " | ".join(f"{figures[key]:.3f}" for key in ("accuracy", "f1", "kappa"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    here = Path(__file__).resolve().parents[3]
    parser.add_argument("--data", type=Path, default=here.parent / "shared" / "data")
    parser.add_argument("--output", type=Path)
    parser.add_argument("--rows", type=int, default=60_000, help="judged in each cloud")
    arguments = parser.parse_args()
    results = {name: run_cloud(arguments.data / "clouds", name, arguments.rows) for name in CLOUDS}
    if arguments.output:
        arguments.output.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    print(as_markdown(results))


if __name__ == "__main__":
    main()
