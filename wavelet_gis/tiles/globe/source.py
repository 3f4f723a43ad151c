"""The surface that a globe is tiled from: a TIN in steps of the finest zoom, and what is around it.

Outside its outline the surface goes on level for one spacing of its vertices, falls (or rises) to
the height of filling over some more, and stays there; so the slope is beside the data, not in them.
Holes inside are spanned by triangles between the vertices of their rims.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from wavelet_core import TriangleMesh
from wavelet_core.mesh.location import cover_of, surface_errors
from wavelet_core.mesh.triangulation import delaunay_faces
from wavelet_gis.tiles.globe.tile_grid import STEPS, Tile, steps_of_degrees

__all__ = ["GlobePoints", "SourceSurface", "source_surface"]

FloatArray = NDArray[np.float64]

_AROUND = np.column_stack([f(np.arange(6) * (np.pi / 3)) for f in (np.cos, np.sin)])

#: Spacings outside the outline at which the ground has come to the height of filling: so many that
#: rounding to the steps of coarse zooms is little against the slope.
FALL = 8


#: Part of the way outside that a place around the outline must be from all vertices of the outline.
_CLEAR = 0.7


class GlobePoints(NamedTuple):
    """A TIN on the earth.

    longitude, latitude : (n,) float64, degrees on WGS 84
    height : (n,) float64, metres
    faces : (m, 3) int
    others : (k, 3) float64, longitude, latitude and height of points that were merged with a vertex
    """

    longitude: FloatArray
    latitude: FloatArray
    height: FloatArray
    faces: NDArray[np.int64]
    others: FloatArray = np.empty((0, 3))


class _Sorted(NamedTuple):
    """Points by tile.

    points : (n, 3) float64, x and y in steps of a zoom, sorted by the tile they are in
    tile : (n,) int64, as ``row * columns + column``
    """

    points: FloatArray
    tile: NDArray[np.int64]

    @classmethod
    def of(cls, points: FloatArray, zoom: int) -> _Sorted:
        """Return points sorted by their tiles of a zoom."""
        columns = 2 << zoom
        at = np.clip(np.floor(points[:, :2] / STEPS), 0, [columns - 1, columns // 2 - 1])
        tile = (at[:, 1] * columns + at[:, 0]).astype(np.int64)
        order = np.argsort(tile, kind="stable")
        return cls(points[order], tile[order])

    def within(self, tile: Tile, zoom: int) -> FloatArray:
        """Return the points in a tile of their zoom or a coarser one."""
        k = zoom - tile.zoom
        rows = np.arange(tile.y << k, (tile.y + 1) << k, dtype=np.int64) * (2 << zoom)
        first = np.searchsorted(self.tile, rows + (tile.x << k))
        last = np.searchsorted(self.tile, rows + ((tile.x + 1) << k))
        return np.concatenate([self.points[a:b] for a, b in zip(first, last, strict=True)])


@dataclass(frozen=True, slots=True)
class SourceSurface:
    """The TIN and its surroundings in steps of the finest zoom.

    Attributes
    ----------
    zoom : int
        The finest.
    points, others : sorted points
        The vertices, and the points that were merged with one; z in metres.
    ring : (k, 3) float64
        Places around the outline, at the height of the outline or of filling.
    whole : TriangleMesh
        The TIN, and triangles around it and over its holes, which meet vertices without faces.
    fill : float
        Height of the ground outside, metres.
    """

    zoom: int
    points: _Sorted
    others: _Sorted
    ring: FloatArray
    whole: TriangleMesh
    fill: float

    def heights_at(self, plan: FloatArray) -> FloatArray:
        """Return the heights of places in steps, ``(n, 2)``, in metres."""
        places = np.column_stack([plan, np.zeros(len(plan))])
        heights = -surface_errors(self.whole, places, cover_of(self.whole, plan))
        return np.where(np.isnan(heights), self.fill, heights)

    @property
    def n_points(self) -> int:
        """Number of vertices."""
        return len(self.points.points)

    def points_in(self, tile: Tile) -> FloatArray:
        """Return the vertices of a tile of any zoom."""
        return self.points.within(tile, self.zoom)

    def others_in(self, tile: Tile) -> FloatArray:
        """Return the points of a tile of any zoom that were merged with a vertex."""
        return self.others.within(tile, self.zoom)

    def ring_in(self, tile: Tile) -> FloatArray:
        """Return the places around the outline in a tile of the finest zoom."""
        at = np.floor(self.ring[:, :2] / STEPS)
        return self.ring[(at[:, 0] == tile.x) & (at[:, 1] == tile.y)]

    def extent(self) -> FloatArray:
        """Return the smallest and the largest x and y of points and ring, ``(2, 2)``."""
        both = np.concatenate([self.points.points, self.ring])[:, :2]
        return np.stack([both.min(axis=0), both.max(axis=0)])


def source_surface(globe: GlobePoints, zoom: int, fill: float) -> SourceSurface:
    """Return the surface of a TIN for tiles up to a zoom.

    Parameters
    ----------
    globe : GlobePoints
    zoom : int
        The finest.
    fill : float
        Height of the ground outside, metres.
    """
    x, y = steps_of_degrees(globe.longitude, globe.latitude, zoom)
    vertices = np.column_stack([x, y, globe.height])
    used = np.unique(globe.faces)
    place = np.full(len(x), -1, dtype=np.int64)
    place[used] = np.arange(len(used))
    tin = TriangleMesh.from_triangles(vertices[used], place[globe.faces])
    lone = np.delete(vertices, used, axis=0)
    ring = _ring(tin, lone, fill)
    whole = _with_surroundings(tin, ring, lone, fill)
    x, y = steps_of_degrees(globe.others[:, 0], globe.others[:, 1], zoom)
    others = np.column_stack([x, y, globe.others[:, 2]])
    by_tile, merged = _Sorted.of(vertices, zoom), _Sorted.of(others, zoom)
    return SourceSurface(zoom, by_tile, merged, ring, whole, fill)


def _outline(faces: NDArray[np.int64], n_vertices: int) -> NDArray[np.int64]:
    """Return the edges of one face, with that on their left, ``(k, 2)``."""
    tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    keys, back = tail * n_vertices + head, head * n_vertices + tail
    alone = ~np.isin(keys, back, assume_unique=True)
    return np.column_stack([tail[alone], head[alone]])


def _ring(tin: TriangleMesh, lone: FloatArray, fill: float) -> FloatArray:
    """Return places around the outer outlines: beside them, and where the filling begins.

    A vertex without faces has six of each around it.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edges = _outline(tin.faces, tin.n_vertices)
    plan = tin.vertices[:, :2]
    data = cKDTree(np.concatenate([plan[np.unique(edges)], lone[:, :2]]))
    tail, head = plan[edges[:, 0]], plan[edges[:, 1]]
    graph = coo_array(
        (np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(tin.n_vertices,) * 2
    )
    _, loop_of_vertex = connected_components(graph, directed=False)
    loop = loop_of_vertex[edges[:, 0]]
    origin = plan.mean(axis=0)
    a, b = tail - origin, head - origin
    area = np.bincount(loop, a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    outer = area[loop] > 0
    edges, along = edges[outer], (head - tail)[outer]
    outward = np.column_stack([along[:, 1], -along[:, 0]])
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    normal = np.zeros_like(plan)
    np.add.at(normal, edges[:, 0], outward)
    np.add.at(normal, edges[:, 1], outward)
    rim = np.unique(edges)
    size = np.linalg.norm(normal[rim], axis=1, keepdims=True)
    rim, normal = rim[size[:, 0] > 1e-6], (normal[rim] / np.maximum(size, 1e-6))[size[:, 0] > 1e-6]
    spacing = np.sqrt(tin.plan_areas.sum() / tin.n_vertices)
    middle = np.concatenate([tin.vertices[rim], np.repeat(lone, len(_AROUND), axis=0)])
    away = np.concatenate([normal, np.tile(_AROUND, (len(lone), 1))])
    near, far = (np.rint(middle[:, :2] + k * spacing * away) for k in (1, FALL))
    # What lies across a bay or a narrow gap would be a wall at the shore on its other side.
    of_near, of_far = (
        data.query(places)[0] >= _CLEAR * k * spacing for places, k in ((near, 1), (far, FALL))
    )
    ring = np.concatenate(
        [
            np.column_stack([near, middle[:, 2]])[of_near],
            np.column_stack([far, np.full(len(far), fill)])[of_far],
        ]
    )
    _, first = np.unique(ring[:, :2], axis=0, return_index=True)
    ring = ring[np.sort(first)]
    if len(lone):  # which are as high as they are, whatever is around others
        ring = ring[cKDTree(lone[:, :2]).query(ring[:, :2])[0] >= 0.5 * spacing]
    return np.delete(ring, cover_of(tin, ring[:, :2]).point, axis=0)


def _with_surroundings(
    tin: TriangleMesh, ring: FloatArray, lone: FloatArray, fill: float
) -> TriangleMesh:
    lone = np.delete(lone, cover_of(tin, lone[:, :2]).point, axis=0)
    ring = np.concatenate([ring, lone])
    edges = _outline(tin.faces, tin.n_vertices)
    rim = np.unique(edges)
    low, high = ring[:, :2].min(axis=0) - 4 * STEPS, ring[:, :2].max(axis=0) + 4 * STEPS
    box = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    plan = np.concatenate([tin.vertices[rim, :2], ring[:, :2], box])
    ids = np.concatenate([rim, tin.n_vertices + np.arange(len(ring) + 4)])
    faces = delaunay_faces(plan - low, np.searchsorted(rim, edges))
    middle = plan[faces].mean(axis=1)
    is_outside = np.ones(len(faces), dtype=bool)
    is_outside[cover_of(tin, middle).point] = False
    filled = np.concatenate([ring, np.column_stack([box, np.full(4, fill)])])
    return TriangleMesh(
        np.concatenate([tin.vertices, filled]),
        np.concatenate([tin.faces, ids[faces[is_outside]]]),
    )
