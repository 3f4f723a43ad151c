"""How steeply the spectrum of terrain falls: the exponent of its power law, from the levels."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .._validate import FloatArray
from ..errors import OptionError
from ..lifting.pyramid import Pyramid
from ..lifting.step import Step
from ..mesh.collapse import even_positions

__all__ = ["spectral_slope"]

#: Levels with fewer stars are left out, for the chance in their mean square.
MIN_STARS = 30
#: A line through fewer levels says nothing.
MIN_LEVELS = 4
#: Stars of a level that are looked at, evenly taken.
MAX_STARS = 10_000
#: Hurst exponents that are looked for; at 1 the law of planes' residuals is a logarithm.
LEAST, MOST, AROUND_ONE = 0.01, 1.99, 1e-3
#: The exponent is found when it changes by less.
PRECISE = 1e-6
MAX_ROUNDS = 100


class _Stars(NamedTuple):
    """Predicted vertices of one level with those that they are predicted from.

    scale : root mean square distance of the neighbours
    squares : mean square of the residuals
    coefficients : (n_stars, n_corners), 1 at the vertex, -p at its neighbours, 0 where none is
    distances : (n_stars, n_corners, n_corners) between them, in plan
    """

    scale: float
    squares: float
    coefficients: FloatArray
    distances: FloatArray


def spectral_slope(pyramid: Pyramid, channel: str = "z") -> float:
    r"""Return the exponent β with which the power spectrum of terrain falls, :math:`k^{-\beta}`.

    Parameters
    ----------
    pyramid : Pyramid
        Of a partition whose levels are bands of sizes, and a prediction that reproduces planes:
        random and plane. Take as many levels as there are.
    channel : str
        One of ``pyramid.channels``.

    Returns
    -------
    float
        Of the spectrum in two dimensions: 2 + 2H for a fractal surface of Hurst exponent H, whose
        fractal dimension is 3 - H while H is below 1. From 2.02 to 5.98.

    Raises
    ------
    OptionError
        A channel that the pyramid does not have, or fewer than four levels with at least 30
        vertices that are not predicted without error.

    Notes
    -----
    If the spectrum is that power law, heights differ by a mean square of :math:`h^{2H}` at distance
    h, and the residual of a vertex, predicted with weights p from the neighbours' heights, has
    the variance

    .. math::
        v_H = C \, \bigl| \tfrac12 \textstyle\sum_{ij} a_i a_j |x_i - x_j|^{2H} \bigr|,
        \qquad a = (1, -p),

    on whatever star. H is the one at which the ratio of the mean squares of residuals and the mean
    :math:`v_H` does not depend on the scale of the level: the line through their logarithms, the
    levels weighted by their numbers of vertices, is level. The residuals are those of the input's
    own heights (*our choice*): details proper are of heights that the update has smoothed, which
    has no such law. On fractal surfaces with β of 3 and 3.5 it is within 2 %.

    References
    ----------
    P. Flandrin: Wavelet analysis and synthesis of fractional Brownian motion. IEEE Transactions on
    Information Theory 38(2), 1992. J.-P. Chilès, P. Delfiner: Geostatistics. Wiley, 2012, on
    generalised covariances.

    Examples
    --------
    >>> import numpy as np
    >>> from wavelet_core import TriangleMesh, analyse, spectral_slope
    >>> axis = np.arange(100.0)
    >>> steps = np.random.default_rng(0).normal(size=(2, 100)).cumsum(axis=1)
    >>> mesh = TriangleMesh.from_grid(steps[0][:, None] + steps[1], x=axis, y=axis)
    >>> pyramid = analyse(mesh, levels=12, partition="random", prediction="plane")
    >>> bool(abs(spectral_slope(pyramid) - 3.0) < 0.3)  # of a Brownian walk H is a half
    True
    """
    if channel not in pyramid.channels:
        raise OptionError(
            "there is no {0} {given}; the pyramid has {channels}.",
            "channel",
            given=repr(channel),
            channels=", ".join(pyramid.channels),
        )
    levels = [stars for stars in _levels(pyramid, channel) if stars.squares > 0]
    if len(levels) < MIN_LEVELS:
        raise OptionError(
            "{0} has {n} levels with {stars} vertices that are not predicted without error, and "
            "{least} are needed; analyse with more levels, or more terrain.",
            "pyramid",
            n=len(levels),
            stars=MIN_STARS,
            least=MIN_LEVELS,
        )
    hurst = 0.5
    for _ in range(MAX_ROUNDS):
        found = float(np.clip(hurst + 0.5 * _slope_left(levels, hurst), LEAST, MOST))
        if abs(found - hurst) < PRECISE:
            break
        hurst = found
    return 2.0 + 2.0 * found


def _slope_left(levels: list[_Stars], hurst: float) -> float:
    """Return by which power of the scale residuals grow beyond what a Hurst exponent has them."""
    if abs(hurst - 1.0) < AROUND_ONE:
        hurst = 1.0 + AROUND_ONE
    ratios = [stars.squares / abs(_mean_variance(stars, hurst)) for stars in levels]
    scales = [stars.scale for stars in levels]
    weights = np.sqrt([len(stars.coefficients) for stars in levels])
    return float(np.polyfit(np.log(scales), np.log(ratios), 1, w=weights)[0])


def _mean_variance(stars: _Stars, hurst: float) -> float:
    relative = stars.distances / stars.scale
    powers = np.power(relative, 2 * hurst)
    a = stars.coefficients
    variances = -0.5 * np.einsum("ni,nj,nij->n", a, a, powers)
    return float(variances.mean()) * stars.scale ** (2 * hurst)


def _levels(pyramid: Pyramid, channel: str) -> Iterator[_Stars]:
    """Yield the stars of each level that has enough, the finest first."""
    mesh = pyramid.synthesise()
    plan = mesh.vertices[:, :2]
    heights = pyramid.columns_of(mesh)[:, pyramid.channels.index(channel)]
    for step in reversed(pyramid.steps):
        even = even_positions(step.odd, len(plan))
        if step.n_odd >= MIN_STARS:
            yield _stars(step, plan[step.odd], plan[even], heights[step.odd], heights[even])
        plan, heights = plan[even], heights[even]


def _stars(
    step: Step,
    odd_plan: FloatArray,
    even_plan: FloatArray,
    odd_heights: FloatArray,
    even_heights: FloatArray,
) -> _Stars:
    residuals = odd_heights - step.prediction(len(even_plan)) @ even_heights
    chosen = np.arange(0, step.n_odd, -(-step.n_odd // MAX_STARS))
    sizes = np.diff(step.indptr)[chosen]
    rows = np.repeat(np.arange(len(chosen)), sizes)
    places = np.arange(len(rows)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    entries = step.indptr[chosen][rows] + places
    offsets = even_plan[step.indices[entries]] - odd_plan[chosen][rows]
    corners = np.zeros((len(chosen), int(sizes.max(initial=0)) + 1, 2))
    coefficients = np.zeros(corners.shape[:2])
    corners[rows, places + 1] = offsets
    coefficients[:, 0] = 1.0
    coefficients[rows, places + 1] = -step.weights[entries]
    between = corners[:, :, None] - corners[:, None]
    return _Stars(
        float(np.sqrt((offsets**2).sum(axis=1).mean())),
        float(np.mean(residuals[chosen] ** 2)),
        coefficients,
        np.hypot(between[..., 0], between[..., 1]),
    )
