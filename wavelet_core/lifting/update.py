"""Update filters: how the details of the odd vertices are handed to the even ones (Eqs. 43-51)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags  # diags_array is not in SciPy 1.10

from .._kernels.update import add_ring_means, subtract_ring_means
from .._validate import FloatArray

#: Full names of the update filters, by the paper's short ones.
UPDATES = {
    "MO": "martinez_ortega",
    "ORMP": "one_ring_mean",
    "MN": "minimum_norm",
    "NONE": "none",
}


def coarse_integrals(
    prediction: csr_array, odd_integrals: FloatArray, even_integrals: FloatArray
) -> FloatArray:
    """Return the integrals of the coarse scaling functions (Eqs. 23 and 47)."""
    return even_integrals + prediction.T @ odd_integrals


def update_filter(
    method: str,
    prediction: csr_array,
    odd_integrals: FloatArray,
    integrals: FloatArray,
    locked: NDArray[np.bool_],
) -> csr_array:
    r"""Return the update filter U, ``(n_even, n_odd)``: what multiplies the details.

    Parameters
    ----------
    method : str
        A full name out of ``UPDATES``.
    prediction : csr_array, shape (n_odd, n_even)
    odd_integrals : ndarray, shape (n_odd,)
        Integrals of the odd vertices' scaling functions on the finer level.
    integrals : ndarray, shape (n_even,)
        Integrals on the coarser level.
    locked : ndarray of bool, shape (n_even,)
        Vertices whose coefficients must not change: their rows are empty.

    Notes
    -----
    The support of column k is the unlocked part of row k of P (entries stored as 0 included).

    - ``martinez_ortega`` (MO, Eq. 43): 0.5 p / Σ p over the odd neighbours of each even vertex.
    - ``one_ring_mean`` (ORMP, Eq. 46): 1 / (N + 1) on the ring of N; the term in the even
      coefficients is applied by :func:`apply_ring_means`.
    - ``minimum_norm`` (MN, Eq. 50): :math:`\zeta_{l+1,o}\, \zeta_l / \|\zeta_l\|^2` over the
      support, so that :math:`\sum \zeta s` is the same on every level.
    - ``none``: no entries; the even coefficients stay as they are.
    """
    n_odd, n_even = prediction.shape
    if method == "none":
        return csr_array((n_even, n_odd))
    rows = np.repeat(np.arange(n_odd), np.diff(prediction.indptr))
    is_free = ~locked[prediction.indices]
    if method == "martinez_ortega":
        sums = prediction.sum(axis=0)
        scale = np.divide(0.5, sums, out=np.zeros(n_even), where=(sums != 0) & ~locked)
        return csr_array(diags(scale) @ prediction.T)
    if method == "one_ring_mean":
        n_free = np.bincount(rows[is_free], minlength=n_odd)
        values = is_free / (n_free[rows] + 1.0)
    else:
        zeta = np.where(is_free, integrals[prediction.indices], 0.0)
        squared = np.bincount(rows, weights=zeta**2, minlength=n_odd)
        factor = np.divide(odd_integrals, squared, out=np.zeros(n_odd), where=squared > 0)
        values = zeta * factor[rows]
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
