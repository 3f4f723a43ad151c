"""Slope, aspect and curvatures of a level of a pyramid, as rasters."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from qgis.core import QgsProcessingParameterNumber, QgsProcessingParameterRasterDestination

from ..base import Values
from ..parameters.pyramid import checked_level, crs_of
from ..parameters.request import Request
from ..parameters.surface_output import add_cell_size_parameter
from ..ui.enums import WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.products.vertex_raster import Bands

    from ..qgis_io.background import Work

#: The band of `wavelet_gis.details` that each output is.
BANDS = {
    "SLOPE": "slope",
    "ASPECT": "aspect",
    "PROFILE_CURVATURE": "profile",
    "TANGENTIAL_CURVATURE": "tangential",
    "MEAN_CURVATURE": "mean",
}


class ShapeOfLevel(PyramidAlgorithm):
    """Pyramid to slope, aspect and curvature."""

    GROUP = "readoff"
    PAGE = "details"

    def name(self) -> str:
        """Return the public id."""
        return "shapeoflevel"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Slope, aspect and curvature of level")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("The shape of the terrain at the scale of one level of a pyramid, as rasters")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "slope,aspect,curvature,profile curvature,plan curvature,tangential,geomorphometry,"
            "terrain analysis,derivatives,scale,level,pyramid,wavelet"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "A landform has a size: the slope of a hill is not that of its furrows. This gives "
            "slope, aspect and curvature of the surface of one level, each as smooth as the level."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter("LEVEL")
        self.add(
            QgsProcessingParameterNumber("LEVEL", tr("Level"), WHOLE_NUMBER, None, True, 0),
            tr("0 is the coarsest. Empty for the input itself."),
        )
        add_cell_size_parameter(
            self,
            tr(
                "In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made "
                "from, and for points their mean spacing."
            ),
        )
        for name, description, text, is_made in (
            ("SLOPE", tr("Slope"), tr("Steepest, in degrees."), True),
            (
                "ASPECT",
                tr("Aspect"),
                tr("Direction of descent, degrees clockwise from north; nothing on the flat."),
                False,
            ),
            (
                "PROFILE_CURVATURE",
                tr("Profile curvature"),
                tr("Along the descent, in one over the unit of length; convex is above 0."),
                False,
            ),
            (
                "TANGENTIAL_CURVATURE",
                tr("Tangential curvature"),
                tr("Across the descent; spurs are above 0, hollows below."),
                False,
            ),
            (
                "MEAN_CURVATURE",
                tr("Mean curvature"),
                tr("Ridges and hilltops are above 0, channels and pits below."),
                False,
            ),
        ):
            self.add(
                QgsProcessingParameterRasterDestination(
                    name, description, optional=True, createByDefault=is_made
                ),
                text,
            )

    def work(self, request: Request) -> Values:
        """Measure the shape, write the rasters that were asked for."""
        from wavelet_gis.products.vertex_raster import Bands
        from wavelet_gis.workflows.details import details

        from ..qgis_io.raster_writer import write_bands
        from ..ui import layer_styles as styles

        wanted = [name for name in BANDS if request.wants(name)]
        if not wanted:
            raise QgsProcessingException(tr("No output is chosen; choose a raster."))
        geo = self.geo_pyramid(request)
        given = request.whole("LEVEL")
        level = checked_level(geo, geo.pyramid.n_levels if given is None else given)
        cell_size = request.size("CELL_SIZE")
        request.stage(tr("Measuring the shape of the surface"))

        def compute(work: Work) -> Bands:
            found = details(geo, what="shape", level=level)
            return found.raster(cell_size, work.progress)

        shape = request.computed(compute, 0.05, 0.7)
        request.figures = {"LEVEL": level}
        results: Values = {}
        for k, name in enumerate(wanted):
            band = shape.names.index(BANDS[name])
            alone = Bands(shape.values[band : band + 1], (BANDS[name],), shape.geometry)
            path = request.output_layer(name)
            start = 0.7 + 0.3 * k / len(wanted)
            report = request.progress(start, start + 0.3 / len(wanted))
            write_bands(path, alone, crs_of(geo), request.feedback, report)
            request.finish(name, path, partial(styles.style_shape, name=BANDS[name]))
            results[name] = path
        return results
