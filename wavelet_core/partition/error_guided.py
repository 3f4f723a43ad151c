"""Pyramids that keep the surface: partition by vertical error, barycentric prediction.

Every removal is ranked by what it does to the vertical errors of *all* input vertices, so the
coarse TINs are about the best of their size. Plan positions never change, so every input vertex
lies in exactly one face of each level and follows it through the collapses.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray, frozen
from ._level_figures import LevelFigures
from ._mutable_level import CollapseStep, SurfaceLevel
from .questions import Collapses

#: Share of the vertices that a level may take, at most, unless more cost nothing. Half of them is
#: 1 to 6 % worse at the same size and takes 25 % less time. The comparisons that this and the
#: numbers below rest on are in docs/topics/surface.md, "What helped, and what did not".
REMOVAL_FRACTION = 0.25
#: Levels where neither their number nor a size or a tolerance is given. A level keeps some 85 % of
#: the vertices that have relief, so 1 to 4 % of them are left (table in docs/topics/surface.md).
DEFAULT_LEVELS = 24
#: Where a size or a tolerance says when to stop, a level takes no vertex that costs more than this
#: many times what the cheapest ones do: cheap terrain goes first, whatever its share. Where only
#: the number of levels is given, each level takes its full share. 4 times is 1 to 1.6 % better for
#: 10 % more time.
COST_RATIO = 8.0
#: While more than FAR times the target are left, a level may take FAR_FACTOR times the share, and
#: vertices that cost more: what goes then hardly adds to the error in the end (within 2 %, for 10
#: to 25 % less time).
FAR = 2
FAR_FACTOR = 2.0
FAR_COST_RATIO = 64.0
#: Costs beyond this multiple of the highest one of a level are not worked out for the next level,
#: which needs more choice where it takes its full share. A smaller margin leaves a level fewer
#: candidates; all costs are worked out only where hardly any are left (LEAST_PROGRESS). A margin of
#: 1.1 takes 2.6 times as long, 1.5 is 0.7 % worse, and 4 no better; with the full share, 2 is 1.7 %
#: worse and 8 takes 13 % more time for the same.
COST_MARGIN = 2.0
FULL_SHARE_COST_MARGIN = 4.0
#: With an update and a tolerance, how often a level is tried with half as many vertices. A single
#: trial leaves 12 % more vertices, four 1 %; eight leave 0.2 % fewer for 2 % more time.
N_ATTEMPTS = 6
#: An analysis by tolerance ends when a level takes less than this part of the vertices.
LEAST_PROGRESS = 1e-3


class SurfaceRules(NamedTuple):
    """When to stop, and how to rank.

    levels : int, the most levels; None for DEFAULT_LEVELS after those that thin flat parts alone
    norm : "rms" or "max"
    with_update : bool, minimum-norm update or none
    removal_fraction : float in (0, 1]
    target_vertices : int
    max_error, max_rms : float, in the unit of z; inf for no limit
    outline_tolerance : float, in the unit of x and y
    """

    levels: int | None
    norm: str = "rms"
    with_update: bool = True
    removal_fraction: float = REMOVAL_FRACTION
    target_vertices: int = 0
    max_error: float = np.inf
    max_rms: float = np.inf
    outline_tolerance: float = 0.0

    def share_of(self, n_vertices: int) -> tuple[float, float]:
        """Return which share a level may take, and up to what multiple of its cheapest cost."""
        if self.target_vertices > 0 and n_vertices > FAR * self.target_vertices:
            return min(FAR_FACTOR * self.removal_fraction, 1.0), FAR_COST_RATIO
        return self.removal_fraction, COST_RATIO if self.limits_error else np.inf

    @property
    def cost_margin(self) -> float:
        """Up to what multiple of this level's highest cost the next level's are worked out."""
        return COST_MARGIN if self.limits_error else FULL_SHARE_COST_MARGIN

    @property
    def limits_error(self) -> bool:
        """Whether a size or a tolerance says when to stop."""
        return self.has_tolerance or self.target_vertices > 0

    @property
    def has_tolerance(self) -> bool:
        """Whether a largest or a mean square error says when to stop."""
        return min(self.max_error, self.max_rms) < np.inf

    @property
    def needs_proof(self) -> bool:
        """Whether a step may break a tolerance that its ranking did not see."""
        return self.max_rms < np.inf or (self.max_error < np.inf and self.with_update)

    def budget_of(self, level: SurfaceLevel) -> float:
        """Return what the sum of the squared errors may still grow by."""
        if self.max_rms == np.inf:
            return np.inf
        return self._most_squared(level) - level.squared_errors()

    def are_kept_by(self, level: SurfaceLevel) -> bool:
        """Whether the errors of all input vertices keep the tolerances."""
        if self.max_rms < np.inf and level.squared_errors() > self._most_squared(level):
            return False
        return level.largest_error() <= self.max_error

    def _most_squared(self, level: SurfaceLevel) -> float:
        """Return the largest sum of squared errors that the mean allows."""
        return self.max_rms * self.max_rms * level.n_input  # inf where ** would overflow


class SurfaceAnalysis(NamedTuple):
    """Coarse coefficients ``(n_coarse, n_channels)``, and the steps, the finest first.

    faces : (n_faces, 3) int32, of the coarsest level
    stopped_by : one of wavelet_core.partition.stopping.REASONS
    figures : of every level, the finest first, in weighted columns
    """

    coarse: FloatArray
    faces: NDArray[np.int32]
    steps: list[CollapseStep]
    stopped_by: str
    figures: list[LevelFigures]


class Recorder(Protocol):
    """Follows what an analysis does; see `wavelet_core.lifting.recorded.Recorder`."""

    def look(self, level: SurfaceLevel, collapses: Collapses) -> None:
        """See which collapses are about to be taken on a level."""

    def took(self, level: SurfaceLevel, step: CollapseStep) -> None:
        """Keep a step, in input units, that ended at a level."""


class _Choice(NamedTuple):
    """Vertices that are to go; whether they are no more than flat parts; how far to rank next."""

    odd: NDArray[np.int32]
    is_flat: bool
    next_cutoff: float


def analyse_surface(
    plan: FloatArray,
    columns: FloatArray,
    faces: NDArray[np.int32],
    locked: NDArray[np.bool_],
    weights: FloatArray,
    rules: SurfaceRules,
    report: Callable[[int], None],
    integrals: FloatArray | None = None,
    points: FloatArray | None = None,
    recorder: Recorder | None = None,
) -> SurfaceAnalysis:
    """Return the coarse coefficients and the steps of a surface-guided analysis.

    Parameters
    ----------
    plan : ndarray, shape (n_vertices, 2)
        x and y.
    columns : ndarray, shape (n_vertices, n_channels)
        z and the attributes, in input units.
    faces : ndarray of int32, shape (n_faces, 3)
        A manifold, counter-clockwise in plan.
    locked : ndarray of bool, shape (n_vertices,)
    weights : ndarray, shape (n_channels,)
        What the errors of each channel count for; 1 for z.
    rules : SurfaceRules
    report : callable
        Called with the present number of vertices between the passes; may raise to stop.
    integrals : ndarray, shape (n_vertices,), optional
        Of the scaling functions of the input; by default 1.
    points : ndarray, shape (n_points, 2 + n_channels), optional
        Of a finer input, in input units; errors are measured at them, too.
    recorder : Recorder, optional
        Is given every step.
    """
    level = SurfaceLevel(
        plan, columns * weights, faces, locked, rules.with_update, rules.outline_tolerance
    )
    del faces  # which nobody else may keep
    if integrals is not None:
        level.begin_with(integrals)
    if points is not None:
        level.begin_with_points(points[:, :2], points[:, 2:] * weights)
    steps: list[CollapseStep] = []
    figures = [level.figures()]
    n_flat = 0
    cutoff = np.inf
    most = DEFAULT_LEVELS if rules.levels is None else rules.levels
    stopped_by = "levels"
    while len(steps) - n_flat < most:
        report(level.n_vertices)
        if level.n_vertices <= rules.target_vertices:
            stopped_by = "target"
            break
        choice = _choose(level, rules, cutoff)
        if choice is None:
            is_kept = rules.has_tolerance and level.has_collapse(rules.norm)
            stopped_by = "tolerance" if is_kept else "nothing_left"
            break
        report(level.n_vertices)
        taken = _take_step(level, rules, choice.odd, recorder)
        if taken is None:
            stopped_by = "tolerance"
            break
        level, step = taken
        steps.append(step._replace(details=frozen(step.details / weights)))
        if recorder is not None:
            recorder.took(level, steps[-1])
        figures.append(level.figures())
        n_flat += choice.is_flat
        cutoff = choice.next_cutoff
    ids = level.ids
    coarse = level.heights / weights
    unchanged = locked[ids] if rules.with_update else np.ones(len(ids), dtype=bool)
    coarse[unchanged] = columns[ids[unchanged]]  # to the bit
    return SurfaceAnalysis(coarse, level.faces, steps, stopped_by, figures)


def _choose(level: SurfaceLevel, rules: SurfaceRules, cutoff: float) -> _Choice | None:
    """Return which vertices go next; None where none can."""
    max_odd = level.n_vertices - rules.target_vertices
    while True:
        slots, is_flat = _candidates(level, rules, cutoff)
        odd = level.independent(slots, max_odd, rules.budget_of(level))
        if len(odd) == 0:
            return None
        linked = level.linked(odd)
        if len(linked) > 0:
            highest = float(level.costs(linked).max())
            next_cutoff = rules.cost_margin * highest if highest > 0 else np.inf
            return _Choice(linked, is_flat, next_cutoff)


def _candidates(
    level: SurfaceLevel, rules: SurfaceRules, cutoff: float
) -> tuple[NDArray[np.int32], bool]:
    """Return the slots that may go, and whether they are those of flat parts alone.

    Vertices beyond the cutoff are looked at where hardly any others are left.
    """
    fraction, cost_ratio = rules.share_of(level.n_vertices)
    level.rank(rules.norm, rules.max_error, cutoff)
    if rules.levels is None:
        free = level.free(cutoff)
        if len(free) > fraction * level.n_vertices:
            return free, True
    besides_free = rules.levels is not None and not rules.limits_error
    slots = level.candidates(fraction, cutoff, cost_ratio, besides_free)
    if cutoff < np.inf and len(slots) < LEAST_PROGRESS * level.n_vertices:
        level.rank(rules.norm, rules.max_error, np.inf)
        slots = level.candidates(fraction, np.inf, cost_ratio, besides_free)
    return slots, False


def _take_step(
    level: SurfaceLevel, rules: SurfaceRules, odd: NDArray[np.int32], recorder: Recorder | None
) -> tuple[SurfaceLevel, CollapseStep] | None:
    """Return the level after the step, and the step; None where no part of it keeps a tolerance."""
    if not rules.needs_proof:
        if recorder is not None:
            recorder.look(level, level.collapses(odd))
        return level, level.remove(odd)
    cheapest_first = odd[np.argsort(level.costs(odd), kind="stable")]
    for attempt in range(N_ATTEMPTS):
        n_odd = len(odd) >> attempt
        if n_odd == 0 or (attempt and n_odd < LEAST_PROGRESS * level.n_vertices):
            return None
        trial = level.snapshot()
        step = trial.remove(np.sort(cheapest_first[:n_odd]))
        if rules.are_kept_by(trial):
            if recorder is not None:
                slots = level.sight().slots
                recorder.look(level, Collapses(slots[step.odd], slots[step.target]))
            return trial, step
    return None
