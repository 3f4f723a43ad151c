"""The parameters by which algorithms take a DEM, and its reading."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import QgsProcessingParameterBand, QgsProcessingParameterRasterLayer

from ..base import TerrainWaveletsAlgorithm
from ..parameters.analysis_options import vertical_unit
from ..parameters.request import Request
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr

if TYPE_CHECKING:
    from wavelet_gis.model.terrain import Terrain

    from ..qgis_io.raster_reader import RasterInput


class DemInput(TerrainWaveletsAlgorithm):
    """Base of the algorithms that start from a raster layer."""

    raster: RasterInput

    def add_dem_parameters(self) -> None:
        """Declare INPUT and BAND."""
        self.add(
            QgsProcessingParameterRasterLayer("INPUT", tr("DEM")),
            tr(
                "Raster of elevations, in any CRS; degrees are worked on in a local metric frame. "
                "Cells without data become holes."
            ),
        )
        self.add(
            QgsProcessingParameterBand("BAND", tr("Band"), 1, "INPUT"),
            tr("Band with the elevations."),
        )

    def take_layers(self, request: Request) -> None:
        """Take from the layer, in its own thread, what reading it needs."""
        from ..qgis_io.raster_reader import RasterInput

        layer = self.parameterAsRasterLayer(request.parameters, "INPUT", request.context)
        if layer is None or not layer.isValid():
            raise QgsProcessingException(self.invalidRasterError(request.parameters, "INPUT"))
        self.raster = RasterInput.from_layer(layer, request.whole("BAND") or 1)

    def terrain(self, request: Request) -> Terrain:
        """Return the terrain in the layer."""
        from wavelet_gis.model.terrain import terrain_of_dem

        from ..qgis_io.crs_and_progress import coordinate_system
        from ..qgis_io.raster_reader import read_dem

        request.stage(tr("Reading the DEM"))
        dem, system = read_dem(self.raster, request.feedback), coordinate_system(self.raster.crs)
        unit = vertical_unit(request) or self.raster.vertical_unit()
        return request.computed(
            lambda work: terrain_of_dem(self.raster.name, dem, system, unit), 0.0, 0.05
        )
