"""A pyramid by the arrays of its steps: all of them, or those that its collapses follow from."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, Pyramid, PyramidError, Step, TriangleMesh
from wavelet_core.lifting.pyramid import PyramidPart
from wavelet_core.lifting.recorded import is_error_guided
from wavelet_core.lifting.signal import SIGNALS
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.partition._mutable_level import CollapseStep
from wavelet_core.partition.plan_record import places_of_steps, steps_at_places
from wavelet_core.progress import part_of, report, watched_part
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.io.pyramid.array_tables import StoredArrays
from wavelet_gis.io.pyramid.described import (
    locked_from,
    parameters_from,
    require_surface,
    stop_from,
)
from wavelet_gis.io.pyramid.metadata_tables import MAX_LEVELS, Contents
from wavelet_gis.model.dem import cell_plan
from wavelet_gis.model.origin import Origin

__all__ = ["listed_arrays", "lists_from_pyramid", "pyramid_from_lists"]

#: Arrays of one step, with the only data type and number of dimensions that each may have.
_STEP_ARRAYS = {
    "odd": ("<i4", 1),
    "target": ("<i4", 1),
    "indptr": ("<i8", 1),
    "indices": ("<i4", 1),
    "weights": ("<f8", 1),
    "details": ("<f8", 2),
}

#: What the metadata say of x and y that are those of a raster's cells.
_CELLS = "cells"

#: What the metadata say of steps whose filters follow from their collapses.
_PLACES = "places"

#: Of the time in which such a pyramid is read: whether its finest level is a surface.
_SHARE_OF_SURFACE = 0.1


def lists_from_pyramid(
    pyramid: Pyramid, origin: Origin, frame: LocalFrame, progress: Progress | None = None
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return what the metadata say of its arrays, and the arrays of a pyramid.

    Parameters
    ----------
    pyramid : Pyramid
        One that does not follow from its input.
    origin : Origin
        Of the input, which may hold its places.
    frame : LocalFrame
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    described: dict[str, Any] = {}
    placed = _placed_arrays(pyramid, progress)
    arrays = listed_arrays(pyramid) if placed is None else placed
    if placed is not None:
        described["steps"] = _PLACES
    if _is_plan_of_cells(pyramid, origin, frame):
        described["plan"] = _CELLS
        del arrays["horizontal"]
    if pyramid.part is not None:
        arrays["integrals"] = pyramid.part.integrals
    return described, arrays


def listed_arrays(pyramid: Pyramid) -> dict[str, NDArray[Any]]:
    """Return the arrays of a pyramid that does not follow from its input."""
    arrays: dict[str, NDArray[Any]] = {"faces": pyramid.faces, "coarse": pyramid.coarse}
    if pyramid.horizontal is not None:
        arrays["horizontal"] = pyramid.horizontal
    for level, step in enumerate(pyramid.steps):
        for name in _STEP_ARRAYS:
            arrays[_name_of(level, name)] = getattr(step, name)
    return arrays


def pyramid_from_lists(
    contents: Contents,
    arrays: StoredArrays,
    origin: Origin,
    frame: LocalFrame,
    progress: Progress | None,
) -> Pyramid:
    """Return a pyramid from the arrays of its steps."""
    described = contents.metadata.fields("pyramid")
    n_levels = described.integer("n_levels", 0, MAX_LEVELS)
    signal = described.choice("signal", tuple(SIGNALS))
    coarse = arrays.get("coarse", "<f8", 2)
    if not len(coarse):
        raise PyramidError("the coarsest level has no vertices; the file is damaged.")
    faces, locked = arrays.get("faces", "<i4", 2), locked_from(described, arrays)
    horizontal = None
    if SIGNALS[signal].keeps_plan and described.get("plan") == _CELLS:
        horizontal = _plan_of_cells(origin, frame)
    elif SIGNALS[signal].keeps_plan:
        horizontal = arrays.get("horizontal", "<f8", 2)
    if described.get("steps") == _PLACES and horizontal is not None:
        tolerance = described.fields("parameters").number("outline_tolerance")
        steps = _placed_steps(arrays, n_levels, horizontal, faces, locked, tolerance, progress)
        is_surface = True
    else:
        steps = _listed_steps(arrays, n_levels, len(faces), progress)
        is_surface = False
    pyramid = Pyramid.from_parts(
        faces=faces,
        horizontal=horizontal,
        coarse=coarse,
        steps=steps,
        channels=described.texts("channels"),
        signal=signal,
        update=described.text("update"),
        locked=locked,
        parameters=parameters_from(described),
        stop=stop_from(described),
    )
    n_vertices = pyramid.n_vertices(pyramid.n_levels)
    if not is_surface:
        with watched_part(progress, 1.0):  # refuses what is no manifold
            build_connectivity(pyramid.faces.astype(np.int32), n_vertices)
    if "has_integrals" in described:
        integrals = arrays.get("integrals", "<f8", 1)
        if len(integrals) != n_vertices or not np.isfinite(integrals).all():
            raise PyramidError("integrals for another number of vertices; the file is damaged.")
        ids = np.arange(n_vertices, dtype=np.int32)
        pyramid = replace(pyramid, part=PyramidPart(ids, integrals))
    return pyramid


def _placed_arrays(
    pyramid: Pyramid, progress: Progress | None = None
) -> dict[str, NDArray[Any]] | None:
    """Return the arrays of a pyramid whose filters follow from its collapses; None for others."""
    if not is_error_guided(pyramid) or pyramid.horizontal is None or pyramid.n_levels == 0:
        return None
    places = places_of_steps(
        pyramid.horizontal,
        pyramid.faces,
        _mask(pyramid.locked, len(pyramid.horizontal)),
        float(pyramid.parameters["outline_tolerance"]),
        [
            CollapseStep(*(getattr(step, name) for name in _STEP_ARRAYS))
            for step in reversed(pyramid.steps)
        ],
        progress,
    )
    if places is None:
        return None
    arrays: dict[str, NDArray[Any]] = {
        "faces": pyramid.faces,
        "coarse": pyramid.coarse,
        "horizontal": pyramid.horizontal,
    }
    for level, (step, of_step) in enumerate(zip(pyramid.steps, reversed(places), strict=True)):
        arrays[_name_of(level, "odd")] = step.odd
        arrays[_name_of(level, "places")] = of_step
        arrays[_name_of(level, "details")] = step.details
    return arrays


def _is_plan_of_cells(pyramid: Pyramid, origin: Origin, frame: LocalFrame) -> bool:
    if origin.grid is None or pyramid.horizontal is None:
        return False
    return np.array_equal(pyramid.horizontal, _plan_of_cells(origin, frame))


def _plan_of_cells(origin: Origin, frame: LocalFrame) -> NDArray[np.float64]:
    """Return x and y of all cells with data of a raster, in the working frame."""
    if origin.grid is None:
        raise PyramidError("places of cells without a raster; the file is damaged.")
    ids = np.arange(np.count_nonzero(origin.grid.valid))
    return cell_plan(origin.grid.geometry, origin.grid.valid, frame, ids)


def _listed_steps(
    arrays: StoredArrays, n_levels: int, n_faces: int, progress: Progress | None
) -> list[Step]:
    """Return the steps of which every array is stored."""
    steps = []
    n_read = 0
    for level in range(n_levels):
        stored = {}
        for name, kind in _STEP_ARRAYS.items():
            stored[name] = arrays.get(_name_of(level, name), *kind)
            report(progress, min(2 * n_read / max(n_faces, 1), 1.0))  # a vertex has two faces
        steps.append(Step(**stored))
        n_read += len(stored["odd"])
    return steps


def _placed_steps(
    arrays: StoredArrays,
    n_levels: int,
    horizontal: NDArray[np.float64],
    faces: NDArray[np.int32],
    locked: NDArray[np.bool_] | None,
    tolerance: float,
    progress: Progress | None,
) -> list[Step]:
    """Return the steps of which odd vertices, places of targets and details are stored."""
    is_sound = (
        horizontal.shape[1:] == (2,)
        and faces.shape[1:] == (3,)
        and len(horizontal) > 0
        and bool(np.isfinite(horizontal).all())
        and (faces.size == 0 or bool(faces.min() >= 0 and faces.max() < len(horizontal)))
        and (locked is None or locked.shape == (len(horizontal),))
        and tolerance >= 0
    )
    if not is_sound:
        raise PyramidError("a finest level that is no surface; the file is damaged.")
    mesh = TriangleMesh(np.insert(horizontal, 2, 0.0, axis=1), faces)
    require_surface(mesh, part_of(progress, 0.0, _SHARE_OF_SURFACE))
    progress = part_of(progress, _SHARE_OF_SURFACE, 1.0)
    moves = [
        (
            arrays.get(_name_of(level, "odd"), "<i4", 1),
            arrays.get(_name_of(level, "places"), "|u1", 1),
        )
        for level in range(n_levels)
    ]
    mask = _mask(locked, len(horizontal))
    with np.errstate(all="ignore"):
        collapses = list(steps_at_places(horizontal, faces, mask, tolerance, moves[::-1], progress))
    return [
        Step(*collapse._replace(details=arrays.get(_name_of(level, "details"), "<f8", 2)))
        for level, collapse in enumerate(reversed(collapses))
    ]


def _name_of(level: int, array: str) -> str:
    return f"steps/{level:04d}/{array}"


def _mask(locked: NDArray[np.bool_] | None, n_vertices: int) -> NDArray[np.bool_]:
    return np.zeros(n_vertices, dtype=bool) if locked is None else locked
