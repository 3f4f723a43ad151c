"""Points in polygons, by QGIS's geometry engine."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from qgis.core import QgsGeometry, QgsPoint

if TYPE_CHECKING:
    from wavelet_core.progress import Progress

#: Positions that are looked at between two reports: a list of millions would hold QGIS up.
BLOCK = 20_000


def rows_in(
    area: QgsGeometry, positions: NDArray[np.float64], progress: Progress | None = None
) -> NDArray[np.int64]:
    """Return which of ``(n, 2 or 3)`` positions are in an area or on its edge.

    ``progress`` is called with a fraction in [0, 1]; the work stops when it returns False.
    """
    engine = QgsGeometry.createGeometryEngine(area.constGet())
    if engine is None:  # there is no geometry
        return np.empty(0, dtype=np.int64)
    engine.prepareGeometry()
    box = area.boundingBox()
    x, y = positions[:, 0], positions[:, 1]
    is_near = (x >= box.xMinimum()) & (x <= box.xMaximum())
    is_near &= (y >= box.yMinimum()) & (y <= box.yMaximum())
    near = np.flatnonzero(is_near)
    return near[_answers(engine.intersects, positions[near, :2], progress)]


def inside(
    area: QgsGeometry, positions: NDArray[np.float64], progress: Progress | None = None
) -> NDArray[np.bool_]:
    """Return which of ``(n, 2)`` positions are inside an area.

    ``progress`` is called with a fraction in [0, 1]; the work stops when it returns False.
    """
    engine = QgsGeometry.createGeometryEngine(area.constGet())
    if engine is None:  # there is no geometry
        return np.zeros(len(positions), dtype=bool)
    engine.prepareGeometry()
    return _answers(engine.contains, positions, progress)


def _answers(
    ask: Callable[[QgsPoint], bool], positions: NDArray[np.float64], progress: Progress | None
) -> NDArray[np.bool_]:
    """Return what is answered for each of ``(n, 2)`` positions, a block at a time."""
    from wavelet_core.progress import report

    def answers() -> Iterator[bool]:
        for start in range(0, len(positions), BLOCK):
            report(progress, start / len(positions))
            for x, y in positions[start : start + BLOCK].tolist():
                yield ask(QgsPoint(x, y))

    return np.fromiter(answers(), dtype=bool, count=len(positions))
