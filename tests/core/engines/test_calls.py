"""Compiled code is called past numba's look-up of types, which leaks before 0.61."""

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest

from wavelet_core._kernels import _jit
from wavelet_core._kernels._calls import PastLeak, called_past_leak

pytestmark = pytest.mark.skipif(not _jit.HAS_NUMBA, reason="compiles kernels, and numba is off")


class Pair(NamedTuple):
    first: np.ndarray
    second: np.ndarray


class Nested(NamedTuple):
    pair: Pair
    third: np.ndarray


class Counted:
    """A dispatcher of numba that counts how often its look-up of types is used."""

    def __init__(self, function):
        import numba

        self.compiled, self.n_calls = numba.njit(function), 0
        self.overloads = self.compiled.overloads

    def __call__(self, *arguments):
        self.n_calls += 1
        return self.compiled(*arguments)


def sum_of(nested, factor):
    total = 0.0
    for value in nested.pair.first.flat:
        total += value
    for value in nested.pair.second.flat:
        total += value
    for value in nested.third.flat:
        total += value
    return total * factor


@pytest.fixture
def counted():
    import numba

    counted = Counted(sum_of)
    return counted, PastLeak(counted, numba.typeof)


def test_arguments_of_one_kind_are_looked_up_once(counted):
    dispatcher, call = counted
    for k in range(5):
        array = np.arange(3.0 + k)
        assert call(Nested(Pair(array, array), array), 2.0) == 6 * array.sum()
    assert dispatcher.n_calls == 1


def test_what_numba_compiles_for_anew_is_another_kind(counted):
    """Code for other arrays would read their bytes wrongly."""
    dispatcher, call = counted
    plain = np.arange(12.0).reshape(3, 4)
    fixed = plain.copy()
    fixed.setflags(write=False)
    ragged = np.frombuffer(b"\0" + plain.tobytes(), "<f8", offset=1).reshape(3, 4)
    kinds = [plain, fixed, plain.T, plain[:, ::2], plain.astype("f4"), plain.astype("i4"), ragged]
    kinds += [np.arange(5.0), np.arange(5)]
    for k, array in enumerate(kinds):
        for _ in range(2):
            assert call(Nested(Pair(plain, array), plain), 1) == 2 * plain.sum() + array.sum()
        assert dispatcher.n_calls == k + 1
    assert call(Nested(Pair(plain, plain), plain), 0.5) == 1.5 * plain.sum()
    assert dispatcher.n_calls == len(kinds) + 1


@pytest.mark.parametrize(
    ("version", "is_leaking"), [((0, 56), True), ((0, 60), True), ((0, 61), False)]
)
def test_only_versions_that_leak_are_passed_by(version, is_leaking):
    import numba

    dispatcher = numba.njit(sum_of)
    of_version = SimpleNamespace(version_info=SimpleNamespace(short=version), typeof=numba.typeof)
    called = called_past_leak(dispatcher, of_version)
    assert isinstance(called, PastLeak) == is_leaking
    assert is_leaking or called is dispatcher


def test_a_kernel_calls_past_the_leak():
    import numba

    is_leaking = numba.version_info.short < (0, 61)
    assert all(isinstance(step.call, PastLeak) == is_leaking for step in _jit._steps)
