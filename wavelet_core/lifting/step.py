"""One level of the lifting scheme: analysis (Eqs. 30-31) and synthesis (Eqs. 32-33)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .._kernels._jit import run_in_ranges
from .._kernels.update import predict_rows
from .._threads import put_rows
from .._validate import FloatArray, are_equal, counted, owned
from .update import UPDATES, Support, apply_ring_means, coarse_integrals, update_changes


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Step:
    """One analysis step, from level l + 1 to level l.

    Ids are those of the vertices of the finer mesh; the even ones are all that are not odd, in
    ascending order, which is also their order in the coarser mesh.

    Attributes
    ----------
    odd : ndarray of int32, shape (n_odd,)
        Removed vertices in the order of their removal.
    target : ndarray of int32, shape (n_odd,)
        The even vertex that each odd one collapsed onto.
    indptr, indices, weights : ndarray
        The prediction filter P in CSR: rows in the order of ``odd``, columns in that of the even
        vertices.
    details : ndarray, shape (n_odd, n_channels)
        Detail vectors w, in the units of the input.
    """

    odd: NDArray[np.int32]
    target: NDArray[np.int32]
    indptr: NDArray[np.int64]
    indices: NDArray[np.int32]
    weights: FloatArray
    details: FloatArray

    def __eq__(self, other: object) -> bool:
        return are_equal(self, other) if isinstance(other, Step) else NotImplemented

    __hash__ = None  # type: ignore[assignment]  # as for meshes

    def __repr__(self) -> str:
        channels = counted(self.details.shape[1], "channel")
        return f"<Step {counted(self.n_odd, 'odd vertex', 'odd vertices')}, {channels}>"

    def owned(self) -> Step:
        """Return the step with arrays that nobody can change; the caller's stay as they are."""
        return Step(
            owned(self.odd, np.int32),
            owned(self.target, np.int32),
            owned(self.indptr, np.int64),
            owned(self.indices, np.int32),
            owned(self.weights, np.float64),
            owned(self.details, np.float64),
        )

    @property
    def n_odd(self) -> int:
        """Number of vertices that the step removes."""
        return len(self.odd)

    def prediction(self, n_even: int) -> csr_array:
        """Return the prediction filter, ``(n_odd, n_even)``."""
        return csr_array((self.weights, self.indices, self.indptr), shape=(len(self.odd), n_even))


class FilterPair(NamedTuple):
    """The filters of one step, and the order of their rows and columns.

    prediction : csr_array, (n_odd, n_even); update : csr_array, (n_even, n_odd)
    odd, even : ids in the finer mesh
    """

    prediction: csr_array
    update: csr_array
    odd: NDArray[np.int32]
    even: NDArray[np.int32]


def predicted(prediction: csr_array, coarse: FloatArray) -> FloatArray:
    """Return P @ coarse: what the odd vertices are predicted, ``(n_odd, n_channels)``."""
    rows = np.empty((prediction.shape[0], coarse.shape[1]))
    run_in_ranges(
        predict_rows,
        len(rows),
        prediction.indptr.astype(np.int64),
        prediction.indices,
        prediction.data,
        np.ascontiguousarray(coarse),
        rows,
    )
    return rows


def split_integrals(
    integrals: FloatArray, odd: NDArray[np.int32], even: NDArray[np.int32], prediction: csr_array
) -> tuple[FloatArray, FloatArray]:
    """Return the integrals of the odd vertices (finer level) and of the coarser level (Eq. 47)."""
    odd_integrals = integrals[odd]
    return odd_integrals, coarse_integrals(prediction, odd_integrals, integrals[even])


def analyse_level(
    fine: FloatArray,
    odd: NDArray[np.int32],
    even: NDArray[np.int32],
    prediction: csr_array,
    method: str,
    integrals: FloatArray,
    locked: NDArray[np.bool_],
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return coarse coefficients, details and coarse integrals of one step.

    Parameters
    ----------
    fine : ndarray, shape (n_vertices, n_channels)
        Scaling coefficients of the finer level.
    odd, even : ndarray of int32
    prediction : csr_array, shape (n_odd, n_even)
    method : str
        Update filter.
    integrals : ndarray, shape (n_vertices,)
        Integrals of the finer level's scaling functions.
    locked : ndarray of bool, shape (n_vertices,)
    """
    odd_integrals, coarser = split_integrals(integrals, odd, even, prediction)
    coarse = fine[even]
    details = fine[odd] - predicted(prediction, coarse)  # Eq. 30
    update = UPDATES.find(method)
    if update.is_sequential:
        coarse = apply_ring_means(coarse, details, prediction, locked[even])
    elif not update.is_empty:
        support = Support(prediction, odd_integrals, coarser, locked[even])
        coarse = coarse + update_changes(method, support, details)  # Eq. 31
    return coarse, details, coarser


def synthesise_level(
    coarse: FloatArray,
    details: FloatArray,
    odd: NDArray[np.int32],
    even: NDArray[np.int32],
    prediction: csr_array,
    method: str,
    integrals: FloatArray,
    locked: NDArray[np.bool_],
    coarser: FloatArray | None = None,
) -> FloatArray:
    """Return the scaling coefficients of the finer level: the mirror of :func:`analyse_level`.

    ``coarser`` are the integrals of the coarser level, where they are known.
    """
    update = UPDATES.find(method)
    if update.is_sequential:
        coarse = apply_ring_means(coarse, details, prediction, locked[even], undo=True)
    elif not update.is_empty:
        if coarser is None:
            coarser = split_integrals(integrals, odd, even, prediction)[1]
        support = Support(prediction, integrals[odd], coarser, locked[even])
        coarse = coarse - update_changes(method, support, details)  # Eq. 32
    fine = np.empty((len(odd) + len(even), coarse.shape[1]))
    put_rows(fine, even, coarse)
    put_rows(fine, odd, details + predicted(prediction, coarse))  # Eq. 33
    return fine
