"""Breaklines and clip polygons made ready for a triangulation, with QGIS's geometry functions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from qgis.core import QgsGeometry, QgsWkbTypes

from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from .geometry import inside
from .vectors import features_in

if TYPE_CHECKING:
    from qgis.core import (
        QgsCoordinateReferenceSystem,
        QgsCoordinateTransformContext,
        QgsProcessingFeatureSource,
        QgsProcessingFeedback,
    )

    from wavelet_core.progress import Progress

#: z of a corner by its x and y.
Heights = dict[tuple[float, float], float]


class Constraints(NamedTuple):
    """What a triangulation must respect.

    breaklines : list of (n, 3) arrays; z is NaN where it is not known
    outline : list of (n, 3) arrays, the closed rings of the clip polygon; z is NaN
    clip : QgsGeometry or None
    """

    breaklines: list[NDArray[np.float64]]
    outline: list[NDArray[np.float64]]
    clip: QgsGeometry | None

    def contains(
        self, positions: NDArray[np.float64], progress: Progress | None = None
    ) -> NDArray[np.bool_]:
        """Return which of ``(m, 2)`` positions are inside the clip polygon.

        ``progress`` is called with a fraction in [0, 1]; the work stops when it returns False.
        """
        if self.clip is None:
            return np.ones(len(positions), dtype=bool)
        return inside(self.clip, positions, progress)

    def meets(self, positions: NDArray[np.float64]) -> bool:
        """Return whether a breakline reaches into the rectangle around positions."""
        low, high = positions[:, :2].min(axis=0), positions[:, :2].max(axis=0)
        return any(
            (line[:, :2].min(axis=0) <= high).all() and (line[:, :2].max(axis=0) >= low).all()
            for line in self.breaklines
        )


def read_constraints(
    breakline_source: QgsProcessingFeatureSource | None,
    clip_source: QgsProcessingFeatureSource | None,
    crs: QgsCoordinateReferenceSystem,
    transform_context: QgsCoordinateTransformContext,
    feedback: QgsProcessingFeedback,
) -> Constraints:
    """Return the lines of two sources in a CRS, cut where they cross.

    Parameters
    ----------
    breakline_source, clip_source : QgsProcessingFeatureSource or None
    crs : QgsCoordinateReferenceSystem
        In which they are wanted; layers in another are transformed.
    transform_context : QgsCoordinateTransformContext
    feedback : QgsProcessingFeedback
    """
    lines = _geometries(breakline_source, crs, transform_context, feedback)
    clip = None
    if clip_source is not None:
        clip = QgsGeometry.unaryUnion(_geometries(clip_source, crs, transform_context, feedback))
        if clip.isEmpty():
            raise QgsProcessingException(
                tr(
                    "{}: there is no polygon to clip by; check the layer, its filter and selection."
                ).format(clip_source.sourceName())
            )
    has_z = breakline_source is not None and QgsWkbTypes.hasZ(breakline_source.wkbType())
    heights = _heights(lines) if has_z else None
    noded = QgsGeometry.unaryUnion(lines) if lines else QgsGeometry()
    rings = _rings(clip)
    if clip is not None and lines:
        noded = QgsGeometry.unaryUnion([noded.intersection(clip), *rings])
        # Pieces of the rings were cut where lines meet them; the rest are breaklines.
        on_ring = QgsGeometry.unaryUnion(rings).buffer(1e-9 * _extent(clip), 1)
        pieces = [QgsGeometry(part.clone()) for part in noded.constParts()]
        breaklines = [piece for piece in pieces if not on_ring.contains(piece)]
        rings = [piece for piece in pieces if on_ring.contains(piece)]
    else:
        breaklines = [QgsGeometry(part.clone()) for part in noded.constParts()]
    if breakline_source is not None and not breaklines:
        feedback.pushWarning(
            tr("{}: there is no breakline here; the TIN is made without.").format(
                breakline_source.sourceName()
            )
        )
    return Constraints(
        [_array(line, heights) for line in breaklines],
        [_array(ring, heights if lines else None) for ring in rings],
        clip,
    )


def _geometries(
    source: QgsProcessingFeatureSource | None,
    crs: QgsCoordinateReferenceSystem,
    transform_context: QgsCoordinateTransformContext,
    feedback: QgsProcessingFeedback,
) -> list[QgsGeometry]:
    if source is None:
        return []
    features = features_in(source, crs, transform_context, feedback)
    return [QgsGeometry(feature.geometry()) for feature in features]


def _rings(clip: QgsGeometry | None) -> list[QgsGeometry]:
    if clip is None:
        return []
    rings = []
    part: Any  # of a polygon layer, a polygon
    for part in clip.constParts():
        curves = [part.exteriorRing()]
        curves += [part.interiorRing(k) for k in range(part.numInteriorRings())]
        rings += [QgsGeometry(curve.clone()) for curve in curves]
    return rings


def _heights(lines: list[QgsGeometry]) -> Heights:
    return {(p.x(), p.y()): p.z() for line in lines for p in line.vertices() if p.is3D()}


def _array(line: QgsGeometry, heights: Heights | None) -> NDArray[np.float64]:
    """Return the corners; z as the lines had it, between their corners as GEOS interpolated it."""
    rows = []
    for p in line.vertices():
        z = np.nan
        if heights is not None:
            z = heights.get((p.x(), p.y()), p.z() if p.is3D() else np.nan)
        rows.append((p.x(), p.y(), z))
    return np.array(rows, dtype=np.float64).reshape(len(rows), 3)


def _extent(geometry: QgsGeometry) -> float:
    box = geometry.boundingBox()
    return max(box.width(), box.height(), abs(box.xMaximum()), abs(box.yMaximum()))
