"""Contours of a level of a pyramid."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_core import Progress
from wavelet_core.errors import OptionError
from wavelet_gis.errors import OutputFileError
from wavelet_gis.io.formats import PYRAMID_SUFFIX, suffix_of
from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.contours import contour_lines, contour_values, round_interval
from wavelet_gis.products.layers import Layer
from wavelet_gis.products.styles import contour_style
from wavelet_gis.products.wkb import lines_wkb
from wavelet_gis.workflows.options import HoldsPyramid, pyramid_of
from wavelet_gis.workflows.read_off.levels import checked_levels

__all__ = ["Contours", "contours"]

#: Part of the interval that the RMSE of a level may be which is taken where none is named.
FITTING_ERROR = 0.2
#: One contour in so many is an index contour, which maps draw thick.
INDEX = 5
#: More heights than this are refused rather than tried.
MOST_HEIGHTS = 100_000


@dataclass(frozen=True, slots=True)
class Contours:
    """Contour lines of a level.

    Attributes
    ----------
    geo : GeoPyramid
        Gives place and CRS.
    level : int
        Whose surface.
    interval, base : float
        In the input's unit of z: heights are the base and multiples of the interval from there.
    heights : (n,) float64
        Of each line.
    lines : tuple of (m, 3) float64
        In the coordinates of the input; higher ground is on the right.
    """

    geo: GeoPyramid
    level: int
    interval: float
    base: float
    heights: NDArray[np.float64]
    lines: tuple[NDArray[np.float64], ...]

    def layer(self) -> Layer:
        """Return the lines as a layer with the fields ``elevation`` and ``is_index``."""
        steps = np.rint((self.heights - self.base) / self.interval).astype(np.int64)
        return Layer(
            "contours",
            "LineString Z",
            lines_wkb(self.lines),
            {"elevation": self.heights, "is_index": (steps % INDEX == 0).astype(np.int64)},
            contour_style(),
            f"Contours of level {self.level}",
            f"Contour lines at intervals of {self.interval:g}; every fifth is an index contour",
        )

    def write(self, path: str | os.PathLike[str]) -> dict[str, Any]:
        """Write a layer of lines (.gpkg); see `wavelet_gis.workflows.save.save`."""
        if suffix_of(path) != PYRAMID_SUFFIX:
            raise OutputFileError(f"{path}: contours are written as {PYRAMID_SUFFIX}.")
        from wavelet_gis.io.vector.vector_writer import add_layers

        add_layers(path, [self.layer()], self.geo.system)
        return {}

    def figures(self) -> dict[str, Any]:
        """Return what was drawn, as JSON-able values."""
        return {
            "level": self.level,
            "interval": self.interval,
            "base": self.base,
            "n_contours": len(self.lines),
        }


def contours(
    data: HoldsPyramid | GeoPyramid,
    *,
    interval: float | None = None,
    level: int | None = None,
    base: float = 0.0,
    progress: Progress | None = None,
) -> Contours:
    """Return the contours of one level of a pyramid, straight in each triangle, never crossing.

    Parameters
    ----------
    data : Analysis, Filtered or GeoPyramid
        The pyramid.
    interval : float, optional
        In the input's unit of z; by default a round one that gives about twenty.
    level : int, optional
        By default the coarsest whose RMSE is at most a fifth of the interval.
    base : float
        What intervals are counted from.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Raises
    ------
    OptionError
        An interval that is no length or gives too many contours, a base that is no height, or a
        level that is not there.
    """
    geo = pyramid_of(data)
    if interval is not None and not 0 < interval < np.inf:
        raise OptionError("{0} is {given}; give one above 0.", "interval", given=interval)
    if not np.isfinite(base):
        raise OptionError("{0} is {given}; give a height.", "base", given=base)
    finest = geo.frame.to_file(geo.pyramid.synthesise().vertices)
    relief = float(finest[:, 2].max() - finest[:, 2].min())
    chosen = interval or round_interval(relief)
    if relief / chosen > MOST_HEIGHTS:
        raise OptionError(
            "{0} is {given}, which gives {n:,.0f} heights; give a larger one.",
            "interval",
            given=chosen,
            n=relief / chosen,
        )
    found = _fitting_level(geo, chosen) if level is None else checked_levels(geo, [level])[0]
    mesh = geo.pyramid.mesh(found)
    vertices = geo.frame.to_file(mesh.vertices)
    values = contour_values(vertices[:, 2], chosen, base)
    drawn = list(contour_lines(vertices, mesh.faces, values, progress))
    heights = np.array([height for height, _ in drawn], dtype=np.float64)
    return Contours(geo, found, chosen, base, heights, tuple(line for _, line in drawn))


def _fitting_level(geo: GeoPyramid, interval: float) -> int:
    """Return the coarsest level that is accurate enough for an interval."""
    measured = geo if geo.errors else geo.with_errors(None)
    for errors in measured.errors or ():
        if errors.rmse_surface <= FITTING_ERROR * interval:
            return errors.level
    return geo.pyramid.n_levels
