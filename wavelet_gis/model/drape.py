"""Lines laid on a TIN: cut where they cross its edges, then thinned as far as a tolerance allows.

A line of which only the corners lie on the terrain is a wall or a trench between them as soon as it
becomes edges of a mesh. A TIN is linear between two of its edges, so a line that is cut at every
edge lies on it at all of its points; what can be left out again is what is nearly straight, seen
from the side.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from wavelet_core import TriangleMesh
from wavelet_core.mesh.connectivity import edges_of
from wavelet_core.mesh.location import surface_errors

__all__ = ["Draped", "default_tolerance", "drape"]

FloatArray = NDArray[np.float64]

#: Cuts that are closer than this, as a share of a segment or of an edge, are one.
_SAME = 1e-9
#: Share of the relief that a line may be off where no tolerance is given.
_OF_RELIEF = 1e-3


class Draped(NamedTuple):
    """Lines on a TIN.

    lines : list of (n, 3) float64, as they were given, with heights and as many cuts as are needed
    profile : (m, 3) float64, where the terrain was known along them: every cut and every corner
    """

    lines: list[FloatArray]
    profile: FloatArray


def default_tolerance(points: FloatArray) -> float:
    """Return the tolerance of lines where none is given: a thousandth of the relief.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        The terrain.
    """
    return _OF_RELIEF * float(np.ptp(points[:, 2])) if len(points) else 0.0


def drape(lines: Sequence[FloatArray], mesh: TriangleMesh, tolerance: float) -> Draped:
    """Return lines that lie on a TIN where their own heights are not known.

    Parameters
    ----------
    lines : sequence of ndarray, shape (n, 3)
        x, y, z. A segment between two corners of known z stays as it is; z is NaN where it is not
        known, and there the line is laid on the TIN.
    mesh : TriangleMesh
        The terrain; a corner beyond it gets the height of the nearest vertex.
    tolerance : float
        Vertical distance from the TIN, in its unit, that a line may have for the sake of fewer
        vertices; 0 keeps every cut that is needed.

    Returns
    -------
    Draped
        The corners in plan stay where they are.
    """
    profiles = []
    cutter: _Cutter | None = None
    draped = []
    of_corners = _heights_of_open(lines, mesh)
    for number, line in enumerate(lines):
        is_open = np.isnan(line[:, 2])
        if not is_open.any():
            draped.append(line)
            profiles.append(line)
            continue
        cutter = cutter or _Cutter(mesh)
        corners = line.copy()
        corners[is_open, 2] = of_corners[number]
        parts, profile = [corners[:1]], [corners[:1]]
        for k in range(len(corners) - 1):
            start, stop = corners[k], corners[k + 1]
            if not (is_open[k] or is_open[k + 1]):
                parts.append(stop[None])
                profile.append(stop[None])
                continue
            path = np.concatenate([start[None], cutter.cuts(start, stop), stop[None]])
            profile.append(path[1:])
            parts.append(path[_needed(path, tolerance)][1:])
        draped.append(np.concatenate(parts))
        profiles.append(np.concatenate(profile))
    joined = np.concatenate(profiles) if profiles else np.empty((0, 3))
    return Draped(draped, joined)


class _Cutter:
    """Finds where segments cross the edges of a TIN.

    Edges are kept in trees of their midpoints, one for each doubling of their length, so that a
    segment has to look at few more than it crosses, however uneven the TIN is.
    """

    def __init__(self, mesh: TriangleMesh) -> None:
        edges = edges_of(mesh.faces)[0]
        self._a, self._b = mesh.vertices[edges[:, 0]], mesh.vertices[edges[:, 1]]
        length = np.hypot(*(self._b - self._a)[:, :2].T)
        doublings = np.floor(np.log2(np.maximum(length, np.finfo(float).tiny))).astype(np.int64)
        self._classes = []
        for doubling in np.unique(doublings):
            ids = np.flatnonzero(doublings == doubling)
            middles = (self._a[ids, :2] + self._b[ids, :2]) / 2
            self._classes.append((float(length[ids].max()), ids, cKDTree(middles)))

    def cuts(self, start: FloatArray, stop: FloatArray) -> FloatArray:
        """Return the points at which a segment crosses edges, in its direction, ``(n, 3)``."""
        along = stop[:2] - start[:2]
        length = float(np.hypot(*along))
        found = [np.empty((0, 4))]
        if length > 0:
            found += [self._crossings(ids, start, along) for ids in self._near(start, along)]
        cuts = np.concatenate(found)
        cuts = cuts[np.argsort(cuts[:, 0], kind="stable")]
        is_new = np.diff(cuts[:, 0], prepend=0.0) > _SAME
        return cuts[is_new & (cuts[:, 0] < 1 - _SAME), 1:]

    def _near(self, start: FloatArray, along: FloatArray) -> Iterator[NDArray[np.int64]]:
        """Yield ids of edges, among which are all that the segment crosses."""
        length = float(np.hypot(*along))
        for longest, ids, tree in self._classes:
            n_steps = max(int(np.ceil(length / longest)), 1)
            if n_steps > len(ids):  # few edges, much shorter than the segment
                yield ids
                continue
            share = (np.arange(n_steps) + 0.5) / n_steps
            reach = (longest + length / n_steps) / 2 * (1 + _SAME)
            hits = tree.query_ball_point(start[:2] + share[:, None] * along, reach)
            near = np.unique(np.concatenate([np.asarray(hit, dtype=np.int64) for hit in hits]))
            yield ids[near]

    def _crossings(
        self, ids: NDArray[np.int64], start: FloatArray, along: FloatArray
    ) -> FloatArray:
        """Return ``(n, 4)``: how far along the segment, as a share of it, and x, y, z."""
        a, b = self._a[ids], self._b[ids]
        side_a = along[0] * (a[:, 1] - start[1]) - along[1] * (a[:, 0] - start[0])
        side_b = along[0] * (b[:, 1] - start[1]) - along[1] * (b[:, 0] - start[0])
        meets = (side_a * side_b <= 0) & (side_a != side_b)
        a, b, side_a, side_b = a[meets], b[meets], side_a[meets], side_b[meets]
        at_b = (side_a / (side_a - side_b))[:, None]
        point = a + at_b * (b - a)
        point = np.where(at_b < _SAME, a, np.where(at_b > 1 - _SAME, b, point))
        share = (point[:, :2] - start[:2]) @ along / (along @ along)
        inside = (share > 0) & (share < 1)
        return np.column_stack([share[inside], point[inside]])


def _needed(path: FloatArray, tolerance: float) -> NDArray[np.bool_]:
    """Return which points of a straight path keep it within a tolerance, seen from the side.

    Douglas and Peucker's way, with vertical distances.
    """
    share = np.hypot(*(path[:, :2] - path[0, :2]).T)
    z = path[:, 2]
    keep = np.zeros(len(path), dtype=bool)
    keep[[0, -1]] = True
    open_parts = [(0, len(path) - 1)]
    while open_parts:
        first, last = open_parts.pop()
        if last - first < 2:
            continue
        inner = slice(first + 1, last)
        width = share[last] - share[first]
        at = (share[inner] - share[first]) / width if width > 0 else 0.0
        distance = np.abs(z[inner] - z[first] - at * (z[last] - z[first]))
        worst = int(distance.argmax())
        if distance[worst] > tolerance:
            middle = first + 1 + worst
            keep[middle] = True
            open_parts += [(first, middle), (middle, last)]
    return keep


def _heights_of_open(lines: Sequence[FloatArray], mesh: TriangleMesh) -> list[FloatArray]:
    """Return, for each line, the heights of the TIN at its corners of unknown z.

    All at once: each search goes over the whole TIN.
    """
    places = [line[np.isnan(line[:, 2]), :2] for line in lines]
    if not sum(map(len, places)):
        return places
    heights = _heights_at(mesh, np.concatenate(places))
    return np.split(heights, np.cumsum([len(place) for place in places])[:-1])


def _heights_at(mesh: TriangleMesh, plan: FloatArray) -> FloatArray:
    """Return the height of the TIN at positions; beyond it, that of the nearest vertex."""
    heights = -surface_errors(mesh, np.column_stack([plan, np.zeros(len(plan))]))
    uncovered = np.isnan(heights)
    if uncovered.any():
        nearest = cKDTree(mesh.vertices[:, :2]).query(plan[uncovered])[1]
        heights[uncovered] = mesh.vertices[nearest, 2]
    return heights
