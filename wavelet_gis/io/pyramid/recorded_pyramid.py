"""A pyramid by the input that it follows from and the record of its steps."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress, Pyramid, PyramidError
from wavelet_core.lifting.recorded import part_of as part_of_record
from wavelet_core.lifting.recorded import pyramid_of
from wavelet_core.progress import part_of
from wavelet_gis._fields import Fields
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.io.pyramid.array_tables import StoredArrays
from wavelet_gis.io.pyramid.described import (
    locked_from,
    require_surface,
    stop_from,
)
from wavelet_gis.io.pyramid.metadata_tables import Contents
from wavelet_gis.io.pyramid.record_parts import (
    codes_per_level,
    faces_from_parts,
    n_parts,
    record_from_parts,
)
from wavelet_gis.model.dem import cell_plan
from wavelet_gis.model.origin import Origin

__all__ = ["NO_INPUT", "part_with", "pyramid_from_record", "pyramid_of_part"]

#: Of the time in which a pyramid of points is read: its faces.
_SHARE_OF_FACES = 0.35

#: Until when it is known whether they are a surface.
_SHARE_OF_SURFACE = 0.37

NO_INPUT = "the pyramid is described by an input that the file does not hold."


def pyramid_from_record(
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
    design = _design_from(described, len(described.texts("channels")))
    record = record_from_parts(contents.metadata.fields("record"), arrays, len(design["channels"]))
    n_steps = sum(len(part.answers.levels) for part in record.parts)
    if n_steps != described.integer("n_levels"):
        raise PyramidError(f"{n_steps} steps for another number of levels; the file is damaged.")
    locked = locked_from(described, arrays)
    if written is not None:  # its mesh is compared by what it follows from
        return written
    mesh = origin.kept_mesh(frame, faces)
    if mesh is None:
        raise PyramidError(NO_INPUT)
    if mesh.attribute_names != design["channels"][1:]:
        raise PyramidError("channels that are not those of the source; the file is damaged.")
    if locked is not None and locked.shape != (mesh.n_vertices,):
        raise PyramidError("a locked mask of another length; the file is damaged.")
    begins = 0.0 if faces is None else _SHARE_OF_FACES
    if origin.grid is None:
        require_surface(mesh, part_of(progress, begins, _SHARE_OF_SURFACE))
        begins = _SHARE_OF_SURFACE
    with np.errstate(all="ignore"):
        return pyramid_of(
            record,
            mesh,
            locked=locked,
            stop=stop_from(described),
            progress=part_of(progress, begins, 1.0),
            **design,
        )


def part_with(contents: Contents, level: int) -> int:
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
        begins -= len(part.items_of("levels")) // codes_per_level(part)
    return found


def pyramid_of_part(
    contents: Contents,
    arrays: StoredArrays,
    origin: Origin,
    frame: LocalFrame,
    index: int,
    progress: Progress | None,
) -> Pyramid:
    """Return the levels of a pyramid from one of the parts of its record down."""
    metadata = contents.metadata
    described = metadata.fields("pyramid")
    design = _design_from(described, len(described.texts("channels")))
    record = record_from_parts(metadata.fields("record"), arrays, len(design["channels"]), index)
    ids = record.parts[index].ids
    if ids is None or ids[-1] >= (origin.n_vertices or 0):
        raise PyramidError(f"part {index} has vertices that are not in the input.")
    plan = _plan_of(origin, frame, ids)
    locked = locked_from(described, arrays)
    if locked is not None and len(locked) != origin.n_vertices:
        raise PyramidError("a locked mask of another length; the file is damaged.")
    with np.errstate(all="ignore"):
        return part_of_record(
            record,
            index,
            plan,
            locked=None if locked is None else locked[ids],
            progress=progress,
            **design,
        )


def _plan_of(origin: Origin, frame: LocalFrame, ids: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return x and y of some vertices of the input, in the working frame."""
    if origin.grid is not None:
        return cell_plan(origin.grid.geometry, origin.grid.valid, frame, ids)
    mesh = origin.kept_mesh(frame, np.empty((0, 3), dtype=np.int32))
    if mesh is None:
        raise PyramidError(NO_INPUT)
    return mesh.vertices[ids, :2]


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
