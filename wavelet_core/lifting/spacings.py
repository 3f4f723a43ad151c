"""How far apart the vertices of each level are: the sizes that its details are of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._threads import run_in_blocks
from .._validate import FloatArray
from ..mesh.collapse import even_positions, merge_map, merged_faces
from ..mesh.triangle_mesh import TriangleMesh
from ..progress import Progress, report
from .pyramid import Pyramid


def level_spacings(pyramid: Pyramid, progress: Progress | None = None) -> FloatArray:
    """Return the median length, in plan, of the edges of every level, ``(L + 1,)``.

    Parameters
    ----------
    pyramid : Pyramid
    progress : callable, optional
        Called with a fraction in [0, 1]; the work stops when it returns False.

    Returns
    -------
    ndarray, shape (L + 1,)
        In the unit of x and y, level 0 first; NaN for a level without faces. The details of level
        l are at home at the spacing of level l + 1.

    Examples
    --------
    >>> from wavelet_core import analyse, level_spacings, synthetic
    >>> pyramid = analyse(synthetic.hills(20, 30, cell=10.0), levels=6, partition="quadric")
    >>> spacings = level_spacings(pyramid)
    >>> float(spacings[-1]), bool(spacings[0] > 15)
    (10.0, True)
    """
    if pyramid.horizontal is None:
        return np.array([mesh_spacing(mesh) for mesh in pyramid])
    # x and y do not change, so no level need be synthesised, and none but the present one kept
    spacings = np.empty(pyramid.n_levels + 1)
    plan, faces = pyramid.horizontal, pyramid.faces
    for level in range(pyramid.n_levels, -1, -1):
        spacings[level] = _spacing(plan, faces)
        if level > 0:
            step = pyramid.steps[level - 1]
            faces = merged_faces(faces, merge_map(step.odd, step.target, len(plan)))
            plan = plan[even_positions(step.odd, len(plan))]
        report(progress, 1.0 - len(plan) / len(pyramid.horizontal) if level else 1.0)
    return spacings


def mesh_spacing(mesh: TriangleMesh) -> float:
    """Return the median length, in plan, of the edges of a mesh; NaN without faces."""
    return _spacing(mesh.vertices[:, :2], mesh.faces)


def _spacing(plan: FloatArray, faces: NDArray[np.integer]) -> float:
    if not len(faces):
        return float("nan")
    lengths = np.empty((len(faces), 3))

    def measure(start: int, stop: int) -> None:
        corners = plan[faces[start:stop]]
        sides = corners - corners[:, [1, 2, 0]]
        np.hypot(sides[..., 0], sides[..., 1], out=lengths[start:stop])

    run_in_blocks(measure, len(faces))
    return float(np.median(lengths, overwrite_input=True))
