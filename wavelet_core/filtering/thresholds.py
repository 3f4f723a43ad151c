"""Thresholds on the details of one pyramid: hard, soft, and by Bayes' rule."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .._validate import FloatArray, frozen
from ..errors import OptionError
from ..lifting.linear_map import LinearStep, Transform
from ..lifting.pyramid import Pyramid
from .gains import channel_index
from .noise import channel_noise, check_sigma, deviation_of, local_energy, noise_gains

#: Thresholds in standard deviations of the noise, for strength 1.
HARD_THRESHOLD = 3.0
SOFT_THRESHOLD = 1.5
METHODS = ("bayes", "soft", "hard")
#: Rounds of averaging over rings that a local energy is taken over.
LOCAL_ROUNDS = 4


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
        raise OptionError(
            "{0} is {given}; give one of {methods}.",
            "method",
            given=repr(method),
            methods=", ".join(METHODS),
        )
    if not (np.isfinite(strength) and strength >= 0):
        raise OptionError("{0} is {given}; give a number of 0 or more.", "strength", given=strength)
    if by_level and sigma is not None:
        raise OptionError("{0} and {1} exclude each other; give one.", "sigma", "by_level")
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
            noise = gain * (deviation_of(detail / gain) if by_level else deviation)
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
