"""What may be done to detail coefficients: gains, bands, thresholds, and how noise reaches them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from .._validate import FloatArray, frozen
from ..errors import OptionError
from ..lifting.linear_map import Transform
from ..lifting.pyramid import Pyramid
from ..lifting.spacings import level_spacings
from ..mesh.triangle_mesh import TriangleMesh

Gains = Mapping[int, float | Sequence[float]]


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
        :func:`wavelet_core.lifting.spacings.level_spacings` tells it.

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


# -- thresholds ----------------------------------------------------------------------------------


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
