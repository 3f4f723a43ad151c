"""The header, VLRs and EVLRs of a LAS file as bytes, every number held against the file's size.

laspy trusts what a header says, and so would read a billion records out of 15 kB. Here each count
and length is checked before anything of that size is made, and what is not understood is kept as
it came, so that it can be given back byte for byte.
"""

from __future__ import annotations

import math
import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO, NamedTuple

from wavelet_gis.errors import InputFileError

__all__ = [
    "LARGEST_COORDINATE",
    "RECORD_LENGTHS",
    "LasLayout",
    "LaszipRecord",
    "Record",
    "laszip_record",
    "parse_layout",
    "read_layout",
    "records_of",
]

#: No CRS has coordinates beyond this, in whatever unit: the earth is 1.3e8 feet round.
LARGEST_COORDINATE = 1e9

#: Scales beyond these are finer than an atom or coarser than a country.
SMALLEST_SCALE, LARGEST_SCALE = 1e-12, 1e6

#: Bytes of a header by minor version, the least that holds its fields.
_HEADER_SIZES = {0: 227, 1: 227, 2: 227, 3: 235, 4: 375, 5: 393}

#: Bytes of a point record by format, without extra bytes.
RECORD_LENGTHS = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)

#: The largest point format that a minor version has.
_LAST_FORMATS = {0: 1, 1: 1, 2: 3, 3: 5, 4: 10, 5: 10}

_VLR_HEADER, _EVLR_HEADER = struct.Struct("<H16sHH32s"), struct.Struct("<H16sHQ32s")

#: Where the header holds what is read or written here.
ENCODING, SIZES, SCALING, WAVEFORM, EVLRS, POINT_COUNT = 6, 94, 131, 227, 235, 247
#: The tables of points by return, before and since LAS 1.4.
RETURNS, LONG_RETURNS = 111, 255

#: Global encoding: where the waveform packets are.
_WAVEFORMS_INSIDE, _WAVEFORMS_OUTSIDE = 2, 4

#: Items of a compressed record and their sizes; those of extra bytes have any.
_ITEM_SIZES = {6: 20, 7: 8, 8: 6, 9: 29, 10: 30, 11: 6, 12: 8, 13: 29}
_EXTRA_ITEMS = (0, 14)

#: The items that a point format must have.
_ITEMS_OF_FORMAT = (
    (6,),
    (6, 7),
    (6, 8),
    (6, 7, 8),
    (6, 7, 9),
    (6, 7, 8, 9),
    (10,),
    (10, 11),
    (10, 12),
    (10, 13),
    (10, 12, 13),
)


class Record(NamedTuple):
    """One VLR or EVLR: who defined it, and where its bytes lie in the block that it is part of."""

    user_id: str
    record_id: int
    start: int
    data_start: int
    end: int


class LaszipRecord(NamedTuple):
    """How the points of a LAZ file are compressed.

    data : bytes
        The whole record, as the decoder wants it.
    compressor : int
        1 for one stream of points, 2 and 3 for chunks.
    chunk_size : int
        Points in a chunk; 2^32 - 1 where chunks differ.
    """

    data: bytes
    compressor: int
    chunk_size: int

    @property
    def is_variable(self) -> bool:
        """Whether the chunks hold different numbers of points."""
        return self.chunk_size == 0xFFFFFFFF


@dataclass(frozen=True, slots=True)
class LasLayout:
    """Where everything in a LAS file lies.

    Attributes
    ----------
    block : bytes
        The file up to its first point.
    minor : int
        LAS 1.minor.
    header_size, record_length, point_format, n_points : int
        As the header has them; `point_format` without the bit of the compression.
    is_compressed : bool
        Whether this is a LAZ file.
    scales, offsets, high, low : tuple of float
        Of x, y and z.
    vlrs : tuple of Record
        In `block`.
    evlr_start, n_evlrs, waveform_start : int
        Offsets in the file, 0 for none.
    notes : tuple of str
        What is odd but usable.
    """

    block: bytes
    minor: int
    header_size: int
    record_length: int
    point_format: int
    is_compressed: bool
    n_points: int
    scales: tuple[float, ...]
    offsets: tuple[float, ...]
    high: tuple[float, ...]
    low: tuple[float, ...]
    vlrs: tuple[Record, ...]
    evlr_start: int = 0
    n_evlrs: int = 0
    waveform_start: int = 0
    notes: tuple[str, ...] = ()

    @property
    def points_start(self) -> int:
        """Offset of the first point."""
        return len(self.block)

    @property
    def points_end(self) -> int:
        """Offset behind the last point of an uncompressed file."""
        return self.points_start + self.n_points * self.record_length

    @property
    def vlrs_end(self) -> int:
        """Offset behind the last VLR."""
        return self.vlrs[-1].end if self.vlrs else self.header_size

    @property
    def has_outside_waveforms(self) -> bool:
        """Whether the waveform packets are in another file."""
        return bool(self.block[ENCODING] & _WAVEFORMS_OUTSIDE)


def read_layout(name: str, stream: BinaryIO) -> LasLayout:
    """Return the layout of an open file, from its first bytes and its size.

    Raises
    ------
    InputFileError
        When it is no LAS file, or says of itself what cannot be.
    """
    size = os.fstat(stream.fileno()).st_size
    stream.seek(0)
    start = stream.read(_HEADER_SIZES[0])
    if start[:4] != b"LASF" or len(start) < _HEADER_SIZES[0]:
        raise InputFileError(
            f"{name}: this cannot be read as LAS or LAZ (it does not begin with a LAS header); "
            "the file is damaged or of another format, get it again."
        )
    (offset_to_points,) = struct.unpack_from("<I", start, SIZES + 2)
    if offset_to_points > size:
        raise _refusal(
            name,
            f"the header says that the points begin at byte {offset_to_points} of {size}",
        )
    stream.seek(0)
    return parse_layout(name, stream.read(offset_to_points), size)


def parse_layout(name: str, block: bytes, size: int | None = None) -> LasLayout:
    """Return the layout that the bytes before the first point describe.

    Parameters
    ----------
    name : str
        Of the file, for messages.
    block : bytes
        Header, VLRs, and what lies between them and the points.
    size : int, optional
        Of the file; without it, counts of points and EVLRs are not held against anything.

    Raises
    ------
    InputFileError
        When the header says what cannot be.
    """
    if block[:4] != b"LASF" or len(block) < _HEADER_SIZES[0]:
        raise _refusal(name, "the LAS header is cut short")
    major, minor = block[24], block[25]
    if major != 1 or minor not in _HEADER_SIZES:
        raise _refusal(name, f"LAS {major}.{minor} does not exist (1.0 to 1.5 do)")
    header_size, offset_to_points, n_vlrs, format_byte, record_length, n_points = (
        struct.unpack_from("<HIIBHI", block, SIZES)
    )
    notes: list[str] = []
    if not _HEADER_SIZES[minor] <= header_size <= len(block) or offset_to_points != len(block):
        raise _refusal(
            name,
            f"the header of LAS 1.{minor} says that it has {header_size} bytes and that the points "
            f"begin at byte {offset_to_points}",
        )
    is_compressed, point_format = bool(format_byte & 0x80), format_byte & 0x7F
    if point_format >= len(RECORD_LENGTHS):
        raise _refusal(name, f"there is no point format {point_format}")
    if record_length < RECORD_LENGTHS[point_format]:
        raise _refusal(
            name,
            f"records of point format {point_format} have {RECORD_LENGTHS[point_format]} bytes or "
            f"more, not {record_length}",
        )
    if point_format > _LAST_FORMATS[minor]:
        notes.append(f"LAS 1.{minor} has no point format {point_format}; it is read as it stands")
    if minor >= 4:
        n_points = _point_count(n_points, struct.unpack_from("<Q", block, POINT_COUNT)[0], notes)
    _check_returns(block, minor, n_points, notes)
    numbers = struct.unpack_from("<12d", block, SCALING)
    _check_scaling(name, numbers[:3], numbers[3:6])
    layout = LasLayout(
        block=block,
        minor=minor,
        header_size=header_size,
        record_length=record_length,
        point_format=point_format,
        is_compressed=is_compressed,
        n_points=n_points,
        scales=numbers[:3],
        offsets=numbers[3:6],
        high=numbers[6::2],
        low=numbers[7::2],
        vlrs=_vlrs(name, block, header_size, n_vlrs, notes),
        notes=(),
    )
    return _with_what_follows(name, layout, size, notes)


def laszip_record(name: str, layout: LasLayout) -> LaszipRecord:
    """Return the record on the compression of a LAZ file.

    Raises
    ------
    InputFileError
        When there is none, or it does not fit the point format.
    """
    for record in layout.vlrs:
        if record.user_id == "laszip encoded" and record.record_id == 22204:
            data = layout.block[record.data_start : record.end]
            break
    else:
        raise _refusal(name, "the points are compressed and no record says how")
    if len(data) < 34:
        raise _refusal(name, "the record on the compression is cut short")
    compressor, coder = struct.unpack_from("<HH", data)
    chunk_size, n_items = struct.unpack_from("<I16xH", data, 12)
    if len(data) < 34 + 6 * n_items or compressor not in (1, 2, 3) or coder != 0:
        raise _refusal(name, f"there is no LAZ compression {compressor} with {n_items} items")
    items = [struct.unpack_from("<HHH", data, 34 + 6 * k)[:2] for k in range(n_items)]
    kinds = tuple(kind for kind, _ in items if kind not in _EXTRA_ITEMS)
    fits = (
        sum(length for _, length in items) == layout.record_length
        and all(_ITEM_SIZES.get(kind, length) == length for kind, length in items)
        and sorted(kinds) == sorted(_ITEMS_OF_FORMAT[layout.point_format])
        and all(kind in _ITEM_SIZES or kind in _EXTRA_ITEMS for kind, _ in items)
    )
    if not fits:
        raise _refusal(
            name,
            f"the compression is that of other records than those of point format "
            f"{layout.point_format} with {layout.record_length} bytes",
        )
    if compressor != 1 and chunk_size == 0:
        raise _refusal(name, "the compressed chunks are said to hold no points")
    return LaszipRecord(data, compressor, chunk_size)


def records_of(block: bytes, start: int, count: int, *, extended: bool) -> Iterator[Record]:
    """Yield up to `count` records from a place in a block, as many as lie whole in it.

    Parameters
    ----------
    block : bytes
        Holds the records one after the other.
    start : int
        Of the first.
    count : int
        Of records.
    extended : bool
        EVLRs, whose lengths have eight bytes, instead of VLRs.
    """
    head = _EVLR_HEADER if extended else _VLR_HEADER
    for _ in range(count):
        if not 0 <= start <= len(block) - head.size:
            return
        _, user_id, record_id, length, _ = head.unpack_from(block, start)
        end = start + head.size + length
        if end > len(block):
            return
        owner = user_id.split(b"\0")[0].decode("ascii", errors="replace").strip()
        yield Record(owner, record_id, start, start + head.size, end)
        start = end


def _refusal(name: str, what: str) -> InputFileError:
    return InputFileError(f"{name}: {what}; the file is damaged, get it again.")


def _point_count(legacy: int, count: int, notes: list[str]) -> int:
    """Return the number of points of LAS 1.4, which has a field for old readers beside its own."""
    if legacy in (0, count):
        return count
    if count == 0:
        notes.append(f"the number of points stands only where LAS 1.3 has it ({legacy})")
        return legacy
    notes.append(f"the header has two numbers of points, {legacy} and {count}; the second is used")
    return count


def _check_returns(block: bytes, minor: int, n_points: int, notes: list[str]) -> None:
    """Note where the header counts more points by return than in all: some may be left unread."""
    by_return = struct.unpack_from("<5I", block, RETURNS)
    if minor >= 4 and not any(by_return):
        by_return = struct.unpack_from("<15Q", block, LONG_RETURNS)
    if sum(by_return) > n_points:
        notes.append(
            f"the header counts {sum(by_return)} points by return and {n_points} in all; "
            f"the first {n_points} are read"
        )


def _check_scaling(name: str, scales: tuple[float, ...], offsets: tuple[float, ...]) -> None:
    sound = all(
        math.isfinite(scale) and SMALLEST_SCALE <= abs(scale) <= LARGEST_SCALE for scale in scales
    ) and all(math.isfinite(offset) and abs(offset) <= LARGEST_COORDINATE for offset in offsets)
    if not sound:
        raise _refusal(
            name,
            f"the header has the scales {list(scales)} and offsets {list(offsets)}, which give no "
            "coordinates that a CRS has",
        )


def _vlrs(
    name: str, block: bytes, header_size: int, n_vlrs: int, notes: list[str]
) -> tuple[Record, ...]:
    room = len(block) - header_size
    if n_vlrs * _VLR_HEADER.size > room:
        raise _refusal(
            name,
            f"the header announces {n_vlrs} VLRs, and the {room} bytes before the points hold "
            f"{room // _VLR_HEADER.size} at most",
        )
    vlrs = tuple(records_of(block, header_size, n_vlrs, extended=False))
    if len(vlrs) < n_vlrs:
        notes.append(
            f"the header announces {n_vlrs} VLRs, {len(vlrs)} lie before the points; those are used"
        )
        return vlrs
    end = vlrs[-1].end if vlrs else header_size
    further = next(records_of(block, end, 1, extended=False), None)
    if further is not None and further.user_id.isprintable() and further.user_id:
        notes.append(
            f"what looks like another VLR ({further.user_id}) lies behind the {n_vlrs} that the "
            "header announces; it is carried, not read"
        )
    return vlrs


def _with_what_follows(
    name: str, layout: LasLayout, size: int | None, notes: list[str]
) -> LasLayout:
    """Return the layout with the EVLRs and waveforms behind the points, all of it in the file."""
    from dataclasses import replace

    block, minor = layout.block, layout.minor
    evlr_start = n_evlrs = waveform_start = 0
    if minor >= 3 and block[ENCODING] & _WAVEFORMS_INSIDE:
        (waveform_start,) = struct.unpack_from("<Q", block, WAVEFORM)
    if minor >= 4:
        evlr_start, n_evlrs = struct.unpack_from("<QI", block, EVLRS)
        if n_evlrs and not evlr_start:
            notes.append(
                f"the header announces {n_evlrs} EVLRs and no place for them; none is read"
            )
        n_evlrs, evlr_start = (n_evlrs, evlr_start) if n_evlrs and evlr_start else (0, 0)
    if size is None:
        return replace(
            layout,
            evlr_start=evlr_start,
            n_evlrs=n_evlrs,
            waveform_start=waveform_start,
            notes=tuple(notes),
        )
    n_there = layout.n_points
    if not layout.is_compressed:
        n_there = (size - layout.points_start) // layout.record_length
        _check_count(name, layout.n_points, n_there)
    is_cut = n_there < layout.n_points
    first_byte = layout.points_start if layout.is_compressed or is_cut else layout.points_end
    for what, start in (("EVLRs", evlr_start), ("waveform packets", waveform_start)):
        if start and is_cut:
            notes.append(f"the {what} are lost with the end of the file")
        elif start and not first_byte <= start <= size - _EVLR_HEADER.size:
            raise _refusal(
                name,
                f"the header says that the {what} begin at byte {start}, and the points end at "
                f"byte {first_byte} of {size}",
            )
    if is_cut:
        evlr_start = n_evlrs = waveform_start = 0
    if n_evlrs * _EVLR_HEADER.size > size - evlr_start:
        raise _refusal(
            name,
            f"the header announces {n_evlrs} EVLRs, and the {size - evlr_start} bytes behind the "
            f"points hold {(size - evlr_start) // _EVLR_HEADER.size} at most",
        )
    if not layout.is_compressed and not is_cut:
        follows = min(start for start in (evlr_start or size, waveform_start or size))
        n_more = (follows - layout.points_end) // layout.record_length
        if n_more > 0:
            notes.append(
                f"the header announces {layout.n_points} points, and there is room for {n_more} "
                "more behind them; those are not read"
            )
    return replace(
        layout,
        evlr_start=evlr_start,
        n_evlrs=n_evlrs,
        waveform_start=waveform_start,
        notes=tuple(notes),
    )


def _check_count(name: str, n_points: int, n_there: int) -> None:
    if n_there == 0 and n_points:
        raise InputFileError(
            f"{name}: the file holds no points although its header announces {n_points}; get it "
            "again."
        )
    if n_points > 100 * n_there and n_there:
        raise _refusal(
            name, f"the header announces {n_points} points, the file has room for {n_there}"
        )
