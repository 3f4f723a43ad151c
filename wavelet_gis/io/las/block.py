"""The bytes around the points of a LAS file, written back as they came.

Where nothing was asked to change, an uncompressed file comes back byte for byte: the block before
the points and all that follows them are written as they were read. What must differ (a record on
the compression, another dimension, another number of points) is changed in those bytes and nothing
else is.
"""

from __future__ import annotations

import struct
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.io.las.layout import (
    EVLRS,
    LONG_RETURNS,
    POINT_COUNT,
    RECORD_LENGTHS,
    RETURNS,
    SCALING,
    SIZES,
    WAVEFORM,
    LasLayout,
    Record,
    parse_layout,
    records_of,
)
from wavelet_gis.model.points.cloud import PointCloud

__all__ = ["TailPlace", "described", "for_laspy", "moved", "rebuilt", "tail_of", "with_counts"]

#: Owners of VLRs on how points are compressed or arranged, wrong in any file written anew.
_STALE_OWNERS = ("laszip encoded", "copc")

#: Of an extra-byte record: bytes of one description, and of one value of each type.
_DESCRIPTION = 192
_TYPE_SIZES = (0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8)
_FLOAT32 = 9

#: Points that the fields of LAS 1.3 and older can count.
_LEGACY_LIMIT = 1 << 32

TailPlace = int | None


def for_laspy(layout: LasLayout) -> bytes:
    """Return the header with the one record that laspy needs: that on the extra dimensions.

    Names and descriptions in another encoding than UTF-8 are written in ASCII, since laspy refuses
    them; the block that is kept still has them as they came.
    """
    records = []
    for record in layout.vlrs:
        if not _is_extra_bytes(record):
            continue
        data = bytearray(layout.block[record.data_start : record.end])
        for start in range(0, len(data) - _DESCRIPTION + 1, _DESCRIPTION):
            for text in (slice(start + 4, start + 36), slice(start + 160, start + 192)):
                data[text] = bytes(byte if byte < 128 else ord("?") for byte in data[text])
        records.append(_vlr(b"LASF_Spec", 4, bytes(data), b""))
    block = bytearray(layout.block[: layout.header_size])
    n_bytes = layout.header_size + sum(map(len, records))
    struct.pack_into("<II", block, SIZES + 2, n_bytes, len(records))
    return bytes(block) + b"".join(records)


def tail_of(content: bytes, start: int, layout: LasLayout) -> tuple[bytes, TailPlace, str]:
    """Return what is kept of the bytes behind the points, the offset they had, and a note.

    Parameters
    ----------
    content : bytes
        The file from `start` to its end.
    start : int
        Offset of `content`.
    layout : LasLayout
        Says where the EVLRs begin.

    Returns
    -------
    bytes, int or None, str
        The offset is None where the EVLRs were taken out of their places and put together.
    """
    first = layout.evlr_start - start
    evlrs = tuple(records_of(content, first, layout.n_evlrs, extended=True))
    note = ""
    if len(evlrs) < layout.n_evlrs:
        note = (
            f"the header announces {layout.n_evlrs} EVLRs, {len(evlrs)} lie whole in the file; "
            "those are used"
        )
    if not layout.is_compressed:
        return content, start, note
    kept = [record for record in evlrs if record.user_id not in _STALE_OWNERS]
    if len(kept) == len(evlrs):
        return content, start, note
    return b"".join(content[r.start : r.end] for r in kept), None, note


def rebuilt(layout: LasLayout, *, laszip: bytes | None = None) -> LasLayout:
    """Return the layout of a file with its points compressed in another way.

    Parameters
    ----------
    layout : LasLayout
        As it was read.
    laszip : bytes, optional
        The record on the compression; without it the file is an uncompressed one.
    """
    if not layout.is_compressed and laszip is None:
        return layout
    kept = [
        layout.block[r.start : r.end]
        for r in layout.vlrs
        if not (r.user_id in _STALE_OWNERS and (layout.is_compressed or laszip is not None))
    ]
    if laszip is not None:
        kept.append(_vlr(b"laszip encoded", 22204, laszip, b"terrain-wavelets"))
    byte = layout.point_format | (0x80 if laszip is not None else 0)
    return _with_vlrs(layout, kept, format_byte=byte, record_length=layout.record_length)


def described(layout: LasLayout, name: str, description: str) -> LasLayout:
    """Return the layout of a file whose records have one more dimension, a float32, at their end.

    Parameters
    ----------
    layout : LasLayout
        Of an uncompressed file.
    name, description : str
        Of the new dimension, up to 31 characters.
    """
    at = next((k for k, r in enumerate(layout.vlrs) if _is_extra_bytes(r)), None)
    kept = [layout.block[r.start : r.end] for r in layout.vlrs]
    known = b"" if at is None else layout.block[layout.vlrs[at].data_start : layout.vlrs[at].end]
    known = known[: len(known) // _DESCRIPTION * _DESCRIPTION]
    unnamed = layout.record_length - RECORD_LENGTHS[layout.point_format] - _described_bytes(known)
    if unnamed > 0:  # extra bytes that no record describes come before the new ones
        known += b"".join(
            _description(0, min(255, unnamed - k), b"", b"") for k in range(0, unnamed, 255)
        )
    known += _description(_FLOAT32, 0, name.encode(), description.encode())
    record = _vlr(b"LASF_Spec", 4, known, b"Extra Bytes Record")
    if at is None:
        kept.append(record)
    else:
        kept[at] = record
    return _with_vlrs(
        layout, kept, format_byte=layout.point_format, record_length=layout.record_length + 4
    )


def with_counts(
    block: bytes, cloud: PointCloud, return_numbers: NDArray[np.integer] | None
) -> bytes:
    """Return the block with the number, returns and extent of the points brought up to date.

    Parameters
    ----------
    block : bytes
        Header and VLRs.
    cloud : PointCloud
        What is written.
    return_numbers : (n_points,) integers, optional
        Of the points, counted from 1.
    """
    changed, minor, n_points = bytearray(block), block[25], cloud.n_points
    by_return = np.zeros(15, dtype=np.int64)
    if return_numbers is not None:
        by_return = np.bincount(return_numbers, minlength=16)[1:16]
    is_legacy = minor < 4 or struct.unpack_from("<I", block, SIZES + 13)[0] != 0
    if is_legacy and n_points < _LEGACY_LIMIT:
        struct.pack_into("<I", changed, SIZES + 13, n_points)
        struct.pack_into("<5I", changed, RETURNS, *by_return[:5].tolist())
    if minor >= 4:
        struct.pack_into("<Q", changed, POINT_COUNT, n_points)
        struct.pack_into("<15Q", changed, LONG_RETURNS, *by_return.tolist())
    extent = np.array([cloud.integers.max(axis=0), cloud.integers.min(axis=0)])
    ends = np.sort(extent * cloud.scales + cloud.offsets, axis=0)[::-1]  # a scale may be negative
    struct.pack_into("<6d", changed, SCALING + 48, *ends.T.ravel().tolist())
    return bytes(changed)


def moved(block: bytes, layout: LasLayout, tail: bytes, was_at: TailPlace, is_at: int) -> bytes:
    """Return the block with the places of EVLRs and waveforms, which now follow `is_at`.

    Parameters
    ----------
    block : bytes
        Header and VLRs.
    layout : LasLayout
        As it was read, with the places of then.
    tail : bytes
        What follows the points.
    was_at : int or None
        Offset of `tail` in the file that was read; None where it begins with the EVLRs.
    is_at : int
        Offset of `tail` in the file that is written.
    """
    changed = bytearray(block)
    if layout.minor >= 4:
        start, announced = struct.unpack_from("<QI", block, EVLRS)
        first = 0 if was_at is None else start - was_at
        if announced and start and (was_at != is_at or first >= len(tail)):
            n_evlrs = len(list(records_of(tail, first, announced, extended=True)))
            struct.pack_into("<QI", changed, EVLRS, is_at + first if n_evlrs else 0, n_evlrs)
    if layout.waveform_start and was_at is not None and was_at != is_at:
        start = layout.waveform_start - was_at
        struct.pack_into("<Q", changed, WAVEFORM, is_at + start if start < len(tail) else 0)
    return bytes(changed)


def _with_vlrs(
    layout: LasLayout, vlrs: list[bytes], *, format_byte: int, record_length: int
) -> LasLayout:
    block = bytearray(layout.block[: layout.header_size])
    gap = layout.block[layout.vlrs_end :]
    n_bytes = layout.header_size + sum(map(len, vlrs)) + len(gap)
    struct.pack_into("<IIBH", block, SIZES + 2, n_bytes, len(vlrs), format_byte, record_length)
    made = parse_layout("", bytes(block) + b"".join(vlrs) + gap)
    return replace(made, evlr_start=layout.evlr_start, waveform_start=layout.waveform_start)


def _vlr(owner: bytes, record_id: int, data: bytes, description: bytes) -> bytes:
    return struct.pack("<H16sHH32s", 0, owner, record_id, len(data), description) + data


def _is_extra_bytes(record: Record) -> bool:
    return record.user_id == "LASF_Spec" and record.record_id == 4


def _described_bytes(data: bytes) -> int:
    total = 0
    for start in range(0, len(data), _DESCRIPTION):
        kind, options = data[start + 2], data[start + 3]
        of_one = _TYPE_SIZES[(kind - 1) % 10 + 1] if kind else options
        total += of_one * ((kind - 1) // 10 + 1 if kind else 1)
    return total


def _description(kind: int, options: int, name: bytes, text: bytes) -> bytes:
    return struct.pack("<2xBB32s124x32s", kind, options, name, text)
