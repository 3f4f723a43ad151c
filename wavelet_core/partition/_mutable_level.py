"""The working state of a surface-guided analysis: one level, collapsed in place."""

from __future__ import annotations

import copy

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.connectivity import fill_stars
from .._kernels.half_edges import (
    HalfEdges,
    find_outgoing,
    find_twins,
    pack_faces,
    pack_vertices,
    renew_outgoing,
)
from .._kernels.surface_choice import (
    CANDIDATE,
    TAKEN,
    collapse_all,
    find_cheapest,
    measure_rings,
    record_rings,
    take_cheapest,
)
from .._kernels.surface_cost import LARGEST, LEAST_SQUARES, collapse_costs
from .._kernels.surface_points import (
    FacePoints,
    Moments,
    Surface,
    copy_points,
    count_points,
    hand_over,
    sum_over_faces,
    sum_over_stars,
    update_heights,
)
from .._validate import FloatArray, frozen
from ..lifting.step import Step

#: Part of the vertices that a level may take, by whose dearest the others' costs are judged.
CHEAPEST_SHARE = 16
#: Errors below this part of the range of z are rounding.
ROUNDING = 1e-9
#: Arrays are packed when no more than this share of them is in use.
PACKED_SHARE = 0.7


class SurfaceLevel:
    """The present level; its vertices and faces live in arrays with gaps.

    Slots keep the order of the input, so that the vertices of a level are its live slots in
    ascending order.

    Parameters
    ----------
    plan : ndarray, shape (n_vertices, 2)
        x and y.
    heights : ndarray, shape (n_vertices, n_channels)
        z and the weighted attributes.
    faces : ndarray of int32, shape (n_faces, 3)
    locked : ndarray of bool, shape (n_vertices,)
    with_update : bool
        Whether the minimum-norm update follows each step.
    """

    def __init__(
        self,
        plan: FloatArray,
        heights: FloatArray,
        faces: NDArray[np.int32],
        locked: NDArray[np.bool_],
        with_update: bool,
    ) -> None:
        n_vertices, n_faces, n_channels = len(plan), len(faces), heights.shape[1]
        self._mesh, has_one_fan = _half_edges(faces, n_vertices)
        origin = plan.min(axis=0) + np.ptp(plan, axis=0) / 2
        self._surface = Surface(
            np.ascontiguousarray(plan[:, 0] - origin[0]),
            np.ascontiguousarray(plan[:, 1] - origin[1]),
            heights.copy(),
            heights,
        )
        self._points = FacePoints(
            np.zeros(n_faces, np.int32),
            np.zeros(n_faces, np.int32),
            np.empty(0),
            np.empty(0),
            np.empty((0, n_channels)),
        )
        self._n_used = 0
        self.n_input = n_vertices
        self._dearest = 0.0
        self._noise = (ROUNDING * float(np.ptp(heights[:, 0]))) ** 2
        self.n_vertices = n_vertices
        self._ids = np.arange(n_vertices, dtype=np.int32)
        self._vertex_lives = np.ones(n_vertices, dtype=bool)
        self._face_lives = np.ones(n_faces, dtype=bool)
        self._locked = locked
        self._stays = locked | ~has_one_fan
        self._integrals = np.ones(n_vertices)
        self._cost = np.full(n_vertices, -np.inf)
        self._key = _scattered(n_vertices)
        self._target = np.full(n_vertices, -1, dtype=np.int32)
        self._is_stale = np.ones(n_vertices, dtype=bool)
        self._is_new = np.ones(n_vertices, dtype=bool)
        self._has_moved = np.zeros(n_vertices, dtype=bool)
        self._z_changed = np.zeros(n_vertices, dtype=bool)
        self._face_changed = np.zeros(n_faces, dtype=bool)
        self._squared = np.zeros(n_faces)
        self._squared_z = np.zeros(n_faces if n_channels > 1 else 0)
        self._largest_z = np.zeros(n_faces)
        n_corners, n_stars = (3 * n_faces, n_vertices) if with_update else (0, 0)
        self._moments = Moments(
            np.zeros((n_corners, n_channels), np.float32),
            np.zeros(n_corners, np.float32),
            np.zeros((n_stars, n_channels)),
            np.ones(n_stars),
        )
        self._with_update = with_update

    @property
    def ids(self) -> NDArray[np.int32]:
        """Ids, in the input, of the vertices of the level."""
        return self._ids[self._vertex_lives]

    @property
    def heights(self) -> FloatArray:
        """Present heights and weighted attributes, one row a vertex of the level."""
        return self._surface.z[self._vertex_lives]

    def costs(self, slots: NDArray[np.int32]) -> FloatArray:
        """Return the costs of vertices, as last ranked."""
        return self._cost[slots]

    def squared_errors(self) -> float:
        """Return the sum of the squared height errors of all input vertices."""
        of_faces = self._squared_z if len(self._squared_z) else self._squared
        return float(of_faces[self._face_lives].sum() + (self._own_errors() ** 2).sum())

    def largest_error(self) -> float:
        """Return the largest height error of all input vertices."""
        of_faces = self._largest_z[self._face_lives].max(initial=0.0)
        return max(float(np.sqrt(of_faces)), float(np.abs(self._own_errors()).max(initial=0.0)))

    def _own_errors(self) -> FloatArray:
        difference = self._surface.z[:, 0] - self._surface.measured[:, 0]
        return difference[self._vertex_lives]

    # -- which vertices go -----------------------------------------------------------------------

    def rank(self, norm: str, tolerance: float, cutoff: float) -> None:
        """Bring the costs up to date that may be at most ``cutoff``."""
        may_matter = (self._cost <= cutoff) | (self._cost == np.inf)
        todo = np.flatnonzero(self._is_stale & self._vertex_lives & may_matter)
        todo = todo.astype(np.int32)
        run_in_ranges(
            collapse_costs, len(todo), todo, self._mesh, self._surface, self._points, self._stays,
            self._locked, self._squared, self._moments, self._integrals,
            LARGEST if norm == "max" else LEAST_SQUARES, tolerance**2, cutoff, self._cost,
            self._target, self._is_stale, self._is_new,
        )  # fmt: skip

    def candidates(
        self, fraction: float, cutoff: float, cost_ratio: float = np.inf
    ) -> NDArray[np.int32]:
        """Return the slots of the vertices that may be odd: the cheapest ``fraction`` at most.

        None of them costs more than ``cost_ratio`` times what the cheapest part of those
        (1 / CHEAPEST_SHARE) does, or than what a level before was allowed to take.
        """
        known = (
            self._vertex_lives & ~self._is_stale & (self._cost <= cutoff) & np.isfinite(self._cost)
        )
        slots = np.flatnonzero(known).astype(np.int32)
        cost = self._cost[slots]
        n_most = max(int(fraction * self.n_vertices), 1)
        n_cheapest = max(n_most // CHEAPEST_SHARE, 1)
        if len(slots) < n_cheapest:
            return slots
        places = [n_cheapest - 1, min(n_most, len(slots)) - 1]
        cheap, dear = np.partition(cost, places)[places]
        if cost_ratio < np.inf:
            self._dearest = max(cost_ratio * cheap, self._noise, self._dearest)
            dear = min(dear, self._dearest)
        return slots[cost <= dear]

    def independent(
        self, slots: NDArray[np.int32], max_odd: int, budget: float
    ) -> NDArray[np.int32]:
        """Return those candidates that go: no two of them neighbours, the cheaper one first.

        The set is the one that a single pass in order of cost would find; equal costs are told
        apart by a number scattered over the vertices, so that flat terrain is not thinned in
        rows. At most ``max_odd`` go, whose costs sum to at most ``budget``.
        """
        state = np.zeros(len(self._ids), dtype=np.int8)
        state[slots] = CANDIDATE
        active = slots
        while len(active):
            wins = np.empty(len(active), dtype=bool)
            arguments = (active, self._mesh, state, self._cost, self._key, wins)
            run_in_ranges(find_cheapest, len(active), *arguments)
            run_in_ranges(take_cheapest, len(active), active, wins, self._mesh, state)
            active = active[state[active] == CANDIDATE]
        odd = slots[state[slots] == TAKEN]
        if len(odd) <= max_odd and budget == np.inf:
            return odd
        odd = odd[np.lexsort((self._key[odd], self._cost[odd]))][:max_odd]
        spent = np.maximum.accumulate(np.cumsum(self._cost[odd]))
        n_affordable = np.searchsorted(spent, budget, side="right")
        return np.sort(odd[:n_affordable])

    # -- one step --------------------------------------------------------------------------------

    def remove(self, odd: NDArray[np.int32]) -> Step:
        """Collapse the odd vertices, predict, update; return the step, details as weighted."""
        odd, indptr, ring, ring_faces = self._collapse(odd)
        corners, weights, details = self._hand_over(odd, indptr, ring, ring_faces)
        stays = self._vertex_lives
        even_position = np.cumsum(stays, dtype=np.int32) - np.int32(1)
        fine = stays.copy()
        fine[odd] = True
        fine_position = np.cumsum(fine, dtype=np.int32) - np.int32(1)
        row_indptr, columns, row_weights = self._support(corners, weights, indptr, ring)
        self.n_vertices -= len(odd)
        if self._with_update:
            update_heights(
                odd, row_indptr, columns, row_weights, details, self._locked, self._integrals,
                self._surface.z, self._z_changed,
            )  # fmt: skip
        self._bring_sums_up_to_date()
        step = Step(
            frozen(fine_position[odd]),
            frozen(fine_position[ring[indptr[:-1]]]),
            frozen(row_indptr),
            frozen(even_position[columns]),
            frozen(row_weights),
            details,
        )
        self._pack()
        return step

    def _collapse(
        self, odd: NDArray[np.int32]
    ) -> tuple[NDArray[np.int32], NDArray[np.int64], NDArray[np.int32], NDArray[np.int32]]:
        """Collapse on the mesh; return the odd vertices that went and their rings in CSR."""
        size = np.empty(len(odd), dtype=np.int64)
        run_in_ranges(measure_rings, len(odd), odd, self._mesh, size)
        indptr = _starts(size)
        ring = np.empty(indptr[-1], dtype=np.int32)
        ring_faces = np.empty(indptr[-1], dtype=np.int32)
        target = self._target[odd]
        arguments = (odd, target, self._mesh, indptr, ring, ring_faces)
        run_in_ranges(record_rings, len(odd), *arguments)
        goes = np.empty(len(odd), dtype=bool)
        stamp = np.zeros(len(self._ids), dtype=np.int32)
        lives = (self._vertex_lives, self._face_lives)
        collapse_all(odd, indptr, ring, ring_faces, self._mesh, *lives, stamp, goes)
        renew_outgoing(self._mesh, self._face_lives)
        if goes.all():
            return odd, indptr, ring, ring_faces
        self._cost[odd[~goes]] = np.inf  # until its star changes
        kept = np.repeat(goes, size)
        return odd[goes], _starts(size[goes]), ring[kept], ring_faces[kept]

    def _hand_over(
        self,
        odd: NDArray[np.int32],
        indptr: NDArray[np.int64],
        ring: NDArray[np.int32],
        ring_faces: NDArray[np.int32],
    ) -> tuple[NDArray[np.int32], FloatArray, FloatArray]:
        """Move the points to their new faces; return corners, weights and details."""
        size = np.empty(len(odd), dtype=np.int64)
        run_in_ranges(count_points, len(odd), indptr, ring_faces, self._points, size)
        first = _starts(size)
        self._make_room(int(first[-1]))
        first += self._n_used
        self._n_used = int(first[-1])
        corners = np.empty((len(odd), 3), dtype=np.int32)
        weights = np.empty((len(odd), 3))
        details = np.empty((len(odd), self._surface.z.shape[1]))
        run_in_ranges(
            hand_over, len(odd), odd, indptr, ring, ring_faces, self._surface, self._points, first,
            self._face_changed, corners, weights, details,
        )  # fmt: skip
        return corners, weights, details

    def _support(
        self,
        corners: NDArray[np.int32],
        weights: FloatArray,
        indptr: NDArray[np.int64],
        ring: NDArray[np.int32],
    ) -> tuple[NDArray[np.int64], NDArray[np.int32], FloatArray]:
        """Return the rows of P: the corners, and, if all are locked, the rest of the ring at 0."""
        n_odd = len(corners)
        row_indptr = np.arange(0, 3 * n_odd + 1, 3, dtype=np.int64)
        columns, row_weights = corners.ravel(), weights.ravel()
        stuck = np.flatnonzero(self._locked[corners].all(axis=1))
        if len(stuck) == 0:
            return row_indptr, columns, row_weights
        counts = np.full(n_odd, 3, dtype=np.int64)
        extra = []
        for row in stuck:
            around = ring[indptr[row] : indptr[row + 1]]
            extra.append(around[~self._locked[around]])
            counts[row] += len(extra[-1])
        where = np.repeat(3 * (stuck + 1), counts[stuck] - 3)
        columns = np.insert(columns, where, np.concatenate(extra))
        return _starts(counts), columns, np.insert(row_weights, where, 0.0)

    def _bring_sums_up_to_date(self) -> None:
        """Sum the errors anew where faces or heights changed; mark the costs that depend on it."""
        run_in_ranges(
            sum_over_faces, len(self._face_lives), self._mesh, self._face_lives,
            self._face_changed, self._z_changed, self._surface, self._points, self._squared,
            self._squared_z, self._largest_z, self._moments, self._is_stale, self._is_new,
            self._has_moved,
        )  # fmt: skip
        self._z_changed[:] = False
        if self._with_update:
            run_in_ranges(
                sum_over_stars, len(self._ids), self._mesh, self._vertex_lives, self._has_moved,
                self._surface, self._moments,
            )  # fmt: skip

    # -- keeping the arrays small ----------------------------------------------------------------

    def _make_room(self, n_more: int) -> None:
        """Leave room for ``n_more`` points behind those in use."""
        if self._n_used + n_more <= len(self._points.x):
            return
        holders = np.flatnonzero(self._points.n_points).astype(np.int32)
        first = _starts(self._points.n_points[holders])
        capacity = int(first[-1]) + n_more
        capacity += capacity // 2 + self.n_input // 4
        n_channels = self._points.z.shape[1]
        x, y, z = np.empty(capacity), np.empty(capacity), np.empty((capacity, n_channels))
        run_in_ranges(copy_points, len(holders), holders, first, self._points, x, y, z)
        start = self._points.start.copy()
        start[holders] = first[:-1]
        self._points = FacePoints(start, self._points.n_points, x, y, z)
        self._n_used = int(first[-1])

    def _pack(self) -> None:
        """Close the gaps once there are many."""
        if self.n_vertices > PACKED_SHARE * len(self._ids):
            return
        vertices, faces = np.flatnonzero(self._vertex_lives), np.flatnonzero(self._face_lives)
        position = np.full(len(self._ids), -1, dtype=np.int32)
        position[vertices] = np.arange(len(vertices), dtype=np.int32)
        face_position = np.full(len(self._face_lives), -1, dtype=np.int32)
        face_position[faces] = np.arange(len(faces), dtype=np.int32)

        packed = HalfEdges(
            np.empty(3 * len(faces), dtype=np.int32),
            np.empty(3 * len(faces), dtype=np.int32),
            np.empty(len(vertices), dtype=np.int32),
        )
        run_in_ranges(pack_faces, len(faces), faces, position, face_position, self._mesh, packed)
        run_in_ranges(pack_vertices, len(vertices), vertices, face_position, self._mesh, packed)
        self._mesh = packed
        self._surface = Surface(*(np.ascontiguousarray(a[vertices]) for a in self._surface))
        self._points = self._points._replace(
            start=self._points.start[faces], n_points=self._points.n_points[faces]
        )
        self._target = position[self._target[vertices]]
        for name in _OF_VERTICES:
            setattr(self, name, getattr(self, name)[vertices])
        for name in _OF_FACES:
            setattr(self, name, getattr(self, name)[faces])
        if len(self._squared_z):
            self._squared_z = self._squared_z[faces]
        if self._with_update:
            n_channels = self._moments.slope.shape[1]
            self._moments = Moments(
                self._moments.slope.reshape(-1, 3, n_channels)[faces].reshape(-1, n_channels),
                self._moments.weight.reshape(-1, 3)[faces].ravel(),
                self._moments.vertex_slope[vertices],
                self._moments.vertex_weight[vertices],
            )

    def snapshot(self) -> SurfaceLevel:
        """Return a copy to go back to; points already in place are never overwritten."""
        twin = copy.copy(self)
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                setattr(twin, name, value.copy())
        twin._mesh = HalfEdges(*(array.copy() for array in self._mesh))
        twin._moments = copy.deepcopy(self._moments)
        twin._surface = self._surface._replace(z=self._surface.z.copy())
        twin._points = self._points._replace(
            start=self._points.start.copy(), n_points=self._points.n_points.copy()
        )
        return twin


_OF_VERTICES = (
    "_ids", "_vertex_lives", "_locked", "_stays", "_integrals", "_cost", "_key", "_is_stale",
    "_is_new", "_has_moved", "_z_changed",
)  # fmt: skip
_OF_FACES = ("_face_lives", "_face_changed", "_squared", "_largest_z")


def _half_edges(faces: NDArray[np.int32], n_vertices: int) -> tuple[HalfEdges, NDArray[np.bool_]]:
    """Return the half-edge mesh, and which vertices have one fan of faces around them."""
    indptr = np.zeros(n_vertices + 1, dtype=np.int64)
    star = np.empty(3 * len(faces), dtype=np.int32)
    fill_stars(faces, indptr, star)
    mesh = HalfEdges(
        faces.ravel().copy(),
        np.empty(3 * len(faces), dtype=np.int32),
        np.empty(n_vertices, dtype=np.int32),
    )
    run_in_ranges(find_twins, len(faces), indptr, star, mesh)
    n_fans = np.empty(n_vertices, dtype=np.int8)
    run_in_ranges(find_outgoing, n_vertices, indptr, star, mesh, n_fans)
    return mesh, n_fans == 1


def _scattered(n_vertices: int) -> NDArray[np.uint32]:
    """Return a different number for each vertex, without order (a Weyl sequence, mixed)."""
    key = np.arange(n_vertices, dtype=np.uint32) * np.uint32(2654435761)
    return (key ^ (key >> np.uint32(15))) * np.uint32(2246822519)


def _starts(counts: NDArray) -> NDArray[np.int64]:
    starts = np.zeros(len(counts) + 1, dtype=np.int64)
    np.cumsum(counts, out=starts[1:])
    return starts
