"""The errors of every level at few points, without meshes of whole levels."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.metrics import find_faces_near
from .._validate import FloatArray
from ..lifting.pyramid import Pyramid
from ..mesh.location import surface_errors
from ..mesh.triangle_mesh import TriangleMesh

__all__ = ["errors_by_level"]

#: Cells along the longer side of the extent of the points: faces are near that share one with them.
N_CELLS = 2048


def errors_by_level(pyramid: Pyramid, points: FloatArray) -> Iterator[FloatArray]:
    """Yield the vertical distance of points from the surface of each level, the coarsest first.

    Parameters
    ----------
    pyramid : Pyramid
        With signal "z".
    points : (n_points, 3) float64
        Few beside the vertices: of each level, the faces near them are kept.

    Yields
    ------
    (n_points,) float64
        As of `wavelet_core.metrics.surface_errors`, of whole levels.
    """
    assert pyramid.horizontal is not None
    ids = pyramid._ids_by_level(0)
    near = _faces_near(pyramid, ids, points)
    lone = _lone_vertices(pyramid)
    for level, coefficients in pyramid._coefficients(ids, slice(1)):  # of heights alone
        corners = near.pop().ravel()
        vertices = np.concatenate([corners, np.searchsorted(ids[level], lone)])
        used, places = np.unique(vertices, return_inverse=True)
        faces = places[: len(corners)].reshape(-1, 3)
        points_of = np.column_stack([pyramid.horizontal[ids[level][used]], coefficients[used, 0]])
        part = TriangleMesh._trusted(points_of, faces, np.empty((len(used), 0)), ())
        yield surface_errors(part, points)


def _lone_vertices(pyramid: Pyramid) -> NDArray[np.int64]:
    """Return the vertices without faces: the same in all levels, since none goes or joins them."""
    is_lone = np.ones(pyramid.n_vertices(pyramid.n_levels), dtype=bool)
    is_lone[pyramid.faces] = False
    return np.flatnonzero(is_lone)


def _faces_near(
    pyramid: Pyramid, ids: dict[int, NDArray[np.int32]], points: FloatArray
) -> list[NDArray[np.int32]]:
    """Return the faces of each level whose bounds share a cell with a point, the finest first."""
    assert pyramid.horizontal is not None
    low = points[:, :2].min(axis=0)
    extent = points[:, :2].max(axis=0) - low
    size = float(extent.max()) / N_CELLS or 1.0
    columns, rows = np.floor((points[:, :2] - low) / size).astype(np.int64).T
    counts = np.zeros((rows.max() + 2, columns.max() + 2), dtype=np.int64)
    np.add.at(counts, (rows + 1, columns + 1), 1)
    counts = counts.cumsum(axis=0).cumsum(axis=1)  # of the cells below and to the left
    x, y = (np.ascontiguousarray(pyramid.horizontal[:, k]) for k in (0, 1))
    near = []
    for level, faces in zip(
        range(pyramid.n_levels, -1, -1), pyramid._faces_downwards(), strict=True
    ):
        is_near = np.empty(len(faces), dtype=bool)
        run_in_ranges(
            find_faces_near, len(faces), faces, ids[level], x, y, low[0], low[1], size, counts,
            is_near,
        )  # fmt: skip
        near.append(faces[is_near])
    return near
