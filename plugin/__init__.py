"""The QGIS plugin: the only place that imports qgis or osgeo. It translates layers to arrays and back."""
