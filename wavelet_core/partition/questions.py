"""What the forecasts of collapses leave open of a step: questions, their classes, the answers.

Whoever has the finer level knows the forecast of every collapse, which costs no symbol. What is
left are answers to questions in an order that both sides work out:

* of each level, how high the forecast of a vertex that goes may be, and what it and the integral
  are in the middle;
* of each vertex whose forecast is lower than those of all neighbours still in question, whether it
  goes. If it does, its neighbours stay, and are not asked about; if not, it is out of question;
* of each vertex that goes, onto which of its legal targets, counted from the best forecast.

An answer belongs to a class of questions, by the odds that what is known gives it. Within one,
answers are alike, so that a compressor makes little of them: some 1.6 bits a vertex of the first
kind and 0.6 of the second where the steps by themselves have 4 and 2.3.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from .._arrays.forecast import upper_halves
from .._kernels._jit import run_in_ranges
from .._kernels.forecast import NO_FORECAST, forecast_collapses, match_targets
from .._kernels.half_edges import HalfEdges
from .._kernels.outline import Outline
from .._kernels.surface_choice import OUT_OF_QUESTION, find_first, take_first
from .._kernels.surface_points import Surface
from .._threads import run_in_blocks
from .._validate import FloatArray, frozen
from ..errors import PyramidError

#: Classes of the questions whether a vertex goes.
N_GOING_CLASSES = 32
#: Onto which target: by the number of neighbours, three to nine and more, whether the integral
#: still is 1 and whether the forecast is nothing; the last one where there is one target only.
N_TARGET_CLASSES = 7 * 4 + 1
#: Codes in an octave: numbers within a factor of two.
CODES_IN_OCTAVE = 128
#: The odds that a vertex goes, in sixteenths of their natural logarithm, are the sum of six terms.
#: They are those of a logistic regression over ten terrains (rasters of 1 to 90 m, clouds of 1 to
#: 20 points a square metre). Fitted to nine of them, the tables leave 4 to 14 % fewer bytes of the
#: tenth than classes by forecast alone, 11 % in the mean (`benchmarks/cost/odds.py`).
ODDS = -9
#: By the octave of the forecast from the middle of those that go, eight below to eight above.
ODDS_BY_FORECAST = (8, 7, 7, 6, 6, 6, 7, 7, 7, -11, -37, -26, 12, 12, 7, -38, -9)
#: Where the forecast is nothing.
ODDS_OF_NOTHING = 18
#: In the first round of questions, and later.
ODDS_BY_ROUND = (-3, -5)
#: By the number of neighbours, from three on.
ODDS_BY_NEIGHBOURS = (10, 8, 8, 5, -4, -8, -12, -14)
#: By the quarter of an octave of the integral, from two octaves below the middle to two above.
ODDS_BY_INTEGRAL = (11, 9, 5, 6, 4, 3, 1, -1, -1, -6, -5, -12, -12, -13, -10, -8, -6)
#: Where the integral still is 1, as in the input.
ODDS_OF_UNTOUCHED = 28
#: By the half octaves between the best forecast and the next.
ODDS_BY_LEAD = (12, 6, 4, 2, 1, -1, -1, -3, -3, -3, -4, -5, -6)
#: Where there is one target only.
ODDS_OF_NO_CHOICE = -7
#: Odds in a class; the middle one is that of even odds.
ODDS_IN_CLASS = 3
#: In records before format 4: the class of the forecasts in the middle of those that go, and the
#: last one; the classes of targets, and the codes by which the best target leads in one of them.
MIDDLE_CLASS = 8
LAST_CLASS = 14
N_LEAD_CLASSES = 8
CODES_IN_DOUBT = 96
#: Forecasts below the square of so many steps of rounding are nothing.
NEGLIGIBLE_STEPS = 16.0


class Answers(NamedTuple):
    """What was answered, by class, in the order of the questions.

    levels : (n_steps, 3) uint16, of each step the highest and the middle code of what goes, and the
        middle code of its integrals; (n_steps, 2) in records that ask by forecasts alone
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
    integrals : (n,) float64, of the scaling functions
    height_step : float, differences of heights below are rounding
    """

    mesh: HalfEdges
    surface: Surface
    outline: Outline
    stays: NDArray[np.bool_]
    locked: NDArray[np.bool_]
    key: NDArray[np.uint32]
    slots: NDArray[np.int32]
    integrals: FloatArray
    height_step: float


class Bounds(NamedTuple):
    """Codes of the vertices that go at a step: the highest, that in the middle, of the integrals.

    integral : int, or None in records that ask by forecasts alone
    """

    highest: int
    middle: int
    integral: int | None = None


class _Forecasts(NamedTuple):
    """Of every slot the codes of the best and of the next best target, and how many neighbours."""

    best: NDArray[np.uint16]
    second: NDArray[np.uint16]
    n_around: NDArray[np.uint8]


#: Gives the classes of the questions about vertices, in the first round or later.
_Classes = Callable[[NDArray[np.int32], bool], NDArray[np.uint8]]


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
    forecasts = _forecasts(sight)
    is_odd, bounds = None, None
    if truth is not None:
        is_odd = np.zeros(len(forecasts.best), dtype=bool)
        is_odd[truth.odd] = True
        codes, integrals = forecasts.best[truth.odd], upper_halves(sight.integrals[truth.odd])
        bounds = Bounds(int(codes.max()), _middle(codes), _middle(integrals))
    bounds = pen.level(bounds)
    odd = _ask_going(pen, sight, forecasts, bounds, is_odd)
    if len(odd) == 0:
        raise PyramidError("a step without odd vertices; the file is damaged.")
    classes_of_targets = _targets_by_lead if bounds.integral is None else _targets_by_ring
    classes = classes_of_targets(odd, sight, forecasts)
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


def _middle(codes: NDArray[np.uint16]) -> int:
    return int(np.partition(codes, len(codes) // 2)[len(codes) // 2])


def _forecasts(sight: Sight) -> _Forecasts:
    best, second = (np.full(len(sight.key), NO_FORECAST, dtype=np.uint16) for _ in range(2))
    n_around = np.zeros(len(sight.key), dtype=np.uint8)
    negligible = (NEGLIGIBLE_STEPS * sight.height_step) ** 2
    run_in_ranges(
        forecast_collapses, len(sight.slots), sight.slots, sight.mesh, sight.surface, sight.stays,
        sight.locked, sight.outline, sight.height_step, negligible, best, second,
        n_around,
    )  # fmt: skip
    return _Forecasts(best, second, n_around)


def _ask_going(
    pen: Pen,
    sight: Sight,
    forecasts: _Forecasts,
    bounds: Bounds,
    is_odd: NDArray[np.bool_] | None,
) -> NDArray[np.int32]:
    """Ask in rounds which of the vertices go; return those, ascending."""
    codes = forecasts.best
    place = _places(codes, sight.key, bounds.highest)
    active = np.flatnonzero(codes <= bounds.highest).astype(np.int32)  # none at slots that are gone
    classes_of = _classes_by_forecast if bounds.integral is None else _classes_by_odds
    classes_of_asked = classes_of(sight, forecasts, bounds)
    rival = np.arange(len(place), dtype=np.int32)
    taken = []
    is_first = True
    while len(active):
        wins = np.empty(len(active), dtype=bool)
        run_in_ranges(find_first, len(active), active, sight.mesh, place, wins, rival)
        asked = active[wins]
        classes = classes_of_asked(asked, is_first)
        goes = pen.going(classes, None if is_odd is None else is_odd[asked])
        place[asked[~goes]] = OUT_OF_QUESTION
        wins[wins] = goes
        run_in_ranges(take_first, len(active), active, wins, sight.mesh, place)
        taken.append(asked[goes])
        active = active[_are_in_question(place, active)]
        is_first = False
    return np.sort(np.concatenate(taken)) if taken else np.empty(0, dtype=np.int32)


def _are_in_question(place: NDArray[np.uint64], slots: NDArray[np.int32]) -> NDArray[np.bool_]:
    found = np.empty(len(slots), dtype=bool)

    def fill(start: int, stop: int) -> None:
        found[start:stop] = place[slots[start:stop]] != OUT_OF_QUESTION

    run_in_blocks(fill, len(slots))
    return found


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

    def level(self, bounds: Bounds | None) -> Bounds:
        """Return the codes of a level."""

    def going(self, classes: NDArray, answers: NDArray | None) -> NDArray[np.bool_]:
        """Return which vertices go."""

    def targets(self, classes: NDArray, answers: NDArray | None) -> NDArray[np.int32]:
        """Return the places of targets."""


class Writer:
    """A pen that keeps the answers it is given."""

    def __init__(self) -> None:
        self._levels: list[Bounds] = []
        self._going: list[list[NDArray]] = [[] for _ in range(N_GOING_CLASSES)]
        self._targets: list[list[NDArray]] = [[] for _ in range(N_TARGET_CLASSES)]

    def level(self, bounds: Bounds | None) -> Bounds:
        """Keep the codes of a level."""
        assert bounds is not None
        self._levels.append(bounds)
        return bounds

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
            np.array(self._levels, dtype=np.uint16).reshape(-1, len(Bounds._fields)),
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
        self._going = [0] * len(answers.going)
        self._targets = [0] * len(answers.targets)

    def level(self, bounds: Bounds | None) -> Bounds:
        """Return the codes of the next level."""
        highest, *middle = self._answers.levels[self._level].tolist()
        self._level += 1
        return Bounds(min(highest, NO_FORECAST - 1), *middle)

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


#: The code of the integrals of the input.
_UNTOUCHED = upper_halves(np.ones(1))[0]


def _classes_by_odds(sight: Sight, forecasts: _Forecasts, bounds: Bounds) -> _Classes:
    """Return what gives the classes of questions by the odds that a vertex goes."""
    assert bounds.integral is not None
    every = np.arange(NO_FORECAST + 1)
    by_forecast = _looked_up(
        ODDS_BY_FORECAST, (every - bounds.middle) // CODES_IN_OCTAVE + len(ODDS_BY_FORECAST) // 2
    )
    by_forecast[0] = ODDS_OF_NOTHING
    quarters = (every - bounds.integral) // (CODES_IN_OCTAVE // 4)
    by_integral = _looked_up(ODDS_BY_INTEGRAL, quarters + len(ODDS_BY_INTEGRAL) // 2)
    by_integral[_UNTOUCHED] = ODDS_OF_UNTOUCHED
    by_lead = _looked_up(ODDS_BY_LEAD, every // (CODES_IN_OCTAVE // 2))
    by_neighbours = _looked_up(ODDS_BY_NEIGHBOURS, np.arange(256) - 3)
    best, second, n_around = forecasts

    def of_block(asked: NDArray[np.int32], is_first: bool) -> NDArray[np.int16]:
        codes, next_best = best[asked], second[asked]
        lead = by_lead[np.maximum(next_best, codes) - codes]  # equal ones may be out of order
        lead[next_best == NO_FORECAST] = ODDS_OF_NO_CHOICE
        odds = by_forecast[codes] + by_integral[upper_halves(sight.integrals[asked])] + lead
        odds += by_neighbours[n_around[asked]] + np.int16(ODDS + ODDS_BY_ROUND[not is_first])
        return np.clip(odds // ODDS_IN_CLASS + N_GOING_CLASSES // 2, 0, N_GOING_CLASSES - 1)

    def classes(asked: NDArray[np.int32], is_first: bool) -> NDArray[np.uint8]:
        found = np.empty(len(asked), dtype=np.uint8)

        def fill(start: int, stop: int) -> None:
            found[start:stop] = of_block(asked[start:stop], is_first)

        run_in_blocks(fill, len(asked))
        return found

    return classes


def _looked_up(table: tuple[int, ...], places: NDArray[np.int64]) -> NDArray[np.int16]:
    """Return the entries of a table at places, the first and last one beyond its ends."""
    return np.array(table, dtype=np.int16)[np.clip(places, 0, len(table) - 1)]


def _classes_by_forecast(sight: Sight, forecasts: _Forecasts, bounds: Bounds) -> _Classes:
    """Return what gives the classes of questions in records before format 4."""
    del sight
    octave = (np.arange(NO_FORECAST + 1) - bounds.middle) // CODES_IN_OCTAVE + MIDDLE_CLASS
    octave = np.clip(octave, 0, LAST_CLASS)
    octave[0] = LAST_CLASS + 1
    first = (2 * octave).astype(np.uint8)

    def classes(asked: NDArray[np.int32], is_first: bool) -> NDArray[np.uint8]:
        return first[forecasts.best[asked]] + np.uint8(not is_first)

    return classes


def _targets_by_ring(
    odd: NDArray[np.int32], sight: Sight, forecasts: _Forecasts
) -> NDArray[np.uint8]:
    """Return the classes of the questions onto which target vertices go."""
    best, second, n_around = (of_all[odd] for of_all in forecasts)
    is_untouched = upper_halves(sight.integrals[odd]) == _UNTOUCHED
    classes = 4 * (np.clip(n_around, 3, 9) - 3) + 2 * is_untouched + (best == 0)
    classes[second == NO_FORECAST] = N_TARGET_CLASSES - 1
    return classes.astype(np.uint8)


def _targets_by_lead(
    odd: NDArray[np.int32], sight: Sight, forecasts: _Forecasts
) -> NDArray[np.uint8]:
    """Return the same as in records before format 4."""
    del sight
    best, second = forecasts.best[odd], forecasts.second[odd]
    lead = (second.astype(np.int64) - best) // CODES_IN_DOUBT
    classes = np.clip(lead, 0, N_LEAD_CLASSES - 3).astype(np.uint8)
    classes[best == 0] = N_LEAD_CLASSES - 2
    classes[second == NO_FORECAST] = N_LEAD_CLASSES - 1
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
