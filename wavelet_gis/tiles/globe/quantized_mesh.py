"""A TIN as one tile of quantized-mesh 1.0, the format of terrain for globes.

Written here and not by the library quantized-mesh-encoder, since that gives each tile a scale of
heights of its own: the same height is then rounded otherwise on the two sides of an edge. Here
heights are whole multiples of a power of two, in every tile.

References
----------
https://github.com/CesiumGS/quantized-mesh
"""

from __future__ import annotations

import struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["QuantizedTile", "encoded_tile", "geocentric"]

#: Semi-axes of WGS 84.
_SEMI_MAJOR, _SEMI_MINOR = 6378137.0, 6356752.314245179
_STEPS = 32767
_OCT_NORMALS = 1
#: What is written for a tile that is too large to be hidden by the horizon: a point far above it.
_ALWAYS_SEEN = 1e3

FloatArray = NDArray[np.float64]


class QuantizedTile(NamedTuple):
    """A tile in whole numbers.

    bounds : west, south, east and north in degrees
    u, v : (n,) int, 0 to 32767 from west to east and from south to north
    heights : (n,) int, in units of ``height_step``
    height_step : float, metres, a power of two
    faces : (m, 3) int, counter-clockwise from above
    normals : (n, 3) float64 or None, unit vectors from the centre of the earth
    """

    bounds: tuple[float, float, float, float]
    u: NDArray[np.int64]
    v: NDArray[np.int64]
    heights: NDArray[np.int64]
    height_step: float
    faces: NDArray[np.int64]
    normals: FloatArray | None = None


def encoded_tile(tile: QuantizedTile) -> bytes:
    """Return the bytes of a tile.

    Raises
    ------
    ValueError
        Numbers that the format cannot hold.
    """
    order, faces = _in_order_of_use(tile.faces, len(tile.u))
    u, v, heights = tile.u[order], tile.v[order], tile.heights[order]
    lowest = int(heights.min())
    if min(u.min(), v.min()) < 0 or max(u.max(), v.max(), int(heights.max()) - lowest) > _STEPS:
        raise ValueError("the tile holds numbers beyond 0 to 32767")
    low, high = lowest * tile.height_step, (lowest + _STEPS) * tile.height_step
    if not float(np.float32(low)) == low or not float(np.float32(high)) == high:
        raise ValueError("the heights have more digits than the format holds")
    is_long = len(u) > 65536
    index = np.dtype("<u4" if is_long else "<u2")
    parts = [_header(tile.bounds, u, v, heights.astype(np.float64) * tile.height_step, low, high)]
    parts.append(struct.pack("<I", len(u)))
    parts += [_zigzag_differences(values).tobytes() for values in (u, v, heights - lowest)]
    size = sum(map(len, parts))
    parts.append(b"\0" * (-size % index.itemsize))
    parts.append(struct.pack("<I", len(faces)))
    parts.append(_below_high_water(faces.ravel()).astype(index).tobytes())
    for along, across, edge in ((v, u, 0), (u, v, 0), (v, u, _STEPS), (u, v, _STEPS)):
        on_edge = np.flatnonzero(across == edge)
        on_edge = on_edge[np.argsort(along[on_edge], kind="stable")]
        parts.append(struct.pack("<I", len(on_edge)) + on_edge.astype(index).tobytes())
    if tile.normals is not None:
        oct_encoded = _oct_encoded(tile.normals[order]).tobytes()
        parts.append(struct.pack("<BI", _OCT_NORMALS, len(oct_encoded)) + oct_encoded)
    return b"".join(parts)


def geocentric(longitude: FloatArray, latitude: FloatArray, height: FloatArray) -> FloatArray:
    """Return x, y, z from the centre of the earth of places in degrees on WGS 84."""
    lon, lat = np.radians(longitude), np.radians(latitude)
    eccentricity = 1 - (_SEMI_MINOR / _SEMI_MAJOR) ** 2
    normal = _SEMI_MAJOR / np.sqrt(1 - eccentricity * np.sin(lat) ** 2)
    return np.stack(
        [
            (normal + height) * np.cos(lat) * np.cos(lon),
            (normal + height) * np.cos(lat) * np.sin(lon),
            (normal * (1 - eccentricity) + height) * np.sin(lat),
        ],
        axis=-1,
    )


def _header(
    bounds: tuple[float, float, float, float],
    u: NDArray[np.int64],
    v: NDArray[np.int64],
    heights: FloatArray,
    low: float,
    high: float,
) -> bytes:
    west, south, east, north = bounds
    places = geocentric(
        west + u / _STEPS * (east - west), south + v / _STEPS * (north - south), heights
    )
    middle = np.array([(west + east) / 2, (south + north) / 2, (heights.min() + heights.max()) / 2])
    centre = geocentric(*middle)
    sphere = (places.min(axis=0) + places.max(axis=0)) / 2
    radius = float(np.linalg.norm(places - sphere, axis=1).max())
    return struct.pack(
        "<3d2f3dd3d", *centre, low, high, *sphere, radius, *_horizon_point(places, sphere)
    )


def _horizon_point(places: FloatArray, towards: FloatArray) -> FloatArray:
    """Return the point, in a space where the earth is a unit sphere, hidden only if the tile is."""
    axes = np.array([_SEMI_MAJOR, _SEMI_MAJOR, _SEMI_MINOR])
    direction = towards / axes
    length = np.linalg.norm(direction)
    if length < 1e-9:
        return np.array([0.0, 0.0, _ALWAYS_SEEN])
    direction /= length
    scaled = places / axes
    size = np.linalg.norm(scaled, axis=1)
    unit = scaled / size[:, None]
    size = np.maximum(size, 1.0)
    cos_alpha = unit @ direction
    sin_alpha = np.linalg.norm(np.cross(unit, direction), axis=1)
    cos_beta = 1 / size
    sin_beta = np.sqrt(np.maximum(size**2 - 1, 0)) * cos_beta
    denominator = cos_alpha * cos_beta - sin_alpha * sin_beta
    if denominator.min() <= 1 / _ALWAYS_SEEN:
        return direction * _ALWAYS_SEEN
    return direction * float((1 / denominator).max())


def _in_order_of_use(
    faces: NDArray[np.int64], n_vertices: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the vertices in the order in which faces name them first, and the faces so."""
    flat = faces.ravel()
    used, first = np.unique(flat, return_index=True)
    order = used[np.argsort(first, kind="stable")]
    place = np.full(n_vertices, -1, dtype=np.int64)
    place[order] = np.arange(len(order))
    return order, place[faces]


def _zigzag_differences(values: NDArray[np.int64]) -> NDArray[np.uint16]:
    differences = np.diff(values, prepend=0)
    return ((differences << 1) ^ (differences >> 63)).astype("<u2")


def _below_high_water(indices: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return how far each index is below the first one that was not used before it."""
    highest = np.maximum.accumulate(indices)
    before = np.concatenate([[-1], highest[:-1]]) + 1
    return before - indices


def _oct_encoded(normals: FloatArray) -> NDArray[np.uint8]:
    x, y, z = (normals / np.abs(normals).sum(axis=1, keepdims=True)).T
    folded_x = np.where(z < 0, (1 - np.abs(y)) * np.where(x < 0, -1, 1), x)
    folded_y = np.where(z < 0, (1 - np.abs(x)) * np.where(y < 0, -1, 1), y)
    both = np.column_stack([folded_x, folded_y])
    return np.rint((np.clip(both, -1, 1) * 0.5 + 0.5) * 255).astype(np.uint8)
