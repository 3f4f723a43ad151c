"""LAS and LAZ files out: the header, VLRs and dimensions that came in, read back."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import MissingDependencyError
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.las import block as las_block
from wavelet_gis.io.las import laz_decoder
from wavelet_gis.io.las.cloud_reader import laspy_header, require_laspy
from wavelet_gis.io.las.dimensions import HEIGHT_ABOVE_GROUND
from wavelet_gis.io.las.layout import (
    RECORD_LENGTHS,
    LasLayout,
    laszip_record,
    parse_layout,
)
from wavelet_gis.io.read_back import read_back
from wavelet_gis.model.attributes.categories import channel_category
from wavelet_gis.model.points.cloud import PointAttribute, PointCloud

if TYPE_CHECKING:
    from laspy.point.record import PackedPointRecord

__all__ = ["record_array", "write_cloud", "write_records"]

#: Points written, and read back, at once; read back, no more than so many bytes of them.
_BATCH = 1_000_000
_BATCH_BYTES = 1 << 26


def write_cloud(path: str | os.PathLike[str], cloud: PointCloud) -> None:
    """Write the points with the header, VLRs and dimensions they came with.

    Parameters
    ----------
    path : path
        ``.laz`` is compressed, anything else is not.
    cloud : PointCloud
        What to write. Where it is what was read, an uncompressed file is byte for byte the one
        that was read if that was uncompressed too.

    Raises
    ------
    OutputFileError
        When the points cannot be compressed, or need lazrs.
    """
    was = parse_layout("the stored LAS header", cloud.header.tobytes())
    layout = las_block.rebuilt(was)
    record = _record_of(cloud, layout)
    content = np.ascontiguousarray(record.array).view(np.uint8).reshape(cloud.n_points, -1)
    for attribute in cloud.attributes:
        if attribute.dimension == HEIGHT_ABOVE_GROUND and not _has_dimension(record, attribute):
            layout = las_block.described(layout, attribute.name, "Height above ground")
            heights = attribute.values.astype("<f4").reshape(-1, 1).view(np.uint8)
            content = np.hstack([content, heights])
    is_altered = cloud.n_points != was.n_points or cloud.is_altered
    counted = cloud if is_altered else None
    _write(path, was, layout, content, cloud.evlrs.tobytes(), cloud.evlrs_at, counted, record)


def record_array(cloud: PointCloud) -> NDArray[Any]:
    """Return the point records of a cloud, as its file has them."""
    layout = las_block.rebuilt(parse_layout("the stored LAS header", cloud.header.tobytes()))
    return _record_of(cloud, layout).array


def write_records(
    path: str | os.PathLike[str],
    was: LasLayout,
    records: NDArray[Any],
    tail: bytes,
    tail_at: int | None,
    *,
    is_altered: bool,
) -> None:
    """Write point records with the header and the tail of a file that was read.

    Parameters
    ----------
    path : path
        ``.laz`` is compressed, anything else is not.
    was : LasLayout
        Of the file that was read.
    records : (n_points,) structured array
        Of its point format; a memory map may be larger than memory.
    tail, tail_at
        See `wavelet_gis.io.las.batches.CloudHead`.
    is_altered : bool
        Whether these are other points than the file had, to be counted anew.

    Raises
    ------
    OutputFileError
        As `write_cloud`.
    """
    layout = las_block.rebuilt(was)
    header = laspy_header("the stored LAS header", layout)
    content = records.view(np.uint8).reshape(len(records), -1)
    counted = record = None
    if is_altered:
        record = require_laspy().PackedPointRecord(records, header.point_format)
        counted = PointCloud(
            integers=np.column_stack([records[axis] for axis in "XYZ"]),
            scales=np.array(layout.scales),
            offsets=np.array(layout.offsets),
        )
    _write(path, was, layout, content, tail, tail_at, counted, record)


def _write(
    path: str | os.PathLike[str],
    was: LasLayout,
    layout: LasLayout,
    content: NDArray[np.uint8],
    tail: bytes,
    tail_at: int | None,
    counted: PointCloud | None,
    record: PackedPointRecord | None,
) -> None:
    compressor = _laz_record(path, layout) if Path(path).suffix.lower() == ".laz" else None
    if compressor is not None:
        layout = las_block.rebuilt(layout, laszip=bytes(compressor.record_data()))
    block = layout.block
    if counted is not None and record is not None:
        block = las_block.with_counts(block, counted, _return_numbers(record))
    with open(path, "wb") as stream:
        stream.write(block)
        _write_points(path, stream, content, layout.point_format, compressor)
        end = stream.seek(0, os.SEEK_END)
        stream.write(tail)
        stream.seek(0)
        stream.write(las_block.moved(block, was, tail, tail_at, end))
    read_back(path, partial(_verify, layout=layout, content=content))


def _put(record: PackedPointRecord, attribute: PointAttribute) -> None:
    """Put the stored values of an attribute in its dimension."""
    if attribute.dimension in (record.array.dtype.names or ()):
        field = record.array[attribute.dimension]
        if attribute.component is None:
            field[:] = attribute.values
        else:
            field[:, attribute.component] = attribute.values
        return
    largest = record.point_format.dimension_by_name(attribute.dimension).max or 0
    record[attribute.dimension] = np.minimum(attribute.values, largest)


def _has_dimension(record: PackedPointRecord, attribute: PointAttribute) -> bool:
    return attribute.name in list(record.point_format.dimension_names)


def _record_of(cloud: PointCloud, layout: LasLayout) -> PackedPointRecord:
    """Return the point records, every field in its place."""
    header = laspy_header("the stored LAS header", layout)
    record = require_laspy().PackedPointRecord.zeros(cloud.n_points, header.point_format)
    for attribute in cloud.attributes:
        category = channel_category(attribute)
        if category is not None:  # what is carried comes over it
            dimension, value = category
            record[dimension] = np.where(attribute.values != 0, value, record[dimension])
    for name, values in cloud.carried.items():
        if name in (record.array.dtype.names or ()) and name not in ("X", "Y", "Z"):
            record.array[name] = values
    for k, axis in enumerate("XYZ"):
        record.array[axis] = cloud.integers[:, k]
    for attribute in cloud.attributes:
        is_stored = attribute.dimension != HEIGHT_ABOVE_GROUND or _has_dimension(record, attribute)
        if is_stored and channel_category(attribute) is None:
            _put(record, attribute)
    return record


def _return_numbers(record: PackedPointRecord) -> NDArray[np.integer]:
    return np.array(record["return_number"])


def _laz_record(path: str | os.PathLike[str], layout: LasLayout) -> Any:
    """Return lazrs' record on the compression of such points."""
    try:
        import lazrs
    except ImportError as error:
        raise MissingDependencyError(
            f"{path}: writing LAZ needs lazrs; install it with 'pip install lazrs'."
        ) from error
    n_extra = layout.record_length - RECORD_LENGTHS[layout.point_format]
    try:
        return lazrs.LazVlr.new_for_compression(layout.point_format, n_extra)
    except lazrs.LazrsError as error:
        raise _not_compressible(path, layout.point_format, error) from error


def _write_points(
    path: str | os.PathLike[str],
    stream: BinaryIO,
    content: NDArray[np.uint8],
    point_format: int,
    laz: Any,
) -> None:
    batches = [content[k : k + _BATCH] for k in range(0, len(content), _BATCH)]
    if laz is None:
        for batch in batches:
            stream.write(np.ascontiguousarray(batch).data)
        return
    import lazrs

    try:
        # One thread: a pool of them would hang in a process that is forked later.
        compressor = lazrs.LasZipCompressor(stream, laz)
        for batch in batches:
            compressor.compress_many(np.ascontiguousarray(batch).reshape(-1))
        compressor.done()
    except lazrs.LazrsError as error:
        raise _not_compressible(path, point_format, error) from error


def _verify(path: str | os.PathLike[str], layout: LasLayout, content: NDArray[np.uint8]) -> None:
    """Read the points back: lazrs loses some waveform references without a word."""
    n_read = n_other = 0

    def take(batch: memoryview) -> None:
        nonlocal n_read, n_other
        back = np.frombuffer(batch, np.uint8).reshape(-1, content.shape[1])
        due = content[n_read : n_read + len(back)]
        n_other += int(np.count_nonzero((back[: len(due)] != due).any(axis=1)))
        n_read += len(back)

    if not layout.is_compressed:
        with open(path, "rb") as stream:
            stream.seek(layout.points_start)
            n_bytes = _read_at_once(*content.shape) * content.shape[1]
            while n_read < len(content) and (batch := stream.read(n_bytes)):
                take(memoryview(batch[: len(batch) // content.shape[1] * content.shape[1]]))
                if len(batch) < n_bytes:
                    break
        if n_read < len(content) or n_other:
            raise OutputFileError("the points are not those that were written")
        return
    job = laz_decoder.Job(
        path=os.fspath(path),
        start=layout.points_start,
        record=laszip_record(os.fspath(path), layout).data,
        record_length=content.shape[1],
        n_points=len(content),
    )
    try:
        laz_decoder.decoded_in_batches(job, _read_at_once(*content.shape), take)
    except laz_decoder.DecodeError as error:
        raise _not_compressible(path, layout.point_format, error) from error
    if n_other:
        raise _not_compressible(
            path, layout.point_format, f"{n_other} of {len(content)} points come back changed"
        )


def _read_at_once(n_points: int, record_length: int) -> int:
    """Return how many points are read back at once: records may have 64 kB."""
    return max(min(n_points, _BATCH, _BATCH_BYTES // record_length), 1)


def _not_compressible(path: Any, point_format: int, why: object) -> OutputFileError:
    return OutputFileError(
        f"{path}: points of format {point_format} cannot be written as LAZ ({why}); write .las."
    )
