"""A coarse TIN that changes in place, and which input points lie in each of its faces."""

from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.half_edges import HalfEdges
from .._kernels.refine_flip import flip_edges, gains_of_flips
from .._kernels.refine_merge import (
    MAX_RIM,
    count_polygon_points,
    list_polygons,
    merge_edges,
    propose_merges,
)
from .._kernels.refine_move import move_vertices, propose_moves
from .._kernels.refine_polygon import MAX_POLYGON, lay_polygons, propose_polygons
from .._kernels.refine_replace import (
    insert_vertices,
    list_corners,
    list_stars,
    propose_insertions,
    propose_removals,
    remove_vertices,
)
from .._kernels.refine_tin import (
    Objective,
    Points,
    Tin,
    colour_vertices,
    copy_lists,
    count_star_points,
    sum_face_errors,
    take_in_order,
)
from .._validate import FloatArray, IntArray
from ..mesh.half_edges import half_edges_of
from ..partition._level_state import scattered
from ._known import FaceErrors, Known
from ._proposals import Insertions, Polygons, Removals

#: Vertices with more neighbours than this are not taken out: they claim too much of the TIN. On
#: three DEMs 10 leaves up to 0.3 % more vertices within a tolerance, 25 as many.
MAX_REMOVED_RING = 15
#: The pool has room for so many times the points before it is put in order anew; the result is the
#: same for any.
ROOM = 3

IndexArray = NDArray[np.int32]
#: Called with the share of a pass that is done; it may raise, to stop.
Tell = Callable[[float], None]


class TinState:
    """A TIN in the making.

    Each pass works on parts that have nothing in common, chosen in an order that depends on the
    TIN alone; the kernels say what it does to each.

    Parameters
    ----------
    plan : (n_points, 2) float64
        x and y of the input points, about a local origin.
    columns : (n_points, n_channels) float64
        Their heights and attributes, weighted.
    heights : (n_vertices, n_channels) float64
        Those of the TIN's vertices.
    faces : (n_faces, 3) int32
    vertex_ids : (n_vertices,) int64
        The points that the vertices lie on.
    face_of : (n_points,) int64
        The face of each point, -1 for none.
    locked : (n_vertices,) bool
    objective : Objective
    strictness : (n_points,) float64, optional
        Weight of a squared height error against the tolerance of the objective; by default 1.
    """

    def __init__(
        self,
        plan: FloatArray,
        columns: FloatArray,
        heights: FloatArray,
        faces: IndexArray,
        vertex_ids: IntArray,
        face_of: IntArray,
        locked: NDArray[np.bool_],
        objective: Objective,
        strictness: FloatArray | None = None,
    ) -> None:
        mesh, n_fans = half_edges_of(faces, len(vertex_ids))
        # where two fans meet, a walk sees one of them only
        held = locked | (n_fans != 1)
        x, y = (np.ascontiguousarray(column) for column in plan.T)
        self.tin = Tin(
            mesh, x[vertex_ids], y[vertex_ids], heights.copy(), vertex_ids.astype(np.int32),
            held, held.copy(),
        )  # fmt: skip
        inside = np.flatnonzero(face_of >= 0)
        listed = inside[np.argsort(face_of[inside], kind="stable")]
        count = np.bincount(face_of[inside], minlength=len(faces)).astype(np.int64)
        pool = np.empty(ROOM * len(listed), dtype=np.int32)
        pool[: len(listed)] = listed
        strict = np.ones(len(x)) if strictness is None else strictness
        self.points = Points(x, y, columns, strict, np.cumsum(count) - count, count, pool)
        self._objective = objective
        self._known = Known.nothing(len(faces))
        self._n_used = len(listed)
        self._key = scattered(len(vertex_ids))
        self._lives = np.ones(len(vertex_ids), dtype=bool)

    @property
    def objective(self) -> Objective:
        """What is made small; with another one nothing is known of the TIN."""
        return self._objective

    @objective.setter
    def objective(self, objective: Objective) -> None:
        if objective != self._objective:
            self._objective = objective
            self._known = Known.nothing(len(self.points.first))

    @property
    def n_vertices(self) -> int:
        """How many vertices there are now."""
        return int(np.count_nonzero(self._lives))

    def snapshot(self) -> TinState:
        """Return a copy to go back to; lists in place are never written over."""
        twin = copy.copy(self)
        mesh = HalfEdges._make(array.copy() for array in self.tin.mesh)
        twin.tin = Tin._make([mesh, *(array.copy() for array in self.tin[1:])])
        twin.points = self.points._replace(
            first=self.points.first.copy(), n_points=self.points.n_points.copy()
        )
        twin._lives = self._lives.copy()
        twin._known = Known.nothing(len(self.points.first))
        return twin

    # -- what there is ---------------------------------------------------------------------------

    def face_errors(self) -> FaceErrors:
        """Return the errors of all faces, as they are until the next change."""
        known = self._known
        chosen = np.flatnonzero(known.has_new_error)
        run_in_ranges(
            sum_face_errors, len(chosen), chosen, self.tin, self.points, self.objective,
            *known.errors,
        )  # fmt: skip
        known.has_new_error[:] = False
        return known.errors

    def faces(self) -> tuple[IntArray, IntArray, IntArray]:
        """Return the slots of the vertices and of the faces, and the faces by the former."""
        slots = np.flatnonzero(self._lives)
        slots = slots[np.argsort(self.tin.point[slots], kind="stable")]
        position = np.full(len(self._lives), -1, dtype=np.int64)
        position[slots] = np.arange(len(slots))
        corners = self.tin.mesh.origin.reshape(-1, 3)
        kept = np.flatnonzero(corners[:, 0] >= 0)
        return slots, kept, position[corners[kept]]

    def listed_points(self, kept: IntArray) -> tuple[IntArray, IntArray]:
        """Return the points of the faces ``kept``, and in which of those each lies."""
        count = self.points.n_points[kept]
        face = np.repeat(np.arange(len(kept)), count)
        ends = np.cumsum(count)
        place = np.arange(len(face)) + np.repeat(self.points.first[kept] - ends + count, count)
        return self.points.pool[place].astype(np.int64), face

    # -- places and heights ----------------------------------------------------------------------

    def relocate(self, tell: Tell | None = None) -> int:
        """Move each vertex to the best place near it, and its height; return how many moved."""
        mesh = self.tin.mesh
        alive = self._free_vertices()
        colour = np.full(len(mesh.outgoing), -1, dtype=np.int8)
        colour_vertices(alive[np.argsort(self._key[alive], kind="stable")], mesh, colour)
        n_moved, n_colours = 0, int(colour.max(initial=-1)) + 1
        for c in range(n_colours):
            n_moved += self._relocate(np.flatnonzero(colour == c).astype(np.int32))
            if tell is not None:
                tell((c + 1) / n_colours)
        return n_moved

    def _relocate(self, chosen: IndexArray) -> int:
        n = len(chosen)
        counts = self._star_points(chosen)
        capacity = int(counts.max(initial=0))
        to, gain = np.empty(n, dtype=np.int32), np.empty(n)
        shift = np.empty((n, self.tin.z.shape[1]))
        run_in_ranges(
            propose_moves,
            n,
            chosen,
            self.tin,
            self.points,
            self.objective,
            capacity,
            to,
            shift,
            gain,
        )
        moves = to >= 0
        base = self._room_for(np.where(moves, counts, 0))
        run_in_ranges(move_vertices, n, chosen, to, shift, base, self.tin, self.points, capacity)
        self._known.has_new_error[:] = self._known.has_new_edges[:] = True
        return int(np.count_nonzero(moves))

    def _star_points(self, chosen: IndexArray) -> IntArray:
        counts = np.empty(len(chosen), dtype=np.int64)
        run_in_ranges(count_star_points, len(chosen), chosen, self.tin, self.points, counts)
        return counts

    # -- edges -----------------------------------------------------------------------------------

    def flip(self, n_passes: int, tell: Tell | None = None) -> int:
        """Turn edges that lie better the other way, the best first; return how many."""
        mesh, gains = self.tin.mesh, self._known.gains
        n_flipped = 0
        for number in range(n_passes):
            if tell is not None:
                tell(number / n_passes)
            self._judge_edges()
            chosen = self._apart(np.flatnonzero(gains > 0.0).astype(np.int32), gains)
            if len(chosen) == 0:
                break
            faces = np.column_stack([chosen // 3, mesh.twin[chosen] // 3])
            base = self._room_for(self.points.n_points[faces].sum(axis=1))
            run_in_ranges(flip_edges, len(chosen), chosen, base, self.tin, self.points)
            n_flipped += len(chosen)
            self._known.change(faces)
        return n_flipped

    def _judge_edges(self) -> None:
        """Work out what the edges of changed faces gain where they are turned."""
        twin, known = self.tin.mesh.twin, self._known
        around = (3 * np.flatnonzero(known.has_new_edges)[:, None] + np.arange(3)).ravel()
        beyond = twin[around]
        known.gains[around] = 0.0
        known.gains[beyond[beyond >= 0]] = 0.0
        is_judged = np.zeros(len(twin), dtype=bool)
        is_judged[np.minimum(around, beyond)[beyond >= 0]] = True
        half_edges = np.flatnonzero(is_judged).astype(np.int32)
        gain = np.empty(len(half_edges))
        run_in_ranges(
            gains_of_flips, len(half_edges), half_edges, self.tin, self.points, self.objective,
            self.face_errors().error, gain,
        )  # fmt: skip
        known.gains[half_edges] = gain
        known.has_new_edges[:] = False

    def _apart(self, half_edges: IndexArray, gains: FloatArray) -> IndexArray:
        """Return edges whose quadrangles have no vertex in common."""
        mesh = self.tin.mesh
        other = mesh.twin[half_edges]
        corners = (half_edges, other, _before(half_edges), _before(other))
        needs = np.column_stack([mesh.origin[corner] for corner in corners])
        return half_edges[self._first(np.argsort(-gains[half_edges], kind="stable"), needs)]

    def _first(self, order: IntArray, needs: IndexArray) -> NDArray[np.bool_]:
        """Return which rows get all the vertices that they need."""
        wins = np.zeros(len(needs), dtype=bool)
        is_taken = np.zeros(len(self._lives), dtype=bool)
        take_in_order(order, np.ascontiguousarray(needs), is_taken, wins)
        return wins

    # -- vertices that go, and that come ---------------------------------------------------------

    def replace(self, most: int, ratio: float) -> int:
        """Take out the vertices that help least, and put as many where they help more.

        The k-th cheapest makes room for the k-th best, at most ``most`` of them, while the one
        costs less than ``ratio`` times what the other gains; those whose surroundings meet wait.
        """
        wanted = self._insertions()
        most = min(most, len(wanted.gain))
        if most == 0:
            return 0
        by_gain = np.argsort(-wanted.gain, kind="stable")[:most]
        spare = self._removals(ratio * float(wanted.gain[by_gain[0]]), with_outline=False)
        by_cost = np.argsort(spare.cost, kind="stable")[:most]
        n = min(len(by_cost), len(by_gain))
        pays = spare.cost[by_cost[:n]] < ratio * wanted.gain[by_gain[:n]]
        n = int(np.count_nonzero(pays))  # the one rises, the other falls
        outs, ins = by_cost[:n], by_gain[:n]
        corners = np.full((n, spare.needs.shape[1]), -1, dtype=np.int32)
        list_corners(0, n, wanted.face[ins], wanted.on_edge[ins], self.tin.mesh, corners)
        order = np.arange(2 * n).reshape(2, n).T.ravel()  # in turns
        wins = self._first(order, np.vstack([spare.needs[outs], corners]))
        came = wins[n:]
        outs, ins = outs[wins[:n]], ins[came]
        n = min(len(outs), len(ins))
        outs, ins = outs[:n], ins[:n]
        vertex = spare.vertex[outs]
        freed = self._remove(vertex, spare.target[outs], spare.capacity)
        self._insert(Insertions._make(array[ins] for array in wanted), vertex, freed)
        self._change_around(np.vstack([spare.needs[outs], corners[came][:n]]))
        return n

    def thin(self, budget: float = np.inf) -> int:
        """Take out vertices, the cheapest first; return how many.

        Their costs sum to at most ``budget``; no tolerance of the objective is broken.
        """
        spare = self._removals(np.inf, with_outline=True)
        order = np.argsort(spare.cost, kind="stable")
        # what could be had if none stood in another's way: dearer ones wait for the next pass
        n = np.searchsorted(np.maximum.accumulate(np.cumsum(spare.cost[order])), budget, "right")
        wins = self._first(order[:n], spare.needs)
        order = np.sort(order[wins[order]])
        vertex = spare.vertex[order]
        self._remove(vertex, spare.target[order], spare.capacity)
        self._change_around(spare.needs[order])
        self._lives[vertex] = False
        return len(vertex)

    def thin_by_polygons(self) -> int:
        """Take out vertices whose star keeps the tolerance in any triangulation; return how many.

        The cheapest first; an outline vertex only where the outline runs straight through it.
        """
        found = self._polygons(self._free_vertices())
        return self._lay(found.rows(self._cheapest_apart(found.cost, found.needs)))

    def shrink_to(self, n_vertices: int) -> int:
        """Take out vertices until so many are left, the cheapest first; return how many went.

        The best triangulation takes the place of each star. What a vertex costs whose neighbour has
        gone is worked out anew once it would be among the next to go.
        """
        n_slots, n_before = len(self._lives), self.n_vertices
        cost = np.full(n_slots, np.inf)
        corners = np.empty((n_slots, MAX_POLYGON - 2, 3), dtype=np.int8)
        has_new_star = np.zeros(n_slots, dtype=bool)

        def judge(vertex: IndexArray) -> None:
            found = self._polygons(vertex)
            cost[vertex], has_new_star[vertex] = np.inf, False
            cost[found.vertex], corners[found.vertex] = found.cost, found.corners

        judge(self._free_vertices())
        while (due := self.n_vertices - n_vertices) > 0:
            next_ones = np.argsort(cost, kind="stable")[: 2 * due].astype(np.int32)
            judge(np.sort(next_ones[has_new_star[next_ones]]))
            chosen = next_ones[np.argsort(cost[next_ones], kind="stable")][:due]
            chosen = chosen[cost[chosen] < np.inf]
            if len(chosen) == 0:
                left = np.flatnonzero(has_new_star & self._lives).astype(np.int32)
                if len(left) == 0:
                    break
                judge(left)
                continue
            cheapest = self._as_polygons(chosen, corners[chosen], cost[chosen])
            gone = cheapest.rows(self._cheapest_apart(cheapest.cost, cheapest.needs))
            self._lay(gone)
            cost[gone.vertex] = np.inf
            has_new_star[gone.needs[gone.needs >= 0]] = True
        return n_before - self.n_vertices

    def _polygons(self, vertex: IndexArray) -> Polygons:
        """Return those of the vertices that may go, and what takes the place of their stars."""
        capacity = int(self._star_points(vertex).max(initial=0))
        corners = np.empty((len(vertex), MAX_POLYGON - 2, 3), dtype=np.int8)
        cost = np.empty(len(vertex))
        run_in_ranges(
            propose_polygons, len(vertex), vertex, self.tin, self.points, self.objective,
            self.face_errors().error, capacity, corners, cost,
        )  # fmt: skip
        found = np.flatnonzero(cost < np.inf)
        return self._as_polygons(vertex[found], corners[found], cost[found])

    def _as_polygons(
        self, vertex: IndexArray, corners: NDArray[np.int8], cost: FloatArray
    ) -> Polygons:
        needs = np.empty((len(vertex), MAX_POLYGON + 1), dtype=np.int32)
        run_in_ranges(list_stars, len(vertex), vertex, self.tin.mesh, needs)
        return Polygons(vertex, corners, cost, needs)

    def _lay(self, polygons: Polygons) -> int:
        """Lay polygons that have no vertex in common; return how many."""
        counts = self._star_points(polygons.vertex)
        base = self._room_for(counts)
        run_in_ranges(
            lay_polygons, len(counts), polygons.vertex, polygons.corners, base, self.tin,
            self.points, int(counts.max(initial=0)),
        )  # fmt: skip
        self._change_around(polygons.needs)
        self._lives[polygons.vertex] = False
        return len(counts)

    def merge(self) -> int:
        """Put a point in place of both ends of an edge, within the tolerance; return how many.

        The cheapest first; an edge with an end on the outline only where that runs straight on.
        """
        mesh = self.tin.mesh
        every = np.arange(len(mesh.twin))
        half_edges = np.flatnonzero((mesh.origin >= 0) & (mesh.twin < every)).astype(np.int32)
        counts = np.empty(len(half_edges), dtype=np.int64)
        run_in_ranges(
            count_polygon_points, len(half_edges), half_edges, self.tin, self.points, counts
        )
        capacity = int(counts.max(initial=0))
        to, cost = np.empty(len(half_edges), dtype=np.int32), np.empty(len(half_edges))
        run_in_ranges(
            propose_merges, len(half_edges), half_edges, counts, self.tin, self.points,
            self.objective, self.face_errors().error, capacity, to, cost,
        )  # fmt: skip
        found = np.flatnonzero(to >= 0)
        needs = np.empty((len(found), MAX_RIM + 3), dtype=np.int32)
        run_in_ranges(list_polygons, len(found), half_edges[found], mesh, needs)
        apart = self._cheapest_apart(cost[found], needs)
        chosen, gone = found[apart], needs[apart, 1]
        base = self._room_for(counts[chosen])
        run_in_ranges(
            merge_edges, len(chosen), half_edges[chosen], to[chosen], base, self.tin, self.points,
            capacity,
        )  # fmt: skip
        self._change_around(needs[apart])
        self._lives[gone] = False
        return len(chosen)

    def _change_around(self, vertices: IndexArray) -> None:
        """Note that faces may be other ones, or gone, all whose corners are among these or -1."""
        is_one = np.zeros(len(self._lives) + 1, dtype=bool)
        is_one[vertices] = is_one[-1] = True
        inside = is_one[self.tin.mesh.origin].reshape(-1, 3).all(axis=1)
        self._known.change(np.flatnonzero(inside))

    def _cheapest_apart(self, cost: FloatArray, needs: IndexArray) -> IntArray:
        """Return, ascending, the cheapest rows that need no vertex of a cheaper one."""
        order = np.argsort(cost, kind="stable")
        return np.flatnonzero(self._first(order, needs))

    def _free_vertices(self) -> IndexArray:
        free = (self.tin.mesh.outgoing >= 0) & ~self.tin.is_locked
        return np.flatnonzero(free).astype(np.int32)

    def _removals(self, bound: float, *, with_outline: bool) -> Removals:
        tin = self.tin
        vertex = self._free_vertices()
        counts = self._star_points(vertex)
        capacity = int(counts.max(initial=0))
        target, cost = np.empty(len(vertex), dtype=np.int32), np.empty(len(vertex))
        run_in_ranges(
            propose_removals, len(vertex), vertex, tin, self.points, self.objective,
            self.face_errors().error, bound, capacity, with_outline, target, cost,
        )  # fmt: skip
        found = np.flatnonzero(target >= 0)
        needs = np.empty((len(found), MAX_REMOVED_RING + 2), dtype=np.int32)
        run_in_ranges(list_stars, len(found), vertex[found], tin.mesh, needs)
        fits = needs[:, -1] < 0
        found, needs = found[fits], needs[fits]
        return Removals(vertex[found], target[found], cost[found], needs, capacity)

    def _insertions(self) -> Insertions:
        n = len(self.points.first)
        face = np.arange(n, dtype=np.int32)
        point, on_edge = np.empty(n, dtype=np.int32), np.empty(n, dtype=np.int32)
        height, gain = np.empty((n, self.tin.z.shape[1])), np.empty(n)
        run_in_ranges(
            propose_insertions, n, face, self.tin, self.points, self.objective, point, on_edge,
            height, gain,
        )  # fmt: skip
        found = np.flatnonzero(point >= 0)
        return Insertions._make(array[found] for array in (face, point, on_edge, height, gain))

    def _remove(self, vertex: IndexArray, target: IndexArray, capacity: int) -> IndexArray:
        """Collapse vertices onto places of their rings; return the two faces that each frees."""
        base = self._room_for(self._star_points(vertex))
        freed = np.empty((len(vertex), 2), dtype=np.int32)
        run_in_ranges(
            remove_vertices, len(vertex), vertex, target, base, self.tin, self.points, capacity,
            freed,
        )  # fmt: skip
        return freed

    def _insert(self, new: Insertions, vertex: IndexArray, free: IndexArray) -> None:
        counts = self.points.n_points[new.face]
        split = new.on_edge >= 0
        counts[split] += self.points.n_points[self.tin.mesh.twin[new.on_edge[split]] // 3]
        base = self._room_for(counts)
        run_in_ranges(
            insert_vertices, len(vertex), new.face, new.on_edge, new.point, new.height, vertex,
            free, base, self.tin, self.points, int(counts.max(initial=0)),
        )  # fmt: skip

    # -- room ------------------------------------------------------------------------------------

    def _room_for(self, counts: IntArray) -> IntArray:
        """Return where in the pool there is room for lists of such lengths."""
        total = int(counts.sum())
        if self._n_used + total > len(self.points.pool):
            count = self.points.n_points
            first = np.cumsum(count) - count
            self._n_used = int(count.sum())
            pool = np.empty(ROOM * self._n_used + total, dtype=np.int32)
            run_in_ranges(copy_lists, len(count), self.points, first, pool)
            self.points = self.points._replace(first=first, pool=pool)
        base = np.cumsum(counts) - counts + self._n_used
        self._n_used += total
        return base


def _before(half_edge: IndexArray) -> IndexArray:
    return half_edge - 1 + 3 * (half_edge % 3 == 0)
