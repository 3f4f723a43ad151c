"""The linear map of a pyramid, applied to columns other than those it was made from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .._validate import FloatArray
from ..mesh.collapse import even_positions
from .pyramid import Pyramid
from .step import split_integrals
from .update import UPDATES, apply_ring_means, update_filter


@dataclass(frozen=True, slots=True)
class LinearStep:
    """The filters of one step and where its vertices are.

    odd : (n_odd,) int32; even : (n_even,) int32; ids in the finer mesh
    prediction : (n_odd, n_even); update : (n_even, n_odd)
    locked : (n_even,) bool
    """

    odd: NDArray[np.int32]
    even: NDArray[np.int32]
    prediction: csr_array
    update: csr_array
    locked: NDArray[np.bool_]


def _nothing() -> None:
    """Do nothing."""


@dataclass(frozen=True, slots=True)
class Transform:
    """Analysis and synthesis of any columns with the filters of one pyramid.

    The filters are fixed once the pyramid is made, so the map from columns to coefficients is
    linear: noise, a probe or a first guess can be sent through it. Build it with
    :meth:`from_pyramid`.

    Attributes
    ----------
    steps : tuple of LinearStep
        ``steps[level]`` leads from level + 1 to level.
    is_sequential : bool
        Whether the update is the one-ring mean, applied vertex by vertex.
    tick : callable
        Called after every step that is taken; it may raise, to stop.
    """

    steps: tuple[LinearStep, ...]
    is_sequential: bool
    tick: Callable[[], None] = _nothing

    @classmethod
    def from_pyramid(cls, pyramid: Pyramid, tick: Callable[[], None] = _nothing) -> Transform:
        """Return the transform of a pyramid."""
        n_fine = pyramid.n_vertices(pyramid.n_levels)
        integrals = pyramid.integrals(pyramid.n_levels)
        locked = np.zeros(n_fine, dtype=bool) if pyramid.locked is None else pyramid.locked
        steps = []
        for step in reversed(pyramid.steps):
            even = even_positions(step.odd, len(integrals))
            prediction = step.prediction(len(even))
            odd_integrals, integrals = split_integrals(integrals, step.odd, even, prediction)
            locked = locked[even]
            update = update_filter(pyramid.update, prediction, odd_integrals, integrals, locked)
            steps.append(LinearStep(step.odd, even, prediction, update, locked))
            tick()
        return cls(tuple(reversed(steps)), UPDATES.find(pyramid.update).is_sequential, tick)

    def analyse(self, columns: FloatArray) -> tuple[FloatArray, list[FloatArray]]:
        """Return the coarse coefficients and the details of columns ``(n_vertices, k)``.

        Parameters
        ----------
        columns : ndarray, shape (n_vertices, k)
            One value for each vertex of the input.

        Returns
        -------
        coarse : ndarray, shape (n_coarse, k)
        details : list of ndarray, shape (n_odd, k)
            ``details[level]`` belongs to ``steps[level]``.
        """
        details = []
        for step in reversed(self.steps):
            coarse = columns[step.even]
            detail = columns[step.odd] - step.prediction @ coarse
            if self.is_sequential:
                columns = apply_ring_means(coarse, detail, step.prediction, step.locked)
            else:
                columns = coarse + step.update @ detail
            details.append(detail)
            self.tick()
        return columns, details[::-1]

    def synthesise(self, coarse: FloatArray, details: list[FloatArray]) -> FloatArray:
        """Return the columns on the finest level: the inverse of :meth:`analyse`."""
        for step, detail in zip(self.steps, details, strict=True):
            coarse = self._synthesise_step(step, coarse, detail)
        return coarse

    def synthesise_bands(self, details: Mapping[int, FloatArray]) -> FloatArray:
        """Return what the details of some levels alone, ``(n_odd, k)`` each, add to the finest."""
        lowest = min(details)
        columns = np.zeros((len(self.steps[lowest].even), details[lowest].shape[1]))
        for level in range(lowest, len(self.steps)):
            columns = self._synthesise_step(self.steps[level], columns, details.get(level))
        return columns

    def _synthesise_step(
        self, step: LinearStep, coarse: FloatArray, detail: FloatArray | None
    ) -> FloatArray:
        if self.is_sequential:
            if detail is None:
                detail = np.zeros((len(step.odd), coarse.shape[1]))
            coarse = apply_ring_means(coarse, detail, step.prediction, step.locked, undo=True)
        elif detail is not None:
            coarse = coarse - step.update @ detail
        fine = np.empty((len(step.odd) + len(step.even), coarse.shape[1]))
        fine[step.even] = coarse
        fine[step.odd] = step.prediction @ coarse
        if detail is not None:
            fine[step.odd] += detail
        self.tick()
        return fine
