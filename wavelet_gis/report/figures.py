"""The figures of a quality report: sizes, errors, triangles and details of every level."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, TriangleMesh, surface_shape
from wavelet_core.metrics import surface_errors
from wavelet_core.progress import report
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.workflows.read_off.levels import checked_levels, default_levels
from wavelet_gis.workflows.solver.quality import triangle_quality

__all__ = ["CANCELLED", "ReportData", "report_data"]

#: What is said where ``progress`` returns False.
CANCELLED = "the report was cancelled; nothing was written."

#: Share of the time in which the levels are measured; their errors by slope take the rest.
LEVELS_SHARE = 0.85

FloatArray = NDArray[np.float64]

#: Classes of slope, in degrees, over which the error is broken down.
SLOPE_CLASSES = (0.0, 5.0, 15.0, 30.0, 90.0)

#: Bins of the histograms, common to all levels.
N_BINS = 40

#: How many of the largest errors are listed, how far apart (as a part of the extent), and among
#: how many they are sought.
N_WORST, WORST_REACH, N_CANDIDATES = 8, 0.02, 20_000


@dataclass(frozen=True, slots=True)
class ReportData:
    """The figures, and the surfaces that the pictures show.

    Attributes
    ----------
    figures : dict
        JSON-able.
    shown : dict of int to TriangleMesh
        The chosen levels in the working frame, and the finest.
    errors : dict of int to (n_vertices,) float64
        Signed vertical distance of every input vertex from each chosen level, in the input's
        unit of z; NaN where it is not covered.
    """

    figures: dict[str, Any]
    shown: dict[int, TriangleMesh]
    errors: dict[int, FloatArray]


def report_data(
    geo: GeoPyramid,
    levels: Sequence[int] | None = None,
    progress: Progress | None = None,
) -> ReportData:
    """Return everything that a quality report shows.

    Parameters
    ----------
    geo : GeoPyramid
        What is reported on.
    levels : sequence of int, optional
        Which levels are shown as pictures; see `default_levels`.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        A level that the pyramid does not have, or none.
    Cancelled
        ``progress`` returned False.
    """
    pyramid = geo.pyramid
    chosen = default_levels(geo) if levels is None else checked_levels(geo, list(levels))
    finest = pyramid.synthesise()
    points = _points_of(geo, finest)
    rows, shown, errors = [], {pyramid.n_levels: finest}, {}
    # a level costs its own triangles, and one look from each point of the input
    sizes = [pyramid.n_vertices(level) for level in range(len(pyramid))]
    ends = np.cumsum(np.array(sizes) + finest.n_vertices)
    for level, mesh in enumerate(pyramid):
        distance = surface_errors(mesh, points.places) / geo.frame.z_scale
        rows.append(_level_row(geo, level, mesh, finest, distance))
        if level in chosen:
            shown[level], errors[level] = mesh, distance
        report(progress, LEVELS_SHARE * float(ends[level] / ends[-1]), CANCELLED)
    by_slope = []
    for k, level in enumerate(chosen, 1):
        by_slope.append(_error_figures(geo, finest, points, level, errors[level]))
        report(progress, LEVELS_SHARE + (1.0 - LEVELS_SHARE) * k / len(chosen), CANCELLED)
    figures = {
        "source": _source_figures(geo, finest),
        "levels": rows[::-1],
        "details": _detail_figures(geo),
        "shown": by_slope,
        "parameters": dict(pyramid.parameters),
        "history": list(geo.history),
        "notes": [note.to_dict() for note in geo.notes],
        "versions": _versions(),
    }
    at_vertices = {level: errors[level][: finest.n_vertices] for level in chosen}
    return ReportData(figures, shown, at_vertices)


class _Points(NamedTuple):
    """All input points of a surface: those of the vertices first, then those merged with one.

    places : (n, 3) float64, in the working frame
    vertex : (n,) int64, the vertex that each is at
    """

    places: FloatArray
    vertex: NDArray[np.int64]


def _points_of(geo: GeoPyramid, finest: TriangleMesh) -> _Points:
    own = np.arange(finest.n_vertices)
    if geo.origin.points is None:
        return _Points(finest.vertices, own)
    places = geo.origin.points.points_for_errors(finest, geo.frame)
    return _Points(places, np.concatenate([own, geo.origin.points.representative]))


def _level_row(
    geo: GeoPyramid,
    level: int,
    mesh: TriangleMesh,
    finest: TriangleMesh,
    distance: FloatArray,
) -> dict[str, Any]:
    ids = geo.pyramid.vertex_ids(level)
    reference = np.hstack([finest.vertices, finest.attributes])
    extent = np.ptp(reference, axis=0)
    difference = np.hstack([mesh.vertices, mesh.attributes]) - reference[ids]
    difference /= np.where(extent > 0, extent, 1.0)
    covered = distance[np.isfinite(distance)]
    edges = mesh.vertices[mesh.faces, :2]
    lengths = np.linalg.norm(edges - np.roll(edges, 1, axis=1), axis=2)
    return {
        "level": level,
        "n_vertices": mesh.n_vertices,
        "n_faces": mesh.n_faces,
        "vertex_share": mesh.n_vertices / finest.n_vertices,
        "spacing": float(np.median(lengths)) if lengths.size else float("nan"),
        "rmse_coefficients": float(np.sqrt((difference**2).sum() / max(len(ids), 1))),
        "rmse_surface": float(np.sqrt(np.mean(covered**2))) if len(covered) else float("nan"),
        "max_error_surface": float(np.abs(covered).max(initial=0.0)),
        "error_90": float(np.quantile(np.abs(covered), 0.9)) if len(covered) else float("nan"),
        "n_uncovered": len(distance) - len(covered),
        **triangle_quality(mesh),
    }


def _detail_figures(geo: GeoPyramid) -> dict[str, Any]:
    """Histograms of the magnitudes, over bins of equal ratio that all levels share."""
    magnitudes = [
        np.linalg.norm(geo.file_details(step.details), axis=1) for step in geo.pyramid.steps
    ]
    together = np.concatenate(magnitudes) if magnitudes else np.empty(0)
    together = together[together > 0]
    if len(together) == 0:
        return {"bin_edges": [], "levels": []}
    low, high = np.quantile(together, 0.001), together.max()
    edges = np.geomspace(low, max(high, low * 1.001), N_BINS + 1)
    rows = []
    for level, magnitude in enumerate(magnitudes):
        inside = np.clip(magnitude, edges[0], edges[-1])
        rows.append(
            {
                "level": level,
                "n_details": len(magnitude),
                "rms": float(np.sqrt(np.mean(magnitude**2))) if len(magnitude) else 0.0,
                "median": float(np.median(magnitude)) if len(magnitude) else 0.0,
                "largest": float(magnitude.max(initial=0.0)),
                "counts": np.histogram(inside, edges)[0].tolist(),
            }
        )
    return {"bin_edges": edges.tolist(), "levels": rows}


def _error_figures(
    geo: GeoPyramid, finest: TriangleMesh, points: _Points, level: int, distance: FloatArray
) -> dict[str, Any]:
    """Where the error of a level is: by slope of the input, and its worst places."""
    slope = surface_shape(finest).slope[points.vertex]
    known = np.isfinite(distance) & np.isfinite(slope)
    total = float((distance[known] ** 2).sum())
    classes = []
    for low, high in pairwise(SLOPE_CLASSES):
        inside = known & (slope >= low) & ((slope < high) | (high == SLOPE_CLASSES[-1]))
        squared = float((distance[inside] ** 2).sum())
        n_inside = int(np.count_nonzero(inside))
        classes.append(
            {
                "slope_from": low,
                "slope_to": high,
                "vertex_share": n_inside / max(int(np.count_nonzero(known)), 1),
                "rmse_surface": float(np.sqrt(squared / n_inside)) if n_inside else float("nan"),
                "squared_error_share": squared / total if total > 0 else 0.0,
            }
        )
    size = np.abs(np.where(known, distance, 0.0))
    worst = _apart(points.places[:, :2], size)
    places = geo.frame.to_file(points.places[worst])
    return {
        "level": level,
        "quantiles": {
            str(q): float(np.quantile(size[known], q)) if known.any() else float("nan")
            for q in (0.5, 0.9, 0.99, 1.0)
        },
        "bias": float(distance[known].mean()) if known.any() else float("nan"),
        "by_slope": classes,
        "worst": [
            {"x": float(x), "y": float(y), "z": float(z), "error": float(distance[vertex])}
            for (x, y, z), vertex in zip(places, worst, strict=True)
            if size[vertex] > 0
        ],
    }


def _apart(plan: FloatArray, size: FloatArray) -> list[int]:
    """Return the vertices of the largest sizes that lie apart from each other."""
    reach = WORST_REACH * float(np.ptp(plan, axis=0).max(initial=0.0))
    places: list[int] = []
    for vertex in np.argsort(-size, kind="stable")[:N_CANDIDATES]:
        if len(places) == N_WORST:
            break
        if all(np.hypot(*(plan[vertex] - plan[other])) > reach for other in places):
            places.append(int(vertex))
    return places


def _source_figures(geo: GeoPyramid, finest: TriangleMesh) -> dict[str, Any]:
    vertices = geo.frame.to_file(finest.vertices)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return {
        "name": geo.source_name.replace("\\", "/").rsplit("/", 1)[-1],
        "kind": geo.origin.kind,
        "is_exact": bool(geo.origin.is_exact),
        "n_vertices": finest.n_vertices,
        "n_faces": finest.n_faces,
        "n_levels": geo.pyramid.n_levels,
        "channels": list(geo.pyramid.channels),
        "crs": geo.system.name,
        "vertical_unit": geo.vertical_unit,
        "x": [float(low[0]), float(high[0])],
        "y": [float(low[1]), float(high[1])],
        "z": [float(low[2]), float(high[2])],
    }


def _versions() -> dict[str, str]:
    from importlib.metadata import PackageNotFoundError, version

    versions = {"Python": platform.python_version()}
    for package in ("terrain-wavelets", "numpy", "scipy", "numba", "PythonCDT"):
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            versions[package] = "not installed"
    if versions["terrain-wavelets"] == "not installed":
        from wavelet_core import __version__

        versions["terrain-wavelets"] = __version__
    return versions
