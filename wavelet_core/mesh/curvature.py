"""Curvature and bending energy at the vertices of a mesh (Algorithm 1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.geometry import bending_energies, total_curvatures
from .._validate import FloatArray
from .connectivity import Connectivity


def squared_curvature_sums(
    points: FloatArray, faces: NDArray[np.int32], connectivity: Connectivity
) -> FloatArray:
    r"""Return :math:`\kappa_1^2 + \kappa_2^2 = 4H^2 - 2K` at every vertex.

    Parameters
    ----------
    points : ndarray, shape (n_vertices, 3 or more)
        Vertices; the first three columns are x, y, z.
    faces : ndarray of int32, shape (n_faces, 3)
    connectivity : Connectivity
        Of the same mesh.

    Returns
    -------
    ndarray, shape (n_vertices,)
        In one over the squared unit of the points.

    Notes
    -----
    K is the angle deficit and H half the length of the cotangent mean-curvature normal, both
    over Meyer's mixed area. *Our choice:* the discrete value may be negative and is then 0; on
    the outline, where neither is defined by the star, it is 0 too.

    References
    ----------
    M. Meyer, M. Desbrun, P. Schröder, A. Barr: Discrete differential-geometry operators for
    triangulated 2-manifolds. Visualization and Mathematics III, 2003.
    """
    curvature = np.empty(len(points))
    run_in_ranges(
        total_curvatures,
        len(points),
        points,
        faces,
        connectivity.star_indptr,
        connectivity.star,
        connectivity.kind,
        curvature,
    )
    return curvature


def bending_energy(
    points: FloatArray, faces: NDArray[np.int32], connectivity: Connectivity
) -> FloatArray:
    """Return the thin-plate energy of the star of every vertex (Algorithm 1, Eq. 38).

    Parameters are those of :func:`squared_curvature_sums`.

    Returns
    -------
    ndarray, shape (n_vertices,)
        Without unit: it does not change when the points are scaled.
    """
    curvature = squared_curvature_sums(points, faces, connectivity)
    energy = np.empty(len(points))
    run_in_ranges(
        bending_energies,
        len(points),
        points,
        faces,
        connectivity.star_indptr,
        connectivity.star,
        curvature,
        energy,
    )
    return energy
