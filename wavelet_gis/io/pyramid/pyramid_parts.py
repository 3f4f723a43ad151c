"""A pyramid as metadata and arrays, and back.

A pyramid that follows from its input is kept as that and few symbols
(`wavelet_gis.io.pyramid.record_parts`), any other by the arrays of its steps.
"""

from __future__ import annotations

import math
import os
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavelet_core
from wavelet_core import Progress, Pyramid, PyramidError, Step, TriangleMesh
from wavelet_core.lifting.pyramid import PyramidPart
from wavelet_core.lifting.recorded import is_error_guided, pyramid_of, record_of
from wavelet_core.lifting.recorded import part_of as part_of_record
from wavelet_core.lifting.signal import SIGNALS
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.metrics import LevelErrors
from wavelet_core.partition._mutable_level import CollapseStep
from wavelet_core.partition.plan_record import places_of_steps, steps_at_places
from wavelet_core.partition.stopping import REASONS, StopRecord
from wavelet_core.progress import part_of, report
from wavelet_gis._fields import Fields
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.io.pyramid.array_tables import StoredArrays
from wavelet_gis.io.pyramid.metadata_tables import (
    CHECKSUMS,
    FORMAT_NAME,
    FORMAT_VERSION,
    MAX_LEVELS,
    Contents,
)
from wavelet_gis.io.pyramid.record_parts import (
    faces_from_parts,
    faces_to_parts,
    n_parts,
    record_from_parts,
    record_to_parts,
)
from wavelet_gis.io.pyramid.source_parts import (
    PALETTE,
    check_source,
    shrink_source,
    source_arrays,
)
from wavelet_gis.model.dem import cell_plan
from wavelet_gis.model.exact_restore import CORRECTIONS
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.origin import Origin, origin_from_parts
from wavelet_gis.notes import Note

__all__ = [
    "input_from_parts",
    "levels_from_parts",
    "listed_arrays",
    "pyramid_from_parts",
    "pyramid_to_parts",
]

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

#: Shares of the time that the parts of a pyramid take, after which its source is told, and after
#: which its record is, where that was not kept; the faces of points take the rest.
_SHARE_OF_SOURCE, _SHARE_OF_RECORD = 0.2, 0.4

#: Of the time in which a pyramid of points is read: its faces.
_SHARE_OF_FACES = 0.3

_NO_INPUT = "the pyramid is described by an input that the file does not hold."


def pyramid_to_parts(
    geo: GeoPyramid, progress: Progress | None = None
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return the metadata and the arrays of a pyramid file, by name.

    Parameters
    ----------
    geo : GeoPyramid
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    pyramid = geo.pyramid
    source, arrays = geo.origin.to_parts()
    has_cells = False
    shrink_source(geo, source, arrays, part_of(progress, 0.0, _SHARE_OF_SOURCE))
    mesh = geo.origin.kept_mesh(geo.frame, pyramid.faces)
    of_record = part_of(progress, _SHARE_OF_SOURCE, _SHARE_OF_RECORD)
    record = None if mesh is None else record_of(pyramid, mesh, of_record)
    if record is None:
        recorded = None
        of_places = part_of(progress, _SHARE_OF_SOURCE, 1.0)
        arrays.update(placed_arrays(pyramid, of_places) or listed_arrays(pyramid))
        has_cells = _is_plan_of_cells(pyramid, geo.origin, geo.frame)
        if has_cells:
            del arrays["horizontal"]
        if pyramid.part is not None:
            arrays["integrals"] = pyramid.part.integrals
    else:
        recorded, record_arrays = record_to_parts(record)
        arrays.update(record_arrays)
        if geo.origin.points is not None:
            of_faces, face_arrays = faces_to_parts(
                geo.origin.points.kept_places,
                pyramid.faces,
                part_of(progress, _SHARE_OF_RECORD, 1.0),
            )
            recorded.update(of_faces)
            arrays.update(face_arrays)
    if pyramid.locked is not None:
        arrays["locked"] = pyramid.locked
    is_placed = _name_of(0, "places") in arrays
    is_new = is_placed or has_cells or PALETTE in source
    metadata: dict[str, Any] = {
        "format": {
            "name": FORMAT_NAME,
            "version": FORMAT_VERSION if is_new else FORMAT_VERSION - 1,
            "checksums": CHECKSUMS,
            "software": f"terrain-wavelets {wavelet_core.__version__}",
        },
        "pyramid": {
            "n_levels": pyramid.n_levels,
            "n_vertices": pyramid.n_vertices(pyramid.n_levels),
            "n_faces": len(pyramid.faces),
            "channels": list(pyramid.channels),
            "signal": pyramid.signal,
            "update": pyramid.update,
            "has_locked": pyramid.locked is not None,
            **({"has_integrals": True} if pyramid.part is not None else {}),
            "parameters": dict(pyramid.parameters),
            "stop": None if pyramid.stop is None else pyramid.stop._asdict(),
        },
        "crs": geo.system.to_dict(),
        "frame": geo.frame.to_dict(),
        "vertical_unit": geo.vertical_unit,
        "source": source,
        "source_name": os.path.basename(geo.source_name),
        "history": list(geo.history),
    }
    if is_placed:
        metadata["pyramid"]["steps"] = _PLACES
    if has_cells:
        metadata["pyramid"]["plan"] = _CELLS
    if recorded is not None:
        metadata["record"] = recorded
    if geo.notes:
        metadata["notes"] = [note.to_dict() for note in geo.notes]
    return metadata, arrays


def pyramid_from_parts(
    contents: Contents,
    arrays: StoredArrays,
    written: Pyramid | None = None,
    progress: Progress | None = None,
) -> GeoPyramid:
    """Return what a file holds.

    Parameters
    ----------
    contents : Contents
        What it says in words.
    arrays : StoredArrays
    written : Pyramid, optional
        The one that its record describes, if that is known.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    """
    metadata = contents.metadata
    fields = metadata.fields("source")
    check_source(fields)
    origin = origin_from_parts(fields, source_arrays(fields, arrays))
    frame = LocalFrame.from_dict(metadata.fields("frame"))
    if "record" in metadata:
        pyramid = _recorded(contents, arrays, origin, frame, written, progress)
    else:
        pyramid = _from_lists(contents, arrays, origin, frame, progress)
    n_vertices = pyramid.n_vertices(pyramid.n_levels)
    if origin.n_vertices not in (None, n_vertices):
        raise PyramidError(
            f"the source has {origin.n_vertices} vertices, the pyramid {n_vertices}; analyse "
            "the input anew."
        )
    return _geo_pyramid(contents, pyramid, origin, frame)


def input_from_parts(
    contents: Contents, arrays: StoredArrays, progress: Progress | None = None
) -> GeoPyramid:
    """Return what the input comes back from, without the levels where the file allows it."""
    if "record" not in contents.metadata:
        return pyramid_from_parts(contents, arrays, progress=progress)
    fields = contents.metadata.fields("source")
    check_source(fields)
    origin = origin_from_parts(fields, source_arrays(fields, arrays))
    frame = LocalFrame.from_dict(contents.metadata.fields("frame"))
    mesh = origin.kept_mesh(frame, np.empty((0, 3), dtype=np.int32))
    if mesh is None:
        raise PyramidError(_NO_INPUT)
    described = contents.metadata.fields("pyramid")
    pyramid = Pyramid.from_parts(
        faces=mesh.faces,
        horizontal=mesh.vertices[:, :2],
        coarse=np.hstack([mesh.vertices[:, 2:], mesh.attributes]),
        steps=(),
        channels=("z", *mesh.attribute_names),
        signal="z",
        update=described.text("update"),
        parameters=_parameters_from(described),
    )
    return _geo_pyramid(contents, pyramid, origin, frame)


def levels_from_parts(
    contents: Contents, arrays: StoredArrays, level: int, progress: Progress | None = None
) -> GeoPyramid:
    """Return all levels up to one, or more, from as few of the arrays as may be."""
    index = _part_with(contents, level)
    if index == 0:
        return pyramid_from_parts(contents, arrays, progress=progress)
    return _part_from_parts(contents, arrays, index, progress)


def _part_with(contents: Contents, level: int) -> int:
    """Return the last part of a file's record that holds a level; 0 for all of the file."""
    metadata = contents.metadata
    if "record" not in metadata or level < 0:
        return 0
    record = metadata.fields("record")
    begins = metadata.fields("pyramid").integer("n_levels")
    found = 0
    for index, part in enumerate(record.objects("parts")[: n_parts(record)]):
        if begins >= level:
            found = index
        begins -= len(part.items_of("levels")) // 2
    return found


def _part_from_parts(
    contents: Contents, arrays: StoredArrays, index: int, progress: Progress | None
) -> GeoPyramid:
    """Return the levels of a pyramid from one of its parts down.

    A raster's numbers are not needed, a cloud's are, for the places of the vertices.
    """
    metadata = contents.metadata
    described, fields = metadata.fields("pyramid"), Fields(metadata.fields("source"), "the source")
    if "divisor" in fields:
        fields.pop(CORRECTIONS, None)
    origin = origin_from_parts(fields, source_arrays(fields, arrays, with_numbers=False))
    frame = LocalFrame.from_dict(metadata.fields("frame"))
    design = _design_from(described, len(described.texts("channels")))
    record = record_from_parts(metadata.fields("record"), arrays, len(design["channels"]), index)
    ids = record.parts[index].ids
    if ids is None or ids[-1] >= (origin.n_vertices or 0):
        raise PyramidError(f"part {index} has vertices that are not in the input.")
    plan = _plan_of(origin, frame, ids)
    locked = _locked_from(described, arrays)
    if locked is not None and len(locked) != origin.n_vertices:
        raise PyramidError("a locked mask of another length; the file is damaged.")
    with np.errstate(all="ignore"):
        pyramid = part_of_record(
            record,
            index,
            plan,
            locked=None if locked is None else locked[ids],
            progress=progress,
            **design,
        )
    return _geo_pyramid(contents, pyramid, origin, frame)


def _plan_of(origin: Origin, frame: LocalFrame, ids: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return x and y of some vertices of the input, in the working frame."""
    if origin.grid is not None:
        return cell_plan(origin.grid.geometry, origin.grid.valid, frame, ids)
    mesh = origin.kept_mesh(frame, np.empty((0, 3), dtype=np.int32))
    if mesh is None:
        raise PyramidError(_NO_INPUT)
    return mesh.vertices[ids, :2]


def listed_arrays(pyramid: Pyramid) -> dict[str, NDArray[Any]]:
    """Return the arrays of a pyramid that does not follow from its input."""
    arrays: dict[str, NDArray[Any]] = {"faces": pyramid.faces, "coarse": pyramid.coarse}
    if pyramid.horizontal is not None:
        arrays["horizontal"] = pyramid.horizontal
    for level, step in enumerate(pyramid.steps):
        for name in _STEP_ARRAYS:
            arrays[_name_of(level, name)] = getattr(step, name)
    return arrays


def placed_arrays(
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


def _name_of(level: int, array: str) -> str:
    return f"steps/{level:04d}/{array}"


def _mask(locked: NDArray[np.bool_] | None, n_vertices: int) -> NDArray[np.bool_]:
    return np.zeros(n_vertices, dtype=bool) if locked is None else locked


def _geo_pyramid(
    contents: Contents, pyramid: Pyramid, origin: Origin, frame: LocalFrame
) -> GeoPyramid:
    metadata, levels = contents.metadata, contents.levels[::-1]
    n_levels = metadata.fields("pyramid").integer("n_levels")
    return GeoPyramid(
        pyramid=pyramid,
        system=CoordinateSystem.from_dict(metadata.fields("crs")),
        frame=frame,
        vertical_unit=metadata.text("vertical_unit"),
        origin=origin,
        source_name=metadata.text("source_name"),
        errors=levels if len(levels) == n_levels + 1 and _are_measured(levels) else None,
        history=tuple(metadata.texts("history")),
        notes=tuple(Note.from_dict(fields) for fields in metadata.objects("notes"))
        if "notes" in metadata
        else (),
    )


def _are_measured(levels: tuple[LevelErrors, ...]) -> bool:
    return all(math.isfinite(value) for level in levels for value in level)


def _parameters_from(described: Fields) -> dict[str, Any]:
    """Return the parameters, those checked by which the pyramid is written again."""
    parameters = described.fields("parameters")
    if "outline_tolerance" in parameters and parameters.number("outline_tolerance") < 0:
        raise parameters.fault("a tolerance below 0")
    if "attribute_weights" in parameters:
        weights = parameters["attribute_weights"]
        is_list = isinstance(weights, (list, tuple))
        if not is_list or not all(
            type(weight) in (int, float) and 0 <= weight < 1e300 for weight in weights
        ):
            raise parameters.fault("weights of attributes that are no numbers from 0 up")
    return dict(parameters)


def _from_lists(
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
    faces, locked = arrays.get("faces", "<i4", 2), _locked_from(described, arrays)
    horizontal = None
    if SIGNALS[signal].keeps_plan and described.get("plan") == _CELLS:
        horizontal = _plan_of_cells(origin, frame)
    elif SIGNALS[signal].keeps_plan:
        horizontal = arrays.get("horizontal", "<f8", 2)
    if described.get("steps") == _PLACES and horizontal is not None:
        tolerance = described.fields("parameters").number("outline_tolerance")
        steps = _placed_steps(arrays, n_levels, horizontal, faces, locked, tolerance, progress)
    else:
        steps = _listed_steps(arrays, n_levels, len(faces), progress)
    pyramid = Pyramid.from_parts(
        faces=faces,
        horizontal=horizontal,
        coarse=coarse,
        steps=steps,
        channels=described.texts("channels"),
        signal=signal,
        update=described.text("update"),
        locked=locked,
        parameters=_parameters_from(described),
        stop=_stop_from(described),
    )
    n_vertices = pyramid.n_vertices(pyramid.n_levels)
    build_connectivity(pyramid.faces.astype(np.int32), n_vertices)  # refuses what is no manifold
    if "has_integrals" in described:
        integrals = arrays.get("integrals", "<f8", 1)
        if len(integrals) != n_vertices or not np.isfinite(integrals).all():
            raise PyramidError("integrals for another number of vertices; the file is damaged.")
        ids = np.arange(n_vertices, dtype=np.int32)
        pyramid = replace(pyramid, part=PyramidPart(ids, integrals))
    return pyramid


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
    _require_surface(TriangleMesh(np.insert(horizontal, 2, 0.0, axis=1), faces))
    moves = [
        (
            arrays.get(_name_of(level, "odd"), "<i4", 1),
            arrays.get(_name_of(level, "places"), "|u1", 1),
        )
        for level in range(n_levels)
    ]
    mask = _mask(locked, len(horizontal))
    collapses = []
    n_taken = 0
    with np.errstate(all="ignore"):
        for collapse in steps_at_places(horizontal, faces, mask, tolerance, moves[::-1]):
            collapses.append(collapse)
            n_taken += len(collapse.odd)
            report(progress, min(n_taken / len(horizontal), 1.0))
    return [
        Step(*collapse._replace(details=arrays.get(_name_of(level, "details"), "<f8", 2)))
        for level, collapse in enumerate(reversed(collapses))
    ]


def _recorded(
    contents: Contents,
    arrays: StoredArrays,
    origin: Origin,
    frame: LocalFrame,
    written: Pyramid | None,
    progress: Progress | None,
) -> Pyramid:
    """Return a pyramid from its record and the input."""
    described = contents.metadata.fields("pyramid")
    faces = None
    if written is not None:
        faces = written.faces
        arrays.all_named("faces")  # verified
    elif origin.points is not None:
        fields, places = contents.metadata.fields("record"), origin.points.kept_places
        of_faces = part_of(progress, 0.0, _SHARE_OF_FACES)
        faces = faces_from_parts(fields, arrays, places, of_faces)
    mesh = origin.kept_mesh(frame, faces)
    if mesh is None:
        raise PyramidError(_NO_INPUT)
    design = _design_from(described, len(described.texts("channels")))
    record = record_from_parts(contents.metadata.fields("record"), arrays, len(design["channels"]))
    n_steps = sum(len(part.answers.levels) for part in record.parts)
    if n_steps != described.integer("n_levels"):
        raise PyramidError(f"{n_steps} steps for another number of levels; the file is damaged.")
    if mesh.attribute_names != design["channels"][1:]:
        raise PyramidError("channels that are not those of the source; the file is damaged.")
    locked = _locked_from(described, arrays)
    if locked is not None and locked.shape != (mesh.n_vertices,):
        raise PyramidError("a locked mask of another length; the file is damaged.")
    if written is not None:
        return written
    if origin.grid is None:
        _require_surface(mesh)
    with np.errstate(all="ignore"):
        return pyramid_of(
            record,
            mesh,
            locked=locked,
            stop=_stop_from(described),
            progress=part_of(progress, 0.0 if faces is None else _SHARE_OF_FACES, 1.0),
            **design,
        )


def _require_surface(mesh: TriangleMesh) -> None:
    """Raise unless a mesh of unknown origin is one on which steps can be taken."""
    build_connectivity(mesh.faces.astype(np.int32), mesh.n_vertices)
    if mesh.n_faces and not mesh.plan_areas.min() > 0:
        raise PyramidError("a face that is flipped or flat in plan; the file is damaged.")


def _design_from(described: Fields, n_channels: int) -> dict[str, Any]:
    """Return what the steps of a record are taken by, checked."""
    parameters = described.fields("parameters")
    weights = parameters.numbers("attribute_weights", n_channels - 1)
    tolerance = parameters.number("outline_tolerance")
    if tolerance < 0 or any(weight < 0 for weight in weights):
        raise parameters.fault("a weight or a tolerance below 0")
    described.choice("signal", ("z",))
    channels = tuple(described.texts("channels"))
    if channels[:1] != ("z",) or len(set(channels)) != len(channels):
        raise described.fault("channels of no pyramid")
    return {
        "channels": channels,
        "update": described.choice("update", ("minimum_norm", "none")),
        "parameters": dict(parameters),
    }


def _locked_from(described: Fields, arrays: StoredArrays) -> NDArray[np.bool_] | None:
    if not described.flag("has_locked"):
        return None
    return arrays.get("locked", "|u1", 1).astype(bool)


def _stop_from(described: Fields) -> StopRecord | None:
    """Return why the analysis ended; files of before do not say."""
    if described.get("stop") is None:
        return None
    stored = described.fields("stop")
    target = stored["target_vertices"]
    return StopRecord(
        stored.choice("reason", tuple(REASONS)),
        n_vertices=stored.integer("n_vertices"),
        n_locked=stored.integer("n_locked"),
        n_outline=stored.integer("n_outline"),
        n_inner=stored.integer("n_inner"),
        target_vertices=None if target is None else stored.integer("target_vertices"),
    )
