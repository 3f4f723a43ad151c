"""What is known of a TIN that changes in place, so that only what is new is worked out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._validate import FloatArray, IntArray


class FaceErrors(NamedTuple):
    """Of each face: what its errors count for, the sum of squared height errors, their largest."""

    error: FloatArray
    squared_z: FloatArray
    largest: FloatArray


class Known(NamedTuple):
    """What is known of the TIN, and where it has changed since.

    errors : FaceErrors
    gains : (3 n_faces,) of turning each edge, by its lower half-edge; else 0
    has_new_error, has_new_edges : (n_faces,) bool, faces whose errors, and edges, are not known
    """

    errors: FaceErrors
    gains: FloatArray
    has_new_error: NDArray[np.bool_]
    has_new_edges: NDArray[np.bool_]

    @classmethod
    def nothing(cls, n_faces: int) -> Known:
        """Return that nothing is known."""
        return cls(
            FaceErrors(*(np.empty(n_faces) for _ in range(3))), np.zeros(3 * n_faces),
            np.ones(n_faces, dtype=bool), np.ones(n_faces, dtype=bool),
        )  # fmt: skip

    def change(self, faces: IntArray | NDArray[np.int32]) -> None:
        """Note that these faces are other ones now."""
        self.has_new_error[faces] = True
        self.has_new_edges[faces] = True
