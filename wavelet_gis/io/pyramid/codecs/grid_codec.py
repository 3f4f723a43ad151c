"""The numbers of a raster as residuals of their prediction from coarser to finer cells.

The residuals of each pass (see `grid_walk`) are put in order of how wrong the predictions around
them were and, where that helps, of how much the neighbours differ, small ones first, in every other
pass last: what a compressor then sees changes but slowly. Of each class of that order, the lowest
bits, which are noise, are kept as they are, and what is above them takes four bits: a compressor of
bytes spends something on each bit of them, even on those that are always 0.

Numbers are integers throughout: those of integer rasters; floats times a divisor that makes
integers of all of them (hundreds of centimetres); places in a palette where few values differ;
other floats by the order of their bits.
"""

from __future__ import annotations

import lzma
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core._threads import run_in_blocks
from wavelet_core._validate import distinct
from wavelet_core.errors import PyramidError
from wavelet_core.progress import part_of, report
from wavelet_gis.io.pyramid.codecs.array_codec import WRITTEN_LZMA_FILTERS, unzigzag, zigzag
from wavelet_gis.io.pyramid.codecs.former_grids import (
    FormerResiduals,
    decode_former_grid,
    former_relief,
    pass_by_pass,
)
from wavelet_gis.io.pyramid.codecs.grid_walk import MOST_APART, require, walk

__all__ = [
    "DIVISORS",
    "MOST_LOW_BITS",
    "RELIEF_WEIGHTS",
    "Numbers",
    "Residuals",
    "decode_grid",
    "encode_grid",
    "integers_of",
    "values_of",
]

#: What floats are tried with, the first that fits is taken: halves to 1/1024 and decimals.
DIVISORS = (1, 2, 4, 8, 10, 16, 20, 32, 64, 100, 128, 256, 512, 1000, 1024, 10_000, 100_000)

#: A divisor is no find where it hardly has fewer digits than the floats themselves.
_LEAST_SPACINGS = 4.0

#: Floats that are no multiples have a palette if no more than this share of them differ: means of
#: a few decimals, which repeat.
MOST_IN_PALETTE = 1 / 16

#: How much the relief around a cell counts beside the errors of its near neighbours, in what the
#: residuals are put in order of: where white noise lies on slopes, relief tells nothing of it.
RELIEF_WEIGHTS = (0, 1)

#: Residuals with this in four bits, or more, have the rest beyond.
ESCAPE = 15

#: A number whose upper bits are 2 or 3 has so many; what is below them hardly compresses.
_UPPER_BITS = 2

#: Low bits that a residual of 64 bits may have.
MOST_LOW_BITS = 64 - _UPPER_BITS

#: Residuals of each of the last passes by which the smallest form is found, in so many stretches.
_SAMPLE, _STRETCHES = 1 << 15, 4

#: Twice the exponent of 1 as a double has it.
_HALVES_OF_ONE = 2 * 1023

#: Classes of contexts up to 2^34, and that is the last: they are less than one and a half times it.
_N_CLASSES = 70


class Numbers(NamedTuple):
    """Numbers as integers.

    integers : (n,) int64
    divisor : int, of which they are the multiples; 0 for all others
    palette : array of the values' type, or None; the different values in the order of their bits,
        of which the integers are the places
    """

    integers: NDArray[np.int64]
    divisor: int
    palette: NDArray[Any] | None = None


def integers_of(values: NDArray[Any]) -> Numbers:
    """Return the integers that stand for values, to the bit."""
    dtype = values.dtype.newbyteorder("=")
    if dtype.kind != "f":
        return Numbers(values.astype(np.int64), 0)
    finite = bool(np.isfinite(values).all())
    largest = float(np.abs(values).max(initial=0.0)) if finite else np.inf
    for divisor in DIVISORS if finite and largest < 2.0**40 else ():
        if len(values) and 1.0 / divisor < _LEAST_SPACINGS * float(np.spacing(dtype.type(largest))):
            break
        integers = np.rint(values.astype(np.float64) * divisor).astype(np.int64)
        if values_of(integers, dtype, divisor).tobytes() == values.tobytes():
            return Numbers(integers, divisor)
    bits = _mirrored(values.view(f"<i{dtype.itemsize}").astype(np.int64), dtype.itemsize)
    different = distinct(bits)
    if len(different) > MOST_IN_PALETTE * len(bits):
        return Numbers(bits, 0)
    places = np.empty(len(bits), dtype=np.int64)

    def find(start: int, stop: int) -> None:
        places[start:stop] = np.searchsorted(different, bits[start:stop])

    run_in_blocks(find, len(bits))
    return Numbers(places, 0, values_of(different, dtype, 0))


def values_of(
    integers: NDArray[np.int64],
    dtype: np.dtype[Any],
    divisor: int,
    palette: NDArray[Any] | None = None,
) -> NDArray[Any]:
    """Return the values that integers stand for; the way back of `integers_of`.

    Raises
    ------
    PyramidError
        Places that the palette does not have.
    """
    if palette is not None:
        if len(integers) and not 0 <= integers.min() <= integers.max() < len(palette):
            raise PyramidError("numbers beyond the palette of the raster; the file is damaged.")
        return palette[integers]
    if dtype.kind != "f":
        return integers.astype(dtype)
    if divisor:
        return (integers / float(divisor)).astype(dtype)
    return _mirrored(integers, dtype.itemsize).astype(f"<i{dtype.itemsize}").view(dtype)


def _mirrored(bits: NDArray[np.int64], itemsize: int) -> NDArray[np.int64]:
    """Return the bits of floats as integers of the same order, and those as bits again."""
    return bits ^ ((bits >> 63) & np.int64(2 ** (8 * itemsize - 1) - 1))


class Residuals(NamedTuple):
    """What the predictions of a raster's numbers leave: 0, -1, 1, -2, ... as 0, 1, 2, 3, ...

    pairs : uint8, the upper bits of two residuals each, the first in the upper half
    low : uint8, the low bits of all residuals, eight in each, the first the highest
    beyond : uint64, what the upper bits are above ESCAPE, where they are not below it
    low_bits : tuple of int, how many low bits the residuals of each class have; those of further
        classes have none
    relief_weight : int, 1 where relief counts in the class, else 0
    """

    pairs: NDArray[np.uint8]
    low: NDArray[np.uint8]
    beyond: NDArray[np.uint64]
    low_bits: tuple[int, ...]
    relief_weight: int


_Classified = tuple[NDArray[np.uint64], NDArray[np.uint8]]


class _Found(NamedTuple):
    """Residuals of a pass row by row, zigzag, the relief there as the former had it, and classes.

    There is an array of classes by each of RELIEF_WEIGHTS.
    """

    residuals: NDArray[np.uint64]
    relief: NDArray[np.uint16]
    classes: tuple[NDArray[np.uint8], ...]

    def sample(self) -> _Found:
        """Return some stretches of rows, or all of them."""
        length = len(self.residuals)
        if length <= _SAMPLE:
            return self
        rows = _SAMPLE // _STRETCHES
        starts = (length - rows) * np.arange(_STRETCHES) // (_STRETCHES - 1)
        places = (starts[:, np.newaxis] + np.arange(rows)).reshape(-1)
        classes = tuple(one[places] for one in self.classes)
        return _Found(self.residuals[places], self.relief[places], classes)

    def classified(self, place: int) -> _Classified:
        """Return the residuals and the classes by one of the weights."""
        return self.residuals, self.classes[place]


class _Split(NamedTuple):
    """All residuals as they are stored, but for the low bits."""

    residuals: NDArray[np.uint64]
    n_low: NDArray[np.uint8]
    low_bits: tuple[int, ...]
    pairs: NDArray[np.uint8]
    beyond: NDArray[np.uint64]


def encode_grid(
    integers: NDArray[np.int64], valid: NDArray[np.bool_], progress: Progress | None = None
) -> Residuals | FormerResiduals:
    """Return the residuals of the valid cells, in whichever order and form takes fewest bytes.

    Parameters
    ----------
    integers : (n_valid,) int64
        In row-major order.
    valid : (n_rows, n_columns) bool
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Examples
    --------
    Two cells hold 7 and 9. The first is predicted 0, the other 7; what is left becomes 14 and 4, of
    which the lowest two bits are kept apart.

    >>> residuals = encode_grid(np.array([7, 9]), np.ones((1, 2), dtype=bool))
    >>> [divmod(int(pair), 16) for pair in residuals.pairs], residuals.low_bits
    ([(3, 1)], (2,))
    """
    grid = np.zeros(valid.shape, dtype=np.int64)
    grid[valid] = integers
    passes: list[_Found] = []

    def contexts(
        relief: NDArray[np.float64], wrong: NDArray[np.float64]
    ) -> tuple[NDArray[Any], ...]:
        classes = [_classes(relief, wrong, weight) for weight in RELIEF_WEIGHTS]
        return (*former_relief(relief, wrong), *classes)

    def keep(
        predicted: NDArray[np.int64],
        cells: NDArray[np.int64],
        relief: NDArray[np.uint16],
        *classes: NDArray[np.uint8],
    ) -> NDArray[np.int64]:
        with np.errstate(over="ignore"):
            residuals = zigzag((cells - predicted).view(np.uint64))
        passes.append(_Found(residuals, relief, classes))
        return cells

    walk(grid, valid, contexts, keep, part_of(progress, 0.0, 0.6))
    del grid
    place = _smallest([found.sample() for found in passes[-3:]])
    report(progress, 0.75)
    if place == len(RELIEF_WEIGHTS):
        return pass_by_pass([(found.residuals, found.relief) for found in passes])
    split = _split([found.classified(place) for found in passes])
    report(progress, 0.9)
    planes = _planes(split.residuals, split.n_low, [len(found.residuals) for found in passes])
    low = np.concatenate(list(_packed(planes)))
    return Residuals(split.pairs, low, split.beyond, split.low_bits, RELIEF_WEIGHTS[place])


def _smallest(passes: list[_Found]) -> int:
    """Return the place of the weight by which passes take fewest bytes, or one more: the former."""
    sizes = []
    for place in range(len(RELIEF_WEIGHTS)):
        split = _split([found.classified(place) for found in passes])
        n_bytes = _compressed(split.pairs) + _compressed(split.beyond)
        sizes.append(n_bytes + int(split.n_low.sum()) // 8)
    former = pass_by_pass([(found.residuals, found.relief) for found in passes])
    sizes.append(_compressed(former.numbers) + _compressed(former.beyond))
    return int(np.argmin(sizes))


def _compressed(array: NDArray[Any]) -> int:
    """Return how many bytes an array takes in the file."""
    by_byte = array.view(np.uint8).reshape(-1, array.itemsize).T.tobytes()
    return len(lzma.compress(by_byte, lzma.FORMAT_RAW, filters=WRITTEN_LZMA_FILTERS))


def decode_grid(
    residuals: Residuals | FormerResiduals,
    valid: NDArray[np.bool_],
    progress: Progress | None = None,
) -> NDArray[np.int64]:
    """Return the integers of the valid cells from their residuals; see `encode_grid`.

    Parameters
    ----------
    residuals : Residuals or FormerResiduals
        Of any origin.
    valid : (n_rows, n_columns) bool
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    PyramidError
        When there is not one residual for each valid cell, or it lacks some of its bits.
    """
    if isinstance(residuals, FormerResiduals):
        return decode_former_grid(residuals, valid, progress)
    pairs, low, beyond, low_bits, relief_weight = residuals
    n_valid = int(np.count_nonzero(valid))
    require(
        pairs.shape == (-(-n_valid // 2),)
        and low.ndim == beyond.ndim == 1
        and pairs.dtype == low.dtype == np.uint8
        and beyond.dtype == np.uint64
        and len(low_bits) <= _N_CLASSES
        and all(0 <= n_bits <= MOST_LOW_BITS for n_bits in low_bits)
        and relief_weight in RELIEF_WEIGHTS
    )
    upper = np.stack([pairs >> 4, pairs & ESCAPE], axis=1).reshape(-1)
    require(not upper[n_valid:].any() and len(beyond) == np.count_nonzero(upper == ESCAPE))
    bits_of_class = np.zeros(_N_CLASSES, dtype=np.uint8)
    bits_of_class[: len(low_bits)] = low_bits
    n_passes = n_used = n_beyond = n_bits = 0

    def classes(
        relief: NDArray[np.float64], wrong: NDArray[np.float64]
    ) -> tuple[NDArray[np.uint8]]:
        return (_classes(relief, wrong, relief_weight),)

    def put(
        predicted: NDArray[np.int64], cells: NDArray[np.int64], of: NDArray[np.uint8]
    ) -> NDArray[np.int64]:
        nonlocal n_passes, n_used, n_beyond, n_bits
        order = _order(of, n_passes)
        n_low = bits_of_class[of[order]]
        number = upper[n_used : n_used + len(of)].astype(np.uint64)
        is_beyond = number == ESCAPE
        n_here = int(np.count_nonzero(is_beyond))
        number[is_beyond] += beyond[n_beyond : n_beyond + n_here]
        number <<= n_low
        for bit in range(int(n_low.max(initial=0))):
            has_bit = n_low > bit
            n_set = int(np.count_nonzero(has_bit))
            number[has_bit] |= _bits(low, n_bits, n_set).astype(np.uint64) << np.uint64(bit)
            n_bits += n_set
        n_passes, n_used, n_beyond = n_passes + 1, n_used + len(of), n_beyond + n_here
        residual = np.empty(len(of), dtype=np.int64)
        residual[order] = unzigzag(number).view(np.int64)
        with np.errstate(over="ignore"):
            return predicted + residual

    grid = np.zeros(valid.shape, dtype=np.int64)
    walk(grid, valid, classes, put, progress)
    require(len(low) == -(-n_bits // 8))
    return grid[valid]


def _classes(
    relief: NDArray[np.float64], wrong: NDArray[np.float64], weight: int
) -> NDArray[np.uint8]:
    """Return the classes of cells, two an octave, by how wrong their predictions may be.

    Of a context c, a whole number, the class is 0 for 0, 1 for 1, then 3 for 2, 4 for 3, 5 from 4,
    6 from 6, 7 from 8, 8 from 12, and so on. Of a double the exponent and the highest bit of the
    fraction say so exactly.
    """
    context = wrong + weight * np.minimum(relief, float(MOST_APART)) if weight else wrong
    halves = np.ascontiguousarray(context).view(np.int64) >> 51
    return np.maximum(halves - (_HALVES_OF_ONE - 1), 0).astype(np.uint8)


def _order(classes: NDArray[np.uint8], n_passes: int) -> NDArray[np.int64]:
    """Return the order of a pass after so many others: by class, or by falling class."""
    return np.argsort(classes if n_passes % 2 == 0 else ~classes, kind="stable")


def _split(passes: list[_Classified]) -> _Split:
    """Return the residuals of all passes in order, their upper bits and how many low ones."""
    orders = [_order(classes, index) for index, (_, classes) in enumerate(passes)]
    ordered = list(zip(passes, orders, strict=True))
    residuals = np.concatenate([part[order] for (part, _), order in ordered])
    classes = np.concatenate([part[order] for (_, part), order in ordered])
    del orders, ordered
    low_bits = _low_bits(residuals, classes)
    n_low = np.array(low_bits, dtype=np.uint8)[classes]
    upper = residuals >> n_low
    symbols = np.minimum(upper, ESCAPE).astype(np.uint8)
    beyond = upper[symbols == ESCAPE] - np.uint64(ESCAPE)
    pairs = np.zeros(-(-len(symbols) // 2), dtype=np.uint8)
    pairs |= symbols[::2] << np.uint8(4)
    pairs[: len(symbols) // 2] |= symbols[1::2]
    return _Split(residuals, n_low, low_bits, pairs, beyond)


def _low_bits(residuals: NDArray[np.uint64], classes: NDArray[np.uint8]) -> tuple[int, ...]:
    """Return how many low bits the residuals of each class have: by the median among them."""
    counts = np.bincount(classes)
    ordered = residuals[np.argsort(classes, kind="stable")]
    low_bits = []
    for part in np.split(ordered, np.cumsum(counts)[:-1]):
        middle = len(part) // 2
        median = int(np.partition(part, middle)[middle]) if len(part) else 0
        low_bits.append(max(median.bit_length() - _UPPER_BITS, 0))
    return tuple(low_bits)


def _planes(
    residuals: NDArray[np.uint64], n_low: NDArray[np.uint8], passes: list[int]
) -> Iterator[NDArray[np.uint8]]:
    """Yield the low bits of each pass, the lowest of all its residuals first, each as a byte."""
    stop = 0
    for length in passes:
        start, stop = stop, stop + length
        for bit in range(int(n_low[start:stop].max(initial=0))):
            with_bit = residuals[start:stop][n_low[start:stop] > bit]
            yield (with_bit >> np.uint64(bit)).astype(np.uint8) & np.uint8(1)


def _packed(planes: Iterable[NDArray[np.uint8]]) -> Iterator[NDArray[np.uint8]]:
    """Yield bits, each a byte, as eight a byte; the last byte is filled with zeros."""
    left = np.empty(0, dtype=np.uint8)
    for plane in planes:
        bits = np.concatenate([left, plane])
        n_whole = len(bits) // 8 * 8
        yield np.packbits(bits[:n_whole])
        left = bits[n_whole:]
    yield np.packbits(left)


def _bits(packed: NDArray[np.uint8], start: int, count: int) -> NDArray[np.uint8]:
    """Return so many bits from a place on, each a byte."""
    stop = start + count
    require(stop <= 8 * len(packed))
    part = np.unpackbits(packed[start // 8 : -(-stop // 8)])
    return part[start % 8 : start % 8 + count]
