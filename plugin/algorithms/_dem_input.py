"""The parameters by which algorithms take a DEM, and its reading."""

from __future__ import annotations

from qgis.core import (
    QgsProcessingException,
    QgsProcessingParameterBand,
    QgsProcessingParameterRasterLayer,
)

from ..parameters.analysis_options import vertical_unit


class DemInput:
    """Mixed into the algorithms that start from a raster layer."""

    def add_dem_parameters(self):
        """Declare INPUT and BAND."""
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

    def prepare(self, parameters, context, feedback):
        """Take from the layer, in its own thread, what reading it needs."""
        from ..qgis_io.raster_reader import RasterInput

        layer = self.parameterAsRasterLayer(parameters, "INPUT", context)
        if layer is None or not layer.isValid():
            raise QgsProcessingException(self.invalidRasterError(parameters, "INPUT"))
        self.raster = RasterInput.from_layer(
            layer, self.parameterAsInt(parameters, "BAND", context)
        )

    def terrain(self, parameters, context, feedback):
        """Return the terrain in the layer."""
        from wavelet_gis.model.terrain import terrain_of_dem

        from ..qgis_io.crs_and_progress import coordinate_system
        from ..qgis_io.raster_reader import read_dem

        feedback.setProgressText(self.tr("Reading the DEM"))
        return terrain_of_dem(
            self.raster.name,
            read_dem(self.raster, feedback),
            coordinate_system(self.raster.crs),
            vertical_unit(self, parameters, context) or self.raster.vertical_unit(),
        )
