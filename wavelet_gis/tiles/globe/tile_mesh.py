"""The TIN of one tile: made from points at the finest zoom, from four tiles above it.

Vertices on the border are those of the chains (`wavelet_gis.tiles.globe.edges`) and stay; inside,
the wavelet analysis takes vertices out up to a tolerance. It works on heights above a plane, so
that level ground is round as the earth is, and its chords stay near that.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh, analyse
from wavelet_core.mesh.location import cover_of, errors_with_border
from wavelet_core.mesh.triangulation import delaunay_faces
from wavelet_gis.tiles.globe.edges import Border
from wavelet_gis.tiles.globe.tile_grid import STEPS, Tile, tile_width

__all__ = [
    "EARTH_RADIUS",
    "OnTile",
    "TileMesh",
    "errors_on",
    "finest_mesh",
    "joined",
    "on_tile",
    "simplified",
    "triangulated",
    "with_points",
    "without_slivers",
]

#: Metres.
EARTH_RADIUS = 6378137.0

#: Points so near the border of a tile, in steps, are not made vertices: they would be slivers. With
#: 1 and with 4 the bytes of two DEMs are the same to 0.05 %.
_NEAR_BORDER = 2

#: Steps by which a point may be beside its tile by rounding: positions in steps of zoom 22 are
#: exact to a ten-thousandth.
_BESIDE = 1e-3

#: Rounds in which folded faces are looked after, at most. On two DEMs 16 give the same tiles.
_ROUNDS = 8

#: Faces lower than this, in steps of their tile, are turned: rounded to those steps, points beside
#: them would be on the wrong side of an upright wall. Half of it takes 20 % more bytes on
#: TM1, which has such walls, and twice as much 0.1 % more.
_LEAST_ALTITUDE = 1.5

_AROUND = np.array([(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if (a, b) != (0, 0)])


class TileMesh(NamedTuple):
    """A TIN in steps of the finest zoom and steps of height.

    x, y, height : (n,) int64
    faces : (m, 3) int64
    """

    x: NDArray[np.int64]
    y: NDArray[np.int64]
    height: NDArray[np.int64]
    faces: NDArray[np.int64]

    def with_vertices(self, ids: NDArray[np.int64], faces: NDArray[np.int64]) -> TileMesh:
        """Return the mesh of some of the vertices."""
        return TileMesh(self.x[ids], self.y[ids], self.height[ids], faces)


class OnTile(NamedTuple):
    """A TIN in steps of its own tile, as it is written.

    u, v, height : (n,) int64
    faces : (m, 3) int64
    n_folded : int, faces that rounding has folded or flattened
    """

    u: NDArray[np.int64]
    v: NDArray[np.int64]
    height: NDArray[np.int64]
    faces: NDArray[np.int64]
    n_folded: int


def finest_mesh(
    border: Border, points: NDArray[np.float64], height_step: float, n_parts: int, fill: int
) -> TileMesh:
    """Return the TIN of all points of a tile.

    Parameters
    ----------
    border : Border
    points : (n, 3) float64
        x and y in steps, z in metres.
    height_step : float
        Metres.
    n_parts : int
        Where there are no points: the parts that level ground is cut into along each side.
    fill : int
        Height of level ground, in steps of height.
    """
    west, south = border.x.min(), border.y.min()
    width = border.x.max() - west
    inner = np.rint(points[:, :2]).astype(np.int64)
    height = np.rint(points[:, 2] / height_step).astype(np.int64)
    if not len(inner) and n_parts > 1:
        parts = np.arange(1, n_parts, dtype=np.int64) * width // n_parts
        inner = np.stack(np.meshgrid(west + parts, south + parts), axis=-1).reshape(-1, 2)
        height = np.full(len(inner), fill)
    inside = (np.minimum(inner, [west + width, south + width]) == inner).all(axis=1)
    near = np.abs(inner - [west, south]), np.abs(inner - [west + width, south + width])
    inside &= (np.minimum(*near) >= _NEAR_BORDER).all(axis=1)
    inner, height = inner[inside], height[inside]
    _, first = np.unique(inner, axis=0, return_index=True)
    first.sort()
    n_border = len(border.x)
    x = np.concatenate([border.x, inner[first, 0]])
    y = np.concatenate([border.y, inner[first, 1]])
    return TileMesh(
        x,
        y,
        np.concatenate([border.height, height[first]]),
        triangulated(x, y, np.arange(n_border)),
    )


def joined(meshes: list[TileMesh], border: Border) -> TileMesh:
    """Return the TIN of the tile that four tiles are in, without vertices between its steps.

    Parameters
    ----------
    meshes : list of TileMesh
        Of the four.
    border : Border
        Of the tile.
    """
    sizes = np.cumsum([0, *(len(mesh.x) for mesh in meshes)])
    x, y, height = (np.concatenate([mesh[k] for mesh in meshes]) for k in range(3))
    faces = np.concatenate(
        [mesh.faces + size for mesh, size in zip(meshes, sizes[:-1], strict=True)]
    )
    _, first, place = np.unique(
        np.column_stack([x, y]), axis=0, return_index=True, return_inverse=True
    )
    whole = TileMesh(x[first], y[first], height[first], place.ravel()[faces])
    west, east, south, north = border.x.min(), border.x.max(), border.y.min(), border.y.max()
    on_border = np.isin(whole.x, (west, east)) | np.isin(whole.y, (south, north))
    stays = np.isin(_keys(whole.x, whole.y), _keys(border.x, border.y))
    faces = whole.faces
    for vertex in np.flatnonzero(on_border & ~stays):
        faces = _without(whole, faces, int(vertex), on_border & stays)
    keep = np.flatnonzero(~on_border | stays)
    place = np.full(len(whole.x), -1, dtype=np.int64)
    place[keep] = np.arange(len(keep))
    left = whole.with_vertices(keep, place[faces])
    if (left.faces < 0).any() or (_doubled_areas(left.x, left.y, left.faces) <= 0).any():
        ids = _ids_of(left, border)
        left = left._replace(faces=triangulated(left.x, left.y, ids))
    return left


def simplified(
    mesh: TileMesh,
    border: Border,
    tile: Tile,
    height_step: float,
    tolerance: float,
    kept: NDArray[np.bool_],
) -> TileMesh:
    """Return the mesh with as few vertices as a tolerance allows; the border stays.

    Parameters
    ----------
    mesh : TileMesh
    border : Border
    tile : Tile
    height_step, tolerance : float
        Metres.
    kept : (n,) bool
        Other vertices that stay.
    """
    west, south = border.x.min(), border.y.min()
    width = int(border.x.max() - west)
    x, y = (mesh.x - west).astype(np.float64), (mesh.y - south).astype(np.float64)
    z = mesh.height * height_step - _fall(x / width - 0.5, y / width - 0.5, tile)
    locked = kept | np.isin(_keys(mesh.x, mesh.y), _keys(border.x, border.y))
    pyramid = analyse(
        TriangleMesh(np.column_stack([x, y, z]), mesh.faces), locked=locked, max_error=tolerance
    )
    coarse = mesh.with_vertices(pyramid.vertex_ids(0), pyramid.mesh(0).faces)
    least = _LEAST_ALTITUDE * (width // STEPS)
    return coarse._replace(faces=without_slivers(coarse.x, coarse.y, coarse.faces, least))


def with_points(
    mesh: TileMesh,
    points: NDArray[np.float64],
    height_step: float,
    kept: NDArray[np.bool_],
) -> tuple[TileMesh, NDArray[np.bool_]]:
    """Return the mesh with points as vertices, one a face, and which vertices stay, those too.

    Parameters
    ----------
    mesh : TileMesh
    points : (k, 3) float64
        x and y in steps, z in metres. Those at a vertex make that stay.
    height_step : float
        Metres.
    kept : (n,) bool
        Vertices that stay already.
    """
    places = np.rint(points[:, :2]).astype(np.int64)
    keys, own = _keys(places[:, 0], places[:, 1]), _keys(mesh.x, mesh.y)
    kept = kept | np.isin(own, keys)
    is_new = ~np.isin(keys, own)
    places, heights = places[is_new], np.rint(points[is_new, 2] / height_step).astype(np.int64)
    vertices = np.column_stack([mesh.x, mesh.y, mesh.height]).astype(np.float64)
    cover = cover_of(TriangleMesh(vertices, mesh.faces), places.astype(np.float64))
    face, first = np.unique(cover.face, return_index=True)
    chosen = cover.point[first]
    x = np.concatenate([mesh.x, places[chosen, 0]])
    y = np.concatenate([mesh.y, places[chosen, 1]])
    new = len(mesh.x) + np.arange(len(chosen))
    a, b, c = mesh.faces[face].T
    split = np.concatenate([np.column_stack([p, q, new]) for p, q in ((a, b), (b, c), (c, a))])
    faces = np.concatenate([np.delete(mesh.faces, face, axis=0), split])
    faces = without_slivers(x, y, faces, 1e-9)
    if (_doubled_areas(x, y, faces) <= 0).any():  # on the border itself, whose vertices are given
        return mesh, kept
    height = np.concatenate([mesh.height, heights[chosen]])
    return TileMesh(x, y, height, faces), np.concatenate([kept, np.ones(len(new), dtype=bool)])


def on_tile(mesh: TileMesh, tile: Tile, zoom: int) -> OnTile:
    """Return a mesh in the steps of its own tile.

    Parameters
    ----------
    mesh : TileMesh
    tile : Tile
    zoom : int
        The finest, whose steps the mesh is in.
    """
    scale = 1 << (zoom - tile.zoom)
    exact = np.stack([mesh.x / scale - tile.x * STEPS, mesh.y / scale - tile.y * STEPS], axis=1)
    places = np.rint(exact).astype(np.int64)
    is_inside = (exact > 0) & (exact < STEPS)  # and is to stay there, beside the chains
    places = np.where(is_inside, np.clip(places, 1, STEPS - 1), places)
    # Of vertices that fall together the nearest stays: on an edge, the same one on both sides.
    off = np.abs(exact - places).sum(axis=1)
    order = np.lexsort((mesh.y, mesh.x, off, places[:, 1], places[:, 0]))
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = (places[order[1:]] != places[order[:-1]]).any(axis=1)
    group = np.cumsum(is_first) - 1
    representative = np.empty(len(order), dtype=np.int64)
    representative[order] = order[is_first][group]
    kept = np.unique(representative)
    faces = np.searchsorted(kept, representative[mesh.faces])
    faces = faces[
        (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    ]
    faces = _without_folded_pairs(faces)
    used, faces = np.unique(faces, return_inverse=True)
    kept, faces = kept[used], faces.reshape(-1, 3)
    u, v = places[kept].T.copy()
    faces = without_slivers(u, v, faces, _LEAST_ALTITUDE)
    n_folded = _unfold(u, v, faces)
    return OnTile(u, v, mesh.height[kept], faces, n_folded)


def _without_folded_pairs(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the faces without those that lie on one another, one of them upside down.

    They arise where two vertices on both sides of an edge fall together. What they leave are the
    faces around them, which then meet.
    """
    # Counter-clockwise from the smallest vertex, so that a face has one form, and its back another.
    turned = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    _, own = np.unique(np.concatenate([turned, turned[:, [0, 2, 1]]]), axis=0, return_inverse=True)
    forward, backward = np.split(own.ravel(), 2)
    return faces[~np.isin(forward, backward)]


def errors_on(
    drawn: OnTile, tile: Tile, zoom: int, height_step: float, points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the heights of points above a tile as it is written, metres; NaN where it has a hole.

    Beside it by rounding they are measured at its border.
    """
    scale = 1 << (zoom - tile.zoom)
    vertices = np.column_stack([drawn.u, drawn.v, drawn.height * height_step])
    places = points.copy()
    places[:, 0] = points[:, 0] / scale - tile.x * STEPS
    places[:, 1] = points[:, 1] / scale - tile.y * STEPS
    return errors_with_border(TriangleMesh.from_triangles(vertices, drawn.faces), places, _BESIDE)


def without_slivers(
    x: NDArray[np.int64], y: NDArray[np.int64], faces: NDArray[np.int64], least: float
) -> NDArray[np.int64]:
    """Return the faces with flat ones joined to their neighbours and cut the other way.

    Parameters
    ----------
    x, y : (n,) int64
    faces : (m, 3) int64
    least : float
        A face is flat where its smallest altitude is below this.
    """
    faces, n_vertices = faces.copy(), len(x)
    for _ in range(_ROUNDS):
        altitude, longest = _altitudes(x, y, faces)
        flat = np.flatnonzero(altitude < least)
        if not len(flat):
            break
        tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
        keys = tail * n_vertices + head
        order = np.argsort(keys)
        keys = keys[order]
        is_touched = np.zeros(len(faces), dtype=bool)
        for face in flat[np.argsort(altitude[flat], kind="stable")]:
            a, b, c = np.roll(faces[face], -longest[face])
            place = int(np.searchsorted(keys, b * n_vertices + a))
            if is_touched[face] or place == len(keys) or keys[place] != b * n_vertices + a:
                continue
            other, corner = divmod(int(order[place]), 3)
            if is_touched[other]:
                continue
            d = faces[other, (corner + 2) % 3]
            if d == c:  # the same face from below
                continue
            turned = np.array([[a, d, c], [d, b, c]])
            if _altitudes(x, y, turned)[0].min() > min(altitude[face], altitude[other]):
                faces[face], faces[other] = turned
                is_touched[[face, other]] = True
        if not is_touched.any():
            break
    return faces


def _altitudes(
    x: NDArray[np.int64], y: NDArray[np.int64], faces: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the smallest altitude of each face, negative where folded, and its longest edge."""
    x, y = _multiplied_safely(x), _multiplied_safely(y)
    ends = np.roll(faces, -1, axis=1)
    squared = (x[ends] - x[faces]) ** 2 + (y[ends] - y[faces]) ** 2
    longest = squared.argmax(axis=1)
    return _doubled_areas(x, y, faces) / np.sqrt(np.maximum(squared.max(axis=1), 1)), longest


def _fall(across: NDArray, up: NDArray, tile: Tile) -> NDArray[np.float64]:
    """Return how far the earth falls off the plane that touches it in the middle of a tile."""
    width = np.radians(tile_width(tile.zoom))
    middle = np.radians((tile.y + 0.5) * tile_width(tile.zoom) - 90.0)
    squared = (across * width * np.cos(middle)) ** 2 + (up * width) ** 2
    return EARTH_RADIUS * squared / 2


def _without(
    mesh: TileMesh, faces: NDArray[np.int64], vertex: int, may_take: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Return the faces with a vertex of the border moved into one beside it on the border."""
    own = np.flatnonzero((faces == vertex).any(axis=1))
    ring = np.unique(faces[own])
    near = ring[
        may_take[ring] & ((mesh.x[ring] == mesh.x[vertex]) | (mesh.y[ring] == mesh.y[vertex]))
    ]
    distance = np.abs(mesh.x[near] - mesh.x[vertex]) + np.abs(mesh.y[near] - mesh.y[vertex])
    for target in near[np.argsort(distance, kind="stable")]:
        moved = faces[own].copy()
        moved = moved[~(moved == target).any(axis=1)]
        moved[moved == vertex] = target
        if (_doubled_areas(mesh.x, mesh.y, moved) > 0).all():
            return np.concatenate([np.delete(faces, own, axis=0), moved])
    return np.delete(faces, own, axis=0) if not len(near) else _moved(faces, own, vertex, near[0])


def _moved(faces: NDArray[np.int64], own: NDArray, vertex: int, target: int) -> NDArray[np.int64]:
    moved = faces[own]
    moved = moved[~(moved == target).any(axis=1)]
    moved[moved == vertex] = target
    return np.concatenate([np.delete(faces, own, axis=0), moved])


def triangulated(
    x: NDArray[np.int64], y: NDArray[np.int64], loop: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the Delaunay faces with the edges of a loop of vertices."""
    plan = np.column_stack([x - x.min(), y - y.min()]).astype(np.float64)
    return delaunay_faces(plan, np.column_stack([loop, np.roll(loop, -1)]))


def _ids_of(mesh: TileMesh, border: Border) -> NDArray[np.int64]:
    keys = _keys(mesh.x, mesh.y)
    order = np.argsort(keys)
    return order[np.searchsorted(keys[order], _keys(border.x, border.y))]


def _keys(x: NDArray[np.int64], y: NDArray[np.int64]) -> NDArray[np.complex128]:
    """Return one number for each place; whole numbers below 2^53 are exact."""
    return x + 1j * y


def _multiplied_safely(places: NDArray[np.int64]) -> NDArray[Any]:
    """Return places whose differences can be multiplied: themselves, or, far apart, as floats.

    The tiles of zoom 0 are ``STEPS << zoom`` wide in steps of the finest zoom, 37 bits at zoom 22.
    Differences are exact as floats, and products of two are in the order of the exact ones.
    """
    extent = int(places.max()) - int(places.min()) if len(places) else 0
    return places if extent < 1 << 31 else places.astype(np.float64)


def _doubled_areas(
    x: NDArray[np.int64], y: NDArray[np.int64], faces: NDArray[np.int64]
) -> NDArray[Any]:
    a, b, c = faces.T
    x, y = _multiplied_safely(x), _multiplied_safely(y)
    return (x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a])


def _unfold(u: NDArray[np.int64], v: NDArray[np.int64], faces: NDArray[np.int64]) -> int:
    """Move vertices inside by one step where faces have folded; return how many stay so."""
    inside = (u > 0) & (u < STEPS) & (v > 0) & (v < STEPS)
    for _ in range(_ROUNDS):
        bad = np.flatnonzero(_doubled_areas(u, v, faces) <= 0)
        if not len(bad):
            return 0
        for vertex in np.unique(faces[bad]):
            if not inside[vertex]:
                continue
            star = faces[(faces == vertex).any(axis=1)]
            if (_doubled_areas(u, v, star) > 0).all():
                continue
            at_u, at_v = u[vertex], v[vertex]
            for across, up in _AROUND:
                u[vertex], v[vertex] = at_u + across, at_v + up
                if inside[vertex] and (_doubled_areas(u, v, star) > 0).all():
                    break
            else:
                u[vertex], v[vertex] = at_u, at_v
    return int((_doubled_areas(u, v, faces) <= 0).sum())
