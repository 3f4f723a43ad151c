"""A raster layer becomes a pyramid file."""

from __future__ import annotations

from qgis.core import (
    QgsProcessingException,
    QgsProcessingParameterBand,
    QgsProcessingParameterRasterLayer,
)

from ..design import vertical_unit
from ._analysis import AnalysisAlgorithm


class AnalyseDem(AnalysisAlgorithm):
    """DEM to pyramid."""

    def name(self):
        """Return the public id."""
        return "analysedem"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Analyse DEM")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr("dem,raster,tin,pyramid,wavelet,multiresolution,level of detail").split(",")

    def about(self):
        """Return what it does."""
        return self.tr(
            "Turns a DEM into a reversible wavelet pyramid: a coarse TIN and one layer of details "
            "for each level of resolution, in one GeoPackage. From it <i>Extract level</i> gives "
            "the terrain at any level and <i>Reconstruct</i> the DEM itself, bit for bit."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        self.add(
            QgsProcessingParameterRasterLayer("INPUT", self.tr("DEM")),
            self.tr(
                "Raster of elevations, in any CRS; degrees are worked on in a local metric frame. "
                "Cells without data become holes."
            ),
        )
        self.add(
            QgsProcessingParameterBand("BAND", self.tr("Band"), 1, "INPUT"),
            self.tr("Band with the elevations."),
        )
        self.add_analysis_parameters()

    def prepare(self, parameters, context, feedback):
        """Take from the layer, in its own thread, what reading it needs."""
        from ..rasters import RasterInput

        layer = self.parameterAsRasterLayer(parameters, "INPUT", context)
        if layer is None or not layer.isValid():
            raise QgsProcessingException(self.invalidRasterError(parameters, "INPUT"))
        self.raster = RasterInput.from_layer(
            layer, self.parameterAsInt(parameters, "BAND", context)
        )

    def terrain(self, parameters, context, feedback):
        """Return the terrain in the layer."""
        from wavelet_gis.terrain import terrain_of_dem

        from ..bridge import coordinate_system
        from ..rasters import read_dem

        feedback.setProgressText(self.tr("Reading the DEM"))
        return terrain_of_dem(
            self.raster.name,
            read_dem(self.raster, feedback),
            coordinate_system(self.raster.crs),
            vertical_unit(self, parameters, context) or self.raster.vertical_unit(),
        )
