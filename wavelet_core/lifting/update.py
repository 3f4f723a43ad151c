"""Update filters: how the details of the odd vertices are handed to the even ones (Eqs. 43-51)."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags  # diags_array is not in SciPy 1.10

from .._kernels.update import (
    add_ring_means,
    minimum_norm_changes,
    minimum_norm_columns,
    spread_integrals,
    subtract_ring_means,
)
from .._table import Table
from .._validate import FloatArray


def coarse_integrals(
    prediction: csr_array, odd_integrals: FloatArray, even_integrals: FloatArray
) -> FloatArray:
    """Return the integrals of the coarse scaling functions (Eqs. 23 and 47)."""
    # one entry after the other, as `update_heights` adds them: the bits are the same
    integrals = np.array(even_integrals, dtype=np.float64)
    spread_integrals(
        prediction.indptr.astype(np.int64),
        prediction.indices,
        prediction.data,
        odd_integrals,
        integrals,
    )
    return integrals


class Support(NamedTuple):
    """What the filters need to know of one step.

    prediction : csr_array, (n_odd, n_even)
    odd_integrals : (n_odd,), of the odd vertices' scaling functions on the finer level
    integrals : (n_even,), on the coarser level
    locked : (n_even,) bool, vertices whose coefficients must not change
    """

    prediction: csr_array
    odd_integrals: FloatArray
    integrals: FloatArray
    locked: NDArray[np.bool_]


def update_filter(
    method: str,
    prediction: csr_array,
    odd_integrals: FloatArray,
    integrals: FloatArray,
    locked: NDArray[np.bool_],
) -> csr_array:
    """Return the update filter U, ``(n_even, n_odd)``: what multiplies the details.

    Parameters
    ----------
    method : str
        A name out of :data:`UPDATES`.
    prediction : csr_array, shape (n_odd, n_even)
    odd_integrals : ndarray, shape (n_odd,)
        Integrals of the odd vertices' scaling functions on the finer level.
    integrals : ndarray, shape (n_even,)
        Integrals on the coarser level.
    locked : ndarray of bool, shape (n_even,)
        Vertices whose coefficients must not change: their rows are empty.

    Raises
    ------
    OptionError
        A name that the table does not hold.

    Notes
    -----
    The support of column k is the unlocked part of row k of P (entries stored as 0 included).
    """
    return UPDATES.find(method).filter(Support(prediction, odd_integrals, integrals, locked))


def update_changes(method: str, support: Support, details: FloatArray) -> FloatArray:
    """Return U @ details, ``(n_even, n_channels)``: what an update adds to the even coefficients.

    Parameters
    ----------
    method : str
        A name out of :data:`UPDATES`, of an update that is no sequence.
    support : Support
    details : ndarray, shape (n_odd, n_channels)
    """
    update = UPDATES.find(method)
    if update.changes is not None:
        return update.changes(support, details)
    return update.filter(support) @ details


# -- the filters ---------------------------------------------------------------------------------


def none(support: Support) -> csr_array:
    """Return no entries: the even coefficients stay as they are."""
    n_odd, n_even = support.prediction.shape
    return csr_array((n_even, n_odd))


def martinez_ortega(support: Support) -> csr_array:
    """Return 0.5 p / Σ p over the odd neighbours of each even vertex (Eq. 43)."""
    prediction, n_even = support.prediction, support.prediction.shape[1]
    sums = prediction.sum(axis=0)
    is_used = (sums != 0) & ~support.locked
    scale = np.divide(0.5, sums, out=np.zeros(n_even), where=is_used)
    return csr_array(diags(scale) @ prediction.T)


def one_ring_mean(support: Support) -> csr_array:
    """Return 1 / (N + 1) on the ring of N: the part of Eq. 46 that multiplies the details.

    The part in the even coefficients is applied by :func:`apply_ring_means`.
    """
    prediction = support.prediction
    n_odd = prediction.shape[0]
    rows = np.repeat(np.arange(n_odd), np.diff(prediction.indptr))
    is_free = ~support.locked[prediction.indices]
    n_free = np.bincount(rows[is_free], minlength=n_odd)
    return _columns(prediction, is_free / (n_free[rows] + 1.0))


def minimum_norm(support: Support) -> csr_array:
    r"""Return :math:`\zeta_{l+1,o}\, \zeta_l / \|\zeta_l\|^2` over the support (Eq. 50).

    So :math:`\sum \zeta s` is the same on every level.
    """
    prediction = support.prediction
    values = np.zeros(len(prediction.indices))
    minimum_norm_columns(
        prediction.indptr.astype(np.int64),
        prediction.indices,
        support.odd_integrals,
        support.integrals,
        support.locked,
        values,
    )
    return _columns(prediction, values)


def minimum_norm_applied(support: Support, details: FloatArray) -> FloatArray:
    """Return U @ details of :func:`minimum_norm`, without its U."""
    prediction = support.prediction
    changes = np.zeros((len(support.integrals), details.shape[1]))
    minimum_norm_changes(
        prediction.indptr.astype(np.int64),
        prediction.indices,
        support.odd_integrals,
        support.integrals,
        support.locked,
        np.ascontiguousarray(details),
        changes,
    )
    return changes


def _columns(prediction: csr_array, values: FloatArray) -> csr_array:
    """Return U with the pattern of Pᵀ and values in the order of P."""
    pattern = csr_array((values, prediction.indices, prediction.indptr), shape=prediction.shape)
    return csr_array(pattern.T)


def apply_ring_means(
    even: FloatArray,
    details: FloatArray,
    prediction: csr_array,
    locked: NDArray[np.bool_],
    *,
    undo: bool = False,
) -> FloatArray:
    r"""Return the even coefficients after the one-ring-mean update, or before it with ``undo``.

    Parameters
    ----------
    even : ndarray, shape (n_even, n_channels)
    details : ndarray, shape (n_odd, n_channels)
    prediction : csr_array, shape (n_odd, n_even)
    locked : ndarray of bool, shape (n_even,)
    undo : bool
        Take the odd vertices in reverse order and subtract.

    Notes
    -----
    Eq. 46 adds :math:`w/(N+1) + \sum (N p_m - 1) / (N (N+1))\, s_m` to the whole ring of each odd
    vertex. *Our choice:* one odd vertex after the other, in removal order. The added constant
    cancels in the sum, because :math:`\sum (N p_m - 1) = 0`, so the same formula in reverse order
    undoes it exactly. Locked vertices are left out of the ring, and p is shifted to sum to 1 over
    the rest (rescaling would divide by a sum that may vanish where weights have either sign).
    """
    result = np.array(even, dtype=np.float64, order="C")
    kernel = subtract_ring_means if undo else add_ring_means
    kernel(
        prediction.indptr.astype(np.int64),
        prediction.indices,
        prediction.data,
        np.ascontiguousarray(details),
        locked,
        result,
    )
    return result


# -- the table -----------------------------------------------------------------------------------


class Update(NamedTuple):
    """One update filter: a row of :data:`UPDATES`.

    name, short : str, what `analyse` takes
    filter : callable, from a Support to U, (n_even, n_odd)
    help : str, one line for lists
    equation : str, its number in the paper; empty for what is beyond the paper
    is_empty : bool, whether nothing is updated
    is_sequential : bool, whether it is applied vertex by vertex, by `apply_ring_means`
    uses_integrals : bool, whether the integrals of the scaling functions enter
    divides_by_sums : bool, whether it divides by sums of prediction weights, which must then be of
        one sign
    changes : callable, from a Support and details to U @ details, where that is quicker without U
    """

    name: str
    short: str
    filter: Callable[[Support], csr_array]
    help: str
    equation: str = ""
    is_empty: bool = False
    is_sequential: bool = False
    uses_integrals: bool = False
    divides_by_sums: bool = False
    changes: Callable[[Support, FloatArray], FloatArray] | None = None


#: The update filters. A new one is a function above and a row here, and no more.
UPDATES = Table(
    "update",
    (
        Update(
            "minimum_norm", "MN", minimum_norm,
            "keeps the weighted mean height at every level", "Eq. 50",
            uses_integrals=True, changes=minimum_norm_applied,
        ),
        Update(
            "martinez_ortega", "MO", martinez_ortega,
            "half the mean detail of the odd neighbours, by their prediction weights", "Eq. 43",
            divides_by_sums=True,
        ),
        Update(
            "one_ring_mean", "ORMP", one_ring_mean,
            "keeps the mean of each removed vertex's ring", "Eq. 46",
            is_sequential=True,
        ),
        Update(
            "none", "NONE", none,
            "the vertices that stay keep their heights (subsampling)",
            is_empty=True,
        ),
    ),
)  # fmt: skip
