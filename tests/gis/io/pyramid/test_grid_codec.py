"""A raster's numbers come back from their residuals, whatever they are and wherever holes lie."""

import hashlib

import numpy as np
import pytest
from gis.samples import hills
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from wavelet_core.errors import Cancelled, PyramidError
from wavelet_gis.io.pyramid.codecs.grid_codec import (
    RELIEF_CLASSES,
    decode_grid,
    encode_grid,
    integers_of,
    values_of,
)

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
    residuals = encode_grid(values.ravel(), valid)
    assert residuals.numbers.dtype == np.uint8
    along_rows = np.abs(np.diff(values, axis=1)).mean()
    assert residuals.numbers.astype(float).mean() / 2 < along_rows


def test_of_a_large_raster_one_order_alone_is_tried(monkeypatch):
    values = np.rint(hills(40, 40) * 20).astype(np.int64)
    valid = np.ones(values.shape, dtype=bool)
    monkeypatch.setattr("wavelet_gis.io.pyramid.codecs.grid_codec.MOST_TRIED", 1000)
    residuals = encode_grid(values.ravel(), valid)
    assert np.array_equal(decode_grid(residuals, valid), values.ravel())
    assert len(residuals.classes) == 0


@pytest.mark.parametrize(("every", "expected"), [(1, "aad67cac484cb6c0"), (3, "20861d8ec466eba5")])
def test_residuals_are_what_they_were(every, expected):
    """What writer and reader change alike comes back, and yet reads no file of before."""
    rows, columns = np.arange(37)[:, None], np.arange(53)[None, :]
    values = (rows * rows // 3 + columns * (rows % 7) - (columns * columns) // 5) % 1000
    valid = (rows * columns) % every == 0
    residuals = encode_grid(values[valid], np.broadcast_to(valid, values.shape))
    digest = hashlib.sha256(residuals.numbers.tobytes() + residuals.beyond.tobytes())
    digest.update(repr([int(count) for count in residuals.classes]).encode())
    assert digest.hexdigest()[:16] == expected


def test_either_order_is_read():
    rough = np.random.default_rng(0).integers(-3, 4, (40, 40))
    smooth = np.rint(hills(40, 40) * 20).astype(np.int64)
    valid = np.ones((40, 40), dtype=bool)
    for values in (rough, smooth, rough + smooth):
        residuals = encode_grid(values.ravel(), valid)
        assert np.array_equal(decode_grid(residuals, valid), values.ravel())


def test_residuals_of_another_mask_are_refused():
    values = np.arange(36).reshape(6, 6)
    valid = np.ones((6, 6), dtype=bool)
    residuals = encode_grid(values.ravel(), valid)
    fewer = valid.copy()
    fewer[2, 2] = False
    for broken in (
        residuals._replace(numbers=residuals.numbers[1:]),
        residuals._replace(beyond=np.ones(3, np.uint64)),
        residuals._replace(classes=(36,)),
        residuals._replace(classes=(0,) * 29),
    ):
        with pytest.raises(PyramidError, match="do not fit"):
            decode_grid(broken, valid)
    with pytest.raises(PyramidError, match="do not fit"):
        decode_grid(residuals, fewer)


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
    residuals = encode_grid(np.arange(64, dtype=np.int64), valid)
    n_classes = len(RELIEF_CLASSES) + 1
    with pytest.raises(PyramidError, match="do not fit its mask"):
        decode_grid(residuals._replace(classes=(count,) * n_classes), valid)
