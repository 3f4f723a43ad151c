"""Refined TINs: better places, edges and heights for the vertices of a coarse TIN."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._kernels._jit import fitting_engine
from .._kernels.refine_tin import Objective
from .._validate import FloatArray, IntArray, as_locked
from ..accuracy.fitted_heights import fitted
from ..errors import MeshError, OptionError
from ..lifting.options import checked_weights
from ..lifting.signal import height_weights
from ..mesh.location import Cover, cover_of, surface_errors
from ..mesh.triangle_mesh import TriangleMesh
from ..partition.registry import NORMS
from ..progress import Progress, report
from ._checks import checked_ids, checked_limits, require_sense, strictness
from ._tin_state import TinState

#: Where vertices are taken out, rounds end with the first one that does so with less than this
#: part of them.
LEAST_GAIN = 0.005
#: A vertex may move by so many mean distances of input points in one round. Half of it and twice as
#: much change the RMSE at 2 % by 2 % at most on two DEMs, and vertices within a tolerance by 1 %.
REACH = 3.0
#: A vertex is replaced while that costs less than this many times what its new place gains. Both
#: are reckoned with all others as they are, which takes the cost for too high and the gain for too
#: low: moves and flips then improve both. 4 and 16 change the RMSE by 0.2 % at most on two DEMs.
REPLACED_RATIO = 8.0
#: Passes of flips before and after the vertices move. On three DEMs 1, 2 and 8 change the RMSE at
#: 2 %, and the vertices within a tolerance, by less than 1 %, either way.
FLIP_PASSES = 4
#: Steps in which a TIN goes down to a number of vertices, with moves and flips before and between.
SHRINKS = 3
#: Passes that thin the TIN in one round. 2 leave 0.1 to 0.5 % more vertices, 12 as many.
THIN_PASSES = 6


class _Effort(NamedTuple):
    """How far a refinement goes, where the number of rounds is not given.

    max_rounds : int
    least_gain : float, the rounds end with the first that lowers the error by less than this part
    n_trials : int, places of a vertex that are tried at all points of its star in a round
    replaced_share : float, of the vertices, that are replaced in a round at most
    """

    max_rounds: int
    least_gain: float
    n_trials: int
    replaced_share: float


#: Twice the least gain ends a round or two earlier, 0.3 to 1.2 % worse, on two DEMs; half of it
#: goes on for one more at most. A single trial leaves 0.8 to 1.4 % more RMSE at 2 % and 0.9 to
#: 2.3 % more vertices within a tolerance; 6 leave 0.1 to 2.2 % fewer for a quarter more time. Half
#: the share and twice as much change the RMSE by 0.4 % at most.
ORDINARY = _Effort(8, 0.005, 3, 0.1)
#: Of a coarse TIN at a given size, for which the analysis took longer and a round takes less: at
#: 2 % it lowers the RMSE by another 0.7 to 1.4 % on parts of two DEMs and on three clouds, and the
#: refinement takes about twice as long.
THOROUGH = _Effort(10, 0.001, 8, 0.3)
#: A TIN is coarse with at most this part of the input's points.
COARSE = 0.05


class Round(NamedTuple):
    """What the TIN is like after a round.

    n_vertices : int
    rmse, max_error : float, of z, over the input points that the TIN covers, or has by themselves
    n_moved, n_flipped, n_replaced, n_removed : int, vertices and edges that changed in it
    """

    n_vertices: int
    rmse: float
    max_error: float
    n_moved: int = 0
    n_flipped: int = 0
    n_replaced: int = 0
    n_removed: int = 0


class Refinement(NamedTuple):
    """A refined TIN.

    mesh : TriangleMesh
    vertex_ids : (n_vertices,) int64, the input vertices that its vertices lie on, ascending
    rounds : tuple of Round, the TIN as given first, after the fit of its heights last
    cover : Cover, where the input vertices lie on it
    """

    mesh: TriangleMesh
    vertex_ids: IntArray
    rounds: tuple[Round, ...]
    cover: Cover


def refine(
    mesh: TriangleMesh,
    original: TriangleMesh,
    vertex_ids: ArrayLike,
    *,
    norm: str = "rms",
    rounds: int | None = None,
    keep_points: bool = False,
    max_error: ArrayLike | None = None,
    max_rms: float | None = None,
    target_vertices: int | None = None,
    attribute_weights: Sequence[float] | None = None,
    locked: ArrayLike | None = None,
    cover: Cover | None = None,
    progress: Progress | None = None,
) -> Refinement:
    """Return a coarse TIN with its vertices, edges and heights where they serve best.

    Parameters
    ----------
    mesh : TriangleMesh
        A coarse TIN whose vertices lie on vertices of ``original``, such as ``pyramid.mesh(0)``.
    original : TriangleMesh
        What it stands for, with the same attributes; only its vertices count.
    vertex_ids : array_like of int, shape (n_vertices,)
        Which of them the vertices of ``mesh`` lie on, such as ``pyramid.vertex_ids(0)``.
    norm : {"rms", "max"}
        Keep the sum of squared errors small, with heights fitted to all input vertices; or the
        largest error, with the heights of the input.
    rounds : int, optional
        How many; by default until one of them lowers the error by less than half a per cent, and
        at most 8; of a TIN with at most a twentieth of the input's points, until one lowers it by
        less than a thousandth, and at most 10.
    keep_points : bool
        With ``"rms"``, too, each vertex is an input vertex, height and all.
    max_error : float or array_like, shape (n_original,), optional
        With ``"max"``: take out vertices while no input vertex is farther off than this,
        vertically; one distance for all, or one for each. The mesh has to keep that already.
    max_rms : float, optional
        With ``"rms"``: take out vertices while the root mean square error is at most this.
    target_vertices : int, optional
        With ``"rms"``: take out vertices until so many are left, or none can go any more, in two
        rounds after one of the whole; further rounds follow. A TIN of up to twice as many leads to
        less error than one of just as many.
    attribute_weights : sequence of float, optional
        As for `wavelet_core.analyse`.
    locked : array_like of bool, shape (n_vertices,), optional
        Vertices of ``mesh`` that stay as they are. Edges between two of them stay, too.
    cover : Cover, optional
        What `cover_of` gives for the original's vertices on the mesh, where it is known already.
    progress : callable, optional
        Called with a fraction in [0, 1] between the passes; the work stops when it returns False.

    Returns
    -------
    Refinement
        A valid TIN that covers what the given one covers. Outlines keep their place; along a
        straight one vertices move from input vertex to input vertex.

    Raises
    ------
    OptionError
        Options that contradict each other, or arrays of the wrong size.
    MeshError
        A face that is flipped or flat in plan.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    A round (a) replaces vertices: the one that helps least is collapsed, half-edge by half-edge
    collapse, and a point in a face of large errors becomes a vertex instead ("bad point
    replacement", [1]_); (b) turns edges that lie better across their quadrangle ("data-dependent
    triangulation", [2]_); (c) moves each vertex onto the best input vertex near it, whose height
    has a closed form, and (d) turns edges again. At the end all heights are fitted at once. Each is
    judged by all input vertices in the faces that it changes. With ``"max"`` they are judged by
    the sum of the eighth powers of the errors, *our choice*: the largest ones count for nearly all
    of it, and yet each that falls helps.

    With a tolerance a round takes vertices out instead of (a). Within ``max_error`` these are all
    whose half-edge collapse keeps it, then all whose star keeps it under the best of its
    triangulations, found by dynamic programming [3]_; then edges shrink to one vertex on the input
    vertex that serves best, *our choice*: two vertices go and one comes. What is small is the
    squares in one round and the eighth powers in the next: errors that are small in most places
    leave more room for removals than errors that are alike, and each finds what the other one
    left (1 to 2 % fewer vertices than the squares alone).

    References
    ----------
    .. [1] M. D. Adams, "A flexible content-adaptive mesh-generation strategy for image
       representation", IEEE Transactions on Image Processing 20(9), 2011.
    .. [2] N. Dyn, D. Levin, S. Rippa, "Data dependent triangulations for piecewise linear
       interpolation", IMA Journal of Numerical Analysis 10(1), 1990.
    .. [3] G. T. Klincsek, "Minimal triangulations of polygonal domains", Annals of Discrete
       Mathematics 9, 1980.
    """
    ids = checked_ids(vertex_ids, mesh, original)
    limits = checked_limits(max_error, original)
    norm = NORMS.find(norm).name
    least = None if limits is None else float(limits.min())
    require_sense(norm, rounds, least, max_rms, target_vertices)
    if mesh.attribute_names != original.attribute_names:
        raise OptionError(
            "{0} has the attributes {of_mesh}, {1} {of_original}; refine a level of its own "
            "pyramid.",
            "mesh",
            "original",
            of_mesh=mesh.attribute_names,
            of_original=original.attribute_names,
        )
    fixed = as_locked(locked, mesh.n_vertices)
    areas = mesh.plan_areas
    if len(areas) and areas.min() <= 0:
        face = int(np.argmin(areas))
        raise MeshError(f"face {face} is flipped or flat in plan; only a TIN can be refined.", face)
    cover = cover_of(mesh, original.vertices[:, :2]) if cover is None else cover
    task = _Task(
        mesh, original, ids, fixed, cover, norm == "max", norm == "rms" and not keep_points,
        limits, max_rms, target_vertices, attribute_weights, float(areas.sum()),
    )  # fmt: skip
    with fitting_engine(original.n_vertices):
        work = _Work(task, progress)
        if limits is None and max_rms is None:
            work.shrink(rounds)
            work.run(rounds)
        else:
            work.thin(rounds)
        return work.result()


class _Task(NamedTuple):
    """What is asked for, checked; see `refine`."""

    mesh: TriangleMesh
    original: TriangleMesh
    ids: IntArray
    locked: NDArray[np.bool_]
    cover: Cover
    is_largest: bool
    is_free: bool
    limits: FloatArray | None
    max_rms: float | None
    target_vertices: int | None
    attribute_weights: Sequence[float] | None
    plan_area: float


class _Work:
    """The rounds, and what the TIN was like after each."""

    def __init__(self, task: _Task, progress: Progress | None) -> None:
        original, mesh, ids, cover = task.original, task.mesh, task.ids, task.cover
        self._task, self._progress = task, progress
        self._measured = np.hstack([original.vertices[:, 2:], original.attributes])
        self._given = np.hstack([mesh.vertices[:, 2:], mesh.attributes])
        heights = self._given
        if not task.is_free:
            heights = np.where(task.locked[:, None], heights, self._measured[ids])
        scale, tolerance = self._scale_of(task)
        weights = checked_weights(task.attribute_weights, original.attributes.shape[1])
        extent = np.ptp(self._measured, axis=0)
        self._weights = height_weights(extent, weights) / scale
        self._n_points = max(len(cover.point), 1)
        # A vertex by itself stays as it is: an input point without an error.
        self._n_lone = len(ids) - len(np.unique(mesh.faces))
        face_of = np.full(original.n_vertices, -1, dtype=np.int64)
        face_of[cover.point] = cover.face
        step = np.sqrt(task.plan_area / self._n_points)
        is_within = task.limits is not None or task.max_rms is not None
        n_left = len(ids) if task.target_vertices is None else task.target_vertices
        is_coarse = n_left <= COARSE * self._n_points
        self._effort = THOROUGH if is_coarse and not is_within else ORDINARY
        self._state = TinState(
            original.vertices[:, :2] - original.vertices[:, :2].min(axis=0),
            self._measured * self._weights,
            heights * self._weights,
            mesh.faces.astype(np.int32),
            ids,
            face_of,
            task.locked,
            Objective(
                task.is_largest
                and task.limits is None,  # within a tolerance, in every second round
                task.is_free,
                tolerance,
                float(REACH * step) ** 2,
                self._effort.n_trials,
            ),
            strictness(task.limits, scale),
        )
        self._error = np.inf
        self._n_before = 0  # rounds before those of `run`
        self.rounds: list[Round] = []
        self._note()

    @staticmethod
    def _scale_of(task: _Task) -> tuple[float, float]:
        """Return the unit in which eighth powers are taken, and the legal squared error in it."""
        if task.limits is not None:
            largest = float(np.max(task.limits, initial=0.0, where=np.isfinite(task.limits)))
            return largest or 1.0, 1.0
        if not task.is_largest:
            return 1.0, np.inf
        errors = surface_errors(task.mesh, task.original.vertices, task.cover)
        return float(np.nanmax(np.abs(errors), initial=0.0)) or 1.0, np.inf

    # -- rounds ----------------------------------------------------------------------------------

    def shrink(self, n_rounds: int | None) -> None:
        """Take out vertices until there are as many as are asked for, with rounds in between."""
        target, n_vertices = self._task.target_vertices, self._state.n_vertices
        if target is None or target >= n_vertices:
            return
        n_after = self._effort.max_rounds if n_rounds is None else n_rounds
        least, objective = target / n_vertices, self._state.objective
        self._state.objective = objective._replace(n_trials=ORDINARY.n_trials)
        for step in range(SHRINKS + 1):
            left = round(n_vertices * least ** (step / SHRINKS))
            n_removed = self._state.shrink_to(left)
            self._improve(step, SHRINKS + 1 + n_after, n_removed=n_removed)
        self._state.objective = objective
        self._n_before = SHRINKS + 1

    def run(self, n_rounds: int | None) -> None:
        """Lower the error with as many vertices."""
        most = self._effort.max_rounds if n_rounds is None else n_rounds
        least = self._effort.least_gain if n_rounds is None else 0.0
        settles = False  # the last round replaces nothing
        share = max(int(self._effort.replaced_share * self._state.n_vertices), 1)
        for number in range(most):
            here = self._n_before + number
            before, state = self._error, self._state.snapshot()
            is_last = settles or (number > 0 and number == most - 1)
            n_replaced = 0
            if self._task.is_largest:
                largest = self.rounds[-1].max_error * self._weights[0]
                self._state.objective = self._state.objective._replace(
                    tolerance=float(largest) ** 2
                )
            if here > 0 and not is_last:
                n_replaced = self._state.replace(share, REPLACED_RATIO)
            self._improve(here, self._n_before + most, n_replaced=n_replaced)
            has_risen = self._error > before
            settles = self._lowered(before) <= least
            if has_risen:
                self._state, self._error = state, before
                self.rounds.pop()
            if is_last or (has_risen and n_replaced == 0):
                break

    def thin(self, n_rounds: int | None) -> None:
        """Lower the number of vertices within a tolerance."""
        most = self._effort.max_rounds if n_rounds is None else n_rounds
        least = LEAST_GAIN if n_rounds is None else 0.0
        for number in range(most):
            before = self._state.n_vertices
            n_removed = self._thin(number, most) if number > 0 else 0
            state = self._state.snapshot()
            self._improve(number, most, n_removed=n_removed)
            if self._budget() < 0:  # where other channels gained what z lost
                self._state = state
                self.rounds.pop()
                self._note(0, 0, 0, n_removed)
                break
            if number > 0 and n_removed <= least * before:
                break

    def _thin(self, number: int, most: int) -> int:
        """Take out what the tolerance allows; return how many vertices that were."""
        n_removed = self._collapse(self._part(number, 0.1, most))
        if self._task.limits is not None:
            n_removed += self._state.thin_by_polygons()
            self._report((number + 0.15) / (most + 1))
            n_removed += self._state.merge()
        return n_removed

    def _collapse(self, tell: Callable[[float], None]) -> int:
        """Take out what collapses onto a neighbour; return how many vertices that were."""
        n_removed = 0
        for number in range(THIN_PASSES):
            tell(number / THIN_PASSES)
            budget, state = self._budget(), self._state.snapshot()
            n_here = self._state.thin(budget) if budget > 0 else 0
            if self._budget() < 0:  # where other channels gained what z lost
                self._state = state
                break
            n_removed += n_here
            if n_here <= LEAST_GAIN * self._state.n_vertices:
                break
        return n_removed

    def _budget(self) -> float:
        """Return what the sum of the squared errors of z may still grow by."""
        if self._task.max_rms is None:
            return np.inf
        squared = float(self._state.face_errors().squared_z.sum())
        most = self._task.max_rms * self._task.max_rms  # inf where ** would overflow
        return most * (self._n_points + self._n_lone) - squared

    def _improve(self, number: int, most: int, n_replaced: int = 0, n_removed: int = 0) -> None:
        """Turn edges, move vertices, turn edges; note what the TIN is like."""
        if self._task.limits is not None:  # each kind of errors lets go what the other one held
            self._judge_by_powers(number % 2 == 1)
        n_flipped = self._state.flip(FLIP_PASSES, self._part(number + 0.2, 0.15, most))
        n_moved = self._state.relocate(self._part(number + 0.35, 0.5, most))
        n_flipped += self._state.flip(FLIP_PASSES, self._part(number + 0.85, 0.15, most))
        if self._task.limits is not None:
            self._judge_by_powers(False)
        self._note(n_moved, n_flipped, n_replaced, n_removed)
        self._report((number + 1.0) / (most + 1))

    def _judge_by_powers(self, is_power: bool) -> None:
        self._state.objective = self._state.objective._replace(is_power=is_power)

    def _note(self, *changes: int) -> None:
        errors = self._state.face_errors()
        scale = self._weights[0]
        self._error = float(errors.error.sum())
        self.rounds.append(
            Round(
                self._state.n_vertices,
                float(np.sqrt(errors.squared_z.sum() / (self._n_points + self._n_lone)) / scale),
                float(np.sqrt(errors.largest.max(initial=0.0)) / scale),
                *changes,
            )
        )

    def _lowered(self, before: float) -> float:
        """Return by what part the error has fallen, as a mean of errors, not of their powers."""
        if before == 0.0:
            return 0.0
        return float(1.0 - (self._error / before) ** (1.0 / (8 if self._task.is_largest else 2)))

    def _part(self, start: float, length: float, most: int) -> Callable[[float], None]:
        """Return what reports a part of a round, in rounds."""
        return lambda share: self._report((start + length * share) / (most + 1))

    def _report(self, fraction: float) -> None:
        report(self._progress, fraction, "the refinement was cancelled; nothing was kept.")

    # -- what came out ---------------------------------------------------------------------------

    def result(self) -> Refinement:
        """Return the TIN, its heights fitted where they are free."""
        task = self._task
        slots, kept, faces = self._state.faces()
        ids = self._state.tin.point[slots].astype(np.int64)
        locked = task.locked[slots]
        heights = self._state.tin.z[slots] / self._weights
        if not task.is_free:
            heights = self._measured[ids]
        heights = np.where(locked[:, None], self._given[slots], heights)
        vertices = np.column_stack([task.original.vertices[ids, :2], heights[:, 0]])
        mesh = TriangleMesh._trusted(
            vertices, faces, np.ascontiguousarray(heights[:, 1:]), task.mesh.attribute_names
        )
        cover = _cover(mesh, task.original, *self._state.listed_points(kept))
        if task.is_free:
            mesh = fitted(mesh, task.original, locked, cover)
            errors = np.abs(surface_errors(mesh, task.original.vertices, cover)[cover.point])
            rmse = float(np.sqrt((errors**2).sum() / max(len(errors) + self._n_lone, 1)))
            largest = float(errors.max(initial=0.0))
            self.rounds.append(Round(mesh.n_vertices, rmse, largest))
        return Refinement(mesh, ids, tuple(self.rounds), cover)


def _cover(mesh: TriangleMesh, original: TriangleMesh, point: IntArray, face: IntArray) -> Cover:
    """Return where in their faces the points lie, in the order of the points."""
    order = np.argsort(point, kind="stable")
    point, face = point[order], face[order]
    a, b, c = (mesh.vertices[corner, :2] for corner in mesh.faces[face].T)
    to_b, to_c, to_p = b - a, c - a, original.vertices[point, :2] - a
    area = to_b[:, 0] * to_c[:, 1] - to_b[:, 1] * to_c[:, 0]
    at_b = (to_p[:, 0] * to_c[:, 1] - to_p[:, 1] * to_c[:, 0]) / area
    at_c = (to_b[:, 0] * to_p[:, 1] - to_b[:, 1] * to_p[:, 0]) / area
    return Cover(point, face, at_b, at_c)
