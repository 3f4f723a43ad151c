"""The original comes back bit for bit from values that are right only to rounding."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from wavelet_core.errors import PyramidError
from wavelet_gis.model.exact_restore import ExactColumn, checksum, exact_column, nearest_of_dtype

DTYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8", ">i2", ">f4", ">f8")


def columns(dtype):
    limit = 1e30 if np.dtype(dtype).kind == "f" else None
    elements = None
    if limit is not None:
        width = 8 * np.dtype(dtype).itemsize
        bound = float(np.float32(limit))
        elements = st.floats(-bound, bound, width=width)
    return hnp.arrays(np.dtype(dtype), st.integers(0, 40), elements=elements)


def same_bits(actual, expected):
    expected = expected.astype(expected.dtype.newbyteorder("<"))
    return actual.dtype == expected.dtype and actual.tobytes() == expected.tobytes()


@pytest.mark.parametrize("dtype", DTYPES)
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_every_bit_of_every_type_comes_back(dtype, data, seed):
    original = data.draw(columns(dtype))
    values = original.astype(np.float64)
    extent = float(np.abs(values).max(initial=0.0))
    rng = np.random.default_rng(seed)
    seen = values + rng.uniform(-1, 1, len(values)) * extent * 1e-13
    column = exact_column(original, seen)
    assert same_bits(column.restore(seen), original)


@given(columns("f8"), st.integers(0, 2**32 - 1))
def test_another_machine_may_round_otherwise(original, seed):
    extent = float(np.abs(original).max(initial=0.0))
    rng = np.random.default_rng(seed)
    error = rng.uniform(-1, 1, len(original)) * extent * 1e-14
    column = exact_column(original, original + error)
    elsewhere = original + 100 * rng.permutation(error)
    assert same_bits(column.restore(elsewhere), original)


@pytest.mark.parametrize("dtype", ["f4", "f8"])
def test_the_sign_of_zero_does_not_hang_on_that_of_the_error(dtype):
    original = np.array([1.0, 0.0, -0.0, 0.0], dtype)
    column = exact_column(original, original.astype(float) + 1e-14)
    assert same_bits(column.restore(original.astype(float) - 1e-14), original)


def test_integers_and_plain_float32_cost_nothing():
    rng = np.random.default_rng(0)
    for original in (
        rng.integers(-500, 9000, 1000).astype("i2"),
        rng.uniform(200, 400, 1000).astype("f4"),
        rng.uniform(200, 400, 1000).astype("f4").astype("f8"),
    ):
        column = exact_column(original, original.astype(float) + 1e-12)
        assert column.remainder is None
        assert len(column.exception_rows) == 0


def test_signed_zero_and_nan_payload_free_values():
    original = np.array([-0.0, 0.0, 5e-324, -5e-324, 1.0, np.nextafter(1.0, 2.0)])
    column = exact_column(original, original + 1e-13)
    assert same_bits(column.restore(original - 1e-13), original)


def test_values_that_are_not_near_stay_wrong():
    # The corrections make up for rounding; it must not hide that the pyramid is another one.
    original = np.linspace(0, 100, 50)
    column = exact_column(original, original + 1e-12)
    assert not same_bits(column.restore(original + 0.5), original)


def test_parts_survive_and_damage_is_seen():
    original = np.array([0.1, 0.2, -0.0, 1e6])
    column = exact_column(original, original + 1e-10)
    fields, arrays = column.to_parts("c")
    again = ExactColumn.from_parts("c", fields, arrays)
    assert same_bits(again.restore(original), original)
    for damage in ({"quantum": 0}, {"quantum": "x"}, {"dtype": "O"}, {"dtype": "<c16"}):
        with pytest.raises(PyramidError, match="damaged"):
            ExactColumn.from_parts("c", fields | damage, arrays)
    with pytest.raises(PyramidError, match="remainders"):
        again.restore(original[:2])
    wild = arrays | {
        "c/exception_rows": np.array([99]),
        "c/exception_values": np.array([1.0]),
    }
    with pytest.raises(PyramidError, match="beyond"):
        ExactColumn.from_parts("c", fields, wild).restore(original)
    uneven = arrays | {"c/exception_rows": np.array([1, 2]), "c/exception_values": np.array([1.0])}
    with pytest.raises(PyramidError, match="damaged"):
        ExactColumn.from_parts("c", fields, uneven)


@pytest.mark.parametrize("dtype", ["u1", "i2", "i8", "u8"])
def test_integers_are_kept_within_their_range(dtype):
    limits = np.iinfo(dtype)
    values = np.array([-1e30, -0.4, 0.6, 1e30])
    expected = [limits.min, 0, 1, limits.max]
    assert nearest_of_dtype(values, np.dtype(dtype)).tolist() == expected


def test_the_checksum_knows_order_and_not_byte_order():
    a, b = np.arange(4, dtype="<i2"), np.arange(4, dtype=">i2")
    assert checksum([a]) == checksum([b])
    assert checksum([a, a[:0]]) == checksum([a])
    assert checksum([a]) != checksum([a[::-1]])
