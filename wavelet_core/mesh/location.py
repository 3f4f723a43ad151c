"""Point location in plan: which face covers a point, and how far off the point is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from .._kernels.metrics import cover_points, sort_into_cells
from .._validate import FloatArray, IntArray
from .connectivity import edges_of
from .triangle_mesh import TriangleMesh

#: Points that a cell of the search grid holds on average.
POINTS_PER_CELL = 2


class Cover(NamedTuple):
    """The points that lie on a mesh in plan, and where.

    point, face : (n_covered,) int64
        Index of the point and of the face; where faces overlap in plan, the first one.
    at_b, at_c : (n_covered,) float64
        Barycentric weights of the face's second and third corner.
    """

    point: IntArray
    face: IntArray
    at_b: FloatArray
    at_c: FloatArray


def surface_errors(
    mesh: TriangleMesh, points: FloatArray, cover: Cover | None = None
) -> FloatArray:
    """Return the vertical distance of points from a surface.

    Parameters
    ----------
    mesh : TriangleMesh
        The surface; linear on each face.
    points : ndarray, shape (n_points, 3)
        x, y, z in the unit of the mesh.
    cover : Cover, optional
        What `cover_of` gives for them, where it is known already.

    Returns
    -------
    ndarray, shape (n_points,)
        z of the point minus z of the surface at its x, y; NaN where no face covers it, as where
        x or y is no finite number. Where
        faces overlap in plan, the first one counts. A vertex that no face uses, such as a single
        cell among holes, is surface at its own place.
    """
    points = np.asarray(points, dtype=np.float64)
    cover = cover_of(mesh, points[:, :2]) if cover is None else cover
    z = mesh.vertices[:, 2]
    a, b, c = mesh.faces[cover.face].T
    surface = z[a] + cover.at_b * (z[b] - z[a]) + cover.at_c * (z[c] - z[a])
    errors = np.full(len(points), np.nan)
    errors[cover.point] = points[cover.point, 2] - surface
    if len(cover.point) < len(points):
        _fill_at_lone_vertices(errors, mesh, points)
    return errors


def errors_with_border(mesh: TriangleMesh, points: FloatArray, within: float) -> FloatArray:
    """Return the vertical distance of points from a surface, of those just beside it too.

    Parameters
    ----------
    mesh : TriangleMesh
        The surface; linear on each face.
    points : ndarray, shape (n_points, 3)
        x, y, z in the unit of the mesh.
    within : float
        A point over no face that is no farther than this from the border, or from a vertex that no
        face uses, in plan, is beside the mesh by rounding alone, and is measured there.

    Returns
    -------
    ndarray, shape (n_points,)
        As of `surface_errors`; NaN of points that really have no surface.

    Examples
    --------
    >>> mesh = TriangleMesh([[0, 0, 0], [4, 0, 4], [0, 4, 0]], [[0, 1, 2]])
    >>> places = np.array([[1.0, -1e-7, 3.0], [1.0, -1.0, 3.0]])
    >>> errors_with_border(mesh, places, 1e-6).tolist()
    [2.0, nan]
    """
    errors = surface_errors(mesh, points)
    beside = np.flatnonzero(np.isnan(errors))
    if not len(beside):
        return errors
    heights = _border_heights(mesh, points[beside, :2], within)
    errors[beside] = points[beside, 2] - heights
    return errors


def _border_heights(mesh: TriangleMesh, plan: FloatArray, within: float) -> FloatArray:
    """Return z of the border, or of a vertex that no face uses, at places that near; else NaN."""
    vertices, heights = mesh.vertices, np.full(len(plan), np.nan)
    lone = np.setdiff1d(np.arange(mesh.n_vertices), mesh.faces)
    if len(lone):
        far, nearest = cKDTree(vertices[lone, :2]).query(plan)
        heights[far <= within] = vertices[lone[nearest[far <= within]], 2]
    edges, n_faces = edges_of(mesh.faces)
    tails, heads = (vertices[edges[n_faces == 1, k]] for k in (0, 1))
    # An upright edge, of a vertical face, has no length in plan: the edges that it joins end there.
    has_length = (tails[:, :2] != heads[:, :2]).any(axis=1)
    tails, heads = tails[has_length], heads[has_length]
    # Each edge of the border is a strip of two triangles, and these are laid over the places.
    ahead = (heads - tails)[:, :2]
    ahead *= within / np.hypot(*ahead.T)[:, None]
    aside = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    start, stop = tails[:, :2] - ahead, heads[:, :2] + ahead
    corners = np.stack([start - aside, stop - aside, stop + aside, start + aside], axis=1)
    strip = 4 * np.arange(len(corners), dtype=np.int32)[:, None]
    cover = cover_of(
        TriangleMesh._trusted(
            np.column_stack([corners.reshape(-1, 2), np.zeros(4 * len(corners))]),
            np.concatenate(
                [strip + np.array([0, 1, 2], np.int32), strip + np.array([0, 2, 3], np.int32)]
            ),
            np.empty((4 * len(corners), 0)),
            (),
        ),
        plan,
    )
    tail, head = (ends[cover.face % max(len(tails), 1)] for ends in (tails, heads))
    chord = (head - tail)[:, :2]
    share = ((plan[cover.point] - tail[:, :2]) * chord).sum(axis=1) / (chord**2).sum(axis=1)
    heights[cover.point] = tail[:, 2] + np.clip(share, 0.0, 1.0) * (head[:, 2] - tail[:, 2])
    return heights


def heights_at(mesh: TriangleMesh, plan: FloatArray) -> FloatArray:
    """Return z of a surface at places.

    Parameters
    ----------
    mesh : TriangleMesh
        The surface; linear on each face.
    plan : ndarray, shape (n_points, 2)
        x and y of the places.

    Returns
    -------
    ndarray, shape (n_points,)
        NaN where no face covers the place, and no vertex without faces is there.

    Examples
    --------
    >>> mesh = TriangleMesh([[0, 0, 0], [4, 0, 4], [0, 4, 0]], [[0, 1, 2]])
    >>> heights_at(mesh, np.array([[1.0, 1.0], [4.0, 4.0]])).tolist()
    [1.0, nan]
    """
    return -surface_errors(mesh, np.column_stack([plan, np.zeros(len(plan))]))


def _fill_at_lone_vertices(errors: FloatArray, mesh: TriangleMesh, points: FloatArray) -> None:
    """Give points over no face the error against the vertex without faces that is there."""
    is_lone = np.ones(mesh.n_vertices, dtype=bool)
    is_lone[mesh.faces.reshape(-1)] = False
    lone = mesh.vertices[is_lone]
    if not len(lone):
        return
    over_none = np.flatnonzero(np.isnan(errors))
    places = lone[:, 0] + 1j * lone[:, 1]
    order = np.argsort(places, kind="stable")
    wanted = points[over_none, 0] + 1j * points[over_none, 1]
    at = order[np.minimum(np.searchsorted(places[order], wanted), len(lone) - 1)]
    is_there = places[at] == wanted
    found = over_none[is_there]
    errors[found] = points[found, 2] - lone[at[is_there], 2]


def cover_of(mesh: TriangleMesh, plan: FloatArray) -> Cover:
    """Return which face covers each point, and where in it the point lies.

    Parameters
    ----------
    mesh : TriangleMesh
    plan : ndarray, shape (n_points, 2)
        x and y of the points; one that is not finite lies nowhere.
    """
    is_place = np.isfinite(plan).all(axis=1)
    if not is_place.all():
        rows = np.flatnonzero(is_place)
        cover = cover_of(mesh, plan[rows])
        return cover._replace(point=rows[cover.point])
    face_of = np.full(len(plan), -1, dtype=np.int64)
    weights = np.empty((len(plan), 2))
    if mesh.n_faces > 0 and len(plan) > 0:
        origin = plan.min(axis=0)
        local = np.ascontiguousarray(plan - origin)
        extent = local.max(axis=0)
        n_cells = max(len(plan) // POINTS_PER_CELL, 1)
        area = max(extent[0], 1e-12 * extent[1]) * max(extent[1], 1e-12 * extent[0])
        size = float(np.sqrt(area / n_cells)) or 1.0
        size = max(size, float(extent.max()) / 20_000)
        n_columns, n_rows = (int(side / size) + 1 for side in extent)
        cell_indptr = np.zeros(n_columns * n_rows + 1, dtype=np.int64)
        order = np.empty(len(plan), dtype=np.int64)
        grid = (0.0, 0.0, size, n_columns, n_rows, cell_indptr, order)
        sort_into_cells(local, *grid)
        corners = mesh.vertices[:, :2] - origin
        cover_points(corners, mesh.faces, local, *grid, face_of, weights)
    point = np.flatnonzero(face_of >= 0)
    return Cover(point, face_of[point], weights[point, 0], weights[point, 1])
