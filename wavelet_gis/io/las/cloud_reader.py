"""LAS, LAZ and COPC files in: laspy knows the dimensions, the bytes around are kept."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import MissingDependencyError
from wavelet_gis.crs.frame import Georeference
from wavelet_gis.crs.las import las_crs
from wavelet_gis.errors import CrsWarning, InputFileError, PointCloudWarning
from wavelet_gis.io.las import block as las_block
from wavelet_gis.io.las import laz_decoder
from wavelet_gis.io.las.copc import Chunk, chunks_within, is_copc
from wavelet_gis.io.las.dimensions import carried_fields, lifted_attributes, select
from wavelet_gis.io.las.layout import (
    LARGEST_COORDINATE,
    LasLayout,
    laszip_record,
    read_layout,
    records_of,
)
from wavelet_gis.io.las.octree import Box
from wavelet_gis.model.attributes.ground import GROUND_CLASS
from wavelet_gis.model.points.cloud import PointCloud
from wavelet_gis.notes import warn

if TYPE_CHECKING:
    from laspy import LasHeader
    from laspy.point.record import PackedPointRecord

__all__ = [
    "NOISE_CLASSES",
    "NoneChosenError",
    "decoding",
    "laspy_header",
    "laz_job",
    "masks_aside",
    "projection_records",
    "read_cloud",
    "require_laspy",
    "tail_of",
    "warn_of_crs",
]

#: ASPRS classes of points that hit nothing on the ground: low and high noise.
NOISE_CLASSES = (7, 18)

#: No points are compressed to less than one part in this; thousands of equal ones come near it.
_MOST_COMPRESSED = 100_000

#: Point formats with references to waveform packets.
_WAVEFORM_FORMATS = (4, 5, 9, 10)


class NoneChosenError(InputFileError):
    """A file without a point of the chosen classes, or in the box."""


def read_cloud(
    path: str | os.PathLike[str],
    *,
    attributes: Sequence[str] = (),
    classes: Sequence[int] | None = None,
    ground_first: bool = False,
    carry: bool = True,
    keep_noise: bool = False,
    keep_withheld: bool = False,
    bbox: Box | None = None,
    resolution: float | None = None,
) -> tuple[PointCloud, Georeference]:
    """Return the chosen points of a LAS or LAZ file, and their georeference.

    Parameters
    ----------
    path : path
        LAS 1.0 to 1.4, LAZ or COPC.
    attributes : sequence of str
        Dimensions to lift along: any that the file has, ``rgb`` for the three colours, ``hag``
        for the height above the ground (class 2). An array-valued dimension gives one attribute
        for each component.
    classes : sequence of int, optional
        Only points of these classes; the ground for ``hag`` is that of the whole file.
    ground_first : bool
        Without `classes`, take the last returns of the ground (class 2) if there are some; the
        result names its classes then.
    carry : bool
        Keep the other dimensions too, to be given back untouched.
    keep_noise : bool
        Let points of the classes 7 and 18 (low and high noise) be part of the surface. By default
        they are only carried, to be given back; a class named in `classes` is always kept.
    keep_withheld : bool
        The same for points with the withheld flag.
    bbox : tuple of float, optional
        Only points in a box: smallest x and y, largest x and y, in the file's coordinates. Of a
        COPC file no more is read.
    resolution : float, optional
        Of a COPC file: only so many of its levels as have points so far apart, in the unit of x
        and y.

    Raises
    ------
    InputFileError
        When the file is missing, no LAS file, damaged, empty, or lacks what was asked for.
    MissingDependencyError
        When laspy, or lazrs for a LAZ file, is not installed.

    Warns
    -----
    PointCloudWarning
        What is odd about the file, and which points are no part of the surface.
    CrsWarning
        What is odd about its CRS.
    """
    name = os.fspath(path)
    if os.path.isdir(name):
        raise InputFileError(f"{name}: this is a folder; name the LAS or LAZ file in it.")
    if not os.path.exists(name):
        raise InputFileError(f"{name}: there is no such file; check the path.")
    layout, header, points, tail, tail_at = _read_all(name, bbox, resolution)
    array = points.array
    is_part = bbox is not None or resolution is not None
    if len(array) < layout.n_points and not is_part:
        _warn(
            "points_missing",
            "{name}: the header announces {n_announced} points, the file ends after {n_points}; "
            "those are used",
            name=name,
            n_announced=layout.n_points,
            n_points=len(array),
        )
    lifted = lifted_attributes(name, attributes, points, header)
    chosen = _chosen(name, points, classes)
    if ground_first and classes is None:
        chosen = _ground(points)
        classes = None if chosen is None else (GROUND_CLASS,)
    aside = _aside(name, points, chosen, classes, keep_noise, keep_withheld)
    integers = np.empty((np.count_nonzero(chosen) if chosen is not None else len(array), 3), "i4")
    for k, axis in enumerate("XYZ"):
        integers[:, k] = select(array[axis], chosen)
    cloud = PointCloud(
        integers=integers,
        scales=np.array(layout.scales, dtype=np.float64),
        offsets=np.array(layout.offsets, dtype=np.float64),
        attributes=tuple(replace(a, values=select(a.values, chosen)) for a in lifted),
        carried=carried_fields(points, lifted, chosen) if carry else {},
        header=np.frombuffer(layout.block, np.uint8),
        evlrs=np.frombuffer(tail, np.uint8),
        n_in_file=len(array),
        classes=None if classes is None else tuple(int(c) for c in classes),
        aside=aside,
        evlrs_at=tail_at,
        is_altered=is_part,
    )
    if not is_part:
        _check_extent(name, layout, points)
    _warn_of_waveforms(name, layout)
    place = las_crs(projection_records(layout, tail, tail_at))
    warn_of_crs(name, place)
    return cloud, place


def warn_of_crs(name: str, place: Georeference) -> None:
    """Warn of what is odd about the CRS of a file."""
    for note in place.notes:
        warn(CrsWarning, "las_crs", "{name}: {fact}", name=name, fact=note, stacklevel=3)


def require_laspy() -> Any:
    """Return laspy; raise `MissingDependencyError`, with the remedy, where it is not there."""
    try:
        import laspy
    except ImportError as error:
        raise MissingDependencyError(
            "reading and writing LAS files needs laspy; install it with "
            "'pip install \"laspy[lazrs]\"'."
        ) from error
    return laspy


def _warn(code: str, template: str, *options: str, **figures: Any) -> None:
    warn(PointCloudWarning, code, template, *options, stacklevel=3, **figures)


def _read_all(
    name: str, bbox: Box | None = None, resolution: float | None = None
) -> tuple[LasLayout, LasHeader, PackedPointRecord, bytes, int | None]:
    """Return the layout, laspy's view of it, the points, and what follows them."""
    require_laspy()
    with open(name, "rb") as stream:
        layout = read_layout(name, stream)
        if layout.n_points == 0:
            raise InputFileError(f"{name}: the file holds no points; get it again.")
        header = laspy_header(name, layout)
        chunks: tuple[Chunk, ...] | None = None
        if (bbox is not None or resolution is not None) and is_copc(layout):
            chunks = tuple(chunks_within(name, layout, stream, bbox, resolution))
        elif resolution is not None:
            raise InputFileError(
                "{name}: this is no COPC file, and {0} is for its levels; leave it out.",
                "resolution",
                name=name,
            )
        try:
            points = _points(name, layout, header, stream, chunks)
        except MemoryError as error:
            raise InputFileError(
                f"{name}: the header announces more points than memory can hold; if that is no "
                "mistake, cut the file into tiles."
            ) from error
        if bbox is not None:
            points = _inside(name, layout, points, bbox)
        for note in layout.notes:
            _warn("las_header", "{name}: {fact}", name=name, fact=note)
        tail, tail_at = tail_of(name, layout, stream)
    return layout, header, points, tail, tail_at


def tail_of(name: str, layout: LasLayout, stream: BinaryIO) -> tuple[bytes, int | None]:
    """Return what is kept of what follows the points, and where it was."""
    start = layout.points_end
    if layout.is_compressed:
        places = [place for place in (layout.evlr_start, layout.waveform_start) if place]
        start = min(places, default=os.fstat(stream.fileno()).st_size)
    stream.seek(start)
    tail, tail_at, note = las_block.tail_of(stream.read(), start, layout)
    if note:
        _warn("las_header", "{name}: {fact}", name=name, fact=note)
    return tail, tail_at


def laspy_header(name: str, layout: LasLayout) -> LasHeader:
    """Return laspy's header, which knows the dimensions of the records."""
    laspy = require_laspy()
    try:
        header = laspy.LasHeader.read_from(io.BytesIO(las_block.for_laspy(layout)))
        n_bytes = header.point_format.dtype().itemsize
    # laspy lets whatever a damaged record provokes in it pass: struct, Unicode, value errors.
    except Exception as error:
        reason = str(error).splitlines()[0].rstrip(".") if str(error) else type(error).__name__
        raise InputFileError(
            f"{name}: this cannot be read as LAS or LAZ ({reason}); the file is damaged, get it "
            "again."
        ) from error
    if n_bytes != layout.record_length:
        raise InputFileError(
            f"{name}: the record on the extra dimensions describes points of {n_bytes} bytes, the "
            f"header of {layout.record_length}; the file is damaged, get it again."
        )
    return header


def _inside(
    name: str, layout: LasLayout, points: PackedPointRecord, bbox: Box
) -> PackedPointRecord:
    """Return the points in a box."""
    x, y = (
        points.array[axis] * layout.scales[k] + layout.offsets[k] for k, axis in enumerate("XY")
    )
    inside = (x >= bbox[0]) & (x <= bbox[2]) & (y >= bbox[1]) & (y <= bbox[3])
    if not inside.any():
        raise NoneChosenError(
            "{name}: there are no points in the box; x runs from {x_low:g} to {x_high:g}, y from "
            "{y_low:g} to {y_high:g}, give another {0}.",
            "bbox",
            name=name,
            x_low=layout.low[0],
            x_high=layout.high[0],
            y_low=layout.low[1],
            y_high=layout.high[1],
        )
    return require_laspy().PackedPointRecord(points.array[inside], points.point_format)


def _points(
    name: str,
    layout: LasLayout,
    header: LasHeader,
    stream: BinaryIO,
    chunks: tuple[Chunk, ...] | None = None,
) -> PackedPointRecord:
    laspy, dtype = require_laspy(), header.point_format.dtype()
    if not layout.is_compressed:
        stream.seek(layout.points_start)
        array = np.fromfile(stream, dtype, layout.n_points)
        return laspy.PackedPointRecord(array, header.point_format)
    job = laz_job(name, layout)
    if chunks is not None:
        job = job._replace(chunks=chunks, n_points=sum(chunk.n_points for chunk in chunks))
    array = np.empty(job.n_points, dtype)
    if len(array) == 0:  # a box beside all of it
        return laspy.PackedPointRecord(array, header.point_format)
    with decoding(name):
        laz_decoder.decoded(job, array.view(np.uint8))
    return laspy.PackedPointRecord(array, header.point_format)


def laz_job(name: str, layout: LasLayout) -> laz_decoder.Job:
    """Return what the decoder must know of a LAZ file, once its header is believed."""
    if find_spec("lazrs") is None:
        raise MissingDependencyError(
            f"{name}: reading LAZ needs lazrs; install it with 'pip install lazrs'."
        )
    n_bytes = os.stat(name).st_size - layout.points_start
    if layout.n_points * layout.record_length > _MOST_COMPRESSED * n_bytes:
        raise InputFileError(
            f"{name}: the header announces {layout.n_points} points in {n_bytes} compressed bytes; "
            "the file is damaged, get it again."
        )
    return laz_decoder.Job(
        path=name,
        start=layout.points_start,
        record=laszip_record(name, layout).data,
        record_length=layout.record_length,
        n_points=layout.n_points,
    )


@contextmanager
def decoding(name: str) -> Iterator[None]:
    """Report what the decoder refuses as any other damaged file is reported."""
    try:
        yield
    except laz_decoder.DecodeError as error:
        raise InputFileError(
            f"{name}: the compressed points cannot be read ({error}); the file is damaged, get it "
            "again."
        ) from error


def _check_extent(name: str, layout: LasLayout, points: PackedPointRecord) -> None:
    """Refuse coordinates that no CRS has, and warn of a header that claims others than there are.

    A header with other bounds than its points is how a damaged scale or offset shows.
    """
    for k, axis in enumerate("xyz"):
        stored = points.array[axis.upper()]
        ends = np.array([stored.min(), stored.max()]) * layout.scales[k] + layout.offsets[k]
        low, high = float(ends.min()), float(ends.max())
        if max(-low, high) > LARGEST_COORDINATE:
            raise InputFileError(
                f"{name}: {axis} runs from {low:g} to {high:g}, which no CRS has; the scales and "
                "offsets in the header are wrong, or the file is damaged: get it again."
            )
        # Many writers round the bounds, to a unit in the last place or to the next number.
        slack = 1.5 * abs(layout.scales[k]) + 1e-9 * max(-low, high) + 5e-4 * (high - low)
        claimed = layout.low[k], layout.high[k]
        if not (abs(claimed[0] - low) <= slack and abs(claimed[1] - high) <= slack):
            _warn(
                "header_extent",
                "{name}: the header says that {axis} runs from {claimed[0]:.10g} to "
                "{claimed[1]:.10g}, the points run from {found[0]:.10g} to {found[1]:.10g}; if "
                "that is no old mistake, the file is damaged",
                name=name,
                axis=axis,
                claimed=claimed,
                found=(low, high),
            )


def projection_records(
    layout: LasLayout, tail: bytes, tail_at: int | None
) -> list[tuple[int, bytes]]:
    """Return the records on the CRS: number and content."""
    first = 0 if tail_at is None else layout.evlr_start - tail_at
    found = [(r, layout.block) for r in layout.vlrs]
    if layout.n_evlrs:
        found += [(r, tail) for r in records_of(tail, first, layout.n_evlrs, extended=True)]
    return [
        (r.record_id, block[r.data_start : r.end])
        for r, block in found
        if r.user_id == "LASF_Projection"
    ]


def _aside(
    name: str,
    points: PackedPointRecord,
    chosen: NDArray[np.bool_] | None,
    classes: Sequence[int] | None,
    keep_noise: bool,
    keep_withheld: bool,
) -> NDArray[np.bool_] | None:
    """Return which of the chosen points are carried only, and say how many they are."""
    is_withheld, is_noise = (
        select(mask, chosen) for mask in masks_aside(points, classes, keep_noise, keep_withheld)
    )
    aside = is_noise | is_withheld
    n_aside = int(np.count_nonzero(aside))
    if n_aside == 0:
        return None
    parts = [
        f"{np.count_nonzero(mask)} {what}"
        for mask, what in (
            (is_withheld, "with the withheld flag"),
            (is_noise & ~is_withheld, "of the noise classes 7 and 18"),
        )
        if mask.any()
    ]
    options = [
        option
        for mask, option in ((is_withheld, "keep_withheld"), (is_noise, "keep_noise"))
        if mask.any()
    ]
    ways = " and ".join(f"{{{k}}}" for k in range(len(options)))
    if n_aside == len(aside):
        raise InputFileError(
            "{name}: all points are left out of the surface ({parts}); keep them with "
            + ways
            + ".",
            *options,
            name=name,
            parts=" and ".join(parts),
        )
    _warn(
        "points_aside",
        "{name}: {n_aside} of {n_points} points are left out of the surface ({parts}); they are "
        f"carried along, {ways} let{'s' * (len(options) == 1)} them in",
        *options,
        name=name,
        n_aside=n_aside,
        n_points=len(aside),
        parts=" and ".join(parts),
    )
    return aside


def masks_aside(
    points: PackedPointRecord,
    classes: Sequence[int] | None,
    keep_noise: bool,
    keep_withheld: bool,
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which points are carried only: for their withheld flag, and as noise.

    Parameters
    ----------
    points : PackedPointRecord
    classes, keep_noise, keep_withheld
        See `read_cloud`.
    """
    of_point = np.array(points["classification"])
    noise_classes = [] if keep_noise else [c for c in NOISE_CLASSES if c not in (classes or ())]
    is_withheld = np.array(points["withheld"]).astype(bool)
    if keep_withheld:
        is_withheld = np.zeros_like(is_withheld)
    return is_withheld, np.isin(of_point, noise_classes)


def _chosen(
    name: str, points: PackedPointRecord, classes: Sequence[int] | None
) -> NDArray[np.bool_] | None:
    if classes is None:
        return None
    of_point = np.array(points["classification"])
    chosen: NDArray[np.bool_] = np.isin(of_point, list(classes))
    if not chosen.any():
        present = ", ".join(str(c) for c in np.unique(of_point))
        raise NoneChosenError(
            f"{name}: no point has class {', '.join(map(str, classes))}; the classes in the file "
            f"are {present}."
        )
    return chosen


def _ground(points: PackedPointRecord) -> NDArray[np.bool_] | None:
    """Return which points are last returns of the ground; None where too few for a surface are."""
    is_last = np.array(points["return_number"]) >= np.array(points["number_of_returns"])
    is_ground: NDArray[np.bool_] = is_last & (np.array(points["classification"]) == GROUND_CLASS)
    return is_ground if np.count_nonzero(is_ground) >= 3 else None


def _warn_of_waveforms(name: str, layout: LasLayout) -> None:
    if layout.point_format not in _WAVEFORM_FORMATS or layout.waveform_start:
        return
    where = "another file (.wdp)" if layout.has_outside_waveforms else "no place the header names"
    _warn(
        "waveforms",
        "{name}: the points refer to waveforms in {where}; their references are carried, the "
        "waveform samples themselves are not",
        name=name,
        where=where,
    )
