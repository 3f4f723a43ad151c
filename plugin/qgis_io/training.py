"""Training areas of a polygon layer to labels of vertices."""

from __future__ import annotations

import numpy as np
from qgis.core import QgsGeometry, QgsPoint, QgsProcessingException

from ..ui.translation import tr
from .vectors import features_in

#: Label of vertices outside all areas.
NOT_KNOWN = -1


def labels_inside(source, field, positions, crs, transform_context, feedback) -> np.ndarray:
    """Return the class of the first polygon that each position is inside, or -1.

    Parameters
    ----------
    source : QgsProcessingFeatureSource
        Polygons, in any CRS.
    field : str
        Of whole numbers from 0 to 254.
    positions : ndarray, shape (n, 3)
        In ``crs``.
    crs : QgsCoordinateReferenceSystem
    transform_context : QgsCoordinateTransformContext
    feedback : QgsProcessingFeedback

    Raises
    ------
    QgsProcessingException
        A class that is no such number.
    """
    index = source.fields().lookupField(field)
    labels = np.full(len(positions), NOT_KNOWN, dtype=np.int64)
    x, y = positions[:, 0], positions[:, 1]
    for feature in features_in(source, crs, transform_context, feedback):
        label = _label(feature, index, field)
        geometry = QgsGeometry(feature.geometry())
        box = geometry.boundingBox()
        is_near = (x >= box.xMinimum()) & (x <= box.xMaximum())
        is_near &= (y >= box.yMinimum()) & (y <= box.yMaximum()) & (labels == NOT_KNOWN)
        engine = QgsGeometry.createGeometryEngine(geometry.constGet())
        engine.prepareGeometry()
        for k in np.flatnonzero(is_near).tolist():
            if engine.contains(QgsPoint(x[k], y[k])):
                labels[k] = label
    return labels


def _label(feature, index, field) -> int:
    value = feature.attributes()[index]
    try:
        label = int(value)
    except (TypeError, ValueError):
        label = -1
    if not 0 <= label <= 254 or label != value:
        raise QgsProcessingException(
            tr("Feature {}: field {} holds {}; classes are whole numbers from 0 to 254.").format(
                feature.id(), field, value
            )
        )
    return label
