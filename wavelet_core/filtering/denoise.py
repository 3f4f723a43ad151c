"""Denoising: details of many scales and directions, weighted by an estimate of the risk."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._kernels._jit import current_engine
from .._validate import FloatArray, as_locked
from ..errors import OptionError
from ..lifting.analyse import EXPECTED_KEPT, analyse
from ..lifting.linear_map import Transform
from ..lifting.pyramid import Pyramid
from ..mesh.triangle_mesh import TriangleMesh
from ..progress import Meter, Progress, report
from . import _guided, _weighted_sum
from ._bounded import ticks_of_moments
from ._weighted_sum import ROUNDING, VERTEX_ROUNDS, WeightedSum
from .gains import channel_index
from .noise.model import Noise, RangeOption, noise_of, ticks_of_noise
from .noise.outliers import EXPECTED_PASSES, ROWS_OF_RANKS
from .noise.rounding import FILL_ROUNDS, ROUNDS_OF_SHARE, without_terraces
from .noise.stripes import NO_LINE, STEPS_OF_STRIPES, check_lines
from .noise.white import check_sigma, noise_columns, noise_gains
from .undecimated import UndecimatedBank, n_ticks

#: Scales of the details of all vertices for a level of a pyramid: they reach as far. On crops of
#: two DEMs half as many leave 0 to 1.3 % more error, and twice as many the same in twice the time.
SCALES_PER_LEVEL = 0.5
#: Pyramids that are averaged. Of 54 cases (six terrains, nine kinds of noise) eight leave 0.1 %
#: less error on the average, 1.5 % at most, in half as much time again; two leave 0.1 % more.
N_PYRAMIDS = 4
#: A pyramid for denoising stops where its mesh would be smaller than this.
LEAST_VERTICES = 100
#: For the progress: the share of what goes before the pyramids, where the noise is known and where
#: it is to be found; that of the analysis in a pyramid; the time that the details of all vertices
#: take, in pyramids of the engine, and the share in it of making their filters.
BEFORE_PYRAMIDS, TO_FIND_NOISE, OF_ANALYSIS, OF_BANK = 0.03, 0.2, 0.85, 0.5
TIME_OF_VERTICES = {"compiled": 4.0, "arrays": 0.7, "loops": 3.2}


def denoise(
    mesh: TriangleMesh,
    sigma: float | None = None,
    *,
    n_pyramids: int = N_PYRAMIDS,
    levels: int = 14,
    prediction: str = "plane",
    channels: Sequence[str] = ("z",),
    locked: ArrayLike | None = None,
    seed: int = 0,
    progress: Progress | None = None,
    noise_range: RangeOption = 0.0,
    local_noise: bool = False,
    outliers: bool = False,
    lines: ArrayLike | None = None,
    found: dict[str, Noise] | None = None,
) -> TriangleMesh:
    r"""Return the mesh with the noise taken out of its elevations or attributes.

    Parameters
    ----------
    mesh : TriangleMesh
        A TIN; its x and y stay as they are. Cells of a grid and scattered points will both do.
    sigma : float, optional
        Standard deviation of the noise, in the unit of the channel; by default estimated.
    n_pyramids : int
        Number of pyramids, each from another random order of removal. More help little on a
        grid, some percent where points are scattered unevenly, and take their time.
    levels : int
        The most levels of a pyramid. A feature that spans many more vertices than
        ``1.15 ** levels`` is left alone.
    prediction : str
        As for :func:`wavelet_core.analyse`; it should look at x and y only.
    channels : sequence of str
        Which columns to change: ``"z"`` and names of attributes.
    locked : array_like of bool, shape (n_vertices,), optional
        Vertices whose values are exact and stay.
    seed : int
        The same seed gives the same result.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.
    noise_range : float or "estimate"
        Distance at which the correlation of the noise has fallen to 1/e, in the unit of x and y;
        0 for white noise. An estimate takes relief that is as fine as the mesh for noise.
    local_noise : bool
        Whether the noise differs by place, as on slopes that a laser scanner saw; it is then
        measured there, and ``sigma`` is its median.
    outliers : bool
        Replace values that stand out of their ring before all else.
    lines : array_like of int, shape (n_vertices,), optional
        A label for each vertex, such as its row, its scan line or its flight line, and -1 for none:
        values have an offset for each line, which is found and taken out before all else. Lines of
        fewer than 8 vertices keep theirs.
    found : dict, optional
        Is given the :class:`~wavelet_core.filtering.noise.model.Noise` of each channel: what was
        estimated, the outliers, and the offsets of lines.

    Returns
    -------
    TriangleMesh

    Raises
    ------
    OptionError
        An unknown channel, a negative sigma or range, no pyramid, labels that are none.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    The surface is taken apart in two ways. Pyramids in random order see it through other
    triangles each, so that their average shows none of them; for images this is known as cycle
    spinning. :class:`~wavelet_core.filtering.undecimated.UndecimatedBank` gives each vertex a
    detail at every scale, split by direction, since along a ridge or a bank there is less noise to
    be mistaken for terrain. The details d of either enter as they are and damped in two ways,
    :math:`d \exp(-(E / T)^2)`, where E is the local energy in units of the noise that reaches each
    detail (`wavelet_core.filtering.noise.white.noise_gains`). The result is the input plus the
    weighted sum of these columns F whose expected squared error, by Stein's unbiased estimate,
    is least: :math:`M b = -\sigma^2 \operatorname{div} F` with :math:`M = F^T F`, within bounds
    that neither turn a detail over nor boost it by more than a half, to be shared by the two ways.
    No clean surface and no threshold is needed, and noise of zero gives back the input. The
    estimate holds for normal noise: with a covariance C that is not white, :math:`\sigma^2
    \operatorname{div} F` gives way to :math:`\operatorname{tr}(C\, \partial F)`, probed by columns
    of such noise. M is taken from the average of all pyramids, which is what makes the weights fit
    the average rather than a single one. From 10,000 vertices on, averages that keep the edges of
    this sum are then added to it likewise (`wavelet_core.filtering._guided.edge_kept`), but not
    where values were rounded.

    References
    ----------
    F. Luisier, T. Blu, M. Unser: A new SURE approach to image denoising: interscale orthonormal
    wavelet thresholding. IEEE Transactions on Image Processing 16, 2007.
    R. R. Coifman, D. L. Donoho: Translation-invariant de-noising. Wavelets and Statistics, 1995.
    S. Ramani, T. Blu, M. Unser: Monte-Carlo SURE. IEEE Transactions on Image Processing 17, 2008.

    Examples
    --------
    >>> import numpy as np
    >>> from wavelet_core import TriangleMesh, denoise
    >>> x = np.arange(50.0)
    >>> noise = np.random.default_rng(0).normal(0, 0.2, (50, 50))
    >>> noisy = TriangleMesh.from_grid(np.sin(x / 9) + noise, x=x, y=x)
    >>> clean = denoise(noisy, sigma=0.2, n_pyramids=4)
    >>> truth = np.tile(np.sin(x / 9), 50)
    >>> float(np.std(clean.vertices[:, 2] - truth)) < 0.06
    True
    """
    check_sigma(sigma)
    if n_pyramids < 1:
        raise OptionError("{0} is {given}; give 1 or more.", "n_pyramids", given=n_pyramids)
    if levels < 1:
        raise OptionError("{0} is {given}; give 1 or more.", "levels", given=levels)
    names = ("z", *mesh.attribute_names)
    chosen = {name: channel_index(names, name) for name in channels}
    is_locked = as_locked(locked, mesh.n_vertices)
    line = None
    if lines is not None:  # values that stay are on none
        line = np.where(is_locked, NO_LINE, check_lines(lines, mesh.n_vertices))
    columns = np.column_stack([mesh.vertices[:, 2], mesh.attributes])
    meter = Meter(progress, "denoising was cancelled; nothing was kept.")
    n_steps = EXPECTED_PASSES * (1 + mesh.n_vertices // ROWS_OF_RANKS)
    n_steps += 0 if line is None else STEPS_OF_STRIPES
    before = BEFORE_PYRAMIDS
    if sigma is None or noise_range != 0.0 or local_noise:
        before = TO_FIND_NOISE
        n_steps += ticks_of_noise(mesh.n_vertices, sigma is not None)
    meter.begin(0.0, before, n_steps * len(chosen))
    noises = {}
    for name, c in chosen.items():
        given = columns[:, c].copy()
        noise, columns[:, c] = noise_of(
            mesh,
            given,
            sigma,
            noise_range=noise_range,
            local_noise=local_noise,
            outliers=outliers,
            lines=line,
            seed=seed,
            tick=meter.tick,
        )
        if noise.outliers is not None:
            columns[is_locked, c] = given[is_locked]
            noise = replace(noise, outliers=noise.outliers[~is_locked[noise.outliers]])
        noises[name] = noise
        meter.tick()
    if found is not None:
        found.update(noises)
    noisy = [name for name, c in chosen.items() if _is_above_rounding(noises[name], columns[:, c])]
    if noisy and len(mesh.faces):
        decompositions = _Decompositions(
            mesh, n_pyramids, levels, prediction, is_locked, seed, meter
        )
        weighted = [
            decompositions.weighted_sum(columns[:, chosen[name]], noises[name]) for name in noisy
        ]
        decompositions.run(weighted, before)
        for name, one in zip(noisy, weighted, strict=True):
            columns[:, chosen[name]] = one.result
    report(progress, 1.0, "denoising was cancelled; nothing was kept.")
    return TriangleMesh._trusted(
        np.column_stack([mesh.vertices[:, :2], columns[:, 0]]),
        mesh.faces,
        columns[:, 1:].copy(),
        mesh.attribute_names,
    )


def _is_above_rounding(noise: Noise, values: FloatArray) -> bool:
    spread = float(np.ptp(values)) if len(values) else 0.0
    return noise.sigma > ROUNDING * spread and spread > ROUNDING * float(np.abs(values).max())


class _Decompositions:
    """What takes the mesh apart by scale: pyramids in random order, and all vertices at once."""

    def __init__(
        self,
        mesh: TriangleMesh,
        n_pyramids: int,
        levels: int,
        prediction: str,
        locked: NDArray[np.bool_],
        seed: int,
        meter: Meter,
    ) -> None:
        self._mesh, self._prediction, self._locked, self._seed = mesh, prediction, locked, seed
        self._n_pyramids = n_pyramids
        self._levels = _depth(mesh.n_vertices, levels)
        self._meter = meter

    def weighted_sum(self, values: FloatArray, noise: Noise) -> WeightedSum:
        """Return the sum of a column's details, whose weights are yet to be fitted."""
        return WeightedSum(values, noise, self._n_pyramids, self._levels, self._seed)

    def run(self, weighted: Sequence[WeightedSum], begin: float) -> None:
        """Fit the weights of every column and sum; ``begin`` is the share of the work before."""
        of_vertices = TIME_OF_VERTICES[current_engine()]
        span = (1.0 - begin) / (self._n_pyramids + of_vertices)
        for k in range(self._n_pyramids):
            start, stop = begin + k * span, begin + (k + 1) * span
            self._meter.begin(start, start + OF_ANALYSIS * span, 1)
            pyramid = self._analysed(self._seed * 1_000_003 + k)
            n_steps = (4 + 9 * len(weighted)) * self._levels
            self._meter.begin(start + OF_ANALYSIS * span, stop, n_steps)
            self._take_in(Transform.from_pyramid(pyramid, self._meter.tick), weighted)
            del pyramid
        self._finish(weighted, 1.0 - of_vertices * span)

    def _take_in(self, transform: Transform, weighted: Sequence[WeightedSum]) -> None:
        """Fit one pyramid to every column."""
        for one in weighted:
            one.fit(transform, self._gains(transform, one.noise))

    def _finish(self, weighted: Sequence[WeightedSum], start: float) -> None:
        """Take in the details of all vertices."""
        n, meter = self._mesh.n_vertices, self._meter
        n_scales = max(round(SCALES_PER_LEVEL * self._levels), 1)
        middle = start + OF_BANK * (1.0 - start)
        meter.begin(start, middle, n_ticks(n, n_scales))
        plain = UndecimatedBank.from_mesh(
            self._mesh, n_scales, noise_columns(n, self._seed), self._locked, meter.tick
        )
        rounds = sum(VERTEX_ROUNDS + k for k in range(plain.n_scales)) * plain.n_parts
        rounds += 2 ** (plain.n_scales - 1)
        n_blocks = ticks_of_moments(min(n, _weighted_sum.MAX_FITTED))
        n_steps = len(weighted) * (2 * rounds + n_blocks + _guided.n_ticks(n))
        n_steps += sum(FILL_ROUNDS + ROUNDS_OF_SHARE for w in weighted if w.noise.rounding.step > 0)
        meter.begin(middle, 0.999, n_steps)
        for one in weighted:
            bank = plain
            if not one.noise.is_plain:
                bank = plain.for_noise(one.noise.columns(n, self._seed))
            one.finish(bank, self._locked)
            if one.noise.rounding.step > 0:
                self._fill_terraces(bank, one)

    def _fill_terraces(self, bank: UndecimatedBank, one: WeightedSum) -> None:
        """Take out of a result what rounding left, but where values are no rounded ones."""
        is_fixed = self._locked.copy()
        if one.noise.outliers is not None:
            is_fixed[one.noise.outliers] = True
        sigma = one.noise.sigma * (1.0 if one.noise.relative is None else one.noise.relative)
        one.result = without_terraces(
            bank, one.values, one.result, one.noise.rounding, sigma, is_fixed
        )

    def _gains(self, transform: Transform, noise: Noise) -> list[FloatArray]:
        """Return how noise reaches the details of a pyramid."""
        if noise.is_plain:
            return noise_gains(transform, seed=self._seed)
        columns = noise.columns(self._mesh.n_vertices, self._seed)
        return noise_gains(transform, columns=columns, relative=noise.relative)

    def _analysed(self, seed: int) -> Pyramid:
        """Return a random pyramid that knows x and y only."""
        mesh = self._mesh
        flat = np.column_stack([mesh.vertices[:, :2], np.zeros(mesh.n_vertices)])
        plan = TriangleMesh._trusted(flat, mesh.faces, np.empty((mesh.n_vertices, 0)), ())
        return analyse(
            plan,
            levels=self._levels,
            partition="random",
            prediction=self._prediction,
            update="minimum_norm",
            locked=self._locked,
            seed=seed,
            progress=self._meter.part,
        )


def _depth(n_vertices: int, levels: int) -> int:
    """Return how many levels leave enough vertices."""
    most = int(np.log(max(n_vertices / LEAST_VERTICES, 1.0)) / -np.log(EXPECTED_KEPT))
    return max(min(levels, most), 1)
