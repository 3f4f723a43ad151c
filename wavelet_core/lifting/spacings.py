"""How far apart the vertices of each level are: the sizes that its details are of."""

from __future__ import annotations

import numpy as np

from .._validate import FloatArray
from ..mesh.triangle_mesh import TriangleMesh
from .pyramid import Pyramid


def level_spacings(pyramid: Pyramid) -> FloatArray:
    """Return the median length, in plan, of the edges of every level, ``(L + 1,)``.

    Parameters
    ----------
    pyramid : Pyramid

    Returns
    -------
    ndarray, shape (L + 1,)
        In the unit of x and y, level 0 first; NaN for a level without faces. The details of level
        l are at home at the spacing of level l + 1.

    Examples
    --------
    >>> from wavelet_core import analyse, level_spacings, synthetic
    >>> pyramid = analyse(synthetic.hills(20, 30, cell=10.0), levels=6, partition="quadric")
    >>> spacings = level_spacings(pyramid)
    >>> float(spacings[-1]), bool(spacings[0] > 15)
    (10.0, True)
    """
    spacings = np.full(pyramid.n_levels + 1, np.nan)
    for level, mesh in enumerate(pyramid):
        spacings[level] = mesh_spacing(mesh)
    return spacings


def mesh_spacing(mesh: TriangleMesh) -> float:
    """Return the median length, in plan, of the edges of a mesh; NaN without faces."""
    if not mesh.n_faces:
        return float("nan")
    corners = mesh.vertices[mesh.faces, :2]
    sides = corners - corners[:, [1, 2, 0]]
    return float(np.median(np.hypot(sides[..., 0], sides[..., 1])))
