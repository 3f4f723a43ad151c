"""Kernels of the filters: prediction, minimum-norm update, sequential one-ring mean."""

from ._jit import kernel, njit


# The number that the integrals over the unlocked support of one odd vertex, entries first to last
# of its row, are multiplied by to make its column of U (Eq. 50); 0 where none is unlocked.
# columns (nnz,) int32, integrals (n_even,) of the coarser level, locked (n_even,) bool
@njit
def minimum_norm_factor(first, last, columns, odd_integral, integrals, locked):
    squared = 0.0
    for k in range(first, last):
        if not locked[columns[k]]:
            squared += integrals[columns[k]] * integrals[columns[k]]
    if squared > 0.0:
        return odd_integral / squared
    return 0.0


# indptr (n_odd + 1,) int64, columns (nnz,) int32, odd_integrals (n_odd,), integrals (n_even,),
# locked (n_even,) bool; values (nnz,) float64, filled where the column is unlocked
@kernel
def minimum_norm_columns(indptr, columns, odd_integrals, integrals, locked, values):
    for row in range(len(indptr) - 1):
        first, last = indptr[row], indptr[row + 1]
        factor = minimum_norm_factor(first, last, columns, odd_integrals[row], integrals, locked)
        for k in range(first, last):
            if not locked[columns[k]]:
                values[k] = integrals[columns[k]] * factor


# P @ coarse, row by row; predicted (n_odd, n_channels) float64, filled
@kernel
def predict_rows(start, stop, indptr, columns, weights, coarse, predicted):
    for row in range(start, stop):
        for channel in range(coarse.shape[1]):
            total = 0.0
            for k in range(indptr[row], indptr[row + 1]):
                total += weights[k] * coarse[columns[k], channel]
            predicted[row, channel] = total


# Eq. 47: integrals (n_even,) float64 of the finer level, changed to those of the coarser one
@kernel
def spread_integrals(indptr, columns, weights, odd_integrals, integrals):
    for row in range(odd_integrals.shape[0]):
        for k in range(indptr[row], indptr[row + 1]):
            integrals[columns[k]] += weights[k] * odd_integrals[row]


# U @ details of the minimum-norm update; changes (n_even, n_channels) float64, zeros, filled
@kernel
def minimum_norm_changes(indptr, columns, odd_integrals, integrals, locked, details, changes):
    for row in range(odd_integrals.shape[0]):
        first, last = indptr[row], indptr[row + 1]
        factor = minimum_norm_factor(first, last, columns, odd_integrals[row], integrals, locked)
        for k in range(first, last):
            if not locked[columns[k]]:
                value = integrals[columns[k]] * factor
                for channel in range(details.shape[1]):
                    changes[columns[k], channel] += value * details[row, channel]


# The constant that Eq. 46 adds to the unlocked ring of one odd vertex, for one channel:
# w/(N+1) + sum (p_m - mean p)/(N+1) s_m, which is Eq. 46 where p sums to 1 over the ring. Shifting
# p rather than rescaling it keeps it bounded where the unlocked weights nearly cancel; since the
# shifted weights sum to 0, a local origin changes nothing but the rounding, which large weights
# would carry through the whole sequence.
@njit
def ring_constant(first, last, columns, weights, detail, locked, even, channel):
    n_free, total, origin = 0, 0.0, 0.0
    for k in range(first, last):
        if not locked[columns[k]]:
            if n_free == 0:
                origin = even[columns[k], channel]
            n_free += 1
            total += weights[k]
    if n_free == 0:
        return 0.0
    constant = detail / (n_free + 1.0)
    for k in range(first, last):
        if not locked[columns[k]]:
            excess = weights[k] - total / n_free
            constant += excess / (n_free + 1.0) * (even[columns[k], channel] - origin)
    return constant


# indptr (n_odd + 1,) int64, columns (nnz,) int32, weights (nnz,), details (n_odd, n_channels),
# locked (n_even,) bool; even (n_even, n_channels) float64, changed
@kernel
def add_ring_means(indptr, columns, weights, details, locked, even):
    for row in range(details.shape[0]):
        for channel in range(details.shape[1]):
            constant = ring_constant(
                indptr[row], indptr[row + 1], columns, weights, details[row, channel], locked,
                even, channel,
            )  # fmt: skip
            for k in range(indptr[row], indptr[row + 1]):
                if not locked[columns[k]]:
                    even[columns[k], channel] += constant


@kernel
def subtract_ring_means(indptr, columns, weights, details, locked, even):
    for row in range(details.shape[0] - 1, -1, -1):
        for channel in range(details.shape[1]):
            constant = ring_constant(
                indptr[row], indptr[row + 1], columns, weights, details[row, channel], locked,
                even, channel,
            )  # fmt: skip
            for k in range(indptr[row], indptr[row + 1]):
                if not locked[columns[k]]:
                    even[columns[k], channel] -= constant
