"""Breaklines and clip polygons made ready for a triangulation, with QGIS's geometry functions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from qgis.core import (
    QgsGeometry,
    QgsPoint,
    QgsProcessingException,
    QgsWkbTypes,
)

from ..ui.translation import tr
from .vectors import features_in


class Constraints(NamedTuple):
    """What a triangulation must respect.

    breaklines : list of (n, 3) arrays; z is NaN where it is not known
    outline : list of (n, 3) arrays, the closed rings of the clip polygon; z is NaN
    clip : QgsGeometry or None
    """

    breaklines: list
    outline: list
    clip: QgsGeometry | None

    def contains(self, positions) -> np.ndarray:
        """Return which of ``(m, 2)`` positions are inside the clip polygon."""
        if self.clip is None:
            return np.ones(len(positions), dtype=bool)
        engine = QgsGeometry.createGeometryEngine(self.clip.constGet())
        engine.prepareGeometry()
        return np.fromiter(
            (engine.contains(QgsPoint(x, y)) for x, y in positions.tolist()),
            dtype=bool,
            count=len(positions),
        )

    def meets(self, positions) -> bool:
        """Return whether a breakline reaches into the rectangle around positions."""
        low, high = positions[:, :2].min(axis=0), positions[:, :2].max(axis=0)
        return any(
            (line[:, :2].min(axis=0) <= high).all() and (line[:, :2].max(axis=0) >= low).all()
            for line in self.breaklines
        )


def read_constraints(
    breakline_source, clip_source, crs, transform_context, feedback
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
    heights = _heights(lines) if lines and QgsWkbTypes.hasZ(breakline_source.wkbType()) else None
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


def _geometries(source, crs, transform_context, feedback) -> list:
    if source is None:
        return []
    features = features_in(source, crs, transform_context, feedback)
    return [QgsGeometry(feature.geometry()) for feature in features]


def _rings(clip) -> list:
    if clip is None:
        return []
    rings = []
    for part in clip.constParts():
        curves = [part.exteriorRing()]
        curves += [part.interiorRing(k) for k in range(part.numInteriorRings())]
        rings += [QgsGeometry(curve.clone()) for curve in curves]
    return rings


def _heights(lines) -> dict:
    return {(p.x(), p.y()): p.z() for line in lines for p in line.vertices() if p.is3D()}


def _array(line, heights) -> np.ndarray:
    """Return the corners; z as the lines had it, between their corners as GEOS interpolated it."""
    rows = []
    for p in line.vertices():
        z = np.nan
        if heights is not None:
            z = heights.get((p.x(), p.y()), p.z() if p.is3D() else np.nan)
        rows.append((p.x(), p.y(), z))
    return np.array(rows, dtype=np.float64).reshape(len(rows), 3)


def _extent(geometry) -> float:
    box = geometry.boundingBox()
    return max(box.width(), box.height(), abs(box.xMaximum()), abs(box.yMaximum()))
