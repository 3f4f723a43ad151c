"""The step to which values were rounded, the noise of it, and the terraces that it leaves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import ndtr

from ..._validate import FloatArray
from ...mesh.triangle_mesh import TriangleMesh
from ..undecimated import Rings, UndecimatedBank, rings
from .white import estimate_noise

#: Least share of the values that rounding to a step must make alike for the step to be believed.
LEAST_ALIKE = 0.5
#: Rounding to a step leaves a deviation of step / sqrt(12), but neighbours are alike in it, so that
#: a filter for white noise must take more than its square out: step / sqrt(6) on wide terraces.
#: On slopes, where the share of edges across a step is more than the last of these numbers,
#: neighbours are not alike. With 8 there (and 0.25 and 0.4) the error is 1.7 % higher on the
#: average of 19 cases on 13 windows of five DEMs, :func:`without_terraces` included: from 7 % lower
#: to 7 % higher.
ROUNDED_TERRACES, ROUNDED_SLOPES, SHARES_BETWEEN = 6.0, 12.0, (0.2, 0.4)
#: Peaks and pits of one vertex, over the share of edges across a step, below which all noise is
#: that of rounding, which makes none.
FEWEST_SPIKES = 0.015
#: Rounds of averaging over rings, after the ring itself, in which the share of edges across a step
#: is counted; with 6 the error is 1 % more.
ROUNDS_OF_SHARE = 20
#: The share of edges across a step at which half of the result is that without terraces, and how
#: sharply it changes there. 0.35 leaves 3 % more error: rounding is white noise there.
SHARE_OF_TERRACES, SHARPNESS = 0.25, 8.0
#: Peaks and pits of one vertex, over the share of edges across a step, at which other noise breaks
#: terraces up, and how sharply.
SHARE_OF_SPIKES, SHARPNESS_OF_SPIKES = 0.2, 4.0
#: Deviation, in steps, of the terrain from its smooth surface that terraces are filled with; 0.05
#: and 0.2 leave 1 and 20 % more error.
DEVIATION_IN_TERRACES = 0.1
#: Rounds in which terraces are filled.
FILL_ROUNDS = 40
#: Standard deviations, of noise beside that of rounding, within which the terrain is.
WITHIN_DEVIATIONS = 3.0


def rounding_step(values: FloatArray) -> float:
    """Return the step to which values were rounded; 0 where they were not, or finely.

    Examples
    --------
    >>> x = np.linspace(0, 50, 2000)
    >>> rounding_step(np.round(x * 2) / 2 + 0.1), rounding_step(x)
    (0.5, 0.0)
    """
    levels = np.unique(np.round(values, 9))
    if len(levels) < 3 or len(levels) > LEAST_ALIKE * len(values):
        return 0.0
    steps = np.diff(levels)
    step = float(np.median(steps[steps < 1.5 * steps.min()]))
    whole = np.diff(levels) / step
    # Steps of a unit that was converted are whole to the digits of the conversion only.
    return step if np.abs(whole - np.rint(whole)).max() < 1e-3 * max(whole.max(), 1.0) else 0.0


class Rounding(NamedTuple):
    """What rounding has left of a column.

    Attributes
    ----------
    step : float
        0 where the values were not rounded.
    least : float
        Deviation of white noise that takes out the noise of rounding.
    is_alone : bool
        Whether there is no other noise.
    """

    step: float = 0.0
    least: float = 0.0
    is_alone: bool = False

    @classmethod
    def of(cls, mesh: TriangleMesh, values: FloatArray) -> Rounding:
        """Return the rounding of a column of a mesh."""
        step = rounding_step(values)
        if step == 0.0:
            return cls()
        crossed, spikes = (
            float(one.mean()) for one in _crossed_and_spikes(rings(mesh), values, step)
        )
        rounded = float(np.interp(crossed, SHARES_BETWEEN, (ROUNDED_TERRACES, ROUNDED_SLOPES)))
        return cls(step, step / np.sqrt(rounded), spikes < FEWEST_SPIKES * crossed)

    def deviation(self, mesh: TriangleMesh, values: FloatArray, seed: int = 0) -> float:
        """Return the deviation of white noise; no less than what rounding takes.

        The details of rounded values are multiples of a part of the step, and so is their median.
        Noise of the width of a step, put onto them and out of the estimate again, makes it
        continuous.
        """
        if self.is_alone:
            return self.least
        if self.step == 0.0:
            return estimate_noise(mesh, values)
        dither = self.step * (np.random.default_rng(seed).random(len(values)) - 0.5)
        found = estimate_noise(mesh, values + dither)
        return max(float(np.sqrt(max(found**2 - self.step**2 / 12.0, 0.0))), self.least)


#: That of values which were not rounded.
NO_ROUNDING = Rounding()


def without_terraces(
    bank: UndecimatedBank,
    rounded: FloatArray,
    smooth: FloatArray,
    rounding: Rounding,
    sigma: FloatArray | float,
    is_fixed: np.ndarray,
) -> FloatArray:
    r"""Return a denoised column, filled where rounding left terraces and kept within its steps.

    Parameters
    ----------
    bank : UndecimatedBank
        Whose smoother fills the terraces.
    rounded, smooth : ndarray, shape (n_vertices,)
        The values before and after denoising.
    rounding : Rounding
        With a step.
    sigma : float or ndarray, shape (n_vertices,)
        Standard deviation of all noise.
    is_fixed : ndarray of bool, shape (n_vertices,)
        Vertices whose smooth values stay.

    Notes
    -----
    A rounded value says that the terrain is within half a step of it: grouped data. Their most
    likely smooth surface is found by taking turns: the expected terrain, normal about the surface
    but within the step, then the surface smoothed from that. It is taken where few edges cross
    a step; elsewhere, rounding is white noise, which denoising has taken out better. In the end,
    nothing is further from its value than half a step and three deviations of the noise that is
    left when that of rounding is taken off.

    References
    ----------
    A. P. Dempster, N. M. Laird, D. B. Rubin: Maximum likelihood from incomplete data via the EM
    algorithm. Journal of the Royal Statistical Society B 39, 1977.
    """
    quantum = rounding.step
    crossed, spikes = _crossed_and_spikes(
        Rings(bank.averaging.indptr, bank.averaging.indices), rounded, quantum
    )
    shares = bank.local_energy(np.column_stack([crossed, spikes]), ROUNDS_OF_SHARE)
    is_terrace = _falling(shares[:, 0], SHARE_OF_TERRACES, SHARPNESS)
    is_unbroken = _falling(
        shares[:, 1] / np.maximum(shares[:, 0], 1e-12), SHARE_OF_SPIKES, SHARPNESS_OF_SPIKES
    )
    rest = np.sqrt(np.maximum(np.square(sigma) - rounding.least**2, 0.0))
    half = 0.5 * quantum + WITHIN_DEVIATIONS * rest + quantum * (1.0 - is_unbroken)
    weight = np.where(is_fixed, 0.0, is_terrace * is_unbroken)
    filled = smooth
    for _ in range(FILL_ROUNDS):
        expected = _expected_within(filled, rounded, half, DEVIATION_IN_TERRACES * quantum)
        filled = (1.0 - weight) * smooth + weight * (bank.smoother @ expected)
        bank.tick()
    within = np.clip(filled, rounded - half, rounded + half)
    return np.where(is_fixed, smooth, within)


def _falling(share: FloatArray, middle: float, sharpness: float) -> FloatArray:
    """Return weights that fall from 1 to 0 about the middle."""
    weight: FloatArray = 1.0 / (1.0 + (share / middle) ** sharpness)
    return weight


def _crossed_and_spikes(
    around: Rings, rounded: FloatArray, quantum: float
) -> tuple[FloatArray, FloatArray]:
    """Return, of the edges of each vertex, the share across a step, and 1 where all go one way."""
    counts, rows = np.diff(around.indptr), around.rows
    rise = rounded[around.indices] - rounded[rows]
    n_edges = np.maximum(counts - 1, 1)
    up, down = (
        np.bincount(rows, crosses, len(counts)) / n_edges
        for crosses in (rise > 0.5 * quantum, rise < -0.5 * quantum)
    )
    return up + down, np.maximum(up, down) >= 1.0


def _expected_within(
    mean: FloatArray, centre: FloatArray, half: FloatArray | float, deviation: float
) -> FloatArray:
    """Return the mean of normal distributions, cut off at half to either side of the centres."""
    low, high = (centre - half - mean) / deviation, (centre + half - mean) / deviation
    share = ndtr(high) - ndtr(low)
    density = (np.exp(-0.5 * low**2) - np.exp(-0.5 * high**2)) / np.sqrt(2.0 * np.pi)
    # Far outside nothing of the distribution is left; the nearer end is then the mean.
    is_there = share > 1e-9
    inside = np.where(is_there, mean + deviation * density / np.where(is_there, share, 1.0), mean)
    return np.clip(inside, centre - half, centre + half)
