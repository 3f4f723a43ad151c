"""Filtering of a pyramid in the units of its input: noise taken out, scales changed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from wavelet_core import denoise
from wavelet_core.errors import OptionError
from wavelet_core.filtering.gains import band_gains, channel_index, check_level, relifted
from wavelet_core.filtering.noise import channel_noise
from wavelet_gis.model.categories import category_gains
from wavelet_gis.model.geo_pyramid import GeoPyramid

__all__ = ["change_between", "chosen_gains", "denoised_record", "scaled_record"]

Progress = Callable[[float], bool | None]


def denoised_record(
    geo: GeoPyramid,
    sigma: float | None = None,
    *,
    channels: Sequence[str] = ("z",),
    n_pyramids: int = 8,
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
        How many pyramids in random order are averaged; 0 thresholds the details of this one.
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
    for k, name in enumerate(channels):
        unit = geo.frame.z_scale if name == "z" else 1.0
        deviation = channel_noise(pyramid, name) if sigma is None else sigma * unit
        sigmas[name] = deviation / unit
        if n_pyramids == 0:
            part = _part(progress, k, len(channels))
            pyramid = pyramid.denoised(deviation, channels=[name], progress=part)
            continue
        mesh = denoise(
            pyramid.synthesise(),
            deviation,
            n_pyramids=n_pyramids,
            channels=[name],
            locked=pyramid.locked,
            progress=_part(progress, k, len(channels)),
        )
        pyramid = relifted(pyramid, mesh)
    how = f"average of {n_pyramids} pyramids" if n_pyramids else "thresholds"
    listed = ", ".join(f"{name} {deviation:.4g}" for name, deviation in sigmas.items())
    line = f"denoised by {how}, standard deviation of the noise: {listed}"
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
        is_metric = geo.system.kind == "geographic"
        unit = 1.0 if is_metric else 1.0 / geo.system.horizontal_unit
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


def _part(progress: Progress | None, k: int, n: int) -> Progress | None:
    if progress is None:
        return None
    return lambda fraction: progress((k + fraction) / n)
