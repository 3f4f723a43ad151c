"""Points in polygons, by QGIS's geometry engine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from qgis.core import QgsGeometry, QgsPoint


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
