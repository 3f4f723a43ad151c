"""The levels of a pyramid in one HTML page, with a slider; it needs no network."""

from __future__ import annotations

import base64
import html
import json
import zlib
from importlib.resources import files
from typing import Any

import numpy as np

from wavelet_core import OptionError, Progress, TriangleMesh
from wavelet_core.progress import report
from wavelet_gis.model.geo_pyramid import GeoPyramid

__all__ = ["MAX_VERTICES", "level_viewer"]

#: Vertices of the finest level shown, where none is named: pages of some 2 to 4 MB.
MAX_VERTICES = 60_000
#: A level is passed over where it has more than this part of the vertices of the next finer one.
THINNING = 0.75
#: By what heights are multiplied: relief then is at least this part of the width.
LEAST_RELIEF = 0.1
N_STEPS = 65535
_SHORT_UNITS = {"metre": "m", "foot": "ft", "us_survey_foot": "US survey ft"}


def level_viewer(
    geo: GeoPyramid, max_vertices: int | None = None, progress: Progress | None = None
) -> tuple[str, dict[str, Any]]:
    """Return an HTML page that shows the levels of a pyramid as surfaces, and its figures.

    Parameters
    ----------
    geo : GeoPyramid
        What is shown.
    max_vertices : int, optional
        Vertices of the finest level shown; by default `MAX_VERTICES`.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    page : str
        Self-contained; opens in any browser with WebGL 2. Without that, its table says the same.
    figures : dict
        JSON-able: the levels that are shown, with their sizes and errors.

    Raises
    ------
    OptionError
        No level is small enough.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    Coordinates are those of the working frame, each rounded to 1/65535 of its extent.
    """
    limit = MAX_VERTICES if max_vertices is None else max_vertices
    pyramid = geo.pyramid
    smallest = pyramid.n_vertices(0)
    if smallest > limit:
        raise OptionError(
            "the coarsest level has {smallest} vertices, more than the {limit} of {0}; raise that, "
            "or analyse to a coarser level.",
            "max_vertices",
            smallest=smallest,
            limit=limit,
        )
    levels_shown = _levels_shown([pyramid.n_vertices(k) for k in range(len(pyramid))], limit)
    chosen: list[tuple[int, TriangleMesh]] = []
    for level, mesh in enumerate(pyramid):
        if level > levels_shown[-1]:
            break
        if level in levels_shown:
            chosen.append((level, mesh))
        report(progress, 0.7 * (level + 1) / (levels_shown[-1] + 1))
    corners = [(mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)) for _, mesh in chosen]
    low = np.min([corner for corner, _ in corners], axis=0)
    high = np.max([corner for _, corner in corners], axis=0)
    rows = [_row(geo, level, mesh) for level, mesh in chosen]
    levels = []
    for k, (row, (_, mesh)) in enumerate(zip(rows, chosen, strict=True)):
        levels.append({"words": _words(row, geo.vertical_unit), **_packed(mesh, low, high)})
        report(progress, 0.7 + 0.3 * (k + 1) / len(chosen))
    width, relief = float((high - low)[:2].max()), float(high[2] - low[2])
    data = {
        "low": low.tolist(),
        "high": high.tolist(),
        "exaggeration": float(np.clip(LEAST_RELIEF * width / relief, 1, 20)) if relief > 0 else 1.0,
        "levels": levels,
    }
    name = geo.source_name.replace("\\", "/").rsplit("/", 1)[-1]
    title = f"{name}: {pyramid.n_levels} levels, {pyramid.n_vertices(pyramid.n_levels):,} vertices"
    template = files("wavelet_gis.report").joinpath("level_viewer.html").read_text("utf-8")
    page = (
        template.replace("@title@", html.escape(title))
        .replace("@table@", _table(rows, geo.vertical_unit))
        # "</script" in a text would end the element, whatever the JSON says around it
        .replace("@data@", json.dumps(data, allow_nan=False).replace("<", "\\u003c"))
    )
    return page, {"n_levels": pyramid.n_levels, "shown": rows}


def _levels_shown(sizes: list[int], limit: int) -> list[int]:
    """Return the levels of a page: the coarsest, some between, the finest that may be."""
    allowed = [level for level, size in enumerate(sizes) if size <= limit]
    shown = [allowed[-1]]
    for level in allowed[-2::-1]:
        if level == 0 or sizes[level] <= THINNING * sizes[shown[-1]]:
            shown.append(level)
    return shown[::-1]


def _row(geo: GeoPyramid, level: int, mesh: TriangleMesh) -> dict[str, Any]:
    """Return the figures of a level; errors where the pyramid has them."""
    pyramid = geo.pyramid
    row: dict[str, Any] = {
        "level": level,
        "n_vertices": mesh.n_vertices,
        "n_triangles": mesh.n_faces,
        "share": mesh.n_vertices / geo.pyramid.n_vertices(pyramid.n_levels),
    }
    errors = geo.errors_at(level)
    if errors is not None:
        row |= {"rmse": errors.rmse_surface, "max_error": errors.max_error_surface}
    return row


def _words(row: dict[str, Any], unit: str) -> str:
    text = (
        f"Level {row['level']}: {row['n_vertices']:,} vertices ({row['share']:.1%} of the input), "
        f"{row['n_triangles']:,} triangles"
    )
    if "rmse" not in row:
        return text
    unit = _SHORT_UNITS.get(unit, unit)
    return (
        f"{text}; RMSE {row['rmse']:.3g}, largest error {row['max_error']:.3g} "
        f"{unit} at all input points"
    )


def _table(rows: list[dict[str, Any]], unit: str) -> str:
    unit = html.escape(_SHORT_UNITS.get(unit, unit))
    head = "".join(
        f'<th scope="col">{name}</th>'
        for name in ("level", "vertices", "triangles", f"RMSE ({unit})", f"largest error ({unit})")
    )
    body = "".join(
        f"<tr><td>{row['level']}</td><td>{row['n_vertices']:,}</td><td>{row['n_triangles']:,}</td>"
        f"<td>{_number(row.get('rmse'))}</td><td>{_number(row.get('max_error'))}</td></tr>"
        for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _number(value: float | None) -> str:
    return "not measured" if value is None else f"{value:.4g}"


def _packed(mesh: TriangleMesh, low: np.ndarray, high: np.ndarray) -> dict[str, str]:
    """Return vertices and faces as packed differences; faces in the order of their vertices."""
    extent = np.where(high > low, high - low, 1.0)
    steps = np.rint((mesh.vertices - low) / extent * N_STEPS).astype(np.int64)
    differences = np.diff(steps, axis=0, prepend=0).astype(np.uint16)  # modulo 65536
    faces = mesh.faces.astype(np.int64)
    turned = np.argmin(faces, axis=1)
    faces = np.take_along_axis(faces, (turned[:, None] + np.arange(3)) % 3, axis=1)
    faces = faces[np.lexsort(faces.T[::-1])]
    corners = np.diff(faces.ravel(), prepend=0).astype("<i4")
    return {
        "positions": _encoded(np.ascontiguousarray(differences.T).astype("<u2")),
        "faces": _encoded(corners),
    }


def _encoded(array: np.ndarray) -> str:
    return base64.b64encode(zlib.compress(array.tobytes(), 9)).decode("ascii")
