"""A raster's numbers come back from their residuals, whatever they are and wherever holes lie."""

import hashlib
import lzma
import sqlite3
from contextlib import closing
from unittest.mock import patch

import numpy as np
import pytest
from gis.samples import hills
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from tools.format_one import former_residuals, write_former_grid

from wavelet_core.errors import Cancelled, PyramidError
from wavelet_gis.io.pyramid.codecs import grid_codec
from wavelet_gis.io.pyramid.codecs.array_codec import WRITTEN_LZMA_FILTERS
from wavelet_gis.io.pyramid.codecs.former_grids import (
    RELIEF_CLASSES,
    FormerResiduals,
    decode_former_grid,
)
from wavelet_gis.io.pyramid.codecs.grid_codec import (
    decode_grid,
    encode_grid,
    integers_of,
    values_of,
)
from wavelet_gis.io.pyramid.codecs.grid_walk import MOST_APART
from wavelet_gis.io.pyramid.pyramid_file import read_pyramid, write_pyramid

DTYPES = ("u1", "i1", "<u2", "<i2", "<u4", "<i4", "<i8", "<u8", "<f4", "<f8", "<f2")


@pytest.mark.parametrize("dtype", DTYPES)
@given(data=st.data())
def test_every_bit_of_every_type_comes_back(dtype, data):
    shape = data.draw(st.tuples(st.integers(1, 9), st.integers(1, 9)))
    raw = data.draw(hnp.arrays(np.uint8, (*shape, np.dtype(dtype).itemsize)))
    values = np.ascontiguousarray(raw).view(dtype)[..., 0]
    valid = data.draw(hnp.arrays(bool, shape))
    numbers = integers_of(values[valid])
    residuals = encode_grid(numbers.integers, valid)
    integers = decode_grid(residuals, valid)
    back = values_of(integers, np.dtype(dtype), numbers.divisor, numbers.palette)
    assert back.tobytes() == values[valid].tobytes()


@pytest.mark.parametrize(
    ("values", "divisor"),
    [
        (np.array([1.0, 2.5, -3.0], "f4"), 2),
        (np.array([101.23, 99.99], "f4"), 100),
        (np.array([101.23, 99.99]), 100),
        (np.array([0.1, -0.0]), 0),  # a sign that no integer has
        (np.array([np.pi, 1e300]), 0),
        (np.array([2543.0217, 3946.1387], "f4"), 0),  # no fewer digits than floats have
    ],
)
def test_floats_that_are_decimals_are_found(values, divisor):
    numbers = integers_of(values)
    assert numbers.divisor == divisor
    assert values_of(numbers.integers, values.dtype, divisor).tobytes() == values.tobytes()


@pytest.mark.parametrize(
    "divisor", [1, 2, 4, 8, 10, 16, 20, 32, 64, 100, 128, 256, 512, 1000, 1024]
)
def test_steps_of_any_usual_size_are_found(divisor):
    values = (np.arange(-3000, 3000) / divisor).astype("f8")
    assert integers_of(values).divisor == divisor


def test_floats_of_which_few_differ_have_a_palette():
    rng = np.random.default_rng(3)
    thirds = rng.integers(-60, 60, 4000) / 3.0
    thirds[:2] = -0.0, 0.0
    numbers = integers_of(thirds)
    assert numbers.palette is not None
    assert len(numbers.palette) < 130
    assert numbers.integers.max() < 130
    back = values_of(numbers.integers, thirds.dtype, 0, numbers.palette)
    assert back.tobytes() == thirds.tobytes()
    for beyond in (-1, len(numbers.palette)):
        with pytest.raises(PyramidError, match="beyond the palette"):
            values_of(np.array([beyond]), thirds.dtype, 0, numbers.palette)
    assert integers_of(rng.normal(size=4000)).palette is None


def test_smooth_terrain_has_small_residuals():
    values = np.rint(hills(64, 64) * 10).astype(np.int64)
    valid = np.ones(values.shape, dtype=bool)
    numbers = former_residuals(values.ravel(), valid).numbers
    assert numbers.dtype == np.uint8
    along_rows = np.abs(np.diff(values, axis=1)).mean()
    assert numbers.astype(float).mean() / 2 < along_rows
    bits = 8 * len(packed(encode_grid(values.ravel(), valid)))
    assert bits / values.size < np.log2(along_rows) + 1


def encoded(values, valid, weight=0):
    """Return the residuals in half bytes by a weight of relief, whichever takes fewest bytes."""
    with patch.object(grid_codec, "_smallest", return_value=weight):
        return encode_grid(np.ravel(values), valid)


def packed(residuals):
    """Return the residuals as compressed bytes, near enough to what is stored."""
    arrays = [array for array in residuals if isinstance(array, np.ndarray)]
    parts = []
    for array in arrays:
        by_byte = array.view(np.uint8).reshape(-1, array.itemsize).T.tobytes()
        tight = lzma.compress(by_byte, lzma.FORMAT_RAW, filters=WRITTEN_LZMA_FILTERS)
        parts.append(min(tight, by_byte, key=len))
    return b"".join(parts)


@pytest.mark.parametrize(("noise", "share"), [(0.7, 0.94), (60.0, 0.97), (20_000.0, 0.98)])
def test_smooth_terrain_with_noise_takes_fewer_bytes_than_before(noise, share):
    """A byte a residual costs LZMA eight decisions, and relief tells nothing of noise on slopes."""
    rng = np.random.default_rng(5)
    rows, columns = np.mgrid[:160, :160] / 16
    smooth = noise * 40 * (np.sin(rows) * np.cos(columns) + rows)
    strength = noise * (0.3 + np.abs(np.sin(rows / 3 + columns / 2)))
    values = np.rint(smooth + strength * rng.normal(size=smooth.shape)).astype(np.int64).ravel()
    valid = np.ones(smooth.shape, dtype=bool)
    residuals = encode_grid(values, valid)
    assert len(packed(residuals)) < share * len(packed(former_residuals(values, valid)))
    assert residuals.relief_weight == 0


@pytest.mark.parametrize("height", [10, 100, 1000])
def test_rough_terrain_is_in_the_order_of_its_relief_too_and_takes_fewer_bytes(height):
    rng = np.random.default_rng(5)
    wave = np.hypot(*np.meshgrid(np.fft.fftfreq(160), np.fft.fftfreq(160)))
    wave[0, 0] = 1.0
    terrain = np.fft.ifft2(np.fft.fft2(rng.normal(size=wave.shape)) / wave**1.8).real
    values = np.rint(terrain * height / terrain.std()).astype(np.int64).ravel()
    valid = np.ones(wave.shape, dtype=bool)
    residuals = encode_grid(values, valid)
    assert len(packed(residuals)) < 0.995 * len(packed(former_residuals(values, valid)))
    assert residuals.relief_weight == 1


@pytest.mark.parametrize("of", ["centimetres", "nearest"])
def test_what_repeats_is_written_in_the_form_of_before(of):
    """Its low bits are no noise: halved bytes took 5 to 16 % more."""
    metres = np.rint(3 * hills(60, 60) + np.random.default_rng(2).normal(0, 2, (60, 60)))
    cells = metres * 100 if of == "centimetres" else np.kron(metres[::3, ::3], np.ones((8, 8)))
    values, valid = cells.astype(np.int64).ravel(), np.ones(cells.shape, dtype=bool)
    residuals = encode_grid(values, valid)
    assert isinstance(residuals, FormerResiduals)
    assert len(packed(residuals)) < min(len(packed(encoded(values, valid, w))) for w in (0, 1))
    assert np.array_equal(decode_grid(residuals, valid), values)


def test_a_large_raster_is_judged_by_stretches_of_it(monkeypatch):
    monkeypatch.setattr(grid_codec, "_SAMPLE", 64)
    seen = []
    monkeypatch.setattr(grid_codec, "_smallest", lambda passes: seen.extend(passes) or 1)
    values = np.rint(hills(60, 60) * 10).astype(np.int64)
    valid = np.ones((60, 60), dtype=bool)
    residuals = encode_grid(values.ravel(), valid)
    assert [len(array) for found in seen for array in (*found[:2], *found.classes)] == [64] * 12
    assert np.array_equal(decode_grid(residuals, valid), values.ravel())


def test_a_small_raster_by_hand():
    """Each number in the file, worked out on paper.

    ::

        5  5  6      pass 0: the corner, 5 - 0 = 5, zigzag 10
        4  9  6      pass 1: the other corner, 6 - 5 = 1, so 2
                     pass 2: below the centre, 9 - 5.5 (6) = 3, so 6; an error of 1 beside it
                     pass 3: the upper edge, 5 - 20 / 3 (7) = -2, so 3; errors 0 + 1 + 3
                     pass 4: the left edge, 4 - 7 = -3, so 5; errors 0 + 3
                             the right one, 6 - 7.5 (8) = -2, so 3; errors 1 + 3

    The classes are 0, 0, 1, 5, 4, 5, their medians 10 (of 2 and 10), 6, 5 and 3: of these all but
    the highest two bits are low ones.
    """
    values = np.array([[5, 5, 6], [4, 9, 6]])
    residuals = encoded(values, np.ones((2, 3), dtype=bool))
    assert residuals.relief_weight == 0
    assert residuals.low_bits == (2, 1, 0, 0, 1, 0)
    # 10 >> 2, 2 >> 2; 6 >> 1, 3; 5 >> 1, 3
    assert residuals.pairs.tolist() == [0x20, 0x33, 0x23]
    # 10: 0, 1; 2: 0, 1; 6: 0; 5: 1, and two bits that fill the byte
    assert residuals.low.tolist() == [0b01010100]
    assert residuals.beyond.tolist() == []


@pytest.mark.parametrize(
    ("spike", "symbol", "beyond"), [(7, 14, []), (-8, 15, [0]), (999, 15, [1983])]
)
def test_what_four_bits_do_not_hold_is_beyond_them(spike, symbol, beyond):
    """No other cell is predicted from the one that stands out, and it comes in the last pass."""
    values = np.zeros((5, 5), dtype=np.int64)
    values[3, 4] = spike
    residuals = encoded(values, np.ones((5, 5), dtype=bool))
    assert residuals.pairs.tolist() == [*[0] * 12, symbol << 4]
    assert (residuals.low_bits, residuals.beyond.tolist()) == ((0,), beyond)


@pytest.mark.parametrize(
    ("context", "expected"),
    [(0, 0), (1, 1), (2, 3), (3, 4), (4, 5), (5, 5), (6, 6), (7, 6), (8, 7), (11, 7), (12, 8),
     (2**31 - 1, 62), (2**31, 63), (5 * (2**32 - 1), 69)],
)  # fmt: skip
def test_classes_begin_at_powers_of_two_and_half_way_between(context, expected):
    """The last is the largest context that there is."""
    relief = np.array([2.0**63 if context > 2**33 else 0.0])
    wrong = np.array([float(context) - min(relief[0], MOST_APART)])
    assert grid_codec._classes(relief, wrong, 1).tolist() == [expected]
    if not relief[0]:
        assert grid_codec._classes(relief, wrong, 0).tolist() == [expected]
    assert expected < grid_codec._N_CLASSES


@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (50, 1), (2, 33), (65, 64)])
@pytest.mark.parametrize("span", [0, 1, 300, 70_000, 2**40, 2**63 - 1])
@pytest.mark.parametrize("share", [1.0, 0.6, 0.03, 0.0])
def test_any_shape_and_any_width(shape, span, share):
    rng = np.random.default_rng(7)
    valid = rng.random(shape) < share
    values = rng.integers(-span - 1, span, int(valid.sum()), endpoint=True)
    assert np.array_equal(decode_grid(encode_grid(values, valid), valid), values)
    for weight in (0, 1):
        assert np.array_equal(decode_grid(encoded(values, valid, weight), valid), values)
    former = former_residuals(values, valid)
    assert np.array_equal(decode_grid(former, valid), values)


def test_the_ends_of_int64_come_back():
    """Differences of them wrap round."""
    ends = np.array([-(2**63), 2**63 - 1, 0, -1])
    values = np.random.default_rng(1).choice(ends, 30 * 31)
    valid = np.ones((30, 31), dtype=bool)
    residuals = encoded(values, valid)
    assert np.array_equal(decode_grid(residuals, valid), values)
    assert max(residuals.low_bits) == grid_codec.MOST_LOW_BITS


@given(data=st.data())
def test_damaged_residuals_are_refused_or_read(data):
    rng = np.random.default_rng(data.draw(st.integers(0, 9)))
    valid = rng.random((9, 11)) < 0.8
    span = data.draw(st.sampled_from([2, 40, 2**30, 2**62]))
    residuals = encoded(rng.integers(-span, span, int(valid.sum())), valid)
    for name in data.draw(st.sets(st.sampled_from(["pairs", "low", "beyond"]), min_size=1)):
        array = getattr(residuals, name).copy()
        if len(array):
            array[data.draw(st.integers(0, len(array) - 1))] ^= array.dtype.type(
                data.draw(st.integers(0, np.iinfo(array.dtype).max))
            )
            residuals = residuals._replace(**{name: array[: data.draw(st.integers(0, len(array)))]})
    if data.draw(st.booleans()):
        widths = data.draw(st.lists(st.integers(-1, 64), max_size=72))
        residuals = residuals._replace(low_bits=tuple(widths))
    try:
        found = decode_grid(residuals, valid)
    except PyramidError:
        return
    assert found.shape == (int(valid.sum()),)
    assert found.dtype == np.int64


@pytest.mark.parametrize(("every", "expected"), [(1, "33ee499e9165ea52"), (3, "c9f2e84a4d5401fe")])
def test_residuals_are_what_they_were(every, expected):
    """What writer and reader change alike comes back, and yet reads no file of before."""
    values, valid = a_pattern(every)
    residuals = encoded(values, valid, weight=every // 2)
    digest = hashlib.sha256(residuals.pairs.tobytes() + residuals.low.tobytes())
    digest.update(residuals.beyond.tobytes())
    digest.update(repr([*residuals.low_bits, residuals.relief_weight]).encode())
    assert digest.hexdigest()[:16] == expected


def a_pattern(every):
    """Return numbers and a mask that are the same everywhere."""
    rows, columns = np.arange(37)[:, None], np.arange(53)[None, :]
    values = (rows * rows // 3 + columns * (rows % 7) - (columns * columns) // 5) % 1000
    valid = np.broadcast_to((rows * columns) % every == 0, values.shape)
    return values[valid], valid


@pytest.mark.parametrize(("every", "expected"), [(1, "aad67cac484cb6c0"), (3, "20861d8ec466eba5")])
def test_residuals_of_formats_2_and_3_are_what_they_were_and_are_read(every, expected):
    values, valid = a_pattern(every)
    residuals = former_residuals(values, valid)
    digest = hashlib.sha256(residuals.numbers.tobytes() + residuals.beyond.tobytes())
    digest.update(repr([int(count) for count in residuals.classes]).encode())
    assert digest.hexdigest()[:16] == expected
    assert np.array_equal(decode_former_grid(residuals, valid), values)


def test_either_order_of_formats_2_and_3_is_read():
    rough = np.random.default_rng(0).integers(-3, 4, (40, 40))
    smooth = np.rint(hills(40, 40) * 20).astype(np.int64)
    valid = np.ones((40, 40), dtype=bool)
    orders = set()
    for values in (rough, smooth, rough + smooth, 1000 * rough + smooth):
        residuals = former_residuals(values.ravel(), valid)
        orders.add(len(residuals.classes))
        assert np.array_equal(decode_former_grid(residuals, valid), values.ravel())
    assert orders == {0, len(RELIEF_CLASSES) + 1}


def test_a_file_of_formats_2_and_3_is_read(raster_record, tmp_path):
    path = tmp_path / "former.gpkg"
    write_former_grid(path, raster_record)
    write_pyramid(tmp_path / "new.gpkg", raster_record)
    restored = []
    for name in (path, tmp_path / "new.gpkg"):
        with closing(sqlite3.connect(name)) as connection:
            source, n_low = connection.execute(
                "SELECT value, (SELECT count(*) FROM wavelet_arrays WHERE name = 'source/low') "
                "FROM wavelet_metadata WHERE name = 'source'"
            ).fetchone()
        assert ("relief_classes" in source, n_low) == (name == path, int(name != path))
        restored.append(read_pyramid(name).restore())
    former, new = restored
    assert former.values.tobytes() == new.values.tobytes()
    assert np.array_equal(former.valid, new.valid)


def test_residuals_of_another_mask_are_refused():
    values = np.arange(36).reshape(6, 6) ** 3
    valid = np.ones((6, 6), dtype=bool)
    residuals = encoded(values, valid)
    assert len(residuals.low)
    assert len(residuals.beyond)
    fewer = valid.copy()
    fewer[2, 2] = False
    for broken in (
        residuals._replace(pairs=residuals.pairs[1:]),
        residuals._replace(pairs=residuals.pairs.astype(np.uint16)),
        residuals._replace(pairs=residuals.pairs.reshape(-1, 1)),
        residuals._replace(low=residuals.low[1:]),
        residuals._replace(low=np.append(residuals.low, np.uint8(0))),
        residuals._replace(low=residuals.low.astype(np.int8)),
        residuals._replace(beyond=residuals.beyond[1:]),
        residuals._replace(beyond=np.append(residuals.beyond, np.uint64(0))),
        residuals._replace(beyond=residuals.beyond.astype(np.uint8)),
        residuals._replace(low_bits=(0,) * 71),
        residuals._replace(low_bits=(-1,)),
        residuals._replace(low_bits=(63,)),
        residuals._replace(low_bits=(2**63 - 1,)),
        residuals._replace(low_bits=(62,) * 70),
        residuals._replace(low_bits=()),
        residuals._replace(relief_weight=2),
    ):
        with pytest.raises(PyramidError, match="do not fit"):
            decode_grid(broken, valid)
    for smaller in (fewer, valid[:, :5]):
        with pytest.raises(PyramidError, match="do not fit"):
            decode_grid(residuals, smaller)


def test_what_fills_the_last_byte_is_nothing():
    valid = np.ones((3, 3), dtype=bool)
    residuals = encoded(np.arange(9), valid)
    pairs = residuals.pairs.copy()
    pairs[-1] |= 1
    with pytest.raises(PyramidError, match="do not fit"):
        decode_grid(residuals._replace(pairs=pairs), valid)


def test_residuals_of_formats_2_and_3_of_another_mask_are_refused():
    valid = np.ones((6, 6), dtype=bool)
    residuals = former_residuals(np.arange(36), valid)
    fewer = valid.copy()
    fewer[2, 2] = False
    for broken in (
        residuals._replace(numbers=residuals.numbers[1:]),
        residuals._replace(beyond=np.ones(3, np.uint64)),
        residuals._replace(classes=(36,)),
        residuals._replace(classes=(0,) * 29),
    ):
        with pytest.raises(PyramidError, match="do not fit"):
            decode_former_grid(broken, valid)
    with pytest.raises(PyramidError, match="do not fit"):
        decode_former_grid(residuals, fewer)


def test_the_numbers_of_a_raster_are_packed_in_parts_that_are_reported():
    """A million cells took a second without a word, four million three."""
    numbers = np.random.default_rng(3).integers(0, 50, 64 * 64)
    valid = np.ones((64, 64), dtype=bool)
    seen = []
    residuals = encode_grid(numbers, valid, seen.append)
    assert np.array_equal(decode_grid(residuals, valid), numbers)
    assert seen == sorted(seen)
    assert np.diff([0.0, *seen, 1.0]).max() <= 0.26
    with pytest.raises(Cancelled):
        encode_grid(numbers, valid, lambda fraction: fraction < 0.6)


@pytest.mark.parametrize("count", [0, 1, 64, -64, 2**62, 2**70])
def test_classes_that_do_not_count_the_cells_are_refused(count):
    """Classes of more than all cells ended in a ValueError."""
    valid = np.ones((8, 8), dtype=bool)
    residuals = former_residuals(np.arange(64, dtype=np.int64), valid)
    n_classes = len(RELIEF_CLASSES) + 1
    with pytest.raises(PyramidError, match="do not fit its mask"):
        decode_former_grid(residuals._replace(classes=(count,) * n_classes), valid)
