"""A second reading of quantized-mesh, from the text of its specification; shares no line with ours.

https://github.com/CesiumGS/quantized-mesh
"""

from dataclasses import dataclass

import numpy as np

STEPS = 32767


@dataclass
class DecodedTile:
    """One tile: the numbers that are stored, and what they mean."""

    centre: np.ndarray
    low: float
    high: float
    sphere: np.ndarray
    radius: float
    horizon: np.ndarray
    u: np.ndarray
    v: np.ndarray
    h: np.ndarray
    triangles: np.ndarray
    edges: dict
    extensions: dict

    def heights(self):
        """Return heights in metres, as the specification has them."""
        return self.low + self.h / STEPS * (self.high - self.low)

    def edge(self, name):
        """Return (position along the edge, height) of an edge's vertices in their order."""
        ids = self.edges[name]
        along = self.v if name in ("west", "east") else self.u
        order = np.argsort(along[ids], kind="stable")
        return list(
            zip(along[ids][order].tolist(), self.heights()[ids][order].tolist(), strict=True)
        )


class _Cursor:
    def __init__(self, content):
        self.content, self.at = content, 0

    def take(self, dtype, count=1):
        array = np.frombuffer(self.content, dtype, count, self.at)
        self.at += array.nbytes
        return array

    def align(self, size):
        while self.at % size:
            self.at += 1


def decode(content):
    """Return the tile in some bytes."""
    cursor = _Cursor(content)
    centre = cursor.take("<f8", 3)
    low, high = cursor.take("<f4", 2)
    sphere, radius, horizon = cursor.take("<f8", 3), cursor.take("<f8")[0], cursor.take("<f8", 3)
    n_vertices = int(cursor.take("<u4")[0])
    columns = []
    for _ in range(3):
        value, column = 0, []
        for code in cursor.take("<u2", n_vertices).tolist():
            value += (code >> 1) ^ -(code & 1)
            column.append(value)
        columns.append(np.array(column))
    index = "<u4" if n_vertices > 65536 else "<u2"
    cursor.align(4 if n_vertices > 65536 else 2)
    n_triangles = int(cursor.take("<u4")[0])
    highest, indices = 0, []
    for code in cursor.take(index, 3 * n_triangles).tolist():
        indices.append(highest - code)
        highest += code == 0
    edges = {}
    for name in ("west", "south", "east", "north"):
        edges[name] = cursor.take(index, int(cursor.take("<u4")[0])).astype(int)
    extensions = {}
    while cursor.at < len(content):
        kind, size = int(cursor.take("u1")[0]), int(cursor.take("<u4")[0])
        extensions[kind] = bytes(cursor.take("u1", size))
    assert cursor.at == len(content)
    return DecodedTile(
        centre,
        float(low),
        float(high),
        sphere,
        float(radius),
        horizon,
        *columns,
        np.array(indices).reshape(-1, 3),
        edges,
        extensions,
    )


def bounds_of(z, x, y):
    """Return west, south, east and north of a tile in degrees."""
    size = 180.0 / 2**z
    return -180.0 + x * size, -90.0 + y * size, -180.0 + (x + 1) * size, -90.0 + (y + 1) * size
