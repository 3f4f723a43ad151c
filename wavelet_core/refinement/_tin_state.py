"""A coarse TIN that changes in place, and the input points in each of its faces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.connectivity import fill_stars
from .._kernels.half_edges import HalfEdges, find_outgoing, find_twins
from .._kernels.refine_flip import flip_edges, gains_of_flips
from .._kernels.refine_move import move_vertices, propose_moves
from .._kernels.refine_replace import (
    insert_vertices,
    list_corners,
    list_stars,
    propose_insertions,
    propose_removals,
    remove_vertices,
)
from .._kernels.refine_tin import (
    Aim,
    Points,
    Tin,
    colour_vertices,
    copy_lists,
    count_star_points,
    sum_face_errors,
    take_in_order,
)
from .._validate import FloatArray, IntArray

#: Longest ring of a vertex that may be taken out.
MAX_REMOVED_RING = 15


class TinState:
    """A TIN in the making; see the kernels for what each pass does."""

    def __init__(
        self,
        plan: FloatArray,
        columns: FloatArray,
        faces: NDArray[np.int32],
        heights: FloatArray,
        vertex_ids: IntArray,
        face_of: IntArray,
        locked: NDArray[np.bool_],
        aim: Aim,
    ) -> None:
        n, n_faces = len(vertex_ids), len(faces)
        indptr = np.zeros(n + 1, dtype=np.int64)
        star = np.empty(3 * n_faces, dtype=np.int32)
        fill_stars(faces, indptr, star)
        mesh = HalfEdges(
            faces.ravel().copy(),
            np.empty(3 * n_faces, dtype=np.int32),
            np.empty(n, dtype=np.int32),
        )
        run_in_ranges(find_twins, n_faces, indptr, star, mesh)
        n_fans = np.empty(n, dtype=np.int8)
        run_in_ranges(find_outgoing, n, indptr, star, mesh, n_fans)
        held = locked | (n_fans != 1)
        self.tin = Tin(
            mesh,
            plan[vertex_ids, 0].copy(),
            plan[vertex_ids, 1].copy(),
            heights.copy(),
            vertex_ids.astype(np.int32),
            held.copy(),
            held.copy(),
        )
        inside = np.flatnonzero(face_of >= 0)
        order = inside[np.argsort(face_of[inside], kind="stable")].astype(np.int32)
        count = np.bincount(face_of[inside], minlength=n_faces).astype(np.int64)
        first = np.cumsum(count) - count
        pool = np.empty(3 * len(order) + 64, dtype=np.int32)
        pool[: len(order)] = order
        self.points = Points(
            np.ascontiguousarray(plan[:, 0]),
            np.ascontiguousarray(plan[:, 1]),
            columns,
            first,
            count,
            pool,
        )
        self.n_used = len(order)
        self.aim = aim
        self.key = _scattered(n)

    # -- sums ------------------------------------------------------------------------------------

    def face_errors(self) -> tuple[FloatArray, FloatArray]:
        n_faces = len(self.points.first)
        error, largest = np.empty(n_faces), np.empty(n_faces)
        run_in_ranges(
            sum_face_errors, n_faces, self.tin, self.points, self.aim, error, largest
        )
        return error, largest

    # -- passes ----------------------------------------------------------------------------------

    def relocate(self) -> int:
        """Move each vertex to the best place near it, and its height; return how many moved."""
        mesh = self.tin.mesh
        alive = np.flatnonzero((mesh.outgoing >= 0) & ~self.tin.is_locked)
        colour = np.full(len(mesh.outgoing), -1, dtype=np.int8)
        order = alive[np.argsort(self.key[alive], kind="stable")].astype(np.int32)
        colour_vertices(order, mesh, colour)
        n_moved = 0
        for c in range(int(colour.max(initial=-1)) + 1):
            chosen = np.flatnonzero(colour == c).astype(np.int32)
            n_moved += self._relocate(chosen)
        return n_moved

    def _relocate(self, chosen: NDArray[np.int32]) -> int:
        k, n_channels = len(chosen), self.tin.z.shape[1]
        counts = np.empty(k, dtype=np.int64)
        run_in_ranges(count_star_points, k, chosen, self.tin, self.points, counts)
        capacity = int(counts.max(initial=0))
        to, gain = np.empty(k, dtype=np.int32), np.empty(k)
        shift = np.empty((k, n_channels))
        run_in_ranges(
            propose_moves, k, chosen, self.tin, self.points, self.aim, capacity, to, shift, gain
        )
        base = self._room_for(np.where(to >= 0, counts, 0))
        run_in_ranges(
            move_vertices, k, chosen, to, shift, base, self.tin, self.points, capacity
        )
        return int(np.count_nonzero(to >= 0))

    def flip(self, n_passes: int) -> int:
        """Turn edges that lie better the other way; return how many."""
        mesh = self.tin.mesh
        half_edges = np.flatnonzero(mesh.twin > np.arange(len(mesh.twin))).astype(np.int32)
        gains = np.zeros(len(mesh.twin))
        n_flipped = 0
        for _ in range(n_passes):
            error, _ = self.face_errors()
            gain = np.empty(len(half_edges))
            run_in_ranges(
                gains_of_flips, len(half_edges), half_edges, self.tin, self.points, self.aim,
                error, gain,
            )  # fmt: skip
            gains[half_edges] = gain
            rows = np.flatnonzero(gains > 0.0).astype(np.int32)
            if len(rows) == 0:
                break
            order = np.argsort(-gains[rows], kind="stable")
            other = mesh.twin[rows]
            needs = np.column_stack(
                [
                    mesh.origin[rows],
                    mesh.origin[other],
                    mesh.origin[_before(rows)],
                    mesh.origin[_before(other)],
                ]
            ).astype(np.int32)
            wins = np.empty(len(rows), dtype=bool)
            take_in_order(order, needs, np.zeros(len(mesh.outgoing), dtype=bool), wins)
            chosen = rows[wins]
            faces = np.column_stack([chosen // 3, mesh.twin[chosen] // 3])
            base = self._room_for(self.points.count[faces].sum(axis=1))
            run_in_ranges(flip_edges, len(chosen), chosen, base, self.tin, self.points)
            n_flipped += len(chosen)
            touched = np.zeros(len(self.points.first), dtype=bool)
            touched[faces] = True
            around = np.flatnonzero(np.repeat(touched, 3)).astype(np.int32)
            gains[around] = 0.0
            twins = mesh.twin[around]
            gains[twins[twins >= 0]] = 0.0
            around = np.minimum(around[twins >= 0], twins[twins >= 0])
            half_edges = np.unique(around).astype(np.int32)
        return n_flipped

    def removals(
        self, bound: float, with_outline: bool
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], FloatArray, int]:
        """Return vertices that may go, onto which place of their ring, at what cost."""
        tin = self.tin
        alive = np.flatnonzero((tin.mesh.outgoing >= 0) & ~tin.is_locked).astype(np.int32)
        k = len(alive)
        counts = np.empty(k, dtype=np.int64)
        run_in_ranges(count_star_points, k, alive, tin, self.points, counts)
        error, _ = self.face_errors()
        target, cost = np.empty(k, dtype=np.int32), np.empty(k)
        run_in_ranges(
            propose_removals, k, alive, tin, self.points, self.aim, error, bound,
            int(counts.max(initial=0)), with_outline, target, cost,
        )  # fmt: skip
        found = target >= 0
        return alive[found], target[found], cost[found], int(counts.max(initial=0))

    def insertions(self) -> tuple[IntArray, ...]:
        n_faces = len(self.points.first)
        faces = np.arange(n_faces, dtype=np.int32)
        point, on_edge = np.empty(n_faces, dtype=np.int32), np.empty(n_faces, dtype=np.int32)
        height, gain = np.empty((n_faces, self.tin.z.shape[1])), np.empty(n_faces)
        run_in_ranges(
            propose_insertions, n_faces, faces, self.tin, self.points, self.aim, point, on_edge,
            height, gain,
        )  # fmt: skip
        found = np.flatnonzero(point >= 0)
        return faces[found], point[found], on_edge[found], height[found], gain[found]

    def replace(self, most: int, ratio: float) -> int:
        """Take out the vertices that help least and insert as many where that helps more."""
        mesh = self.tin.mesh
        faces, point, on_edge, height, gain = self.insertions()
        if len(faces) == 0:
            return 0
        most = min(most, len(faces))
        top = np.partition(gain, len(gain) - most)[len(gain) - most :]
        bound = float(top.max()) * ratio
        chosen, target, cost, capacity = self.removals(bound, False)
        if len(chosen) == 0:
            return 0
        width = MAX_REMOVED_RING + 1
        needs = np.empty((len(chosen), width + 1), dtype=np.int32)
        run_in_ranges(list_stars, len(chosen), chosen, mesh, needs)
        fits = needs[:, -1] < 0
        chosen, target, cost, needs = chosen[fits], target[fits], cost[fits], needs[fits]
        corners = np.empty((len(faces), 4), dtype=np.int32)
        run_in_ranges(list_corners, len(faces), faces, on_edge, mesh, corners)
        # both in order of what they are worth, side by side: the k-th cheapest for the k-th best
        by_cost, by_gain = np.argsort(cost, kind="stable"), np.argsort(-gain, kind="stable")
        n = min(len(by_cost), len(by_gain), most)
        pays = cost[by_cost[:n]] < ratio * gain[by_gain[:n]]
        n = int(np.argmin(pays)) if not pays.all() else n
        if n == 0:
            return 0
        outs, ins = by_cost[:n], by_gain[:n]
        needs = np.vstack([needs[outs], _widened(corners[ins], needs.shape[1])])
        order = np.arange(2 * n).reshape(2, n).T.ravel()
        wins = np.empty(2 * n, dtype=bool)
        take_in_order(order, needs, np.zeros(len(mesh.outgoing), dtype=bool), wins)
        outs, ins = outs[wins[:n]], ins[wins[n:]]
        n = min(len(outs), len(ins))
        outs, ins = outs[:n], ins[:n]
        freed = self._remove(chosen[outs], target[outs], capacity)
        self._insert(
            faces[ins], on_edge[ins], point[ins], height[ins], chosen[outs], freed, capacity
        )
        return n

    def _remove(self, chosen, target, capacity):
        k = len(chosen)
        counts = np.empty(k, dtype=np.int64)
        run_in_ranges(count_star_points, k, chosen, self.tin, self.points, counts)
        base = self._room_for(counts)
        freed = np.empty((k, 2), dtype=np.int32)
        run_in_ranges(
            remove_vertices, k, chosen, target, base, self.tin, self.points, capacity, freed
        )
        return freed

    def _insert(self, faces, on_edge, point, height, vertex, free, capacity):
        counts = self.points.count[faces].copy()
        split = on_edge >= 0
        counts[split] += self.points.count[self.tin.mesh.twin[on_edge[split]] // 3]
        base = self._room_for(counts)
        run_in_ranges(
            insert_vertices, len(faces), faces, on_edge, point, height, vertex, free, base,
            self.tin, self.points, int(counts.max(initial=0)),
        )  # fmt: skip

    # -- room ------------------------------------------------------------------------------------

    def _room_for(self, counts: IntArray) -> IntArray:
        """Return where in the pool there is room for so many points each."""
        total = int(counts.sum())
        if self.n_used + total > len(self.points.pool):
            count = self.points.count
            first = np.cumsum(count) - count
            n = int(count.sum())
            pool = np.empty(max(len(self.points.pool), n + total), dtype=np.int32)
            run_in_ranges(copy_lists, len(count), self.points, first, pool)
            self.points = self.points._replace(first=first, pool=pool)
            self.n_used = n
        base = np.cumsum(counts) - counts + self.n_used
        self.n_used += total
        return base


def _before(half_edge):
    return half_edge - 1 + 3 * (half_edge % 3 == 0)


def _widened(needs, width):
    wide = np.full((len(needs), width), -1, dtype=np.int32)
    wide[:, : needs.shape[1]] = needs
    return wide


def _scattered(n: int) -> NDArray[np.uint32]:
    key = np.arange(n, dtype=np.uint32) * np.uint32(2654435761)
    return (key ^ (key >> np.uint32(15))) * np.uint32(2246822519)
