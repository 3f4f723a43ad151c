"""Height above ground: points measured against the TIN of those that were classified as ground."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavelet_core import TriangleMesh
from wavelet_core.mesh.location import surface_errors
from wavelet_gis.errors import InputFileError

__all__ = ["GROUND_CLASS", "height_above_ground"]

#: ASPRS class of ground points.
GROUND_CLASS = 2

#: Heights are rounded to multiples of this (about 1 mm in metres), finer than any scanner ranges.
#: Being a power of two it makes them exact in a float32 dimension up to 16 km.
HEIGHT_STEP = 2.0**-10


def height_above_ground(
    coordinates: NDArray[np.float64], is_ground: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """Height of each point above the TIN of the ground points, in the unit of z.

    Parameters
    ----------
    coordinates : ndarray, shape (n_points, 3)
        x, y (horizontal) and z.
    is_ground : ndarray of bool, shape (n_points,)
        The ground points, class 2 in a LAS file.

    Returns
    -------
    ndarray of float32, shape (n_points,)
        Negative below the ground. Outside the ground's outline the nearest ground point counts.

    Raises
    ------
    InputFileError
        When there are fewer than three ground points.

    Examples
    --------
    >>> import numpy as np
    >>> ground = np.array([[0, 0, 1], [4, 0, 1], [4, 4, 1], [0, 4, 1.0]])
    >>> tree = np.array([[1, 2, 9.5]])
    >>> heights = height_above_ground(np.vstack([ground, tree]), np.arange(5) < 4)
    >>> float(heights[4])
    8.5
    """
    n_ground = int(np.count_nonzero(is_ground))
    if n_ground < 3:
        raise InputFileError(
            "height above ground needs points of class {ground} (ground), and there are "
            "{n_ground}; classify the ground first, or leave hag out of {0}.",
            "attributes",
            ground=GROUND_CLASS,
            n_ground=n_ground,
        )
    # Heights do not change with the origin; differences of small numbers keep their digits.
    origin = np.array([*coordinates[:, :2].min(axis=0), 0.0])
    points = coordinates - origin
    ground = TriangleMesh.from_points(points[is_ground])
    heights = surface_errors(ground, points)
    outside = np.flatnonzero(np.isnan(heights))
    if len(outside):
        from scipy.spatial import cKDTree

        nearest = cKDTree(ground.vertices[:, :2]).query(points[outside, :2], workers=-1)[1]
        heights[outside] = points[outside, 2] - ground.vertices[nearest, 2]
    return (np.rint(heights / HEIGHT_STEP) * HEIGHT_STEP).astype(np.float32)
