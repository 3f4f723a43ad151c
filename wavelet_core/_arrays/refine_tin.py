"""The TIN of a refinement on whole arrays; see the kernels of the same name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._kernels.outline import FLATNESS_TOLERANCE
from ._csr import blocks, expanded
from .half_edges import rings_of

#: Points that are looked at together: a bound on the memory.
POINTS_AT_ONCE = 1 << 19


class Stars(NamedTuple):
    """Vertices whose stars are of one shape, and their points, from each vertex.

    rows : (n,) their places among those chosen; v : (n,) the vertices
    ring, spoke : (n, size), (n, n_sides)
    x, y, z : (n, size), (n, size, c) where the rings lie
    row, side, p : (k,) of each point the vertex, the side of the star, and which point it is
    px, py, pz : (k,), (k, c) where it lies
    """

    rows: NDArray
    v: NDArray
    ring: NDArray
    spoke: NDArray
    x: NDArray
    y: NDArray
    z: NDArray
    row: NDArray
    side: NDArray
    p: NDArray
    px: NDArray
    py: NDArray
    pz: NDArray

    @property
    def is_outline(self) -> bool:
        """Whether the vertices lie on an outline."""
        return self.spoke.shape[1] < self.ring.shape[1]


def stars_of(chosen, may, tin, points) -> Iterator[Stars]:
    """Yield the stars of those chosen vertices that may be looked at, in blocks."""
    rows = np.flatnonzero(may)
    rings = rings_of(chosen[rows], tin.mesh)
    spokes = rings.spoke
    counts = np.where(spokes >= 0, points.n_points[np.maximum(spokes, 0) // 3], 0).sum(axis=1)
    kind = 2 * rings.size + (rings.n_sides < rings.size)
    for which in np.unique(kind[rings.size > 0]):
        same = np.flatnonzero(kind == which)
        size, n_sides = int(which) // 2, int(which) // 2 - int(which) % 2
        for part in blocks(counts[same] + size, POINTS_AT_ONCE):
            at = same[part]
            v = chosen[rows[at]]
            ring, spoke = rings.ring[at, :size], rings.spoke[at, :n_sides]
            faces = spoke // 3
            row, place = expanded(points.first[faces].ravel(), points.n_points[faces].ravel())
            row, side = row // n_sides, row % n_sides
            p = points.pool[place]
            centre = v[row]
            yield Stars(
                rows[at], v, ring, spoke,
                tin.x[ring] - tin.x[v][:, None], tin.y[ring] - tin.y[v][:, None],
                tin.z[ring] - tin.z[v][:, None], row, side, p, points.x[p] - tin.x[centre],
                points.y[p] - tin.y[centre], points.z[p] - tin.z[centre],
            )  # fmt: skip


def weighed(squared, is_power):
    if is_power:
        fourth = squared * squared
        return fourth * fourth
    return squared


def total(row, values, n):
    """Return the sum of the values of each row, added one after the other."""
    return np.bincount(row, values, minlength=n).astype(np.float64, copy=False)


def largest(row, values, n):
    """Return the largest of the values of each row, at least 0."""
    most = np.zeros(n)
    np.maximum.at(most, row, values)
    return most


def count_star_points(start, stop, chosen, tin, points, count):
    count[:] = 0
    rows = np.flatnonzero(tin.mesh.outgoing[chosen] >= 0)
    spokes = rings_of(chosen[rows], tin.mesh).spoke
    counts = np.where(spokes >= 0, points.n_points[np.maximum(spokes, 0) // 3], 0)
    count[rows] = counts.sum(axis=1)


def sum_face_errors(start, stop, chosen, tin, points, objective, error, squared_z, largest_z):
    corners = tin.mesh.origin.reshape(-1, 3)
    alive = chosen[corners[chosen, 0] >= 0]
    error[chosen], squared_z[chosen], largest_z[chosen] = 0.0, 0.0, 0.0
    for part in blocks(points.n_points[alive] + 1, POINTS_AT_ONCE):
        faces = alive[part]
        a, b, c = corners[faces].T
        bx, by = tin.x[b] - tin.x[a], tin.y[b] - tin.y[a]
        cx, cy = tin.x[c] - tin.x[a], tin.y[c] - tin.y[a]
        per_area = 1.0 / (bx * cy - by * cx)
        row, place = expanded(points.first[faces], points.n_points[faces])
        p = points.pool[place]
        px, py = points.x[p] - tin.x[a][row], points.y[p] - tin.y[a][row]
        at_b = (px * cy[row] - py * cx[row]) * per_area[row]
        at_c = (bx[row] * py - by[row] * px) * per_area[row]
        squared, first = np.zeros(len(p)), None
        for i in range(tin.z.shape[1]):
            za, zb, zc = tin.z[a, i][row], tin.z[b, i][row], tin.z[c, i][row]
            off = za + at_b * (zb - za) + at_c * (zc - za)
            off -= points.z[p, i]
            squared += off * off
            first = squared.copy() if i == 0 else first
        error[faces] = total(row, weighed(squared, objective.is_power), len(faces))
        squared_z[faces] = total(row, first, len(faces))
        largest_z[faces] = largest(row, first, len(faces))


def take_in_order(order, needs, is_taken, wins):
    wins[:] = False
    rank = np.zeros(len(needs), dtype=np.int64)
    rank[order] = np.arange(len(order))
    nobody = len(order)
    owner = np.empty(len(is_taken), dtype=np.int64)
    active = np.asarray(order)
    while len(active):
        wanted = needs[active]
        active = active[~(is_taken[wanted] & (wanted >= 0)).any(axis=1)]
        wanted = needs[active]
        owner[:] = nobody
        backwards = wanted[::-1]  # the first is written last
        for k in range(needs.shape[1] - 1, -1, -1):
            column = backwards[:, k]
            owner[column[column >= 0]] = np.minimum(
                owner[column[column >= 0]], rank[active[::-1]][column >= 0]
            )
        first = ((owner[wanted] == rank[active][:, None]) | (wanted < 0)).all(axis=1)
        wins[active[first]] = True
        taken = wanted[first]
        is_taken[taken[taken >= 0]] = True
        active = active[~first]


def colour_vertices(order, mesh, colour):
    place = np.full(len(colour), -1, dtype=np.int64)
    place[order] = np.arange(len(order))
    active = np.asarray(order)
    rings = rings_of(active, mesh)
    ring, is_there = np.maximum(rings.ring, 0), rings.ring >= 0
    comes_first = is_there & (place[ring] >= 0) & (place[ring] < place[active][:, None])
    bits = np.int64(1)
    while len(active):
        known = colour[ring] >= 0
        ready = (known | ~comes_first).all(axis=1)
        seen = known & comes_first
        used = np.where(seen, bits << np.maximum(colour[ring], 0).astype(np.int64), 0)
        used = np.bitwise_or.reduce(used[ready], axis=1)
        free = ~used & (used + 1)  # the lowest bit that is not set
        colour[active[ready]] = np.log2(free.astype(np.float64)).astype(np.int8)
        active, ring, comes_first = active[~ready], ring[~ready], comes_first[~ready]


def copy_lists(start, stop, points, first, pool):
    _row, place = expanded(points.first, points.n_points)
    _, to = expanded(first, points.n_points)
    pool[to] = points.pool[place]


def is_wide(ax, ay, bx, by, cx, cy):
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    longest = np.maximum(
        (bx - ax) ** 2 + (by - ay) ** 2,
        np.maximum((cx - bx) ** 2 + (cy - by) ** 2, (ax - cx) ** 2 + (ay - cy) ** 2),
    )
    return (area > 0.0) & ~(area <= FLATNESS_TOLERANCE * longest)


def hand_over(row, slot, p, base, faces, points):
    """Write the lists of faces anew: of each row the points ``p``, which go to its place ``slot``.

    row : (k,) ascending; faces : (n, m) of each row, -1 where it has fewer
    """
    n, m = faces.shape
    key = row * m + slot
    order = np.argsort(key, kind="stable")
    count = np.bincount(key, minlength=n * m).reshape(n, m)
    first = base[:, None] + np.cumsum(count, axis=1) - count
    _, to = expanded(base, count.sum(axis=1))
    points.pool[to] = p[order]
    there = faces >= 0
    points.first[faces[there]], points.n_points[faces[there]] = first[there], count[there]
