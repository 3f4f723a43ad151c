"""Points in polygons, by QGIS's geometry engine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from qgis.core import QgsGeometry, QgsPoint


def rows_in(area: QgsGeometry, positions: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return which of ``(n, 2 or 3)`` positions are in an area or on its edge."""
    engine = QgsGeometry.createGeometryEngine(area.constGet())
    if engine is None:  # there is no geometry
        return np.empty(0, dtype=np.int64)
    engine.prepareGeometry()
    box = area.boundingBox()
    x, y = positions[:, 0], positions[:, 1]
    is_near = (x >= box.xMinimum()) & (x <= box.xMaximum())
    is_near &= (y >= box.yMinimum()) & (y <= box.yMaximum())
    near = np.flatnonzero(is_near)
    there = (engine.intersects(QgsPoint(*place)) for place in positions[near, :2].tolist())
    return near[np.fromiter(there, dtype=bool, count=len(near))]


def inside(area: QgsGeometry, positions: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which of ``(n, 2)`` positions are inside an area."""
    engine = QgsGeometry.createGeometryEngine(area.constGet())
    if engine is None:  # there is no geometry
        return np.zeros(len(positions), dtype=bool)
    engine.prepareGeometry()
    return np.fromiter(
        (engine.contains(QgsPoint(x, y)) for x, y in positions.tolist()),
        dtype=bool,
        count=len(positions),
    )
