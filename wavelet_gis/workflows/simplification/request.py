"""What a simplification is asked for: one rule of three, and options that go with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core.errors import OptionError
from wavelet_gis.model.terrain import Terrain
from wavelet_gis.workflows.options import WaveletOptions, options_for
from wavelet_gis.workflows.tolerance.by_place import MaxError, is_by_place, tolerances

__all__ = ["Request", "request_for"]


@dataclass(frozen=True, slots=True)
class Request:
    """A simplification, checked.

    Attributes
    ----------
    vertices : int or None
        How many to keep.
    max_error : float or None
        The tolerance of the largest error, in the input's unit of z; of one by place the largest.
    limits : (n_input_vertices,) float64 or None
        The tolerance by place.
    max_rms : float or None
        The tolerance of the root mean square error.
    fit, keep_points, rounds
        As `wavelet_gis.simplify` takes them; ``rounds`` is its ``refine``.
    options : dict
        Keywords of `wavelet_core.analyse` that say how.
    """

    vertices: int | None
    max_error: float | None
    limits: NDArray[np.float64] | None
    max_rms: float | None
    fit: bool
    keep_points: bool
    rounds: int | None
    options: dict[str, Any]

    def limits_of(self, n_vertices: int) -> NDArray[np.float64] | None:
        """Return the tolerance of each vertex, where the largest error has one."""
        if self.limits is None and self.max_error is not None:
            return np.full(n_vertices, self.max_error)
        return self.limits


def request_for(
    terrain: Terrain,
    *,
    vertices: int | None,
    max_error: MaxError | None,
    zones: Any,
    zone_field: str | None,
    max_rms: float | None,
    fit: bool,
    refine: int | None,
    keep_points: bool,
    options: WaveletOptions,
) -> Request:
    """Return what is asked for, once it is known to make sense.

    Parameters
    ----------
    terrain, vertices, max_error, zones, zone_field, max_rms, fit, refine, keep_points, options
        See `wavelet_gis.simplify`.

    Raises
    ------
    OptionError
        Not just one of the three rules, or options that contradict each other.
    """
    has_max_error = max_error is not None or zones is not None
    if zones is not None and (vertices is not None or max_rms is not None):
        raise OptionError("{0} go with {1} only; leave them out.", "zones", "max_error")
    if (vertices is not None) + has_max_error + (max_rms is not None) != 1:
        raise OptionError("give one of {0}, {1} and {2}.", "vertices", "max_error", "max_rms")
    _require_sensible_rounds(refine, fit=fit, keep_points=keep_points)
    keywords = options_for(terrain, options)
    limits, largest = None, None
    if is_by_place(max_error, zones, zone_field):
        limits = tolerances(terrain, terrain.mesh, max_error, zones, zone_field)
        largest = _largest_of(limits, terrain)
        keywords = _by_largest_error(keywords)
    elif max_error is not None:
        largest = float(max_error)  # type: ignore[arg-type]
    if keep_points:
        keywords = _without_update(keywords)
    rounds = 0 if limits is not None and not fit else refine
    return Request(vertices, largest, limits, max_rms, fit, keep_points, rounds, keywords)


def _require_sensible_rounds(refine: int | None, *, fit: bool, keep_points: bool) -> None:
    if refine is not None and refine < 0:
        raise OptionError("{0} is {given}; give 0 or more rounds.", "refine", given=refine)
    if refine and not (fit or keep_points):
        raise OptionError(
            "{0} moves vertices, whose heights cannot stay those of the level; leave out {0} or "
            "{1}, or give {2}.",
            "refine",
            "fit",
            "keep_points",
        )


def _largest_of(limits: NDArray[np.float64], terrain: Terrain) -> float:
    """Return the largest tolerance, or what no error can be above."""
    relief = float(np.ptp(terrain.mesh.vertices[:, 2])) / terrain.frame.z_scale
    return float(min(limits.max(initial=0.0), relief))


def _by_largest_error(keywords: dict[str, Any]) -> dict[str, Any]:
    """Return the options of an analysis that a tolerance by place can start from."""
    for option, due in (("norm", "max"), ("update", "none")):
        if keywords.get(option, due) != due:
            raise OptionError(
                "{0} {given!r} does not go with a tolerance that varies by place, which needs "
                "{due!r}; leave it out.",
                option,
                given=keywords[option],
                due=due,
            )
    if "prediction" in keywords or keywords.get("signal", "z") != "z":
        raise OptionError(
            "a tolerance that varies by place needs the heights of the input; leave out {0}, {1} "
            "and {2}.",
            "design",
            "prediction",
            "signal",
        )
    return {**keywords, "norm": "max", "update": "none"}


def _without_update(keywords: dict[str, Any]) -> dict[str, Any]:
    """Return the options of an analysis whose levels keep the heights of the input."""
    if "prediction" in keywords or keywords.get("update", "none") != "none":
        raise OptionError(
            "{0} keeps the heights of the input; leave out {1}, {2} and {3}, which would not.",
            "keep_points",
            "design",
            "prediction",
            "update",
        )
    return {**keywords, "update": "none"}
