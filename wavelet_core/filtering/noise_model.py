"""What is known of the noise of a channel: its strength by place, its reach, outliers, rounding."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy import ndimage

from .._validate import FloatArray, IntArray
from ..errors import OptionError
from ..mesh.triangle_mesh import TriangleMesh
from .noise import NORMAL_MAD, check_sigma, estimate_noise, noise_columns
from .undecimated import UndecimatedBank, rings

#: Least share of the values that rounding to a step must make alike for the step to be believed.
LEAST_ALIKE = 0.5
#: Rounding to a step leaves a deviation of step / sqrt(12), but what it leaves is alike along a
#: terrace, and a filter for white noise must take twice its square to take it out. Measured on four
#: DEMs rounded in 18 ways: never worse than step / sqrt(12), and up to a third of its error.
ROUNDED = 6.0
#: An outlier is so many standard deviations of the noise, plus so many times the relief of its
#: ring, above the second highest of its neighbours or below the second lowest.
OUTLIER_DEVIATIONS, OUTLIER_RELIEF, OUTLIER_RELIEF_OF_OUTLINE = 5.0, 1.0, 4.0
#: Looks for outliers: each sees those that others stood beside.
OUTLIER_PASSES = 5
#: Vertices whose neighbours are put in order at once.
ROWS_OF_RANKS = 50_000
#: Vertices of fewer neighbours, at corners, are none.
LEAST_NEIGHBOURS = 4
#: Rounds in which an outlier is filled from its neighbours.
FILL_ROUNDS = 20
#: Vertices of a block of the map that tell the noise there, the width of the blur over blocks,
#: and what the blurred deviation of white noise varies by, times the root of that number.
VERTICES_OF_BLOCK, BLUR_OF_BLOCKS, DEVIATION_OF_BLOCK = 25, 0.5, 0.9
#: Correlation lengths that are tried, in mean distances of neighbours.
TRIED_RANGES = (0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.5, 8.0)
#: Share of the vertices, the flatter ones, that tell how the finest details grow with relief.
SHARE_SLOPED = 0.6
#: Powers of the coarser energy with which they may do so.
POWERS_OF_RELIEF = (0.5, 0.75, 1.0)
#: Scales by which they are told, and the share of the vertices, the flattest, that tell.
N_TOLD, SHARE_TOLD = 3, 0.5
#: Noise of one deviation is the same in the flattest places, this share of the vertices, as in the
#: flatter half; where it is less than these parts of it, of white noise and of correlated, relief
#: as fine as the mesh was taken for noise. Fewer vertices than that do not tell.
SHARE_FLATTEST, STEADY_WHITE, STEADY_CORRELATED, LEAST_TOLD = 0.05, 0.9, 0.8, 2_000

RangeOption = float | Literal["estimate"]


@dataclass(frozen=True, slots=True)
class Noise:
    """The noise of one channel, as it was given or found.

    Attributes
    ----------
    sigma : float
        Standard deviation, in the channel's unit; the median one where it differs by place.
    relative : ndarray, shape (n_vertices,), or None
        Deviation at each vertex over sigma; None where it is the same everywhere.
    reach : float
        Distance at which the correlation of the noise has fallen to 1/e, in the unit of x and y;
        0 for white noise.
    outliers : ndarray of int64, shape (n_outliers,)
        Vertices whose values are no part of the terrain; they are replaced before.
    quantum : float
        Step to which the values were rounded; 0 where none was found.
    plan : ndarray, shape (n_vertices, 2), or None
        Where the noise is, if it is correlated.
    n_standing_out : int
        Values that would be outliers, had they been asked for; they are still there.
    is_rough : bool
        Whether relief as fine as the mesh cannot be told from noise: the deviation is then that of
        the flattest places, and noise of unknown range is taken for white.
    """

    sigma: float
    relative: FloatArray | None = None
    reach: float = 0.0
    outliers: IntArray | None = None
    quantum: float = 0.0
    plan: FloatArray | None = None
    n_standing_out: int = 0
    is_rough: bool = False

    @property
    def is_plain(self) -> bool:
        """Whether it is white and the same everywhere."""
        return self.relative is None and self.plan is None

    @property
    def n_outliers(self) -> int:
        """How many outliers there are."""
        return 0 if self.outliers is None else len(self.outliers)

    def columns(self, n_vertices: int, seed: int) -> FloatArray:
        """Return columns of noise of this kind with sigma 1, ``(n_vertices, k)``."""
        white = noise_columns(n_vertices, seed)
        if self.is_plain:
            return white
        return self._shaped(white.shape, np.random.default_rng(seed + 1), white)

    def probes(self, generator: np.random.Generator, shape: tuple[int, int]) -> FloatArray:
        """Return columns with the covariance of this noise, sigma being 1, to probe a filter."""
        signs = generator.choice([-1.0, 1.0], size=shape)
        return signs if self.is_plain else self._shaped(shape, generator, signs)

    def describe(self) -> str:
        """Return what was given or found, in words.

        Examples
        --------
        >>> Noise(0.25, reach=3.0, outliers=np.arange(4), quantum=1.0).describe()
        '0.25, correlated over 3, values rounded to 1, 4 outliers replaced'
        """
        words = [f"{self.sigma:.4g}"]
        if self.relative is not None:
            low, high = np.quantile(self.relative, [0.05, 0.95]) * self.sigma
            words.append(f"from {low:.3g} to {high:.3g} by place")
        if self.reach > 0:
            words.append(f"correlated over {self.reach:.3g}")
        if self.quantum > 0:
            words.append(f"values rounded to {self.quantum:.6g}")
        if self.outliers is not None:
            one = self.n_outliers == 1
            words.append(f"{self.n_outliers:,} outlier{'' if one else 's'} replaced")
        return ", ".join(words)

    def _shaped(
        self, shape: tuple[int, int], generator: np.random.Generator, white: FloatArray
    ) -> FloatArray:
        columns = white
        if self.plan is not None and self.reach > 0:
            columns = correlated_noise(self.plan, self.reach, shape[1], generator)
        return columns if self.relative is None else columns * self.relative[:, None]


def noise_of(
    mesh: TriangleMesh,
    values: FloatArray,
    sigma: float | None = None,
    *,
    noise_range: RangeOption = 0.0,
    local_noise: bool = False,
    outliers: bool = False,
    seed: int = 0,
    tick: Callable[[], None] = lambda: None,
) -> tuple[Noise, FloatArray]:
    """Return the noise of a column, and the column with its outliers replaced.

    Parameters
    ----------
    mesh : TriangleMesh
    values : ndarray, shape (n_vertices,)
    sigma : float, optional
        Standard deviation of the noise; by default estimated, and no less than what rounding to
        the step of the values takes, step / sqrt(6). Where the flattest places hold less than
        others, relief as fine as the mesh is among it, and those tell.
    noise_range : float or "estimate"
        Distance at which the correlation of the noise has fallen to 1/e; 0 for white noise.
    local_noise : bool
        Whether the deviation differs by place and is to be found there.
    outliers : bool
        Whether to look for outliers.
    seed : int
    tick : callable
        Called now and then; it may raise, to stop.

    Raises
    ------
    OptionError
        A negative sigma or range.
    """
    check_sigma(sigma)
    if noise_range != "estimate" and not (np.isfinite(noise_range) and noise_range >= 0):
        raise OptionError(
            "{0} is {given}; give a distance of 0 or more, or 'estimate'.",
            "noise_range",
            given=repr(noise_range),
        )
    quantum = 0.0
    if sigma is None:
        quantum = rounding_step(values)
    standing_out, without = without_outliers(mesh, values, sigma, quantum, tick)
    tick()
    found = standing_out if outliers else None
    values = without if outliers else values
    noise = Noise(
        _floored(estimate_noise(mesh, values), quantum) if sigma is None else float(sigma),
        outliers=found,
        quantum=quantum,
        n_standing_out=0 if outliers else len(standing_out),
    )
    is_told = sigma is not None or mesh.n_vertices < LEAST_TOLD
    is_plain = noise_range == 0.0 and not local_noise
    if (is_plain and is_told) or not len(mesh.faces) or np.ptp(values) == 0:
        return noise, values
    bank = UndecimatedBank.from_mesh(
        mesh, N_TOLD + 1, noise_columns(mesh.n_vertices, seed)[:, :4], tick=tick
    )
    plan = mesh.vertices[:, :2] - mesh.vertices[:, :2].min(axis=0)
    if noise_range == "estimate":
        noise_range = _told_range(bank, plan, values, seed)
        alike = replace(noise, reach=float(noise_range), plan=plan).columns(mesh.n_vertices, seed)
        half, flattest = _deviations(bank, values, alike[:, 0])
        is_rough = bool(np.median(flattest) < STEADY_CORRELATED * np.median(half))
        if is_rough and mesh.n_vertices >= LEAST_TOLD:
            noise_range = 0.0
            noise = replace(noise, is_rough=True)
    if noise_range > 0:
        noise = replace(noise, reach=float(noise_range), plan=plan)
        if sigma is None:
            alike = noise.columns(mesh.n_vertices, seed)
            half = _deviations(bank, values, alike[:, 0])[0]
            noise = replace(noise, sigma=_floored(float(np.median(half)), quantum))
    elif not is_told and not local_noise:
        white = noise_columns(mesh.n_vertices, seed)[:, :4]
        half, flattest = _deviations(bank, values, white[:, 0])
        is_rough = noise.is_rough or bool(flattest[0] < STEADY_WHITE * half[0])
        ending = _where_relief_ends(bank, values, white)
        if is_rough or ending < STEADY_WHITE * noise.sigma:
            deviation = _floored(min(ending, noise.sigma), quantum)
            noise = replace(noise, sigma=deviation, is_rough=is_rough)
    if local_noise:
        local = _map_of_noise(bank, plan, values, noise, seed)
        if local is not None:
            typical = float(np.median(local))
            noise = replace(
                noise,
                sigma=_floored(typical, quantum) if sigma is None else noise.sigma,
                relative=local / typical,
            )
    return noise, values


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


def without_outliers(
    mesh: TriangleMesh,
    values: FloatArray,
    sigma: float | None = None,
    quantum: float = 0.0,
    tick: Callable[[], None] = lambda: None,
) -> tuple[IntArray, FloatArray]:
    """Return the vertices that stand out of their rings, and the values with those filled.

    Parameters
    ----------
    mesh : TriangleMesh
    values : ndarray, shape (n_vertices,)
    sigma : float, optional
        Standard deviation of the noise; by default estimated.
    quantum : float
        Step to which the values were rounded.
    tick : callable
        Called now and then; it may raise, to stop.

    Notes
    -----
    An outlier is above the second highest of its neighbours, or below the second lowest, by more
    than 5 sigma and the relief of the ring between those two; at an outline, where all neighbours
    may lie downhill, above the highest by four times the relief. So a bank, a crest or a summit is
    none, nor is one of two outliers side by side a reason to keep the other.
    """
    n = mesh.n_vertices
    if n == 0 or not len(mesh.faces):
        return np.empty(0, np.int64), values
    around = rings(mesh, tick)
    keeps = around.rows != around.indices
    row, column = around.rows[keeps], around.indices[keeps]
    del around, keeps
    tick()
    deviation = _floored(estimate_noise(mesh, values), quantum) if sigma is None else sigma
    # At an outline all neighbours may lie downhill.
    is_inside = np.bincount(row, minlength=n) == np.bincount(mesh.faces.ravel(), minlength=n)
    tick()
    relief_counts = np.where(is_inside, OUTLIER_RELIEF, OUTLIER_RELIEF_OF_OUTLINE)
    rank = np.where(is_inside, 2, 1)
    is_out = np.zeros(n, dtype=bool)
    for _ in range(OUTLIER_PASSES):
        good = ~is_out[column]
        lowest, highest = _low_and_high(row[good], values[column[good]], rank, tick)
        known = np.isfinite(highest) & np.isfinite(lowest)
        relief = np.where(known, np.maximum(highest - lowest, 0.0), np.inf)
        excess = np.maximum(values - highest, lowest - values)
        least = OUTLIER_DEVIATIONS * deviation + relief_counts * relief
        new = known & ~is_out & (excess > least)
        if not new.any():
            break
        is_out |= new
    found = np.flatnonzero(is_out)
    return found, _filled(row, column, values, is_out) if len(found) else values


def correlated_noise(
    plan: FloatArray, reach: float, n_columns: int, generator: np.random.Generator
) -> FloatArray:
    """Return columns of noise of deviation 1 whose correlation has fallen to 1/e at ``reach``.

    White noise on a grid in plan, blurred by a Gaussian and read off at the vertices: its
    correlation falls as ``exp(-(distance / reach)^2)`` on any mesh.
    """
    width = reach / 2.0
    extent = np.ptp(plan, axis=0)
    cell = max(width / 1.5, float(np.sqrt(extent.prod() / (8.0 * len(plan)))), extent.max() / 3e4)
    at = (plan - plan.min(axis=0)).T / cell
    shape = tuple((np.ceil(extent / cell) + 2).astype(int))
    columns = np.empty((len(plan), n_columns))
    for k in range(n_columns):
        field = ndimage.gaussian_filter(
            generator.standard_normal(shape), width / cell, mode="reflect", truncate=4.0
        )
        columns[:, k] = ndimage.map_coordinates(field, at, order=1, mode="nearest")
        columns[:, k] /= max(float(columns[:, k].std()), 1e-300)
    return columns


def _floored(sigma: float, quantum: float) -> float:
    return max(sigma, quantum / np.sqrt(ROUNDED))


def _low_and_high(
    row: IntArray, values: FloatArray, rank: IntArray, tick: Callable[[], None]
) -> tuple[FloatArray, FloatArray]:
    """Return the values of a rank, 1 the outmost, from below and from above, of each row.

    Infinite, so that nothing stands out, where a row has too few.
    """
    n = len(rank)
    low, high = np.full(n, np.inf), np.full(n, -np.inf)
    counts = np.bincount(row, minlength=n)
    ends = np.concatenate([[0], np.cumsum(counts)])
    for first in range(0, n, ROWS_OF_RANKS):
        here = np.arange(first, min(first + ROWS_OF_RANKS, n))
        part = slice(int(ends[first]), int(ends[here[-1] + 1]))
        in_order = values[part][np.lexsort((values[part], row[part]))]
        here = here[counts[here] >= LEAST_NEIGHBOURS]
        low[here] = in_order[ends[here] - part.start + rank[here] - 1]
        high[here] = in_order[ends[here + 1] - part.start - rank[here]]
        tick()
    return low, high


def _filled(row: IntArray, column: IntArray, values: FloatArray, is_out: np.ndarray) -> FloatArray:
    """Return values with the outliers at the mean of their neighbours, also through others."""
    n, filled = len(values), values.copy()
    here = is_out[row]
    row, column = row[here], column[here]
    is_known = ~is_out
    for _ in range(FILL_ROUNDS):
        weight = is_known[column].astype(np.float64)
        count = np.bincount(row, weight, n)
        total = np.bincount(row, weight * filled[column], n)
        now = is_out & (count > 0)
        filled[now] = total[now] / count[now]
        is_known |= now
    return filled


def _deviations(
    bank: UndecimatedBank, values: FloatArray, alike: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the deviation of the noise by each scale, in the flatter half and where flattest.

    ``alike`` is a column of noise of deviation 1 that the noise of ``values`` is compared with.
    """
    half, flattest = (
        _told_deviations(bank, values, share) / _told_deviations(bank, alike, share)
        for share in (SHARE_TOLD, SHARE_FLATTEST)
    )
    return half, flattest


def _told_deviations(
    bank: UndecimatedBank, column: FloatArray, share: float = SHARE_TOLD
) -> FloatArray:
    """Return the robust deviation of details of each scale, where the next scale is flattest.

    The flattest places are also those where the noise happens to be weak; the noise that this is
    compared with goes the same way.
    """
    details = [
        sum(parts[1:], start=parts[0])[:, 0]
        for parts in bank.details((column - column.mean())[:, None])
    ]
    energy = bank.local_energy(details[-1] ** 2, 8)
    flat = energy <= np.quantile(energy, share)
    told = np.array([np.median(np.abs(one[flat])) / NORMAL_MAD for one in details[:N_TOLD]])
    return np.maximum(told, 1e-300)


def _where_relief_ends(bank: UndecimatedBank, values: FloatArray, white: FloatArray) -> float:
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
        if scale in (0, N_TOLD):
            together = sum(parts[1:], start=parts[0])
            finest, coarser = (np.abs(together), coarser) if scale == 0 else (finest, together)
    energy = bank.local_energy(coarser[:, 0] ** 2, 8)
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


def _told_range(bank: UndecimatedBank, plan: FloatArray, values: FloatArray, seed: int) -> float:
    """Return the correlation length whose details fall off over the scales as those found do."""
    told = _told_deviations(bank, values)
    spacing = float(np.sqrt(np.ptp(plan, axis=0).prod() / max(len(plan), 1)))
    generator = np.random.default_rng(seed)
    misfits = []
    for tried in TRIED_RANGES:
        if tried == 0.0:
            column = generator.standard_normal(len(plan))
        else:
            column = correlated_noise(plan, tried * spacing, 1, generator)[:, 0]
        misfits.append(float(np.var(np.log(told / _told_deviations(bank, column)))))
    return TRIED_RANGES[int(np.argmin(misfits))] * spacing


def _map_of_noise(
    bank: UndecimatedBank, plan: FloatArray, values: FloatArray, noise: Noise, seed: int
) -> FloatArray | None:
    """Return the deviation of the noise at each vertex; None where it is the same everywhere.

    The finest details, smoothed out twice so that hills leave nothing in them, are compared by
    their mean square in blocks of the map, what is above three times the median counting as that.
    The map is believed where it varies by more than so few would alone. Squares are smoothed, not
    logarithms, and nothing is pulled towards the middle: the estimate of the risk goes by squares,
    and a map that is even too low where the noise is strong leaves it there. Measured on ten DEMs
    with noise that grows with the slope.
    """
    both = np.column_stack([values - values.mean(), noise.columns(len(values), seed)[:, :4]])
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
    is_told = (counts >= VERTICES_OF_BLOCK / 4) & (medians > 0)
    if is_told.sum() < 4:
        return None
    limit = 3.0 * medians[block] / NORMAL_MAD
    squares = np.bincount(block, np.minimum(size, limit) ** 2, n_blocks) / np.maximum(counts, 1)
    weight = is_told.reshape(shape).astype(np.float64)
    around = np.maximum(_blurred(weight), 1e-12)
    logs = 0.5 * np.log(np.where(is_told, squares, 1.0)).reshape(shape)
    centre = float(np.median(logs[weight > 0]))
    smooth = _blurred((logs - centre) * weight) / around
    by_chance = DEVIATION_OF_BLOCK**2 / VERTICES_OF_BLOCK
    if float(np.var(smooth[weight > 0])) <= 2 * by_chance:
        return None
    apart = np.where(is_told, squares, 0.0).reshape(shape) - np.exp(2 * centre) * weight
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
