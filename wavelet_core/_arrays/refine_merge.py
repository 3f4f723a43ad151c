"""An edge shrinks to one vertex, on whole arrays; see the kernels of that name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._kernels.refine_merge import MAX_RIM, SQUARED_REACH
from ._csr import blocks, expanded
from .half_edges import after
from .outline import is_straight
from .refine_move import find_side, following_of
from .refine_tin import POINTS_AT_ONCE, hand_over, is_wide, total

#: Of the points of a polygon, one in so many is looked at first; most places fail at one of them.
SPARSE = (64, 16, 4)


class _Rims(NamedTuple):
    """rim (n, MAX_RIM), n_sides (n,), kept and gone (n,): see `walk_rim` of the kernels."""

    rim: NDArray[np.int32]
    n_sides: NDArray[np.int64]
    kept: NDArray[np.int32]
    gone: NDArray[np.int32]


def _walk_rims(half_edges, mesh) -> _Rims:
    origin, twin, outgoing = mesh
    a, b = origin[half_edges], origin[after(half_edges)]
    a_is_outline, b_is_outline = twin[outgoing[a]] < 0, twin[outgoing[b]] < 0
    kept = np.where(b_is_outline, b, a)
    n = len(half_edges)
    rim, n_sides = np.full((n, MAX_RIM), -1, dtype=np.int32), np.zeros(n, dtype=np.int64)
    here = after(outgoing[kept])
    here = np.where((origin[here] == a) | (origin[here] == b), after(here), here)
    active = np.flatnonzero(~(a_is_outline & b_is_outline & (twin[half_edges] >= 0)))
    while len(active):
        now = here[active]
        head = origin[after(now)]
        is_spoke = (head == a[active]) | (head == b[active])
        spokes, others = active[is_spoke], active[~is_spoke]
        beyond = twin[now[is_spoke]]
        here[spokes[beyond >= 0]] = after(beyond[beyond >= 0])
        now = now[~is_spoke]
        is_closed = (n_sides[others] > 0) & (now == rim[others, 0])
        is_long = ~is_closed & (n_sides[others] == MAX_RIM)
        goes_on = ~(is_closed | is_long)
        n_sides[others[is_long]] = 0
        others, now = others[goes_on], now[goes_on]
        rim[others, n_sides[others]] = now
        n_sides[others] += 1
        here[others] = after(now)
        active = np.concatenate([spokes[beyond >= 0], others])
    return _Rims(rim, n_sides, kept, np.where(kept == a, b, a))


def _inner(half_edges, twin):
    """Return the faces on both sides of edges, -1 where there is none."""
    other = twin[half_edges]
    return np.column_stack([half_edges // 3, np.where(other >= 0, other // 3, -1)])


def count_polygon_points(start, stop, half_edges, tin, points, n_points):
    mesh = tin.mesh
    n_points[:] = 0
    ends = mesh.origin[half_edges], mesh.origin[after(half_edges)]
    free = np.flatnonzero(~(tin.is_locked[ends[0]] | tin.is_locked[ends[1]]))
    rims = _walk_rims(half_edges[free], mesh)
    is_side = np.arange(MAX_RIM) < rims.n_sides[:, None]
    around = np.where(is_side, points.n_points[np.where(is_side, rims.rim, 0) // 3], 0).sum(axis=1)
    inner = _inner(half_edges[free], mesh.twin)
    within = np.where(inner >= 0, points.n_points[inner], 0).sum(axis=1)
    n_points[free] = np.where(rims.n_sides > 0, around + within, 0)


def list_polygons(start, stop, half_edges, mesh, needs):
    rims = _walk_rims(half_edges, mesh)
    needs[:] = -1
    needs[:, 0], needs[:, 1] = rims.kept, rims.gone
    rows = np.arange(len(half_edges))
    for k in range(MAX_RIM):
        there = k < rims.n_sides
        needs[there, 2 + k] = mesh.origin[rims.rim[there, k]]
    last = mesh.origin[after(rims.rim[rows, rims.n_sides - 1])]
    is_path = last != mesh.origin[rims.rim[:, 0]]
    needs[rows[is_path], 2 + rims.n_sides[is_path]] = last[is_path]


class _Polygons(NamedTuple):
    """Polygons of one shape around edges, and their points, from the ends that live on.

    rows : (n,) their places among those given
    half_edge, kept, gone : (n,); rim : (n, n_sides); ring : (n, size)
    faces : (n, n_sides + 2), -1 where there is none
    x, y : (n, size) where the rings lie
    row, side, p, px, py : (k,) of each point
    first, n_points : (n,) where the points of a polygon begin, and how many there are
    """

    rows: NDArray
    half_edge: NDArray
    kept: NDArray
    gone: NDArray
    rim: NDArray
    ring: NDArray
    faces: NDArray
    x: NDArray
    y: NDArray
    row: NDArray
    side: NDArray
    p: NDArray
    px: NDArray
    py: NDArray
    first: NDArray
    n_points: NDArray

    @property
    def is_path(self) -> bool:
        """Whether the rims run from the outline to the outline."""
        return self.ring.shape[1] > self.rim.shape[1]


def _polygons_of(half_edges, rows, tin, points) -> Iterator[_Polygons]:
    """Yield the polygons around some of the edges, in blocks."""
    mesh = tin.mesh
    rims = _walk_rims(half_edges[rows], mesh)
    inner = _inner(half_edges[rows], mesh.twin)
    last = mesh.origin[after(rims.rim[np.arange(len(rows)), rims.n_sides - 1])]
    kind = 2 * rims.n_sides + (last != mesh.origin[rims.rim[:, 0]])
    for which in np.unique(kind[rims.n_sides > 0]):
        same = np.flatnonzero(kind == which)
        n_sides = int(which) // 2
        rim = rims.rim[same, :n_sides]
        ring = mesh.origin[rim]
        if which % 2:
            ring = np.column_stack([ring, last[same]])
        faces = np.column_stack([rim // 3, inner[same]])
        counts = np.where(faces >= 0, points.n_points[faces], 0)
        size = ring.shape[1]
        for part in blocks(counts.sum(axis=1) + size, max(POINTS_AT_ONCE // size, 1)):
            at = same[part]
            kept = rims.kept[at]
            entry, place = expanded(points.first[faces[part]].ravel(), counts[part].ravel())
            row, side = entry // (n_sides + 2), entry % (n_sides + 2)
            p = points.pool[place]
            count = counts[part].sum(axis=1)
            yield _Polygons(
                rows[at], half_edges[rows[at]], kept, rims.gone[at], rim[part], ring[part],
                faces[part], tin.x[ring[part]] - tin.x[kept][:, None],
                tin.y[ring[part]] - tin.y[kept][:, None], row, np.where(side < n_sides, side, 0), p,
                points.x[p] - tin.x[kept][row], points.y[p] - tin.y[kept][row],
                np.cumsum(count) - count, count,
            )  # fmt: skip


def propose_merges(
    start, stop, half_edges, n_points, tin, points, objective, error, capacity, to, cost
):
    to[:], cost[:] = -1, np.inf
    for polygons in _polygons_of(half_edges, np.flatnonzero(n_points > 0), tin, points):
        _propose(polygons, tin, points, objective, error, to, cost)


def _propose(polygons, tin, points, objective, error, to, cost):
    legal = _may_shrink(polygons, tin)
    q = _places(polygons, legal, tin)
    fans = _Fans(polygons, q, tin, points, objective)
    ends = (tin.point[polygons.kept], tin.point[polygons.gone])
    is_end = (polygons.p == ends[0][polygons.row]) | (polygons.p == ends[1][polygons.row])
    local = np.arange(len(polygons.p)) - polygons.first[polygons.row]
    kept = np.arange(len(q))
    for looked_at in (is_end, *(local % step == 0 for step in SPARSE)):
        kept = kept[fans.keep(kept, looked_at)]
    sums, keeps = fans.sums(kept)
    kept, sums = kept[keeps], sums[keeps]
    row = polygons.row[q[kept]]
    order = np.lexsort((kept, sums, row))
    order = order[np.flatnonzero(np.diff(row[order], prepend=-1))]
    present = np.zeros(len(polygons.rows))
    for k in range(polygons.faces.shape[1]):
        face = polygons.faces[:, k]
        present += np.where(face >= 0, error[face], 0.0)
    found = row[order]
    at = polygons.rows[found]
    to[at] = polygons.p[q[kept[order]]]
    cost[at] = sums[order] - present[found]


def _may_shrink(polygons, tin):
    """Return which polygons are simple, and straight where they meet the outline."""
    x, y, ring = polygons.x, polygons.y, polygons.ring
    in_order = np.sort(ring, axis=1)
    legal = (in_order[:, 1:] != in_order[:, :-1]).all(axis=1)
    if polygons.is_path:
        gone = polygons.gone
        gone_x, gone_y = tin.x[gone] - tin.x[polygons.kept], tin.y[gone] - tin.y[polygons.kept]
        legal &= is_straight(x[:, 0], y[:, 0], x[:, -1], y[:, -1])
        legal &= (tin.mesh.twin[tin.mesh.outgoing[gone]] >= 0) | is_straight(
            x[:, 0] - gone_x, y[:, 0] - gone_y, x[:, -1] - gone_x, y[:, -1] - gone_y
        )
    return legal


def _places(polygons, legal, tin):
    """Return the points near each edge around which its rim makes a fan."""
    n_sides, size = polygons.rim.shape[1], polygons.ring.shape[1]
    gone_x = tin.x[polygons.gone] - tin.x[polygons.kept]
    gone_y = tin.y[polygons.gone] - tin.y[polygons.kept]
    reach = SQUARED_REACH * (0.25 * (gone_x * gone_x + gone_y * gone_y))
    row = polygons.row
    dx, dy = polygons.px - (0.5 * gone_x)[row], polygons.py - (0.5 * gone_y)[row]
    q = np.flatnonzero(legal[row] & ~(dx * dx + dy * dy > reach[row]))
    for k in range(n_sides):
        at, then = row[q], k + 1 if k + 1 < size else 0
        ends = (
            polygons.x[at, k], polygons.y[at, k], polygons.x[at, then], polygons.y[at, then]
        )  # fmt: skip
        q = q[is_wide(polygons.px[q], polygons.py[q], *ends)]
    if polygons.is_path:
        at, x, y = row[q], polygons.px[q], polygons.py[q]
        q = q[
            is_straight(
                polygons.x[at, 0] - x, polygons.y[at, 0] - y,
                polygons.x[at, -1] - x, polygons.y[at, -1] - y,
            )
        ]  # fmt: skip
    return q


class _Fans:
    """Fans around the points ``q``, entries of the polygons, each over its polygon."""

    def __init__(self, polygons, q, tin, points, objective) -> None:
        self._polygons, self._q, self._points = polygons, q, points
        self._tolerance = objective.tolerance
        n_sides, size = polygons.rim.shape[1], polygons.ring.shape[1]
        row = polygons.row[q]
        self._x = polygons.x[row] - polygons.px[q][:, None]
        self._y = polygons.y[row] - polygons.py[q][:, None]
        here = np.arange(n_sides)
        then = following_of(here, size)
        bx, by, cx, cy = self._x[:, here], self._y[:, here], self._x[:, then], self._y[:, then]
        area = bx * cy - by * cx
        self._slopes = []
        for i in range(tin.z.shape[1]):
            own = points.z[polygons.p[q], i][:, None]
            z = tin.z[polygons.ring[row], i]
            to_b, to_c = (z[:, here] - own) / area, (z[:, then] - own) / area
            self._slopes.append((to_b * cy - to_c * by, to_c * bx - to_b * cx))

    def _squared(self, fan, entry):
        """Return the squared errors of entries under fans: of all channels, and of the height."""
        polygons, points, q = self._polygons, self._points, self._q[fan]
        n_sides, size = polygons.rim.shape[1], polygons.ring.shape[1]
        px, py = polygons.px[entry] - polygons.px[q], polygons.py[entry] - polygons.py[q]
        k = find_side(polygons.side[entry], size, n_sides, self._x, self._y, fan, px, py)
        at, p = polygons.p[q], polygons.p[entry]
        squared = np.zeros(len(fan))
        squared_z = squared
        for i, (slope_x, slope_y) in enumerate(self._slopes):
            off = points.z[at, i] + slope_x[fan, k] * px + slope_y[fan, k] * py - points.z[p, i]
            squared = squared + off * off
            squared_z = squared if i == 0 else squared_z
        return squared, squared_z * points.strictness[p]

    def _entries(self, fans, listed, first, count):
        row = self._polygons.row[self._q[fans]]
        for part in blocks(count[row] + 1, POINTS_AT_ONCE):
            which, place = expanded(first[row[part]], count[row[part]])
            yield part, which, listed[place]

    def keep(self, fans, looked_at):
        """Return which of the fans keep the tolerance at some entries of their polygons."""
        polygons = self._polygons
        listed = np.flatnonzero(looked_at)
        count = np.bincount(polygons.row[listed], minlength=len(polygons.rows))
        keeps = np.ones(len(fans), dtype=bool)
        for part, which, entry in self._entries(fans, listed, np.cumsum(count) - count, count):
            here = fans[part]
            _, strict = self._squared(here[which], entry)
            off = np.bincount(which[strict > self._tolerance], minlength=len(here))
            keeps[part] = off == 0
        return keeps

    def sums(self, fans):
        """Return the squared errors under fans, summed, and which keep the tolerance."""
        polygons = self._polygons
        sums, keeps = np.zeros(len(fans)), np.ones(len(fans), dtype=bool)
        every = np.arange(len(polygons.p))
        for part, which, entry in self._entries(fans, every, polygons.first, polygons.n_points):
            here = fans[part]
            squared, strict = self._squared(here[which], entry)
            sums[part] = total(which, squared, len(here))
            keeps[part] = np.bincount(which[strict > self._tolerance], minlength=len(here)) == 0
        return sums, keeps


def merge_edges(start, stop, half_edges, to, base, tin, points, capacity):
    rows = np.arange(len(half_edges))
    for polygons in list(_polygons_of(half_edges, rows, tin, points)):
        _merge(polygons, to, base, tin, points)


def _merge(polygons, to, base, tin, points):
    origin, twin, outgoing = tin.mesh.origin, tin.mesh.twin, tin.mesh.outgoing
    v, at, ring, rim = polygons.kept, to[polygons.rows], polygons.ring, polygons.rim
    n_sides, size = rim.shape[1], ring.shape[1]
    tin.x[v], tin.y[v], tin.z[v], tin.point[v] = points.x[at], points.y[at], points.z[at], at
    seen_x, seen_y = tin.x[ring] - tin.x[v][:, None], tin.y[ring] - tin.y[v][:, None]
    row, p = polygons.row, polygons.p
    px, py = points.x[p] - tin.x[v][row], points.y[p] - tin.y[v][row]
    side = find_side(polygons.side, size, n_sides, seen_x, seen_y, row, px, py)
    slots = rim // 3
    hand_over(row, side, p, base[polygons.rows], slots, points)
    first = 3 * slots
    for k in range(size):
        names = (outgoing[ring[:, k], None] // 3 == polygons.faces).any(axis=1)
        named = first[:, k] if k < n_sides else first[:, k - 1] + 1
        outgoing[ring[names, k]] = named[names]
    beyond = twin[rim]
    for k in range(n_sides):
        f, following = first[:, k], k + 1 if k + 1 < size else 0
        origin[f], origin[f + 1], origin[f + 2] = ring[:, k], ring[:, following], v
        twin[f] = beyond[:, k]
        there = beyond[:, k] >= 0
        twin[beyond[there, k]] = f[there]
        twin[f + 1] = first[:, following] + 2 if following < n_sides else -1
        twin[f + 2] = first[:, k - 1] + 1 if k > 0 or size == n_sides else -1
    outgoing[v] = first[:, 0] + 2
    outgoing[polygons.gone] = -1
    inner = polygons.faces[:, n_sides:]
    gone = inner[inner >= 0]
    points.n_points[gone] = 0
    half_edges = 3 * gone[:, None] + np.arange(3)
    origin[half_edges], twin[half_edges] = -1, -1
