"""Generalised quadrics in R^(n+1): build, evaluate, redistribute."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .._kernels._jit import Kernel, run_in_ranges
from .._kernels.quadric import ring_costs, spread_quadrics, star_quadrics, target_costs
from .._validate import FloatArray
from .connectivity import Connectivity


def build_quadrics(
    points: FloatArray, faces: NDArray[np.int32], connectivity: Connectivity
) -> FloatArray:
    """Return for every vertex the summed quadric of its faces (Eq. 35).

    Parameters
    ----------
    points : ndarray, shape (n_vertices, d)
        Normalised coordinates, attributes and bending energy.

    Returns
    -------
    ndarray, shape (n_vertices, (d + 1)(d + 2) / 2)
        Packed: the upper triangle of A by rows, then b, then c, with
        error(p) = pᵀ A p + 2 bᵀ p + c the summed squared distance to the planes (Eq. 34).

    References
    ----------
    M. Garland, P. Heckbert: Simplifying surfaces with color and texture using quadric error
    metrics. IEEE Visualization 1998 (the form for R^n).
    """
    d = points.shape[1]
    quadrics = np.empty((len(points), (d + 1) * (d + 2) // 2))
    run_in_ranges(
        star_quadrics,
        len(points),
        points,
        faces,
        connectivity.star_indptr,
        connectivity.star,
        quadrics,
    )
    return quadrics


def vertex_costs(
    points: FloatArray, quadrics: FloatArray, connectivity: Connectivity
) -> FloatArray:
    """Return the removal cost of every vertex (Eq. 36), 0 where it has no ordered ring."""
    return _costs(ring_costs, points, quadrics, connectivity)


def collapse_costs(
    points: FloatArray, quadrics: FloatArray, connectivity: Connectivity
) -> FloatArray:
    """Return what the cheapest collapse of every vertex costs, 0 where it has no ordered ring.

    That is the least of vᵀ Q(a) v over the neighbours a: the error by which the target of the
    collapse is chosen, instead of the sum over the ring (Eq. 36).
    """
    return _costs(target_costs, points, quadrics, connectivity)


def _costs(
    costs: Kernel, points: FloatArray, quadrics: FloatArray, connectivity: Connectivity
) -> FloatArray:
    cost = np.empty(len(points))
    run_in_ranges(
        costs,
        len(points),
        points,
        quadrics,
        connectivity.star_indptr,
        connectivity.ring,
        connectivity.ring_size,
        cost,
    )
    return cost


def redistribute_quadrics(
    quadrics: FloatArray,
    odd: NDArray[np.int32],
    even: NDArray[np.int32],
    prediction: csr_array,
) -> FloatArray:
    """Return the quadrics of the even vertices after the odd ones passed theirs on (Eqs. 52-53).

    ``quadrics`` is used up: it is changed in place, which saves a copy of the largest array.
    *Our choice:* negative prediction weights count as 0, and a row without a positive one is
    spread evenly, so that no quadric turns indefinite.
    """
    spread_quadrics(odd, even, prediction.indptr, prediction.indices, prediction.data, quadrics)
    return quadrics[even]
