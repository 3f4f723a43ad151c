"""The steps of an error-guided analysis as few symbols, and from those the steps again.

The questions are those of `wavelet_core.partition.questions`. An analysis answers them at
each of its steps; whoever has the answers takes the same steps again.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.surface_points import FacePoints, hand_over
from .._validate import FloatArray
from ..errors import PyramidError
from ..progress import Progress, report
from ._mutable_level import CollapseStep, SurfaceLevel
from .questions import Answers, Collapses, Pen, Reader, Writer, ask


class Start(NamedTuple):
    """Where a record starts: the input, or a level that is stored for itself.

    plan : (n, 2) float64, x and y from the local origin
    heights : (n, c) float64, z and weighted attributes from theirs
    integrals : (n,) float64
    faces : (m, 3) int32
    locked : (n,) bool
    """

    plan: FloatArray
    heights: FloatArray
    integrals: FloatArray
    faces: NDArray[np.int32]
    locked: NDArray[np.bool_]


class Manner(NamedTuple):
    """What holds for all levels of one analysis.

    with_update : bool
    outline_tolerance : float
    height_step : float, differences of heights below are rounding
    """

    with_update: bool
    outline_tolerance: float
    height_step: float


class RecordedLevel(SurfaceLevel):
    """A level that is collapsed as a record says, without points, errors or costs.

    Parameters
    ----------
    start : Start
    manner : Manner
    """

    keeps_points = False

    def __init__(self, start: Start, manner: Manner) -> None:
        self._set_up(
            start.plan,
            start.heights,
            start.faces,
            start.locked,
            manner.with_update,
            manner.outline_tolerance,
            manner.height_step,
        )
        self._vertices.integrals[:] = start.integrals

    def take(self, pen: Pen, truth: CollapseStep | None = None) -> CollapseStep:
        """Take the next step: the one given, which the pen writes, or the one that it reads.

        Raises
        ------
        PyramidError
            The answers are those of no step that an analysis takes.
        """
        sight = self.sight()
        known = None
        if truth is not None:
            known = Collapses(sight.slots[truth.odd], sight.slots[truth.target])
        step = self.collapse(*ask(pen, sight, known))
        if step is None:
            raise PyramidError("a collapse that no surface allows; the file is damaged.")
        return step

    def collapse(self, odd: NDArray[np.int32], target: NDArray[np.int32]) -> CollapseStep | None:
        """Collapse vertices onto others, slots both; None if the link condition forbids one."""
        self._vertices.target[odd] = target
        n_vertices = self.n_vertices
        step = self.remove(odd)
        return step if n_vertices - self.n_vertices == len(odd) else None

    def _hand_over(
        self,
        odd: NDArray[np.int32],
        indptr: NDArray[np.int64],
        ring: NDArray[np.int32],
        ring_faces: NDArray[np.int32],
    ) -> tuple[NDArray[np.int32], FloatArray, FloatArray]:
        """Return corners, weights and details; the points are not kept."""
        n_odd, n_channels = len(odd), self._surface.z.shape[1]
        corners = np.empty((n_odd, 3), dtype=np.int32)
        weights, details = np.empty((n_odd, 3)), np.empty((n_odd, n_channels))
        none = FacePoints(
            self._points.start,
            self._points.n_points,
            np.empty(n_odd),
            np.empty(n_odd),
            np.empty((n_odd, n_channels)),
        )
        run_in_ranges(
            hand_over, n_odd, odd, indptr, ring, ring_faces, self._surface, none,
            np.arange(n_odd + 1, dtype=np.int64), self._faces.changed,
            self._outline.squared_tolerance, corners, weights, details,
        )  # fmt: skip
        self._points.n_points[:] = 0
        return corners, weights, details

    def _bring_sums_up_to_date(self) -> None:
        """Sum nothing: there are no points."""


def record(
    level: RecordedLevel,
    steps: Sequence[CollapseStep],
    weights: FloatArray,
    progress: Progress | None = None,
) -> Answers | None:
    """Return the answers that give the steps from ``level`` on; None where they do not to the bit.

    Parameters
    ----------
    level : RecordedLevel
        Where they start; it is left where they end.
    steps : sequence of CollapseStep
        The finest first; their details are in input units.
    weights : (c,) float64
        What the level's heights are in, by those.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    writer = Writer()
    n_vertices = level.n_vertices
    for step in steps:
        if not takes(level, writer, step, weights):
            return None
        report(progress, 1.0 - level.n_vertices / n_vertices)
    return writer.answers()


def takes(level: RecordedLevel, writer: Writer, step: CollapseStep, weights: FloatArray) -> bool:
    """Take one step of an analysis; return whether it came out to the bit, see `record`."""
    if len(step.odd) == 0 or not (np.diff(step.odd) > 0).all():
        return False
    try:
        taken = level.take(writer, step)
    except PyramidError:
        return False
    taken = taken._replace(details=taken.details / weights)
    pairs: Iterable[tuple[Any, Any]] = zip(taken, step, strict=True)
    return all(np.array_equal(one, other) for one, other in pairs)


def replay(
    level: RecordedLevel, answers: Answers, progress: Progress | None = None
) -> list[CollapseStep]:
    """Return the steps that answers describe, the finest first; ``level`` is left where they end.

    Parameters
    ----------
    level : RecordedLevel
        Where they start.
    answers : Answers
        Of any origin.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    PyramidError
        They describe no steps of an analysis.
    """
    reader = Reader(answers)
    steps = []
    n_vertices = level.n_vertices
    for _ in range(len(answers.levels)):
        steps.append(level.take(reader))
        report(progress, 1.0 - level.n_vertices / n_vertices)
    reader.finish()
    return steps
