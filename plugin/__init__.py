"""The QGIS plugin, the only place that imports qgis or osgeo: layers to arrays and back."""
