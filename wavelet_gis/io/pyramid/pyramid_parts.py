"""A pyramid as metadata and arrays, and back.

A pyramid that follows from its input is told by that and by few symbols
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
from wavelet_core.lifting.recorded import part_of as part_of_record
from wavelet_core.lifting.recorded import pyramid_of, record_of
from wavelet_core.lifting.signal import SIGNALS
from wavelet_core.mesh.connectivity import build_connectivity
from wavelet_core.metrics import LevelErrors
from wavelet_core.partition.stopping import REASONS, StopRecord
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
from wavelet_gis.io.pyramid.source_parts import check_source, shrink_source, source_arrays
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

_NO_INPUT = "the pyramid is told by an input that the file does not hold."


def pyramid_to_parts(
    geo: GeoPyramid, progress: Progress | None = None
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return the metadata and the arrays of a pyramid file, by name."""
    pyramid = geo.pyramid
    source, arrays = geo.origin.to_parts()
    shrink_source(geo, source, arrays)
    mesh = geo.origin.kept_mesh(geo.frame, pyramid.faces)
    record = None if mesh is None else record_of(pyramid, mesh, progress)
    if record is None:
        told = None
        arrays.update(listed_arrays(pyramid))
    else:
        told, record_arrays = record_to_parts(record)
        arrays.update(record_arrays)
        if geo.origin.points is not None:
            of_faces, face_arrays = faces_to_parts(geo.origin.points.kept_places, pyramid.faces)
            told.update(of_faces)
            arrays.update(face_arrays)
    if pyramid.locked is not None:
        arrays["locked"] = pyramid.locked
    metadata: dict[str, Any] = {
        "format": {
            "name": FORMAT_NAME,
            "version": FORMAT_VERSION,
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
    if told is not None:
        metadata["record"] = told
    if geo.notes:
        metadata["notes"] = [note.to_dict() for note in geo.notes]
    return metadata, arrays


def pyramid_from_parts(
    contents: Contents, arrays: StoredArrays, written: Pyramid | None = None
) -> GeoPyramid:
    """Return what a file holds; ``written``, if given, is the pyramid that its record told."""
    metadata = contents.metadata
    fields = metadata.fields("source")
    check_source(fields)
    origin = origin_from_parts(fields, source_arrays(fields, arrays))
    frame = LocalFrame.from_dict(metadata.fields("frame"))
    if "record" in metadata:
        pyramid = _recorded(contents, arrays, origin, frame, written)
    else:
        pyramid = _from_lists(contents, arrays)
    n_vertices = pyramid.n_vertices(pyramid.n_levels)
    if origin.n_vertices not in (None, n_vertices):
        raise PyramidError(
            f"the source has {origin.n_vertices} vertices, the pyramid {n_vertices}; analyse "
            "the input anew."
        )
    return _geo_pyramid(contents, pyramid, origin, frame)


def input_from_parts(contents: Contents, arrays: StoredArrays) -> GeoPyramid:
    """Return what the input comes back from, without the levels where the file allows it."""
    if "record" not in contents.metadata:
        return pyramid_from_parts(contents, arrays)
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
        parameters=dict(described.fields("parameters")),
    )
    return _geo_pyramid(contents, pyramid, origin, frame)


def levels_from_parts(contents: Contents, arrays: StoredArrays, level: int) -> GeoPyramid:
    """Return all levels up to one, or more, from as few of the arrays as may be."""
    index = _part_with(contents, level)
    if index == 0:
        return pyramid_from_parts(contents, arrays)
    return _part_from_parts(contents, arrays, index)


def _part_with(contents: Contents, level: int) -> int:
    """Return the last part of a file's record that holds a level; 0 for all of the file."""
    metadata = contents.metadata
    if "record" not in metadata or "divisor" not in metadata.fields("source") or level < 0:
        return 0
    record = metadata.fields("record")
    begins = metadata.fields("pyramid").integer("n_levels")
    found = 0
    for index, part in enumerate(record.objects("parts")[: n_parts(record)]):
        if begins >= level:
            found = index
        begins -= len(part.items_of("levels")) // 2
    return found


def _part_from_parts(contents: Contents, arrays: StoredArrays, index: int) -> GeoPyramid:
    """Return the levels of a raster's pyramid from one of its parts down."""
    metadata = contents.metadata
    described, fields = metadata.fields("pyramid"), Fields(metadata.fields("source"), "the raster")
    fields.pop(CORRECTIONS, None)
    origin = origin_from_parts(fields, source_arrays(fields, arrays, with_numbers=False))
    frame = LocalFrame.from_dict(metadata.fields("frame"))
    design = _design_from(described, len(described.texts("channels")))
    record = record_from_parts(metadata.fields("record"), arrays, len(design["channels"]), index)
    ids = record.parts[index].ids
    grid = origin.grid
    if ids is None or grid is None or ids[-1] >= (origin.n_vertices or 0):
        raise PyramidError(f"part {index} has vertices that the raster has not.")
    plan = cell_plan(grid.geometry, grid.valid, frame, ids)
    locked = _locked_from(described, arrays)
    if locked is not None and len(locked) != origin.n_vertices:
        raise PyramidError("a locked mask of another length; the file is damaged.")
    with np.errstate(all="ignore"):
        pyramid = part_of_record(
            record, index, plan, locked=None if locked is None else locked[ids], **design
        )
    return _geo_pyramid(contents, pyramid, origin, frame)


def listed_arrays(pyramid: Pyramid) -> dict[str, NDArray[Any]]:
    """Return the arrays of a pyramid that does not follow from its input."""
    arrays: dict[str, NDArray[Any]] = {"faces": pyramid.faces, "coarse": pyramid.coarse}
    if pyramid.horizontal is not None:
        arrays["horizontal"] = pyramid.horizontal
    if pyramid.part is not None:
        arrays["integrals"] = pyramid.part.integrals
    for level, step in enumerate(pyramid.steps):
        for name in _STEP_ARRAYS:
            arrays[f"steps/{level:04d}/{name}"] = getattr(step, name)
    return arrays


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


def _from_lists(contents: Contents, arrays: StoredArrays) -> Pyramid:
    """Return a pyramid from the arrays of its steps."""
    described = contents.metadata.fields("pyramid")
    n_levels = described.integer("n_levels", 0, MAX_LEVELS)
    steps = [
        Step(
            **{
                name: arrays.get(f"steps/{k:04d}/{name}", *kind)
                for name, kind in _STEP_ARRAYS.items()
            }
        )
        for k in range(n_levels)
    ]
    signal = described.choice("signal", tuple(SIGNALS))
    coarse = arrays.get("coarse", "<f8", 2)
    if not len(coarse):
        raise PyramidError("the coarsest level has no vertices; the file is damaged.")
    pyramid = Pyramid.from_parts(
        faces=arrays.get("faces", "<i4", 2),
        horizontal=arrays.get("horizontal", "<f8", 2) if SIGNALS[signal].keeps_plan else None,
        coarse=coarse,
        steps=steps,
        channels=described.texts("channels"),
        signal=signal,
        update=described.text("update"),
        locked=_locked_from(described, arrays),
        parameters=dict(described.fields("parameters")),
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


def _recorded(
    contents: Contents,
    arrays: StoredArrays,
    origin: Origin,
    frame: LocalFrame,
    written: Pyramid | None,
) -> Pyramid:
    """Return a pyramid from its record and the input."""
    described = contents.metadata.fields("pyramid")
    faces = None
    if written is not None:
        faces = written.faces
        arrays.all_named("faces")  # verified
    elif origin.points is not None:
        told, places = contents.metadata.fields("record"), origin.points.kept_places
        faces = faces_from_parts(told, arrays, places)
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
        return pyramid_of(record, mesh, locked=locked, stop=_stop_from(described), **design)


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
    """Return why the analysis ended; files of before do not tell."""
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
