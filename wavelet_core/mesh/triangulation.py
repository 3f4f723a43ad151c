"""Scattered points to faces: exact duplicates merged, then a Delaunay library."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray, IntArray
from ..errors import MeshError, MissingDependencyError, OptionError

#: A hull face is a sliver when its doubled area is at most this part of its longest edge squared.
SLIVER_TOLERANCE = 1e-9


#: By rule: which way the points of one place are ranked by their heights.
_SIGN_OF_RULE = {"lowest": 1.0, "highest": -1.0, "first": 0.0}


class Merged(NamedTuple):
    """Which points became vertices.

    kept : (n_unique,) int64, ascending indices of the points that stay.
    representative : (n_points,) int64, for each point the position in ``kept`` of its vertex.
    """

    kept: IntArray
    representative: IntArray


def merge_duplicates(points: FloatArray, rule: str = "lowest") -> Merged:
    """Return which of the points that share x and y exactly stand for them.

    Parameters
    ----------
    points : ndarray, shape (n_points, 3)
        x, y and z.
    rule : {"lowest", "highest", "first"}
        Which point of each group is kept, ties going to the first.

    Raises
    ------
    OptionError
        There is no such rule.
    """
    if rule not in _SIGN_OF_RULE:
        raise OptionError(f"duplicates must be one of {', '.join(_SIGN_OF_RULE)}, and is {rule!r}.")
    n_points = len(points)
    order = np.lexsort((_SIGN_OF_RULE[rule] * points[:, 2], points[:, 1], points[:, 0]))
    x, y = points[order, 0], points[order, 1]
    is_first = np.ones(n_points, dtype=bool)
    is_first[1:] = (x[1:] != x[:-1]) | (y[1:] != y[:-1])
    group_of_sorted = np.cumsum(is_first) - 1
    lowest = order[is_first]
    kept = np.sort(lowest)
    position_of_group = np.searchsorted(kept, lowest)
    representative = np.empty(n_points, dtype=np.int64)
    representative[order] = position_of_group[group_of_sorted]
    return Merged(kept, representative)


def delaunay_faces(plan: FloatArray, edges: IntArray | None = None) -> IntArray:
    """Return the Delaunay faces, counter-clockwise, of points that are all different.

    Parameters
    ----------
    plan : ndarray, shape (n_points, 2)
        Horizontal coordinates.
    edges : ndarray of int, shape (n_edges, 2), optional
        Edges that must be in the triangulation (breaklines); they must not cross.

    Raises
    ------
    MeshError
        Fewer than three points, all of them on one line, or constraint edges that cross.
    MissingDependencyError
        pythoncdt is absent and SciPy's Delaunay fails on the points, or there are edges.

    Notes
    -----
    pythoncdt is used (measured in the design notes: 2-3 s a million points, valid on every case
    tried). SciPy's Qhull is the last resort: it works on centred coordinates and its result is
    refused unless every point is used and the Euler count is right.
    """
    if len(plan) < 3:
        raise MeshError(
            f"the points lie at {len(plan)} different places in plan, too few to triangulate; give "
            "at least three."
        )
    _require_not_collinear(plan)
    try:
        import pythoncdt
    except ImportError:
        faces = _qhull_faces(plan, edges)
    else:
        faces = _cdt_faces(pythoncdt, plan, edges)
    if len(faces) == 0:
        raise MeshError("all points lie on one line in plan; a surface needs more than that.")
    return _without_hull_slivers(plan, faces)


def _require_not_collinear(plan: FloatArray) -> None:
    centred = plan - plan.mean(axis=0)
    covariance = np.einsum("vi,vj->ij", centred, centred)  # BLAS: other digits by its threads
    smallest, largest = np.linalg.eigvalsh(covariance)
    if largest == 0 or smallest <= 1e-15 * largest:  # eigenvalues err by eps * largest
        raise MeshError("all points lie on one line in plan; a surface needs more than that.")


def _cdt_faces(pythoncdt: Any, plan: FloatArray, edges: IntArray | None) -> IntArray:
    triangulation = pythoncdt.Triangulation(
        pythoncdt.VertexInsertionOrder.AUTO,
        pythoncdt.IntersectingConstraintEdges.NOT_ALLOWED,
        0.0,
    )
    try:
        triangulation.insert_vertices(np.ascontiguousarray(plan, dtype=np.float64))
    except RuntimeError as error:
        reason = str(error).splitlines()[0]
        raise MeshError(
            f"the points cannot be triangulated ({reason}); some lie closer together than numbers "
            "can tell apart, or far from all others: leave those out."
        ) from error
    if edges is not None and len(edges):
        try:
            triangulation.insert_edges(np.ascontiguousarray(edges, dtype=np.uint32))
        except RuntimeError as error:
            raise MeshError(
                f"constraint edges cannot be inserted ({error}); split them where they cross."
            ) from error
    triangulation.erase_super_triangle()
    triangles = triangulation.triangles_array(copy=False)
    return np.ascontiguousarray(triangles["vertices"], dtype=np.int64)


def _qhull_faces(plan: FloatArray, edges: IntArray | None) -> IntArray:
    if edges is not None and len(edges):
        raise MissingDependencyError(
            "breaklines need pythoncdt; install it with 'pip install pythoncdt'."
        )
    from scipy.spatial import Delaunay

    centred = plan - plan.mean(axis=0)
    faces = Delaunay(centred).simplices.astype(np.int64)
    a, b, c = (centred[faces[:, k]] for k in range(3))
    areas = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    faces[areas < 0] = faces[areas < 0, ::-1]
    directed = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    n_edges = len(np.unique(np.sort(directed, axis=1), axis=0))
    is_disk = len(plan) - n_edges + len(faces) == 1
    if len(np.unique(faces)) != len(plan) or not is_disk or (areas == 0).any():
        raise MissingDependencyError(
            "SciPy's triangulation lost points or has flat faces on this input; "
            "install pythoncdt with 'pip install pythoncdt'."
        )
    return faces


def _without_hull_slivers(plan: FloatArray, faces: IntArray) -> IntArray:
    """Peel faces of no area off the outline, where exact collinearity broke in rounding.

    Only faces with an edge on the outline go, and only while all their vertices keep another
    face; inside, the Delaunay library's exact predicates leave none.
    """
    while True:
        corners = plan[faces]
        sides = np.roll(corners, -1, axis=1) - corners
        doubled_area = sides[:, 0, 0] * -sides[:, 2, 1] + sides[:, 0, 1] * sides[:, 2, 0]
        longest = (sides**2).sum(axis=2).max(axis=1)
        sliver = np.flatnonzero(doubled_area <= SLIVER_TOLERANCE * longest)
        if len(sliver) == 0:
            return faces
        doomed = _peelable(faces, sliver, len(plan))
        if len(doomed) == 0:
            return faces
        faces = np.delete(faces, doomed, axis=0)


def _peelable(faces: IntArray, sliver: IntArray, n_vertices: int) -> NDArray[np.int64]:
    starts, ends = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    keys = np.sort(starts * n_vertices + ends)
    n_faces_of = np.bincount(starts, minlength=n_vertices)
    doomed = []
    for face in sliver:
        reverse = np.roll(faces[face], -1) * n_vertices + faces[face]
        where = np.minimum(np.searchsorted(keys, reverse), len(keys) - 1)
        on_outline = (keys[where] != reverse).any()
        if on_outline and (n_faces_of[faces[face]] > 1).all():
            doomed.append(face)
            n_faces_of[faces[face]] -= 1
    return np.array(doomed, dtype=np.int64)
