"""Scattered points to faces: exact duplicates merged, then a Delaunay library."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._threads import rows_at, run_in_blocks
from .._validate import FloatArray, IntArray, distinct
from ..errors import MeshError, MissingDependencyError, OptionError
from .constraints import with_edges

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
        raise OptionError(
            "{0} is {given!r}; give one of {choices}.",
            "duplicates",
            given=rule,
            choices=", ".join(_SIGN_OF_RULE),
        )
    shared = np.flatnonzero(_may_share_place(points))  # few of many, as a rule
    by_place = np.lexsort(
        (_SIGN_OF_RULE[rule] * points[shared, 2], points[shared, 1], points[shared, 0])
    )
    at = shared[by_place]
    x, y = points[at, 0], points[at, 1]
    is_first = np.ones(len(at), dtype=bool)
    is_first[1:] = (x[1:] != x[:-1]) | (y[1:] != y[:-1])
    chosen = at[is_first]
    stays = np.ones(len(points), dtype=bool)
    stays[shared] = False
    stays[chosen] = True
    representative = np.cumsum(stays) - 1
    representative[at] = representative[chosen][np.cumsum(is_first) - 1]
    return Merged(np.flatnonzero(stays), representative)


def _may_share_place(points: FloatArray) -> NDArray[np.bool_]:
    """Return which points have the x and y of another, and perhaps a few that have not.

    One number is sorted for each point, which takes a fraction of the time of sorting by x and y;
    that two places have the same number is possible, but hardly ever happens.
    """
    number = np.empty(len(points), dtype=np.uint64)

    def mix(start: int, stop: int) -> None:
        plan = points[start:stop, :2] + 0.0  # both zeros are one place
        x, y = np.ascontiguousarray(plan.T).view(np.uint64)
        mixed = (x ^ (x >> np.uint64(32))) * np.uint64(0x9E3779B97F4A7C15)
        mixed = (mixed ^ (mixed >> np.uint64(29)) ^ y) * np.uint64(0xBF58476D1CE4E5B9)
        number[start:stop] = mixed ^ (mixed >> np.uint64(32))

    run_in_blocks(mix, len(points))
    ascending = np.sort(number)
    several = distinct(ascending[1:][ascending[1:] == ascending[:-1]])
    found = np.zeros(len(points), dtype=bool)
    if len(several) == 0:
        return found

    def find(start: int, stop: int) -> None:
        place = np.searchsorted(several, number[start:stop])
        nearest = several[np.minimum(place, len(several) - 1)]
        found[start:stop] = nearest == number[start:stop]

    run_in_blocks(find, len(points))
    return found


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
        pythoncdt is absent, and neither SciPy nor GEOS can triangulate the points.

    Notes
    -----
    pythoncdt is used (measured in the design notes: 2-3 s a million points, valid on every case
    tried). Without it, SciPy's Qhull or, where that fails, GEOS works on centred coordinates; a
    result in which a point or a face is lost or flat is refused. Edges then come in by flips.
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
        centred = plan - plan.mean(axis=0)
        faces = _checked_faces(centred)
        if edges is not None and len(edges):
            faces = with_edges(centred, faces, edges)
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
            f"the points cannot be triangulated ({reason}); some lie closer together than "
            "doubles resolve, or far from all others: leave those out."
        ) from error
    if edges is not None and len(edges):
        try:
            triangulation.insert_edges(np.ascontiguousarray(edges, dtype=np.uint32))
        except RuntimeError as error:
            raise MeshError(
                f"constraint edges cannot be inserted ({error}); split them where they cross."
            ) from error
        triangulation.erase_super_triangle()
        faces = triangulation.triangles_array(copy=False)["vertices"]
        return np.ascontiguousarray(faces, dtype=np.int64)
    return _without_super_triangle(triangulation.triangles_array(copy=False)["vertices"])


def _without_super_triangle(faces: NDArray[np.integer]) -> IntArray:
    """Return the faces without those of the first three vertices, which are then left out.

    The library does that as well, but renumbers the neighbours of all faces too: a fifth of its
    time.
    """

    def rest(start: int, stop: int) -> IntArray:
        block = faces[start:stop].astype(np.int64)
        own: IntArray = block[(block >= 3).all(axis=1)] - 3
        return own

    return np.concatenate([np.empty((0, 3), np.int64), *run_in_blocks(rest, len(faces))])


def _checked_faces(centred: FloatArray) -> IntArray:
    """Return the Delaunay faces, peeled, by the first library that loses nothing."""
    for triangulate in (_qhull_faces, _geos_faces):
        faces = triangulate(centred)
        peeled = _without_hull_slivers(centred, faces)
        if _is_whole(centred, faces, peeled):
            return peeled
    raise MissingDependencyError(
        "the triangulation by SciPy loses points or has flat faces on this input; "
        "install pythoncdt with 'pip install pythoncdt'."
    )


def _qhull_faces(centred: FloatArray) -> IntArray:
    from scipy.spatial import Delaunay

    faces = Delaunay(centred).simplices.astype(np.int64)
    is_clockwise = _doubled_areas(centred, faces) < 0
    faces[is_clockwise] = faces[is_clockwise, ::-1]
    return faces


def _geos_faces(centred: FloatArray) -> IntArray:
    """Return the faces by GEOS; none where shapely is absent."""
    try:
        import shapely
    except ImportError:
        return np.empty((0, 3), dtype=np.int64)
    triangles = shapely.delaunay_triangles(shapely.MultiPoint(centred))
    corners = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3].reshape(-1, 2)
    both = np.concatenate([centred, corners])  # GEOS hands out the numbers that it was given
    _, place = np.unique(both, axis=0, return_inverse=True)
    vertex_of_place = np.empty(len(both), dtype=np.int64)
    vertex_of_place[place.ravel()[: len(centred)]] = np.arange(len(centred))
    faces: IntArray = vertex_of_place[place.ravel()[len(centred) :]].reshape(-1, 3)
    return faces


def _is_whole(centred: FloatArray, faces: IntArray, peeled: IntArray) -> bool:
    """Return whether every point is used, the faces are a disk, and none is flat once peeled."""
    tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    # one number for each edge: rows would be sorted with the interpreter held, for seconds
    n_edges = len(distinct(np.minimum(tails, heads) * len(centred) + np.maximum(tails, heads)))
    if len(distinct(faces)) != len(centred) or len(centred) - n_edges + len(faces) != 1:
        return False
    return len(distinct(peeled)) == len(centred) and bool(
        (_doubled_areas(centred, peeled) > 0).all()
    )


def _doubled_areas(plan: FloatArray, faces: IntArray) -> FloatArray:
    a, b, c = (plan[faces[:, k]] for k in range(3))
    areas: FloatArray = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (
        c[:, 0] - a[:, 0]
    )
    return areas


def _without_hull_slivers(plan: FloatArray, faces: IntArray) -> IntArray:
    """Peel faces of no area off the outline, where exact collinearity broke in rounding.

    Only faces with an edge on the outline go, and only while all their vertices keep another
    face; inside, the Delaunay library's exact predicates leave none.
    """
    while True:
        sliver = _slivers(plan, faces)
        if len(sliver) == 0:
            return faces
        doomed = _peelable(faces, sliver, len(plan))
        if len(doomed) == 0:
            return faces
        faces = np.delete(faces, doomed, axis=0)


def _slivers(plan: FloatArray, faces: IntArray) -> NDArray[np.int64]:
    """Return the faces of no area."""

    def find(start: int, stop: int) -> NDArray[np.int64]:
        corners = plan[faces[start:stop]]
        sides = np.roll(corners, -1, axis=1) - corners
        doubled_area = sides[:, 0, 0] * -sides[:, 2, 1] + sides[:, 0, 1] * sides[:, 2, 0]
        longest = (sides**2).sum(axis=2).max(axis=1)
        return start + np.flatnonzero(doubled_area <= SLIVER_TOLERANCE * longest)

    return np.concatenate([np.empty(0, np.int64), *run_in_blocks(find, len(faces))])


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


def canonical_faces(faces: NDArray[np.integer]) -> NDArray[np.int64]:
    """Return faces in the one order that they alone decide: the lowest vertex first, sorted.

    Examples
    --------
    >>> canonical_faces(np.array([[3, 1, 2], [2, 0, 1]])).tolist()
    [[0, 1, 2], [1, 2, 3]]
    """
    turned = np.empty((len(faces), 3), dtype=np.int64)

    def turn(start: int, stop: int) -> None:
        block = faces[start:stop]
        places = (np.argmin(block, axis=1)[:, None] + np.arange(3)) % 3
        turned[start:stop] = np.take_along_axis(block, places, axis=1)

    run_in_blocks(turn, len(faces))
    # a side that no two faces have in one direction decides alone
    side = turned[:, 0] * (int(turned.max(initial=0)) + 1) + turned[:, 1]
    order = np.argsort(side)
    ascending = rows_at(side, order)
    if (ascending[1:] == ascending[:-1]).any():
        order = np.lexsort((turned[:, 2], turned[:, 1], turned[:, 0]))
    return rows_at(turned, order)
