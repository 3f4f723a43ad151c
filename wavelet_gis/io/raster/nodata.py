"""Numbers that stand for nothing though no tag says so."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.errors import RasterWarning
from wavelet_gis.notes import warn

__all__ = [
    "NO_ELEVATION",
    "NO_TAG",
    "doubtful_value",
    "implausible_cells",
    "impossible_values",
    "warn_of_doubts",
]

#: Given for a nodata value, it says that there is none.
NO_TAG = "none"

#: Floats from here on are no elevations in any unit; programs fill holes with them.
NO_ELEVATION = 1e30

#: What programs like to fill holes with, and what may also be an elevation.
_FILLERS = (-9999, -99999, -999, -32768, -32767, 0, 9999, 99999, 32767, 65535)

#: Beyond the height of any mountain and the depth of any sea, in any unit.
_BEYOND_THE_EARTH = 1e6


def impossible_values(values: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which stored numbers can be no elevations: floats of 1e30 and more, or less."""
    if values.dtype.kind != "f":
        return np.zeros(values.shape, dtype=bool)
    with np.errstate(invalid="ignore"):
        is_impossible: NDArray[np.bool_] = np.abs(values) >= NO_ELEVATION
    return is_impossible & np.isfinite(values)


def doubtful_value(values: NDArray[Any]) -> tuple[float, int, float] | None:
    """Return a value that may stand for nothing, how often it occurs, and the one next to it.

    Parameters
    ----------
    values : (n,) any real type
        The stored numbers of the cells with data.

    Returns
    -------
    tuple or None
        The lowest or highest number, when programs like to fill holes with it or the earth has
        no such height, and it is farther from the next one than all the others are apart.
    """
    if len(values) < 2:
        return None
    low, high = values.min(), values.max()
    for end, other in ((low, high), (high, low)):
        if float(end) not in _FILLERS and abs(float(end)) < _BEYOND_THE_EARTH:
            continue
        rest = values[values != end]
        if not len(rest):
            continue
        nearest = rest.min() if end == low else rest.max()
        gap, spread = abs(float(nearest) - float(end)), abs(float(other) - float(nearest))
        if gap > max(spread, 1.0) and gap > 50.0:
            return float(end), len(values) - len(rest), float(nearest)
    return None


def implausible_cells(
    values: NDArray[Any], valid: NDArray[np.bool_], name: str
) -> NDArray[np.bool_]:
    """Return which cells hold what cannot be an elevation but is not nodata yet, and warn of them.

    Parameters
    ----------
    values : ndarray
        The stored numbers.
    valid : ndarray of bool
        Cells with data.
    name : str
        Of the raster, for the warning.
    """
    holes = valid & impossible_values(values)
    if holes.any():
        found = sorted({float(value) for value in np.unique(values[holes])[:3]})
        warn(
            RasterWarning,
            "impossible_elevations",
            "{path}: {n_cells:,} cells hold {values}, which is no elevation; they are taken as "
            "nodata ({0} names another value, or {none})",
            "nodata",
            stacklevel=4,
            path=name,
            n_cells=int(np.count_nonzero(holes)),
            values=", ".join(f"{value:.8g}" for value in found),
            none=NO_TAG,
        )
    return holes


def warn_of_doubts(values: NDArray[Any], name: str) -> None:
    """Warn of a value that may stand for nothing.

    Parameters
    ----------
    values : (n,) any real type
        The stored numbers of the cells with data.
    name : str
        Of the raster.
    """
    doubt = doubtful_value(values)
    if doubt is None:
        return
    value, count, nearest = doubt
    warn(
        RasterWarning,
        "doubtful_elevations",
        "{path}: {n_cells:,} cells hold {value:.8g} and the next value is {nearest:.8g}; they are "
        "taken as elevations ({0} {value:.8g} makes them holes)",
        "nodata",
        stacklevel=4,
        path=name,
        n_cells=count,
        value=value,
        nearest=nearest,
    )
