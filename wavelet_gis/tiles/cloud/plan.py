"""How point clouds are cut into tiles, from their headers alone."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import OptionError
from wavelet_gis.crs.agreement import agreed
from wavelet_gis.crs.frame import CoordinateSystem, Georeference, LocalFrame
from wavelet_gis.errors import InputFileError
from wavelet_gis.io.formats import CLOUD_SUFFIXES, EPT, any_of, suffix_of
from wavelet_gis.io.las.batches import CloudHead, read_head
from wavelet_gis.io.las.cloud_reader import laspy_header, warn_of_crs
from wavelet_gis.io.las.dimensions import HEIGHT_ABOVE_GROUND
from wavelet_gis.io.las.ept import nodes_within, read_ept
from wavelet_gis.io.names import files_of, joint_name
from wavelet_gis.model.points.aside import DUPLICATE_RULES
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.model.terrain import frame_of_bounds, require_plan
from wavelet_gis.tiles.cloud.borders import FAR
from wavelet_gis.tiles.plan import (
    LEVELS,
    PointLattice,
    SourceFile,
    TilePlan,
    checked_wavelets,
    ends_of_tiles,
)

__all__ = ["POINTS_IN_TILE", "plan_of_clouds", "shift_of"]

#: Points of a tile where no size is given.
POINTS_IN_TILE = 1_000_000

#: Spacings of the points along the shortest side of a tile.
_LEAST_SIDE = 32

#: Part of a tile's side that its neighbours may reach into it for the sake of the border.
_REACH = 16

#: Largest p and q of a ratio.
_LARGEST_TERM = 64

#: Steps from the first offset to a point, and from end to end: a cell of the whole, by rows and
#: columns, is one int64.
_LARGEST_SHIFT = np.iinfo(np.int32).max


def plan_of_clouds(
    data: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    tile: float | tuple[float, float] | None = None,
    levels: int = LEVELS,
    crs: str | None = None,
    vertical_unit: str | None = None,
    attributes: Sequence[str] = (),
    classes: Sequence[int] | None = None,
    keep_noise: bool = False,
    keep_withheld: bool = False,
    duplicates: str | None = None,
    wavelets: dict[str, Any] | None = None,
) -> TilePlan:
    """Return the plan by which point clouds are tiled; reads no more than their headers.

    Parameters
    ----------
    data : path or sequence of path
        LAS, LAZ or COPC files of one point format, or a folder of such.
    tile : float or (float, float), optional
        Side of a tile, or its width and height, in the unit of x and y; by default such that a
        tile has about a million points.
    levels : int
        The most of each tile, and of each group but the last.
    crs, vertical_unit, attributes, classes, keep_noise, keep_withheld, duplicates
        See `wavelet_gis.open`. Heights above the ground are no attribute here.
    wavelets : dict, optional
        See `wavelet_gis.tiles.plan.plan_of_rasters`.

    Raises
    ------
    InputFileError
        Files that cannot be read, or that contradict each other.
    OptionError
        A size or a number of levels that makes no tiles.

    Warns
    -----
    CrsWarning
        What is odd about the CRS of a file, or that there is none.
    """
    from wavelet_gis.crs.lookup import coordinate_system

    if not 1 <= levels <= LEVELS:
        raise OptionError(
            "{0} is {levels}; give 1 to {most} levels.", "levels", levels=levels, most=LEVELS
        )
    if any(name.lower() == HEIGHT_ABOVE_GROUND for name in attributes):
        raise OptionError(
            "{0}: heights above the ground are not the same from both sides of a border; compute "
            "them before (pdal's filters.hag_nn), or leave hag out.",
            "attributes",
        )
    wavelets = checked_wavelets(wavelets)
    given = files_of(data)
    if os.path.basename(given[0]) == EPT and not given[1:]:
        given = nodes_within(read_ept(given[0]))
    paths = [os.path.abspath(path) for path in given]
    heads = _heads(paths)
    places = [head.place for head in heads]
    for path, one in zip(paths, places, strict=True):
        warn_of_crs(path, one)
    place = agreed(paths, places, any_crs=bool(crs), any_unit=bool(vertical_unit))
    system = coordinate_system(crs) if crs else coordinate_system(place.wkt)
    low, high = _extents(paths, heads)
    frame, unit = _frame(joint_name(paths), heads[0], low, high, system, place, vertical_unit)
    first_column, first_row = (int(value) for value in low.min(axis=0))
    last_column, last_row = (int(value) for value in high.max(axis=0))
    shape = (last_row - first_row + 1, last_column - first_column + 1)
    scales, offsets = heads[0].layout.scales, heads[0].layout.offsets
    ratio = _ratio(joint_name(paths), scales, frame)
    n_points = sum(head.layout.n_points for head in heads)
    spacing = _spacing(low, high, ratio, n_points)
    rows, columns = _ends(tile, shape, (scales[0], scales[1]), ratio, spacing, n_points)
    shortest = min(np.diff(rows).min() * ratio[1], np.diff(columns).min() * ratio[0])
    x0 = offsets[0] + scales[0] * (first_column - 0.5)
    y0 = offsets[1] + scales[1] * (first_row - 0.5)
    return TilePlan(
        files=_files(paths, low, high),
        shape=shape,
        transform=(scales[0], 0.0, x0, 0.0, scales[1], y0),
        rows=rows,
        columns=columns,
        levels=levels,
        reading={
            "attributes": list(attributes),
            "classes": None if classes is None else [int(one) for one in classes],
            "keep_noise": keep_noise,
            "keep_withheld": keep_withheld,
            "duplicates": DUPLICATE_RULES.chosen(duplicates).name,
        },
        wavelets=wavelets,
        system=system.to_dict(),
        frame=frame.to_dict(),
        vertical_unit=unit,
        points=PointLattice(
            scales=(scales[0], scales[1], scales[2]),
            offsets=(offsets[0], offsets[1], offsets[2]),
            first=(first_row, first_column),
            ratio=ratio,
            spacing=spacing,
            reach=max(int(shortest) // _REACH, 2 * spacing),
            n_points=n_points,
        ),
    )


def _heads(paths: Sequence[str]) -> list[CloudHead]:
    """Return what the headers of the files say; refuse files that are no clouds of one kind."""
    for path in paths:
        if suffix_of(path) not in CLOUD_SUFFIXES:
            raise InputFileError(
                f"{path}: {paths[0]} is a point cloud, this does not end in "
                f"{any_of(CLOUD_SUFFIXES)}; name files of one kind."
            )
    heads = [read_head(path) for path in paths]
    _require_alike(paths, heads)
    return heads


def _frame(
    name: str,
    head: CloudHead,
    low: NDArray[np.int64],
    high: NDArray[np.int64],
    system: CoordinateSystem,
    place: Georeference,
    vertical_unit: str | None,
) -> tuple[LocalFrame, str]:
    """Return the working frame of all files, from their extents, and the unit of z."""
    scales, offsets = np.array(head.layout.scales), np.array(head.layout.offsets)
    corners = np.array([[*low.min(axis=0), 0], [*high.max(axis=0), 0]])
    x_ends, y_ends, _ = np.sort(corners * scales + offsets, axis=0).T.tolist()
    corners[:, 2] = round((head.layout.low[2] - offsets[2]) / scales[2])
    require_plan(name, PointCloud(corners.astype(np.int32), scales, offsets), system)
    bounds = (x_ends[0], y_ends[0], x_ends[1], y_ends[1])
    return frame_of_bounds(name, system, bounds, vertical_unit or place.vertical_unit, place.fault)


def _ratio(name: str, scales: Sequence[float], frame: LocalFrame) -> tuple[int, int]:
    """Return the steps of x and of y, in metres, as small whole numbers."""
    steps = abs(scales[0]) * frame.x_scale, abs(scales[1]) * frame.y_scale
    ratio = Fraction(steps[0] / steps[1]).limit_denominator(_LARGEST_TERM)
    if not 1 <= ratio.numerator <= _LARGEST_TERM:
        raise InputFileError(
            f"{name}: x is stored in steps of {steps[0]:g} and y in steps of {steps[1]:g}; bring "
            "them to like scales first (pdal translate --writers.las.scale_x and so on)."
        )
    return ratio.numerator, ratio.denominator


def _spacing(
    low: NDArray[np.int64], high: NDArray[np.int64], ratio: tuple[int, int], n_points: int
) -> int:
    """Return the mean distance of neighbouring points, in steps; flight lines may overlap."""
    area = _covered_area((low * ratio).astype(np.float64), (high * ratio).astype(np.float64))
    return max(round(math.sqrt(area / n_points)), 1)


def _covered_area(low: NDArray[np.float64], high: NDArray[np.float64]) -> float:
    """Return the area that boxes cover, those that overlap counted once.

    In stripes between all their ends in x, in which each box runs from one side to the other.
    """
    ends = np.unique([low[:, 0], high[:, 0]])
    order = np.argsort(low[:, 1], kind="stable")
    low, high = low[order], high[order]
    covered = 0.0
    for west, east in pairwise(ends.tolist()):
        there = (low[:, 0] <= west) & (high[:, 0] >= east)
        bottom, top = low[there, 1], high[there, 1]
        if len(top):
            before = np.maximum.accumulate(np.concatenate([bottom[:1], top[:-1]]))
            covered += (east - west) * float(np.maximum(top - np.maximum(bottom, before), 0).sum())
    return covered


def _files(
    paths: Sequence[str], low: NDArray[np.int64], high: NDArray[np.int64]
) -> tuple[SourceFile, ...]:
    """Return where each file lies in the whole, and by what it is known again."""
    corners = low - low.min(axis=0)
    sizes = high - low + 1
    return tuple(
        SourceFile(
            path,
            int(corner[1]),
            int(corner[0]),
            int(size[1]),
            int(size[0]),
            os.stat(path).st_size,
            os.stat(path).st_mtime_ns,
        )
        for path, corner, size in zip(paths, corners, sizes, strict=True)
    )


def _ends(
    tile: float | tuple[float, float] | None,
    shape: tuple[int, int],
    scales: tuple[float, float],
    ratio: tuple[int, int],
    spacing: int,
    n_points: int,
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the rows and the columns where tiles end."""
    lengths = (shape[1] * ratio[0], shape[0] * ratio[1])
    if tile is None:
        # Of a narrow strip the tiles are as wide as it is.
        side = float(np.sqrt(lengths[0] * float(lengths[1]) * POINTS_IN_TILE / n_points))
        sides = [max(side, _LEAST_SIDE * spacing) / term for term in ratio]
    else:
        given = tile if isinstance(tile, tuple) else (tile, tile)
        if not all(np.isfinite(one) and one > 0 for one in given):
            raise OptionError("{0} is {tile}; give a length above 0.", "tile", tile=tile)
        # Sides far too small are refused below, but a list of their ends comes before that.
        sides = [
            max(one / abs(scale), _LEAST_SIDE * spacing / term / 4)
            for one, scale, term in zip(given, scales, ratio, strict=True)
        ]
    columns, rows = (
        ends_of_tiles(n_cells, side)
        for n_cells, side in zip((shape[1], shape[0]), sides, strict=True)
    )
    for ends, term, scale in ((columns, ratio[0], scales[0]), (rows, ratio[1], scales[1])):
        shortest, longest = np.diff(ends).min() * term, np.diff(ends).max() * term
        if len(ends) > 2 and shortest < _LEAST_SIDE * spacing:
            raise OptionError(
                "{0} is {tile}, and a tile needs some thousand points: with so many points here a "
                "side of {least:.4g} at least.",
                "tile",
                tile=tile,
                least=_LEAST_SIDE * spacing / term * abs(scale) * 1.5,
            )
        if longest > FAR // 4:
            raise OptionError(
                "{0}: a tile has more steps of the stored coordinates than can be told apart; give "
                "smaller tiles.",
                "tile",
            )
    return rows, columns


def _extents(
    paths: Sequence[str], heads: Sequence[CloudHead]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the lowest and highest stored x and y of each file, as its header says."""
    first = heads[0].layout
    lows, highs = [], []
    for path, head in zip(paths, heads, strict=True):
        ends = []
        for k in range(2):
            claimed = np.array([head.layout.low[k], head.layout.high[k]])
            if not np.isfinite(claimed).all() or claimed[0] > claimed[1]:
                raise InputFileError(
                    f"{path}: the header says that {'xy'[k]} runs from {claimed[0]:g} to "
                    f"{claimed[1]:g}; repair the header first (lasinfo -repair), tiles are "
                    "cut by it."
                )
            # Many writers round the bounds, as far as the readers of clouds let them.
            slack = 1.5 * abs(first.scales[k]) + 5e-4 * (claimed[1] - claimed[0])
            widened = np.array([claimed[0] - slack, claimed[1] + slack])
            stored = (widened - first.offsets[k]) / first.scales[k]
            ends.append((np.floor(stored.min()), np.ceil(stored.max())))
        lows.append([low for low, _ in ends])
        highs.append([high for _, high in ends])
    low, high = np.array(lows), np.array(highs)
    longest = (high.max(axis=0) - low.min(axis=0)).max() + 1
    if max(-low.min(), high.max(), longest) > _LARGEST_SHIFT:
        raise InputFileError(
            f"{joint_name(list(paths))}: the files lie too far from one another for coordinates "
            f"in steps of {max(map(abs, first.scales[:2])):g}; tile them in parts."
        )
    return low.astype(np.int64), high.astype(np.int64)


def _require_alike(paths: Sequence[str], heads: Sequence[CloudHead]) -> None:
    def described(path: str, head: CloudHead) -> list[tuple[Any, ...]]:
        point_format = laspy_header(path, head.layout).point_format
        return [
            (d.name, str(d.dtype), d.num_bits, *map(_listed, (d.scales, d.offsets)))
            for d in point_format.dimensions
        ]

    first = described(paths[0], heads[0])
    for path, head in zip(paths[1:], heads[1:], strict=True):
        if described(path, head) != first:
            raise InputFileError(
                f"{path}: its points have other dimensions than those of {paths[0]}; bring them to "
                "one point format first (pdal translate)."
            )
        shift_of(paths[0], heads[0], path, head)


def shift_of(first_name: str, first: CloudHead, name: str, head: CloudHead) -> NDArray[np.int64]:
    """Return what stored X, Y and Z of a file differ by from those of the first.

    Raises
    ------
    InputFileError
        Another scale, or offsets that differ by parts of a step.
    """
    there, here = first.layout, head.layout
    if here.scales != there.scales:
        raise InputFileError(
            f"{name}: its coordinates are stored in steps of "
            f"{', '.join(f'{s:g}' for s in here.scales)}, those of {first_name} in "
            f"{', '.join(f'{s:g}' for s in there.scales)}; bring them to one scale first "
            "(pdal translate --writers.las.scale_x and so on)."
        )
    shift = (np.array(here.offsets) - there.offsets) / there.scales
    whole = np.rint(shift)
    if np.abs(shift - whole).max() > 1e-4:
        raise InputFileError(
            f"{name}: its coordinates lie between the steps of those of {first_name} (the offsets "
            "in the headers differ by parts of a step); bring them to one offset first "
            "(pdal translate --writers.las.offset_x and so on)."
        )
    return whole.astype(np.int64)


def _listed(values: Any) -> Any:
    return None if values is None else [float(value) for value in np.ravel(values)]
