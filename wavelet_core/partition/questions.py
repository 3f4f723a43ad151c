"""What the forecasts of collapses leave open of a step: questions, their classes, the answers.

Whoever has the finer level knows the forecast of every collapse, which costs no symbol. What is
left are answers to questions in an order that both sides work out:

* of each level, how high the forecast of a vertex that goes may be, and what it is in the middle;
* of each vertex whose forecast is lower than those of all neighbours still in question, whether it
  goes. If it does, its neighbours stay, and are not asked about; if not, it is out of question;
* of each vertex that goes, onto which of its legal targets, counted from the best forecast.

An answer belongs to a class of questions, by what is forecast. Within one, answers are alike, so
that a compressor makes little of them: some 1.8 bits a vertex of the first kind and 1 of the second
where the steps by themselves have 4 and 2.3.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.forecast import NO_FORECAST, forecast_collapses, match_targets
from .._kernels.half_edges import HalfEdges
from .._kernels.outline import Outline
from .._kernels.surface_choice import OUT_OF_QUESTION, find_first, take_first
from .._kernels.surface_points import Surface
from .._threads import run_in_blocks
from .._validate import frozen
from ..errors import PyramidError

#: Classes of the questions whether a vertex goes, and onto which target.
N_GOING_CLASSES = 32
N_TARGET_CLASSES = 8
#: Codes in a class: forecasts within a factor of two.
CODES_IN_CLASS = 128
#: The class of the forecasts in the middle of those that go, and the last one.
MIDDLE_CLASS = 8
LAST_CLASS = 14
#: Codes for how much better the best target is than the next one.
CODES_IN_DOUBT = 96
#: Forecasts below the square of so many steps of rounding are nothing.
NEGLIGIBLE_STEPS = 16.0


class Answers(NamedTuple):
    """What was answered, by class, in the order of the questions.

    levels : (n_steps, 2) uint16, of each step the highest and the middle code of what goes
    going : tuple of uint8 arrays, one a class, 0 or 1
    targets : tuple of uint8 arrays, one a class
    """

    levels: NDArray[np.uint16]
    going: tuple[NDArray[np.uint8], ...]
    targets: tuple[NDArray[np.uint8], ...]


class Sight(NamedTuple):
    """What is known of a level before its step: by whoever takes it, and by whoever reads of it.

    mesh, surface, outline : of the level
    stays, locked : (n,) bool, key : (n,) uint32, see `_level_state.VertexState`
    slots : (n_vertices,) int32, of the level's vertices, ascending
    height_step : float, differences of heights below are rounding
    """

    mesh: HalfEdges
    surface: Surface
    outline: Outline
    stays: NDArray[np.bool_]
    locked: NDArray[np.bool_]
    key: NDArray[np.uint32]
    slots: NDArray[np.int32]
    height_step: float


class Collapses(NamedTuple):
    """Which vertices go, and onto which.

    odd : (n_odd,) int32, slots, ascending
    target : (n_odd,) int32, slots
    """

    odd: NDArray[np.int32]
    target: NDArray[np.int32]


def ask(pen: Pen, sight: Sight, truth: Collapses | None = None) -> Collapses:
    """Return the collapses of a step: those given, which the pen writes, or those that it reads.

    Raises
    ------
    PyramidError
        The answers are those of no step that an analysis takes.
    """
    best, second = _forecasts(sight)
    is_odd, bounds = None, None
    if truth is not None:
        is_odd = np.zeros(len(best), dtype=bool)
        is_odd[truth.odd] = True
        codes = np.sort(best[truth.odd])
        bounds = int(codes[-1]), int(codes[len(codes) // 2])
    highest, middle = pen.level(bounds)
    odd = _ask_going(pen, sight, best, highest, middle, is_odd)
    if len(odd) == 0:
        raise PyramidError("a step without odd vertices; the file is damaged.")
    classes = _target_classes(best[odd], second[odd])
    if truth is None:
        ranks = pen.targets(classes, None)
        target = targets_at(sight, odd, ranks)
    else:
        target = truth.target
        ranks = places_of_targets(sight, odd, target)
        pen.targets(classes, ranks)
    if (target < 0).any() or (ranks < 0).any():
        raise PyramidError("a target that no ring has; the file is damaged.")
    return Collapses(odd, target)


def _forecasts(sight: Sight) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
    """Return the codes of the best and of the next best target of every slot."""
    best, second = (np.full(len(sight.key), NO_FORECAST, dtype=np.uint16) for _ in range(2))
    negligible = (NEGLIGIBLE_STEPS * sight.height_step) ** 2
    run_in_ranges(
        forecast_collapses, len(sight.slots), sight.slots, sight.mesh, sight.surface, sight.stays,
        sight.locked, sight.outline, sight.height_step, negligible, best, second,
    )  # fmt: skip
    return best, second


def _ask_going(
    pen: Pen,
    sight: Sight,
    codes: NDArray[np.uint16],
    highest: int,
    middle: int,
    is_odd: NDArray[np.bool_] | None,
) -> NDArray[np.int32]:
    """Ask in rounds which of the vertices go; return those, ascending."""
    place = _places(codes, sight.key, highest)
    active = np.flatnonzero(codes <= highest).astype(np.int32)  # none at slots that are gone
    class_of = _class_of_code(middle)
    rival = np.arange(len(place), dtype=np.int32)
    taken = []
    is_first = True
    while len(active):
        wins = np.empty(len(active), dtype=bool)
        run_in_ranges(find_first, len(active), active, sight.mesh, place, wins, rival)
        asked = active[wins]
        classes = class_of[codes[asked]] + np.uint8(not is_first)
        goes = pen.going(classes, None if is_odd is None else is_odd[asked])
        place[asked[~goes]] = OUT_OF_QUESTION
        wins[wins] = goes
        run_in_ranges(take_first, len(active), active, wins, sight.mesh, place)
        taken.append(asked[goes])
        active = active[place[active] != OUT_OF_QUESTION]
        is_first = False
    return np.sort(np.concatenate(taken)) if taken else np.empty(0, dtype=np.int32)


def targets_at(
    sight: Sight, odd: NDArray[np.int32], places: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Return the targets of vertices by their places among the legal ones; -1 beyond those."""
    target = np.full(len(odd), -1, dtype=np.int32)
    _match(sight, odd, places.copy(), target)
    return target


def places_of_targets(
    sight: Sight, odd: NDArray[np.int32], target: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Return the places of vertices' targets among the legal ones; -1 where it is none of them."""
    places = np.full(len(odd), -1, dtype=np.int32)
    _match(sight, odd, places, target.copy())
    return places


def _match(
    sight: Sight, odd: NDArray[np.int32], rank: NDArray[np.int32], target: NDArray[np.int32]
) -> None:
    run_in_ranges(
        match_targets, len(odd), odd, sight.mesh, sight.surface, sight.stays, sight.locked,
        sight.outline, sight.height_step, rank, target,
    )  # fmt: skip


class Pen(Protocol):
    """Gives the answers: writes down those it is given, or reads them."""

    def level(self, code: tuple[int, int] | None) -> tuple[int, int]:
        """Return the codes of a level."""

    def going(self, classes: NDArray, answers: NDArray | None) -> NDArray[np.bool_]:
        """Return which vertices go."""

    def targets(self, classes: NDArray, answers: NDArray | None) -> NDArray[np.int32]:
        """Return the places of targets."""


class Writer:
    """A pen that keeps the answers it is given."""

    def __init__(self) -> None:
        self._levels: list[tuple[int, int]] = []
        self._going: list[list[NDArray]] = [[] for _ in range(N_GOING_CLASSES)]
        self._targets: list[list[NDArray]] = [[] for _ in range(N_TARGET_CLASSES)]

    def level(self, code: tuple[int, int] | None) -> tuple[int, int]:
        """Keep the codes of a level."""
        assert code is not None
        self._levels.append(code)
        return code

    def going(self, classes: NDArray, answers: NDArray | None) -> NDArray[np.bool_]:
        """Keep which vertices go."""
        assert answers is not None
        _sort_into(self._going, classes, answers.astype(np.uint8))
        return answers

    def targets(self, classes: NDArray, answers: NDArray | None) -> NDArray[np.int32]:
        """Keep the places of targets."""
        assert answers is not None
        _sort_into(self._targets, classes, answers.astype(np.uint8))
        return answers

    def answers(self) -> Answers:
        """Return all that was kept."""
        return Answers(
            np.array(self._levels, dtype=np.uint16).reshape(-1, 2),
            tuple(_joined(parts) for parts in self._going),
            tuple(_joined(parts) for parts in self._targets),
        )


class Reader:
    """A pen that reads answers, in the order in which they were written.

    Parameters
    ----------
    answers : Answers
        Of any origin.
    """

    def __init__(self, answers: Answers) -> None:
        self._answers = answers
        self._level = 0
        self._going = [0] * N_GOING_CLASSES
        self._targets = [0] * N_TARGET_CLASSES

    def level(self, code: tuple[int, int] | None) -> tuple[int, int]:
        """Return the codes of the next level."""
        highest, middle = self._answers.levels[self._level]
        self._level += 1
        return min(int(highest), NO_FORECAST - 1), int(middle)

    def going(self, classes: NDArray, answers: NDArray | None) -> NDArray[np.bool_]:
        """Return which vertices go."""
        return _taken_from(self._answers.going, self._going, classes) != 0

    def targets(self, classes: NDArray, answers: NDArray | None) -> NDArray[np.int32]:
        """Return the places of targets."""
        return _taken_from(self._answers.targets, self._targets, classes).astype(np.int32)

    def finish(self) -> None:
        """Raise :class:`PyramidError` unless every answer has been read."""
        for stored, used in zip(
            (*self._answers.going, *self._answers.targets),
            (*self._going, *self._targets),
            strict=True,
        ):
            if len(stored) != used:
                raise PyramidError("answers to no question; the file is damaged.")


def _places(codes: NDArray[np.uint16], key: NDArray[np.uint32], highest: int) -> NDArray[np.uint64]:
    """Return numbers in the order of the questions: by forecast, and by key where these agree."""
    place = np.empty(len(codes), dtype=np.uint64)

    def fill(start: int, stop: int) -> None:
        of_block = codes[start:stop]
        numbers = (of_block.astype(np.uint64) << np.uint64(32)) | key[start:stop]
        place[start:stop] = np.where(of_block <= highest, numbers, OUT_OF_QUESTION)

    run_in_blocks(fill, len(codes))
    return place


def _class_of_code(middle: int) -> NDArray[np.uint8]:
    """Return the class of the questions of the first round, by code; later ones follow it."""
    octave = (np.arange(NO_FORECAST + 1) - middle) // CODES_IN_CLASS + MIDDLE_CLASS
    octave = np.clip(octave, 0, LAST_CLASS)
    octave[0] = LAST_CLASS + 1
    return (2 * octave).astype(np.uint8)


def _target_classes(best: NDArray[np.uint16], second: NDArray[np.uint16]) -> NDArray[np.uint8]:
    lead = (second.astype(np.int64) - best) // CODES_IN_DOUBT
    classes = np.clip(lead, 0, N_TARGET_CLASSES - 3).astype(np.uint8)
    classes[best == 0] = N_TARGET_CLASSES - 2
    classes[second == NO_FORECAST] = N_TARGET_CLASSES - 1
    return classes


def _sort_into(kept: list[list[NDArray]], classes: NDArray, answers: NDArray) -> None:
    order = np.argsort(classes, kind="stable")
    ends = np.cumsum(np.bincount(classes, minlength=len(kept)))
    for parts, answers_of_class in zip(kept, np.split(answers[order], ends[:-1]), strict=True):
        if len(answers_of_class):
            parts.append(answers_of_class)


def _joined(parts: list[NDArray]) -> NDArray[np.uint8]:
    return frozen(np.concatenate(parts)) if parts else frozen(np.empty(0, dtype=np.uint8))


def _taken_from(
    stored: tuple[NDArray[np.uint8], ...], used: list[int], classes: NDArray
) -> NDArray[np.uint8]:
    counts = np.bincount(classes, minlength=len(stored))
    parts = []
    for k, (answers, count) in enumerate(zip(stored, counts.tolist(), strict=True)):
        if used[k] + count > len(answers):
            raise PyramidError("questions without an answer; the file is damaged.")
        parts.append(answers[used[k] : used[k] + count])
        used[k] += count
    order = np.argsort(classes, kind="stable")
    answers = np.empty(len(classes), dtype=np.uint8)
    answers[order] = np.concatenate(parts)
    return answers
