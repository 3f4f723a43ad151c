"""Noise separated from relief, by how its details fall off over the scales and in flat places."""

from __future__ import annotations

import numpy as np

from ..._validate import FloatArray
from ..undecimated import UndecimatedBank
from .white import NORMAL_MAD, correlated_noise

#: Scales by which noise is compared, and the share of the vertices, the flatter ones, whose details
#: count.
N_SCALES, SHARE_FLATTER = 3, 0.5
#: Rounds of averaging over rings that the energy of the coarsest details is taken over.
ROUNDS_OF_ENERGY = 8
#: The share of the vertices that are the flattest places: noise of one deviation is the same there.
SHARE_FLATTEST = 0.05
#: Share of the vertices, the flatter ones, that show how the finest details grow with relief.
SHARE_SLOPED = 0.6
#: Powers of the coarser energy with which they may do so.
POWERS_OF_RELIEF = (0.5, 0.75, 1.0)
#: Correlation lengths that are tried, in mean distances of neighbours.
TRIED_RANGES = (0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.5, 8.0)
#: White parts of the variance that are tried beside correlated noise. With noise of 3 cells on
#: twelve windows, lengths of 1.5 to 2.5 that were found without them become 2.5 or 3.
WHITE_SHARES = (0.003, 0.01)


def deviations_by_scale(
    bank: UndecimatedBank, values: FloatArray, alike: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the deviation of the noise by each scale, in the flatter half and where flattest.

    ``alike`` is a column of noise of deviation 1 that the noise of ``values`` is compared with.
    """
    half, flattest = (
        _robust_deviations(bank, values, share) / _robust_deviations(bank, alike, share)
        for share in (SHARE_FLATTER, SHARE_FLATTEST)
    )
    return half, flattest


def _robust_deviations(
    bank: UndecimatedBank, column: FloatArray, share: float = SHARE_FLATTER
) -> FloatArray:
    """Return the robust deviation of details of each scale, where the next scale is flattest.

    The flattest places are also those where the noise happens to be weak; the noise that this is
    compared with goes the same way.
    """
    details = [
        sum(parts[1:], start=parts[0])[:, 0]
        for parts in bank.details((column - column.mean())[:, None])
    ]
    energy = bank.local_energy(details[-1] ** 2, ROUNDS_OF_ENERGY)
    flat = energy <= np.quantile(energy, share)
    deviations = np.array([np.median(np.abs(one[flat])) / NORMAL_MAD for one in details[:N_SCALES]])
    return np.maximum(deviations, 1e-300)


def where_relief_ends(bank: UndecimatedBank, values: FloatArray, white: FloatArray) -> float:
    """Return the deviation of white noise that the finest details tend to as relief goes to zero.

    The squares of the finest details, in shares of the vertices by their relief at a coarser scale,
    grow with a power of that energy: with the energy itself where the same relief is higher in one
    place than in another, with its root where relief is the rougher the finer one looks. That of
    a few powers which fits the flatter shares best is followed down from the flattest one; where
    that is flat, there is nowhere to go.
    """
    both = np.column_stack([values - values.mean(), white])
    finest, coarser = np.empty(0), np.empty(0)
    for scale, parts in enumerate(bank.details(both)):
        if scale in (0, N_SCALES):
            together = sum(parts[1:], start=parts[0])
            finest, coarser = (np.abs(together), coarser) if scale == 0 else (finest, together)
    energy = bank.local_energy(coarser[:, 0] ** 2, ROUNDS_OF_ENERGY)
    order = np.argsort(energy, kind="stable")
    shares = np.array_split(order, round(1 / SHARE_FLATTEST))[
        : round(SHARE_SLOPED / SHARE_FLATTEST)
    ]
    coarse = np.array([energy[share].mean() for share in shares])
    squares = np.array(
        [np.median(finest[share, 0]) ** 2 / np.median(finest[share, 1:]) ** 2 for share in shares]
    )
    weights = 1.0 / np.maximum(squares, 1e-6 * max(float(squares.max()), 1e-300)) ** 2
    weights /= weights.sum()
    rest = squares - np.sum(weights * squares)
    least, found = np.inf, float(squares[0])
    for power in POWERS_OF_RELIEF:
        relief = (coarse / max(float(coarse.mean()), 1e-300)) ** power
        apart = relief - np.sum(weights * relief)
        spread = float(np.sum(weights * apart**2))
        slope = max(float(np.sum(weights * apart * rest)) / spread, 0.0) if spread > 0 else 0.0
        misfit = float(np.sum(weights * (rest - slope * apart) ** 2))
        if misfit < least:
            least, found = misfit, float(squares[0] - slope * relief[0])
    return float(np.sqrt(max(found, squares[0] / 4.0)))


def estimated_ranges(
    bank: UndecimatedBank, plan: FloatArray, values: FloatArray, seed: int
) -> tuple[float, float]:
    """Return the correlation length whose details fall off over the scales as those found do.

    Twice: of correlated noise alone, and with a little white noise beside it. Correlated noise has
    so little of the finest details that a hundredth of its variance in white noise, or in relief as
    fine, shows in them, and makes the length shorter than it is.
    """
    found = _robust_deviations(bank, values)
    spacing = float(np.sqrt(np.ptp(plan, axis=0).prod() / max(len(plan), 1)))
    generator = np.random.default_rng(seed)
    white = _robust_deviations(bank, generator.standard_normal(len(plan)))
    alone = {0.0: float(np.var(np.log(found / white)))}
    beside = dict(alone)
    for tried in TRIED_RANGES[1:]:
        column = correlated_noise(plan, tried * spacing, 1, generator)[:, 0]
        deviations = _robust_deviations(bank, column)
        alone[tried] = float(np.var(np.log(found / deviations)))
        beside[tried] = min(
            float(np.var(np.log(found / np.hypot(deviations, np.sqrt(share) * white))))
            for share in (0.0, *WHITE_SHARES)
        )
    first, second = (min(misfits, key=misfits.__getitem__) for misfits in (alone, beside))
    return first * spacing, second * spacing
