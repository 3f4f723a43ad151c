"""Vector features to arrays and back, through QGIS sources and sinks."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from qgis.core import (
    QgsFeature,
    QgsFeatureRequest,
    QgsFeatureSink,
    QgsField,
    QgsFields,
    QgsGeometry,
    QgsWkbTypes,
)

from ..ui.enums import DOUBLE, INTEGER, LINE_Z, LONG_INTEGER, POINT_Z, POLYGON_Z
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from .crs_and_progress import require_running

if TYPE_CHECKING:
    from qgis.core import (
        QgsCoordinateReferenceSystem,
        QgsCoordinateTransformContext,
        QgsFeedback,
        QgsProcessingFeatureSource,
        QgsProcessingFeedback,
    )

    from wavelet_gis.products.layers import Layer

#: Features read or written between two looks at the cancel button.
CHUNK = 5_000
#: Part of the whole work by which an input is read.
READ_BY = 0.05


class Points(NamedTuple):
    """Points of a layer: xyz (n, 3), attributes (n, k), is_marked (n,) bool."""

    xyz: NDArray[np.float64]
    attributes: NDArray[np.float64]
    is_marked: NDArray[np.bool_]


def read_points(
    source: QgsProcessingFeatureSource,
    z_field: str | None,
    attribute_fields: Sequence[str],
    mark_field: str | None,
    feedback: QgsFeedback,
) -> Points:
    """Return the points of a source.

    Parameters
    ----------
    source : QgsProcessingFeatureSource
        Its selection or subset is respected.
    z_field : str or None
        Field with the elevation; None takes the geometry's Z.
    attribute_fields : sequence of str
        Numeric fields that become attributes.
    mark_field : str or None
        Field that marks a point (any value but 0, false and NULL).

    Raises
    ------
    QgsProcessingException
        A point without elevation, an attribute that is NULL or no number.
    """
    fields = source.fields()
    z_index = fields.lookupField(z_field) if z_field else -1
    attribute_indices = [fields.lookupField(name) for name in attribute_fields]
    mark_index = fields.lookupField(mark_field) if mark_field else -1
    if not z_field and not QgsWkbTypes.hasZ(source.wkbType()):
        raise QgsProcessingException(
            tr("{}: the points have no Z; choose the field with the elevation.").format(
                source.sourceName()
            )
        )
    # numbers side by side: of lists of millions, the copy alone would hold QGIS up for seconds
    xyz, attributes, marks = array("d"), array("d"), bytearray()
    for feature in _features(source, feedback):
        geometry = feature.geometry()
        values = feature.attributes()
        row = [_number(feature, values[k], fields[k].name()) for k in attribute_indices]
        is_marked = mark_index >= 0 and _is_true(values[mark_index])
        for point in geometry.vertices():
            z = _number(feature, values[z_index], z_field) if z_field else point.z()
            xyz.extend((point.x(), point.y(), z))
            attributes.extend(row)
            marks.append(is_marked)
    n = len(marks)
    return Points(
        np.array(xyz, dtype=np.float64).reshape(n, 3),
        np.array(attributes, dtype=np.float64).reshape(n, len(attribute_indices)),
        np.array(marks, dtype=bool),
    )


def read_triangles(
    source: QgsProcessingFeatureSource, feedback: QgsFeedback
) -> NDArray[np.float64]:
    """Return the corners of a layer of triangles, ``(n_faces, 3, 3)``: face, corner, x y z.

    Raises
    ------
    QgsProcessingException
        A polygon that is no triangle, or without Z.
    """
    if not QgsWkbTypes.hasZ(source.wkbType()):
        raise QgsProcessingException(
            tr(
                "{}: the triangles have no Z, so they hold no elevations; give a layer whose "
                "geometries have Z."
            ).format(source.sourceName())
        )
    corners = array("d")
    part: Any  # of a polygon layer, a polygon
    for feature in _features(source, feedback):
        for part in feature.geometry().constParts():
            ring = part.exteriorRing()
            if ring is None or ring.numPoints() != 4 or part.numInteriorRings():
                raise QgsProcessingException(
                    tr(
                        "{}: feature {} is no triangle; triangulate the layer first, or give a "
                        "point layer."
                    ).format(source.sourceName(), feature.id())
                )
            for point in ring.points()[:3]:
                corners.extend((point.x(), point.y(), point.z()))
    return np.array(corners, dtype=np.float64).reshape(-1, 3, 3)


def features_in(
    source: QgsProcessingFeatureSource,
    crs: QgsCoordinateReferenceSystem,
    transform_context: QgsCoordinateTransformContext,
    feedback: QgsProcessingFeedback,
) -> Iterator[QgsFeature]:
    """Yield the features of a source that have a geometry, in a CRS.

    Parameters
    ----------
    source : QgsProcessingFeatureSource
    crs : QgsCoordinateReferenceSystem
        That of the terrain. Where it or that of the source is missing, coordinates are taken as
        they are, with a warning.
    transform_context : QgsCoordinateTransformContext
    feedback : QgsProcessingFeedback
    """
    own, failed = source.sourceCrs(), list[int]()
    request = QgsFeatureRequest()
    if own.isValid() != crs.isValid():
        feedback.pushWarning(
            tr(
                "{}: of this layer and the terrain only one has a CRS, so their coordinates are "
                "taken to be alike (assign the CRS that is missing)"
            ).format(source.sourceName())
        )
    elif own != crs:
        request.setDestinationCrs(crs, transform_context)
        request.setTransformErrorCallback(lambda feature: failed.append(feature.id()))
    for feature in source.getFeatures(request):
        require_running(feedback)
        if not feature.hasGeometry():
            continue
        if feature.geometry().boundingBox().isFinite():
            yield feature
        else:
            failed.append(feature.id())
    if failed:
        feedback.pushWarning(
            tr(
                "{}: what cannot be brought into the CRS of the terrain is left out (features: "
                "{}); check the CRS of the layer"
            ).format(source.sourceName(), len(failed))
        )


def fields_of(layer: Layer) -> QgsFields:
    """Return the fields of a ``wavelet_gis.products.layers.Layer``."""
    fields = QgsFields()
    for name, column in layer.fields.items():
        fields.append(QgsField(name, _type_of(column)))
    return fields


def _type_of(column: NDArray[Any]) -> Any:
    """Return the type of a field: long where it must be, as for the points of large tile sets."""
    if column.dtype.kind == "f":
        return DOUBLE
    return LONG_INTEGER if column.max(initial=0) > np.iinfo(np.int32).max else INTEGER


def wkb_type_of(layer: Layer) -> Any:
    """Return the geometry type of a ``wavelet_gis.products.layers.Layer``."""
    return {"Point Z": POINT_Z, "LineString Z": LINE_Z, "Polygon Z": POLYGON_Z}[layer.geometry_type]


def add_layer(
    sink: QgsFeatureSink,
    layer: Layer,
    feedback: QgsFeedback,
    rows: NDArray[np.intp] | None = None,
    report: Callable[[float], bool] | None = None,
) -> int:
    """Add the features of a ``wavelet_gis.products.layers.Layer`` to a sink made with its fields.

    Parameters
    ----------
    sink : QgsFeatureSink
    layer : Layer
    feedback : QgsProcessingFeedback
    rows : array of int, optional
        Which of them; all by default.
    report : callable, optional
        Takes the fraction that is done.

    Returns
    -------
    int
        Number of features added.
    """
    fields = fields_of(layer)
    selected: Any = slice(None) if rows is None else rows
    geometries = layer.geometry[selected]
    columns = [_values(column[selected]) for column in layer.fields.values()]
    for start in range(0, len(geometries), CHUNK):
        require_running(feedback)
        if report is not None:
            report(start / len(geometries))
        features = []
        for k in range(start, min(start + CHUNK, len(geometries))):
            feature = QgsFeature(fields)
            geometry = QgsGeometry()
            geometry.fromWkb(geometries[k])
            feature.setGeometry(geometry)
            feature.setAttributes([column[k] for column in columns])
            features.append(feature)
        if not sink.addFeatures(features, QgsFeatureSink.Flag.FastInsert):
            raise QgsProcessingException(
                tr("The features could not be written ({}); check the disk and the name.").format(
                    sink.lastError()
                )
            )
    return len(geometries)


def _values(column: NDArray[Any]) -> list[Any]:
    """Return the values of a field, None for what is no number."""
    values: list[Any] = column.tolist()
    if column.dtype.kind != "f" or np.isfinite(column).all():
        return values
    return [None if value != value else value for value in values]


def _features(source: QgsProcessingFeatureSource, feedback: QgsFeedback) -> Iterator[QgsFeature]:
    """Yield the features of an input, which are read in the first part of the work."""
    feature: QgsFeature
    n_features = max(source.featureCount(), 1)
    for count, feature in enumerate(source.getFeatures()):
        if count % CHUNK == 0:
            feedback.setProgress(100.0 * READ_BY * min(count / n_features, 1.0))
            require_running(feedback)
        if feature.hasGeometry():
            yield feature


def number_of(feature: QgsFeature, name: str) -> float | None:
    """Return the number in a field of a feature; None where it is empty.

    Raises
    ------
    QgsProcessingException
        Something that is no number.
    """
    value = feature.attributes()[feature.fields().lookupField(name)]
    return None if _is_null(value) else _number(feature, value, name)


def _number(feature: QgsFeature, value: Any, name: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise QgsProcessingException(
            tr("Feature {}: field {} holds {}, which is no number; fill or filter it.").format(
                feature.id(), name, "NULL" if _is_null(value) else repr(value)
            )
        ) from error


def _is_null(value: Any) -> bool:
    return value is None or (hasattr(value, "isNull") and value.isNull())


def _is_true(value: Any) -> bool:
    return not _is_null(value) and bool(value) and str(value).strip().lower() not in ("0", "false")
