"""Types of fields, spelt so that Qt 5 and Qt 6, and every QGIS from 3.28, take them."""

from __future__ import annotations

from qgis.core import Qgis
from qgis.PyQt.QtCore import QMetaType, QVariant

if Qgis.QGIS_VERSION_INT >= 33800:
    INTEGER, DOUBLE, STRING = QMetaType.Type.Int, QMetaType.Type.Double, QMetaType.Type.QString
else:
    INTEGER, DOUBLE, STRING = QVariant.Int, QVariant.Double, QVariant.String
