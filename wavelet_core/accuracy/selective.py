"""A TIN out of a pyramid that is fine in some places and coarse in others, without cracks.

Every collapse of a pyramid replaces the faces around a vertex by others over the same polygon (or,
where the outline may move, over one that leaves a strip of it out). A
collapse that took faces away which an earlier one had laid has to be undone before that one is;
otherwise collapses know nothing of each other. So any set of collapses that is closed in this sense
may be undone, and what is left are the faces of a valid TIN: the *multi-triangulation* of De
Floriani, Magillo and Puppo [1]_.

References
----------
.. [1] L. De Floriani, P. Magillo, E. Puppo, "Building and traversing a surface at variable
   resolution", IEEE Visualization 1997.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from .._validate import FloatArray, IntArray
from ..errors import OptionError
from ..lifting.pyramid import Pyramid
from ..lifting.step import FilterPair
from ..lifting.update import UPDATES
from ..mesh.location import cover_of
from ..mesh.triangle_mesh import TriangleMesh
from ..progress import Progress, report

__all__ = ["PartialMesh", "is_selective", "mesh_within"]

#: No collapse laid this face, or took it away.
NOBODY = -1


class PartialMesh(NamedTuple):
    """A mesh of a chosen size out of a pyramid.

    mesh : TriangleMesh
    vertex_ids : (n_vertices,) int64, ids of its vertices in the input
    level : int, the level that it is, or else the finest that a part of it comes from
    """

    mesh: TriangleMesh
    vertex_ids: IntArray
    level: int


def is_selective(pyramid: Pyramid) -> bool:
    """Return whether parts of a pyramid can be synthesised by themselves."""
    return pyramid.signal == "z" and not UPDATES.find(pyramid.update).is_sequential


def mesh_within(
    pyramid: Pyramid,
    tolerance: ArrayLike,
    progress: Progress | None = None,
    *,
    keep_points: bool = False,
) -> PartialMesh:
    """Return the coarsest mesh of a pyramid whose errors keep a tolerance that varies by place.

    Parameters
    ----------
    pyramid : Pyramid
        Of signal "z"; by any update but the one-ring mean, unless ``keep_points`` is given.
    tolerance : array_like, shape (n_vertices,)
        The largest vertical distance that each vertex of the input may have from the surface; in
        the unit of z. Infinite where any will do.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    keep_points : bool
        Vertices are input vertices, height and all, whatever an update made of them.

    Returns
    -------
    PartialMesh
        Its level is the finest one that any part of it comes from.

    Raises
    ------
    OptionError
        Tolerances that are no numbers of 0 or more, one for each vertex; or a pyramid whose parts
        cannot be synthesised by themselves.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    Starts with the coarsest level and undoes the collapse that laid a face, and those that it
    depends on, wherever an input vertex is too far from that face. Without an update, and with
    ``keep_points``, the heights are the input's and the result is the smallest there is in the
    pyramid. With an update a height depends on what is undone around it; it is synthesised by the
    steps that are, and measured so. Input vertices that a moved outline leaves outside have no
    error, here as in the errors of the levels.
    """
    points = pyramid.mesh(pyramid.n_levels).vertices
    limits = np.asarray(tolerance, dtype=np.float64)
    if limits.shape != (len(points),) or not (limits >= 0).all():
        raise OptionError(
            "{0} has the shape {shape} or holds numbers that are no distance; give one of 0 or "
            "more for each of {n_vertices} vertices.",
            "tolerance",
            shape=limits.shape,
            n_vertices=len(points),
        )
    if not (is_selective(pyramid) or (keep_points and pyramid.signal == "z")):
        raise OptionError(
            "a tolerance that varies by place needs {0} 'z' and {1} 'minimum_norm' or 'none'; "
            "analyse the input anew.",
            "signal",
            "update",
        )
    history = _history_of(pyramid)
    heights = _Heights(pyramid, keep_points)
    is_undone = np.zeros(len(points), dtype=bool)
    is_there = history.present(is_undone)
    where = _Places(history, points, is_there)
    n_collapses = max(int((history.level >= 0).sum()), 1)
    while True:
        z = heights.at(is_undone)
        offending = where.faces_beyond(z, limits)
        wanted = history.laid_by[offending]
        wanted = wanted[wanted != NOBODY]
        if len(wanted) == 0:  # faces of the input, at heights that an update has moved
            wanted = heights.moved_by(history.corners[offending], is_undone)
        if len(wanted) == 0:
            break
        history.undo(wanted, is_undone)
        before, is_there = is_there, history.present(is_undone)
        where.move(before & ~is_there, is_there & ~before)
        report(progress, float(is_undone.sum()) / n_collapses)
    report(progress, 1.0)
    return _assembled(pyramid, history, heights.columns(is_undone), is_undone, is_there)


class _History(NamedTuple):
    """The faces of all levels of a pyramid, and the collapses that replaced them.

    A collapse is known by the vertex that it removed, ids being those of the finest level.

    corners : (n, 3) int32; laid_by, taken_by : (n,) int32, collapses or NOBODY
    level : (n_vertices,) int32, of the step that removes each vertex; -1 of those that stay
    before : csr_array (n_vertices, n_vertices), row c: the collapses to undo before c
    """

    corners: NDArray[np.int32]
    laid_by: NDArray[np.int32]
    taken_by: NDArray[np.int32]
    level: NDArray[np.int32]
    before: csr_array

    def present(self, is_undone: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return which faces are there: laid (and that not undone), and not taken away."""
        is_laid = (self.laid_by == NOBODY) | ~is_undone[self.laid_by]
        return is_laid & ((self.taken_by == NOBODY) | is_undone[self.taken_by])

    def undo(self, collapses: NDArray[np.int32], is_undone: NDArray[np.bool_]) -> None:
        """Add collapses to those that are undone, and whatever has to be undone before them."""
        front = np.unique(collapses)
        while len(front):
            front = front[~is_undone[front]]
            is_undone[front] = True
            front = np.unique(self.before[front].indices)


def _history_of(pyramid: Pyramid) -> _History:
    n_vertices = pyramid.n_vertices(pyramid.n_levels)
    ids = pyramid._ids_by_level(0)
    level_of = np.full(n_vertices, -1, dtype=np.int32)
    target_of = np.empty(n_vertices, dtype=np.int32)
    faces = pyramid.faces  # of the level, each with the collapse that laid it and its row in all
    laid = np.full(len(faces), NOBODY, dtype=np.int32)
    rows = np.arange(len(faces))
    corners, laid_by, takings = [faces], [laid], []
    n_all = len(faces)
    for level in range(pyramid.n_levels - 1, -1, -1):
        step = pyramid.steps[level]
        odd = ids[level + 1][step.odd]
        level_of[odd] = level
        target_of[odd] = ids[level + 1][step.target]
        is_odd = level_of[faces] == level  # true of at most one corner of a face
        touched = np.flatnonzero(is_odd.any(axis=1))
        corner = is_odd[touched].argmax(axis=1)
        by = faces[touched, corner]
        takings.append(np.column_stack([rows[touched], laid[touched], by]))
        moved = faces[touched]
        moved[np.arange(len(touched)), corner] = target_of[by]
        a, b, c = moved.T
        is_face = (a != b) & (b != c) & (c != a)
        moved, by = moved[is_face], by[is_face]
        faces = np.concatenate([np.delete(faces, touched, axis=0), moved])
        laid = np.concatenate([np.delete(laid, touched), by])
        rows = np.concatenate([np.delete(rows, touched), np.arange(n_all, n_all + len(moved))])
        n_all += len(moved)
        corners.append(moved)
        laid_by.append(by)
    taken_by = np.full(n_all, NOBODY, dtype=np.int32)
    taken, first, then = np.concatenate([np.empty((0, 3), np.int64), *takings]).T
    taken_by[taken] = then
    depends = first != NOBODY
    before = csr_array(
        (np.ones(int(depends.sum()), dtype=bool), (first[depends], then[depends])),
        shape=(n_vertices, n_vertices),
    )
    return _History(np.concatenate(corners), np.concatenate(laid_by), taken_by, level_of, before)


class _Places:
    """In which of the faces that are there each input vertex lies, and where in it."""

    def __init__(self, history: _History, points: FloatArray, is_there: NDArray[np.bool_]) -> None:
        self._history, self._points = history, points
        self._face = np.full(len(points), NOBODY, dtype=np.int64)
        self._weights = np.zeros((len(points), 2))
        # what rounding makes of a point on its face
        self._slack = 4 * np.finfo(np.float64).eps * float(np.abs(points[:, 2]).max(initial=0.0))
        self._locate(np.arange(len(points)), np.flatnonzero(is_there))

    def move(self, gone: NDArray[np.bool_], new: NDArray[np.bool_]) -> None:
        """Find the points of the faces that are gone, and those outside, in the new faces."""
        moved = np.flatnonzero((self._face == NOBODY) | gone[self._face])
        self._face[moved] = NOBODY
        self._locate(moved, np.flatnonzero(new))

    def faces_beyond(self, z: FloatArray, limits: FloatArray) -> IntArray:
        """Return the faces that are farther than its limit from an input vertex."""
        point = np.flatnonzero(self._face != NOBODY)
        at_b, at_c = self._weights[point].T
        a, b, c = z[self._history.corners[self._face[point]]].T
        off = np.abs(a + at_b * (b - a) + at_c * (c - a) - self._points[point, 2])
        return np.unique(self._face[point[off > limits[point] + self._slack]])

    def _locate(self, point: IntArray, rows: IntArray) -> None:
        corners = self._history.corners[rows]
        used, faces = np.unique(corners, return_inverse=True)
        mesh = TriangleMesh._trusted(
            self._points[used],
            faces.reshape(-1, 3).astype(np.int32),
            np.empty((len(used), 0)),
            (),
        )
        cover = cover_of(mesh, self._points[point, :2])
        found = point[cover.point]
        self._face[found] = rows[cover.face]
        self._weights[found] = np.column_stack([cover.at_b, cover.at_c])


class _Heights:
    """The coefficients of the vertices that are there, as what is undone gives them."""

    def __init__(self, pyramid: Pyramid, keep_points: bool) -> None:
        self._pyramid = pyramid
        self._ids = pyramid._ids_by_level(0)
        # Without an update nothing ever changes the coefficients of a vertex that stays.
        self._finest: FloatArray | None = None
        self._filters: list[FilterPair] = []
        self._movers = self._parents = csr_array((0, 0))
        if keep_points or UPDATES.find(pyramid.update).is_empty:
            self._finest = pyramid.columns_of(pyramid.mesh(pyramid.n_levels))
        else:
            self._filters = list(pyramid.all_filters())
            self._note_dependence(pyramid.n_vertices(pyramid.n_levels))

    def columns(self, is_undone: NDArray[np.bool_]) -> FloatArray:
        """Return the channels of all vertices, ``(n_vertices, k)``; what is gone has any value."""
        if self._finest is not None:
            return self._finest
        pyramid = self._pyramid
        coefficients = pyramid.coarse
        for level, (step, pair) in enumerate(zip(pyramid.steps, self._filters, strict=True)):
            of_level = self._ids[level + 1]
            rows = np.flatnonzero(is_undone[of_level[step.odd]])
            details = np.zeros_like(step.details)
            details[rows] = step.details[rows]
            fine = np.zeros((len(of_level), coefficients.shape[1]))
            fine[pair.even] = coefficients - pair.update @ details  # Eq. 32, of what is undone
            predicted = pair.prediction[rows] @ fine[pair.even]
            fine[step.odd[rows]] = step.details[rows] + predicted  # Eq. 33
            coefficients = fine
        return coefficients

    def moved_by(
        self, vertices: NDArray[np.int32], is_undone: NDArray[np.bool_]
    ) -> NDArray[np.int32]:
        """Return collapses, not undone, by which the heights of vertices differ from the input's.

        Those whose updates have moved the vertices themselves, or else the vertices that they are
        predicted from, and so on.
        """
        reached = np.empty(0, dtype=np.int32)
        front = np.unique(vertices)
        while len(front) > len(reached) and self._filters:
            collapses = self._movers[front].indices
            collapses = collapses[~is_undone[collapses]]
            if len(collapses):
                return collapses
            reached, front = front, np.union1d(front, self._parents[front].indices)
        return np.empty(0, dtype=np.int32)

    def _note_dependence(self, n_vertices: int) -> None:
        """Note which collapses move a vertex, and which vertices a vertex is predicted from."""
        moved, movers, predicted, parents = [], [], [], []
        for level, pair in enumerate(self._filters):
            of_level = self._ids[level + 1]
            shares, weights = pair.update.tocoo(), pair.prediction.tocoo()
            moved.append(of_level[pair.even[shares.row]])
            movers.append(of_level[pair.odd[shares.col]])
            predicted.append(of_level[pair.odd[weights.row]])
            parents.append(of_level[pair.even[weights.col]])
        self._movers = _relation(moved, movers, n_vertices)
        self._parents = _relation(predicted, parents, n_vertices)

    def at(self, is_undone: NDArray[np.bool_]) -> FloatArray:
        """Return z of all vertices."""
        return self.columns(is_undone)[:, 0]


def _relation(rows: list[NDArray], columns: list[NDArray], n: int) -> csr_array:
    row, column = (np.concatenate([np.empty(0, np.int32), *part]) for part in (rows, columns))
    return csr_array((np.ones(len(row), dtype=bool), (row, column)), shape=(n, n))


def _assembled(
    pyramid: Pyramid,
    history: _History,
    columns: FloatArray,
    is_undone: NDArray[np.bool_],
    is_there: NDArray[np.bool_],
) -> PartialMesh:
    stays = np.flatnonzero((history.level < 0) | is_undone)
    position = np.full(len(is_undone), -1, dtype=np.int32)
    position[stays] = np.arange(len(stays), dtype=np.int32)
    finest = pyramid.mesh(pyramid.n_levels)
    mesh = TriangleMesh._trusted(
        np.column_stack([finest.vertices[stays, :2], columns[stays, 0]]),
        position[history.corners[is_there]],
        columns[stays, 1:],
        pyramid.attribute_names,
    )
    level = int(history.level[is_undone].max(initial=-1)) + 1
    return PartialMesh(mesh, pyramid._in_input(stays.astype(np.int32)), level)
