"""When an analysis stops: rules in the unit of the input, and a word where one was not met."""

from __future__ import annotations

from wavelet_core import Pyramid
from wavelet_gis.crs.frame import LocalFrame
from wavelet_gis.notes import note

__all__ = ["note_unreached_size", "working_rules"]


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
    # Why it stopped is the core's knowledge; where it does not tell, the size alone is said.
    reason = getattr(pyramid, "stopped_by", None)
    note(
        "size_not_reached",
        "the coarsest level has {n_vertices:,} vertices where {target_vertices:,} were asked for"
        + ("; {reason}" if reason else ""),
        n_vertices=reached,
        target_vertices=target_vertices,
        reason=reason,
    )
