"""Ground points of a cloud: what does not stand above the lows around it, at any scale."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from .._validate import FloatArray
from ..errors import MeshError, OptionError
from ..progress import Progress, report
from ._lows import (
    LowGrid,
    at_points,
    filled_from_coarse,
    grid_of_lows,
    nearest_filled,
    opened,
    slope_of,
    steps_of_rims,
)

__all__ = ["HEIGHT_TOLERANCE", "LARGEST_OBJECT", "LEAST_SLOPE", "ground_points"]

#: Objects up to this width are taken off; metres.
LARGEST_OBJECT = 60.0
#: The ground may rise by so much everywhere: rise over run.
LEAST_SLOPE = 0.1
#: Points so far from the ground's surface are part of it; metres.
HEIGHT_TOLERANCE = 0.15

#: What stands up less than this is no object, whatever its size; metres.
LEAST_HEIGHT = 0.2
#: Distance over which the slope of the ground is taken, in metres.
SLOPE_DISTANCE = 10.0
#: Each scale is so many times the one before.
SCALE_STEP = 1.4
#: A lowest point so far below its neighbours, more by a cell's width, is a false one; metres.
PIT_DEPTH = 1.0
#: An area of this size whose rim has no steps is ground: a hill, a bank. Square metres; a step is
#: steeper than this rise over run; and so many of its sides may be steps.
LEAST_HILL, STEP_SLOPE, MOST_STEPS = 100.0, 0.8, 0.25


def ground_points(
    points: FloatArray,
    *,
    largest_object: float = LARGEST_OBJECT,
    least_slope: float = LEAST_SLOPE,
    height_tolerance: float = HEIGHT_TOLERANCE,
    progress: Progress | None = None,
) -> NDArray[np.bool_]:
    """Return which points of a cloud are ground, from their heights alone and without training.

    Parameters
    ----------
    points : (n_points, 3) float64
        x, y, z in metres.
    largest_object : float
        Width of the largest building, in metres. What is wider is taken for ground.
    least_slope : float
        Rise over run that the ground may have everywhere, also where all around is flat: larger
        values keep more banks and let more low things through.
    height_tolerance : float
        Points up to this far above or below the ground's surface are part of it, in metres; on
        slopes more, by half a cell's rise.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    (n_points,) bool

    Raises
    ------
    MeshError
        Fewer than three points, numbers that are not finite, or stray points far away.
    OptionError
        An option that is not above 0.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    **Our choice**, of the family of progressive morphological filters (K. Zhang et al., 2003; SMRF:
    Pingel et al., 2013):

    1. The lowest points on a grid of about one point a cell. Single lows far below all around
       them are left out.
    2. From fine to coarse, the highest surface below it that holds no object of a scale. What
       stands out at a scale *w* by *h* would need ground that rises by ``(h - 0.2 m) / w``; the
       largest such slope over all scales is kept for each cell.
    3. Cells where it is more than the slope of the ground around are objects. That slope is taken
       from a ground found with the least slope first, then from the ground that it gave: a filter
       for plains and mountains alike needs no slope as a parameter.
    4. Objects whose rim has no steps are hills and banks, and given back.
    5. The gaps are filled from coarse levels to fine ones; points near that surface are ground.

    On slopes, what is uphill hides a part of what stands there: a house of two storeys may stay
    where the ground rises by more than about 1 : 4.

    Examples
    --------
    >>> import numpy as np
    >>> x, y = np.meshgrid(np.arange(60.0), np.arange(60.0))
    >>> z = 0.1 * x
    >>> house = (abs(x - 30) < 6) & (abs(y - 25) < 8)
    >>> points = np.column_stack([x.ravel(), y.ravel(), (z + 5.0 * house).ravel()])
    >>> from wavelet_core import ground_points
    >>> bool((ground_points(points) == ~house.ravel()).all())
    True
    """
    for name, value in (
        ("largest_object", largest_object),
        ("least_slope", least_slope),
        ("height_tolerance", height_tolerance),
    ):
        if not (np.isfinite(value) and value > 0):
            raise OptionError("{0} is {value}; give a number above 0.", name, value=value)
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 3:
        raise MeshError(
            f"ground needs an array of at least three points, x, y and z; this is of shape "
            f"{points.shape}."
        )
    if not np.isfinite(points).all():
        where = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise MeshError(f"point {where} is {points[where]}, which is no place; leave it out.")
    grid = grid_of_lows(points)
    report(progress, 0.1)
    ground = _ground_surface(grid, largest_object, least_slope, progress)
    above = points[:, 2] - at_points(ground, grid)
    slope = at_points(slope_of(ground, grid.size), grid)
    report(progress, 1.0)
    is_ground: NDArray[np.bool_] = np.abs(above) <= height_tolerance + 0.5 * grid.size * slope
    return is_ground


def _ground_surface(
    grid: LowGrid, largest_object: float, least_slope: float, progress: Progress | None
) -> FloatArray:
    """Return the ground as a grid."""
    surface = nearest_filled(grid.low)
    around = ndimage.percentile_filter(surface, 25, size=3, mode="nearest")
    is_known = ~np.isnan(grid.low) & (around - surface <= PIT_DEPTH + grid.size)
    lows = np.where(is_known, grid.low, np.nan)
    surface = nearest_filled(lows)
    needed = _needed_slopes(surface, grid.size, largest_object, progress)
    slope = np.full(surface.shape, least_slope)
    reach = SLOPE_DISTANCE / grid.size
    for _ in range(2):
        is_object = _without_hills(needed > slope, surface, is_known, grid.size)
        ground = filled_from_coarse(np.where(is_object, np.nan, lows))
        smooth = ndimage.gaussian_filter(ground, max(reach, 1.0))
        around = ndimage.maximum_filter(
            slope_of(smooth, grid.size), size=2 * max(int(reach), 1) + 1
        )
        slope = np.maximum(around, least_slope)
        report(progress, 0.9)
    return ground


def _needed_slopes(
    surface: FloatArray, size: float, largest_object: float, progress: Progress | None
) -> FloatArray:
    """Return the slope that would explain what stands out at any scale, by cell."""
    needed = np.zeros_like(surface)
    radii = _radii(largest_object, size)
    for k, radius in enumerate(radii):
        report(progress, 0.1 + 0.7 * k / len(radii))
        lower = opened(surface, radius)
        np.maximum(needed, (surface - lower - LEAST_HEIGHT) / (radius * size), out=needed)
        surface = lower
    return needed


def _radii(largest_object: float, size: float) -> list[int]:
    """Return the scales as radii in cells, up to half the largest object."""
    last = max(int(np.ceil(0.5 * largest_object / size)), 1)
    n_steps = int(np.ceil(np.log(last) / np.log(SCALE_STEP)))
    return sorted({*(int(SCALE_STEP**k) for k in range(n_steps)), last})


def _without_hills(
    is_object: NDArray[np.bool_], surface: FloatArray, is_known: NDArray[np.bool_], size: float
) -> NDArray[np.bool_]:
    """Return the objects without the large ones that rise from the ground without a step."""
    labels, _ = ndimage.label(is_object)
    n_sides, n_steps = steps_of_rims(labels, surface, is_known, LEAST_HEIGHT + STEP_SLOPE * size)
    areas = np.bincount(labels.ravel(), minlength=len(n_sides)) * size**2
    is_hill = (areas >= LEAST_HILL) & (n_sides > 0) & (n_steps <= MOST_STEPS * n_sides)
    is_hill[0] = False
    result: NDArray[np.bool_] = is_object & ~is_hill[labels]
    return result
