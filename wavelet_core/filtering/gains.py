"""Bands of details, and other columns sent through the filters of a pyramid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from .._validate import frozen
from ..errors import OptionError
from ..lifting.linear_map import Transform
from ..lifting.pyramid import Pyramid
from ..lifting.spacings import level_spacings
from ..mesh.triangle_mesh import TriangleMesh


def band_gains(
    pyramid: Pyramid,
    levels: tuple[int, int] | None = None,
    lengths: tuple[float, float] | None = None,
    *,
    is_empty_fine: bool = False,
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
        `wavelet_core.level_spacings` returns it.
    is_empty_fine : bool
        Whether a band of lengths that no level has details of is no error; all are dropped then.

    Raises
    ------
    OptionError
        Both or neither given, bounds in the wrong order, or lengths that no level has details of.
    """
    if (levels is None) == (lengths is None):
        raise OptionError(
            "a band is given by {0} or by {1} on the ground; give one.", "levels", "lengths"
        )
    low, high = levels if levels is not None else lengths  # type: ignore[misc]
    require_order(low, high, "levels" if levels is not None else "lengths")
    if levels is not None:
        for level in levels:
            pyramid.require_details(level, "levels")
        sizes: Sequence[float] = range(pyramid.n_levels)
    else:
        sizes = level_spacings(pyramid)[1:].tolist()
    gains = {level: float(low <= size <= high) for level, size in enumerate(sizes)}
    if lengths is not None and gains and not (any(gains.values()) or is_empty_fine):
        raise OptionError(
            "no level has a spacing of {low:.4g} to {high:.4g}, in the unit of x and y; theirs are "
            "{least:.4g} to {most:.4g}. Choose others, or analyse with more levels.",
            "lengths",
            low=low,
            high=high,
            least=min(sizes),
            most=max(sizes),
        )
    return gains


def require_order(low: float, high: float, option: str) -> None:
    """Raise :class:`OptionError` unless the bounds of a band are in order.

    Parameters
    ----------
    low, high : float
    option : str
        The parameter that names them, for the error.
    """
    if not low <= high:
        raise OptionError(
            "the band runs from {low} to {high}; give the smaller bound first.",
            option,
            low=low,
            high=high,
        )


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
            "{0} has {of_mesh} vertices with attributes {names}, the pyramid {of_pyramid} with "
            "{expected}; give the same.",
            "mesh",
            of_mesh=mesh.n_vertices,
            names=mesh.attribute_names,
            of_pyramid=n_vertices,
            expected=pyramid.attribute_names,
        )
    columns = pyramid.columns_of(mesh)
    coarse, details = Transform.from_pyramid(pyramid).analyse(columns)
    steps = tuple(
        replace(step, details=frozen(detail))
        for step, detail in zip(pyramid.steps, details, strict=True)
    )
    return pyramid.with_parts(coarse=frozen(coarse), steps=steps)


def channel_index(channels: Sequence[str], name: str) -> int:
    """Return the position of a channel.

    Raises
    ------
    OptionError
        There is none of this name.
    """
    if name not in channels:
        raise OptionError(
            "there is no channel {given}; the channels are {channels}.",
            "channels",
            given=repr(name),
            channels=", ".join(channels),
        )
    return list(channels).index(name)
