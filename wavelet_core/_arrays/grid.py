"""Whole-array faces of a raster; see :mod:`wavelet_core._kernels.grid`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def _corners(ids, start, stop):
    """Return a, b, d, e of the squares of some rows."""
    lower, upper = ids[start:stop], ids[start + 1 : stop + 1]
    return lower[:, :-1], lower[:, 1:], upper[:, :-1], upper[:, 1:]


def count_grid_faces(start, stop, ids, counts):
    """Count the faces of each row of squares."""
    n_corners = sum((corner >= 0).astype(np.int64) for corner in _corners(ids, start, stop))
    counts[start:stop] = np.maximum(n_corners - 2, 0).sum(axis=1)


def fill_grid_faces(start, stop, ids, first, is_clockwise, faces: NDArray[np.int64]):
    """Write the faces of each row of squares."""
    for row in range(start, stop):  # the temporaries of one row stay in the cache
        a, b, d, e = (corner[0] for corner in _corners(ids, row, row + 1))
        one = np.column_stack([a, b, e])
        for is_gone, corners in ((b < 0, (a, e, d)), (e < 0, (a, b, d)), (a < 0, (b, e, d))):
            one[is_gone] = np.column_stack(corners)[is_gone]
        two = np.column_stack([a, e, d])
        keep = np.column_stack([(one >= 0).all(axis=1), (two >= 0).all(axis=1) & (b >= 0)])
        found = np.stack([one, two], axis=1)[keep]
        faces[first[row] : first[row + 1]] = found[:, ::-1] if is_clockwise else found
