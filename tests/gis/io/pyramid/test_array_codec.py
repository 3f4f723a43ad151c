"""Arrays survive their chunks, and no false claim is believed."""

import lzma
import zlib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from wavelet_core.errors import Cancelled, PyramidError
from wavelet_gis.io.geopackage import create_geopackage, open_for_writing
from wavelet_gis.io.pyramid.array_tables import SCHEMA, read_entries, write_arrays
from wavelet_gis.io.pyramid.codecs import array_codec
from wavelet_gis.io.pyramid.codecs.array_codec import (
    FILTERS,
    ArrayHeader,
    Tally,
    array_checksum,
    closest_header,
    decode_array,
    encode_array,
    header_of,
    work_of,
)

ANY_ARRAY = st.sampled_from(["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"]).flatmap(
    lambda code: hnp.arrays(code, hnp.array_shapes(min_dims=1, max_dims=2, min_side=0, max_side=30))
)


def round_trip(array, pool=None):
    chunks = list(encode_array(array, pool))
    header = header_of(array)
    header = ArrayHeader.checked(header.dtype, list(header.shape), header.filter, header.chunk_rows)
    assert len(chunks) == header.n_chunks
    return decode_array(header, chunks, sum(map(len, chunks)), pool)


@given(ANY_ARRAY, st.integers(1, 64))
def test_any_array_comes_back_bit_for_bit(array, chunk_bytes):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(array_codec, "CHUNK_BYTES", chunk_bytes)
        back = round_trip(array)
    assert back.dtype == array.dtype.newbyteorder("<")
    assert back.shape == array.shape
    assert back.tobytes() == array.tobytes()


def test_booleans_become_bytes_and_big_endian_little():
    assert round_trip(np.array([True, False])).tolist() == [1, 0]
    assert round_trip(np.arange(5, dtype=">i4")).dtype == np.dtype("<i4")


def test_threads_change_nothing(monkeypatch):
    monkeypatch.setattr(array_codec, "CHUNK_BYTES", 1 << 10)
    array = np.random.default_rng(0).normal(size=(5000, 2))
    with ThreadPoolExecutor(3) as pool:
        assert list(encode_array(array, pool)) == list(encode_array(array))
        assert round_trip(array, pool).tobytes() == array.tobytes()


def test_the_faces_of_a_grid_shrink():
    row = np.arange(10_000, dtype=np.int32)[:, None]
    faces = row + np.array([0, 1, 101], dtype=np.int32)
    assert sum(map(len, encode_array(faces))) < faces.nbytes / 100


def test_what_is_no_number_is_refused():
    for array in (np.array(["a"]), np.array([{}]), np.zeros((2, 2, 2)), np.zeros(3, complex)):
        with pytest.raises(PyramidError, match="cannot be stored"):
            header_of(array)


@pytest.mark.parametrize(
    "claim",
    [
        ("O", [3], "shuffle", 1),
        ("<U9", [3], "shuffle", 1),
        ("<f8", [-1], "shuffle", 1),
        ("<f8", [1, 2, 3], "shuffle", 1),
        ("<f8", [], "shuffle", 1),
        ("<f8", [2.5], "shuffle", 1),
        ("<f8", [True], "shuffle", 1),
        ("<f8", "3", "shuffle", 1),
        ("<f8", [1 << 50], "shuffle", 1),
        ("<f8", [1 << 30], "shuffle", 1 << 30),  # one chunk of 8 GiB
        ("<f8", [3], "pickle", 1),
        ("<f8", [3], "shuffle\n", 1),
        ("<f8", [3], "shuffle", 0),
        ("<f8", [3], "shuffle", None),
    ],
)
def test_claims_that_no_file_of_ours_makes(claim):
    with pytest.raises(PyramidError, match="damaged") as caught:
        ArrayHeader.checked(*claim)
    assert "\n" not in str(caught.value)


def header(n_rows, chunk_rows=4, dtype="<f8"):
    return ArrayHeader.checked(dtype, [n_rows], "shuffle", chunk_rows)


def chunk_of(n_bytes):
    return zlib.compress(bytes(n_bytes))


@pytest.mark.parametrize(
    ("declared", "chunks"),
    [
        (header(4), []),  # too few
        (header(4), [chunk_of(32), chunk_of(32)]),  # too many
        (header(4), [chunk_of(32), chunk_of(0)]),  # too many, one of them of no rows
        (header(8), [chunk_of(32)]),
        (header(4), [chunk_of(31)]),  # too short
        (header(4), [chunk_of(40)]),  # a little bomb
        (header(4), [chunk_of(10_000_000)]),  # a larger one
        (header(4), [b"nothing compressed"]),
        (header(4), [chunk_of(32)[:-1]]),  # no checksum at its end
        (header(4), [chunk_of(32) + b"more"]),
        (header(4), [chunk_of(32)[:-4] + b"\0\0\0\1"]),  # a wrong checksum
        (header(4), [b""]),
    ],
)
def test_chunks_that_do_not_hold_what_is_declared(declared, chunks):
    with pytest.raises(PyramidError, match="damaged"):
        decode_array(declared, chunks, max(sum(map(len, chunks)), 1))


LZMA = [{"id": lzma.FILTER_LZMA2, "dict_size": 1 << 20, "lc": 0, "lp": 0, "pb": 0}]
#: As docs/reference/format.md has them: floats in order, differences, zigzag, the compressor.
AS_WRITTEN_DOWN = {
    "shuffle": (False, 0, False, "zlib"),
    "delta_shuffle": (False, 1, False, "zlib"),
    "lzma": (False, 0, False, "lzma"),
    "zigzag_lzma": (True, 0, True, "lzma"),
    "delta_lzma": (True, 1, True, "lzma"),
    "delta2_lzma": (True, 2, True, "lzma"),
}


def packed_by_hand(array, name):
    """Return the chunk of an array, number by number."""
    in_order, n_differences, is_zigzag, compressor = AS_WRITTEN_DOWN[name]
    n_bits, n_bytes = 8 * array.dtype.itemsize, array.dtype.itemsize
    numbers = [int.from_bytes(value.tobytes(), "little") for value in array]
    if in_order and array.dtype.kind == "f":
        sign, low = 1 << (n_bits - 1), (1 << (n_bits - 1)) - 1
        numbers = [number ^ low if number & sign else number for number in numbers]
    for _ in range(n_differences):
        before = [0, *numbers[:-1]]
        numbers = [(a - b) % (1 << n_bits) for a, b in zip(numbers, before, strict=True)]
    if is_zigzag:
        half, whole = 1 << (n_bits - 1), 1 << n_bits
        numbers = [2 * n if n < half else 2 * (whole - n) - 1 for n in numbers]
    rows = [number.to_bytes(n_bytes, "little") for number in numbers]
    shuffled = bytes(row[place] for place in range(n_bytes) for row in rows)
    if compressor == "zlib":
        return zlib.compress(shuffled)
    return lzma.compress(shuffled, lzma.FORMAT_RAW, filters=LZMA)


@pytest.mark.parametrize("name", array_codec.FILTERS)
@pytest.mark.parametrize("dtype", ["<i4", "<f8", "<u2"])
def test_what_is_packed_as_the_format_says_is_read(name, dtype):
    """A change of writer and reader alike comes back, and yet reads no file of before."""
    array = np.array([3, 0, 250, 7, 7, 1, 90], dtype)
    if dtype != "<u2":
        array[::2] *= -1
    declared = ArrayHeader.checked(dtype, [7], name, 4)
    chunks = [packed_by_hand(array[:4], name), packed_by_hand(array[4:], name)]
    back = decode_array(declared, chunks, sum(map(len, chunks)))
    assert back.tobytes() == array.tobytes()


@pytest.mark.parametrize("name", ["lzma", "delta2_lzma"])
def test_a_chunk_that_ends_too_early_is_refused(name):
    chunk = packed_by_hand(np.arange(4, dtype="<f8"), name)
    for broken in (chunk[:-1], chunk[: len(chunk) // 2], b"", chunk + b"more"):
        with pytest.raises(PyramidError, match="damaged"):
            decode_array(ArrayHeader.checked("<f8", [4], name, 4), [broken], len(chunk))


def test_no_rows_need_no_choice():
    empty = np.zeros((0, 3))
    assert closest_header(empty) == header_of(empty)


def test_lzma_must_save_what_its_time_is_worth():
    rng = np.random.default_rng(0)
    noise = rng.normal(size=20_000)  # LZMA saves 1 % of it, and a fifth of the other
    assert not FILTERS[closest_header(noise).filter].is_lzma
    assert FILTERS[closest_header(np.round(noise * 50).astype(np.int32)).filter].is_lzma


def test_the_filter_is_chosen_by_rows_of_all_parts(monkeypatch):
    monkeypatch.setattr(array_codec, "_SAMPLE_ROWS", 1000)
    noise = np.random.default_rng(0).integers(0, 2**62, 3000)
    ramp = np.arange(12_000) ** 2 * 10**6
    assert closest_header(ramp).filter == "delta2_lzma"
    # at both ends and between: noise at the beginning is one stretch of four
    assert closest_header(np.concatenate([noise, ramp])).filter == "delta2_lzma"
    between = np.concatenate([noise[:500], ramp[:2500], noise, noise, noise])
    assert closest_header(between).filter != "delta2_lzma"  # where no stretch is
    assert len(array_codec._sample(ramp)) == 1000
    assert array_codec._sample(ramp)[-1] == ramp[-1]
    assert work_of(ramp) == ramp.nbytes + 1000 * ramp.itemsize * len(array_codec.FILTERS)


def test_a_bomb_is_not_expanded(monkeypatch):
    asked = []
    original = zlib.decompressobj

    class Watched:
        def __init__(self):
            self._expander = original()

        def decompress(self, data, limit):
            out = self._expander.decompress(data, limit)
            asked.append(len(out))
            return out

        def __getattr__(self, name):
            return getattr(self._expander, name)

    monkeypatch.setattr(array_codec.zlib, "decompressobj", Watched)
    with pytest.raises(PyramidError, match="damaged"):
        decode_array(header(4), [chunk_of(100_000_000)], 100_000)
    assert max(asked) <= 32


def test_a_size_that_compression_cannot_reach_gets_no_memory():
    huge = header(1 << 36, chunk_rows=1 << 20)
    with pytest.raises(PyramidError, match="more than compression can hold"):
        decode_array(huge, [chunk_of(8 << 20)], 8200)


@pytest.mark.parametrize("n_threads", [0, 2])
def test_compressing_reports_pieces_of_a_chunk_and_makes_the_same_of_it(n_threads, monkeypatch):
    """Whole chunks took seconds each, in which QGIS showed nothing and heard no cancel."""
    monkeypatch.setattr(array_codec, "_PIECE_BYTES", 1 << 16)
    monkeypatch.setattr(array_codec, "_LOOK", 0.001)
    array = np.random.default_rng(0).normal(0, 9, 1_000_000).astype(np.int16)
    header = replace(header_of(array), filter="lzma")
    seen = []
    with ThreadPoolExecutor(2) as pool:
        chunks = list(encode_array(array, pool if n_threads else None, header, seen.append))
    shuffled = array.view(np.uint8).reshape(-1, 2).T.tobytes()
    filters = array_codec.WRITTEN_LZMA_FILTERS
    whole = lzma.compress(shuffled, format=lzma.FORMAT_RAW, filters=filters)
    assert chunks == [whole]
    assert sum(seen) == array.nbytes
    assert len([n for n in seen if n]) > 3 or not n_threads


def test_compressing_stops_within_a_chunk(monkeypatch):
    monkeypatch.setattr(array_codec, "_LOOK", 0.001)
    array = np.random.default_rng(0).normal(0, 9, 2_000_000).astype(np.int16)
    header = replace(header_of(array), filter="lzma")
    packed = []
    add = Tally.__call__
    monkeypatch.setattr(Tally, "__call__", lambda self, n: (packed.append(n), add(self, n)))

    def stop(n_bytes):
        raise Cancelled("stop")

    with ThreadPoolExecutor(2) as pool, pytest.raises(Cancelled):
        list(encode_array(array, pool, header, stop))
    assert sum(packed) < array.nbytes / 4


def test_what_shrinks_too_well_to_be_believed_counts_once(tmp_path):
    """Counted twice, it had the bar at its end while other arrays took 6 s more."""
    create_geopackage(tmp_path / "a.gpkg")
    arrays = {"ramp": np.arange(2_000_000), "noise": np.random.default_rng(0).normal(size=1000)}
    seen = []
    with open_for_writing(tmp_path / "a.gpkg") as connection, ThreadPoolExecutor(2) as pool:
        connection.executescript(SCHEMA)
        write_arrays(connection, arrays, pool, seen.append)
        ((name,),) = connection.execute("SELECT filter FROM wavelet_arrays WHERE name = 'ramp'")
    assert name == "delta_shuffle"
    assert sum(seen) == sum(map(work_of, arrays.values()))


def test_arrays_side_by_side_are_packed_as_each_alone(tmp_path, monkeypatch):
    monkeypatch.setattr(array_codec, "CHUNK_BYTES", 1 << 14)
    rng = np.random.default_rng(3)
    sizes = [10, 3000, 40_000, 0, 2000, 5000, 100_000, 1]
    arrays = {f"a{k}": rng.normal(0, 9, n).astype(np.int16) for k, n in enumerate(sizes)}
    arrays["ramp"] = np.arange(4000)  # shrinks too well to be believed
    create_geopackage(tmp_path / "a.gpkg")
    with open_for_writing(tmp_path / "a.gpkg") as connection, ThreadPoolExecutor(3) as pool:
        connection.executescript(SCHEMA)
        write_arrays(connection, arrays, pool, lambda n_bytes: None)
        entries = read_entries(connection, with_checksums=True)
        stored = connection.execute("SELECT array_id, data FROM wavelet_chunks ORDER BY id")
        chunks = [(array_id, data) for array_id, data in stored]
    assert list(entries) == list(arrays)
    alone = []
    for name, array in arrays.items():
        entry = entries[name]
        closest = closest_header(array)
        assert entry.header in (closest, header_of(array))
        assert entry.header == closest or name == "ramp"
        assert entry.checksum == array_checksum(closest, [array])
        alone += [(entry.array_id, chunk) for chunk in encode_array(array, header=entry.header)]
    assert chunks == alone
    assert max(entry.header.n_chunks for entry in entries.values()) > 3


def test_packing_arrays_side_by_side_stops_within_each(tmp_path, monkeypatch):
    monkeypatch.setattr(array_codec, "_LOOK", 0.001)
    monkeypatch.setattr(array_codec, "_PIECE_BYTES", 1 << 14)
    rng = np.random.default_rng(0)
    arrays = {f"a{k}": rng.normal(0, 9, 2_000_000).astype(np.int16) for k in range(3)}
    made = []
    pack = array_codec._lzma
    monkeypatch.setattr(array_codec, "_lzma", lambda *job: made.append(pack(*job)) or made[-1])

    def stop(n_bytes):
        if n_bytes:
            raise Cancelled("stop")

    create_geopackage(tmp_path / "a.gpkg")
    with open_for_writing(tmp_path / "a.gpkg") as connection, ThreadPoolExecutor(2) as pool:
        connection.executescript(SCHEMA)
        with pytest.raises(Cancelled):
            write_arrays(connection, arrays, pool, stop)
    assert b"" in made  # one ended midway
    assert len(made) < 4 * 3  # and most were never begun
