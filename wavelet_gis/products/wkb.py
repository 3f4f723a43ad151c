"""Points, triangles, lines and boxes as well-known binary, built by numpy for millions at once."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["boxes_wkb", "lines_wkb", "points_wkb", "triangles_wkb"]

_LITTLE_ENDIAN = 1
_POLYGON, _POINT_Z, _LINE_Z, _POLYGON_Z = 3, 1001, 1002, 1003

_POINT = np.dtype([("order", "u1"), ("type", "<u4"), ("xyz", "<f8", (3,))])
_TRIANGLE = np.dtype(
    [
        ("order", "u1"),
        ("type", "<u4"),
        ("n_rings", "<u4"),
        ("n_corners", "<u4"),
        ("xyz", "<f8", (4, 3)),
    ]
)


_BOX = np.dtype(
    [
        ("order", "u1"),
        ("type", "<u4"),
        ("n_rings", "<u4"),
        ("n_corners", "<u4"),
        ("xy", "<f8", (5, 2)),
    ]
)


def points_wkb(vertices: NDArray[np.float64]) -> NDArray[Any]:
    """Return ``(n,)`` bytes objects, a Point Z for each row of ``(n, 3)`` coordinates."""
    records = np.empty(len(vertices), dtype=_POINT)
    records["order"], records["type"] = _LITTLE_ENDIAN, _POINT_Z
    records["xyz"] = vertices
    return _as_bytes(records)


def triangles_wkb(vertices: NDArray[np.float64], faces: NDArray[Any]) -> NDArray[Any]:
    """Return ``(n,)`` bytes objects, a Polygon Z with a closed ring for each face."""
    records = np.empty(len(faces), dtype=_TRIANGLE)
    records["order"], records["type"] = _LITTLE_ENDIAN, _POLYGON_Z
    records["n_rings"], records["n_corners"] = 1, 4
    records["xyz"] = vertices[faces[:, [0, 1, 2, 0]]]
    return _as_bytes(records)


def boxes_wkb(boxes: NDArray[np.float64]) -> NDArray[Any]:
    """Return ``(n,)`` bytes objects, a Polygon for each row of ``(n, 4)`` ends in x and y.

    Smallest x and y come first, then the largest.
    """
    records = np.empty(len(boxes), dtype=_BOX)
    records["order"], records["type"] = _LITTLE_ENDIAN, _POLYGON
    records["n_rings"], records["n_corners"] = 1, 5
    records["xy"] = boxes[:, [2, 1, 2, 3, 0, 3, 0, 1, 2, 1]].reshape(-1, 5, 2)
    return _as_bytes(records)


def lines_wkb(lines: Sequence[NDArray[np.float64]]) -> NDArray[Any]:
    """Return ``(n,)`` bytes objects, a LineString Z for each ``(m, 3)`` array of coordinates."""
    objects = np.empty(len(lines), dtype=object)
    for k, line in enumerate(lines):
        head = struct.pack("<BII", _LITTLE_ENDIAN, _LINE_Z, len(line))
        objects[k] = head + np.ascontiguousarray(line, dtype="<f8").tobytes()
    return objects


def _as_bytes(records: NDArray[Any]) -> NDArray[Any]:
    packed = records.view(f"V{records.dtype.itemsize}").tolist()
    objects = np.empty(len(packed), dtype=object)
    objects[:] = packed
    return objects
