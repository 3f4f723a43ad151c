"""Filtering of a pyramid in the units of its input: noise taken out, scales changed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from wavelet_core import denoise
from wavelet_core.errors import OptionError
from wavelet_core.filtering.gains import band_gains, channel_index, check_level, relifted
from wavelet_core.filtering.noise import channel_noise
from wavelet_core.filtering.noise_model import Noise
from wavelet_core.progress import Progress, part_of
from wavelet_gis.model.categories import category_gains
from wavelet_gis.model.geo_pyramid import GeoPyramid

__all__ = ["change_between", "chosen_gains", "denoised_record", "scaled_record"]


def denoised_record(
    geo: GeoPyramid,
    sigma: float | None = None,
    *,
    channels: Sequence[str] = ("z",),
    n_pyramids: int = 8,
    noise_range: float | Literal["estimate"] = 0.0,
    local_noise: bool = False,
    outliers: bool = False,
    progress: Progress | None = None,
) -> tuple[GeoPyramid, dict[str, float]]:
    """Return the pyramid with the noise taken out, and the noise that was taken for it.

    Parameters
    ----------
    geo : GeoPyramid
        What is filtered.
    sigma : float, optional
        Standard deviation of the noise, in the input's unit; by default estimated.
    channels : sequence of str
        Which to take it from.
    n_pyramids : int
        How many pyramids in random order are averaged; 0 thresholds the details of one.
    noise_range, local_noise, outliers
        As for `wavelet_core.denoise`; the range in metres where the CRS tells its unit, else in
        its own. Not with thresholds.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    GeoPyramid
        With one more line of history.
    dict of str to float
        Standard deviation of the noise in each channel, in the input's unit.

    Raises
    ------
    OptionError
        An unknown channel or a negative number; nothing has been computed yet.
    """
    pyramid, sigmas = geo.pyramid, {}
    for name in channels:
        channel_index(pyramid.channels, name)
        if name in geo.categories:
            raise OptionError(f"{name} is a category and has no noise; name another channel.")
    if n_pyramids == 0 and (noise_range != 0.0 or local_noise or outliers):
        raise OptionError(
            "thresholds know white noise only; leave out the range, the noise by place and the "
            "outliers, or average one or more pyramids."
        )
    reach = noise_range if noise_range == "estimate" else noise_range * _metre(geo)
    described = []
    for k, name in enumerate(channels):
        unit = geo.frame.z_scale if name == "z" else 1.0
        part = part_of(progress, k / len(channels), (k + 1) / len(channels))
        if n_pyramids == 0:
            deviation = channel_noise(pyramid, name) if sigma is None else sigma * unit
            sigmas[name] = deviation / unit
            described.append(f"{name} {sigmas[name]:.4g}")
            pyramid = pyramid.denoised(deviation, channels=[name], progress=part)
            continue
        found: dict[str, Noise] = {}
        mesh = denoise(
            pyramid.synthesise(),
            None if sigma is None else sigma * unit,
            n_pyramids=n_pyramids,
            channels=[name],
            locked=pyramid.locked,
            noise_range=reach,
            local_noise=local_noise,
            outliers=outliers,
            found=found,
            progress=part,
        )
        noise = found[name]
        sigmas[name] = noise.sigma / unit
        in_file = replace(
            noise,
            sigma=noise.sigma / unit,
            quantum=noise.quantum / unit,
            reach=noise.reach / _metre(geo),
        )
        described.append(f"{name} {in_file.describe()}")
        pyramid = relifted(pyramid, mesh)
    how = f"average of {n_pyramids} pyramids" if n_pyramids else "thresholds"
    line = f"denoised by {how}, standard deviation of the noise: {'; '.join(described)}"
    return geo.with_pyramid(pyramid, line), sigmas


def chosen_gains(
    geo: GeoPyramid,
    gains: Iterable[tuple[int, float]] = (),
    *,
    levels: tuple[int, int] | None = None,
    metres: tuple[float, float] | None = None,
) -> dict[int, float]:
    """Return the gain of each level that a band and single gains ask for together.

    Parameters
    ----------
    geo : GeoPyramid
        Whose levels.
    gains : iterable of (level, gain)
        They multiply what the band gives.
    levels : (int, int), optional
        Keep the details of these levels only.
    metres : (float, float), optional
        Instead: keep details of this size on the ground only, in metres where the CRS tells its
        unit, else in its own.

    Raises
    ------
    OptionError
        Bounds in the wrong order, or a level without details.
    """
    chosen: dict[int, float] = {}
    if metres is not None:
        unit = _metre(geo)
        chosen = band_gains(geo.pyramid, lengths=(metres[0] * unit, metres[1] * unit))
    elif levels is not None:
        chosen = band_gains(geo.pyramid, levels=levels)
    for level, gain in gains:
        check_level(level, geo.pyramid)
        chosen[level] = gain * chosen.get(level, 1.0)
    return chosen


def scaled_record(
    geo: GeoPyramid, gains: dict[int, float], *, drops_coarse: bool = False
) -> GeoPyramid:
    """Return the pyramid with the details of each level multiplied.

    Parameters
    ----------
    geo : GeoPyramid
        What is filtered.
    gains : dict of int to float
        By level; others keep 1. Categories, such as classes, stay as they are.
    drops_coarse : bool
        Leave out the coarsest surface too, so that the details remain by themselves.
    """
    channels, categories = geo.pyramid.channels, geo.categories
    coarse = [0.0 if drops_coarse and name not in categories else 1.0 for name in channels]
    pyramid = geo.pyramid.with_gains(category_gains(gains, channels, categories), coarse)
    named = ", ".join(f"{level}={gain:g}" for level, gain in sorted(gains.items()))
    line = f"gains {named or 'unchanged'}" + ", without the coarse surface" * drops_coarse
    return geo.with_pyramid(pyramid, line)


def change_between(before: GeoPyramid, after: GeoPyramid) -> tuple[float, float]:
    """Return root mean square and largest change of z, in the input's unit."""
    old, new = (geo.pyramid.synthesise().vertices[:, 2] for geo in (before, after))
    moved = (new - old) / before.frame.z_scale
    rms = float(np.sqrt(np.mean(moved**2))) if len(moved) else 0.0
    return rms, float(np.abs(moved).max(initial=0.0))


def _metre(geo: GeoPyramid) -> float:
    """Return a metre in the unit of the working frame, where that is known."""
    return 1.0 if geo.system.kind == "geographic" else 1.0 / geo.system.horizontal_unit
