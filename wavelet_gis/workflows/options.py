"""What workflows take: a terrain or a pyramid, the options of an analysis, rules to stop by."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from wavelet_core import Pyramid, TriangleMesh
from wavelet_core.errors import OptionError
from wavelet_core.partition.outline import area_change
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.errors import TerrainWarning
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.notes import note, warn

__all__ = [
    "ROUNDING",
    "HoldsPyramid",
    "WaveletOptions",
    "core_options",
    "metre_of",
    "note_moved_outline",
    "note_unreached_size",
    "options_for",
    "pyramid_of",
    "require_levels",
    "require_terrain",
    "warn_of_error_above",
    "working_rules",
]

#: An error that is above a limit by so much, in parts of one, is within it.
ROUNDING = 1e-9


class WaveletOptions(TypedDict, total=False):
    """Keywords of `wavelet_core.analyse`, and ``design``; None leaves the choice to the core.

    design : a design of the paper, prediction and update in one, such as ``GLMN``; with the paper's
        partition unless another is named
    partition, prediction, update, signal, norm, removal_fraction, outline_tolerance,
    bending_weight, quadrics, cost, attribute_weights, locked : see `wavelet_core.analyse`
    """

    design: str | None
    partition: str | None
    prediction: str | None
    update: str | None
    signal: str | None
    norm: str | None
    removal_fraction: float | None
    outline_tolerance: float | None
    bending_weight: float | None
    quadrics: str | None
    cost: str | None
    attribute_weights: Sequence[float] | None
    locked: ArrayLike | None


def core_options(options: WaveletOptions) -> dict[str, Any]:
    """Return the options that are given as keywords of `wavelet_core.analyse`.

    Parameters
    ----------
    options : WaveletOptions
        As a workflow was given them.

    Raises
    ------
    OptionError
        A design beside a prediction or an update.

    Examples
    --------
    >>> core_options({"design": "GLMN", "norm": None})
    {'prediction': 'GLMN', 'partition': 'quadric'}
    """
    given: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
    design = given.pop("design", None)
    if design is None:
        return given
    if "prediction" in given or "update" in given:
        raise OptionError(
            "{0} names prediction and update; leave out {1} and {2}.",
            "design",
            "prediction",
            "update",
        )
    return {"prediction": design, "partition": "quadric", **given}


def options_for(terrain: Terrain, options: WaveletOptions) -> dict[str, Any]:
    """Return the options as keywords of the core, with the vertices that a terrain locks.

    Parameters
    ----------
    terrain : Terrain
        Whose lines and fixed points are locked.
    options : WaveletOptions
        See `core_options`; what they lock is locked too.
    """
    keywords = core_options(options)
    if terrain.locked is not None and terrain.locked.any():
        also = np.asarray(keywords.get("locked", terrain.locked))
        # Of another length it is for the core to refuse.
        is_mask = also.shape == terrain.locked.shape and also.dtype == bool
        keywords["locked"] = terrain.locked | also if is_mask else also
    return keywords


def working_rules(
    frame: LocalFrame,
    *,
    levels: int | None = None,
    target_vertices: int | None = None,
    max_error: float | None = None,
    max_rms: float | None = None,
) -> dict[str, float | int | None]:
    """Return the stop rules of `wavelet_core.analyse`, heights in the working unit.

    Parameters
    ----------
    frame : LocalFrame
        Of the terrain.
    levels, target_vertices : int, optional
        As the core takes them.
    max_error, max_rms : float, optional
        In the input's unit of z.
    """
    unit = frame.z_scale
    return {
        "levels": levels,
        "target_vertices": target_vertices,
        "max_error": None if max_error is None else max_error * unit,
        "max_rms": None if max_rms is None else max_rms * unit,
    }


def note_unreached_size(pyramid: Pyramid, target_vertices: int | None) -> None:
    """Note that the coarsest level has more vertices than were asked for, and why.

    Parameters
    ----------
    pyramid : Pyramid
        As analysed.
    target_vertices : int or None
        What was asked for.
    """
    reached = pyramid.n_vertices(0)
    if target_vertices is None or reached <= target_vertices:
        return
    note(
        "size_not_reached",
        "the coarsest level has {n_vertices:,} vertices where {target_vertices:,} were asked for; "
        "{reason}",
        n_vertices=reached,
        target_vertices=target_vertices,
        reason=str(pyramid.stop).rstrip("."),
    )


def note_moved_outline(
    original: TriangleMesh, coarse: TriangleMesh, outline_tolerance: float | None
) -> None:
    """Note by what the area has changed where the outline was free to move.

    Parameters
    ----------
    original, coarse : TriangleMesh
        Before and after.
    outline_tolerance : float or None
        What was allowed.
    """
    if not outline_tolerance:
        return
    note(
        "outline_moved",
        "the outline moved by at most {tolerance:g}; the area changed by {area_change:.4g}, in "
        "the square of the unit of x and y",
        tolerance=outline_tolerance,
        area_change=area_change(original, coarse),
    )


def warn_of_error_above(
    name: str,
    largest: float | None,
    rms: float | None,
    *,
    max_error: float | None = None,
    max_rms: float | None = None,
) -> None:
    """Warn where the error at all input points is above what was asked for at the vertices.

    A stop rule looks at the vertices; points that share x and y with one of them are farther off
    by as much as they are apart, whatever the surface is.

    Parameters
    ----------
    name : str
        Of the input, for the message.
    largest, rms : float or None
        As measured at all input points, in the input's unit of z; None where they were not.
    max_error, max_rms : float, optional
        What was asked for.
    """
    for option, asked, found in (("max_error", max_error, largest), ("max_rms", max_rms, rms)):
        if asked is None or found is None or found <= asked * (1.0 + ROUNDING):
            continue
        warn(
            TerrainWarning,
            "error_above_what_was_asked",
            "{name}: {0} {asked:g} holds at the vertices; with the points that share x and y with "
            "one of them the error is {found:.4g}",
            option,
            stacklevel=3,
            name=name,
            asked=asked,
            found=found,
        )


class HoldsPyramid(Protocol):
    """A result that holds a pyramid, such as an `Analysis`."""

    @property
    def geo(self) -> GeoPyramid:
        """The pyramid."""


def metre_of(geo: GeoPyramid) -> float:
    """Return a metre in the unit of the working frame, where that is known."""
    return 1.0 / geo.system.working_unit


def pyramid_of(data: HoldsPyramid | GeoPyramid) -> GeoPyramid:
    """Return the pyramid that a workflow was given.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        What analysing, filtering or loading returned.

    Raises
    ------
    OptionError
        Something else.
    """
    geo = getattr(data, "geo", data)
    if isinstance(geo, GeoPyramid):
        return geo
    raise OptionError(
        f"a {type(data).__name__} is not a pyramid; give what 'wavelet_gis.analyse' or "
        "'wavelet_gis.load' returns."
    )


def require_levels(geo: GeoPyramid) -> None:
    """Raise `OptionError` unless the pyramid has levels, and so details."""
    if geo.pyramid.n_levels == 0:
        raise OptionError(
            "the pyramid has no levels and so no details; analyse the input with more levels (a "
            "surface of a few points has none to give)."
        )


def require_terrain(data: object) -> None:
    """Raise `OptionError` unless this is a terrain that can be analysed."""
    if not isinstance(data, Terrain):
        raise OptionError(
            f"a {type(data).__name__} is not a terrain that can be analysed; give what "
            "'wavelet_gis.open' returns for a raster, a point cloud or a TIN."
        )
