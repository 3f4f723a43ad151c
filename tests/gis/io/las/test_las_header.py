"""Headers that claim what cannot be: refused in one line before anything of that size is read."""

import struct
import time
import warnings

import numpy as np
import pytest
from gis.io.las.test_las_round_trip import las_bytes, record
from hypothesis import given, settings
from hypothesis import strategies as st

from wavelet_gis.errors import InputFileError, PointCloudWarning
from wavelet_gis.io.las import read_cloud, write_cloud
from wavelet_gis.io.las.layout import parse_layout

N_VLRS, OFFSET, FORMAT, LENGTH, COUNT, SCALES, OFFSETS = 100, 96, 104, 105, 107, 131, 155


def refusal(tmp_path, content):
    """Return the line with which a file is refused, and check that it comes at once."""
    path = tmp_path / "a.las"
    path.write_bytes(content)
    began = time.perf_counter()
    with pytest.raises(InputFileError) as caught:
        read_cloud(path)
    assert time.perf_counter() - began < 5
    assert "\n" not in str(caught.value)
    assert "a.las" in str(caught.value)
    return str(caught.value)


def damaged(at, form, value, minor=2, point_format=3, **parts):
    content = bytearray(las_bytes(minor, point_format, **parts))
    struct.pack_into("<" + form, content, at, value)
    return content


@pytest.mark.parametrize("count", [200, 1 << 20, (1 << 31) - 1, (1 << 32) - 1])
def test_more_vlrs_than_there_is_room_for(tmp_path, count):
    content = damaged(N_VLRS, "I", count, vlrs=(record(b"x", 1, bytes(300)),))
    assert f"announces {count} VLRs" in refusal(tmp_path, content)


@pytest.mark.parametrize("count", [3, 1 << 31, (1 << 32) - 1])
def test_more_evlrs_than_there_is_room_for(tmp_path, count):
    parts = {"evlrs": (record(b"x", 1, b"12", extended=True),)}
    assert "EVLRs" in refusal(tmp_path, damaged(243, "I", count, 4, 6, **parts))


@pytest.mark.parametrize("start", [1, 400, 1 << 40, (1 << 64) - 1])
def test_evlrs_that_are_not_behind_the_points(tmp_path, start):
    parts = {"evlrs": (record(b"x", 1, b"12", extended=True),)}
    assert f"begin at byte {start}" in refusal(tmp_path, damaged(235, "Q", start, 4, 6, **parts))


@pytest.mark.parametrize("suffix", ["las", "laz"])
def test_evlrs_without_a_place(tmp_path, suffix):
    """A count in the header and an offset of 0: found by `tests/tools/mutate.py`."""
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(damaged(243, "I", 1, 4, 6))
    if suffix == "laz":
        (tmp_path / "b.las").write_bytes(las_bytes(4, 6))
        write_cloud(path, read_cloud(tmp_path / "b.las")[0])
        content = bytearray(path.read_bytes())
        struct.pack_into("<I", content, 243, 7)
        path.write_bytes(content)
    with pytest.warns(PointCloudWarning, match="no place for them"):
        cloud, _ = read_cloud(path)
    write_cloud(tmp_path / "back.las", cloud)
    again, _ = read_cloud_quietly(tmp_path / "back.las")
    assert (again.integers == cloud.integers).all()


def read_cloud_quietly(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return read_cloud(path)


def test_an_evlr_longer_than_the_file_is_told_of(tmp_path):
    content = bytearray(las_bytes(4, 6, evlrs=(record(b"x", 1, b"12", extended=True),)))
    struct.pack_into("<Q", content, len(content) - 62 + 20, 1 << 50)
    path = tmp_path / "a.las"
    path.write_bytes(content)
    with pytest.warns(PointCloudWarning, match="1 EVLRs, 0 lie whole"):
        cloud, _ = read_cloud(path)
    write_cloud(tmp_path / "b.las", cloud)
    assert (tmp_path / "b.las").read_bytes() == bytes(content)


@pytest.mark.parametrize(
    ("at", "form", "value", "words"),
    [
        (25, "B", 7, "LAS 1.7 does not exist"),
        (24, "B", 2, "LAS 2.2 does not exist"),
        (94, "H", 100, "says that it has 100 bytes"),
        (94, "H", 65535, "says that it has 65535 bytes"),
        (OFFSET, "I", (1 << 32) - 1, "points begin at byte 4294967295"),
        (OFFSET, "I", 12, "cut short"),
        (FORMAT, "B", 11, "no point format 11"),
        (FORMAT, "B", 64, "no point format 64"),
        (FORMAT, "B", 131, "no record says how"),
        (LENGTH, "H", 20, "have 34 bytes or more"),
        (LENGTH, "H", 0, "have 34 bytes or more"),
        (COUNT, "I", (1 << 32) - 1, "room for 60"),
        (COUNT, "I", 0, "no points"),
        (SCALES, "d", 0.0, "scales"),
        (SCALES + 8, "d", float("nan"), "scales"),
        (SCALES + 16, "d", 1e300, "scales"),
        (SCALES, "d", 1e-300, "scales"),
        (OFFSETS, "d", 1e308, "offsets"),
        (OFFSETS + 8, "d", -1e12, "offsets"),
        (OFFSETS + 16, "d", float("inf"), "offsets"),
        (SCALES, "d", 1e5, "x runs from"),
    ],
)
def test_numbers_that_cannot_be(tmp_path, at, form, value, words):
    assert words in refusal(tmp_path, damaged(at, form, value))


@pytest.mark.filterwarnings("ignore:.*left out of the surface")
@pytest.mark.parametrize(
    ("at", "form", "value", "words"),
    [
        (COUNT, "I", 61, "announces 61 points, the file ends after 60"),
        (COUNT, "I", 50, "room for 10 more"),
        (SCALES, "d", 0.013, "says that x runs from"),
        (OFFSETS + 8, "d", 5100100.0, "says that y runs from"),
        (OFFSETS + 16, "d", -100.0, "says that z runs from"),
        (N_VLRS, "I", 0, "looks like another VLR"),
        (N_VLRS, "I", 2, "announces 2 VLRs, 1 lie before"),
    ],
)
def test_what_is_odd_is_told(tmp_path, at, form, value, words):
    path = tmp_path / "a.las"
    path.write_bytes(damaged(at, form, value, vlrs=(record(b"mine", 1, bytes(99)),)))
    with pytest.warns(PointCloudWarning, match=words):
        read_cloud(path)


@pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")
@settings(max_examples=150)
@given(
    minor_format=st.sampled_from([(0, 1), (2, 3), (3, 4), (4, 6), (4, 7)]),
    at=st.integers(0, 420),
    width=st.sampled_from([1, 2, 4, 8]),
    value=st.integers(0, (1 << 64) - 1),
)
def test_any_damage_to_the_head_is_survived(tmp_path_factory, minor_format, at, width, value):
    """Read, or refused in one line; never anything else."""
    parts = {"vlrs": (record(b"LASF_Projection", 2112, b"PROJCS["),)}
    if minor_format[0] == 4:
        parts["evlrs"] = (record(b"LASF_Spec", 7, b"123", extended=True),)
    content = bytearray(las_bytes(*minor_format, **parts))
    content[at : at + width] = (value % (1 << (8 * width))).to_bytes(width, "little")
    path = tmp_path_factory.getbasetemp() / "any.las"
    path.write_bytes(content)
    fault = cloud = None
    try:
        cloud, _ = read_cloud(path)
    except InputFileError as error:
        fault = str(error)
    assert fault is None or "\n" not in fault
    assert cloud is None or np.abs(cloud.coordinates()).max() <= 1e9


def test_a_header_alone_tells_where_things_lie():
    vlrs = (record(b"a", 1, b"123"), record(b"b", 2, b""))
    content = las_bytes(2, 1, vlrs=vlrs, gap=b"xy")
    layout = parse_layout("a.las", content[: 227 + 57 + 54 + 2])
    assert [r.user_id for r in layout.vlrs] == ["a", "b"]
    assert layout.vlrs_end == 227 + 57 + 54
    assert (layout.n_points, layout.record_length, layout.point_format) == (60, 28, 1)


@pytest.mark.parametrize("minor", [2, 4])
def test_points_that_the_header_counts_by_return_only_are_told_of(tmp_path, minor):
    """A damaged number of points left 44 of 300 unread without a word."""
    content = bytearray(las_bytes(minor, 3))
    at, form = (247, "<Q") if minor == 4 else (COUNT, "<I")
    n_points = struct.unpack_from(form, content, at)[0]
    struct.pack_into(form, content, at, n_points - 5)
    if minor == 4:
        struct.pack_into("<I", content, COUNT, 0)
        struct.pack_into("<5I", content, 111, 0, 0, 0, 0, 0)
        struct.pack_into("<15Q", content, 255, n_points, *[0] * 14)
    else:
        struct.pack_into("<5I", content, 111, n_points, 0, 0, 0, 0)
    path = tmp_path / "a.las"
    path.write_bytes(content)
    words = f"counts {n_points} points by return and {n_points - 5} in all"
    with pytest.warns(PointCloudWarning) as told:
        cloud, _ = read_cloud(path)
    assert any(words in str(warning.message) for warning in told)
    assert cloud.n_points == n_points - 5
