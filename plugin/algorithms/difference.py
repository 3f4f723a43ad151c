"""How far a level of a pyramid is above another level, or above a DEM."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import (
    QgsProcessingOutputNumber,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
    QgsProcessingParameterRasterLayer,
)

from ..base import Values
from ..parameters.pyramid import checked_level, crs_of, dem_beside
from ..parameters.request import Request
from ..parameters.surface_output import add_cell_size_parameter
from ..ui.enums import WHOLE_NUMBER
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.model.dem import Dem
    from wavelet_gis.workflows.read_off.difference import Difference as Result

    from ..qgis_io.background import Work
    from ..qgis_io.raster_reader import RasterInput


class Difference(PyramidAlgorithm):
    """Pyramid to a raster of differences."""

    raster: RasterInput | None

    GROUP = "readoff"

    def name(self) -> str:
        """Return the public id."""
        return "difference"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Difference of level")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("A level of a pyramid less another level, or less a DEM, as a raster")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "difference,dod,dem of difference,change,error,residual,compare,level,pyramid,wavelet"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Subtracts from the surface of one level that of another one, or a DEM: what a "
            "generalisation took away, or how a later survey differs at the scale of the level. "
            "Above 0 the level is the higher one."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter("LEVEL")
        self.add(
            QgsProcessingParameterNumber("LEVEL", tr("Level"), WHOLE_NUMBER, 0, minValue=0),
            tr("0 is the coarsest."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "LESS_LEVEL", tr("Level that is subtracted"), WHOLE_NUMBER, None, True, 0
            ),
            tr("Empty for the input itself, where there is no DEM either."),
        )
        self.add(
            QgsProcessingParameterRasterLayer(
                "LESS_DEM", tr("DEM that is subtracted"), optional=True
            ),
            tr("Instead of a level; in the CRS of the pyramid. The result is on its grid."),
        )
        add_cell_size_parameter(
            self,
            tr(
                "In the unit of the CRS, where no DEM is given. Empty for the grid of the DEM that "
                "the pyramid was made from, and for points their mean spacing."
            ),
        )
        self.add(
            QgsProcessingParameterRasterDestination("OUTPUT", tr("Difference of the surfaces")),
            tr("Level less the other, in the unit of elevation: red is added, blue taken away."),
        )
        for name, description in (
            ("MEAN", tr("Mean difference, in the unit of elevation")),
            ("RMS", tr("Root mean square difference, in the unit of elevation")),
            ("LOWEST", tr("Lowest difference, in the unit of elevation")),
            ("HIGHEST", tr("Highest difference, in the unit of elevation")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def refusal(self, request: Request) -> str | None:
        """Refuse two things to subtract, and a cell size beside a DEM."""
        if request.has("LESS_DEM") and request.has("LESS_LEVEL"):
            return tr("Give a level to subtract or a DEM, not both.")
        if request.has("LESS_DEM") and request.size("CELL_SIZE"):
            return tr("A DEM has its own cell size; leave the other one empty.")
        return super().refusal(request)

    def take_layers(self, request: Request) -> None:
        """Take from the DEM, in its own thread, what reading it needs."""
        from ..qgis_io.raster_reader import RasterInput

        layer = self.parameterAsRasterLayer(request.parameters, "LESS_DEM", request.context)
        self.raster = None if layer is None else RasterInput.from_layer(layer, 1)

    def work(self, request: Request) -> Values:
        """Subtract, write the raster."""
        from wavelet_gis.workflows.read_off.difference import difference

        from ..qgis_io.raster_writer import write_dem
        from ..ui import layer_styles as styles

        geo = self.geo_pyramid(request)
        level = checked_level(geo, request.whole("LEVEL") or 0)
        given = request.whole("LESS_LEVEL")
        less: int | Dem | None = None if given is None else checked_level(geo, given)
        if self.raster is not None:
            less = dem_beside(request, geo, self.raster)
        cell_size = request.size("CELL_SIZE")
        request.stage(tr("Subtracting the surfaces"))

        def compute(work: Work) -> Result:
            return difference(geo, level=level, less=less, cell_size=cell_size)

        found = request.computed(compute, 0.2, 0.8)
        figures = found.figures()
        request.figures = {
            name.upper(): figures[name] for name in ("mean", "rms", "lowest", "highest")
        }
        path = request.output_layer("OUTPUT")
        write_dem(path, found.dem, crs_of(geo), request.feedback, request.progress(0.8))
        request.finish("OUTPUT", path, styles.style_difference)
        return {**request.figures, "OUTPUT": path}
