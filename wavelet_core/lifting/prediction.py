"""Prediction filters: how an odd vertex is estimated from its even one-ring (Eqs. 39-42)."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .._kernels._jit import Kernel, run_in_ranges
from .._kernels.prediction import (
    cotangent_weights,
    covering_faces,
    geometric_weights,
    least_squares_weights,
    nnls_weights,
    plane_weights,
    ring_columns,
)
from .._table import Table
from .._validate import FloatArray
from ..mesh.connectivity import Connectivity


class Removal(NamedTuple):
    """What the filters need to know of one step.

    points : (n_vertices, d) float64, normalised x, y, z and attributes of the finer level
    plan : (n_vertices, 2) float64, x and y in the input's proportions
    connectivity : of the finer level
    odd, target : (n_odd,) int32, removed vertices and where each collapsed to
    even : (n_even,) int32, ascending
    locked : (n_vertices,) bool
    """

    points: FloatArray
    plan: FloatArray
    connectivity: Connectivity
    odd: NDArray[np.int32]
    target: NDArray[np.int32]
    even: NDArray[np.int32]
    locked: NDArray[np.bool_]

    @property
    def even_position(self) -> NDArray[np.int32]:
        """Position of every vertex among the even ones; -1 for odd ones."""
        position = np.full(len(self.points), -1, dtype=np.int32)
        position[self.even] = np.arange(len(self.even), dtype=np.int32)
        return position


def predict(method: str, removal: Removal) -> csr_array:
    """Return the prediction filter P, ``(n_odd, n_even)``; its rows sum to one.

    Parameters
    ----------
    method : str
        A name out of :data:`PREDICTIONS`.
    removal : Removal

    Raises
    ------
    OptionError
        A name that the table does not hold.
    """
    return PREDICTIONS.find(method).filter(removal)


# -- the filters ---------------------------------------------------------------------------------
#
# With w_m the weight of neighbour m, p_m = w_m / sum of all w (Eq. 41).


def uniform(removal: Removal) -> csr_array:
    """Return equal weights."""
    rows = _ring_rows(removal)
    sizes = np.diff(rows.indptr)
    return _matrix(removal, rows, np.repeat(1.0 / np.maximum(sizes, 1), sizes))


def cotangent(removal: Removal) -> csr_array:
    """Return weights cot α + cot β of the angles opposite the edge, in normalised x, y, z.

    *Our choice:* a negative sum counts as 0, and a star where all are is predicted uniformly; left
    alone such stars give weights without bound.
    """
    return _by_kernel(cotangent_weights, removal, removal.connectivity.kind, removal.points)


def geometric(removal: Removal) -> csr_array:
    """Return weights of one over the edge's length, in coordinates and attributes (Eq. 42)."""
    return _by_kernel(geometric_weights, removal, removal.points)


def nnls(removal: Removal) -> csr_array:
    """Return the non-negative weights of sum one that leave the smallest detail vector.

    *Our choice:* a damping of 1e-8 of the squared ring size makes them unique where several sets
    are equally good.
    """
    return _by_kernel(nnls_weights, removal, removal.points, called="the prediction nnls (NNLS)")


def least_squares(removal: Removal) -> csr_array:
    """Return as :func:`nnls`, damping included, weights of any sign: the paper's baseline."""
    return _by_kernel(
        least_squares_weights,
        removal,
        removal.points,
        called="the prediction least_squares (LS)",
    )


def plane(removal: Removal) -> csr_array:
    """Return the weights that give the value, at the vertex, of the plane fitted to its ring.

    Any tilted plane has zero details (two vanishing moments), and of all weights that do so these
    have the least norm. A vertex lies within the hull of its upright ring, where convex weights
    do it too, so the squared norm is at most 1 and noise is never amplified. *Our choice:* even
    weights where signal "xyz" has folded the ring.
    """
    return _by_kernel(plane_weights, removal, removal.plan)


def barycentric(removal: Removal) -> csr_array:
    """Return the coordinates of the vertex, in plan, in the coarse face that now covers it.

    So the detail is its vertical distance from the coarse surface. The row also names the rest of
    the ring where all three corners are locked, with weight 0, so that the update has somewhere
    to go.
    """
    odd, connectivity = removal.odd, removal.connectivity
    corners = np.empty((len(odd), 3), dtype=np.int32)
    weights = np.empty((len(odd), 3))
    run_in_ranges(
        covering_faces,
        len(odd),
        odd,
        removal.target,
        connectivity.star_indptr,
        connectivity.ring,
        connectivity.ring_size,
        connectivity.kind,
        removal.plan,
        corners,
        weights,
    )
    position = removal.even_position
    row_indptr = np.arange(0, 3 * len(odd) + 1, 3, dtype=np.int64)
    columns, data = position[corners].ravel(), weights.ravel()
    stuck = np.flatnonzero(removal.locked[corners].all(axis=1))
    if len(stuck):
        columns, data, row_indptr = _with_unlocked_ring(removal, stuck, columns, data)
    return csr_array((data, columns, row_indptr), shape=(len(odd), len(removal.even)))


class _RingRows(NamedTuple):
    """Rows of P over the one-rings: CSR without its data."""

    indptr: NDArray[np.int64]
    columns: NDArray[np.int32]


def _ring_rows(removal: Removal) -> _RingRows:
    odd, connectivity = removal.odd, removal.connectivity
    indptr = np.zeros(len(odd) + 1, dtype=np.int64)
    np.cumsum(connectivity.ring_size[odd], out=indptr[1:])
    columns = np.empty(indptr[-1], dtype=np.int32)
    rings = (connectivity.star_indptr, connectivity.ring)
    run_in_ranges(ring_columns, len(odd), odd, indptr, *rings, removal.even_position, columns)
    return _RingRows(indptr, columns)


def _by_kernel(
    kernel: Kernel, removal: Removal, *arguments: NDArray, called: str = ""
) -> csr_array:
    """Return P with the weights that a kernel gives the ring of each odd vertex."""
    rows, connectivity = _ring_rows(removal), removal.connectivity
    weights = np.empty(len(rows.columns))
    run_in_ranges(
        kernel,
        len(removal.odd),
        removal.odd,
        rows.indptr,
        connectivity.star_indptr,
        connectivity.ring,
        *arguments,
        weights,
        called=called,
    )
    return _matrix(removal, rows, weights)


def _matrix(removal: Removal, rows: _RingRows, weights: FloatArray) -> csr_array:
    shape = (len(removal.odd), len(removal.even))
    return csr_array((weights, rows.columns, rows.indptr), shape=shape)


def _with_unlocked_ring(
    removal: Removal,
    stuck: NDArray[np.int64],
    columns: NDArray[np.int32],
    data: FloatArray,
) -> tuple[NDArray[np.int32], FloatArray, NDArray[np.int64]]:
    """Add the unlocked ring, with weight 0, to the rows whose three corners are all locked."""
    position = removal.even_position
    counts = np.full(len(removal.odd), 3, dtype=np.int64)
    extra_rows, extra_columns = [], []
    for row in stuck:
        ring = removal.connectivity.one_ring(int(removal.odd[row]))
        free = position[ring[~removal.locked[ring]]]
        counts[row] += len(free)
        extra_rows.append(np.full(len(free), 3 * (row + 1)))
        extra_columns.append(free)
    where = np.concatenate(extra_rows)
    columns = np.insert(columns, where, np.concatenate(extra_columns))
    data = np.insert(data, where, 0.0)
    return columns, data, np.concatenate([[0], np.cumsum(counts)])


# -- the table -----------------------------------------------------------------------------------


class Prediction(NamedTuple):
    """One prediction filter: a row of :data:`PREDICTIONS`.

    name, short : str, what `analyse` takes
    filter : callable, from a Removal to P, (n_odd, n_even), whose rows sum to one
    help : str, one line for lists
    equation : str, its number in the paper; empty for what is beyond the paper
    in_plan : bool, whether it looks at x and y alone
    is_signed : bool, whether weights may be negative, so that a sum of them may vanish
    """

    name: str
    short: str
    filter: Callable[[Removal], csr_array]
    help: str
    equation: str = ""
    in_plan: bool = False
    is_signed: bool = False


#: The prediction filters. A new one is a function above and a row here, and no more: the options,
#: the help of the command line, the dialogs and the tests read the table.
PREDICTIONS = Table(
    "prediction",
    (
        Prediction(
            "geometric", "GL", geometric,
            "one over the distance in coordinates and attributes", "Eq. 42",
        ),
        Prediction("uniform", "UG", uniform, "the mean of the neighbours", "Eq. 41"),
        Prediction(
            "cotangent", "CL", cotangent,
            "cotangents of the angles opposite each edge, not below 0", "Eq. 41",
        ),
        Prediction(
            "nnls", "NNLS", nnls,
            "the non-negative weights that leave the smallest detail", "Eq. 40",
        ),
        Prediction(
            "least_squares", "LS", least_squares,
            "the same with weights of any sign; can be unstable", "Eq. 40",
            is_signed=True,
        ),
        Prediction(
            "barycentric", "BL", barycentric,
            "from the coarse triangle that now covers the vertex",
            in_plan=True,
        ),
        Prediction(
            "plane", "PL", plane,
            "from the plane fitted to the neighbours; slopes have no details",
            in_plan=True, is_signed=True,
        ),
    ),
)  # fmt: skip
