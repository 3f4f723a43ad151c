"""The least of a quadratic form within bounds, to the same bytes for any number of threads.

The sums of BLAS and LAPACK, and so the solvers of NumPy and SciPy, depend on the number of
threads in their last digits. Nothing here calls them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray

#: A gradient smaller than this, relative to the pull, opens no bound.
TOLERANCE = 1e-10
#: Bounds that are opened one by one, for each unknown.
MOST_STEPS = 10
#: Rows whose products are summed at once.
ROWS_AT_ONCE = 4096
#: Blocks between two ticks: a pass over a large mesh takes as long as hundreds of blocks.
BLOCKS_OF_TICK = 16


def moments_of(columns: FloatArray, tick: Callable[[], None] = lambda: None) -> FloatArray:
    """Return the sums of the products of every two columns, ``(n_columns, n_columns)``.

    Parameters
    ----------
    columns : ndarray, shape (n_rows, n_columns)
    tick : callable
        Called now and then; it may raise, to stop.
    """
    n_rows, n_columns = columns.shape
    moments = np.zeros((n_columns, n_columns))
    for first in range(0, n_rows, ROWS_AT_ONCE):
        block = np.ascontiguousarray(columns[first : first + ROWS_AT_ONCE].T)
        for k in range(n_columns):
            moments[k, : k + 1] += np.einsum("jv,v->j", block[: k + 1], block[k])
        if (first // ROWS_AT_ONCE + 1) % BLOCKS_OF_TICK == 0:
            tick()
    return np.tril(moments) + np.tril(moments, -1).T


def ticks_of_moments(n_rows: int) -> int:
    """Return how often `moments_of` ticks."""
    return -(-n_rows // ROWS_AT_ONCE) // BLOCKS_OF_TICK


def solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Return x with ``matrix x = right``, by Cholesky's factors.

    Parameters
    ----------
    matrix : ndarray, shape (n, n)
        Symmetric and positive definite.
    right : ndarray, shape (n,)

    Examples
    --------
    >>> solved(np.array([[4.0, 2.0], [2.0, 3.0]]), np.array([2.0, 5.0])).round(12).tolist()
    [-0.5, 2.0]
    """
    left, found = matrix.copy(), right.copy()
    n = len(found)
    for k in range(n):
        left[k:, k] /= np.sqrt(left[k, k])
        below = left[k + 1 :, k]
        left[k + 1 :, k + 1 :] -= below[:, None] * below
        found[k] /= left[k, k]
        found[k + 1 :] -= below * found[k]
    for k in range(n - 1, -1, -1):
        found[k] /= left[k, k]
        found[:k] -= left[k, :k] * found[k]
    return found


def least_within(
    matrix: FloatArray, pull: FloatArray, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, float]:
    """Return the x within bounds of the least ``x' matrix x / 2 - pull x``, and that least value.

    Parameters
    ----------
    matrix : ndarray, shape (n, n)
        Symmetric and positive definite.
    pull, low, high : ndarray, shape (n,)
        The lower bounds are below the upper ones.

    References
    ----------
    P. B. Stark, R. L. Parker: Bounded-variable least-squares: an algorithm and applications.
    Computational Statistics 10, 1995.
    """
    x = np.zeros(len(pull))
    held = np.zeros(len(pull), dtype=np.int64)  # -1 at the lower bound, 1 at the upper one
    while True:  # hold all that is beyond a bound, until nothing is
        is_free = held == 0
        wanted = _solved_for(matrix, pull, x, is_free)
        beyond = np.where(wanted > high, 1, np.where(wanted < low, -1, 0)) * is_free
        x = np.where(is_free, np.clip(wanted, low, high), x)
        if not beyond.any():
            break
        held += beyond
    least = TOLERANCE * float(np.abs(pull).max(initial=0.0))
    for _ in range(MOST_STEPS * len(pull)):
        outward = (_times(matrix, x) - pull) * held  # above 0: the form falls away from the bound
        opened = int(np.argmax(outward))
        if outward[opened] <= least:
            break
        held[opened] = 0
        x = _settled(matrix, pull, x, held, low, high)
    return x, float(np.sum(x * (0.5 * _times(matrix, x) - pull)))


def _settled(
    matrix: FloatArray,
    pull: FloatArray,
    x: FloatArray,
    held: NDArray[np.int64],
    low: FloatArray,
    high: FloatArray,
) -> FloatArray:
    """Go from x towards the least of the free unknowns; what meets a bound is held, in place."""
    while True:
        is_free = held == 0
        wanted = _solved_for(matrix, pull, x, is_free)
        bound = np.where(wanted > high, high, low)
        beyond = is_free & ((wanted > high) | (wanted < low))
        if not beyond.any():
            return wanted
        shares = np.full(len(x), np.inf)
        shares[beyond] = (bound - x)[beyond] / (wanted - x)[beyond]
        first = int(np.argmin(shares))
        x = np.clip(x + shares[first] * (wanted - x), low, high)
        x[first] = bound[first]
        held[first] = 1 if bound[first] == high[first] else -1


def _solved_for(
    matrix: FloatArray, pull: FloatArray, x: FloatArray, is_free: NDArray[np.bool_]
) -> FloatArray:
    """Return x with the free unknowns at their least, the others as they are."""
    found = x.copy()
    if is_free.any():
        rest = pull - _times(matrix, np.where(is_free, 0.0, x))
        found[is_free] = solved(matrix[np.ix_(is_free, is_free)], rest[is_free])
    return found


def _times(matrix: FloatArray, x: FloatArray) -> FloatArray:
    product: FloatArray = np.einsum("ij,j->i", matrix, x)
    return product
