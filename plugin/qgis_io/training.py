"""Training areas of a polygon layer to labels of vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from qgis.core import QgsGeometry

from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from .geometry import inside
from .vectors import features_in

if TYPE_CHECKING:
    from qgis.core import (
        QgsCoordinateReferenceSystem,
        QgsCoordinateTransformContext,
        QgsFeature,
        QgsProcessingFeatureSource,
        QgsProcessingFeedback,
    )

#: Label of vertices outside all areas.
NOT_KNOWN = -1


def labels_inside(
    source: QgsProcessingFeatureSource,
    field: str,
    positions: NDArray[np.float64],
    crs: QgsCoordinateReferenceSystem,
    transform_context: QgsCoordinateTransformContext,
    feedback: QgsProcessingFeedback,
) -> NDArray[np.int64]:
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
        rows = np.flatnonzero(is_near)
        is_inside = inside(geometry, positions[rows, :2], lambda _: not feedback.isCanceled())
        labels[rows[is_inside]] = label
    return labels


def _label(feature: QgsFeature, index: int, field: str) -> int:
    value = feature.attributes()[index]
    try:
        label = int(value)
    except (TypeError, ValueError, OverflowError):  # NULL, a word, infinity
        label = -1
    if not 0 <= label <= 254 or label != value:
        raise QgsProcessingException(
            tr("Feature {}: field {} holds {}; classes are whole numbers from 0 to 254.").format(
                feature.id(), field, value
            )
        )
    return label
