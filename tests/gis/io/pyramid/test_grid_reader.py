"""A second reader of a raster's residuals, cell by cell, as the format page says it."""

from unittest.mock import patch

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from wavelet_gis.io.pyramid.codecs import grid_codec
from wavelet_gis.io.pyramid.codecs.grid_codec import encode_grid


@given(data=st.data())
def test_it_finds_the_same(data):
    shape = data.draw(st.tuples(st.integers(1, 12), st.integers(1, 12)))
    span = data.draw(st.sampled_from([3, 90, 2**20, 2**45]))
    values = data.draw(hnp.arrays(np.int64, shape, elements=st.integers(-span, span)))
    values += 10 * np.arange(shape[1])
    valid = data.draw(hnp.arrays(bool, shape))
    for weight in (0, 1):
        with patch.object(grid_codec, "_smallest", return_value=weight):
            residuals = encode_grid(values[valid], valid)
        assert residuals.relief_weight == weight
        assert slow_reader(residuals, valid) == values[valid].tolist()


def slow_reader(residuals, valid):
    """Return the numbers of the valid cells, cell by cell, out of sound residuals."""
    upper = iter([half for pair in residuals.pairs.tolist() for half in divmod(pair, 16)])
    beyond = iter(residuals.beyond.tolist())
    bits = iter("".join(f"{byte:08b}" for byte in residuals.low.tolist()))
    low_bits = dict(enumerate(residuals.low_bits))
    number, error = {}, {}
    for index, (h, cells, near, far) in enumerate(passes_of_the_page(*valid.shape)):
        found = []
        for row, column in ((r, c) for r, c in cells if valid[r, c]):
            at = [(row + r * h, column + c * h) for r, c in near]
            beside = [number[cell] for cell in at if cell in number]
            others = [number.get((row + r * h, column + c * h)) for r, c in far]
            predicted = sum(beside) / len(beside) if beside else 0
            if len(beside) == 4 and None not in others:
                predicted = (10 * sum(beside) - sum(others)) / 32
            relief = min(max(beside) - min(beside), 2**32 - 1) if beside else 0
            context = sum(error.get(cell, 0) for cell in at) + residuals.relief_weight * relief
            e = context.bit_length() - 1
            of = 2 * e + 1 + (2 * context >= 3 * 2**e) if context else 0
            found.append((of if index % 2 == 0 else -of, row, column, round(predicted)))
        found.sort()
        left = [high + next(beyond) if (high := next(upper)) == 15 else high for _ in found]
        widths = [low_bits.get(abs(of), 0) for of, *_ in found]
        left = [high << width for high, width in zip(left, widths, strict=True)]
        for bit in range(max(widths, default=0)):
            for place, width in enumerate(widths):
                left[place] |= int(next(bits)) << bit if width > bit else 0
        for (_, row, column, predicted), one in zip(found, left, strict=True):
            residual = -(one + 1) // 2 if one % 2 else one // 2
            number[row, column] = predicted + residual
            error[row, column] = min(abs(residual), 2**32 - 1) if near else 0
    return [number[cell] for cell in sorted(number)]


def passes_of_the_page(n_rows, n_columns):
    """Yield the passes: h, the cells, and the offsets of near and far neighbours in parts of h."""
    s = 1
    while s < max(n_rows, n_columns):
        s *= 2
    yield s, [(r, c) for r in range(0, n_rows, s) for c in range(0, n_columns, s)], (), ()
    diagonal = [(a, b) for a in (-1, 1) for b in (-1, 1)]
    straight = [(-1, 0), (1, 0), (0, -1), (0, 1)]
    wide = [(3 * a, b) for a, b in diagonal] + [(a, 3 * b) for a, b in diagonal]
    around = [(a, 2 * b) for a, b in diagonal] + [(2 * a, b) for a, b in diagonal]
    while s > 1:
        h = s // 2
        for row, column, near, far in (
            (h, h, diagonal, wide), (0, h, straight, around), (h, 0, straight, around)
        ):  # fmt: skip
            cells = [(r, c) for r in range(row, n_rows, s) for c in range(column, n_columns, s)]
            if cells:
                yield h, cells, near, far
        s = h
