"""QGIS's enumerations, spelt so that Qt 5 and Qt 6, and every QGIS from 3.28 on, take them.

The stubs that mypy reads are those of the newest QGIS and know its own spellings alone; there, the
ones below are aliases that are added while ``qgis.core`` is imported.
"""

from __future__ import annotations

from typing import Any

from qgis.core import (
    Qgis,
    QgsColorRampShader,
    QgsCoordinateReferenceSystem,
    QgsProcessing,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterField,
    QgsProcessingParameterNumber,
    QgsProcessingUtils,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QMetaType, QVariant

_source: Any = QgsProcessing.SourceType
_flag: Any = QgsProcessingParameterDefinition.Flag
_number: Any = QgsProcessingParameterNumber.Type
_field: Any = QgsProcessingParameterField.DataType
_wkt: Any = QgsCoordinateReferenceSystem.WktVariant
_geometry: Any = QgsWkbTypes.GeometryType
_wkb: Any = QgsWkbTypes.Type
_shader: Any = QgsColorRampShader.Type

#: Kinds of layers that a parameter takes.
POINTS, LINES, POLYGONS = _source.TypeVectorPoint, _source.TypeVectorLine, _source.TypeVectorPolygon
TABLE = _source.TypeVector
RASTERS, FILES = _source.TypeRaster, _source.TypeFile

#: Folds a parameter away in the dialog.
ADVANCED = _flag.FlagAdvanced

#: Kinds of numbers that a parameter takes, and of fields.
WHOLE_NUMBER, REAL_NUMBER = _number.Integer, _number.Double
NUMERIC_FIELD, ANY_FIELD = _field.Numeric, _field.Any

#: A CRS as text that GDAL reads.
WKT_FOR_GDAL = _wkt.WKT_PREFERRED_GDAL

#: Geometry types.
POLYGON_GEOMETRY = _geometry.PolygonGeometry
POINT_Z, LINE_Z, POLYGON_Z = _wkb.PointZ, _wkb.LineStringZ, _wkb.PolygonZ
NO_GEOMETRY = _wkb.NoGeometry

#: What a file holds that is loaded as a layer.
MESH_LAYER = QgsProcessingUtils.LayerHint.Mesh

#: Colours between those that are given.
INTERPOLATED = _shader.Interpolated

#: Types of the fields of a layer.
INTEGER: Any
LONG_INTEGER: Any
DOUBLE: Any
if Qgis.versionInt() >= 33800:
    INTEGER, DOUBLE = QMetaType.Type.Int, QMetaType.Type.Double
    LONG_INTEGER = QMetaType.Type.LongLong
else:
    INTEGER, DOUBLE = QVariant.Int, QVariant.Double
    LONG_INTEGER = QVariant.LongLong
