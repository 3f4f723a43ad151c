"""What is known of a channel's noise: its strength by place, reach, outliers, rounding, stripes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from ..._validate import FloatArray, IntArray
from ...errors import OptionError
from ...mesh.triangle_mesh import TriangleMesh
from ..undecimated import N_DIRECTIONS, ROUNDS_OF_SCALE, UndecimatedBank, n_ticks
from .by_place import map_of_noise
from .by_scale import (
    N_SCALES,
    ROUNDS_OF_ENERGY,
    deviations_by_scale,
    estimated_ranges,
    where_relief_ends,
)
from .outliers import without_outliers
from .rounding import NO_ROUNDING, Rounding
from .stripes import Stripes, stripes_of
from .white import check_sigma, correlated_noise, noise_columns

#: Where the deviation in the flattest places is less than these parts of that in the flatter half,
#: of white noise and of correlated, relief as fine as the mesh was taken for noise.
STEADY_WHITE, STEADY_CORRELATED = 0.9, 0.8
#: With fewer vertices than this, relief cannot be separated from noise.
LEAST_VERTICES = 2_000
#: How often values are taken apart to find white noise, for the progress.
TIMES_APART = 5

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
    rounding : Rounding
        What rounding has left of the values.
    plan : ndarray, shape (n_vertices, 2), or None
        Where the noise is, if it is correlated.
    n_standing_out : int
        Values that would be outliers, had they been asked for; they are still there.
    stripes : Stripes or None
        Offsets of lines, which were taken out before; None where no lines were given.
    is_rough : bool
        Whether relief as fine as the mesh cannot be separated from noise: the deviation is then
        that of the flattest places, and noise of unknown range is taken for white.
    """

    sigma: float
    relative: FloatArray | None = None
    reach: float = 0.0
    outliers: IntArray | None = None
    rounding: Rounding = NO_ROUNDING
    plan: FloatArray | None = None
    n_standing_out: int = 0
    stripes: Stripes | None = None
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
        >>> Noise(0.25, reach=3.0, outliers=np.arange(4), rounding=Rounding(1.0)).describe()
        '0.25, correlated over 3, values rounded to 1, 4 outliers replaced'
        """
        words = [f"{self.sigma:.4g}"]
        if self.relative is not None:
            low, high = np.quantile(self.relative, [0.05, 0.95]) * self.sigma
            words.append(f"from {low:.3g} to {high:.3g} by place")
        if self.reach > 0:
            words.append(f"correlated over {self.reach:.3g}")
        if self.rounding.step > 0:
            words.append(f"values rounded to {self.rounding.step:.6g}")
        if self.outliers is not None:
            one = self.n_outliers == 1
            words.append(f"{self.n_outliers:,} outlier{'' if one else 's'} replaced")
        if self.stripes is not None:
            words.append(self.stripes.describe())
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
    lines: IntArray | None = None,
    seed: int = 0,
    tick: Callable[[], None] = lambda: None,
) -> tuple[Noise, FloatArray]:
    """Return the noise of a column, and the column without offsets of lines and outliers.

    Parameters
    ----------
    mesh : TriangleMesh
    values : ndarray, shape (n_vertices,)
    sigma : float, optional
        Standard deviation of the noise; by default estimated, and no less than what rounding to
        the step of the values takes. Where the flattest places hold less than
        others, relief as fine as the mesh is among it, and those decide.
    noise_range : float or "estimate"
        Distance at which the correlation of the noise has fallen to 1/e; 0 for white noise.
    local_noise : bool
        Whether the deviation differs by place and is to be found there.
    outliers : bool
        Whether to look for outliers.
    lines : ndarray of int64, shape (n_vertices,), optional
        The line of each vertex, -1 for none, whose offsets are to be found.
    seed : int
    tick : callable
        Called now and then; it may raise, to stop.

    Raises
    ------
    OptionError
        A negative sigma or range.
    """
    check_sigma(sigma)
    _check_range(noise_range)
    n_vertices = mesh.n_vertices
    white = noise_columns(n_vertices, seed)[:, :4]
    bank, stripes = None, None
    if lines is not None and len(mesh.faces):
        bank = UndecimatedBank.from_mesh(mesh, N_SCALES + 1, white, tick=tick)
        stripes = stripes_of(bank, mesh.vertices[:, :2], values, lines)
        if stripes.deviation > 0:
            values = values - stripes.of_vertices(lines)
    rounding = Rounding.of(mesh, values) if sigma is None else NO_ROUNDING
    noise, values = _plain_noise(mesh, values, sigma, rounding, outliers, tick)
    noise = replace(noise, stripes=stripes)
    is_known = sigma is not None or n_vertices < LEAST_VERTICES
    is_plain = noise_range == 0.0 and not local_noise
    if (is_plain and is_known) or not len(mesh.faces) or np.ptp(values) == 0:
        return noise, values
    if bank is None:
        bank = UndecimatedBank.from_mesh(mesh, N_SCALES + 1, white, tick=tick)
    plan = mesh.vertices[:, :2] - mesh.vertices[:, :2].min(axis=0)
    column = _Column(bank, plan, values, rounding, seed)
    if noise_range == "estimate":
        noise_range, better = estimated_ranges(bank, plan, values, seed)
        if n_vertices >= LEAST_VERTICES and _is_relief_as_fine(column, noise, noise_range):
            noise_range, noise = 0.0, replace(noise, is_rough=True)
        elif noise_range > 0 and not _is_relief_as_fine(column, noise, better):
            noise_range = better
    if noise_range > 0:
        noise = _correlated(column, noise, noise_range, sigma)
    elif not is_known and not local_noise:
        noise = _without_relief(column, noise, white)
    if local_noise:
        noise = _by_place(column, noise, sigma)
    return noise, values


def ticks_of_noise(n_vertices: int, is_given: bool) -> int:
    """Return how often `noise_of` ticks, about, to find the kind of noise, or its deviation too."""
    n_scales = N_SCALES + 1
    if is_given:
        return n_ticks(n_vertices, n_scales)
    of_details = sum(ROUNDS_OF_SCALE[:n_scales]) + N_DIRECTIONS * n_scales + ROUNDS_OF_ENERGY
    return n_ticks(n_vertices, n_scales) + TIMES_APART * of_details


def _check_range(noise_range: RangeOption) -> None:
    if noise_range != "estimate" and not (np.isfinite(noise_range) and noise_range >= 0):
        raise OptionError(
            "{0} is {given}; give a distance of 0 or more, or 'estimate'.",
            "noise_range",
            given=repr(noise_range),
        )


def _plain_noise(
    mesh: TriangleMesh,
    values: FloatArray,
    sigma: float | None,
    rounding: Rounding,
    outliers: bool,
    tick: Callable[[], None],
) -> tuple[Noise, FloatArray]:
    """Return the noise as if it were white and the same everywhere, and the values it is in."""
    standing_out, without = without_outliers(mesh, values, sigma, rounding, tick)
    tick()
    values = without if outliers else values
    noise = Noise(
        rounding.deviation(mesh, values) if sigma is None else float(sigma),
        outliers=standing_out if outliers else None,
        rounding=rounding,
        n_standing_out=0 if outliers else len(standing_out),
    )
    return noise, values


class _Column(NamedTuple):
    """Values whose noise is looked for, what their details are taken by, and where they are."""

    bank: UndecimatedBank
    plan: FloatArray
    values: FloatArray
    rounding: Rounding
    seed: int

    def deviations(self, noise: Noise) -> tuple[FloatArray, FloatArray]:
        """Return the deviations, by scale, that noise of this kind would have here."""
        alike = noise.columns(len(self.values), self.seed)
        return deviations_by_scale(self.bank, self.values, alike[:, 0])


def _is_relief_as_fine(column: _Column, noise: Noise, noise_range: float) -> bool:
    """Whether relief was taken for noise of a range: in the flattest places there is less of it."""
    half, flattest = column.deviations(replace(noise, reach=float(noise_range), plan=column.plan))
    return bool(np.median(flattest) < STEADY_CORRELATED * np.median(half))


def _correlated(column: _Column, noise: Noise, noise_range: float, sigma: float | None) -> Noise:
    noise = replace(noise, reach=float(noise_range), plan=column.plan)
    if sigma is not None:
        return noise
    half, flattest = column.deviations(noise)
    deviation = min(float(np.median(half)), float(flattest.min()))
    return replace(noise, sigma=max(deviation, column.rounding.least))


def _without_relief(column: _Column, noise: Noise, white: FloatArray) -> Noise:
    """Return white noise of a deviation that leaves out relief as fine as the mesh."""
    if noise.sigma < column.rounding.step:  # flat places are terraces, which have less of any noise
        return noise
    half, flattest = deviations_by_scale(column.bank, column.values, white[:, 0])
    is_rough = noise.is_rough or bool(flattest[0] < STEADY_WHITE * half[0])
    ending = where_relief_ends(column.bank, column.values, white)
    if not (is_rough or ending < STEADY_WHITE * noise.sigma):
        return noise
    deviation = max(min(ending, noise.sigma), column.rounding.least)
    return replace(noise, sigma=deviation, is_rough=is_rough)


def _by_place(column: _Column, noise: Noise, sigma: float | None) -> Noise:
    alike = noise.columns(len(column.values), column.seed)[:, :4]
    local = map_of_noise(column.bank, column.plan, column.values, alike)
    if local is None:
        return noise
    typical = float(np.median(local))
    return replace(
        noise,
        sigma=max(typical, column.rounding.least) if sigma is None else noise.sigma,
        relative=local / typical,
    )
