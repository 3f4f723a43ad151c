"""What an error-guided analysis knows of each vertex and of each face of the present level."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray


class VertexState(NamedTuple):
    """One entry a slot; slots keep the order of the input, with gaps where vertices have gone.

    ids : int32, in the input
    lives : bool, whether the vertex belongs to the level
    locked : bool, whether its heights may not change
    stays : bool, whether it may not go whatever its cost
    integrals : float64, of its scaling function
    key : uint32, which of two vertices of equal cost comes first
    cost : float64, what its collapse adds to the errors; inf where none is legal
    target : int32, the slot that it would collapse onto; -1 where none is known
    is_stale : bool, whether cost and target must be worked out anew
    is_new : bool, whether its faces have changed since, not only their heights
    has_moved : bool, whether the moments of its star must be summed anew
    z_changed : bool, whether its height has changed since its faces were summed
    """

    ids: NDArray[np.int32]
    lives: NDArray[np.bool_]
    locked: NDArray[np.bool_]
    stays: NDArray[np.bool_]
    integrals: FloatArray
    key: NDArray[np.uint32]
    cost: FloatArray
    target: NDArray[np.int32]
    is_stale: NDArray[np.bool_]
    is_new: NDArray[np.bool_]
    has_moved: NDArray[np.bool_]
    z_changed: NDArray[np.bool_]

    @classmethod
    def of_input(cls, locked: NDArray[np.bool_], stays: NDArray[np.bool_]) -> VertexState:
        """Return the state before the first step."""
        n = len(locked)
        return cls(
            ids=np.arange(n, dtype=np.int32),
            lives=np.ones(n, dtype=bool),
            locked=locked,
            stays=stays,
            integrals=np.ones(n),
            key=scattered(n),
            cost=np.full(n, -np.inf),
            target=np.full(n, -1, dtype=np.int32),
            is_stale=np.ones(n, dtype=bool),
            is_new=np.ones(n, dtype=bool),
            has_moved=np.zeros(n, dtype=bool),
            z_changed=np.zeros(n, dtype=bool),
        )

    def copied(self) -> VertexState:
        """Return a copy that shares no array."""
        return VertexState._make(array.copy() for array in self)


class FaceState(NamedTuple):
    """One entry a face, with gaps.

    lives : bool, whether the face belongs to the level
    changed : bool, whether its corners or points have changed since it was summed
    squared : float64, sum of the squared errors of its points over all channels; with the two
        below it is empty where points are not kept
    squared_z : float64, the same of heights alone; empty where there is no other channel
    largest_z : float64, the largest squared height error
    """

    lives: NDArray[np.bool_]
    changed: NDArray[np.bool_]
    squared: FloatArray
    squared_z: FloatArray
    largest_z: FloatArray

    @classmethod
    def of_input(cls, n_faces: int, n_channels: int, *, with_errors: bool) -> FaceState:
        """Return the state before the first step; without room for errors where nobody asks."""
        n_measured = n_faces if with_errors else 0
        return cls(
            lives=np.ones(n_faces, dtype=bool),
            changed=np.zeros(n_faces, dtype=bool),
            squared=np.zeros(n_measured),
            squared_z=np.zeros(n_measured if n_channels > 1 else 0),
            largest_z=np.zeros(n_measured),
        )

    def copied(self) -> FaceState:
        """Return a copy that shares no array."""
        return FaceState._make(array.copy() for array in self)


def scattered(n_vertices: int) -> NDArray[np.uint32]:
    """Return a different number for each vertex, without order (a Weyl sequence, mixed)."""
    key = np.arange(n_vertices, dtype=np.uint32) * np.uint32(2654435761)
    return (key ^ (key >> np.uint32(15))) * np.uint32(2246822519)
