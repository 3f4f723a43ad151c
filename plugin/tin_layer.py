"""A level of a pyramid as a layer of triangles."""

from __future__ import annotations

from qgis.core import QgsField, QgsFields, QgsWkbTypes

from . import styles, vectors
from .field_types import DOUBLE, INTEGER


def fields(attribute_names) -> QgsFields:
    """Return the fields of a TIN layer: the face, its mean elevation, its mean attributes."""
    result = QgsFields()
    result.append(QgsField("face_id", INTEGER))
    result.append(QgsField("z", DOUBLE))
    for name in attribute_names:
        result.append(QgsField(name, DOUBLE))
    return result


def sink_of(algorithm, parameters, name, context, crs, attribute_names=()):
    """Return the sink of a TIN layer and its destination; both None where it is not wanted."""
    return algorithm.parameterAsSink(
        parameters,
        name,
        context,
        fields(attribute_names),
        QgsWkbTypes.Type.PolygonZ,
        crs,
    )


def add_mesh(sink, mesh, feedback) -> None:
    """Add the faces of a mesh, whose coordinates are those of the layer's CRS."""
    import numpy as np

    columns = [np.arange(mesh.n_faces), mesh.vertices[mesh.faces, 2].mean(axis=1)]
    columns += [mesh.attributes[mesh.faces, k].mean(axis=1) for k in range(mesh.attributes.shape[1])]
    vectors.add_triangles(
        sink, fields(mesh.attribute_names), mesh.vertices, mesh.faces, columns, feedback
    )


def add_level(sink, record, level: int, feedback) -> None:
    """Add the faces of a level of a record."""
    add_mesh(sink, record.file_mesh(record.pyramid.mesh(level)), feedback)


def style(context, destination) -> None:
    """Let the layer open with thin edges, coloured by elevation."""
    styles.style_output(context, destination, styles.TIN)
