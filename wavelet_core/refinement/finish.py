"""The coarsest level of a pyramid as a TIN for itself: refined, its heights fitted."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._validate import IntArray
from ..accuracy.fitted_heights import fitted
from ..accuracy.selective import mesh_within
from ..errors import OptionError, PyramidError
from ..lifting.pyramid import Pyramid
from ..mesh.connectivity import BOUNDARY, build_connectivity
from ..mesh.location import Cover, cover_of
from ..mesh.triangle_mesh import TriangleMesh
from ..progress import Progress, part_of
from .refine import COARSE, Round, refine

#: Parameters of an analysis that say which error counts, and what a level keeps.
NEEDED = ("norm", "max_error", "max_rms", "update", "signal", "partition")


#: A coarse TIN is refined from a level of at least so many times its vertices on.
HEAD_START = 2.0


class FinishedTin(NamedTuple):
    """A TIN that is no level of its pyramid any more.

    mesh : TriangleMesh
    vertex_ids : (n_vertices,) int64, the input vertices that its vertices lie on
    cover : Cover, where the input vertices lie on it
    rounds : tuple of Round, of the refinement; empty without one
    is_fitted : bool, whether its heights are fitted to all input vertices
    """

    mesh: TriangleMesh
    vertex_ids: IntArray
    cover: Cover
    rounds: tuple[Round, ...]
    is_fitted: bool


def finished(
    pyramid: Pyramid,
    original: TriangleMesh,
    *,
    fit: bool = True,
    rounds: int | None = None,
    keep_points: bool = False,
    progress: Progress | None = None,
) -> FinishedTin:
    """Return the coarsest level, refined and with fitted heights where that lowers its error.

    Parameters
    ----------
    pyramid : Pyramid
        Its parameters say which error counts, and what the tolerance is.
    original : TriangleMesh
        Its input.
    fit : bool
        Fit the heights where the root mean square error counts. Without it, the level stays as it
        is, unless ``keep_points`` is given.
    rounds : int, optional
        Of `refine`; by default as many as pay where `analyse` chose the vertices by the errors that
        they leave (partition "surface"), and none otherwise.
    keep_points : bool
        Vertices are input vertices, height and all.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        Rounds where heights shall stay those of the level, or where signal "xyz" has moved it.
    PyramidError
        The pyramid does not say how it was analysed, as one that comes from elsewhere.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    A level that keeps a tolerance by the ``"rms"`` norm or with an update stays as it is: fitted
    heights, and those of the input where an update has moved them, might break the tolerance.
    """
    parameters = pyramid.parameters
    missing = [name for name in NEEDED if name not in parameters]
    if missing:
        raise PyramidError(
            f"the pyramid's parameters lack {', '.join(missing)}, so it does not say what its "
            "coarsest level keeps; give them to Pyramid.from_parts, or analyse the input anew."
        )
    mesh, ids = pyramid.mesh(0), pyramid.vertex_ids(0)
    is_rms, max_error = parameters["norm"] == "rms", parameters["max_error"]
    is_lifted = is_rms or parameters["update"] != "none"
    stays = (is_lifted and max_error is not None) or not (fit or keep_points)
    if rounds and (stays or parameters["signal"] != "z"):
        raise OptionError(
            "{0} goes neither with fixed heights nor with {1} 'xyz'; leave one of them out.",
            "rounds",
            "signal",
        )
    pays = parameters["partition"] == "surface" and parameters["signal"] == "z" and not stays
    if rounds is None and not pays:
        rounds = 0
    if rounds is None and (level := _level_to_start_from(pyramid, original)) > 0:
        found = _refined(
            pyramid, original, pyramid.mesh(level), pyramid.vertex_ids(level), None, rounds,
            keep_points, progress, target_vertices=mesh.n_vertices,
        )  # fmt: skip
        if found.mesh.n_vertices == mesh.n_vertices:
            return found
    if rounds != 0:
        return _refined(pyramid, original, mesh, ids, None, rounds, keep_points, progress)
    cover = cover_of(mesh, original.vertices[:, :2])
    if keep_points and not stays:
        columns = np.hstack([original.vertices[ids, 2:], original.attributes[ids]])
        vertices = np.column_stack([mesh.vertices[:, :2], columns[:, 0]])
        mesh = TriangleMesh(vertices, mesh.faces, columns[:, 1:], mesh.attribute_names)
    elif is_rms and not stays:
        locked = None if pyramid.locked is None else pyramid.locked[ids]
        mesh = fitted(mesh, original, locked, cover)
        return FinishedTin(mesh, ids, cover, (), True)
    return FinishedTin(mesh, ids, cover, (), False)


def _level_to_start_from(pyramid: Pyramid, original: TriangleMesh) -> int:
    """Return the level from which a refinement goes down to the size of the coarsest one.

    That is another one than 0 for coarse TINs at a given size only, where it leaves 1 to 2 % less
    RMSE at 2 % (three DEMs and three clouds) and takes one and a half to twice as long.
    """
    parameters, n_vertices = pyramid.parameters, pyramid.n_vertices(0)
    has_given_size = parameters["norm"] == "rms" and parameters["max_rms"] is None
    if not has_given_size or n_vertices > COARSE * original.n_vertices:
        return 0
    if parameters.get("outline_tolerance", 0.0) > 0:  # a refinement keeps the outline as it is
        return 0
    levels = range(pyramid.n_levels + 1)
    return next((k for k in levels if pyramid.n_vertices(k) >= HEAD_START * n_vertices), 0)


def finished_within(
    pyramid: Pyramid,
    original: TriangleMesh,
    max_error: ArrayLike,
    *,
    rounds: int | None = None,
    progress: Progress | None = None,
) -> FinishedTin:
    """Return the coarsest TIN of a pyramid that keeps a tolerance by place, thinned as it allows.

    Its vertices are input vertices, height and all.

    Parameters
    ----------
    pyramid : Pyramid
        Of signal "z", however it was made; one by the largest error has the fewest vertices.
    original : TriangleMesh
        Its input.
    max_error : array_like, shape (n_vertices,)
        The largest vertical distance of each input vertex from the TIN.
    rounds : int, optional
        Of `refine`, 0 for none; by default as many as pay.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        A pyramid of signal "xyz", or tolerances that are not one for each vertex.
    Cancelled
        ``progress`` returned False.
    """
    part = mesh_within(pyramid, max_error, part_of(progress, 0.0, 0.5), keep_points=True)
    cover = cover_of(part.mesh, original.vertices[:, :2])
    if rounds == 0:
        ids = part.vertex_ids
        mesh = TriangleMesh._trusted(
            original.vertices[ids], part.mesh.faces, original.attributes[ids],
            original.attribute_names,
        )  # fmt: skip
        return FinishedTin(mesh, ids, cover, (), False)
    return _refined(
        pyramid, original, part.mesh, part.vertex_ids, cover, rounds, False,
        part_of(progress, 0.5, 1.0), max_error,
    )  # fmt: skip


def _refined(
    pyramid: Pyramid,
    original: TriangleMesh,
    mesh: TriangleMesh,
    ids: IntArray,
    cover: Cover | None,
    rounds: int | None,
    keep_points: bool,
    progress: Progress | None,
    max_error: ArrayLike | None = None,
    target_vertices: int | None = None,
) -> FinishedTin:
    parameters = pyramid.parameters
    is_within = max_error is not None
    norm = "max" if is_within else parameters["norm"]
    max_error = max_error if is_within else parameters["max_error"]
    locked = np.zeros(len(ids), dtype=bool) if pyramid.locked is None else pyramid.locked[ids]
    if parameters.get("outline_tolerance", 0.0) > 0 and max_error is not None:
        # the points that the outline left outside keep the tolerance at its nearest edge
        connectivity = build_connectivity(mesh.faces.astype(np.int32), mesh.n_vertices)
        locked = locked | (connectivity.kind == BOUNDARY)
    result = refine(
        mesh,
        original,
        ids,
        norm=norm,
        rounds=rounds,
        keep_points=keep_points,
        max_error=max_error,
        max_rms=None if is_within else parameters["max_rms"],
        target_vertices=target_vertices,
        attribute_weights=parameters.get("attribute_weights"),
        locked=locked,
        cover=cover,
        progress=progress,
    )
    is_fitted = norm == "rms" and not keep_points
    return FinishedTin(result.mesh, result.vertex_ids, result.cover, result.rounds, is_fitted)
