"""Work in blocks: the same whatever the number of threads, and the same as at once."""

import numpy as np
import pytest

from wavelet_core import analyse, synthetic
from wavelet_core._threads import (
    BLOCK,
    THREADS_VARIABLE,
    centre_of,
    minus,
    put_rows,
    rows_at,
    run_in_blocks,
)


@pytest.mark.parametrize("n_items", [0, 1, BLOCK, 2 * BLOCK + 1])
@pytest.mark.parametrize("threads", ["1", "3"])
def test_blocks_cover_all_items_in_order(n_items, threads, monkeypatch):
    monkeypatch.setenv(THREADS_VARIABLE, threads)
    bounds = run_in_blocks(lambda start, stop: (start, stop), n_items)
    assert [start for start, _ in bounds] == list(range(0, n_items, BLOCK))
    assert [stop for _, stop in bounds][-1:] == ([n_items] if n_items else [])
    assert all(stop - start <= BLOCK for start, stop in bounds)


def test_what_a_block_raises_is_raised(monkeypatch):
    monkeypatch.setenv(THREADS_VARIABLE, "2")

    def fail(start, stop):
        if start > BLOCK:
            raise ValueError("of the third block")

    with pytest.raises(ValueError, match="third"):
        run_in_blocks(fail, 3 * BLOCK)


def test_rows_and_centres_are_those_of_numpy():
    rng = np.random.default_rng(1)
    array = rng.normal(size=(BLOCK + 100, 2))
    places = rng.integers(0, len(array), 2 * BLOCK)
    np.testing.assert_array_equal(rows_at(array, places), array[places])
    np.testing.assert_array_equal(rows_at(array[:, 0] > 0, places), (array[:, 0] > 0)[places])
    middle, extent = centre_of(array)
    np.testing.assert_array_equal(extent, np.ptp(array, axis=0))
    np.testing.assert_array_equal(middle, array.min(axis=0) + extent / 2)
    assert [len(found) for found in centre_of(np.empty((3, 0)))] == [0, 0]


def test_the_figures_of_levels_are_the_same_for_any_number_of_threads(monkeypatch):
    mesh = synthetic.hills(300, 310)
    measured = []
    for threads in ("1", "2"):
        monkeypatch.setenv(THREADS_VARIABLE, threads)
        measured.append(analyse(mesh, target_vertices=10_000).measured)
    for one, other in zip(*measured, strict=True):
        assert one[:-1] == other[:-1]
        np.testing.assert_array_equal(one.squared_changes, other.squared_changes)


def test_rows_are_put_and_taken_from_as_by_numpy():
    rng = np.random.default_rng(0)
    n = 3 * BLOCK + 5
    places = rng.permutation(2 * n)[:n]
    rows = rng.normal(size=(n, 2))
    array = np.zeros((2 * n, 2))
    expected = array.copy()
    expected[places] = rows
    put_rows(array, places, rows)
    np.testing.assert_array_equal(array, expected)
    np.testing.assert_array_equal(minus(rows, rows[7]), rows - rows[7])
