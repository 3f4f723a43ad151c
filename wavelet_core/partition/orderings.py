"""Odd or even: which vertices of a level go, and onto which neighbour (Algorithm 2)."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .._kernels.partition import label
from .._table import Table
from .._validate import FloatArray
from ..mesh.connectivity import Connectivity
from ..mesh.curvature import bending_energy
from ..mesh.quadric import build_quadrics, collapse_costs, redistribute_quadrics, vertex_costs
from ._mutable_level import SurfaceLevel

#: Share of the vertices whose bending energies count as different; the rest count as the highest.
ENERGY_QUANTILE = 0.99
#: Bending energies are compared in steps of this: the angles that they sum leave up to 1e-14 of a
#: plane, and faces that meet at 1e-6 have that energy.
ENERGY_STEP = 1e-12


class LevelView(NamedTuple):
    """What a partition may look at: one level of the mesh, before its vertices are labelled.

    faces : (n_faces, 3) int32
    points : (n_vertices, d) float64, normalised x, y, z and attributes
    plan : (n_vertices, 2) float64, x and y in the input's proportions
    connectivity : Connectivity
    locked : (n_vertices,) bool
    in_plan : bool, whether faces must stay upright in plan (signal "z")
    """

    faces: NDArray[np.int32]
    points: FloatArray
    plan: FloatArray
    connectivity: Connectivity
    locked: NDArray[np.bool_]
    in_plan: bool


class Split(NamedTuple):
    """Outcome of a partition: ids in the finer level, ``(n_odd,)`` int32, in removal order."""

    odd: NDArray[np.int32]
    target: NDArray[np.int32]


class Partition(Protocol):
    """A way of labelling that may carry state from level to level."""

    def split(self, view: LevelView, max_odd: int) -> Split:
        """Label the vertices of a level; at most ``max_odd`` become odd."""

    def descend(self, split: Split, even: NDArray[np.int32], prediction: csr_array) -> None:
        """Carry the state to the coarser level."""


class QuadricRule(NamedTuple):
    """What becomes of the quadrics from level to level: a row of :data:`QUADRICS`.

    name : str, what `analyse` takes
    help : str, one line for lists
    are_kept : bool, whether a level's quadrics come from those of the finer level
    """

    name: str
    help: str
    are_kept: bool


#: The paper's text and, as another reading of it, quadrics of the level's own faces.
QUADRICS = Table(
    "quadrics",
    (
        QuadricRule("redistributed", "built on the input, handed on (Eqs. 52-53)", True),
        QuadricRule("rebuilt", "built anew on every level", False),
    ),
)


class CostRule(NamedTuple):
    """By what vertices are ranked: a row of :data:`COSTS`.

    name : str, what `analyse` takes
    help : str, one line for lists
    costs : callable, from points, quadrics and connectivity to ``(n_vertices,)`` costs
    """

    name: str
    help: str
    costs: Callable[[FloatArray, FloatArray, Connectivity], FloatArray]


#: Eq. 36 and, as another reading, the error of the collapse itself.
COSTS = Table(
    "cost",
    (
        CostRule("ring", "the sum over the neighbours' quadrics (Eq. 36)", vertex_costs),
        CostRule("collapse", "the least of them, which is that of the collapse", collapse_costs),
    ),
)


class QuadricPartition:
    """The paper's partition: cheapest quadric and bending cost first (Algorithms 1 and 2).

    Parameters
    ----------
    bending_weight : float
        Weight of the bending energy against the normalised coordinates.
    quadrics : str
        A row of `QUADRICS`.
    cost : str
        A row of `COSTS`.

    Notes
    -----
    *Our choice:* the bending energy is heavy-tailed, so its square root is taken, divided by
    that of the input mesh's 99th percentile and cut at 1; the weight multiplies the result. The
    scale stays that of the input on all levels, since the quadrics carry it.
    """

    def __init__(
        self, bending_weight: float = 1.0, quadrics: str = "redistributed", cost: str = "ring"
    ) -> None:
        self._bending_weight = bending_weight
        self._keeps_quadrics = QUADRICS.find(quadrics).are_kept
        self._costs = COSTS.find(cost).costs
        self._energy_scale: float | None = None
        self._quadrics = np.empty((0, 0))

    def split(self, view: LevelView, max_odd: int) -> Split:
        """Label the vertices of a level in order of their cost; ties by index."""
        energy = bending_energy(view.points, view.faces, view.connectivity)
        points = np.column_stack([view.points, self._bending_coordinate(energy)])
        if not (self._keeps_quadrics and self._quadrics.size):
            self._quadrics = build_quadrics(points, view.faces, view.connectivity)
        cost = self._costs(points, self._quadrics, view.connectivity)
        order = np.argsort(cost, kind="stable")
        return _label(view, order, points, self._quadrics, max_odd)

    def descend(self, split: Split, even: NDArray[np.int32], prediction: csr_array) -> None:
        """Hand the quadrics of the odd vertices to their even neighbours (Eqs. 52-53)."""
        if not self._keeps_quadrics:
            return
        self._quadrics = redistribute_quadrics(self._quadrics, split.odd, even, prediction)

    def _bending_coordinate(self, energy: FloatArray) -> FloatArray:
        energy = np.rint(energy / ENERGY_STEP) * ENERGY_STEP
        if self._energy_scale is None:
            self._energy_scale = float(np.quantile(energy, ENERGY_QUANTILE))
        if self._energy_scale <= 0.0:
            return np.zeros(len(energy))
        return self._bending_weight * np.minimum(np.sqrt(energy / self._energy_scale), 1.0)


class ColouringPartition:
    """The graph-colouring baseline of Fig. 8: a maximal independent set in order of index.

    It looks at no cost at all; the hole is closed by the shortest legal collapse.
    """

    def split(self, view: LevelView, max_odd: int) -> Split:
        """Label the vertices of a level in order of their index."""
        order = np.arange(len(view.points))
        return _label(view, order, view.points, np.empty((0, 0)), max_odd)

    def descend(self, split: Split, even: NDArray[np.int32], prediction: csr_array) -> None:
        """Carry nothing."""


class RandomPartition:
    """A maximal independent set in random order: another one for every seed and level.

    Averaging over such pyramids is to meshes what cycle spinning is to images. With signal "z"
    it looks at x and y alone, so that the filters owe nothing to the noise in z; the hole is
    closed by the shortest legal collapse.

    Parameters
    ----------
    seed : int
        Of the order.
    """

    def __init__(self, seed: int = 0) -> None:
        self._generator = np.random.default_rng(seed)

    def split(self, view: LevelView, max_odd: int) -> Split:
        """Label the vertices of a level in random order."""
        order = self._generator.permutation(len(view.points))
        points = view.plan if view.in_plan else view.points
        return _label(view, order, points, np.empty((0, 0)), max_odd)

    def descend(self, split: Split, even: NDArray[np.int32], prediction: csr_array) -> None:
        """Carry nothing."""


class SurfacePartition:
    """The surface-guided partition for any filters: what raises the vertical errors least goes.

    It measures the errors of the input's own heights, as if nothing were updated, so that every
    pairing of filters can follow. :func:`~wavelet_core.partition.error_guided.analyse_surface`
    also ranks by what the update does, for the barycentric prediction.

    Parameters
    ----------
    level : SurfaceLevel
        The input, without update.
    norm : {"rms", "max"}
    removal_fraction : float
    """

    def __init__(self, level: SurfaceLevel, norm: str, removal_fraction: float) -> None:
        self._level = level
        self._norm = norm
        self._removal_fraction = removal_fraction

    def split(self, view: LevelView, max_odd: int) -> Split:
        """Label the vertices of a level, the cheapest first."""
        level = self._level
        while True:
            level.rank(self._norm, np.inf, np.inf)
            slots = level.candidates(self._removal_fraction, np.inf)
            odd = level.independent(slots, max_odd, np.inf)
            if len(odd) == 0:
                return Split(np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32))
            linked = level.linked(odd)
            if len(linked) > 0:
                step = level.remove(linked)
                return Split(step.odd, step.target)

    def descend(self, split: Split, even: NDArray[np.int32], prediction: csr_array) -> None:
        """Carry nothing: the level has been collapsed in place."""


def _label(
    view: LevelView,
    order: NDArray[np.int64],
    points: FloatArray,
    quadrics: FloatArray,
    max_odd: int,
) -> Split:
    n_vertices = len(points)
    connectivity = view.connectivity
    odd = np.empty(n_vertices, dtype=np.int32)
    target = np.empty(n_vertices, dtype=np.int32)
    n_odd = label(
        order,
        max_odd,
        view.in_plan,
        points,
        view.plan,
        view.faces,
        connectivity.star_indptr,
        connectivity.star,
        connectivity.ring,
        connectivity.ring_size,
        connectivity.kind,
        view.locked,
        quadrics,
        np.zeros(n_vertices, dtype=np.int8),
        odd,
        target,
    )
    return Split(odd[:n_odd].copy(), target[:n_odd].copy())
