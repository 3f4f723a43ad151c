"""What holds for all tiles of a set: zooms, errors, steps of height."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from wavelet_core import OptionError
from wavelet_gis.tiles.globe.quantized_mesh import geocentric
from wavelet_gis.tiles.globe.source import GlobePoints
from wavelet_gis.tiles.globe.tile_grid import POINTS_ACROSS, STEPS, tile_width
from wavelet_gis.tiles.globe.tile_mesh import EARTH_RADIUS

__all__ = ["ERROR_OF_SPACING", "TilesetPlan", "plan_tiles"]

#: Part of the spacing of the points that the finest zoom may be off, where nothing else is asked;
#: more where the steps of height are too large for so little.
ERROR_OF_SPACING = 0.1

#: Of a zoom's error, what chords of level ground may be below the round earth; a limit on the error
#: there, which no point of the input measures. Crops of two DEMs with level ground around them take
#: 55 to 60 % more vertices with half of it and 27 to 32 % fewer with twice as much.
_SHARE_OF_CHORDS = 0.4

_MOST_PARTS = 64
_SMALLEST_STEP = 2.0**-10

#: Steps of height from 0 that the format's single precision can count.
_MOST_STEPS = 1 << 24

_LARGEST_ZOOM = 22

#: Steps of height that an error must be, at least, so that rounding is a small part of it: a limit,
#: which refuses smaller errors and changes no tile.
_STEPS_OF_ERROR = 4


class TilesetPlan(NamedTuple):
    """What holds for all tiles.

    zoom : int, the finest
    max_error : float, metres, of the finest zoom
    height_step : float, metres, a power of two of which all heights are whole multiples
    fill : int, height of the ground beyond the data, in such steps
    """

    zoom: int
    max_error: float
    height_step: float
    fill: int

    @property
    def fill_height(self) -> float:
        """Height of the ground beyond the data, metres."""
        return self.fill * self.height_step

    def error_at(self, zoom: int) -> float:
        """Return the error that is promised for a zoom, metres."""
        return self.max_error * float(1 << (self.zoom - zoom))

    def n_parts(self) -> list[int]:
        """Return, by zoom, the parts that level ground is cut into along the side of a tile."""
        parts = []
        for zoom in range(self.zoom + 1):
            chord = math.sqrt(8 * _SHARE_OF_CHORDS * self.error_at(zoom) / EARTH_RADIUS)
            wanted = math.radians(tile_width(zoom)) / chord
            parts.append(min(1 << max(math.ceil(math.log2(wanted)), 0), _MOST_PARTS))
        for zoom in range(self.zoom - 1, -1, -1):  # every part's end is one of the next zoom, too
            parts[zoom] = min(parts[zoom], 2 * parts[zoom + 1])
        return parts


def plan_tiles(
    globe: GlobePoints, zoom: int | None, max_error: float | None, fill: float
) -> TilesetPlan:
    """Return what is to hold for the tiles of a TIN.

    Parameters
    ----------
    globe : GlobePoints
    zoom, max_error, fill
        See `wavelet_gis.tiles.globe.tileset.terrain_tiles`.

    Raises
    ------
    OptionError
        A zoom or an error that the format cannot hold.
    """
    if not math.isfinite(fill):
        raise OptionError("{0} is {given}; give a height.", "fill", given=fill)
    if max_error is not None and not math.isfinite(max_error):
        raise OptionError("{0} is {given}; give a distance.", "max_error", given=max_error)
    spacing = _spacing(globe)
    if zoom is None:
        wanted = math.log2(180.0 / (POINTS_ACROSS * math.degrees(spacing / EARTH_RADIUS)))
        zoom = min(max(round(wanted), 0), _LARGEST_ZOOM)
    if not 0 <= zoom <= _LARGEST_ZOOM:
        raise OptionError(
            "{0} is {zoom}; give 0 to {largest}.", "zoom", zoom=zoom, largest=_LARGEST_ZOOM
        )
    low, high = min(float(globe.height.min()), fill), max(float(globe.height.max()), fill)
    exponent = math.ceil(
        math.log2(
            max(
                (high - low) / (STEPS - 1),
                max(abs(low), abs(high)) / (_MOST_STEPS - 2 * STEPS),
                _SMALLEST_STEP,
            )
        )
    )
    step = 2.0**exponent
    least = _STEPS_OF_ERROR * step
    error = max(ERROR_OF_SPACING * spacing, least) if max_error is None else max_error
    if not error >= least:
        raise OptionError(
            "{0} is {error:.4g} m, and heights from {low:.5g} to {high:.5g} m are stored in steps "
            "of {step:.4g} m; give at least {least:.4g}.",
            "max_error",
            error=error,
            low=low,
            high=high,
            step=step,
            least=least,
        )
    return TilesetPlan(zoom, error, step, round(fill / step))


def _spacing(globe: GlobePoints) -> float:
    """Return the mean spacing of the points in metres."""
    places = geocentric(globe.longitude, globe.latitude, np.zeros(len(globe.longitude)))
    a, b, c = (places[globe.faces[:, k]] for k in range(3))
    area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2
    return math.sqrt(area / len(np.unique(globe.faces)))
