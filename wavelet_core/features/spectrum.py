"""Vertex-frequency analysis: what every input vertex holds in each band of scales.

A band is a run of consecutive levels; here each is one level, the narrowest there is. Its details
are what the surface loses when its spacing grows from that of level l + 1 to that of level l. Each
detail belongs to one vertex and one band (section 3.3 of the paper); the functions here carry the
bands back to all input vertices, so that each of them has a whole spectrum.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .._validate import FloatArray, frozen
from ..errors import OptionError
from ..lifting.pyramid import Pyramid
from ..lifting.step import Step, synthesise_level
from ..mesh.collapse import even_positions
from ..progress import Progress, report

__all__ = [
    "STAYS",
    "Components",
    "VertexDetails",
    "band_components",
    "band_energies",
    "heights_above_lows",
    "vertex_details",
]

#: Level of the vertices that no step removed: those of the coarsest mesh.
STAYS = -1


@dataclass(frozen=True, slots=True)
class VertexDetails:
    """At which level every input vertex went, and what it took along.

    Attributes
    ----------
    level : ndarray of int32, shape (n_vertices,)
        The level whose detail layer holds the vertex, 0 to L - 1; ``STAYS`` for the vertices of
        the coarsest mesh.
    vectors : ndarray, shape (n_vertices, n_channels)
        Detail vectors, in the units of the input; NaN for vertices that stay.
    magnitude : ndarray, shape (n_vertices,)
        Euclidean norm of the vectors.
    """

    level: NDArray[np.int32]
    vectors: FloatArray
    magnitude: FloatArray


@dataclass(frozen=True, slots=True)
class Components:
    """One channel of the input as a sum: the smooth base and one component for each level.

    Attributes
    ----------
    base : ndarray, shape (n_vertices,)
        Level 0, interpolated to the input vertices by synthesis without details.
    bands : ndarray, shape (n_vertices, L)
        What the details of each level add. ``base + bands.sum(axis=1)`` is the input.
    """

    base: FloatArray
    bands: FloatArray

    def residual(self, level: int) -> FloatArray:
        """Return how far the input is above the surface of ``level``, ``(n_vertices,)``."""
        return self.bands[:, level:].sum(axis=1)


def vertex_details(pyramid: Pyramid) -> VertexDetails:
    """Return the level at which every input vertex went, and its detail vector.

    Parameters
    ----------
    pyramid : Pyramid

    Examples
    --------
    >>> from wavelet_core import analyse, synthetic
    >>> from wavelet_core.features.spectrum import STAYS, vertex_details
    >>> details = vertex_details(analyse(synthetic.hills(20, 30), levels=3))
    >>> sorted(set(details.level.tolist())) == [STAYS, 0, 1, 2]
    True
    """
    current = np.arange(pyramid.n_vertices(pyramid.n_levels))
    level_of_vertex = np.full(len(current), STAYS, dtype=np.int32)
    vectors = np.full((len(current), len(pyramid.channels)), np.nan)
    for level in range(pyramid.n_levels - 1, -1, -1):
        step = pyramid.steps[level]
        removed = current[step.odd]
        level_of_vertex[removed] = level
        vectors[removed] = step.details
        current = current[even_positions(step.odd, len(current))]
    magnitude = np.linalg.norm(vectors, axis=1)
    return VertexDetails(frozen(level_of_vertex), frozen(vectors), frozen(magnitude))


def band_energies(
    pyramid: Pyramid, channel: str | None = None, progress: Progress | None = None
) -> FloatArray:
    r"""Return the energy of every band around every input vertex.

    Parameters
    ----------
    pyramid : Pyramid
    channel : str, optional
        One of ``pyramid.channels``. By default the geometry: z, or with signal "xyz" the three
        coordinates together.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    ndarray, shape (n_vertices, L)
        Column l is the mean squared detail of level l in the neighbourhood that a vertex of level
        l stands for, in squared units of the channel. Its root is a height.

    Raises
    ------
    OptionError
        A channel that the pyramid does not have.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    The neighbourhoods are those that the transform itself uses (*our choice*; the paper shows the
    details at the removed vertices only). With P the prediction filter of the step, ζ the
    integrals of the scaling functions (Eq. 47) and w the details, the energy is gathered to the
    even vertices by the transposed filter, as the integrals are, and spread back up to the input
    by the predictions of all finer steps:

    .. math::
        e_l = \operatorname{diag}(\zeta_l)^{-1} P_l^T (\zeta_{l+1,o} \, w_l^2), \qquad
        E_l = R_{L-1} \dots R_l \, e_l

    where R copies even vertices and predicts odd ones. So a band's energy is only moved about:
    the sum of a column over the input vertices is the sum of ζ w² over the band's details; over the
    vertices of a pyramid that is a part of another, it is that sum weighted by their integrals. The
    cost is O(n L). Filters with negative weights (least squares, plane) take part with
    the absolute values of their weights, scaled to sum one, or energies could be negative.

    Examples
    --------
    >>> from wavelet_core import analyse, synthetic
    >>> from wavelet_core.features.spectrum import band_energies
    >>> energies = band_energies(analyse(synthetic.hills(20, 30), levels=3))
    >>> energies.shape, bool((energies >= 0).all())
    ((600, 3), True)
    """
    columns = _columns_of(pyramid, channel)
    # Where filters have negative weights, so may the vertices of a part; energies have none.
    finest = np.abs(pyramid.integrals(pyramid.n_levels))
    integrals = _integrals(pyramid, finest, _sharing)
    energies = np.empty((pyramid.n_vertices(0), 0))
    for level, (step, even, sharing) in enumerate(_steps_upwards(pyramid)):
        squared = (step.details[:, columns] ** 2).sum(axis=1)
        gathered = sharing.T @ (integrals[level + 1][step.odd] * squared)
        gathered = np.divide(
            gathered, integrals[level], out=np.zeros(len(even)), where=integrals[level] > 0
        )
        energies = _spread(np.column_stack([energies, gathered]), step, even, sharing)
        _report(progress, len(energies) / len(integrals[-1]))
    return energies


def band_components(
    pyramid: Pyramid, channel: str | None = None, progress: Progress | None = None
) -> Components:
    """Return a channel of the input as the sum of a base and of one component for each level.

    Parameters
    ----------
    pyramid : Pyramid
    channel : str, optional
        One of ``pyramid.channels``; z by default.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    Components
        Each band is the synthesis of the details of its level alone, so they are signed: a
        tree top is positive, the ground in a gap between trees negative.

    Raises
    ------
    OptionError
        A channel that the pyramid does not have.
    Cancelled
        ``progress`` returned False.

    Examples
    --------
    >>> import numpy as np
    >>> from wavelet_core import analyse, synthetic
    >>> from wavelet_core.features.spectrum import band_components
    >>> mesh = synthetic.hills(20, 30)
    >>> components = band_components(analyse(mesh, levels=3))
    >>> bool(np.allclose(components.base + components.bands.sum(axis=1), mesh.vertices[:, 2]))
    True
    """
    (column,) = _columns_of(pyramid, channel or "z")
    integrals = _integrals(pyramid, pyramid.integrals(pyramid.n_levels))
    locked = _locked_by_level(pyramid)
    parts = pyramid.coarse[:, [column]]
    for level, (step, even, _) in enumerate(_steps_upwards(pyramid)):
        details = np.zeros((step.n_odd, level + 2))
        details[:, -1] = step.details[:, column]
        parts = synthesise_level(
            np.column_stack([parts, np.zeros(len(parts))]),
            details,
            step.odd,
            even,
            step.prediction(len(even)),
            pyramid.update,
            integrals[level + 1],
            locked[level + 1],
        )
        _report(progress, len(parts) / len(integrals[-1]))
    return Components(frozen(parts[:, 0]), frozen(parts[:, 1:]))


def heights_above_lows(
    pyramid: Pyramid,
    levels: Sequence[int],
    channel: str | None = None,
    progress: Progress | None = None,
) -> FloatArray:
    """Return how far every input vertex is above the lowest of its neighbourhood, at each scale.

    Parameters
    ----------
    pyramid : Pyramid
    levels : sequence of int
        0 to L; the neighbourhoods are those that a vertex of the level stands for.
    channel : str, optional
        One of ``pyramid.channels``; z by default.
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    ndarray, shape (n_vertices, n_levels)
        In the unit of the channel. The ground is near 0 at all scales, a roof at those that are
        finer than the building.

    Raises
    ------
    OptionError
        A channel that the pyramid does not have.
    PyramidError
        A level that it does not have.
    Cancelled
        ``progress`` returned False.

    Notes
    -----
    An erosion through the prediction filters: going down, an even vertex takes the lowest value
    of itself and of the odd ones that it helps to predict; going up, odd vertices take the
    weighted mean of those lows.

    Examples
    --------
    >>> from wavelet_core import analyse, synthetic
    >>> from wavelet_core.features.spectrum import heights_above_lows
    >>> pyramid = analyse(synthetic.hills(20, 30), levels=4)
    >>> heights_above_lows(pyramid, [0, 4]).shape
    (600, 2)
    """
    (column,) = _columns_of(pyramid, channel or "z")
    for level in levels:
        pyramid._require_level(level)
    finest = _finest_column(pyramid, column)
    lows, by_level = finest, {pyramid.n_levels: finest}
    for level in range(pyramid.n_levels - 1, -1, -1):
        step = pyramid.steps[level]
        even = even_positions(step.odd, len(lows))
        lower = lows[even]
        takes = np.flatnonzero(step.weights != 0)
        rows = np.repeat(np.arange(step.n_odd), np.diff(step.indptr))[takes]
        np.minimum.at(lower, step.indices[takes], lows[step.odd][rows])
        lows = by_level[level] = lower
    wanted = np.asarray(levels, dtype=np.int64)
    surfaces = np.empty((len(lows), len(wanted)))
    surfaces[:, wanted == 0] = by_level[0][:, None]
    for level, (step, even, sharing) in enumerate(_steps_upwards(pyramid), start=1):
        surfaces = _spread(surfaces, step, even, sharing)
        surfaces[:, wanted == level] = by_level[level][:, None]
        _report(progress, len(surfaces) / len(finest))
    return finest[:, None] - surfaces


def _finest_column(pyramid: Pyramid, column: int) -> FloatArray:
    return pyramid.columns_of(pyramid.synthesise())[:, column]


def _columns_of(pyramid: Pyramid, channel: str | None) -> list[int]:
    if channel is None:
        return list(range(len(pyramid.coordinates)))
    if channel not in pyramid.channels:
        raise OptionError(
            "there is no {0} {given}; the pyramid has {channels}.",
            "channel",
            given=repr(channel),
            channels=", ".join(pyramid.channels),
        )
    return [pyramid.channels.index(channel)]


def _steps_upwards(pyramid: Pyramid) -> Iterator[tuple[Step, NDArray[np.int32], csr_array]]:
    """Yield each step, its even vertices and the filter by which energies are shared."""
    for level, step in enumerate(pyramid.steps):
        even = even_positions(step.odd, pyramid.n_vertices(level + 1))
        yield step, even, _sharing(step, len(even))


def _sharing(step: Step, n_even: int) -> csr_array:
    """Return the prediction with its negative weights turned round, rows of sum one."""
    if step.weights.size == 0 or step.weights.min() >= 0:
        return step.prediction(n_even)
    rows = np.repeat(np.arange(step.n_odd), np.diff(step.indptr))
    weights = np.abs(step.weights)
    weights = weights / np.bincount(rows, weights, minlength=step.n_odd)[rows]
    return csr_array((weights, step.indices, step.indptr), shape=(step.n_odd, n_even))


def _integrals(
    pyramid: Pyramid,
    finest: FloatArray,
    filter_of: Callable[[Step, int], csr_array] = Step.prediction,
) -> list[FloatArray]:
    """Return, for level 0 to L, what each vertex stands for of ``finest``, that of L (Eq. 47)."""
    by_level = [finest]
    for step in reversed(pyramid.steps):
        finer = by_level[-1]
        even = even_positions(step.odd, len(finer))
        by_level.append(finer[even] + filter_of(step, len(even)).T @ finer[step.odd])
    return by_level[::-1]


def _locked_by_level(pyramid: Pyramid) -> list[NDArray[np.bool_]]:
    n_vertices = pyramid.n_vertices(pyramid.n_levels)
    locked = np.zeros(n_vertices, bool) if pyramid.locked is None else pyramid.locked
    by_level = [locked]
    for step in reversed(pyramid.steps):
        by_level.append(by_level[-1][even_positions(step.odd, len(by_level[-1]))])
    return by_level[::-1]


def _spread(
    values: FloatArray, step: Step, even: NDArray[np.int32], sharing: csr_array
) -> FloatArray:
    """Return the values of a level at the vertices of the next finer one."""
    fine = np.empty((len(even) + step.n_odd, values.shape[1]))
    fine[even] = values
    fine[step.odd] = sharing @ values
    return fine


def _report(progress: Progress | None, fraction: float) -> None:
    report(progress, min(fraction, 1.0), "the spectrum was cancelled; nothing was kept.")
