"""Entwine Point Tiles: LAZ files, the nodes of an octree, in a folder with ``ept.json``.

Every point is in one node: those of level 0 are few points of all, each level beneath has twice the
density. ``ept-hierarchy`` says which nodes there are. What it says is held against the files.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from wavelet_core import PyramidError
from wavelet_gis._fields import Fields, parse_json
from wavelet_gis.errors import InputFileError, PointCloudWarning
from wavelet_gis.io.formats import EPT
from wavelet_gis.io.las.layout import read_layout
from wavelet_gis.io.las.octree import MOST_LEVELS, Box, finest_level, reaches_into
from wavelet_gis.notes import warn

__all__ = ["EptSet", "nodes_within", "read_ept"]

#: What a hierarchy has in the place of points for a node that has a file of its own.
_ELSEWHERE = -1

#: Level, x, y and z of a node.
_KEY = re.compile(r"(\d{1,2})-(\d{1,10})-(\d{1,10})-(\d{1,10})")

_MOST_POINTS = 2**63 - 1


class EptSet(NamedTuple):
    """What ``ept.json`` says.

    folder : Path
    bounds : list of float, smallest x, y and z of the cube, then the largest
    span : int, points along the side of a node, at its spacing
    wkt : str or None, the CRS
    """

    folder: Path
    bounds: list[float]
    span: int
    wkt: str | None


class Node(NamedTuple):
    """A node of the octree, and how many points the hierarchy says it has."""

    level: int
    x: int
    y: int
    z: int
    n_points: int

    @property
    def name(self) -> str:
        """Its name in the hierarchy, and of its file."""
        return f"{self.level}-{self.x}-{self.y}-{self.z}"


def read_ept(path: str | os.PathLike[str]) -> EptSet:
    """Return what ``ept.json`` says.

    Raises
    ------
    InputFileError
        It cannot be read, is damaged, or its nodes are no LAZ files.
    """
    file = Path(path)
    fields = _fields_of(file)
    kind = fields.text("dataType")
    if kind != "laszip":
        raise InputFileError(
            f"{file}: its points are stored as {kind!r}, which is not read; bring them to LAZ "
            "(pdal translate ept.json cloud.copc.laz)."
        )
    bounds = fields.numbers("bounds", 6)
    if not all(low < high for low, high in zip(bounds[:3], bounds[3:], strict=True)):
        raise InputFileError(f"{file}: the bounds {bounds} hold nothing; get the set again.")
    srs = fields.fields("srs") if fields.get("srs") else {}
    wkt = srs.text("wkt") if isinstance(srs, Fields) and srs.get("wkt") else None
    return EptSet(file.parent, bounds, fields.integer("span", 1, 1 << 20), wkt)


def nodes_within(
    ept: EptSet, bbox: Box | None = None, resolution: float | None = None
) -> list[str]:
    """Return the files of the nodes that reach into a box, down to a resolution, coarsest first.

    Parameters
    ----------
    ept : EptSet
    bbox : tuple of float, optional
        Smallest x and y, largest x and y.
    resolution : float, optional
        Spacing of the points that is enough, in the unit of x and y; by default all levels.

    Raises
    ------
    InputFileError
        The hierarchy or a node is missing or damaged, or there is no point there.

    Warns
    -----
    PointCloudWarning
        Where the hierarchy counts other points than the files have.
    """
    low, high = ept.bounds[:3], ept.bounds[3:]
    finest = finest_level((high[0] - low[0]) / ept.span, resolution)
    found = []
    for node in sorted(_nodes(ept)):
        if node.level > finest or node.n_points == 0:
            continue
        sides = (high[0] - low[0]) / 2**node.level, (high[1] - low[1]) / 2**node.level
        west, south = low[0] + node.x * sides[0], low[1] + node.y * sides[1]
        if reaches_into(west, south, sides, bbox):
            found.append(node)
    if not found:
        raise InputFileError(
            "{path}: no node of the set reaches into the box; its x runs from {west:.10g} to "
            "{east:.10g} and its y from {south:.10g} to {north:.10g}: give another {0}.",
            "bbox",
            path=ept.folder / EPT,
            west=low[0],
            east=high[0],
            south=low[1],
            north=high[1],
        )
    return [_file_of(ept, node) for node in found]


def _file_of(ept: EptSet, node: Node) -> str:
    """Return the file of a node; warn where it has another number of points."""
    path = ept.folder / "ept-data" / f"{node.name}.laz"
    try:
        with open(path, "rb") as stream:
            n_points = read_layout(os.fspath(path), stream).n_points
    except OSError as error:
        raise InputFileError(
            f"{path}: this node of {ept.folder / EPT} cannot be read ({error.strerror}); get the "
            "set again."
        ) from error
    if n_points != node.n_points:
        warn(
            PointCloudWarning,
            "ept_counts",
            "{name}: the hierarchy of the set counts {due:,} points there, the file has {n:,}; if "
            "that is no old mistake, get the set again",
            stacklevel=4,
            name=os.fspath(path),
            due=node.n_points,
            n=n_points,
        )
    return os.fspath(path)


def _nodes(ept: EptSet) -> Iterator[Node]:
    """Yield the nodes of the hierarchy, each once, whatever file it is listed in."""
    waiting, seen = [Node(0, 0, 0, 0, _ELSEWHERE)], set()
    listed: set[tuple[int, ...]] = set()
    while waiting:
        page = waiting.pop()
        file = ept.folder / "ept-hierarchy" / f"{page.name}.json"
        for name, count in _fields_of(file).items():
            node = _node(name, count)
            if node is None:
                raise InputFileError(f"{file}: {name[:40]!r} is no node; get the set again.")
            if count != _ELSEWHERE:
                if node[:4] not in listed:
                    listed.add(node[:4])
                    yield node
            elif node[:4] not in seen:  # a page that lists itself is read once
                seen.add(node[:4])
                waiting.append(node)


def _node(name: str, count: object) -> Node | None:
    """Return the node of a row of a hierarchy; None where there can be none of that name."""
    match = _KEY.fullmatch(name)
    if match is None or not isinstance(count, int) or not _ELSEWHERE <= count <= _MOST_POINTS:
        return None
    level, x, y, z = map(int, match.groups())
    if level >= MOST_LEVELS or max(x, y, z) >= 1 << level:
        return None
    return Node(level, x, y, z, count)


def _fields_of(file: Path) -> Fields:
    try:
        text = file.read_text("utf-8")
        return Fields(parse_json(text, os.fspath(file)), os.fspath(file), InputFileError)
    except (OSError, UnicodeDecodeError) as error:
        raise InputFileError(
            f"{file}: this file of a point tile set cannot be read "
            f"({getattr(error, 'strerror', None) or 'no text'}); get the set again."
        ) from error
    except PyramidError as error:
        raise InputFileError(f"{error}") from error
