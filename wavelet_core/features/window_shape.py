"""The shape of terrain over windows: a quadratic fitted to all that lies within a distance.

The surface of a level passes through single vertices, and so do the quadratics of
:mod:`wavelet_core.features.shape`. Those here are fitted to everything around a place, as raster
programs do in a moving window, on points as they lie.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._kernels._jit import run_in_ranges
from .._kernels.shape import fit_windows
from .._validate import FloatArray, distinct, frozen
from ..errors import OptionError
from ..lifting.pyramid import Pyramid
from ..lifting.spacings import level_spacings
from ..lifting.step import Step
from ..mesh.collapse import even_positions
from ..mesh.triangle_mesh import TriangleMesh
from ..progress import Progress, report
from .shape import SurfaceShape, surface_shape
from .spectrum import _sharing

__all__ = ["level_between", "window_shape"]

#: Radius of a window in ground distances, and its weights, which fall from the middle as
#: 1 - r². Their mean square distance is that of a square of 2.5 spacings, in cells of which the
#: published maps agree best with ours of a level (``benchmarks/features/maps.py``).
RADIUS = 1.75

#: Spacing of the level whose means are fitted, in ground distances. With a half the maps of two
#: pyramids differ two to four times as much; with two ninths curvature agrees with r.param.scale's
#: by 0.01 more, for two and a half times the means in a window and as many more windows.
MEANS_PART = 1.0 / 3.0

#: By how much windows grow that hold too little, and how often before the ring is fitted.
GROWTH, MAX_GROWTHS = 1.5, 3

#: Windows are found in squares at least this part of the extent wide, so that they can be counted.
LEAST_SQUARE = 1e-9

#: Places whose windows are looked for together.
PLACES_AT_ONCE = 1 << 18

_STOPPED = "the shape of the terrain was cancelled; nothing was kept."


@dataclass(frozen=True, slots=True)
class _Means:
    """What the vertices of a level stand for: ``(n, 3)``, ``(n, 3)`` and ``(n,)``."""

    places: FloatArray
    moments: FloatArray
    weights: FloatArray


def window_shape(
    pyramid: Pyramid, distance: float, *, at: int | None = None, progress: Progress | None = None
) -> SurfaceShape:
    r"""Return slope, aspect and curvatures over windows of a ground distance.

    Parameters
    ----------
    pyramid : Pyramid
        Of a partition whose levels are bands of sizes: random, with the prediction plane.
    distance : float
        In the unit of x and y: the spacing of a level (:func:`wavelet_core.level_spacings`), or any
        other. Windows are circles with 1.75 of it as radius, weighted by 1 - r², which are as wide
        as squares with sides of 2.5.
    at : int, optional
        Level at whose vertices the shape is wanted, by default the input. To interpolate it,
        :func:`level_between` is fine enough.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    SurfaceShape
        At the vertices of ``at``; NaN at those without faces.

    Raises
    ------
    OptionError
        A distance that is not above 0.
    PyramidError
        A level that the pyramid does not have.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    The quadratic :math:`c + p u + q v + \tfrac12 r u^2 + s u v + \tfrac12 t v^2` is fitted by
    weighted least squares to the means of the terrain around each vertex of a finer level: those
    of z to those of the six terms, all by area and gathered by the transposed predictions (as
    :func:`wavelet_core.local_means` are). So quadratics come out exactly on any mesh, though only
    a few dozen means are in a window of any size. Unlike :func:`surface_shape`, the quadratic need
    not pass through the vertex. *Our choice*: windows with fewer than nine means, or where they do
    not determine it, grow up to three times by a half; after that it is :func:`surface_shape`.

    References
    ----------
    J. Wood: The geomorphological characterisation of digital elevation models. PhD thesis,
    University of Leicester, 1996, chapter 4: quadratics over square windows of a raster.

    Examples
    --------
    >>> from wavelet_core import analyse, synthetic, window_shape
    >>> tilted = synthetic.plane(20, 30, slope=(0.0, -1.0))
    >>> pyramid = analyse(tilted, levels=5, partition="random", prediction="plane")
    >>> sorted(set(window_shape(pyramid, 4.0).slope.round(6).tolist()))
    [45.0]
    """
    at = pyramid.n_levels if at is None else at
    pyramid._require_level(at)
    finer = level_between(pyramid, distance)
    report(progress, 0.1, _STOPPED)
    points = pyramid.synthesise().vertices
    points = points - points.mean(axis=0) if len(points) else points
    means = _means(pyramid, points, finer)
    report(progress, 0.4, _STOPPED)
    mesh, radius = pyramid.mesh(at), RADIUS * distance
    fitted = np.full((mesh.n_vertices, 5), np.nan)
    left = distinct(mesh.faces)
    places = points[pyramid._ids_by_level(at)[at]]
    for growth in range(MAX_GROWTHS + 1):
        for first in range(0, len(left), PLACES_AT_ONCE):
            some = left[first : first + PLACES_AT_ONCE]
            fitted[some] = _fitted(places[some], means, radius * GROWTH**growth)
            share = (growth + (first + len(some)) / len(left)) / (MAX_GROWTHS + 1)
            report(progress, 0.4 + 0.5 * share, _STOPPED)
        left = left[np.isnan(fitted[left, 0])]
    if len(left):
        fitted[left] = _of_surface(mesh)[left]
    report(progress, 1.0, _STOPPED)
    return SurfaceShape(frozen(fitted[:, :2]), frozen(fitted[:, 2:]))


def level_between(pyramid: Pyramid, distance: float) -> int:
    """Return the level at whose vertices windows of a ground distance are well sampled.

    Parameters
    ----------
    pyramid : Pyramid
    distance : float
        In the unit of x and y.

    Returns
    -------
    int
        The one whose spacing is nearest to a third of the distance, by their ratio.

    Raises
    ------
    OptionError
        A distance that is not above 0.

    Examples
    --------
    >>> from wavelet_core import analyse, synthetic
    >>> from wavelet_core.features.window_shape import level_between
    >>> pyramid = analyse(synthetic.hills(30, 40), levels=8, partition="random")
    >>> level_between(pyramid, 1.0), level_between(pyramid, 60.0) < 8
    (8, True)
    """
    if not (np.isfinite(distance) and distance > 0):
        raise OptionError("{0} is {distance}; give one above 0.", "distance", distance=distance)
    spacings = level_spacings(pyramid)
    away = np.abs(np.log(spacings / (MEANS_PART * distance)))
    if np.isnan(away).all():
        return pyramid.n_levels
    return len(away) - 1 - int(np.nanargmin(away[::-1]))  # of equals the finest


def _of_surface(mesh: TriangleMesh) -> FloatArray:
    shape = surface_shape(mesh)
    return np.column_stack([shape.gradient, shape.hessian])


def _means(pyramid: Pyramid, points: FloatArray, level: int) -> _Means:
    """Return the means of x, y and z around the vertices of a level, and of xx, xy and yy.

    They are of the ground, not of the points: each counts with the area around it, or strips that
    were flown twice would count double (on a cloud, r.param.scale agrees by 0.82 to 0.90 instead of
    0.75 to 0.85).
    Sums are taken about each vertex's own place, or those of squares would lose half their digits.
    """
    ids = np.arange(len(points))
    weights = _areas(points[:, :2], pyramid.synthesise().faces)
    sums, squares = np.zeros((len(points), 3)), np.zeros((len(points), 3))
    for step in reversed(pyramid.steps[level:]):
        even = even_positions(step.odd, len(ids))
        offsets = points[ids]
        weights, sums, squares = _gathered(step, even, offsets, weights, sums, squares)
        ids = ids[even]
    stands = weights > 0
    weights, ids = weights[stands], ids[stands]
    mean = sums[stands] / weights[:, None]
    x, y = mean[:, 0], mean[:, 1]
    moments = squares[stands] / weights[:, None] - np.column_stack([x * x, x * y, y * y])
    return _Means(points[ids] + mean, moments, weights)


def _areas(plan: FloatArray, faces: NDArray[np.integer]) -> FloatArray:
    """Return the area in plan that is each vertex's own: on a grid that of a cell.

    Of a face each corner has what is nearest to it; of one with an obtuse angle that corner has
    half, and the others a quarter each (Meyer et al.). A third each would depend on the diagonals.
    """
    corners: FloatArray = plan[faces]
    sides = np.roll(corners, -1, axis=1) - np.roll(corners, 1, axis=1)  # opposite to each corner
    squared = (sides**2).sum(axis=2)
    others = squared.sum(axis=1)[:, None] - squared
    doubled = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])[:, None]
    # squared sides by the cotangents of the opposite angles, of the two other corners
    parts = squared * (others - squared)
    with np.errstate(divide="ignore", invalid="ignore"):
        own = (parts.sum(axis=1)[:, None] - parts) / (16.0 * doubled)
    is_obtuse = squared > others
    shared = np.where(is_obtuse, 0.25, 0.125) * doubled
    own = np.where(is_obtuse.any(axis=1)[:, None] | (doubled <= 0), shared, own)
    areas: FloatArray = np.bincount(faces.ravel(), own.ravel(), len(plan)).astype(np.float64)
    return areas


def _gathered(
    step: Step,
    even: NDArray[np.int32],
    places: FloatArray,
    weights: FloatArray,
    sums: FloatArray,
    squares: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Add to the even vertices what the odd ones stand for, as sums about the even ones' places."""
    sharing = _sharing(step, len(even))
    row = np.repeat(np.arange(step.n_odd), np.diff(sharing.indptr))
    odd, target, share = step.odd[row], sharing.indices, sharing.data
    d = places[odd] - places[even[target]]
    weight, own = weights[odd], sums[odd]

    def add(values: FloatArray, given: FloatArray) -> FloatArray:
        return values[even] + np.bincount(target, share * given, minlength=len(even))

    first = [add(sums[:, k], own[:, k] + d[:, k] * weight) for k in range(3)]
    second = [
        add(
            squares[:, k],
            squares[odd, k]
            + d[:, i] * own[:, j]
            + d[:, j] * own[:, i]
            + d[:, i] * d[:, j] * weight,
        )
        for k, (i, j) in enumerate(((0, 0), (0, 1), (1, 1)))
    ]
    return add(weights, weight), np.column_stack(first), np.column_stack(second)


def _fitted(places: FloatArray, means: _Means, radius: float) -> FloatArray:
    """Return z_x, z_y, z_xx, z_xy and z_yy over windows about places; NaN without enough means."""
    coefficients = np.full((len(places), 5), np.nan)
    if not (len(means.weights) and np.isfinite(radius) and radius > 0):
        return coefficients
    # squares by rows, so that the three next to each other in a row are one run
    low = means.places[:, :2].min(axis=0)
    extent = float((means.places[:, :2].max(axis=0) - low).max())
    side = max(radius, LEAST_SQUARE * extent)
    square = np.floor((means.places[:, :2] - low) / side).astype(np.int64)
    n_columns = int(square[:, 0].max()) + 4
    key = square[:, 1] * n_columns + square[:, 0]
    order = np.argsort(key, kind="stable")
    key = key[order]
    column, row = np.floor((places[:, :2] - low) / side).astype(np.int64).T
    column = np.clip(column, -2, n_columns - 2)  # farther away there are none
    middle = (row[:, None] + np.array([-1, 0, 1])) * n_columns + column[:, None]
    first = np.searchsorted(key, middle - 1, side="left")
    last = np.searchsorted(key, middle + 1, side="right")
    run_in_ranges(
        fit_windows,
        len(places),
        places,
        first,
        last,
        means.places[order],
        means.moments[order],
        means.weights[order],
        radius,
        coefficients,
    )
    return coefficients
