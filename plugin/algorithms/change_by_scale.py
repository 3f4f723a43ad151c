"""What has changed since an earlier survey, taken apart by scale."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import (
    QgsProcessingOutputNumber,
    QgsProcessingParameterBand,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterRasterLayer,
)

from ..base import Values
from ..parameters.pyramid import crs_of, dem_beside
from ..parameters.request import Request
from ..parameters.surface_output import add_cell_size_parameter
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.products.vertex_raster import Bands
    from wavelet_gis.workflows.read_off.change import ChangeByScale as Result

    from ..qgis_io.background import Work
    from ..qgis_io.raster_reader import RasterInput


class ChangeByScale(PyramidAlgorithm):
    """Pyramid and an earlier DEM to a raster of changes, a band a scale."""

    raster: RasterInput

    GROUP = "readoff"

    def name(self) -> str:
        """Return the public id."""
        return "changebyscale"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Change by scale")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("How much terrain has risen since an earlier DEM, all of it and by scale")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "change,dod,dem of difference,erosion,deposition,scale,time,survey,pyramid,wavelet"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Takes an earlier DEM from the terrain of a pyramid, and the difference apart by "
            "scale: a landslide or a mound is in the coarse bands, ploughing and the noise of a "
            "survey in the fine ones. All bands add up to the change. Analyse the later survey "
            "with the partition <i>random</i> and the prediction <i>plane</i>, whose levels mean "
            "the same scale everywhere."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self.add(
            QgsProcessingParameterRasterLayer("EARLIER", tr("Earlier DEM")),
            tr("In the CRS of the pyramid, which is of the later survey; its cells may differ."),
        )
        self.add(
            QgsProcessingParameterBand("BAND", tr("Band"), 1, "EARLIER"),
            tr("Band with the elevations."),
        )
        add_cell_size_parameter(self)
        self.add(
            QgsProcessingParameterRasterDestination("OUTPUT", tr("Change by scale")),
            tr(
                "The first band is all of the change, in the unit of elevation: red is added, blue "
                "taken away. Then what is coarser than all levels, and a band for each scale."
            ),
        )
        for name, description in (
            ("MEAN", tr("Mean change, in the unit of elevation")),
            ("RMS", tr("Root mean square change, in the unit of elevation")),
            ("LOWEST", tr("Lowest change, in the unit of elevation")),
            ("HIGHEST", tr("Highest change, in the unit of elevation")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def take_layers(self, request: Request) -> None:
        """Take from the earlier DEM, in its own thread, what reading it needs."""
        from ..qgis_io.raster_reader import RasterInput

        layer = self.parameterAsRasterLayer(request.parameters, "EARLIER", request.context)
        if layer is None or not layer.isValid():
            raise QgsProcessingException(self.invalidRasterError(request.parameters, "EARLIER"))
        self.raster = RasterInput.from_layer(layer, request.whole("BAND") or 1)

    def work(self, request: Request) -> Values:
        """Subtract, take apart, write the raster."""
        from wavelet_gis.model.terrain import terrain_of_dem
        from wavelet_gis.workflows.read_off.change import change_by_scale

        from ..qgis_io.raster_writer import write_bands
        from ..ui import layer_styles as styles

        geo = self.geo_pyramid(request)
        dem = dem_beside(request, geo, self.raster)
        cell_size = request.size("CELL_SIZE")
        request.stage(tr("Taking the change apart"))

        def compute(work: Work) -> Result:
            earlier = terrain_of_dem(self.raster.name, dem, geo.system, geo.vertical_unit)
            return change_by_scale(geo, earlier, progress=work.progress)

        def drawn(work: Work) -> Bands:
            return found.raster(cell_size, work.progress)

        found = request.computed(compute, 0.3, 0.7)
        bands = request.computed(drawn, 0.7, 0.85)
        figures = found.figures()
        request.figures = {
            name.upper(): figures[name] for name in ("mean", "rms", "lowest", "highest")
        }
        for band in found.bands:
            request.say(
                tr("spacing {}: {} root mean square, {} to {}").format(
                    f"{band.spacing:.4g}",
                    f"{band.rms:.4g}",
                    f"{band.lowest:.4g}",
                    f"{band.highest:.4g}",
                )
            )
        path = request.output_layer("OUTPUT")
        report = request.progress(0.85, 1.0)
        write_bands(path, bands, crs_of(geo), request.feedback, report)
        request.finish("OUTPUT", path, styles.style_difference)
        return {**request.figures, "OUTPUT": path}
