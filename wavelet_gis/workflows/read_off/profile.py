"""The terrain along lines, at several levels of a pyramid."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core.errors import OptionError
from wavelet_core.lifting.spacings import level_spacings
from wavelet_core.mesh.location import heights_at
from wavelet_core.progress import report
from wavelet_gis.errors import InputFileError, OutputFileError
from wavelet_gis.io.formats import PYRAMID_SUFFIX, suffix_of
from wavelet_gis.io.read_back import write_text
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.layers import Layer
from wavelet_gis.products.styles import vertex_style
from wavelet_gis.products.wkb import points_wkb
from wavelet_gis.workflows.options import HoldsPyramid, pyramid_of
from wavelet_gis.workflows.read_off.levels import checked_levels, default_levels

__all__ = ["PROFILE_SUFFIXES", "Profile", "profile"]

FloatArray = NDArray[np.float64]

#: A table, and a layer of points.
PROFILE_SUFFIXES = (".csv", PYRAMID_SUFFIX)

#: More points along the lines than this are refused rather than tried.
MOST_POINTS = 5_000_000


@dataclass(frozen=True, slots=True)
class Profile:
    """Heights along lines, at several levels.

    Attributes
    ----------
    geo : GeoPyramid
        Gives place, CRS and units.
    levels : tuple of int
        Of the columns of ``heights``.
    line : (n,) int64
        Which line a point is of, from 0.
    distance : (n,) float64
        From the start of its line in plan, in the unit of x and y; metres for degrees.
    places : (n, 2) float64
        x and y in the coordinates of the input.
    heights : (n, n_levels) float64
        In the input's unit of z; NaN where the level covers nothing.
    """

    geo: GeoPyramid
    levels: tuple[int, ...]
    line: NDArray[np.int64]
    distance: FloatArray
    places: FloatArray
    heights: FloatArray

    def table(self) -> dict[str, NDArray[Any]]:
        """Return the columns ``line``, ``distance``, ``x``, ``y``, and ``z_00`` by level.

        Lines count from 1, as in the plot.
        """
        columns: dict[str, NDArray[Any]] = {
            "line": self.line + 1,
            "distance": self.distance,
            "x": self.places[:, 0],
            "y": self.places[:, 1],
        }
        for k, level in enumerate(self.levels):
            columns[f"z_{level:02d}"] = self.heights[:, k]
        return columns

    def layer(self) -> Layer:
        """Return the points as a layer, z of the finest level shown; NaN where it has none."""
        finest = self.heights[:, int(np.argmax(self.levels))]
        places = np.column_stack([self.places, finest])
        columns = self.table()
        fields = {name: columns[name] for name in columns if name not in ("x", "y")}
        return Layer(
            "profile",
            "Point Z",
            points_wkb(places),
            fields,
            vertex_style(),
            "Profile",
            "Points along a line: distance from its start, and the height of each level",
        )

    def write(self, path: str | os.PathLike[str]) -> dict[str, Any]:
        """Write a table (.csv) or points (.gpkg); see `wavelet_gis.workflows.save.save`.

        A plot is made by `wavelet_gis.profile_page`.
        """
        suffix = suffix_of(path)
        if suffix == ".csv":
            write_text(path, self.csv())
        elif suffix == PYRAMID_SUFFIX:
            from wavelet_gis.io.vector.vector_writer import add_layers

            add_layers(path, [self.layer()], self.geo.system)
        else:
            raise OutputFileError(f"{path}: a profile is written as .csv or {PYRAMID_SUFFIX}.")
        return {}

    def figures(self) -> dict[str, Any]:
        """Return length, relief and difference from the finest, by line (from 1) and level.

        NaN, in JSON null, where a level has no height along a line.
        """
        finest = self.heights[:, int(np.argmax(self.levels))]
        rows = []
        for line in np.unique(self.line):
            is_here = self.line == line
            for k, level in enumerate(self.levels):
                z = self.heights[is_here, k]
                off = z - finest[is_here]
                rows.append(
                    {
                        "line": int(line) + 1,
                        "length": float(self.distance[is_here].max()),
                        "level": level,
                        "lowest": _of(np.min, z),
                        "highest": _of(np.max, z),
                        "rms_difference": _of(lambda d: np.sqrt((d**2).mean()), off),
                        "max_difference": _of(np.max, np.abs(off)),
                    }
                )
        return {"levels": list(self.levels), "n_points": len(self.line), "profiles": rows}

    def csv(self) -> str:
        """Return the table as text, a line for each point; empty cells where there is no height."""
        columns = self.table()
        rows = [",".join(columns)]
        for values in zip(*(column.tolist() for column in columns.values()), strict=True):
            rows.append(",".join("" if value != value else repr(value) for value in values))
        return "\n".join([*rows, ""])


def profile(
    data: HoldsPyramid | GeoPyramid,
    line: Any,
    *,
    levels: Sequence[int] | None = None,
    step: float | None = None,
    progress: Progress | None = None,
) -> Profile:
    """Return the heights along lines, at several levels of a pyramid.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    line : path, GeoDataFrame, array_like (n, 2 or 3), or sequence of such arrays
        Lines; a file or a GeoDataFrame in any CRS, arrays in the coordinates of the input.
    levels : sequence of int, optional
        0 is the coarsest. By default the input, those with about a quarter and a twentieth of its
        vertices, and the coarsest.
    step : float, optional
        Distance between points along the line, whose corners are points, too; in the unit of x and
        y, metres for degrees. By default the median edge of the input's mesh.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        A level that is not there, or a step that is no length or too small.
    InputFileError
        Lines that cannot be read, or none where the terrain is.
    """
    geo = pyramid_of(data)
    given = [geo.pyramid.n_levels, *default_levels(geo)] if levels is None else list(levels)
    chosen = checked_levels(geo, given)
    if step is None:
        step = float(level_spacings(geo.pyramid)[-1])
    if not (np.isfinite(step) and step > 0):
        raise OptionError("{0} is {given}; give a length above 0.", "step", given=step)
    lines = _lines_in_frame(geo, line)
    length = sum(float(np.hypot(*np.diff(one, axis=0).T).sum()) for one in lines)
    if length / step > MOST_POINTS:
        raise OptionError(
            "{0} is {given}, which takes {n:,.0f} points; give a larger one.",
            "step",
            given=step,
            n=length / step,
        )
    stations = [_stations(one, step) for one in lines]
    plan = np.vstack([places for _, places in stations])
    heights = np.full((len(plan), len(chosen)), np.nan)
    last = max(chosen)
    for level, mesh in enumerate(geo.pyramid):
        if level in chosen:
            heights[:, chosen.index(level)] = heights_at(mesh, plan) / geo.frame.z_scale
        report(progress, (level + 1) / (last + 1))
        if level == last:
            break
    if not np.isfinite(heights).any():
        raise InputFileError(
            "{name}: no part of the line lies on it; check the line's coordinates and CRS.",
            name=geo.source_name,
        )
    return Profile(
        geo,
        tuple(chosen),
        np.repeat(np.arange(len(lines)), [len(places) for _, places in stations]),
        np.concatenate([distance for distance, _ in stations]),
        np.column_stack([geo.frame.file_x(plan[:, 0]), geo.frame.file_y(plan[:, 1])]),
        heights,
    )


def _stations(line: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """Return distances and places of points along a line: its corners, and each step from one."""
    lengths = np.hypot(*np.diff(line, axis=0).T)
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    at = [
        start + length * np.arange(n) / n
        for start, length, n in zip(
            starts[:-1],
            lengths,
            np.maximum(np.ceil(lengths / step - 1e-9), 1).astype(int),
            strict=True,
        )
    ]
    distance = np.concatenate([*at, starts[-1:]])
    places = np.column_stack([np.interp(distance, starts, line[:, k]) for k in (0, 1)])
    return distance, places


def _lines_in_frame(geo: GeoPyramid, given: Any) -> list[FloatArray]:
    """Return x and y of each line in the working frame; corners that stand twice, once."""
    is_shapes = isinstance(given, str | os.PathLike) or hasattr(given, "geometry")
    if is_shapes:
        import shapely

        from wavelet_gis.workflows.lines.layer_shapes import LINES, shapes_in_frame

        shapes, _ = shapes_in_frame(geo, given, "line", LINES)
        lines = [shapely.get_coordinates(part) for part in shapely.get_parts(shapes)]
    else:
        try:
            arrays = _arrays(given)
        except (TypeError, ValueError, LookupError) as error:
            raise OptionError(
                "{0} is no list of x and y ({why}); give one such as [[x, y], [x, y]].",
                "line",
                why=error,
            ) from error
        lines = [
            np.column_stack([geo.frame.local_x(one[:, 0]), geo.frame.local_y(one[:, 1])])
            for one in arrays
        ]
    kept = []
    for one in lines:
        is_new = np.ones(len(one), dtype=bool)
        is_new[1:] = (np.diff(one, axis=0) != 0).any(axis=1)
        if is_new.sum() > 1:
            kept.append(one[is_new])
    if not kept:
        raise OptionError("{0} has no length; give a line of two points or more.", "line")
    return kept


def _arrays(given: Any) -> list[FloatArray]:
    first = np.asarray(given[0], dtype=np.float64)
    arrays = [np.asarray(one, dtype=np.float64) for one in (given if first.ndim == 2 else [given])]
    for one in arrays:
        if one.ndim != 2 or one.shape[1] < 2 or not np.isfinite(one[:, :2]).all():
            raise ValueError(f"of shape {one.shape}")
    return arrays


def _of(function: Callable[[FloatArray], Any], z: FloatArray) -> float:
    """Return a figure of the values that are known; NaN where none is."""
    known = z[np.isfinite(z)]
    return float(function(known)) if len(known) else float("nan")
