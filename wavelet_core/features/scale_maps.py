"""Maps by ground distance: how rough terrain is, how far a place stands out, and at which scale.

What moving windows of growing size measure on rasters, measured on the surfaces and over the
neighbourhoods of a pyramid's levels: without a grid, on points as they lie.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray, frozen
from ..errors import OptionError
from ..lifting.pyramid import Pyramid
from ..lifting.spacings import level_spacings
from ..mesh.collapse import even_positions
from ..mesh.triangle_mesh import TriangleMesh
from ..progress import Progress, part_of, report
from .signature import joined_levels
from .spectrum import _integrals, _sharing, _spread, _steps_upwards

__all__ = [
    "ScaleMaps",
    "deviation_by_scale",
    "heights_above_means",
    "level_at_distance",
    "local_means",
    "roughness_by_scale",
]

#: Terrain whose heights differ less than this part of the largest deviation anywhere is flat:
#: what stands out of it is rounding.
FLAT_PART = 1e-6

#: Least upward part of a normal by which the gradient is taken: walls have none.
STEEPEST = 0.02

_STOPPED = "the maps of scales were cancelled; nothing was kept."


@dataclass(frozen=True, slots=True)
class ScaleMaps:
    """One measure of every vertex of the input at several scales.

    Attributes
    ----------
    levels : tuple of int
        Whose surfaces or neighbourhoods were taken, the coarsest first.
    distances : ndarray, shape (n_scales,)
        Their spacings (median edges in plan), in the unit of x and y.
    values : ndarray, shape (n_vertices, n_scales)
    """

    levels: tuple[int, ...]
    distances: FloatArray
    values: FloatArray

    @property
    def strongest(self) -> FloatArray:
        """The value of largest magnitude of each vertex, with its sign, ``(n_vertices,)``."""
        return np.take_along_axis(self.values, self._place[:, None], axis=1)[:, 0]

    @property
    def strongest_distance(self) -> FloatArray:
        """The distance at which it is found; NaN where all values are 0, ``(n_vertices,)``."""
        found = self.distances[self._place]
        return np.where(self.strongest == 0, np.nan, found)

    @property
    def _place(self) -> NDArray[np.intp]:
        finest_first = np.abs(self.values[:, ::-1])  # of equals the finest
        return self.values.shape[1] - 1 - np.argmax(finest_first, axis=1)


def level_at_distance(pyramid: Pyramid, distance: float) -> int:
    """Return the level whose spacing is nearest to a ground distance, by their ratio.

    Parameters
    ----------
    pyramid : Pyramid
    distance : float
        In the unit of x and y.

    Raises
    ------
    OptionError
        A distance that is not above 0, or outside what the levels span by more than the step
        from one to the next there.

    Examples
    --------
    >>> from wavelet_core import analyse, level_at_distance, synthetic
    >>> pyramid = analyse(synthetic.hills(30, 40, cell=10.0), levels=6, partition="random")
    >>> level_at_distance(pyramid, 10.0)
    6
    """
    if not (np.isfinite(distance) and distance > 0):
        raise OptionError("{0} is {distance}; give one above 0.", "distance", distance=distance)
    spacings = level_spacings(pyramid)
    away = np.abs(np.log(spacings / distance))
    least, most = float(np.nanmin(spacings)), float(np.nanmax(spacings))
    tolerance = most ** (1 / max(pyramid.n_levels, 1)) / least ** (1 / max(pyramid.n_levels, 1))
    if not least / tolerance <= distance <= most * tolerance:
        raise OptionError(
            "{0} is {distance:g}, but the levels' spacings are {least:.3g} to {most:.3g}; choose "
            "one between, or analyse with more levels.",
            "distance",
            distance=distance,
            least=least,
            most=most,
        )
    return int(np.nanargmin(away))


def local_means(
    pyramid: Pyramid, values: FloatArray, levels: Sequence[int], progress: Progress | None = None
) -> FloatArray:
    """Return the mean of values around every input vertex, over the neighbourhoods of levels.

    Parameters
    ----------
    pyramid : Pyramid
    values : ndarray, shape (n_vertices,) or (n_vertices, n_levels)
        At the vertices of the input; with two axes, a column for each of ``levels``.
    levels : sequence of int
        0 to L. The neighbourhoods are those that a vertex of the level stands for, as in
        :func:`wavelet_core.band_energies`.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    ndarray, shape (n_vertices, n_levels)

    Raises
    ------
    PyramidError
        A level that the pyramid does not have.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    A weighted mean with weights that are never negative: values times the integrals ζ (Eq. 47) are
    gathered to the even vertices by the transposed prediction, divided by the integrals there, and
    spread up again by the predictions. *Our choice*: filters with negative weights take part with
    their absolute values.

    Examples
    --------
    >>> from wavelet_core import analyse, synthetic
    >>> from wavelet_core.features.scale_maps import local_means
    >>> mesh = synthetic.hills(30, 40)
    >>> pyramid = analyse(mesh, levels=6, partition="random", prediction="plane")
    >>> means = local_means(pyramid, mesh.vertices[:, 2], [0, 6])
    >>> bool((means[:, 1] == mesh.vertices[:, 2]).all())
    True
    >>> bool(means[:, 0].std() < mesh.vertices[:, 2].std())
    True
    """
    for level in levels:
        pyramid._require_level(level)
    wanted = np.asarray(levels, dtype=np.int64)
    columns = np.broadcast_to(values.reshape(len(values), -1), (len(values), len(wanted)))
    finest = np.abs(pyramid.integrals(pyramid.n_levels))
    integrals = _integrals(pyramid, finest, _sharing)
    own = np.unique(wanted)[::-1]  # the finest first: what has come to its level stays there
    sums = columns * finest[:, None]
    by_level = {}
    for level in range(pyramid.n_levels, -1, -1):
        if level == pyramid.n_levels and level in own:
            by_level[level] = columns[:, wanted == level]  # divided again they would be rounded
        elif level in own:
            weight = integrals[level][:, None]
            gathered = sums[:, wanted == level]
            empty = np.zeros(gathered.shape)
            by_level[level] = np.divide(gathered, weight, out=empty, where=weight > 0)
        if level > own[-1]:
            step = pyramid.steps[level - 1]
            even = even_positions(step.odd, len(sums))
            sums = sums[even] + _sharing(step, len(even)).T @ sums[step.odd]
    means = np.empty((len(values), len(wanted)))
    for level, carried in _carried_up(pyramid, by_level, progress):
        means[:, wanted == level] = carried
    return means


def roughness_by_scale(pyramid: Pyramid, progress: Progress | None = None) -> ScaleMaps:
    r"""Return by how many degrees the terrain turns away from its smooth surface, by scale.

    Parameters
    ----------
    pyramid : Pyramid
        Of a partition whose levels are bands of sizes: random, with the prediction plane.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    ScaleMaps
        Degrees. ``strongest`` is the roughness at the scale where the terrain is roughest.

    Raises
    ------
    OptionError
        A pyramid without levels.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    The angle between the normals of the input and of the surface of level l, averaged over the
    neighbourhoods of level l: the multiscale roughness of Lindsay et al., with the surfaces and
    neighbourhoods of a pyramid for a mean filter's. Normals are means of the faces' by area, those
    of a level carried up to the input by the predictions. (Those of
    :func:`wavelet_core.surface_shape` differ more between two pyramids of the same terrain.) Levels
    are those at which the number of vertices halves
    (:func:`wavelet_core.joined_levels`).

    References
    ----------
    J. B. Lindsay, D. R. Newman, A. Francioni: Scale-optimized surface roughness for topographic
    analysis. Geosciences 9(7), 2019.

    Examples
    --------
    >>> from wavelet_core import analyse, roughness_by_scale, synthetic
    >>> tilted = synthetic.plane(slope=(0.5, 0.2))
    >>> pyramid = analyse(tilted, levels=5, partition="random", prediction="plane")
    >>> bool(roughness_by_scale(pyramid).values.max() < 1e-5)
    True
    """
    levels = _scales(pyramid)
    normals = _vertex_normals(pyramid.synthesise())
    angles = np.empty((len(normals), len(levels)))
    for level, smooth in _carried_normals(pyramid, levels, part_of(progress, 0.0, 0.6)):
        # by the chord: the arc cosine loses half the digits of small angles
        chord = np.linalg.norm(normals - _unit(smooth), axis=1)
        angles[:, levels.index(level)] = np.degrees(2 * np.arcsin(np.minimum(chord / 2, 1.0)))
    values = local_means(pyramid, angles, levels, part_of(progress, 0.6, 1.0))
    return ScaleMaps(levels, frozen(level_spacings(pyramid)[list(levels)]), frozen(values))


def heights_above_means(
    pyramid: Pyramid, levels: Sequence[int], progress: Progress | None = None
) -> FloatArray:
    r"""Return how far every input vertex is above the mean of its surroundings, by level.

    Parameters
    ----------
    pyramid : Pyramid
        Of a partition whose levels are bands of sizes: random, with the prediction plane.
    levels : sequence of int
        0 to L, each once; the surroundings are those that a vertex of the level stands for.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    ndarray, shape (n_vertices, n_levels)
        In the unit of z: residual topography, above 0 on ridges and below in valleys. 0 on a plane.

    Raises
    ------
    PyramidError
        A level that the pyramid does not have.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    :math:`z - \bar z - g \cdot (x - \bar x)`, with the means of height and place
    (:func:`local_means`) and the gradient g of the surface of the level. *Our choice* is the last
    term: the neighbourhoods, unlike windows, do not lie evenly about their vertex, and on a slope
    the mean height would be that of their middle. Whole components are
    :meth:`wavelet_core.Components.residual`, which is more uneven: it has all that single vertices
    were predicted wrongly.

    Examples
    --------
    >>> from wavelet_core import analyse, heights_above_means, synthetic
    >>> mesh = synthetic.hills(30, 40)
    >>> pyramid = analyse(mesh, levels=8, partition="random", prediction="plane")
    >>> above = heights_above_means(pyramid, [0])[:, 0]
    >>> bool(above[mesh.vertices[:, 2].argmax()] > 1)
    True
    """
    points = pyramid.synthesise().vertices
    points = points - points.mean(axis=0)
    offsets = []
    for axis in range(3):
        part = part_of(progress, 0.2 * axis, 0.2 * (axis + 1))
        means = local_means(pyramid, points[:, axis], levels, part)
        offsets.append(points[:, axis, None] - means)
    above = offsets[2]
    for level, normals in _carried_normals(pyramid, levels, part_of(progress, 0.6, 1.0)):
        k = list(levels).index(level)
        upward = np.maximum(normals[:, 2], STEEPEST)
        above[:, k] += (
            normals[:, 0] * offsets[0][:, k] + normals[:, 1] * offsets[1][:, k]
        ) / upward
    return above


def deviation_by_scale(pyramid: Pyramid, progress: Progress | None = None) -> ScaleMaps:
    r"""Return by how many standard deviations each vertex is above its surroundings, by scale.

    Parameters
    ----------
    pyramid : Pyramid
        Of a partition whose levels are bands of sizes: random, with the prediction plane.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    ScaleMaps
        Above 0 on ridges and hilltops, below in valleys; ``strongest_distance`` is the scale of
        maximum deviation.

    Raises
    ------
    OptionError
        A pyramid without levels.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    The height above the mean of the neighbourhood (:func:`heights_above_means`) over the standard
    deviation of the heights in it: the deviation from mean elevation, whose largest over window
    sizes Lindsay et al. map. 0 where the surroundings are flat.

    References
    ----------
    J. B. Lindsay, J. M. H. Cockburn, H. A. J. Russell: An integral image approach to performing
    multi-scale topographic position analysis. Geomorphology 245, 2015.

    Examples
    --------
    >>> from wavelet_core import analyse, deviation_by_scale, synthetic
    >>> mesh = synthetic.hills(30, 40)
    >>> pyramid = analyse(mesh, levels=8, partition="random", prediction="plane")
    >>> deviation = deviation_by_scale(pyramid).strongest
    >>> bool(deviation[mesh.vertices[:, 2].argmax()] > 1)
    True
    """
    levels = _scales(pyramid)
    heights = pyramid.synthesise().vertices[:, 2]
    heights = heights - heights.mean()
    above = heights_above_means(pyramid, levels, part_of(progress, 0.0, 0.7))
    means = local_means(pyramid, heights, levels, part_of(progress, 0.7, 0.85))
    squares = local_means(pyramid, heights**2, levels, part_of(progress, 0.85, 1.0))
    spread = np.sqrt(np.maximum(squares - means**2, 0.0))
    is_flat = spread <= FLAT_PART * np.abs(heights).max(initial=0.0)
    values = np.where(is_flat, 0.0, above / np.where(is_flat, 1.0, spread))
    return ScaleMaps(levels, frozen(level_spacings(pyramid)[list(levels)]), frozen(values))


def _scales(pyramid: Pyramid) -> tuple[int, ...]:
    """Return the levels whose maps are made, the coarsest first."""
    if pyramid.n_levels == 0:
        raise OptionError(
            "{0} has no levels, so there are no scales to compare; analyse with more levels.",
            "pyramid",
        )
    return tuple(first for first, _ in joined_levels(pyramid))


def _carried_normals(
    pyramid: Pyramid, levels: Sequence[int], progress: Progress | None
) -> list[tuple[int, FloatArray]]:
    """Return the normals of some levels at the input's vertices, not yet of length one."""
    by_level = {}
    for level, mesh in enumerate(pyramid):
        if level in levels:
            by_level[level] = _vertex_normals(mesh)
        report(progress, 0.5 * mesh.n_vertices / pyramid.n_vertices(pyramid.n_levels), _STOPPED)
    return _carried_up(pyramid, by_level, part_of(progress, 0.5, 1.0))


def _carried_up(
    pyramid: Pyramid, by_level: dict[int, FloatArray], progress: Progress | None
) -> list[tuple[int, FloatArray]]:
    """Return values at the vertices of some levels, carried up to the input by the predictions."""
    carried: list[tuple[int, FloatArray]] = []
    if 0 in by_level:
        carried.append((0, by_level[0]))
    for level, (step, even, sharing) in enumerate(_steps_upwards(pyramid), start=1):
        carried = [(own, _spread(values, step, even, sharing)) for own, values in carried]
        if level in by_level:
            carried.append((level, by_level[level]))
        report(progress, pyramid.n_vertices(level) / pyramid.n_vertices(pyramid.n_levels), _STOPPED)
    return carried


def _vertex_normals(mesh: TriangleMesh) -> FloatArray:
    """Return the normals at the vertices, means of the faces' by area; upward without a face."""
    corners: FloatArray = mesh.vertices[mesh.faces]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums: FloatArray = np.column_stack(
        [
            np.bincount(mesh.faces.ravel(), np.repeat(column, 3), mesh.n_vertices)
            for column in doubled.T
        ]
    )
    sums[~(np.linalg.norm(sums, axis=1) > 0)] = (0.0, 0.0, 1.0)
    return _unit(sums)


def _unit(vectors: FloatArray) -> FloatArray:
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]
