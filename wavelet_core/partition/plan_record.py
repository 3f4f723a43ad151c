"""The steps of an error-guided analysis as which vertex went, and where to, without any heights.

For pyramids whose heights are no longer those of an input, such as filtered ones. Corners and
weights follow from the places of the vertices in plan, so that of each collapse only the place of
its target is kept, among the legal ones, the nearest first.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.surface_choice import OUT_OF_QUESTION, find_first
from .._validate import FloatArray
from ..errors import PyramidError
from ..progress import Progress, report, watched_part
from ._mutable_level import CollapseStep
from .questions import places_of_targets, targets_at
from .recorded import Manner, RecordedLevel, Start

#: Share of the time in which the finest level is set up.
_OF_START = 0.2

__all__ = ["places_of_steps", "steps_at_places"]


def places_of_steps(
    plan: FloatArray,
    faces: NDArray[np.int32],
    locked: NDArray[np.bool_],
    outline_tolerance: float,
    steps: Sequence[CollapseStep],
    progress: Progress | None = None,
) -> list[NDArray[np.uint8]] | None:
    """Return the places of the targets of each step; None where they do not give them to the bit.

    Parameters
    ----------
    plan : (n, 2) float64
        x and y of the finest level.
    faces : (m, 3) int32
    locked : (n,) bool
    outline_tolerance : float
        Of the analysis.
    steps : sequence of CollapseStep
        The finest first.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    level = _start(plan, faces, locked, outline_tolerance, progress)
    places = []
    for step in steps:
        if len(step.odd) == 0 or not (np.diff(step.odd) > 0).all():
            return None
        sight = level.sight()
        found = places_of_targets(sight, sight.slots[step.odd], sight.slots[step.target])
        if (found < 0).any():
            return None
        taken = _take(level, step.odd, found)
        if taken is None or not _are_alike(taken, step):
            return None
        places.append(found.astype(np.uint8))
        report(progress, _share_of(level, plan))
    return places


def steps_at_places(
    plan: FloatArray,
    faces: NDArray[np.int32],
    locked: NDArray[np.bool_],
    outline_tolerance: float,
    moves: Sequence[tuple[NDArray[np.int32], NDArray[np.uint8]]],
    progress: Progress | None = None,
) -> Iterator[CollapseStep]:
    """Yield the steps, the finest first, without details, of vertices that go to such places.

    Parameters
    ----------
    plan, faces, locked, outline_tolerance
        As for `places_of_steps`; a manifold, counter-clockwise in plan.
    moves : sequence of (odd, places)
        Of each step, the finest first; of any origin.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    PyramidError
        They describe no steps of an analysis.
    """
    level = _start(plan, faces, locked, outline_tolerance, progress)
    for odd, places in moves:
        is_sound = (
            len(odd) > 0
            and odd.shape == places.shape
            and bool((np.diff(odd) > 0).all())
            and odd[0] >= 0
            and odd[-1] < level.n_vertices
        )
        step = _take(level, odd, places.astype(np.int32)) if is_sound else None
        if step is None:
            raise PyramidError("collapses that no surface allows; the file is damaged.")
        report(progress, _share_of(level, plan))
        yield step


def _start(
    plan: FloatArray,
    faces: NDArray[np.int32],
    locked: NDArray[np.bool_],
    outline_tolerance: float,
    progress: Progress | None,
) -> RecordedLevel:
    centre = plan.min(axis=0) + np.ptp(plan, axis=0) / 2
    heights, integrals = np.zeros((len(plan), 1)), np.ones(len(plan))
    start = Start(plan - centre, heights, integrals, faces, locked)
    with watched_part(progress, 0.0, _OF_START):
        level = RecordedLevel(start, Manner(False, outline_tolerance, 0.0))
    report(progress, _OF_START)
    return level


def _share_of(level: RecordedLevel, plan: FloatArray) -> float:
    """Return how much of the work is done, by the vertices that are gone."""
    return _OF_START + (1.0 - _OF_START) * (1.0 - level.n_vertices / len(plan))


def _take(
    level: RecordedLevel, odd: NDArray[np.int32], places: NDArray[np.int32]
) -> CollapseStep | None:
    """Collapse vertices onto the targets at such places; None where that is not legal."""
    sight = level.sight()
    slots = sight.slots[odd]
    target = targets_at(sight, slots, places)
    order = np.full(len(sight.key), OUT_OF_QUESTION)
    order[slots] = np.arange(len(slots), dtype=np.uint64)
    wins = np.empty(len(slots), dtype=bool)
    if (target < 0).any():
        return None
    rival = np.arange(len(order), dtype=np.int32)
    run_in_ranges(find_first, len(slots), slots, sight.mesh, order, wins, rival)
    if not wins.all():  # two of them are neighbours
        return None
    return level.collapse(slots, target)


def _are_alike(one: CollapseStep, other: CollapseStep) -> bool:
    return all(
        np.array_equal(getattr(one, name), getattr(other, name))
        for name in ("odd", "target", "indptr", "indices", "weights")
    )
