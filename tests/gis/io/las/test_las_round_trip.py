"""A LAS file that nothing was asked to change comes back byte for byte, header included.

The files are written with struct, not with the library that the package reads them with, so that
nothing is made anew on the way: odd dates, counts that no rule asks for, padding, records of
owners that nobody knows.
"""

import os
import struct
import subprocess
import sys
from dataclasses import replace
from itertools import product

import laspy
import numpy as np
import pytest

from wavelet_core import analyse
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.las import read_cloud, write_cloud
from wavelet_gis.io.las.cloud_writer import _read_at_once
from wavelet_gis.io.las.layout import RECORD_LENGTHS, read_layout
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid, write_pyramid
from wavelet_gis.workflows.open import open_terrain

HEADER_SIZES = {0: 227, 1: 227, 2: 227, 3: 235, 4: 375}
LAST_FORMATS = {0: 1, 1: 1, 2: 3, 3: 5, 4: 10}
WAVEFORM_FORMATS = (4, 5, 9, 10)

PAIRS = [
    (minor, point_format)
    for minor in HEADER_SIZES
    for point_format in range(LAST_FORMATS[minor] + 1)
]

pytestmark = [
    pytest.mark.filterwarnings("ignore:.*there is no CRS"),
    pytest.mark.filterwarnings("ignore:.*left out of the surface"),
]


def record(owner, number, data, *, extended=False, reserved=0xAABB):
    form = "<H16sHQ32s" if extended else "<H16sHH32s"
    return struct.pack(form, reserved, owner, number, len(data), b"as it came \xe9") + data


def extra_bytes(*dimensions, what=b"meant"):
    """Return the record that describes extra dimensions, each of (kind, name)."""
    return record(
        b"LASF_Spec",
        4,
        b"".join(
            struct.pack("<HBB32s4s24s24s24s24s24s32s", 9, kind, 0, name, b"\x01\x02\x03\x04",
                        bytes(24), b"\x07" * 24, b"\x08" * 24, bytes(24), bytes(24), what)
            for kind, name in dimensions
        ),
    )  # fmt: skip


def las_bytes(minor, point_format, *, vlrs=(), evlrs=(), extra=0, gap=b"", tail=b"", n=60, seed=0):
    """Return a LAS file of random points, its parts as given."""
    rng = np.random.default_rng([seed, minor, point_format])
    length = RECORD_LENGTHS[point_format] + extra
    points = rng.integers(0, 256, (n, length), dtype=np.uint8)
    xyz = rng.integers(-50_000, 50_000, (n, 3), dtype=np.int32)
    xyz[-5:, :2] = xyz[:5, :2]  # five places with two points each
    points[:, :12] = xyz.view(np.uint8).reshape(n, 12)
    flags = 16 if point_format >= 6 else 15
    points[:, flags] = 2 if point_format >= 6 else points[:, flags] & 0b01100000 | 2
    if point_format >= 6:
        points[:, 15] &= 0b11111011  # not withheld
    start = HEADER_SIZES[minor]
    block = b"".join(vlrs) + gap
    offset = start + len(block)
    scales, offsets = (0.01, 0.01, 0.001), (500000.0, 5100000.0, 100.0)
    ends = [
        value
        for k in range(3)
        for value in (xyz[:, k].max() * scales[k] + offsets[k],
                      xyz[:, k].min() * scales[k] + offsets[k])
    ]  # fmt: skip
    count = 0 if point_format >= 6 else n
    header = struct.pack(
        "<4sHH16sBB32s32sHHHIIBHI5I12d",
        b"LASF", 4242, 0, bytes(range(16)), 1, minor, b"scanner \xe9\0junk", b"a program 0.1",
        367, 1899, start, offset, len(vlrs), point_format, length, count,
        *(7, 6, 5, 4, 3), *scales, *offsets, *ends,
    )  # fmt: skip
    if minor >= 3:
        header += struct.pack("<Q", 0)
    if minor >= 4:
        first = offset + n * length + len(tail) if evlrs else 0
        header += struct.pack("<QIQ15Q", first, len(evlrs), n, *range(15))
    assert len(header) == start
    return header + block + points.tobytes() + tail + b"".join(evlrs)


def layout_of(path):
    """Return where the points lie in a file."""
    with open(path, "rb") as stream:
        layout = read_layout(str(path), stream)
    return slice(layout.points_start, layout.points_end)


def through_a_file(path, folder, **options):
    terrain = open_terrain(path, **options)
    geo = terrain.geo_pyramid(analyse(terrain.mesh, levels=2))
    write_pyramid(folder / "a.gpkg", geo)
    return read_pyramid(folder / "a.gpkg")


PARTS = {
    "bare": {},
    "records": {
        "vlrs": (record(b"nobody knows me!", 7, bytes(range(200))), record(b"x", 1, b"")),
        "gap": b"\xdd\xcc",
    },
    "extra": {
        "vlrs": (
            extra_bytes((3, b"two bytes"), (9, b"four \xe9"), what=b"what \xff"),
            record(b"y", 9, b"z"),
        ),
        "extra": 6,
        "gap": b"padding",
    },
    "unnamed": {"extra": 5},
}


@pytest.mark.filterwarnings("ignore:.*refer to waveforms")
@pytest.mark.parametrize("parts", PARTS)
@pytest.mark.parametrize(("minor", "point_format"), PAIRS)
def test_every_version_format_and_record_comes_back(tmp_path, minor, point_format, parts):
    options = dict(PARTS[parts])
    if minor == 4 and parts != "bare":
        options["evlrs"] = (
            record(b"big", 3, bytes(70_000), extended=True),
            record(b"LASF_Projection", 5, b"abc", extended=True),
        )
        options["tail"] = b"between" if parts == "records" else b""
    path = tmp_path / "a.las"
    path.write_bytes(las_bytes(minor, point_format, **options))
    cloud, _ = read_cloud(path)
    write_cloud(tmp_path / "direct.las", cloud)
    assert (tmp_path / "direct.las").read_bytes() == path.read_bytes()
    if parts == "extra":
        write_cloud(tmp_path / "back.las", through_a_file(path, tmp_path).restore())
        assert (tmp_path / "back.las").read_bytes() == path.read_bytes()


VLRS = ((), (record(b"x", 1, b"23"), record(b"nobody knows me!", 7, bytes(range(200)))))
EVLRS = ((), (record(b"big", 3, bytes(7_000), extended=True), record(b"b", 1, b"", extended=True)))
EXTRAS = (
    ((), 0),
    ((extra_bytes((3, b"two bytes"), (9, b"four \xe9"), what=b"what \xff"),), 6),
    ((), 5),
)
BETWEEN = ((b"", b""), (b"padding", b"behind the points"))


@pytest.mark.large
@pytest.mark.filterwarnings("ignore:.*refer to waveforms")
@pytest.mark.parametrize(("minor", "point_format"), PAIRS)
def test_the_whole_matrix_through_a_pyramid_file(tmp_path, minor, point_format):
    """Records x extended records x extra bytes x what lies between: 24 files, 12 before LAS 1.4."""
    n_compared = 0
    for vlrs, evlrs, (described, extra), (gap, tail) in product(VLRS, EVLRS, EXTRAS, BETWEEN):
        if evlrs and minor < 4:
            continue
        content = las_bytes(
            minor, point_format, vlrs=(*vlrs, *described), evlrs=evlrs, extra=extra, gap=gap,
            tail=tail,
        )  # fmt: skip
        (tmp_path / "a.las").write_bytes(content)
        write_cloud(tmp_path / "back.las", through_a_file(tmp_path / "a.las", tmp_path).restore())
        assert (tmp_path / "back.las").read_bytes() == content, (bool(vlrs), bool(evlrs), extra)
        for name in ("a.las", "a.gpkg", "back.las"):
            (tmp_path / name).unlink()
        n_compared += 1
    assert n_compared == (24 if minor == 4 else 12)


@pytest.mark.filterwarnings("ignore:.*has no point format")
@pytest.mark.filterwarnings("ignore:.*refer to waveforms")
@pytest.mark.parametrize(("minor", "point_format"), [(0, 3), (1, 2), (2, 6), (2, 5), (3, 10)])
def test_a_format_that_the_version_does_not_have_comes_back(tmp_path, minor, point_format):
    path = tmp_path / "a.las"
    content = bytearray(las_bytes(minor, point_format))
    struct.pack_into("<I", content, 107, 60)
    path.write_bytes(content)
    write_cloud(tmp_path / "back.las", through_a_file(path, tmp_path).restore())
    assert (tmp_path / "back.las").read_bytes() == path.read_bytes()


def test_what_follows_the_points_without_being_told_of_comes_back(tmp_path):
    path = tmp_path / "a.las"
    path.write_bytes(las_bytes(2, 3, tail=b"a few bytes"))
    write_cloud(tmp_path / "back.las", through_a_file(path, tmp_path).restore())
    assert (tmp_path / "back.las").read_bytes() == path.read_bytes()


def test_waveform_packets_inside_the_file_come_back(tmp_path):
    path = tmp_path / "a.las"
    packets = record(b"LASF_Spec", 65535, bytes(range(256)) * 9, extended=True)
    content = bytearray(las_bytes(3, 4, tail=packets))
    struct.pack_into("<H", content, 6, 2)
    struct.pack_into("<Q", content, 227, len(content) - len(packets))
    path.write_bytes(content)
    cloud, _ = read_cloud(path)  # no warning: nothing is lost
    write_cloud(tmp_path / "back.las", cloud)
    assert (tmp_path / "back.las").read_bytes() == path.read_bytes()
    write_cloud(tmp_path / "back.laz", cloud)
    packed = (tmp_path / "back.laz").read_bytes()
    (start,) = struct.unpack_from("<Q", packed, 227)
    assert packed[start:] == packets


@pytest.mark.filterwarnings("ignore:.*refer to waveforms")
@pytest.mark.parametrize(("minor", "point_format"), PAIRS)
def test_compressed_and_back_only_the_header_says_so(tmp_path, minor, point_format):
    """LAS to LAZ to LAS: points, records and all of the header but the places of things."""
    path = tmp_path / "a.las"
    evlrs = (record(b"big", 3, bytes(500), extended=True),) if minor == 4 else ()
    path.write_bytes(
        las_bytes(minor, point_format, evlrs=evlrs, vlrs=(record(b"x", 1, b"23"),), gap=b"\1\2")
    )
    cloud, _ = read_cloud(path)
    if point_format in (9, 10):
        # lazrs loses waveform references where points of several scanner channels mix.
        with pytest.raises(OutputFileError, match=r"come back changed\); write \.las"):
            write_cloud(tmp_path / "b.laz", cloud)
        content = bytearray(path.read_bytes())
        records = np.frombuffer(content, np.uint8)[layout_of(path)].copy()
        records.reshape(60, -1)[:, 15] &= 0b11001111
        content[layout_of(path)] = records.tobytes()
        path.write_bytes(content)
        cloud, _ = read_cloud(path)
    write_cloud(tmp_path / "b.laz", cloud)
    packed = laspy.read(tmp_path / "b.laz")
    assert packed.points.array.tobytes() == laspy.read(path).points.array.tobytes()
    again, _ = read_cloud(tmp_path / "b.laz")
    write_cloud(tmp_path / "c.las", again)
    assert (tmp_path / "c.las").read_bytes() == path.read_bytes()


def test_a_stale_hierarchy_is_not_written_anew(tmp_path):
    path = tmp_path / "a.las"
    evlrs = (
        record(b"mine", 3, b"kept", extended=True),
        record(b"copc", 1000, b"stale", extended=True),
    )
    path.write_bytes(las_bytes(4, 6, evlrs=evlrs, vlrs=(record(b"copc", 1, bytes(160)),)))
    cloud, _ = read_cloud(path)
    write_cloud(tmp_path / "b.laz", cloud)
    again, _ = read_cloud(tmp_path / "b.laz")
    assert again.evlrs.tobytes() == evlrs[0]
    assert b"copc" not in (tmp_path / "b.laz").read_bytes()[:1000]


def test_points_of_a_class_have_a_header_of_their_own(tmp_path):
    path = tmp_path / "a.las"
    content = bytearray(las_bytes(2, 1, n=100))
    records = np.frombuffer(content, np.uint8, offset=227).reshape(100, 28).copy()
    records[50:, 15] = 5
    records[:, 14] = records[:, 14] & 0b11111000 | 2
    content[227:] = records.tobytes()
    path.write_bytes(content)
    write_cloud(tmp_path / "b.las", through_a_file(path, tmp_path, classes=[5]).restore())
    before, after = laspy.read(path), laspy.read(tmp_path / "b.las")
    chosen = before.points[50:]
    assert after.header.point_count == 50
    assert after.header.number_of_points_by_return[:5].tolist() == [0, 50, 0, 0, 0]
    np.testing.assert_allclose(after.header.maxs[:2], [chosen.x.max(), chosen.y.max()])
    np.testing.assert_allclose(after.header.mins[2], chosen.z.min())
    assert after.header.generating_software == before.header.generating_software
    assert after.points.array.tobytes() == chosen.array.tobytes()


def test_a_filter_gives_the_header_a_new_extent(tmp_path):
    path = tmp_path / "a.las"
    path.write_bytes(las_bytes(4, 6))
    cloud, _ = read_cloud(path)
    raised = replace(cloud, integers=cloud.integers + np.int32([0, 0, 500]), is_altered=True)
    write_cloud(tmp_path / "b.las", raised)
    before, after = laspy.read(path), laspy.read(tmp_path / "b.las")
    assert after.header.maxs[2] == pytest.approx(before.header.maxs[2] + 0.5)
    assert after.header.maxs[0] == pytest.approx(before.header.maxs[0])


@pytest.mark.parametrize("parts", ["bare", "extra", "unnamed"])
def test_a_height_above_ground_is_one_more_dimension(tmp_path, parts):
    path = tmp_path / "a.las"
    plain = {"vlrs": (extra_bytes((3, b"two bytes"), (9, b"four")),), "extra": 6}
    path.write_bytes(las_bytes(4, 6, **(plain if parts == "extra" else PARTS[parts])))
    write_cloud(tmp_path / "b.las", through_a_file(path, tmp_path, attributes=["hag"]).restore())
    before, after = path.read_bytes(), laspy.read(tmp_path / "b.las")
    old = after.header.point_format.size - 4
    records = after.points.array.view(np.uint8).reshape(60, -1)
    assert records[:, :old].tobytes() == before[-60 * old :]
    assert np.asarray(after["hag"]).dtype == np.float32
    names = list(after.point_format.extra_dimension_names)
    assert names[-1] == "hag"


def test_pyramids_of_before_keep_their_extended_records(tmp_path):
    """Files of version 1.0 hold the EVLRs alone and not where they lay."""
    path = tmp_path / "a.las"
    evlrs = (record(b"mine", 3, b"kept", extended=True),)
    path.write_bytes(las_bytes(4, 6, evlrs=evlrs, tail=b"gap"))
    cloud, _ = read_cloud(path)
    old = replace(cloud, evlrs=np.frombuffer(evlrs[0], np.uint8), evlrs_at=None)
    write_cloud(tmp_path / "b.las", old)
    again, _ = read_cloud(tmp_path / "b.las")
    assert again.evlrs.tobytes() == evlrs[0]
    assert (again.integers == cloud.integers).all()


@pytest.mark.data
@pytest.mark.parametrize("folder", ["clouds", "nasty"])
@pytest.mark.filterwarnings("ignore::wavelet_gis.errors.TerrainWarning")
def test_every_real_las_file_comes_back_byte_for_byte(data_folder, tmp_path, folder):
    from wavelet_gis.errors import InputFileError

    n_compared = 0
    for path, suffix in product(sorted((data_folder / folder).glob("*.las")), ("las",)):
        try:
            cloud, _ = read_cloud(path)
        except InputFileError as error:
            assert "no points" in str(error)  # noqa: PT017
            continue
        write_cloud(tmp_path / f"back.{suffix}", cloud)
        assert (tmp_path / f"back.{suffix}").read_bytes() == path.read_bytes(), path.name
        n_compared += 1
    assert n_compared >= 3


def test_no_more_is_read_back_at_once_than_the_points_have_and_memory_takes():
    assert _read_at_once(50, 65535) == 50
    assert _read_at_once(0, 20) == 1
    assert _read_at_once(10**7, 20) == 10**6
    assert _read_at_once(10**6, 65535) * 65535 <= 1 << 26


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_records_of_64_kb_come_back_in_little_memory(tmp_path, suffix):
    """A million of them were asked for to read fifty back: a MemoryError."""
    records = las_bytes(2, 0, extra=65535 - RECORD_LENGTHS[0], n=50)
    (tmp_path / "a.las").write_bytes(records)
    program = f"""
import resource
from wavelet_gis.io.las import read_cloud, write_cloud
cloud = read_cloud({str(tmp_path / "a.las")!r})[0]
with open("/proc/self/statm") as stream:
    used = int(stream.read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + (1 << 29), used + (1 << 29)))
write_cloud({str(tmp_path / ("back" + suffix))!r}, cloud)
"""
    if not os.path.exists("/proc/self/statm"):
        pytest.skip("the system does not tell how much memory a process has")
    ran = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", program], capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stderr
    if suffix == ".las":
        assert (tmp_path / "back.las").read_bytes() == records
