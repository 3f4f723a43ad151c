"""The updates on whole arrays; see :mod:`wavelet_core._kernels.update`.

The one-ring mean goes in rounds: a row reads what rows before it left on the same even vertices. A
row that comes before all others with which it shares one can be applied, and all such rows at once.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from ._csr import expanded, summed


def minimum_norm_columns(indptr, columns, odd_integrals, integrals, locked, values):
    row = np.repeat(np.arange(len(odd_integrals)), np.diff(indptr))
    free = ~locked[columns]
    row, of = row[free], integrals[columns[free]]
    squared = summed(row, of**2, np.zeros(len(odd_integrals)))
    factor = np.divide(
        odd_integrals, squared, out=np.zeros(len(odd_integrals)), where=squared > 0.0
    )
    values[free] = of * factor[row]


def predict_rows(start, stop, indptr, columns, weights, coarse, predicted):
    first, last = indptr[start], indptr[stop]
    rows = csr_array(
        (weights[first:last], columns[first:last], indptr[start : stop + 1] - first),
        shape=(stop - start, len(coarse)),
    )
    predicted[start:stop] = rows @ coarse


def spread_integrals(indptr, columns, weights, odd_integrals, integrals):
    added = weights * np.repeat(odd_integrals, np.diff(indptr))
    integrals[:] = summed(columns, added, integrals)


def minimum_norm_changes(indptr, columns, odd_integrals, integrals, locked, details, changes):
    values = np.zeros(len(columns))
    minimum_norm_columns(indptr, columns, odd_integrals, integrals, locked, values)
    rows = csr_array((values, columns, indptr), shape=(len(details), len(changes)))
    changes[:] = rows.T @ details  # one row of `rows` after the other


def add_ring_means(indptr, columns, weights, details, locked, even):
    _apply(indptr, columns, weights, details, locked, even, np.arange(len(details)), 1.0)


def subtract_ring_means(indptr, columns, weights, details, locked, even):
    order = np.arange(len(details))[::-1]
    _apply(indptr, columns, weights, details, locked, even, order, -1.0)


def _apply(indptr, columns, weights, details, locked, even, order, sign):
    n_free = np.bincount(
        np.repeat(np.arange(len(details)), np.diff(indptr))[~locked[columns]],
        minlength=len(details),
    )
    waiting = order[n_free[order] > 0]
    rank = np.empty(len(details), dtype=np.int64)
    rank[order] = np.arange(len(order))
    lowest = np.full(len(even), len(details), dtype=np.int64)
    while len(waiting):
        row, place = expanded(indptr[waiting], np.diff(indptr)[waiting])
        free = ~locked[columns[place]]
        row, place = row[free], place[free]
        reach, ranks = columns[place], rank[waiting]
        lowest[reach[::-1]] = ranks[row][::-1]  # the first in order is written last
        starts = np.flatnonzero(np.diff(row, prepend=-1))
        comes_first = np.minimum.reduceat(lowest[reach], starts) == ranks
        now = comes_first[row]
        _add_constants(
            waiting[comes_first], np.cumsum(comes_first)[row[now]] - 1, place[now], columns,
            weights, details, even, sign,
        )  # fmt: skip
        waiting = waiting[~comes_first]


def _add_constants(rows, row, place, columns, weights, details, even, sign):
    into = columns[place]
    n_free = np.bincount(row, minlength=len(rows))
    total = summed(row, weights[place], np.zeros(len(rows)))
    excess = weights[place] - (total / n_free)[row]
    first = np.flatnonzero(np.diff(row, prepend=-1))
    for channel in range(details.shape[1]):
        values = even[into, channel]
        constant = summed(
            row,
            excess / (n_free[row] + 1.0) * (values - values[first][row]),
            details[rows, channel] / (n_free + 1.0),
        )
        even[into, channel] = values + sign * constant[row]
