"""A map of the deviation of noise that differs from place to place."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from ..._validate import FloatArray, IntArray
from ..undecimated import UndecimatedBank
from .white import NORMAL_MAD

#: Vertices of a block of the map that give the noise there, the width of the blur over blocks,
#: and what the blurred deviation of white noise varies by, times the root of that number. Where
#: noise grows with the slope, blocks of 16 to 100 and a blur of 0.25 to 1 leave the same RMSE to
#: 1 %; 9 leave 4 % more, and a blur of 2 leaves 21 % (benchmarks/quality/constants.py, four DEMs).
VERTICES_OF_BLOCK, BLUR_OF_BLOCKS, DEVIATION_OF_BLOCK = 25, 0.5, 0.9


def map_of_noise(
    bank: UndecimatedBank, plan: FloatArray, values: FloatArray, alike: FloatArray
) -> FloatArray | None:
    """Return the deviation of the noise at each vertex; None where it is the same everywhere.

    ``alike`` are columns of noise of deviation 1 that the noise of ``values`` is compared with.

    The finest details, smoothed out twice so that hills leave nothing in them, are compared by
    their mean square in blocks of the map, what is above three times the median counting as that.
    The map is believed where it varies by more than so few would alone. Squares are smoothed, not
    logarithms, and nothing is pulled towards the middle: the estimate of the risk goes by squares,
    and a map that is even too low where the noise is strong leaves it there. Measured on ten DEMs
    with noise that grows with the slope.
    """
    both = np.column_stack([values - values.mean(), alike])
    for _ in range(2):
        both = both - bank.smoother @ both
        bank.tick()
    gain = np.sqrt(bank.local_energy(np.mean(both[:, 1:] ** 2, axis=1), 4))
    size = np.abs(both[:, 0]) / np.maximum(gain, 1e-12 * max(float(gain.max()), 1e-300))
    side = np.sqrt(max(float(np.ptp(plan, axis=0).prod()), 1e-300) * VERTICES_OF_BLOCK / len(plan))
    shape = np.maximum(np.ceil(np.ptp(plan, axis=0) / side).astype(int), 1)
    if shape.prod() < 4:
        return None
    cell = np.minimum((plan / side).astype(int), shape - 1)
    block, n_blocks = cell[:, 0] * shape[1] + cell[:, 1], int(shape.prod())
    medians, counts = _medians_of_blocks(block, size, n_blocks)
    is_known = (counts >= VERTICES_OF_BLOCK / 4) & (medians > 0)
    if is_known.sum() < 4:
        return None
    limit = 3.0 * medians[block] / NORMAL_MAD
    squares = np.bincount(block, np.minimum(size, limit) ** 2, n_blocks) / np.maximum(counts, 1)
    weight = is_known.reshape(shape).astype(np.float64)
    around = np.maximum(_blurred(weight), 1e-12)
    logs = 0.5 * np.log(np.where(is_known, squares, 1.0)).reshape(shape)
    centre = float(np.median(logs[weight > 0]))
    smooth = _blurred((logs - centre) * weight) / around
    by_chance = DEVIATION_OF_BLOCK**2 / VERTICES_OF_BLOCK
    if float(np.var(smooth[weight > 0])) <= 2 * by_chance:
        return None
    apart = np.where(is_known, squares, 0.0).reshape(shape) - np.exp(2 * centre) * weight
    variance = np.exp(2 * centre) + _blurred(apart) / around
    at = (plan / side - 0.5).T
    found = ndimage.map_coordinates(variance, at, order=1, mode="nearest")
    local: FloatArray = np.sqrt(np.maximum(found, 1e-300))
    return local


def _blurred(blocks: FloatArray) -> FloatArray:
    blurred: FloatArray = ndimage.gaussian_filter(blocks, BLUR_OF_BLOCKS, mode="nearest")
    return blurred


def _medians_of_blocks(
    block: IntArray, values: FloatArray, n_blocks: int
) -> tuple[FloatArray, IntArray]:
    counts = np.bincount(block, minlength=n_blocks)
    ordered = values[np.lexsort((values, block))]
    first = np.cumsum(counts) - counts
    middle = np.minimum(first + counts // 2, max(len(values) - 1, 0))
    return np.where(counts > 0, ordered[middle], 0.0), counts
