"""The working state of an error-guided analysis: one level, collapsed in place."""

from __future__ import annotations

import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.half_edges import (
    HalfEdges,
    pack_faces,
    pack_vertices,
    renew_outgoing,
)
from .._kernels.surface_choice import (
    CANDIDATE,
    TAKEN,
    check_links,
    collapse_all,
    find_cheapest,
    measure_rings,
    record_rings,
    take_cheapest,
)
from .._kernels.surface_cost import LARGEST, LEAST_SQUARES, Limits, collapse_costs
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
from .._threads import centre_of, minus, rows_at
from .._validate import FloatArray, frozen
from ..mesh.half_edges import half_edges_of
from ..mesh.location import cover_of
from ..mesh.triangle_mesh import TriangleMesh
from ._level_figures import LevelFigures, changes_of, largest_of_faces, squared_of_faces
from ._level_state import FaceState, VertexState
from .outline import tolerant_outline
from .questions import Collapses, Sight

#: The costs of a level are limited by those of the cheapest vertices that it may take: by the
#: highest cost of this part of them, one sixteenth. From a half to one sixty-fourth the RMSE
#: changes by less than 1 % and the time from 0.92 to 1.10 (tables in docs/topics/surface.md).
CHEAPEST_PART = 16
#: The limit on costs is never below that of a height error of this part of the range of z, so that
#: cheapest costs that are rounding alone do not hold up all others. *Our choice*.
NEGLIGIBLE_ERROR = 1e-9
#: Differences of heights below this part of the largest height of the input are rounding: 64 times
#: the spacing of doubles there, for the few operations between a height and its error.
HEIGHT_STEP = 2.0**-46
#: Arrays are packed when no more than this share of them is in use: packing after each tenth of the
#: vertices is slower, and waiting until half have gone is no faster (docs/topics/surface.md).
PACKED_SHARE = 0.7
#: What the kernels call the norms of :data:`wavelet_core.partition.registry.NORMS`.
_NORM_CODES = {"rms": LEAST_SQUARES, "max": LARGEST}


class CollapseStep(NamedTuple):
    """One step of an error-guided analysis, in ids of the finer level.

    odd, target : (n_odd,) int32, the vertices that go, and onto which
    indptr, indices, weights : the prediction filter in CSR, columns in the order of those that stay
    details : (n_odd, n_channels) float64
    """

    odd: NDArray[np.int32]
    target: NDArray[np.int32]
    indptr: NDArray[np.int64]
    indices: NDArray[np.int32]
    weights: FloatArray
    details: FloatArray


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
    outline_tolerance : float
        How far input vertices of the outline may lie from it, in the unit of x and y; with 0 an
        outline vertex goes only where the outline runs straight.

    Raises
    ------
    MeshError
        The faces are no manifold.
    """

    #: Whether the removed vertices are kept, face by face, and the errors at them.
    keeps_points = True

    def __init__(
        self,
        plan: FloatArray,
        heights: FloatArray,
        faces: NDArray[np.int32],
        locked: NDArray[np.bool_],
        with_update: bool,
        outline_tolerance: float = 0.0,
    ) -> None:
        self._centre = centre = centre_of(plan)[0]
        # about a local origin also vertically, so that sums of squares keep their digits
        self._z_origin, extent = centre_of(heights)
        least_error = NEGLIGIBLE_ERROR * float(extent[0])
        self._least_limit = least_error * least_error  # inf where ** would overflow
        self._cost_limit = 0.0
        height_step = HEIGHT_STEP * float(max(heights.max(), -heights.min()))
        self._set_up(
            minus(plan, centre), minus(heights, self._z_origin), faces, locked, with_update,
            outline_tolerance, height_step,
        )  # fmt: skip

    def _set_up(
        self,
        plan: FloatArray,
        local: FloatArray,
        faces: NDArray[np.int32],
        locked: NDArray[np.bool_],
        with_update: bool,
        outline_tolerance: float,
        height_step: float,
    ) -> None:
        """Make the arrays; x, y and heights are from their local origins."""
        n_vertices, n_faces, n_channels = len(plan), len(faces), local.shape[1]
        self._mesh, n_fans = half_edges_of(faces, n_vertices)
        z = local.copy()
        self._surface = Surface(
            np.ascontiguousarray(plan[:, 0]),
            np.ascontiguousarray(plan[:, 1]),
            z,
            local if self.keeps_points else z,  # nobody measures
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
        self.n_vertices = n_vertices
        self._height_step = height_step
        self._vertices = VertexState.of_input(locked, locked | (n_fans != 1))
        self._faces = FaceState.of_input(n_faces, n_channels, with_errors=self.keeps_points)
        self._outline = tolerant_outline(
            outline_tolerance, self._surface.x, self._surface.y, self._mesh, n_fans
        )
        has_moments = with_update and self.keeps_points
        n_corners, n_stars = (3 * n_faces, n_vertices) if has_moments else (0, 0)
        self._moments = Moments(
            np.zeros((n_corners, n_channels), np.float32),
            np.zeros(n_corners, np.float32),
            np.zeros((n_stars, n_channels)),
            np.ones(n_stars),
        )
        self._with_update = with_update

    def begin_with(self, integrals: FloatArray) -> None:
        """Give the vertices of the input other integrals than 1."""
        self._vertices = self._vertices._replace(integrals=integrals.copy())

    def begin_with_points(self, plan: FloatArray, heights: FloatArray) -> None:
        """Let errors be measured at points of a finer input, too.

        Those at the place of a vertex say what height the input has there; those that no face
        covers are left out.

        Parameters
        ----------
        plan : ndarray, shape (n_points, 2)
        heights : ndarray, shape (n_points, n_channels)
            z and the weighted attributes.
        """
        surface = self._surface
        plan, heights = plan - self._centre, heights - self._z_origin
        places = np.column_stack([surface.x, surface.y])
        vertex = _rows_at(places, plan)
        is_vertex = vertex >= 0
        measured = surface.measured.copy()
        measured[vertex[is_vertex]] = heights[is_vertex]
        faces = self._mesh.origin.reshape(-1, 3)
        flat = TriangleMesh(np.column_stack([places, np.zeros(len(places))]), faces)
        plan, heights = plan[~is_vertex], heights[~is_vertex]
        cover = cover_of(flat, plan)
        order = np.argsort(cover.face, kind="stable")
        rows, face = cover.point[order], cover.face[order]
        counts = np.bincount(face, minlength=len(faces))
        self._surface = surface._replace(measured=measured)
        self._points = FacePoints(
            _starts(counts)[:-1].astype(np.int32),
            counts.astype(np.int32),
            np.ascontiguousarray(plan[rows, 0]),
            np.ascontiguousarray(plan[rows, 1]),
            np.ascontiguousarray(heights[rows]),
        )
        self._n_used = len(rows)
        self.n_input += len(rows)
        self._faces.changed[:] = True
        self._bring_sums_up_to_date()

    @property
    def ids(self) -> NDArray[np.int32]:
        """Ids, in the input, of the vertices of the level."""
        return self._vertices.ids[self._vertices.lives]

    @property
    def heights(self) -> FloatArray:
        """Present heights and weighted attributes, one row a vertex of the level."""
        return self._surface.z[self._vertices.lives] + self._z_origin

    @property
    def local_heights(self) -> FloatArray:
        """Heights and weighted attributes of the level's vertices, from their local origin."""
        return self._surface.z[self._vertices.lives]

    @property
    def integrals(self) -> FloatArray:
        """Integrals of the level's scaling functions."""
        return self._vertices.integrals[self._vertices.lives]

    @property
    def faces(self) -> NDArray[np.int32]:
        """Faces of the level, in places among its vertices."""
        position = np.cumsum(self._vertices.lives, dtype=np.int32) - np.int32(1)
        return position[self._mesh.origin.reshape(-1, 3)[self._faces.lives]]

    def sight(self) -> Sight:
        """Return what is known of the level before its step, which changes its arrays."""
        vertices = self._vertices
        return Sight(
            self._mesh,
            self._surface,
            self._outline,
            vertices.stays,
            vertices.locked,
            vertices.key,
            np.flatnonzero(vertices.lives).astype(np.int32),
            vertices.integrals,
            self._height_step,
        )

    def collapses(self, odd: NDArray[np.int32]) -> Collapses:
        """Return vertices that go, and onto which."""
        return Collapses(odd, self._vertices.target[odd])

    def costs(self, slots: NDArray[np.int32]) -> FloatArray:
        """Return the costs of vertices, as last ranked."""
        return self._vertices.cost[slots]

    def figures(self) -> LevelFigures:
        """Return sizes and errors of the level as it is now."""
        squared_changes, largest_change = changes_of(self._surface, self._vertices)
        return LevelFigures(
            self.n_vertices,
            int(np.count_nonzero(self._faces.lives)),
            self.n_input,
            squared_of_faces(self._faces) + float(squared_changes[0]),
            max(largest_of_faces(self._faces), largest_change),
            squared_changes,
        )

    def squared_errors(self) -> float:
        """Return the sum of the squared height errors of all input vertices."""
        squared_changes, _ = changes_of(self._surface, self._vertices)
        return squared_of_faces(self._faces) + float(squared_changes[0])

    def largest_error(self) -> float:
        """Return the largest height error of all input vertices."""
        return max(largest_of_faces(self._faces), changes_of(self._surface, self._vertices)[1])

    # -- which vertices go -----------------------------------------------------------------------

    def rank(self, norm: str, tolerance: float, cutoff: float) -> None:
        """Bring the costs up to date that may be at most ``cutoff``."""
        vertices = self._vertices
        may_matter = (vertices.cost <= cutoff) | (vertices.cost == np.inf)
        todo = np.flatnonzero(vertices.is_stale & vertices.lives & may_matter).astype(np.int32)
        limits = Limits(
            _NORM_CODES[norm],
            float(tolerance) * float(tolerance),
            float(cutoff),
            self._height_step,
        )
        run_in_ranges(
            collapse_costs, len(todo), todo, self._mesh, self._surface, self._points, self._moments,
            vertices, self._faces.squared, self._outline, limits,
        )  # fmt: skip

    def _known(self, cutoff: float) -> tuple[NDArray[np.int32], FloatArray]:
        """Return the slots that may go at no more than ``cutoff``, and their costs."""
        vertices = self._vertices
        is_known = vertices.lives & ~vertices.is_stale & (vertices.cost <= cutoff)
        slots = np.flatnonzero(is_known & np.isfinite(vertices.cost)).astype(np.int32)
        return slots, vertices.cost[slots]

    def free(self, cutoff: float) -> NDArray[np.int32]:
        """Return the slots of the vertices that may go at no cost but rounding."""
        slots, cost = self._known(cutoff)
        return slots[cost <= 0.0]

    def candidates(
        self,
        fraction: float,
        cutoff: float,
        cost_ratio: float = np.inf,
        besides_free: bool = False,
    ) -> NDArray[np.int32]:
        """Return the slots of the vertices that may be odd, the cheapest ones.

        They are ``fraction`` of the vertices at most, or all that cost nothing if those are more;
        with ``besides_free``, all that cost nothing and that share of the others. None of them
        costs more than ``cost_ratio`` times what the cheapest part of those
        (1 / CHEAPEST_PART) does, or than what a level before was allowed to take.
        """
        slots, cost = self._known(cutoff)
        n_free = int(np.count_nonzero(cost <= 0.0))
        if besides_free:
            n_most = n_free + max(int(fraction * (self.n_vertices - n_free)), 1)
        else:
            n_most = max(int(fraction * self.n_vertices), n_free, 1)
        n_cheapest = max(n_most // CHEAPEST_PART, 1)
        if len(slots) < n_cheapest:
            return slots
        places = [n_cheapest - 1, min(n_most, len(slots)) - 1]
        low, high = np.partition(cost, places)[places]
        if cost_ratio < np.inf:
            self._cost_limit = max(cost_ratio * low, self._least_limit, self._cost_limit)
            high = min(high, self._cost_limit)
        return slots[cost <= high]

    def independent(
        self, slots: NDArray[np.int32], max_odd: int, budget: float
    ) -> NDArray[np.int32]:
        """Return those candidates that go: no two of them neighbours, the cheaper one first.

        The set is the one that a single pass in order of cost would find; equal costs are kept
        apart by a number scattered over the vertices, so that flat terrain is not thinned in
        rows. At most ``max_odd`` go, whose costs sum to at most ``budget``.
        """
        cost, key = self._vertices.cost, self._vertices.key
        state = np.zeros(len(cost), dtype=np.int8)
        state[slots] = CANDIDATE
        active = slots
        while len(active):
            wins = np.empty(len(active), dtype=bool)
            arguments = (active, self._mesh, state, cost, key, wins)
            run_in_ranges(find_cheapest, len(active), *arguments)
            run_in_ranges(take_cheapest, len(active), active, wins, self._mesh, state)
            active = active[state[active] == CANDIDATE]
        odd = slots[state[slots] == TAKEN]
        if len(odd) <= max_odd and budget == np.inf:
            return odd
        odd = odd[np.lexsort((key[odd], cost[odd]))][:max_odd]
        spent = np.maximum.accumulate(np.cumsum(cost[odd]))
        n_affordable = np.searchsorted(spent, budget, side="right")
        return np.sort(odd[:n_affordable])

    def linked(self, odd: NDArray[np.int32]) -> NDArray[np.int32]:
        """Return those vertices whose collapse meets the link condition on the present mesh.

        The cost of the others was worked out before edges elsewhere came to join their rings; they
        are ranked anew. Whatever part of the result is removed, at least one vertex goes.
        """
        is_linked = np.empty(len(odd), dtype=bool)
        target = self._vertices.target[odd]
        run_in_ranges(check_links, len(odd), odd, target, self._mesh, is_linked)
        self._rank_anew(odd[~is_linked])
        return odd[is_linked]

    def has_collapse(self, norm: str) -> bool:
        """Return whether any vertex could go, whatever error it left; all are ranked anew."""
        self._rank_anew(np.flatnonzero(self._vertices.lives).astype(np.int32))
        self.rank(norm, np.inf, np.inf)
        return len(self._known(np.inf)[0]) > 0

    def _rank_anew(self, slots: NDArray[np.int32]) -> None:
        vertices = self._vertices
        vertices.cost[slots] = np.inf  # looked at whatever the cutoff
        vertices.is_stale[slots] = vertices.is_new[slots] = True

    # -- one step --------------------------------------------------------------------------------

    def remove(self, odd: NDArray[np.int32]) -> CollapseStep:
        """Collapse the odd vertices, predict, update; return the step, details as weighted."""
        step = self._remove(odd)
        self._pack()  # when the rings are no longer there
        return step

    def _remove(self, odd: NDArray[np.int32]) -> CollapseStep:
        odd, indptr, ring, ring_faces = self._collapse(odd)
        corners, weights, details = self._hand_over(odd, indptr, ring, ring_faces)
        vertices = self._vertices
        even_position = np.cumsum(vertices.lives, dtype=np.int32) - np.int32(1)
        fine = vertices.lives.copy()
        fine[odd] = True
        fine_position = np.cumsum(fine, dtype=np.int32) - np.int32(1)
        row_indptr, columns, row_weights = self._support(corners, weights, indptr, ring)
        self.n_vertices -= len(odd)
        if self._with_update:
            update_heights(
                odd, row_indptr, columns, row_weights, details, vertices.locked,
                vertices.integrals, self._surface.z, vertices.z_changed,
            )  # fmt: skip
        self._bring_sums_up_to_date()
        return CollapseStep(
            frozen(fine_position[odd]),
            frozen(fine_position[ring[indptr[:-1]]]),
            frozen(row_indptr),
            frozen(even_position[columns]),
            frozen(row_weights),
            details,
        )

    def _collapse(
        self, odd: NDArray[np.int32]
    ) -> tuple[NDArray[np.int32], NDArray[np.int64], NDArray[np.int32], NDArray[np.int32]]:
        """Collapse on the mesh; return the odd vertices that went and their rings in CSR."""
        vertices = self._vertices
        size = np.empty(len(odd), dtype=np.int64)
        run_in_ranges(measure_rings, len(odd), odd, self._mesh, size)
        indptr = _starts(size)
        ring = np.empty(indptr[-1], dtype=np.int32)
        ring_faces = np.empty(indptr[-1], dtype=np.int32)
        arguments = (odd, vertices.target[odd], self._mesh, indptr, ring, ring_faces)
        run_in_ranges(record_rings, len(odd), *arguments)
        goes = np.empty(len(odd), dtype=bool)
        collapse_all(
            odd, indptr, ring, ring_faces, self._mesh, vertices.lives, self._faces.lives, goes
        )
        renew_outgoing(self._mesh, self._faces.lives)
        if len(self._outline.lives):
            self._outline.lives[vertices.ids[odd[goes]]] = False
        if goes.all():
            return odd, indptr, ring, ring_faces
        self._rank_anew(odd[~goes])
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
            self._faces.changed, self._outline.squared_tolerance, corners, weights, details,
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
        stuck = np.flatnonzero(self._vertices.locked[corners].all(axis=1))
        if len(stuck) == 0:
            return row_indptr, columns, row_weights
        counts = np.full(n_odd, 3, dtype=np.int64)
        extra = []
        for row in stuck:
            around = ring[indptr[row] : indptr[row + 1]]
            extra.append(around[~self._vertices.locked[around]])
            counts[row] += len(extra[-1])
        where = np.repeat(3 * (stuck + 1), counts[stuck] - 3)
        columns = np.insert(columns, where, np.concatenate(extra))
        return _starts(counts), columns, np.insert(row_weights, where, 0.0)

    def _bring_sums_up_to_date(self) -> None:
        """Sum the errors anew where faces or heights changed; mark the costs that depend on it."""
        vertices, faces = self._vertices, self._faces
        run_in_ranges(
            sum_over_faces, len(faces.lives), self._mesh, self._surface, self._points, vertices,
            faces, self._moments,
        )  # fmt: skip
        vertices.z_changed[:] = False
        if self._with_update:
            run_in_ranges(
                sum_over_stars, len(vertices.ids), self._mesh, vertices.lives, vertices.has_moved,
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
        if self.n_vertices > PACKED_SHARE * len(self._vertices.ids):
            return
        vertices, faces = (
            np.flatnonzero(state.lives).astype(np.int32) for state in (self._vertices, self._faces)
        )
        position = np.full(len(self._vertices.ids), -1, dtype=np.int32)
        position[vertices] = np.arange(len(vertices), dtype=np.int32)
        face_position = np.full(len(self._faces.lives), -1, dtype=np.int32)
        face_position[faces] = np.arange(len(faces), dtype=np.int32)

        packed = HalfEdges(
            np.empty(3 * len(faces), dtype=np.int32),
            np.empty(3 * len(faces), dtype=np.int32),
            np.empty(len(vertices), dtype=np.int32),
        )
        run_in_ranges(pack_faces, len(faces), faces, position, face_position, self._mesh, packed)
        run_in_ranges(pack_vertices, len(vertices), vertices, face_position, self._mesh, packed)
        self._mesh = packed
        # one array after the other, so that hardly any is there twice at a time
        for state, names, places, n_rows in (
            ("_surface", Surface._fields, vertices, 1),
            ("_points", ("start", "n_points"), faces, 1),
            ("_vertices", VertexState._fields, vertices, 1),
            ("_faces", FaceState._fields, faces, 1),
            ("_moments", ("vertex_slope", "vertex_weight"), vertices, 1),
            ("_moments", ("slope", "weight"), faces, 3),
        ):
            for name in names:
                self._pack_array(state, name, places, n_rows)
        known = np.flatnonzero(self._vertices.target >= 0)
        self._vertices.target[known] = position[self._vertices.target[known]]
        if len(self._outline.ids):
            self._outline = self._outline._replace(ids=self._vertices.ids)

    def _pack_array(self, of: str, name: str, places: NDArray[np.int32], n_rows: int) -> None:
        """Keep those rows of an array that places have, ``n_rows`` side by side each."""
        state = getattr(self, of)
        array = getattr(state, name)
        if len(array):
            rows = rows_at(array.reshape(len(array) // n_rows, -1), places)
            setattr(self, of, state._replace(**{name: rows.reshape(-1, *array.shape[1:])}))

    def snapshot(self) -> SurfaceLevel:
        """Return a copy to go back to; points already in place are never overwritten."""
        twin = copy.copy(self)
        twin._vertices = self._vertices.copied()
        twin._faces = self._faces.copied()
        twin._outline = self._outline._replace(lives=self._outline.lives.copy())
        twin._mesh = HalfEdges(*(array.copy() for array in self._mesh))
        twin._moments = Moments._make(array.copy() for array in self._moments)
        twin._surface = self._surface._replace(z=self._surface.z.copy())
        twin._points = self._points._replace(
            start=self._points.start.copy(), n_points=self._points.n_points.copy()
        )
        return twin


def _rows_at(places: FloatArray, plan: FloatArray) -> NDArray[np.int64]:
    """Return the row of the place that each position is, to the bit; -1 for none."""
    keys, wanted = (np.ascontiguousarray(array).view("c16").ravel() for array in (places, plan))
    order = np.argsort(keys, kind="stable")
    at = np.minimum(np.searchsorted(keys[order], wanted), len(keys) - 1)
    rows = order[at]
    rows[keys[rows] != wanted] = -1
    return rows


def _starts(counts: NDArray) -> NDArray[np.int64]:
    starts = np.zeros(len(counts) + 1, dtype=np.int64)
    np.cumsum(counts, out=starts[1:])
    return starts
