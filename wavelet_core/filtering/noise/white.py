"""Noise: how strong it is on a mesh, and how much of it reaches every detail coefficient."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage
from scipy.sparse import csr_array, diags  # diags_array is not in SciPy 1.10

from ..._validate import FloatArray
from ...errors import OptionError
from ...lifting.linear_map import LinearStep, Transform
from ...lifting.prediction import Removal, predict
from ...lifting.pyramid import Pyramid
from ...mesh.connectivity import BOUNDARY, INTERIOR, build_connectivity
from ...mesh.triangle_mesh import TriangleMesh
from ..gains import channel_index

#: The median absolute deviation of a normal distribution with standard deviation 1.
NORMAL_MAD = 0.6744897501960817
#: Columns of noise that are sent through a transform to measure what arrives at each level: few
#: for a large mesh, whose levels average over many details, more for a small one.
LEAST_NOISE_COLUMNS, MOST_NOISE_COLUMNS = 4, 64
NOISE_SAMPLES = 100_000


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
    if not mesh.n_faces:
        return 0.0
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


def noise_gains(
    transform: Transform,
    seed: int = 0,
    columns: FloatArray | None = None,
    relative: FloatArray | None = None,
) -> list[FloatArray]:
    r"""Return the standard deviation that white noise of 1 has in every detail coefficient.

    Parameters
    ----------
    transform : Transform
    seed : int
        Of the noise that is sent through to measure each level.
    columns : ndarray, shape (n_vertices, k), optional
        Noise to send through instead of white one, for noise of another kind.
    relative : ndarray, shape (n_vertices,), optional
        Standard deviation at each vertex, where it differs from place to place.

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
    columns = noise_columns(n_fine, seed) if columns is None else columns
    measured = transform.analyse(columns)[1]
    variance = np.ones(n_fine) if relative is None else relative**2
    gains: list[FloatArray] = []
    for step, detail in zip(reversed(transform.steps), reversed(measured), strict=True):
        odd, even = variance[step.odd], variance[step.even]
        of_details = odd + _squared(step.prediction) @ even
        variance = _even_variance(step, odd, even)
        transform.tick()
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


def local_energy(
    step: LinearStep, energy: FloatArray, rounds: int, tick: Callable[[], None] | None = None
) -> FloatArray:
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
        if tick is not None:
            tick()
    return energy


def channel_noise(pyramid: Pyramid, channel: str = "z") -> float:
    """Return the standard deviation of white noise in a channel; see :func:`estimate_noise`."""
    column = channel_index(pyramid.channels, channel)
    mesh = pyramid.synthesise()
    return estimate_noise(mesh, pyramid.columns_of(mesh)[:, column])


def deviation_of(details: FloatArray) -> float:
    """Return the standard deviation, by the median absolute value."""
    return float(np.median(np.abs(details)) / NORMAL_MAD)


def check_sigma(sigma: float | None) -> None:
    """Raise :class:`OptionError` unless sigma is left out or a number of 0 or more."""
    if sigma is not None and not (np.isfinite(sigma) and sigma >= 0):
        raise OptionError(
            "{0} is {given}; give the noise's standard deviation, 0 or more.", "sigma", given=sigma
        )


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
