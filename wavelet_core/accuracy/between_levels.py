"""Meshes between two levels: of a size, or of an accuracy."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from .._validate import FloatArray
from ..errors import OptionError
from ..lifting.options import as_whole
from ..lifting.pyramid import Pyramid
from ..lifting.step import analyse_level
from ..mesh.collapse import even_positions, merge_map, merged_faces
from ..mesh.location import surface_errors
from ..mesh.triangle_mesh import TriangleMesh
from ..progress import Progress
from .selective import PartialMesh, is_selective, mesh_within


def mesh_of_size(pyramid: Pyramid, n_vertices: int) -> PartialMesh:
    """Return the mesh of a pyramid that has a given number of vertices.

    Parameters
    ----------
    pyramid : Pyramid
    n_vertices : int
        Between those of level 0 and of the input; more than the input has means the input.

    Returns
    -------
    PartialMesh
        A level, if one has just that size. Else the next finer one, from which the vertices with
        the smallest details of the step below are taken out, until the number is met.

    Raises
    ------
    OptionError
        Fewer vertices than the coarsest level has, or no whole number of them.

    Notes
    -----
    The odd vertices of a step are never adjacent and their collapses do not depend on each other,
    so any part of them may go: the flip test looks at stars that share no face, and the link
    condition only loosens with every collapse that is left out. Predict and update are those of
    the pyramid, applied to the part.
    """
    wanted = as_whole(n_vertices)
    if wanted is None:
        raise OptionError("{0} is {given}; give a whole number.", "n_vertices", given=n_vertices)
    if wanted < pyramid.n_vertices(0):
        raise OptionError(
            "the coarsest level has {coarsest} vertices, more than {0} {given}; analyse the input "
            "anew with a smaller target.",
            "n_vertices",
            coarsest=pyramid.n_vertices(0),
            given=wanted,
        )
    level = next(
        (k for k in range(pyramid.n_levels) if pyramid.n_vertices(k) >= wanted),
        pyramid.n_levels,
    )
    n_out = pyramid.n_vertices(level) - wanted
    mesh = pyramid.mesh(level)
    if n_out <= 0:
        return PartialMesh(mesh, pyramid.vertex_ids(level), level)
    return _Step(pyramid, level, mesh).without(n_out)


def mesh_of_accuracy(
    pyramid: Pyramid, max_error: ArrayLike, progress: Progress | None = None
) -> PartialMesh:
    """Return the smallest mesh found in a pyramid whose vertical errors keep a tolerance.

    Parameters
    ----------
    pyramid : Pyramid
    max_error : float or array_like, shape (n_vertices,)
        Largest vertical distance from an input vertex, in the unit of z; one for all of them, or
        one for each.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    PartialMesh
        Fine only where it has to be, see `wavelet_core.accuracy.selective.mesh_within`. Of a
        pyramid of signal "xyz", or by the one-ring mean: the coarsest level that keeps the
        tolerance, thinned by as much of the next step as still keeps it (found by bisection, and
        measured at all input vertices, as synthesised).

    Raises
    ------
    OptionError
        A tolerance below 0; one for each vertex where the pyramid allows none.
    Cancelled
        ``progress`` returned False.
    """
    if np.ndim(max_error) > 0:
        return mesh_within(pyramid, max_error, progress)
    limit = float(np.asarray(max_error))
    if not limit >= 0:
        raise OptionError("{0} is {given}; give a distance of 0 or more.", "max_error", given=limit)
    if not is_selective(pyramid):
        return _thinned_level(pyramid, limit)
    n_finest = pyramid.n_vertices(pyramid.n_levels)
    found = mesh_within(pyramid, np.full(n_finest, limit), progress)
    return _coarser_level(pyramid, limit, found)


def _coarser_level(pyramid: Pyramid, max_error: float, found: PartialMesh) -> PartialMesh:
    """Return a level that keeps a tolerance with fewer vertices, if there is one.

    Heights that an update has moved are, on a level, those of the whole step.
    """
    points = pyramid.mesh(pyramid.n_levels).vertices
    for level in range(pyramid.n_levels, -1, -1):
        if pyramid.n_vertices(level) < found.mesh.n_vertices:
            mesh = pyramid.mesh(level)
            if _largest(mesh, points) > max_error:
                break
            found = PartialMesh(mesh, pyramid.vertex_ids(level), level)
    return found


def _thinned_level(pyramid: Pyramid, max_error: float) -> PartialMesh:
    points = pyramid.mesh(pyramid.n_levels).vertices
    finest = (pyramid.n_levels, pyramid.mesh(pyramid.n_levels))
    fitting = (pair for pair in enumerate(pyramid) if _largest(pair[1], points) <= max_error)
    level, mesh = next(fitting, finest)
    best = PartialMesh(mesh, pyramid.vertex_ids(level), level)
    if level == 0:
        return best
    step = _Step(pyramid, level, mesh)
    fits, too_many = 0, pyramid.n_vertices(level) - pyramid.n_vertices(level - 1)
    while too_many - fits > 1:
        middle = (fits + too_many) // 2
        trial = step.without(middle)
        if _largest(trial.mesh, points) <= max_error:
            fits, best = middle, trial
        else:
            too_many = middle
    return best


class _Step:
    """The step below a level, to be taken in part."""

    def __init__(self, pyramid: Pyramid, level: int, mesh: TriangleMesh) -> None:
        self._pyramid = pyramid
        self._level = level
        self._ids = pyramid.vertex_ids(level)
        self._faces = mesh.faces
        self._fine = np.hstack([mesh.vertices, mesh.attributes])
        self._integrals = pyramid.integrals(level)
        self._step = pyramid.steps[level - 1]
        self._filters = pyramid.filters(level - 1)
        magnitude = np.linalg.norm(self._step.details, axis=1)
        self._by_size = np.argsort(magnitude, kind="stable")

    def without(self, n_out: int) -> PartialMesh:
        """Return the level without the ``n_out`` vertices of the smallest details."""
        rows = np.sort(self._by_size[:n_out])  # ORMP is taken in the order of removal
        odd, target = self._step.odd[rows], self._step.target[rows]
        n_fine = len(self._fine)
        even = even_positions(odd, n_fine)
        position = np.full(n_fine, -1, dtype=np.int32)
        position[even] = np.arange(len(even), dtype=np.int32)
        part = csr_array(self._filters.prediction[rows])
        columns = position[self._filters.even[part.indices]]
        prediction = csr_array((part.data, columns, part.indptr), shape=(len(rows), len(even)))
        pyramid, n_fixed = self._pyramid, 2 if self._pyramid.horizontal is not None else 0
        locked = (
            np.zeros(n_fine, dtype=bool) if pyramid.locked is None else pyramid.locked[self._ids]
        )
        coarse = analyse_level(
            self._fine[:, n_fixed:],
            odd,
            even,
            prediction,
            pyramid.update,
            self._integrals,
            locked,
        )[0]
        columns_of_even = np.hstack([self._fine[even, :n_fixed], coarse])
        faces = merged_faces(self._faces, merge_map(odd, target, n_fine))
        mesh = TriangleMesh._trusted(
            columns_of_even[:, :3].copy(),
            faces,
            columns_of_even[:, 3:].copy(),
            pyramid.attribute_names,
        )
        return PartialMesh(mesh, self._ids[even], self._level)


def _largest(mesh: TriangleMesh, points: FloatArray) -> float:
    errors = np.abs(surface_errors(mesh, points))
    return float(np.nanmax(errors, initial=0.0))
