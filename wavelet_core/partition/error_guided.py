"""Pyramids that keep the surface: partition by vertical error, barycentric prediction.

Every removal is ranked by what it does to the vertical errors of *all* input vertices, so the
coarse TINs are about the best of their size. Plan positions never change, so every input vertex
lies in exactly one face of each level and follows it through the collapses.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray, frozen
from ..lifting.options import REMOVAL_FRACTION
from ..lifting.step import Step
from ._mutable_level import SurfaceLevel

#: Norms by which a removal is judged.
NORMS = ("rms", "max")
#: Where a size or a tolerance says when to stop, a level takes no vertex that costs more than this
#: many times what the cheapest ones do: cheap terrain goes first, whatever its share. Where only
#: the number of levels is given, each level takes its full share.
COST_RATIO = 8.0
#: While more than FAR times the target are left, a level may take FAR_FACTOR times the share, and
#: vertices that are dearer: what goes then hardly adds to the error in the end.
FAR = 2
FAR_FACTOR = 2.0
FAR_COST_RATIO = 64.0
#: Costs beyond this multiple of the last level's dearest are not worked out: the first with a size
#: or a tolerance; the second where each level takes its full share, which needs more choice.
FORESIGHT = 2.0
FULL_FORESIGHT = 4.0
#: With an update and a tolerance, how often a level is tried with fewer vertices.
N_ATTEMPTS = 6
#: An analysis by tolerance ends when a level takes less than this part of the vertices.
LEAST_PROGRESS = 1e-3


class SurfaceRules(NamedTuple):
    """When to stop, and how to rank.

    levels : int, the most levels
    norm : "rms" or "max"
    with_update : bool, minimum-norm update or none
    removal_fraction : float in (0, 1]
    target_vertices : int
    max_error, max_rms : float, in the unit of z; inf for no limit
    """

    levels: int
    norm: str = "rms"
    with_update: bool = True
    removal_fraction: float = REMOVAL_FRACTION
    target_vertices: int = 0
    max_error: float = np.inf
    max_rms: float = np.inf

    def share_of(self, n_vertices: int) -> tuple[float, float]:
        """Return which share a level may take, and how much dearer than its cheapest."""
        if self.target_vertices > 0 and n_vertices > FAR * self.target_vertices:
            return min(FAR_FACTOR * self.removal_fraction, 1.0), FAR_COST_RATIO
        return self.removal_fraction, COST_RATIO if self.has_aim else np.inf

    @property
    def foresight(self) -> float:
        """Up to what multiple of this level's dearest the next level's costs are worked out."""
        return FORESIGHT if self.has_aim else FULL_FORESIGHT

    @property
    def has_aim(self) -> bool:
        """Whether a size or a tolerance says when to stop."""
        return self.target_vertices > 0 or min(self.max_error, self.max_rms) < np.inf

    @property
    def needs_proof(self) -> bool:
        """Whether a step may break a tolerance that its ranking did not see."""
        return self.max_rms < np.inf or (self.max_error < np.inf and self.with_update)

    def budget_of(self, level: SurfaceLevel) -> float:
        """Return what the sum of the squared errors may still grow by."""
        if self.max_rms == np.inf:
            return np.inf
        return self.max_rms**2 * level.n_input - level.squared_errors()

    def are_kept_by(self, level: SurfaceLevel) -> bool:
        """Whether the errors of all input vertices keep the tolerances."""
        if self.max_rms < np.inf and level.squared_errors() > self.max_rms**2 * level.n_input:
            return False
        return level.largest_error() <= self.max_error


class SurfaceAnalysis(NamedTuple):
    """Coarse coefficients ``(n_coarse, n_channels)``, and the steps, the finest first."""

    coarse: FloatArray
    steps: list[Step]


def analyse_surface(
    plan: FloatArray,
    columns: FloatArray,
    faces: NDArray[np.int32],
    locked: NDArray[np.bool_],
    weights: FloatArray,
    rules: SurfaceRules,
    report: Callable[[int], None],
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
    """
    level = SurfaceLevel(plan, columns * weights, faces, locked, rules.with_update)
    steps: list[Step] = []
    cutoff = np.inf
    while len(steps) < rules.levels:
        taken = _take_step(level, rules, cutoff, report)
        if taken is None:
            break
        level, step, cutoff = taken
        steps.append(step)
    ids = level.ids
    coarse = level.heights / weights
    unchanged = locked[ids] if rules.with_update else np.ones(len(ids), dtype=bool)
    coarse[unchanged] = columns[ids[unchanged]]  # to the bit
    for step in steps:
        step.details[:] /= weights
        frozen(step.details)
    return SurfaceAnalysis(coarse, steps)


def _take_step(
    level: SurfaceLevel, rules: SurfaceRules, cutoff: float, report: Callable[[int], None]
) -> tuple[SurfaceLevel, Step, float] | None:
    """Take one step; return the level after it, the step, and the next cutoff of costs."""
    report(level.n_vertices)
    max_odd = level.n_vertices - rules.target_vertices
    if max_odd <= 0:
        return None
    slots = _candidates(level, rules, cutoff)
    odd = level.independent(slots, max_odd, rules.budget_of(level))
    if len(odd) == 0:
        return None
    cost = level.costs(odd)
    dearest = float(cost.max())
    next_cutoff = rules.foresight * dearest if dearest > 0 else np.inf
    report(level.n_vertices)
    if not rules.needs_proof:
        return level, level.remove(odd), next_cutoff
    cheapest_first = odd[np.argsort(cost, kind="stable")]
    for attempt in range(N_ATTEMPTS):
        n_odd = len(odd) >> attempt
        if n_odd == 0 or (attempt and n_odd < LEAST_PROGRESS * level.n_vertices):
            return None
        trial = level.snapshot()
        step = trial.remove(np.sort(cheapest_first[:n_odd]))
        if rules.are_kept_by(trial):
            return trial, step, next_cutoff
    return None


def _candidates(level: SurfaceLevel, rules: SurfaceRules, cutoff: float) -> NDArray[np.int32]:
    """Return the slots that may go; dearer ones are looked at where few others are left."""
    fraction, cost_ratio = rules.share_of(level.n_vertices)
    level.rank(rules.norm, rules.max_error, cutoff)
    slots = level.candidates(fraction, cutoff, cost_ratio)
    if cutoff < np.inf and len(slots) < LEAST_PROGRESS * level.n_vertices:
        level.rank(rules.norm, rules.max_error, np.inf)
        slots = level.candidates(fraction, np.inf, cost_ratio)
    return slots
