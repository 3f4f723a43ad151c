"""What an outline may lose: its vertices, while it stays within a tolerance, and its area."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._kernels.half_edges import HalfEdges
from .._kernels.metrics import sort_into_cells
from .._kernels.outline import Outline
from .._validate import FloatArray
from ..mesh.triangle_mesh import TriangleMesh

#: Vertices that a cell of the search grid holds on average.
VERTICES_PER_CELL = 2


def area_change(original: TriangleMesh, coarse: TriangleMesh) -> float:
    """Return by what the area in plan has grown, negative where it has shrunk.

    Parameters
    ----------
    original, coarse : TriangleMesh
        Such as the input of :func:`wavelet_core.analyse` and a level of its pyramid.

    Returns
    -------
    float
        In the square of the unit of x and y.

    Examples
    --------
    >>> from wavelet_core import analyse, synthetic
    >>> mesh = synthetic.hills(20, 30)
    >>> round(area_change(mesh, analyse(mesh, target_vertices=50).mesh(0)), 9)
    0.0
    """
    return float(coarse.plan_areas.sum() - original.plan_areas.sum())


def fixed_outline() -> Outline:
    """Return the rule of an outline that only goes where it runs straight."""
    none = np.empty(0, dtype=np.int32)
    return Outline(
        squared_tolerance=0.0,
        x=np.empty(0),
        y=np.empty(0),
        after=none,
        before=none,
        ids=none,
        lives=np.empty(0, dtype=bool),
        cells=np.empty(0),
        cell_indptr=np.empty(0, dtype=np.int64),
        cell_members=none,
    )


def tolerant_outline(
    tolerance: float, x: FloatArray, y: FloatArray, mesh: HalfEdges, n_fans: NDArray[np.int8]
) -> Outline:
    """Return the rule of an outline whose input vertices may lie so far from it.

    Parameters
    ----------
    tolerance : float
        In the unit of x and y.
    x, y : ndarray, shape (n_vertices,)
    mesh : HalfEdges
        The input.
    n_fans : ndarray of int8, shape (n_vertices,)
        Fans of faces around each vertex: none for a vertex without faces.
    """
    if tolerance <= 0.0:
        return fixed_outline()
    edges = np.flatnonzero(mesh.twin < 0)
    tail, head = mesh.origin[edges], mesh.origin[edges // 3 * 3 + (edges + 1) % 3]
    after = np.full(len(x), -1, dtype=np.int32)
    before = np.full(len(x), -1, dtype=np.int32)
    after[tail], before[head] = head, tail
    obstacles = np.flatnonzero((after >= 0) | (n_fans != 1)).astype(np.int32)
    low = np.array([x[obstacles].min(), y[obstacles].min()])
    extent = np.array([np.ptp(x[obstacles]), np.ptp(y[obstacles])])
    n_cells = max(len(obstacles) // VERTICES_PER_CELL, 1)
    size = max(float(np.sqrt(extent[0] * extent[1] / n_cells)), float(extent.max()) / n_cells)
    size = size or 1.0  # vertices without faces, all at one place
    n_columns, n_rows = (int(side / size) + 1 for side in extent)
    indptr = np.zeros(n_columns * n_rows + 1, dtype=np.int64)
    order = np.empty(len(obstacles), dtype=np.int64)
    plan = np.column_stack([x[obstacles], y[obstacles]])
    sort_into_cells(plan, low[0], low[1], size, n_columns, n_rows, indptr, order)
    return Outline(
        squared_tolerance=float(tolerance) * float(tolerance),  # inf where ** would overflow
        x=x,
        y=y,
        after=after,
        before=before,
        ids=np.arange(len(x), dtype=np.int32),
        lives=np.ones(len(x), dtype=bool),
        cells=np.array([low[0], low[1], size, n_columns, n_rows]),
        cell_indptr=indptr,
        cell_members=obstacles[order],
    )
