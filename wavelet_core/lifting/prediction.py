"""Prediction filters: how an odd vertex is estimated from its even one-ring (Eqs. 39-42)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .._kernels._jit import run_in_ranges
from .._kernels.prediction import (
    cotangent_weights,
    covering_faces,
    geometric_weights,
    least_squares_weights,
    nnls_weights,
    plane_weights,
    ring_columns,
)
from .._validate import FloatArray
from ..mesh.connectivity import Connectivity

#: Full names of the prediction filters, by the paper's short ones.
PREDICTIONS = {
    "UG": "uniform",
    "CL": "cotangent",
    "GL": "geometric",
    "NNLS": "nnls",
    "LS": "least_squares",
    "BL": "barycentric",
    "PL": "plane",
}


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
    r"""Return the prediction filter P, ``(n_odd, n_even)``; its rows sum to one.

    Parameters
    ----------
    method : str
        A full name out of ``PREDICTIONS``.
    removal : Removal

    Notes
    -----
    With :math:`\omega_m` the weight of neighbour m and :math:`p_m = \omega_m / \sum \omega`
    (Eq. 41):

    - ``uniform`` (UG): all the same.
    - ``cotangent`` (CL): cot α + cot β of the two angles opposite the edge, in normalised x, y,
      z. *Our choice:* a negative sum counts as 0, and a star where all are is predicted
      uniformly; left alone such stars give weights without bound.
    - ``geometric`` (GL): one over the edge's length in the space of coordinates and attributes
      (Eq. 42).
    - ``nnls`` (NNLS): the non-negative weights of sum one that leave the smallest detail vector.
      *Our choice:* a damping of 1e-8 of the squared ring size makes them unique where several
      sets are equally good.
    - ``least_squares`` (LS): as NNLS, damping included, with any sign; the paper's unstable
      baseline.
    - ``barycentric`` (BL; beyond the paper): the coordinates of the vertex, in plan, in the
      coarse face that now covers it, so that the detail is its vertical distance from the
      coarse surface. The row also names the rest of the ring where all three corners are
      locked, with weight 0, so that the update has somewhere to go.
    - ``plane`` (PL; beyond the paper): the value, at the vertex, of the plane fitted to its ring
      by least squares in plan. Any tilted plane has zero details (two vanishing moments), and of
      all weights that do so these have the least norm. A vertex lies within the hull of its
      upright ring, where convex weights do it too, so the squared norm is at most 1 and noise is
      never amplified. *Our choice:* even weights where signal "xyz" has folded the ring.
    """
    if method == "barycentric":
        return _barycentric(removal)
    odd, connectivity = removal.odd, removal.connectivity
    row_indptr = np.zeros(len(odd) + 1, dtype=np.int64)
    np.cumsum(connectivity.ring_size[odd], out=row_indptr[1:])
    columns = np.empty(row_indptr[-1], dtype=np.int32)
    rings = (connectivity.star_indptr, connectivity.ring)
    run_in_ranges(ring_columns, len(odd), odd, row_indptr, *rings, removal.even_position, columns)
    weights = np.empty(len(columns))
    arguments: tuple = (odd, row_indptr, *rings)
    if method == "uniform":
        sizes = np.diff(row_indptr)
        weights = np.repeat(1.0 / np.maximum(sizes, 1), sizes)
    elif method == "cotangent":
        arguments += (connectivity.kind, removal.points, weights)
        run_in_ranges(cotangent_weights, len(odd), *arguments)
    elif method == "plane":
        run_in_ranges(plane_weights, len(odd), *arguments, removal.plan, weights)
    else:
        kernel = {
            "geometric": geometric_weights,
            "nnls": nnls_weights,
            "least_squares": least_squares_weights,
        }[method]
        run_in_ranges(kernel, len(odd), *arguments, removal.points, weights)
    return csr_array((weights, columns, row_indptr), shape=(len(odd), len(removal.even)))


def _barycentric(removal: Removal) -> csr_array:
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
