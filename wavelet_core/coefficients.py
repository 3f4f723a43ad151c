"""What may be done to detail coefficients: gains, bands, thresholds, and how noise reaches them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array, diags  # diags_array is not in SciPy 1.10

from ._validate import FloatArray, frozen
from .connectivity import BOUNDARY, INTERIOR, build_connectivity
from .errors import OptionError
from .mesh import TriangleMesh
from .prediction import Removal, predict
from .pyramid import Pyramid
from .spectrum import level_spacings
from .transform import LinearStep, Transform

Gains = Mapping[int, float | Sequence[float]]

#: Thresholds in standard deviations of the noise, for strength 1.
HARD_THRESHOLD = 3.0
SOFT_THRESHOLD = 1.5
METHODS = ("bayes", "soft", "hard")
#: The median absolute deviation of a normal distribution with standard deviation 1.
NORMAL_MAD = 0.6744897501960817
#: Columns of noise that are sent through a transform to measure what arrives at each level: few
#: for a large mesh, whose levels average over many details, more for a small one.
LEAST_NOISE_COLUMNS, MOST_NOISE_COLUMNS = 4, 64
NOISE_SAMPLES = 100_000
#: Rounds of averaging over rings that a local energy is taken over.
LOCAL_ROUNDS = 4


# -- gains and bands -----------------------------------------------------------------------------


def scaled(pyramid: Pyramid, gains: Gains, coarse: float | Sequence[float] = 1.0) -> Pyramid:
    """Return the pyramid with the details of each level multiplied: a terrain equaliser.

    Parameters
    ----------
    pyramid : Pyramid
    gains : mapping of int to float or sequence of float
        By level, one number or one for each channel; levels that are not named keep 1.
    coarse : float or sequence of float
        Gain of the coarsest level's coefficients; 0 leaves the bands alone.

    Raises
    ------
    OptionError
        A level that has no details, or gains that do not fit the channels.

    Notes
    -----
    Gains of 1 return the same coefficients to the bit. With all gains from level k up at 0 the
    result is the mesh of level k interpolated up by the prediction filters (for updates other
    than the one-ring mean, which has a term in the even coefficients).
    """
    n_channels = len(pyramid.channels)
    for level in gains:
        check_level(level, pyramid)
    factors = {level: _as_gain(gain, n_channels, level) for level, gain in gains.items()}
    steps = tuple(
        replace(step, details=frozen(step.details * factors[level])) if level in factors else step
        for level, step in enumerate(pyramid.steps)
    )
    coarse_gain = _as_gain(coarse, n_channels, "coarse")
    return pyramid.with_parts(steps=steps, coarse=frozen(pyramid.coarse * coarse_gain))


def band_gains(
    pyramid: Pyramid,
    levels: tuple[int, int] | None = None,
    lengths: tuple[float, float] | None = None,
) -> dict[int, float]:
    """Return the gains that keep a band of details and drop the others.

    Parameters
    ----------
    pyramid : Pyramid
    levels : (int, int), optional
        First and last level of the details to keep.
    lengths : (float, float), optional
        Instead, shortest and longest size on the ground, in the unit of x and y: details are
        kept if the median edge length of the mesh that they were taken from is in between, as
        :func:`wavelet_core.spectrum.level_spacings` tells it.

    Raises
    ------
    OptionError
        Both or neither given, bounds in the wrong order, or lengths that no level has details of.
    """
    if (levels is None) == (lengths is None):
        raise OptionError("a band is given by levels or by lengths on the ground; give one.")
    low, high = levels if levels is not None else lengths  # type: ignore[misc]
    if not low <= high:
        raise OptionError(f"the band runs from {low} to {high}; give the smaller bound first.")
    if levels is not None:
        for level in levels:
            check_level(level, pyramid)
        sizes: Sequence[float] = range(pyramid.n_levels)
    else:
        sizes = level_spacings(pyramid)[1:].tolist()
    gains = {level: float(low <= size <= high) for level, size in enumerate(sizes)}
    if lengths is not None and gains and not any(gains.values()):
        raise OptionError(
            f"no level has details of {low:.4g} to {high:.4g}, in the unit of x and y; they are of "
            f"{min(sizes):.4g} to {max(sizes):.4g}. Choose others, or analyse with more levels."
        )
    return gains


def check_level(level: int, pyramid: Pyramid) -> None:
    """Raise :class:`OptionError` unless the pyramid has details at the level."""
    if not 0 <= level < pyramid.n_levels:
        raise OptionError(
            f"there are no details at level {level}; they are at 0 to {pyramid.n_levels - 1}."
        )


def _as_gain(gain: float | Sequence[float], n_channels: int, level: int | str) -> FloatArray:
    array = np.asarray(gain, dtype=np.float64)
    if array.shape not in ((), (n_channels,)) or not np.isfinite(array).all():
        raise OptionError(
            f"the gain of level {level} is {gain}; give a number or one for each of "
            f"{n_channels} channels."
        )
    return array


def relifted(pyramid: Pyramid, mesh: TriangleMesh) -> Pyramid:
    """Return the pyramid of another surface over the same vertices, by the same filters.

    Parameters
    ----------
    pyramid : Pyramid
    mesh : TriangleMesh
        With the vertices of the pyramid's finest mesh in their order and the same attributes;
        with signal "z" its x and y are not looked at.

    Raises
    ------
    OptionError
        Another number of vertices, or other attributes.
    """
    n_vertices = pyramid.n_vertices(pyramid.n_levels)
    if mesh.n_vertices != n_vertices or mesh.attribute_names != pyramid.attribute_names:
        raise OptionError(
            f"the mesh has {mesh.n_vertices} vertices with attributes {mesh.attribute_names}, the "
            f"pyramid {n_vertices} with {pyramid.attribute_names}; give the same."
        )
    first = 2 if pyramid.signal == "z" else 0
    columns = np.column_stack([mesh.vertices[:, first:], mesh.attributes])
    coarse, details = Transform.from_pyramid(pyramid).analyse(columns)
    steps = tuple(
        replace(step, details=frozen(detail))
        for step, detail in zip(pyramid.steps, details, strict=True)
    )
    return pyramid.with_parts(coarse=frozen(coarse), steps=steps)


# -- noise ---------------------------------------------------------------------------------------


def estimate_noise(mesh: TriangleMesh, values: ArrayLike | None = None) -> float:
    r"""Return the standard deviation of white noise on a mesh, from its finest details.

    Parameters
    ----------
    mesh : TriangleMesh
    values : array_like, shape (n_vertices,), optional
        The noisy values; z by default.

    Notes
    -----
    Every vertex is compared with the plane of its one-ring, as the finest step of a pyramid
    with ``prediction="plane"`` would if it could remove them all, and the difference is divided
    by the noise that it should have, :math:`\sqrt{1 + \sum p^2}`. The median absolute value over
    0.6745 is the standard deviation; terrain that is rough at this scale counts as noise too.

    References
    ----------
    D. L. Donoho, I. M. Johnstone: Ideal spatial adaptation by wavelet shrinkage. Biometrika 81,
    1994.
    """
    z = mesh.vertices[:, 2] if values is None else np.asarray(values, dtype=np.float64)
    plan = mesh.vertices[:, :2] - mesh.vertices[:, :2].mean(axis=0)
    connectivity = build_connectivity(mesh.faces.astype(np.int32), mesh.n_vertices)
    has_ring = np.isin(connectivity.kind, (INTERIOR, BOUNDARY)) & (connectivity.ring_size >= 4)
    probed = np.flatnonzero(has_ring).astype(np.int32)
    if not len(probed):
        return 0.0
    everything = np.arange(mesh.n_vertices, dtype=np.int32)
    unlocked = np.zeros(mesh.n_vertices, dtype=bool)
    prediction = predict(
        "plane", Removal(plan, plan, connectivity, probed, probed, everything, unlocked)
    )
    expected = np.sqrt(1.0 + _squared(prediction).sum(axis=1))
    return float(np.median(np.abs(z[probed] - prediction @ z) / expected) / NORMAL_MAD)


def noise_gains(transform: Transform, seed: int = 0) -> list[FloatArray]:
    r"""Return the standard deviation that white noise of 1 has in every detail coefficient.

    Parameters
    ----------
    transform : Transform
    seed : int
        Of the noise that is sent through to measure each level.

    Returns
    -------
    list of ndarray, shape (n_odd,)
        One array a level, from level 0 up.

    Notes
    -----
    The variances are carried through P and U step by step as if the coefficients of a level were
    independent: :math:`P^2` for the details, the squares of :math:`I - UP` and of U for the even
    ones. They are not quite, so each level is then scaled to the noise that a few columns of
    white noise leave there when they are really transformed.
    """
    n_fine = len(transform.steps[-1].odd) + len(transform.steps[-1].even) if transform.steps else 0
    measured = transform.analyse(noise_columns(n_fine, seed))[1]
    variance = np.ones(n_fine)
    gains: list[FloatArray] = []
    for step, detail in zip(reversed(transform.steps), reversed(measured), strict=True):
        odd, even = variance[step.odd], variance[step.even]
        of_details = odd + _squared(step.prediction) @ even
        variance = _even_variance(step, odd, even)
        gains.append(np.sqrt(of_details * (np.mean(detail**2) / of_details.mean())))
    return gains[::-1]


def noise_columns(n_vertices: int, seed: int) -> FloatArray:
    """Return columns of white noise to send through a transform, ``(n_vertices, k)``."""
    wanted = NOISE_SAMPLES // max(n_vertices, 1)
    n_columns = min(max(wanted, LEAST_NOISE_COLUMNS), MOST_NOISE_COLUMNS)
    return np.random.default_rng(seed).standard_normal((n_vertices, n_columns))


def _even_variance(step: LinearStep, odd: FloatArray, even: FloatArray) -> FloatArray:
    """Variance of s = (I - U P) e + U o, for independent e and o."""
    mixing = csr_array(step.update @ step.prediction)
    diagonal = mixing.diagonal()
    own = (1.0 - diagonal) ** 2 - diagonal**2
    return own * even + _squared(mixing) @ even + _squared(step.update) @ odd


def _squared(matrix: csr_array) -> csr_array:
    return csr_array((matrix.data**2, matrix.indices, matrix.indptr), shape=matrix.shape)


def local_energy(step: LinearStep, energy: FloatArray, rounds: int) -> FloatArray:
    """Return values of the odd vertices averaged over their neighbourhood, ``(n_odd, ...)``.

    One round takes them to the even vertices of their rings and back; ``rounds`` widen it.
    """
    pattern = csr_array(
        (np.ones(len(step.prediction.data)), step.prediction.indices, step.prediction.indptr),
        shape=step.prediction.shape,
    )
    back = csr_array(pattern.T)
    there = diags(1.0 / np.maximum(back.sum(axis=1), 1.0)) @ back
    and_back = diags(1.0 / pattern.sum(axis=1)) @ pattern
    for _ in range(rounds):
        energy = and_back @ (there @ energy)
    return energy


# -- thresholds ----------------------------------------------------------------------------------


def denoised(
    pyramid: Pyramid,
    sigma: float | None = None,
    *,
    method: str = "bayes",
    strength: float = 1.0,
    local: bool = False,
    by_level: bool = False,
    channels: Sequence[str] = ("z",),
) -> Pyramid:
    r"""Return the pyramid with thresholded details.

    Parameters
    ----------
    pyramid : Pyramid
    sigma : float, optional
        Standard deviation of the noise in the channel's unit; by default estimated for each
        channel from the finest level.
    method : {"bayes", "soft", "hard"}
        ``"soft"`` and ``"hard"``: thresholds of 1.5 and 3 standard deviations of the noise in
        each coefficient. ``"bayes"``: soft thresholds of :math:`\sigma_n^2 / \sigma_x`, with the
        signal's deviation :math:`\sigma_x` that is left at the level once the noise is taken off.
    strength : float
        Multiplies the thresholds.
    local : bool
        With ``"bayes"``, take :math:`\sigma_x` from each vertex's neighbourhood rather than from
        the whole level.
    by_level : bool
        Estimate the noise on every level by itself, for noise that is not white; ``sigma`` must
        then be left out.
    channels : sequence of str
        Which channels to change.

    Raises
    ------
    OptionError
        An unknown method or channel, or numbers out of range.

    Notes
    -----
    One pyramid leaves the marks of its own triangles; :func:`wavelet_core.denoise` averages many
    and is the better smoother. The noise of a coefficient follows :func:`noise_gains`.

    References
    ----------
    S. G. Chang, B. Yu, M. Vetterli: Adaptive wavelet thresholding for image denoising and
    compression. IEEE Transactions on Image Processing 9, 2000.
    """
    if method not in METHODS:
        raise OptionError(f"method is {method!r}; give one of {', '.join(METHODS)}.")
    if not (np.isfinite(strength) and strength >= 0):
        raise OptionError(f"strength is {strength}; give a number of 0 or more.")
    if by_level and sigma is not None:
        raise OptionError("sigma and by_level exclude each other; give one.")
    check_sigma(sigma)
    columns = {name: channel_index(pyramid.channels, name) for name in channels}
    if not pyramid.steps:
        return pyramid
    transform = Transform.from_pyramid(pyramid)
    gains = noise_gains(transform)
    changed = [step.details.copy() for step in pyramid.steps]
    for name, column in columns.items():
        deviation = sigma if sigma is not None else channel_noise(pyramid, name)
        for level, (step, gain) in enumerate(zip(transform.steps, gains, strict=True)):
            detail = changed[level][:, column]
            noise = gain * (_deviation(detail / gain) if by_level else deviation)
            threshold = strength * _threshold(step, detail, noise, method, local)
            if method == "hard":
                changed[level][:, column] = np.where(np.abs(detail) > threshold, detail, 0.0)
            else:
                shrunk = np.sign(detail) * np.maximum(np.abs(detail) - threshold, 0.0)
                changed[level][:, column] = shrunk
    steps = tuple(
        replace(step, details=frozen(details))
        for step, details in zip(pyramid.steps, changed, strict=True)
    )
    return pyramid.with_parts(steps=steps)


def _threshold(
    step: LinearStep, detail: FloatArray, noise: FloatArray, method: str, local: bool
) -> FloatArray:
    if method == "hard":
        return HARD_THRESHOLD * noise
    if method == "soft":
        return SOFT_THRESHOLD * noise
    energy = np.divide(detail, noise, out=np.zeros_like(detail), where=noise > 0) ** 2
    around = (
        local_energy(step, energy, LOCAL_ROUNDS) if local else np.full(len(detail), energy.mean())
    )
    above = np.maximum(around - 1.0, 1e-12)
    return noise / np.sqrt(above)


def channel_noise(pyramid: Pyramid, channel: str = "z") -> float:
    """Return the standard deviation of white noise in a channel; see :func:`estimate_noise`."""
    column = channel_index(pyramid.channels, channel)
    mesh = pyramid.synthesise()
    first = 2 if pyramid.signal == "z" else 0
    values = np.column_stack([mesh.vertices, mesh.attributes])[:, first + column]
    return estimate_noise(mesh, values)


def _deviation(details: FloatArray) -> float:
    """Return the standard deviation, by the median absolute value."""
    return float(np.median(np.abs(details)) / NORMAL_MAD)


def channel_index(channels: Sequence[str], name: str) -> int:
    """Return the position of a channel.

    Raises
    ------
    OptionError
        There is none of this name.
    """
    if name not in channels:
        raise OptionError(f"there is no channel {name!r}; the channels are {', '.join(channels)}.")
    return list(channels).index(name)


def check_sigma(sigma: float | None) -> None:
    """Raise :class:`OptionError` unless sigma is left out or a number of 0 or more."""
    if sigma is not None and not (np.isfinite(sigma) and sigma >= 0):
        raise OptionError(f"sigma is {sigma}; give the noise's standard deviation, 0 or more.")
