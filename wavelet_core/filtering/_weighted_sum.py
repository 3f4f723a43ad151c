"""The sum of a column's damped details that has the least risk, by Stein's unbiased estimate."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray
from ..lifting.linear_map import LinearStep, Transform
from ._bounded import least_within, moments_of
from ._guided import LEAST_FOR_GUIDED, Moved, edge_kept
from .noise.model import Noise
from .noise.white import local_energy
from .undecimated import Rings, UndecimatedBank


class Damping(NamedTuple):
    r"""Local energies, in units of the noise, that separate details of terrain from those of noise.

    A detail may be changed by a function of its local energy, a weighted sum of 1 and of
    :math:`\exp(-(E / T)^2)` with T each of ``scales``. Such a function is given by its values at
    as many energies ``probed``: none, noise and a half, all.
    """

    scales: tuple[float, ...]
    probed: tuple[float, ...]

    @property
    def n_elements(self) -> int:
        return 1 + len(self.scales)

    def parts(self, details: FloatArray, energy: FloatArray) -> FloatArray:
        """Return ``(..., n_elements)``: details times the function that is 1 at one probed energy.

        They add up to the details. Where all energies are alike, as on a plane, the functions of
        the others are zero to rounding, which a sum of 1 and exponentials would leave to the
        solver as columns that are the same but for their last digits.
        """
        damping = [np.ones(energy.shape)]
        with np.errstate(over="ignore"):  # the energy of a rock in units of a noise of nothing
            damping += [np.exp(-((energy / scale) ** 2)) for scale in self.scales]
        weights = self._weights_of_changes()
        return details[..., None] * np.einsum("...d,de->...e", np.stack(damping, axis=-1), weights)

    def _weights_of_changes(self) -> FloatArray:
        """Return the weights of the elements for a change of 1 at each probed energy alone."""
        ratio = np.divide.outer(np.asarray(self.probed), np.asarray(self.scales))
        return np.linalg.inv(np.column_stack([np.ones(len(ratio)), np.exp(-(ratio**2))]))


OF_PYRAMIDS = Damping((1.3, 2.0), (0.0, 1.6, np.inf))
OF_VERTICES = Damping((1.5, 4.0), (0.0, 2.2, np.inf))
#: Rounds of averaging over rings that a local energy is taken over, for a detail of a pyramid
#: and for one of a vertex at the finest scale; that of coarser ones is wider. On
#: crops of two DEMs half of them and twice as many change the error by less than 0.1 %.
PYRAMID_ROUNDS, VERTEX_ROUNDS = 4, 3
#: Details are at most dropped, and at most boosted by half.
LEAST_CHANGE, MOST_CHANGE = -1.0, 0.5
#: How much of the change the pyramids may make, the details of all vertices the rest.
SHARES_OF_PYRAMIDS = (0.0, 0.25, 0.5, 0.75, 1.0)
#: Levels that share their weights: single ones gain 0.3 % and take twice as long.
LEVELS_PER_BAND = 2
#: Vertices on which the weights are fitted; more do not change them. 5,000 of 8,100 leave 0.1 %
#: more error on crops of two DEMs.
MAX_FITTED = 100_000
#: Step of the numerical derivative, in standard deviations of the noise; half of it and twice as
#: much give the same error to four digits.
PROBE_STEP = 0.01
#: Vertices times probes for the derivative to be accurate enough, for an average of pyramids and
#: where each vertex has one detail a scale only.
PROBED_BY_PYRAMIDS, PROBED_BY_VERTICES = 100_000, 600_000
MOST_PROBES = 8
#: Ridge of the weights, relative to the mean energy of a column: it pulls towards no change.
#: A hundredth of it and a hundred times as much give the same error to four digits.
RIDGE = 1e-7
#: How much of what keeps edges is taken where the noise differs by place, of which the estimates
#: are rough. All of it leaves 7 % less error on a cloud and up to 4 % more on DEMs, half 6 % less
#: and up to 1.5 % more, on twelve windows.
SHARE_BY_PLACE = 0.5
#: Columns smaller than this part of the values are rounding.
ROUNDING = 1e-13


class WeightedSum:
    """One column, and the sum of its damped details that has the least estimated risk.

    :meth:`fit` takes in one pyramid after the other, then :meth:`finish` the details of all
    vertices, so that neither is in memory beside the other.

    Parameters
    ----------
    values : ndarray, shape (n_vertices,)
    noise : Noise
        Its standard deviation above what rounding leaves of the values.
    n_pyramids, levels : int
        How many pyramids will be taken in, and the most levels that they have.
    seed : int
    """

    def __init__(
        self,
        values: FloatArray,
        noise: Noise,
        n_pyramids: int,
        levels: int,
        seed: int,
    ) -> None:
        generator = np.random.default_rng(seed)
        n = len(values)
        self._values = values - values.mean()
        # Noise above the whole relief smooths it all; what is more would only cost digits.
        self._sigma = min(noise.sigma, float(np.ptp(values)))
        self.noise = noise
        self._generator = generator
        self._share = 1.0 / n_pyramids
        self._rows = (
            slice(None) if n <= MAX_FITTED else np.sort(generator.permutation(n)[:MAX_FITTED])
        )
        n_bands = -(-levels // LEVELS_PER_BAND)
        self._of_pyramids = np.zeros((n, n_bands * OF_PYRAMIDS.n_elements))
        # How all columns change along one probe, for what is then guided by their sum. What
        # rounding leaves is alike in flat neighbours: no guide helps there.
        n_guiding = 1 if n >= LEAST_FOR_GUIDED and noise.rounding.step == 0.0 else 0
        self._guiding = noise.probes(np.random.default_rng((seed, 1)), (n, n_guiding))
        self._changes_of_pyramids = np.zeros(
            (n_guiding, *self._of_pyramids.shape), dtype=np.float32
        )
        self._divergence = np.zeros(self._of_pyramids.shape[1])
        self.values, self.result = values, values.copy()

    def fit(self, transform: Transform, gains: list[FloatArray]) -> None:
        """Take in the details of one pyramid, and their divergence."""
        probes = self._probes(PROBED_BY_PYRAMIDS)
        shifted = self._shifted(np.column_stack([self._guiding, probes]))
        details = transform.analyse(shifted)[1]
        damped = [
            _damped(step, detail, self._sigma * gain, transform.tick)
            for step, detail, gain in zip(transform.steps, details, gains, strict=True)
        ]
        for first in range(0, len(damped), LEVELS_PER_BAND):  # counted from the finest
            levels = range(len(damped) - 1 - first, len(damped) - 1 - first - LEVELS_PER_BAND, -1)
            band = transform.synthesise_bands(
                {k: damped[k].reshape(len(damped[k]), -1) for k in levels if k >= 0}
            )
            where, band = _block(first), band.reshape(*shifted.shape, OF_PYRAMIDS.n_elements)
            self._of_pyramids[:, where] += self._share * band[:, 0]
            self._changes_of_pyramids[..., where] += self._share * self._guiding_changes(band)
            self._divergence[where] += self._share * self._slope(band, probes)

    def finish(self, bank: UndecimatedBank, is_fixed: NDArray[np.bool_]) -> None:
        """Take in the details of all vertices, find the weights, and sum.

        Parameters
        ----------
        bank : UndecimatedBank
            Measured with noise of this kind.
        is_fixed : ndarray of bool, shape (n_vertices,)
            Vertices that have no details in the bank.
        """
        column, changes = self._summed(bank)
        del self._of_pyramids, self._changes_of_pyramids
        for probe, change in zip(self._guiding.T, changes, strict=True):  # one, or none
            relative = np.ones(1) if self.noise.relative is None else self.noise.relative
            kept = edge_kept(
                Rings(bank.averaging.indptr, bank.averaging.indices),
                Moved(self._values, probe),
                Moved(column, change),
                self._sigma * relative,
                is_fixed,
                bank.tick,
            )
            column += (1.0 if self.noise.relative is None else SHARE_BY_PLACE) * (kept - column)
        self.result += column - self._values

    def _summed(self, bank: UndecimatedBank) -> tuple[FloatArray, FloatArray]:
        """Return the weighted sum, and its changes along what guides, ``(0 or 1, n_vertices)``."""
        n_of_pyramids, n_rows = self._of_pyramids.shape[1], min(len(self._values), MAX_FITTED)
        n_columns = n_of_pyramids + bank.n_scales * bank.n_parts * OF_VERTICES.n_elements
        columns, divergence = np.empty((n_rows, n_columns)), np.zeros(n_columns)
        columns[:, :n_of_pyramids] = self._of_pyramids[self._rows]
        divergence[:n_of_pyramids] = self._divergence
        probes = self._probes(PROBED_BY_VERTICES)
        shifted = self._shifted(probes)
        for where, damped in self._damped_by_vertices(bank, shifted):
            columns[:, where] = damped[self._rows, 0]
            divergence[where] = self._slope(damped, probes)
        del shifted
        weights = self._weights(columns, divergence, bank.tick)
        del columns
        of_pyramids = weights[:n_of_pyramids]
        column = self._values + np.einsum("vk,k->v", self._of_pyramids, of_pyramids)
        changes = self._guiding.T + np.einsum("gvk,k->gv", self._changes_of_pyramids, of_pyramids)
        for where, damped in self._damped_by_vertices(bank, self._shifted(self._guiding)):
            column += np.einsum("vk,k->v", damped[:, 0], weights[where])
            changes += np.einsum("gvk,k->gv", self._guiding_changes(damped), weights[where])
        return column, changes

    def _weights(
        self, columns: FloatArray, divergence: FloatArray, tick: Callable[[], None]
    ) -> FloatArray:
        """Return the weight of each column.

        Details are multiplied by 1 + a function of their local energy. Its values at the probed
        energies are the unknowns here, so that they can be kept between dropping and boosting: a
        sigma that is far too large would otherwise turn details over. Pyramids and vertices both
        hold all details, so they share the bounds. Columns of nothing but rounding, those of a
        plane or of energies that no detail has, take no part.
        """
        share = len(columns) / len(self._values)
        moments = moments_of(columns, tick)
        pull = -(self._sigma**2) * share * divergence
        size = np.sqrt(np.diag(moments))
        floor = ROUNDING * max(float(np.sqrt(np.sum(self._values**2))), ROUNDING * size.max())
        holds = size > floor
        weights = np.zeros(len(size))
        if holds.any():
            weights[holds] = self._changes(
                moments[np.ix_(holds, holds)],
                pull[holds],
                size[holds],
                np.flatnonzero(holds) < self._of_pyramids.shape[1],
            )
        return weights

    def _changes(
        self,
        moments: FloatArray,
        pull: FloatArray,
        size: FloatArray,
        is_of_pyramids: NDArray[np.bool_],
    ) -> FloatArray:
        """Return the least of ``b' M b / 2 - pull b`` within the bounds."""
        scaled = moments / (size[:, None] * size) + RIDGE * np.eye(len(size))
        least, changes = np.inf, np.zeros(len(size))
        for share_of_pyramids in SHARES_OF_PYRAMIDS:
            room = np.where(is_of_pyramids, share_of_pyramids, 1.0 - share_of_pyramids) * size
            is_open = room > 0
            if not is_open.any():
                continue
            found, cost = least_within(
                scaled[np.ix_(is_open, is_open)],
                (pull / size)[is_open],
                LEAST_CHANGE * room[is_open],
                MOST_CHANGE * room[is_open],
            )
            if cost < least:
                least, changes = cost, np.zeros(len(size))
                changes[is_open] = found
        return changes / size

    def _probes(self, n_wanted: int) -> FloatArray:
        """Return new random probes, so that the errors of what they probe are independent."""
        n = len(self._values)
        return self.noise.probes(self._generator, (n, max(1, min(MOST_PROBES, n_wanted // n))))

    def _shifted(self, probes: FloatArray) -> FloatArray:
        """Return the column, and itself moved a little along each probe."""
        moved = self._values[:, None] + PROBE_STEP * self._sigma * probes
        return np.column_stack([self._values, moved])

    def _slope(self, damped: FloatArray, probes: FloatArray) -> FloatArray:
        """Return the divergence of columns: ``damped[:, 0]``, the last are the probes'."""
        n_probes = probes.shape[1]
        change = damped[:, -n_probes:] - damped[:, :1]
        slope = np.einsum("vp,vpk->k", probes, change) / n_probes
        slope /= PROBE_STEP * self._sigma
        return slope

    def _guiding_changes(self, damped: FloatArray) -> FloatArray:
        """Return how columns ``(n_vertices, k)`` change along what guides, which is the next."""
        n_guiding = self._guiding.shape[1]
        change = damped[:, 1 : 1 + n_guiding] - damped[:, :1]
        change /= PROBE_STEP * self._sigma
        return np.moveaxis(change, 1, 0)

    def _damped_by_vertices(
        self, bank: UndecimatedBank, columns: FloatArray
    ) -> Iterator[tuple[slice, FloatArray]]:
        """Yield where the weights of each part are, and its ``(n_vertices, k, n_elements)``."""
        first = self._of_pyramids.shape[1]
        for scale, details in enumerate(bank.details(columns)):
            for part, one in enumerate(details):
                noise = self._sigma * bank.noise[scale][:, part].astype(np.float64)
                energy = bank.local_energy((one / noise[:, None]) ** 2, VERTEX_ROUNDS + scale)
                end = first + OF_VERTICES.n_elements
                yield slice(first, end), OF_VERTICES.parts(one, energy)
                first = end


def _damped(
    step: LinearStep, details: FloatArray, noise: FloatArray, tick: Callable[[], None]
) -> FloatArray:
    """Return ``(n_odd, k, n_elements)``: each column in parts by its local energy."""
    energy = local_energy(step, (details / noise[:, None]) ** 2, PYRAMID_ROUNDS, tick)
    return OF_PYRAMIDS.parts(details, energy)


def _block(levels_above: int) -> slice:
    """Return the columns of a level, by its distance from the finest: so all transforms agree."""
    first = levels_above // LEVELS_PER_BAND * OF_PYRAMIDS.n_elements
    return slice(first, first + OF_PYRAMIDS.n_elements)
