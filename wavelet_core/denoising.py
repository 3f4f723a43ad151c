"""Denoising by the average of many pyramids, weighted by an unbiased estimate of the risk."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import lsq_linear

from ._validate import FloatArray
from .analysis import EXPECTED_KEPT, analyse
from .coefficients import (
    channel_index,
    check_sigma,
    estimate_noise,
    local_energy,
    noise_gains,
)
from .errors import Cancelled, OptionError
from .mesh import TriangleMesh
from .transform import LinearStep, Transform

#: Neighbourhood (rounds of averaging over rings) and energies, in units of the noise, that tell
#: details of terrain from those of noise.
ROUNDS = 4
ENERGY_SCALES = (1.3, 2.0)
N_ELEMENTS = 1 + len(ENERGY_SCALES)
#: Local energies at which the change of the details is bounded: none, noise and a half, all.
PROBED_ENERGIES = (0.0, 1.6, np.inf)
LEAST_CHANGE, MOST_CHANGE = -1.0, 0.1
#: Levels that share their weights: single ones gain 0.3 % and take twice as long.
LEVELS_PER_BAND = 2
#: Vertices on which the weights are fitted; more do not change them.
MAX_FITTED = 250_000
#: A pyramid for denoising stops where its mesh would be smaller than this.
LEAST_VERTICES = 100
#: Step of the numerical derivative, in standard deviations of the noise.
PROBE_STEP = 0.01
#: Vertices times probes for the derivative to be accurate enough.
PROBED_VERTICES = 100_000
#: Ridge of the weights, relative to the mean energy of a column: it pulls towards no change.
RIDGE = 1e-7

Progress = Callable[[float], bool | None]


def denoise(
    mesh: TriangleMesh,
    sigma: float | None = None,
    *,
    n_pyramids: int = 32,
    levels: int = 14,
    prediction: str = "plane",
    channels: Sequence[str] = ("z",),
    locked: ArrayLike | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> TriangleMesh:
    r"""Return the mesh with the noise taken out of its elevations or attributes.

    Parameters
    ----------
    mesh : TriangleMesh
        A TIN; its x and y stay as they are.
    sigma : float, optional
        Standard deviation of the noise, in the unit of the channel; by default estimated.
    n_pyramids : int
        Number of pyramids, each from another random order of removal.
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

    Returns
    -------
    TriangleMesh

    Raises
    ------
    OptionError
        An unknown channel, a negative sigma, no pyramid.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    Every pyramid sees the terrain through other triangles, so that their average shows none of
    them; for images this is known as cycle spinning. The details d of each level enter as they
    are and damped in two ways, :math:`d \exp(-(E / T)^2)`, where E is the local energy in units
    of the noise that reaches each coefficient (:func:`wavelet_core.coefficients.noise_gains`).
    The result is the input plus the weighted sum of these columns F whose expected squared
    error, by Stein's unbiased estimate, is least: :math:`M b = -\sigma^2 \operatorname{div} F`
    with :math:`M = F^T F`, within bounds that neither turn a detail over nor boost it by more than
    a tenth. No clean surface and no threshold is needed, and noise of zero gives
    back the input. The estimate holds for white normal noise; M is taken from the average of all
    pyramids, which is what makes the weights fit the average rather than a single one.

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
        raise OptionError(f"n_pyramids is {n_pyramids}; give 1 or more.")
    if levels < 1:
        raise OptionError(f"levels is {levels}; give 1 or more.")
    names = ("z", *mesh.attribute_names)
    chosen = [channel_index(names, name) for name in channels]
    columns = np.column_stack([mesh.vertices[:, 2], mesh.attributes])
    deviations = [
        estimate_noise(mesh, columns[:, c]) if sigma is None else float(sigma) for c in chosen
    ]
    weighted = [
        _WeightedSum(columns[:, c], deviation, _depth(mesh.n_vertices, levels), seed)
        for c, deviation in zip(chosen, deviations, strict=True)
        if deviation > 0
    ]
    fits_in_one = mesh.n_vertices <= MAX_FITTED
    for is_fit in (True,) if fits_in_one else (True, False):
        for k in range(n_pyramids):
            _report(progress, (k / n_pyramids + (not is_fit)) / (1 if fits_in_one else 2))
            transform = _transform(mesh, levels, prediction, locked, seed * 1_000_003 + k)
            gains = noise_gains(transform, seed=seed)
            for one in weighted:
                if is_fit:
                    one.fit(transform, gains, 1.0 / n_pyramids)
                else:
                    one.add(transform, gains, 1.0 / n_pyramids)
        if is_fit:
            for one in weighted:
                one.solve(fits_in_one)
    _report(progress, 1.0)
    changed = [c for c, deviation in zip(chosen, deviations, strict=True) if deviation > 0]
    for c, one in zip(changed, weighted, strict=True):
        columns[:, c] = one.result
    return TriangleMesh._trusted(
        np.column_stack([mesh.vertices[:, :2], columns[:, 0]]),
        mesh.faces,
        columns[:, 1:].copy(),
        mesh.attribute_names,
    )


class _WeightedSum:
    """One column, and the sum of its damped details that has the least estimated risk.

    Parameters
    ----------
    values : ndarray, shape (n_vertices,)
    sigma : float
        Standard deviation of the noise, above 0.
    levels : int
        The most levels that a transform will have.
    seed : int
    """

    def __init__(self, values: FloatArray, sigma: float, levels: int, seed: int) -> None:
        generator = np.random.default_rng(seed)
        n = len(values)
        self._values = values - values.mean()
        self._sigma = sigma
        n_probes = max(1, min(8, PROBED_VERTICES // n))
        self._generator, self._n_probes = generator, n_probes
        self._rows = (
            slice(None) if n <= MAX_FITTED else np.sort(generator.permutation(n)[:MAX_FITTED])
        )
        n_columns = -(-levels // LEVELS_PER_BAND) * N_ELEMENTS
        self._columns = np.zeros((min(n, MAX_FITTED), n_columns))
        self._divergence = np.zeros(n_columns)
        self._weights = np.zeros(n_columns)
        self.result = values.copy()

    def fit(self, transform: Transform, gains: list[FloatArray], share: float) -> None:
        """Take in the columns of one transform, and their divergence along the probes."""
        step_size = PROBE_STEP * self._sigma
        shape = (len(self._values), self._n_probes)
        probes = self._generator.choice([-1.0, 1.0], size=shape)
        shifted = self._values[:, None] + step_size * probes
        details = transform.analyse(np.column_stack([self._values, shifted]))[1]
        damped = [
            _damped(step, detail, self._sigma * gain)
            for step, detail, gain in zip(transform.steps, details, gains, strict=True)
        ]
        for first in range(0, len(damped), LEVELS_PER_BAND):  # counted from the finest
            levels = range(len(damped) - 1 - first, len(damped) - 1 - first - LEVELS_PER_BAND, -1)
            band = transform.synthesise_bands(
                {k: damped[k].reshape(len(damped[k]), -1) for k in levels if k >= 0}
            ).reshape(*probes.shape[:1], 1 + self._n_probes, N_ELEMENTS)
            where = _block(first)
            self._columns[:, where] += share * band[self._rows, 0]
            change = band[:, 1:] - band[:, :1]
            slope = np.einsum("vp,vpk->k", probes, change) / self._n_probes
            self._divergence[where] += share * slope / step_size

    def solve(self, finish: bool) -> None:
        """Find the weights; with ``finish`` the fitted columns cover all vertices: sum them.

        A level's details are multiplied by 1 + b_0 + b_1 exp(...) + ..., a function of their
        local energy. Its values at as many energies are the unknowns here, so that they can be
        kept between dropping and slightly boosting: a sigma that is far too large would
        otherwise turn details over.
        """
        share = len(self._columns) / len(self._values)
        to_weights = np.kron(
            np.eye(len(self._weights) // N_ELEMENTS), np.linalg.inv(_multipliers(PROBED_ENERGIES))
        )
        moments = to_weights.T @ (self._columns.T @ self._columns) @ to_weights
        pull = -(self._sigma**2) * share * (to_weights.T @ self._divergence)
        size = np.sqrt(np.where(np.diag(moments) > 0, np.diag(moments), 1.0))
        root = np.linalg.cholesky(moments / np.outer(size, size) + RIDGE * np.eye(len(size)))
        target = np.linalg.solve(root, pull / size)
        bounds = (LEAST_CHANGE * size, MOST_CHANGE * size)
        self._weights = to_weights @ (lsq_linear(root.T, target, bounds, method="bvls").x / size)
        if finish:
            self.result += self._columns @ self._weights

    def add(self, transform: Transform, gains: list[FloatArray], share: float) -> None:
        """Add the weighted columns of one transform to the result."""
        details = transform.analyse(self._values[:, None])[1]
        sums = {}
        for level, (step, gain) in enumerate(zip(transform.steps, gains, strict=True)):
            damped = _damped(step, details[level], self._sigma * gain)[:, 0]
            sums[level] = damped @ self._weights[_block(len(gains) - 1 - level)][:, None]
        if sums:
            self.result += share * transform.synthesise_bands(sums)[:, 0]


def _damped(step: LinearStep, details: FloatArray, noise: FloatArray) -> FloatArray:
    """Return ``(n_odd, k, N_ELEMENTS)``: each column as it is and damped where it is weak."""
    energy = local_energy(step, (details / noise[:, None]) ** 2, ROUNDS)
    damped = [details * np.exp(-((energy / scale) ** 2)) for scale in ENERGY_SCALES]
    return np.stack([details, *damped], axis=2)


def _multipliers(energies: Sequence[float]) -> FloatArray:
    """Return what each element contributes at some local energies, ``(n, N_ELEMENTS)``."""
    ratio = np.divide.outer(np.asarray(energies), np.asarray(ENERGY_SCALES))
    return np.column_stack([np.ones(len(ratio)), np.exp(-(ratio**2))])


def _block(levels_above: int) -> slice:
    """Return the columns of a level, by its distance from the finest: so all transforms agree."""
    first = levels_above // LEVELS_PER_BAND * N_ELEMENTS
    return slice(first, first + N_ELEMENTS)


def _depth(n_vertices: int, levels: int) -> int:
    """Return how many levels leave enough vertices."""
    most = int(np.log(max(n_vertices / LEAST_VERTICES, 1.0)) / -np.log(EXPECTED_KEPT))
    return max(min(levels, most), 1)


def _transform(
    mesh: TriangleMesh, levels: int, prediction: str, locked: ArrayLike | None, seed: int
) -> Transform:
    """Return the transform of a random pyramid that knows x and y only."""
    flat = np.column_stack([mesh.vertices[:, :2], np.zeros(mesh.n_vertices)])
    plan = TriangleMesh._trusted(flat, mesh.faces, np.empty((mesh.n_vertices, 0)), ())
    pyramid = analyse(
        plan,
        levels=_depth(mesh.n_vertices, levels),
        partition="random",
        prediction=prediction,
        update="minimum_norm",
        locked=locked,
        seed=seed,
    )
    return Transform.from_pyramid(pyramid)


def _report(progress: Progress | None, fraction: float) -> None:
    if progress is not None and progress(fraction) is False:
        raise Cancelled("denoising was cancelled; nothing was kept.")
