"""The parameter by which algorithms take a pyramid, and its reading."""

from __future__ import annotations

import os

from qgis.core import QgsProcessingParameterFile

from ..base import TerrainWaveletsAlgorithm


class PyramidAlgorithm(TerrainWaveletsAlgorithm):
    """Base of the algorithms that read a pyramid file."""

    def add_pyramid_parameter(self):
        """Declare INPUT."""
        self.add(
            QgsProcessingParameterFile(
                "INPUT",
                self.tr("Pyramid"),
                extension="gpkg",
                fileFilter=self.tr("Pyramid (*.gpkg)"),
            ),
            self.tr("GeoPackage that one of the analyses made."),
        )

    def checkParameterValues(self, parameters, context):
        """Refuse a file that is not there before anything is started."""
        is_fine, message = super().checkParameterValues(parameters, context)
        if not is_fine:
            return is_fine, message
        path = self.pyramid_path(parameters, context)
        if not os.path.isfile(path):
            return False, self.tr("{}: there is no such file; choose a pyramid.").format(path)
        return True, ""

    def pyramid_path(self, parameters, context) -> str:
        """Return the path of the pyramid file, without the name of a layer in it."""
        return self.parameterAsString(parameters, "INPUT", context).split("|")[0]

    def geo_pyramid(self, parameters, context, feedback):
        """Return the ``GeoPyramid`` in the file."""
        from ..parameters.pyramid import load

        feedback.setProgressText(self.tr("Reading the pyramid"))
        geo = load(self.pyramid_path(parameters, context))
        for line in geo.history:
            feedback.pushInfo(self.tr("Changed since its analysis: {}").format(line))
        return geo
