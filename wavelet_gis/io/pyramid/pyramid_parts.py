"""A pyramid as metadata and arrays, and back.

A pyramid that follows from its input is kept as that and few symbols
(`wavelet_gis.io.pyramid.recorded_pyramid`), any other by the arrays of its steps
(`wavelet_gis.io.pyramid.listed_pyramid`).
"""

from __future__ import annotations

import math
import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavelet_core
from wavelet_core import Progress, Pyramid, PyramidError
from wavelet_core.lifting.recorded import Record, kept_record_of, record_of
from wavelet_core.metrics import LevelErrors
from wavelet_core.progress import part_of
from wavelet_gis._fields import Fields
from wavelet_gis.crs.frame import CoordinateSystem, LocalFrame
from wavelet_gis.io.pyramid.array_tables import StoredArrays
from wavelet_gis.io.pyramid.described import parameters_from
from wavelet_gis.io.pyramid.listed_pyramid import lists_from_pyramid, pyramid_from_lists
from wavelet_gis.io.pyramid.metadata_tables import (
    CHECKSUMS,
    FORMAT_NAME,
    FORMAT_VERSION,
    Contents,
)
from wavelet_gis.io.pyramid.record_parts import (
    asks_by_odds,
    faces_to_parts,
    record_to_parts,
)
from wavelet_gis.io.pyramid.recorded_pyramid import (
    NO_INPUT,
    part_with,
    pyramid_from_record,
    pyramid_of_part,
)
from wavelet_gis.io.pyramid.source_parts import (
    LOW_BITS,
    PALETTE,
    check_source,
    shrink_source,
    source_arrays,
)
from wavelet_gis.model.exact_restore import CORRECTIONS
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.origin import Origin, origin_from_parts
from wavelet_gis.notes import Note

__all__ = [
    "input_from_parts",
    "levels_from_parts",
    "pyramid_from_parts",
    "pyramid_to_parts",
]

#: Shares of the time in which the parts of a pyramid are made, after which its source is there,
#: and after which its record is, where that was not kept; the faces of points take the rest.
_SHARE_OF_SOURCE, _SHARE_OF_RECORD = 0.2, 0.4
#: Share of the time in which they are read, after which its source is there.
_SOURCE_IS_READ = 0.02


def _version(source: dict[str, Any], recorded: dict[str, Any] | None, is_listed: bool) -> int:
    """Return the first format whose readers know all that the file holds."""
    if LOW_BITS in source or (recorded is not None and asks_by_odds(recorded)):
        return FORMAT_VERSION
    return 3 if is_listed or PALETTE in source else 2


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
    of_lists: dict[str, Any] = {}
    shrink_source(geo, source, arrays, part_of(progress, 0.0, _SHARE_OF_SOURCE))
    record = _record_of(geo, part_of(progress, _SHARE_OF_SOURCE, _SHARE_OF_RECORD))
    if record is None:
        recorded = None
        of_places = part_of(progress, _SHARE_OF_SOURCE, 1.0)
        of_lists, listed = lists_from_pyramid(pyramid, geo.origin, geo.frame, of_places)
        arrays.update(listed)
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
    metadata: dict[str, Any] = {
        "format": {
            "name": FORMAT_NAME,
            "version": _version(source, recorded, bool(of_lists)),
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
    metadata["pyramid"].update(of_lists)
    if recorded is not None:
        metadata["record"] = recorded
    if geo.notes:
        metadata["notes"] = [note.to_dict() for note in geo.notes]
    return metadata, arrays


def _record_of(geo: GeoPyramid, progress: Progress | None) -> Record | None:
    """Return the record of a pyramid, that of its analysis where it is kept."""
    if geo.pyramid.kept_record is not None:
        points = geo.origin.kept_mesh(geo.frame, np.empty((0, 3), dtype=np.int32))
        kept = None if points is None else kept_record_of(geo.pyramid, points)
        if kept is not None:
            return kept
    mesh = geo.origin.kept_mesh(geo.frame, geo.pyramid.faces)
    return None if mesh is None else record_of(geo.pyramid, mesh, progress)


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
    of_source = part_of(progress, 0.0, _SOURCE_IS_READ)
    origin = origin_from_parts(fields, source_arrays(fields, arrays, of_source))
    frame = LocalFrame.from_dict(metadata.fields("frame"))
    of_rest = part_of(progress, _SOURCE_IS_READ, 1.0)
    if "record" in metadata:
        pyramid = pyramid_from_record(contents, arrays, origin, frame, written, of_rest)
    else:
        pyramid = pyramid_from_lists(contents, arrays, origin, frame, of_rest)
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
        raise PyramidError(NO_INPUT)
    described = contents.metadata.fields("pyramid")
    pyramid = Pyramid.from_parts(
        faces=mesh.faces,
        horizontal=mesh.vertices[:, :2],
        coarse=np.hstack([mesh.vertices[:, 2:], mesh.attributes]),
        steps=(),
        channels=("z", *mesh.attribute_names),
        signal="z",
        update=described.text("update"),
        parameters=parameters_from(described),
    )
    return _geo_pyramid(contents, pyramid, origin, frame)


def levels_from_parts(
    contents: Contents, arrays: StoredArrays, level: int, progress: Progress | None = None
) -> GeoPyramid:
    """Return all levels up to one, or more, from as few of the arrays as may be."""
    index = part_with(contents, level)
    if index == 0:
        return pyramid_from_parts(contents, arrays, progress=progress)
    # A raster's numbers are not needed, a cloud's are, for the places of the vertices.
    fields = Fields(contents.metadata.fields("source"), "the source")
    if "divisor" in fields:
        fields.pop(CORRECTIONS, None)
    origin = origin_from_parts(fields, source_arrays(fields, arrays, with_numbers=False))
    frame = LocalFrame.from_dict(contents.metadata.fields("frame"))
    pyramid = pyramid_of_part(contents, arrays, origin, frame, index, progress)
    return _geo_pyramid(contents, pyramid, origin, frame)


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
