"""From a mesh to its pyramid: cost, partition, remesh, predict, update (Algorithm 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._kernels._jit import announce_engine, fitting_engine
from .._validate import FloatArray, as_locked, frozen
from ..errors import MeshError, OptionError
from ..mesh.collapse import even_positions, merge_map, merged_faces
from ..mesh.connectivity import build_connectivity
from ..mesh.location import surface_errors
from ..mesh.triangle_mesh import TriangleMesh
from ..partition._level_figures import LevelFigures
from ..partition.error_guided import DEFAULT_LEVELS, SurfaceRules, analyse_surface
from ..partition.orderings import LevelView, Partition
from ..partition.registry import PARTITIONS, PartitionInput
from ..partition.stopping import stop_record
from ..progress import Progress, report, watched
from .options import AnalysisOptions, resolve_options
from .prediction import Removal, predict
from .pyramid import Pyramid, PyramidPart
from .recorded import Recorder
from .signal import SIGNALS, Normalisation
from .step import Step, analyse_level

#: Share of the vertices that one level is expected to keep, for the progress bar alone.
EXPECTED_KEPT = 0.73
#: Shares of the time of a level, for the progress bar alone: one-rings, and choosing what goes.
OF_CONNECTIVITY, OF_SPLIT = 0.15, 0.65


def analyse(
    mesh: TriangleMesh,
    *,
    levels: int | None = None,
    partition: str | None = None,
    prediction: str | None = None,
    update: str | None = None,
    signal: str = "z",
    locked: ArrayLike | None = None,
    target_vertices: int | None = None,
    max_error: float | None = None,
    max_rms: float | None = None,
    progress: Progress | None = None,
    attribute_weights: Sequence[float] | None = None,
    bending_weight: float | None = None,
    quadrics: str | None = None,
    cost: str | None = None,
    seed: int | None = None,
    norm: str | None = None,
    removal_fraction: float | None = None,
    outline_tolerance: float = 0.0,
    integrals: ArrayLike | None = None,
    points: ArrayLike | None = None,
    record: bool = False,
) -> Pyramid:
    """Return the reversible wavelet pyramid of a mesh (Algorithm 3).

    Parameters
    ----------
    mesh : TriangleMesh
        A manifold surface, with or without outline and holes.
    levels : int, optional
        The most levels to build. By default as many as another stop rule takes; without one, 12
        with a partition of the paper, and with ``partition="surface"`` 24 after those that thin
        flat parts alone, which cost nothing.
    partition : {"surface", "quadric", "colouring", "random"}, optional
        Which vertices go: those that raise the vertical errors at all input vertices least; by
        the paper's cost; or regardless of any, in the order of their index or a random one. By
        default ``"surface"``; with a prediction of the paper or ``signal="xyz"``, the paper's
        ``"quadric"``.
    prediction : str, optional
        How an odd vertex is estimated from its neighbours: ``"uniform"``, ``"cotangent"``,
        ``"geometric"``, ``"nnls"``, ``"least_squares"``, ``"barycentric"`` or ``"plane"``; by
        default ``"barycentric"`` with ``partition="surface"``, else ``"geometric"``. The paper's
        short names (``"GL"``) and joined designs (``"GLMN"``) are accepted, in capitals or not.
    update : {"minimum_norm", "martinez_ortega", "one_ring_mean", "none"}, optional
        How the details are handed on to the even vertices. By default ``"minimum_norm"``; with
        ``partition="surface"`` and ``norm="max"`` it is ``"none"``.
    signal : {"z", "xyz"}
        Lift elevation and attributes and keep x and y (every level is a valid TIN), or lift all
        coordinates, as the paper does (a coarse level may then have faces flipped in plan).
    locked : array_like of bool, shape (n_vertices,), optional
        Vertices that are never removed and never changed.
    target_vertices : int, optional
        Stop at this number of vertices; the last level removes only what is still due.
    max_error, max_rms : float, optional
        Largest or root mean square vertical distance from all input vertices, in the unit of z,
        that the coarsest level may have; with ``partition="surface"`` it is used up as far as
        whole removals allow, with the others the analysis stops before the level that breaks it.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    attribute_weights : sequence of float, optional
        Weight of each attribute, against the coordinates, in cost and prediction; 1 by default.
    bending_weight : float, optional
        Weight of the bending energy in the cost of ``partition="quadric"``; by default 1.
    quadrics : {"redistributed", "rebuilt"}, optional
        With ``partition="quadric"``: built on the input and handed on from level to level, as the
        paper says (Eqs. 52-53), the default; or built anew on every level.
    cost : {"ring", "collapse"}, optional
        With ``partition="quadric"``: the sum over the quadrics of all neighbours (Eq. 36), the
        default; or the least of them, that of the collapse which is made.
    seed : int, optional
        Of the order of ``partition="random"``; by default 0.
    norm : {"rms", "max"}, optional
        What ``partition="surface"`` keeps small: the mean square of the vertical errors, or the
        largest. By default ``"max"`` if ``max_error`` is given, else ``"rms"``.
    removal_fraction : float, optional
        Largest share of the vertices that a level of ``partition="surface"`` may take, besides
        those that cost nothing; by default 0.25, and 0.1 for ``norm="max"`` with
        ``target_vertices``. Twice that share while more than twice ``target_vertices`` are left.
    outline_tolerance : float
        How far from the outline of each level, holes included, the vertices of the input's outline
        may lie, in the unit of x and y, with ``partition="surface"`` and its own filters. With 0 an
        outline vertex goes only where the outline runs straight. Input vertices that a level does
        not cover any more count with their error at the nearest place of its outline.
    integrals : array_like, shape (n_vertices,), optional
        Of the scaling functions at the vertices, where the mesh is itself a level of a pyramid, or
        of several side by side; by default 1, as of an input. The pyramid keeps them
        (`Pyramid.part`), so that their sum with the coefficients stays what it was.
    points : array_like, shape (n_points, 3 + n_attributes), optional
        x, y, z and attributes of points of a finer input, of which the mesh is a level, with
        ``partition="surface"`` and its own filters. Vertices then go by the errors at these, too,
        as if the levels from the input to the mesh had been made in the same analysis.
    record : bool
        Keep the record by which a file describes the pyramid (:attr:`Pyramid.kept_record`), which
        takes half as much time again and is otherwise worked out when the file is written. Only
        ``partition="surface"`` with its own filters has one.

    Returns
    -------
    Pyramid
        With as many levels as the rules allow; none where no vertex can be removed.

    Raises
    ------
    MeshError
        The mesh has no vertices or is no manifold, or, with ``signal="z"``, it has a face that is
        not counter-clockwise in plan.
    OptionError
        A value out of bounds, a name that is not listed above, or options that contradict each
        other: an option of another partition, an update beside a joined design, ``"plane"`` with
        ``"martinez_ortega"``.
    Cancelled
        ``progress`` returned False.

    Warns
    -----
    UnstableDesignWarning
        ``"least_squares"`` with ``"martinez_ortega"``, the paper's unstable baseline.

    Notes
    -----
    For cost and prediction the columns are centred and divided by their range. The result is the
    same, to the byte, for any number of threads.

    Examples
    --------
    >>> from wavelet_core import analyse, synthetic
    >>> pyramid = analyse(synthetic.hills(20, 30), levels=3)
    >>> pyramid.n_levels
    3
    """
    options = resolve_options(
        n_attributes=mesh.attributes.shape[1],
        levels=levels,
        partition=partition,
        prediction=prediction,
        update=update,
        signal=signal,
        target_vertices=target_vertices,
        max_error=max_error,
        max_rms=max_rms,
        attribute_weights=attribute_weights,
        bending_weight=bending_weight,
        quadrics=quadrics,
        cost=cost,
        seed=seed,
        norm=norm,
        removal_fraction=removal_fraction,
        outline_tolerance=outline_tolerance,
    )
    if mesh.n_vertices == 0:
        raise MeshError("the mesh has no vertices; there is nothing to analyse.")
    announce_engine(mesh.n_vertices)
    with fitting_engine(mesh.n_vertices):
        return _Analysis(
            mesh,
            options,
            as_locked(locked, mesh.n_vertices),
            progress,
            _begun_integrals(integrals, mesh),
            _finer_points(points, mesh, options),
            record,
        ).run()


class _Analysis:
    """The state that one analysis carries from level to level."""

    def __init__(
        self,
        mesh: TriangleMesh,
        options: AnalysisOptions,
        locked: NDArray[np.bool_],
        progress: Progress | None,
        integrals: FloatArray | None,
        points: FloatArray | None,
        is_recorded: bool,
    ) -> None:
        self._mesh = mesh
        self._options = options
        self._progress = progress
        self._in_plan = SIGNALS[options.signal].keeps_plan
        self._partition_row = PARTITIONS[options.partition]
        if self._in_plan or self._partition_row.needs_upright:
            _require_upright(mesh)
        self._all_locked = locked
        self._faces = mesh.faces.astype(np.int32)
        columns = [mesh.vertices[:, 2:] if self._in_plan else mesh.vertices, mesh.attributes]
        self._coefficients = np.ascontiguousarray(np.hstack(columns))
        self._horizontal = mesh.vertices[:, :2] if self._in_plan else None
        self._locked = locked
        self._begun = integrals
        self._points = points
        self._integrals = np.ones(mesh.n_vertices) if integrals is None else integrals
        self._figures: tuple[LevelFigures, ...] | None = None
        self._coarse_faces: NDArray[np.int32] | None = None
        self._scale = Normalisation(mesh, options.attribute_weights)
        self._share_of_step = self._reported = 0.0
        self._recorder: Recorder | None = None
        if is_recorded and options.is_error_guided and integrals is None:
            self._recorder = Recorder(mesh, locked, options.update, options.as_dict())

    def run(self) -> Pyramid:
        """Take steps until a rule says stop."""
        self._report(0.0)
        steps = self._surface_steps() if self._is_surface_lifting() else self._steps()
        self._report(1.0)
        pyramid = Pyramid(
            faces=frozen(self._mesh.faces.astype(np.int32)),
            horizontal=None if not self._in_plan else frozen(self._mesh.vertices[:, :2]),
            coarse=frozen(self._coefficients),
            steps=tuple(reversed(steps)),
            channels=SIGNALS[self._options.signal].coordinates + self._mesh.attribute_names,
            signal=self._options.signal,  # type: ignore[arg-type]
            update=self._options.update,
            locked=frozen(self._all_locked) if self._all_locked.any() else None,
            parameters=self._options.as_dict(),
            measured=self._figures,
            coarse_faces=self._coarse_faces,
            part=None
            if self._begun is None
            else PyramidPart(np.arange(self._mesh.n_vertices, dtype=np.int32), frozen(self._begun)),
        )
        stop = stop_record(
            self._stopped_by,
            pyramid._faces_of(0),
            self._all_locked[pyramid.vertex_ids(0)],
            self._options.target_vertices,
        )
        pyramid = replace(pyramid, stop=stop)
        if self._recorder is None:
            return pyramid
        return replace(pyramid, kept_record=self._recorder.kept(pyramid.steps, pyramid.coarse))

    def _steps(self) -> list[Step]:
        """Partition, predict and update, each by its own rule."""
        self._partition = self._make_partition()
        steps: list[Step] = []
        most = self._most_levels()
        self._stopped_by = "levels"
        while len(steps) < most:
            step = self._step()
            if step is None:
                break
            steps.append(step)
        return steps

    def _most_levels(self) -> int:
        """Return the number of levels, as far as it is known beforehand."""
        levels = self._options.levels
        return DEFAULT_LEVELS if levels is None else levels

    def _is_surface_lifting(self) -> bool:
        """Whether `analyse_surface` carries out partition and filters as one."""
        return self._options.is_error_guided

    def _surface_steps(self) -> list[Step]:
        """Partition, predict and update in one; see `analyse_surface`."""
        options = self._options
        rules = SurfaceRules(
            levels=options.levels,
            norm=options.norm,
            with_update=options.update == "minimum_norm",
            removal_fraction=options.removal_fraction,
            target_vertices=options.target_vertices or 0,
            max_error=np.inf if options.max_error is None else options.max_error,
            max_rms=np.inf if options.max_rms is None else options.max_rms,
            outline_tolerance=options.outline_tolerance,
        )
        result = analyse_surface(
            self._mesh.vertices[:, :2],
            self._coefficients,
            self._release_faces(),
            self._locked,
            self._scale.height_weights(),
            rules,
            self._report_size,
            self._begun,
            self._points,
            self._recorder,
        )
        self._coefficients = result.coarse
        self._stopped_by = result.stopped_by
        self._figures = self._in_input_units(result.figures)
        self._coarse_faces = frozen(result.faces)
        return [Step(*step) for step in result.steps]

    def _release_faces(self) -> NDArray[np.int32]:
        """Return the faces and keep them no longer: they take a twentieth of the memory."""
        faces, self._faces = self._faces, np.empty((0, 3), dtype=np.int32)
        return faces

    def _in_input_units(self, figures: list[LevelFigures]) -> tuple[LevelFigures, ...] | None:
        """Return the figures of the levels, the coarsest first; None where they are not those.

        With a tolerance of the outline, input vertices that no face covers count in the analysis.
        """
        if self._options.outline_tolerance:
            return None
        squares = self._scale.height_weights() ** 2
        return tuple(
            level._replace(squared_changes=level.squared_changes / squares)
            for level in reversed(figures)
        )

    def _make_partition(self) -> Partition:
        columns = np.hstack([self._mesh.vertices[:, 2:], self._mesh.attributes])
        return self._partition_row.make(
            PartitionInput(
                plan=self._mesh.vertices[:, :2],
                heights=columns * self._scale.height_weights(),
                faces=self._faces,
                locked=self._locked,
                options=self._options.of_partition(),
            )
        )

    def _step(self) -> Step | None:
        """Analyse one level; None, and the level unchanged, where a rule forbids it."""
        n_vertices = len(self._coefficients)
        max_odd = n_vertices - (self._options.target_vertices or 0)
        if max_odd <= 0:
            self._stopped_by = "target"
            return None
        with watched(lambda share: self._report_step(share * OF_CONNECTIVITY)):
            connectivity = build_connectivity(self._faces, n_vertices)
        self._report_step(OF_CONNECTIVITY)
        points, plan = self._scale.points(self._coefficients, self._horizontal)
        view = LevelView(self._faces, points, plan, connectivity, self._locked, self._in_plan)
        with watched(self._report_split):
            split = self._partition.split(view, max_odd)
        if len(split.odd) == 0:
            self._stopped_by = "nothing_left"
            return None
        self._report_step(OF_CONNECTIVITY + OF_SPLIT)
        even = even_positions(split.odd, n_vertices)
        removal = Removal(points, plan, connectivity, *split, even, self._locked)
        filter_matrix = predict(self._options.prediction, removal)
        self._report_step(1.0)
        coarse, details, integrals = analyse_level(
            self._coefficients,
            split.odd,
            even,
            filter_matrix,
            self._options.update,
            self._integrals,
            self._locked,
        )
        faces = merged_faces(self._faces, merge_map(*split, n_vertices))
        if self._breaks_a_tolerance(coarse, even, faces):
            self._stopped_by = "tolerance"
            return None
        self._partition.descend(split, even, filter_matrix)
        self._faces, self._coefficients, self._integrals = faces, coarse, integrals
        self._locked = self._locked[even]
        if self._horizontal is not None:
            self._horizontal = self._horizontal[even]
        self._report_step(0.0)
        return Step(
            frozen(split.odd),
            frozen(split.target),
            frozen(filter_matrix.indptr.astype(np.int64)),
            frozen(filter_matrix.indices.astype(np.int32)),
            frozen(filter_matrix.data),
            frozen(details),
        )

    def _breaks_a_tolerance(
        self, coarse: FloatArray, even: NDArray[np.int32], faces: NDArray[np.int32]
    ) -> bool:
        max_error, max_rms = self._options.max_error, self._options.max_rms
        if max_error is None and max_rms is None:
            return False
        if self._horizontal is None:
            vertices = coarse[:, :3]
        else:
            vertices = np.column_stack([self._horizontal[even], coarse[:, 0]])
        errors = surface_errors(
            TriangleMesh._trusted(vertices, faces, np.empty((len(even), 0)), ()),
            self._mesh.vertices,
        )
        errors = errors[np.isfinite(errors)]
        if max_error is not None and np.abs(errors).max(initial=0.0) > max_error:
            return True
        return max_rms is not None and bool(np.sqrt(np.mean(errors**2)) > max_rms)

    def _report_split(self, share: float) -> None:
        self._report_step(OF_CONNECTIVITY + share * OF_SPLIT)

    def _report_step(self, share: float) -> None:
        self._share_of_step = share
        self._report()

    def _report_size(self, n_vertices: int) -> None:
        self._report(n_vertices=n_vertices)

    def _report(self, fraction: float | None = None, n_vertices: int | None = None) -> None:
        if self._progress is None:
            return
        n_input = self._mesh.n_vertices
        if fraction is None:
            expected = self._options.target_vertices or n_input * EXPECTED_KEPT ** min(
                self._most_levels(), 40
            )
            n_now = len(self._coefficients) if n_vertices is None else n_vertices
            gone = n_input - n_now + self._share_of_step * (1.0 - EXPECTED_KEPT) * n_now
            fraction = min(gone / max(n_input - expected, 1.0), 0.99)
        self._reported = fraction = max(fraction, self._reported)
        report(self._progress, fraction, "the analysis was cancelled; nothing was kept.")


def _begun_integrals(integrals: ArrayLike | None, mesh: TriangleMesh) -> FloatArray | None:
    if integrals is None:
        return None
    values = np.array(integrals, dtype=np.float64)
    if values.shape != (mesh.n_vertices,) or not np.isfinite(values).all():
        raise OptionError(
            "{0} has shape {shape}; give one finite number for each of {n} vertices.",
            "integrals",
            shape=values.shape,
            n=mesh.n_vertices,
        )
    return values


def _finer_points(
    points: ArrayLike | None, mesh: TriangleMesh, options: AnalysisOptions
) -> FloatArray | None:
    if points is None:
        return None
    values = np.array(points, dtype=np.float64)
    n_columns = 3 + mesh.attributes.shape[1]
    if values.ndim != 2 or values.shape[1] != n_columns or not np.isfinite(values).all():
        raise OptionError(
            "{0} has shape {shape}; give {n_columns} finite numbers for each point.",
            "points",
            shape=values.shape,
            n_columns=n_columns,
        )
    if not options.is_error_guided:
        raise OptionError(
            "{0} are for {1} 'surface' with its own filters; leave them out.", "points", "partition"
        )
    return values


def _require_upright(mesh: TriangleMesh) -> None:
    areas = mesh.plan_areas
    if len(areas) and areas.min() <= 0:
        face = int(np.argmax(areas <= 0))
        raise MeshError(
            "face {face} {vertices} is flipped or flat in plan (area {area:g}), so the mesh is no "
            "TIN; reorient or remove it, or use {0} 'xyz'.",
            face,
            "signal",
            face=face,
            vertices=mesh.faces[face].tolist(),
            area=areas[face],
        )
