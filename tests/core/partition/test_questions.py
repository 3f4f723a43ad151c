"""The classes of questions, beside a slow reader of the numbers on the page of the format."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from wavelet_core._kernels.forecast import NO_FORECAST
from wavelet_core.partition import questions
from wavelet_core.partition.questions import Bounds

PAGE = Path(__file__).resolve().parents[3] / "docs" / "reference" / "format.md"


def tables():
    """Return the rows of the odds as the page has them: first place, numbers, what is instead."""
    text = PAGE.read_text("utf-8").split("one number out of\neach row")[1].split("**Before")[0]
    rows = [line.strip("| ").split(" |") for line in text.splitlines() if line.startswith("| ")][1:]
    numbers = [[int(number) for number in row[2].split(",")] for row in rows]
    instead = [re.match(r" (-?\d+) ", row[3] + " ") if len(row) > 3 else None for row in rows]
    return numbers, [None if found is None else int(found[1]) for found in instead]


def upper_half(number):
    with np.errstate(over="ignore"):
        return int(np.float32(number).view(np.uint32)) >> 16


def class_of_going(best, second, neighbours, integral, bounds, is_first):
    """Return the class of one question, as the page says it."""
    numbers, instead = tables()
    code = upper_half(integral)
    places = (
        (best - bounds.middle) // 128 + 8,
        int(not is_first),
        neighbours - 3,
        (code - bounds.integral) // 32 + 8,
        max(second - best, 0) // 64,
    )
    is_instead = (best == 0, False, False, code == upper_half(1.0), second == NO_FORECAST)
    odds = -9
    for row, other, place, differs in zip(numbers, instead, places, is_instead, strict=True):
        odds += other if differs else row[min(max(place, 0), len(row) - 1)]
    return min(max(odds // 3 + 16, 0), 31)


def class_of_target(best, second, neighbours, integral):
    if second == NO_FORECAST:
        return 28
    untouched = upper_half(integral) == upper_half(1.0)
    return 4 * (min(max(neighbours, 3), 9) - 3) + 2 * untouched + (best == 0)


@pytest.fixture
def vertices():
    """Return 3,000 vertices with forecasts in and out of order, none, and integrals of any kind."""
    rng = np.random.default_rng(7)
    best = rng.integers(0, 30_000, 3000).astype(np.uint16)
    best[rng.random(3000) < 0.2] = 0
    second = np.clip(best + rng.integers(-1, 1200, 3000), 0, NO_FORECAST).astype(np.uint16)
    second[100:400] = NO_FORECAST
    n_around = rng.integers(3, 14, 3000).astype(np.uint8)
    integrals = rng.choice([1.0, 1.0, 1.0, 1.004, 1.02, -0.5, 0.0, 1e-50, 1e50, np.inf], 3000)
    integrals[1500:] = 2.0 ** rng.uniform(-4, 6, 1500)
    return questions._Forecasts(best, second, n_around), SimpleNamespace(integrals=integrals)


@pytest.mark.parametrize("is_first", [True, False])
@pytest.mark.parametrize("bounds", [Bounds(40_000, 14_000, 0x3F80), Bounds(9, 3, 0x4100)])
def test_whether_a_vertex_goes_is_asked_in_the_class_that_the_page_says(vertices, bounds, is_first):
    forecasts, sight = vertices
    asked = np.arange(0, 3000, 3, dtype=np.int32)
    found = questions._classes_by_odds(sight, forecasts, bounds)(asked, is_first)
    known = zip(*(of_all[asked].tolist() for of_all in (*forecasts, sight.integrals)), strict=True)
    expected = [class_of_going(*of_one, bounds, is_first) for of_one in known]
    assert found.dtype == np.uint8
    assert found.tolist() == expected
    assert len(set(expected)) > 15


def test_onto_which_target_is_asked_in_the_class_that_the_page_says(vertices):
    forecasts, sight = vertices
    odd = np.arange(0, 3000, 2, dtype=np.int32)
    found = questions._targets_by_ring(odd, sight, forecasts)
    known = zip(*(of_all[odd].tolist() for of_all in (*forecasts, sight.integrals)), strict=True)
    assert found.tolist() == [class_of_target(*of_one) for of_one in known]
    assert set(found.tolist()) == set(range(questions.N_TARGET_CLASSES))
