"""A point cloud as it was named: a file, or a layer of the project with its filter."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsExpression,
    QgsExpressionContext,
    QgsExpressionContextUtils,
    QgsFeature,
    QgsField,
    QgsFields,
)

from ..ui.enums import INTEGER
from ..ui.translation import tr

if TYPE_CHECKING:
    from ..parameters.request import Request

#: The dimension of classes, as QGIS names it.
CLASSIFICATION = "Classification"
#: Files that are read.
SUFFIXES = (".las", ".laz")


class CloudSource(NamedTuple):
    """What is read.

    path : str
    crs : QgsCoordinateReferenceSystem, of the layer; invalid of a file
    classes : tuple of int or None, those that the layer's filter lets through; None without one
    layer : str, the name of the layer; "" of a file
    fault : str or None, why it cannot be read
    """

    path: str
    crs: QgsCoordinateReferenceSystem
    classes: tuple[int, ...] | None
    layer: str
    fault: str | None


def cloud_source(request: Request, name: str) -> CloudSource:
    """Return the cloud that a parameter names; call it in the thread that layers live in."""
    path, layer = request.input_file(name), request.input_cloud(name)
    if layer is None:
        fault = None
        if not os.path.isfile(path):
            fault = tr("{}: there is no such file; choose a point cloud.").format(path)
        return CloudSource(path, QgsCoordinateReferenceSystem(), None, "", fault)
    title, fault, classes = layer.name(), None, None
    if not (os.path.isfile(path) and path.lower().endswith(SUFFIXES)):
        fault = tr(
            "{}: this layer is of {}, and local LAS, LAZ and COPC files are what is read; export "
            "it as one."
        ).format(title, path)
    elif layer.subsetString():
        classes = classes_of(layer.subsetString())
        if classes is None:
            fault = tr(
                "{}: its filter, {}, asks for more than classes; export the layer, or filter by "
                "Classification alone."
            ).format(title, layer.subsetString())
        elif not classes:
            fault = tr("{}: its filter, {}, lets no class through; change it.").format(
                title, layer.subsetString()
            )
    return CloudSource(path, layer.crs(), classes, title, fault)


def classes_of(subset: str) -> tuple[int, ...] | None:
    """Return the classes that a filter lets through; None where it looks at something else.

    The filter is tried with each of the 256 classes, so it may be of any form.
    """
    expression = QgsExpression(subset)
    columns = {column.lower() for column in expression.referencedColumns()}
    if expression.hasParserError() or columns != {CLASSIFICATION.lower()}:
        return None
    fields = QgsFields()
    fields.append(QgsField(CLASSIFICATION, INTEGER))
    feature, context = QgsFeature(fields), QgsExpressionContext()
    context.appendScope(QgsExpressionContextUtils.globalScope())
    context.setFields(fields)
    found = []
    for number in range(256):
        feature.setAttributes([number])
        context.setFeature(feature)
        value = expression.evaluate(context)
        if expression.hasEvalError():
            return None
        if value:
            found.append(number)
    return tuple(found)
