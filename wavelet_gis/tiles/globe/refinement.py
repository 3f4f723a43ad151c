"""Points added to a tile until none of the input is farther off than promised.

What is drawn of a tile is rounded to its steps. Beside a face that is hardly wider than a step, and
steep, rounding alone is metres of height, and a point there may be a vertex already, so that
nothing is left to be added. Such faces come of taking vertices out. Here the vertices are
triangulated anew in the steps of the tile, and points of the input are added where they are off: in
the end all of them are vertices, of faces as wide as the points are apart, and what is left is the
terrain's own slope over half a step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, TriangleMesh
from wavelet_core.mesh.location import cover_of
from wavelet_core.progress import report
from wavelet_gis.tiles.globe.tile_grid import STEPS, Tile
from wavelet_gis.tiles.globe.tile_mesh import OnTile, errors_on, triangulated

__all__ = ["refined"]

#: Rounds in which one point a face is added, the farthest off; after them all that are off, so that
#: the end comes soon.
_CAREFUL_ROUNDS = 24


def refined(
    drawn: OnTile,
    tile: Tile,
    zoom: int,
    height_step: float,
    promised: float,
    points: NDArray[np.float64],
    progress: Progress | None = None,
) -> OnTile:
    """Return a tile with more vertices, by which no point is farther off than promised.

    Parameters
    ----------
    drawn : OnTile
        Its border stays.
    tile : Tile
    zoom : int
        The finest, whose steps the points are in.
    height_step, promised : float
        Metres.
    points : (n, 3) float64
        x and y in steps, z in metres.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    OnTile
        The one with the fewest points that are farther off, where all points as vertices still
        leave some: walls within a step.
    """
    scale = 1 << (zoom - tile.zoom)
    exact = points[:, :2] / scale - np.array([tile.x, tile.y]) * STEPS
    places = np.clip(np.rint(exact), 1, STEPS - 1).astype(np.int64)
    keys = _keys(places[:, 0], places[:, 1])
    heights = np.rint(points[:, 2] / height_step).astype(np.int64)
    best, least = drawn, (len(points) + 1, 0, np.inf)
    n_rounds = 0
    while True:
        report(progress, 1.0 - 0.5**n_rounds)
        mesh = _triangulated(drawn)
        off = np.abs(errors_on(mesh, tile, zoom, height_step, points))
        is_above = ~(off <= promised)
        n_uncovered, n_above = (int(np.count_nonzero(one)) for one in (np.isnan(off), is_above))
        seen = n_uncovered, n_above, float(np.nanmax(off, initial=0.0))
        if seen < least:
            best, least = mesh, seen
        if not is_above.any():
            return mesh
        at = _next(mesh, exact, keys, off, is_above, n_rounds >= _CAREFUL_ROUNDS)
        if not len(at):
            return best
        drawn = mesh._replace(
            u=np.concatenate([mesh.u, places[at, 0]]),
            v=np.concatenate([mesh.v, places[at, 1]]),
            height=np.concatenate([mesh.height, heights[at]]),
        )
        n_rounds += 1


def _next(
    mesh: OnTile,
    exact: NDArray[np.float64],
    keys: NDArray[np.int64],
    off: NDArray[np.float64],
    is_above: NDArray[np.bool_],
    takes_all: bool,
) -> NDArray[np.int64]:
    """Return which points are to be vertices next, one for each place.

    Around a point that is off though it is a vertex, those are in the faces beside it.
    """
    own = _keys(mesh.u, mesh.v)
    is_new = ~np.isin(keys, own)
    stuck: NDArray[np.bool_] = np.isin(own, keys[is_above & ~is_new])
    plane = TriangleMesh(
        np.column_stack([mesh.u, mesh.v, mesh.height]).astype(np.float64), mesh.faces
    )
    cover = cover_of(plane, exact)
    face = np.full(len(exact), -1, dtype=np.int64)
    face[cover.point] = cover.face
    beside = (face >= 0) & np.asarray(stuck[mesh.faces].any(axis=1))[face]
    wanted = np.flatnonzero(is_new & (is_above | beside))
    wanted = wanted[np.argsort(-np.nan_to_num(off[wanted], nan=np.inf), kind="stable")]
    if not takes_all:
        wanted = wanted[np.sort(np.unique(face[wanted], return_index=True)[1])]
    return wanted[np.sort(np.unique(keys[wanted], return_index=True)[1])]


def _triangulated(drawn: OnTile) -> OnTile:
    faces = triangulated(drawn.u, drawn.v, _loop(drawn.u, drawn.v))
    return drawn._replace(faces=faces, n_folded=0)


def _loop(u: NDArray[np.int64], v: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the vertices on the border, counter-clockwise from the south-west corner."""
    sides = (
        (v == 0, u, 0),
        (u == STEPS, v, 0),
        (v == STEPS, u, STEPS),
        (u == 0, v, STEPS),
    )
    parts = []
    for is_on, along, start in sides:
        on = np.flatnonzero(is_on & (along != STEPS - start))
        parts.append(on[np.argsort(np.abs(along[on] - start), kind="stable")])
    return np.concatenate(parts)


def _keys(u: NDArray[np.int64], v: NDArray[np.int64]) -> NDArray[np.int64]:
    return v * (STEPS + 1) + u
