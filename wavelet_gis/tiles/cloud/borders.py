"""The border lines of tiles of points: polylines through points, found alike from both sides.

A straight line between two tiles has no points on it, so the border is a chain of points near it:

        |                      K  the corner: the point nearest to where two lines meet
     o  |V   o     o           V  the arms: of each stretch of the line the point nearest to it
    ----K---V--|--V----V--     Arms begin at twice the distance of K from the crossing, so that
   o  V |  o      o            they cannot meet anywhere else.

Every tile finds the corners and arms around it from the points within some `reach` of it; its
neighbours find the same ones, since each depends on points that all of them read. An arm grows
strictly along its line, so on which side of it a point lies is one sign. All numbers are integers,
all signs are exact.

Where no point is within reach of a crossing, as in a lake, the corner is *virtual*: the crossing
itself, which no triangle uses or covers. At the outer end of a line the border goes straight on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["FAR", "Arm", "Corner", "Ring", "arm_of", "corner_of", "faces_within", "keys_of"]

Ints = NDArray[np.int64]

#: Where the border goes on to behind the last point. Coordinates are within half of it, so that the
#: product of two differences is an int64.
FAR = 1 << 30

#: Spacings within which a point is near a line, and in which there is one vertex of an arm.
_WIDTH = 2


class Corner(NamedTuple):
    """Where four tiles meet.

    u, v : int
    is_real : bool, whether this is a point
    margin : int, how far from the crossing the arms begin
    """

    u: int
    v: int
    is_real: bool
    margin: int


@dataclass(frozen=True, slots=True)
class Arm:
    """The border between two tiles, from corner to corner.

    Attributes
    ----------
    along, across : (n,) int64
        Its vertices; `along` is strictly ascending.
    is_real : (n,) bool
        Whether a vertex is a point.
    """

    along: Ints
    across: Ints
    is_real: NDArray[np.bool_]

    def sides(self, along: Ints, across: Ints) -> NDArray[np.int8]:
        """Return 1 for points beyond the arm, -1 for those before it, 0 on it or past its ends."""
        k = np.searchsorted(self.along, along, side="left")
        has_part = (k > 0) & (k < len(self.along))
        k = np.clip(k, 1, len(self.along) - 1)
        run, rise = self.along[k] - self.along[k - 1], self.across[k] - self.across[k - 1]
        above = run * (across - self.across[k - 1]) - rise * (along - self.along[k - 1])
        return np.where(has_part, np.sign(above), 0).astype(np.int8)


def keys_of(u: Ints, v: Ints) -> Ints:
    """Return one number for each place."""
    keys: Ints = v * (4 * FAR) + u
    return keys


def corner_of(u: Ints, v: Ints, at: tuple[int, int], spacing: int, reach: int) -> Corner:
    """Return the place that is nearest to the crossing of two lines.

    Parameters
    ----------
    u, v : (n,) int64
        Places of points, at least all within reach.
    at : tuple of int
        u and v of the crossing.
    spacing, reach : int
        Of the points; as far as the corner may be from the crossing.
    """
    distance = np.maximum(np.abs(u - at[0]), np.abs(v - at[1]))
    near = np.flatnonzero(distance <= reach)
    if len(near) == 0:
        return Corner(*at, is_real=False, margin=2 * _WIDTH * spacing)
    best = near[np.lexsort((u[near], v[near], distance[near]))[0]]
    margin = 2 * max(int(distance[best]), _WIDTH * spacing)
    return Corner(int(u[best]), int(v[best]), is_real=True, margin=margin)


def arm_of(
    along: Ints,
    across: Ints,
    line: int,
    ends: tuple[int, int],
    corners: tuple[tuple[int, int, bool, int] | None, tuple[int, int, bool, int] | None],
    spacing: int,
) -> Arm:
    """Return the border along a line between two crossings.

    Parameters
    ----------
    along, across : (n,) int64
        Places of points, of which all near the line are there.
    line : int
        `across` of the line.
    ends : tuple of int
        `along` of the crossings at its ends, or of the outer ends of the line.
    corners : tuple of tuple or None
        At the ends: along, across, whether it is a point, and its margin; None at an outer end.
    spacing : int
        Of the points.
    """
    step = _WIDTH * spacing
    first, last = corners
    low = -FAR if first is None else ends[0] + first[3]
    high = FAR if last is None else ends[1] - last[3]
    near = np.flatnonzero(
        (np.abs(across - line) <= _WIDTH * spacing) & (along >= low) & (along <= high)
    )
    stretch = (along[near] - ends[0]) // step
    distance = np.abs(across[near] - line)
    order = np.lexsort((across[near], along[near], distance, stretch))
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = np.diff(stretch[order]) > 0
    chosen = near[order[is_first]]
    vertices = [(int(a), int(c), True) for a, c in zip(along[chosen], across[chosen], strict=True)]
    if first is not None:
        vertices.insert(0, first[:3])
    if last is not None:
        vertices.append(last[:3])
    if first is None:
        vertices.insert(0, (-FAR, vertices[0][1] if vertices else line, False))
    if last is None:
        vertices.append((FAR, vertices[-1][1], False))
    arm = Arm(
        np.array([a for a, _, _ in vertices], np.int64),
        np.array([c for _, c, _ in vertices], np.int64),
        np.array([real for _, _, real in vertices], bool),
    )
    return _with_points_on_it(arm, along, across)


def _with_points_on_it(arm: Arm, along: Ints, across: Ints) -> Arm:
    """Return an arm in which every point that lies on an edge of it is a vertex."""
    low, high = int(arm.across.min()), int(arm.across.max())
    near = np.flatnonzero((across >= low) & (across <= high) & (np.abs(along) < FAR))
    k = np.searchsorted(arm.along, along[near], side="left")
    is_between = (k > 0) & (k < len(arm.along))
    near, k = near[is_between], k[is_between]
    near = near[arm.along[k] != along[near]]
    on = near[arm.sides(along[near], across[near]) == 0]
    on = on[np.unique(along[on], return_index=True)[1]]  # points of one place
    if len(on) == 0:
        return arm
    order = np.argsort(np.concatenate([arm.along, along[on]]), kind="stable")
    return Arm(
        np.concatenate([arm.along, along[on]])[order],
        np.concatenate([arm.across, across[on]])[order],
        np.concatenate([arm.is_real, np.ones(len(on), bool)])[order],
    )


@dataclass(frozen=True, slots=True)
class Ring:
    """The border of a tile: its arms, None where the whole ends.

    Attributes
    ----------
    south, north : Arm or None
        Along u.
    west, east : Arm or None
        Along v.
    corners : tuple of Corner or None
        South-west, south-east, north-east, north-west.
    """

    south: Arm | None
    east: Arm | None
    north: Arm | None
    west: Arm | None
    corners: tuple[Corner | None, Corner | None, Corner | None, Corner | None]

    def holds(self, u: Ints, v: Ints) -> NDArray[np.bool_]:
        """Return which points lie inside; its own vertices are for the caller to know."""
        inside: NDArray[np.bool_] = np.ones(len(u), dtype=bool)
        for arm, along, across, sign in (
            (self.south, u, v, 1),
            (self.north, u, v, -1),
            (self.west, v, u, 1),
            (self.east, v, u, -1),
        ):
            if arm is None:
                continue
            sides = arm.sides(along, across)
            is_past = (along <= arm.along[0]) | (along >= arm.along[-1])
            inside &= is_past | ((sides >= 0) if sign > 0 else (sides < 0))
        for corner, east, north in zip(self.corners, (0, 1, 1, 0), (0, 0, 1, 1), strict=True):
            if corner is not None:
                beyond_u = u >= corner.u if east else u <= corner.u
                beyond_v = v >= corner.v if north else v <= corner.v
                inside &= ~(beyond_u & beyond_v)
        return inside

    def vertices(self) -> tuple[Ints, Ints]:
        """Return u and v of its points, counter-clockwise, each once."""
        u: list[Ints] = []
        v: list[Ints] = []
        for arm, is_along_u, is_forward in self._arms():
            turn = slice(None) if is_forward else slice(None, None, -1)
            along, across = arm.along[arm.is_real][turn], arm.across[arm.is_real][turn]
            u.append(along if is_along_u else across)
            v.append(across if is_along_u else along)
        if not u:
            return np.empty(0, np.int64), np.empty(0, np.int64)
        all_u, all_v = np.concatenate(u), np.concatenate(v)
        _, first = np.unique(keys_of(all_u, all_v), return_index=True)
        order = np.sort(first)
        return all_u[order], all_v[order]

    def edges(self) -> NDArray[np.int64]:
        """Return the edges between its points, ``(n, 2, 2)``: from and to, u and v."""
        return self._pieces(real=True)

    def gates(self) -> NDArray[np.int64]:
        """Return the edges with an end that is no point, which no triangle may cross."""
        return self._pieces(real=False)

    def _arms(self) -> list[tuple[Arm, bool, bool]]:
        arms = (
            (self.south, True, True),
            (self.east, False, True),
            (self.north, True, False),
            (self.west, False, False),
        )
        return [(arm, is_u, forward) for arm, is_u, forward in arms if arm is not None]

    def _pieces(self, *, real: bool) -> NDArray[np.int64]:
        pieces = [np.empty((0, 2, 2), np.int64)]
        for arm, is_along_u, _ in self._arms():
            both = (arm.along, arm.across) if is_along_u else (arm.across, arm.along)
            places = np.column_stack(both)
            is_edge = (arm.is_real[1:] & arm.is_real[:-1]) == real
            pieces.append(np.stack([places[:-1][is_edge], places[1:][is_edge]], axis=1))
        return np.concatenate(pieces)


def faces_within(
    ring: Ring, u: Ints, v: Ints, faces: NDArray[np.int64], ring_place: Ints
) -> NDArray[np.int64]:
    """Return the faces that lie inside a ring, of a triangulation that has its edges.

    Parameters
    ----------
    ring : Ring
    u, v : (n,) int64
        Of the vertices, all of them inside or on the ring.
    faces : (m, 3) int64
        Counter-clockwise.
    ring_place : (n,) int64
        Of each vertex its number along the ring, -1 inside.

    Notes
    -----
    A face of three vertices of the ring is inside when they follow one another as along the ring.
    No other face is outside, but for those that cross an edge without a point at one end.
    """
    places = ring_place[faces]
    a, b, c = places.T
    turns_with_it = ((a < b) & (b < c)) | ((b < c) & (c < a)) | ((c < a) & (a < b))
    inside = turns_with_it | (places < 0).any(axis=1)
    kept = faces[inside]
    for start, end in ring.gates():
        kept = kept[~_crosses(u, v, kept, start, end)]
    return kept


def _crosses(
    u: Ints, v: Ints, faces: NDArray[np.int64], start: Ints, end: Ints
) -> NDArray[np.bool_]:
    """Return which faces an edge crosses."""
    side = np.sign((end[0] - start[0]) * (v - start[1]) - (end[1] - start[1]) * (u - start[0]))
    crossed: NDArray[np.bool_] = np.zeros(len(faces), dtype=bool)
    corners = side[faces]
    at_stake = np.flatnonzero((corners.min(axis=1) < 0) & (corners.max(axis=1) > 0))
    for k in range(3):
        p, q = faces[at_stake, k], faces[at_stake, (k + 1) % 3]
        is_across = side[p] * side[q] < 0
        turns = [
            np.sign((u[q] - u[p]) * (place[1] - v[p]) - (v[q] - v[p]) * (place[0] - u[p]))
            for place in (start, end)
        ]
        crossed[at_stake[is_across & (turns[0] * turns[1] < 0)]] = True
        # An end that is no vertex may lie on the edge itself.
        is_end = ((u[p] == start[0]) & (v[p] == start[1])) | ((u[p] == end[0]) & (v[p] == end[1]))
        crossed[at_stake[is_across & (turns[0] * turns[1] == 0) & ~is_end]] = True
    return crossed
