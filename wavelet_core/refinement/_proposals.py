"""What may be done to a TIN that changes in place: found for all of it, then done where it pays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray, IntArray

IndexArray = NDArray[np.int32]


class Removals(NamedTuple):
    """Vertices that may go, onto which place of their ring, at what cost; most points of a star."""

    vertex: IndexArray
    target: IndexArray
    cost: FloatArray
    needs: IndexArray
    capacity: int


class Insertions(NamedTuple):
    """Points that may come, in which face or on which of its half-edges, how high, at what gain."""

    face: IndexArray
    point: IndexArray
    on_edge: IndexArray
    height: FloatArray
    gain: FloatArray


class Polygons(NamedTuple):
    """Vertices that may go, by which triangles in place of their stars, at what cost."""

    vertex: IndexArray
    corners: NDArray[np.int8]
    cost: FloatArray
    needs: IndexArray

    def rows(self, chosen: IntArray) -> Polygons:
        """Return some of them."""
        return Polygons._make(array[chosen] for array in self)
