"""The details of a pyramid's levels as a layer of points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import (
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
)

from ..base import Values
from ..parameters.pyramid import checked_level, crs_of
from ..parameters.request import Request
from ..parameters.surface_output import add_cell_size_parameter
from ..ui.enums import POINTS, REAL_NUMBER, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.workflows.details import Quantity


#: What each raster shows.
RASTERS: dict[str, Quantity] = {
    "ENERGY": "energy",
    "ROUGHNESS": "roughness",
    "DEVIATION": "deviation",
}


class DetailLayers(PyramidAlgorithm):
    """Pyramid to points with detail vectors."""

    GROUP = "details"
    PAGE = "details"

    def name(self) -> str:
        """Return the public id."""
        return "detaillayers"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Detail layers")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("The details (wavelet coefficients) of a pyramid as points, and their energy")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr("wavelet coefficients,detail,scale,vertex-frequency,points,pyramid").split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Shows at which scale the terrain has its detail: a point for every vertex that the "
            "analysis removed, with the level at which it went and its detail vector (the wavelet "
            "coefficients). Points are coloured by level and sized by magnitude, as in Fig. 10b "
            "of the paper. Level 0 is the coarsest. For scales that mean the same everywhere, "
            "analyse with the partition <i>random</i> and the prediction <i>plane</i>; the default "
            "partition takes detail out where it matters least first."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self.add(
            QgsProcessingParameterNumber(
                "FIRST_LEVEL", tr("Coarsest level"), WHOLE_NUMBER, 0, minValue=0
            ),
            tr("Details of this level and finer ones."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "LAST_LEVEL", tr("Finest level"), WHOLE_NUMBER, None, optional=True, minValue=0
            ),
            tr("Details of this level and coarser ones; empty for all."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "MIN_MAGNITUDE", tr("Smallest magnitude"), REAL_NUMBER, 0.0, minValue=0.0
            ),
            tr(
                "Leave out points whose detail vector is shorter (in the unit of elevation where "
                "elevation alone is lifted)."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFeatureSink("OUTPUT", tr("Details by level"), POINTS),
            tr(
                "Fields: <i>vertex_id</i> in the input, <i>level</i>, <i>w_…</i> the detail of a "
                "channel, <i>magnitude</i> the length of the detail vector."
            ),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "ENERGY", tr("Energy by level"), optional=True, createByDefault=False
            ),
            tr(
                "A raster with one band for each level: the root mean square detail around each "
                "place, in the unit of elevation. It maps at which scale the terrain is rough."
            ),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "ROUGHNESS", tr("Roughness by scale"), optional=True, createByDefault=False
            ),
            tr(
                "Degrees between the surface and the smooth one of a scale, averaged over its "
                "neighbourhoods. The first band is the largest of all scales, the second the "
                "distance on the ground at which it is found; then a band for each scale."
            ),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "DEVIATION", tr("Deviation by scale"), optional=True, createByDefault=False
            ),
            tr(
                "Height above the surroundings in their standard deviations: above 0 on ridges, "
                "below in valleys. The first band is the strongest of all scales, the second the "
                "distance on the ground at which it is found; then a band for each scale."
            ),
        )
        add_cell_size_parameter(self)
        self.addOutput(QgsProcessingOutputNumber("N_DETAILS", tr("Number of points")))
        self.addOutput(QgsProcessingOutputNumber("MAX_MAGNITUDE", tr("Largest magnitude")))

    def work(self, request: Request) -> Values:
        """Walk the levels from coarse to fine and add their points."""
        import numpy as np

        from wavelet_gis.products.layers import detail_layers

        from ..qgis_io import vectors
        from ..qgis_io.crs_and_progress import require_running
        from ..ui import layer_styles as styles

        geo = self.geo_pyramid(request)
        first, last = _levels(request, geo)
        smallest = request.number("MIN_MAGNITUDE") or 0.0
        sink, destination = None, ""
        n_details, largest = 0, 0.0
        for level, layer in enumerate(detail_layers(geo)):
            require_running(request.feedback)
            if sink is None:  # all levels have the same fields
                sink, destination = self.parameterAsSink(
                    request.parameters,
                    "OUTPUT",
                    request.context,
                    vectors.fields_of(layer),
                    vectors.wkb_type_of(layer),
                    crs_of(geo),
                )
                if sink is None:
                    raise QgsProcessingException(
                        self.invalidSinkError(request.parameters, "OUTPUT")
                    )
            if level > last:
                break
            if level < first:
                continue
            magnitude = layer.fields["magnitude"]
            rows = np.flatnonzero(magnitude >= smallest)
            n_levels = last - first + 1
            report = request.progress(
                0.05 + 0.55 * (level - first) / n_levels,
                0.05 + 0.55 * (level - first + 1) / n_levels,
            )
            n_details += vectors.add_layer(sink, layer, request.feedback, rows, report)
            largest = max(largest, float(magnitude.max(initial=0.0)))
        request.finish("OUTPUT", destination, styles.style_details)
        results = {"OUTPUT": destination, "N_DETAILS": n_details, "MAX_MAGNITUDE": largest}
        wanted = [name for name in RASTERS if request.wants(name)]
        for k, name in enumerate(wanted):
            share = 0.4 / len(wanted)
            results[name] = _write_raster(request, geo, name, 0.6 + k * share, share)
        return results


def _levels(request: Request, geo: GeoPyramid) -> tuple[int, int]:
    """Return the coarsest and the finest level whose details are shown."""
    n_levels = geo.pyramid.n_levels
    if n_levels == 0:
        raise QgsProcessingException(tr("This pyramid has no level, so it has no details."))
    first = checked_level(geo, request.whole("FIRST_LEVEL") or 0)
    wanted = request.whole("LAST_LEVEL")
    last = n_levels - 1 if wanted is None else min(wanted, n_levels - 1)
    if first > last:
        raise QgsProcessingException(
            tr("The coarsest level, {}, is finer than the finest, {}; exchange them.").format(
                first, last
            )
        )
    return first, last


def _write_raster(request: Request, geo: GeoPyramid, name: str, start: float, share: float) -> str:
    """Write one of ``RASTERS``; return where it is."""
    from wavelet_gis.workflows.details import details

    from ..qgis_io.raster_writer import write_bands
    from ..ui import layer_styles as styles

    path = request.output_layer(name)
    request.stage(tr("Gathering the scales"))
    cell_size, middle = request.size("CELL_SIZE"), start + 0.75 * share
    found = details(geo, what=RASTERS[name])
    bands = request.computed(lambda work: found.raster(cell_size, work.progress), start, middle)
    report = request.progress(middle, start + share)
    write_bands(path, bands, crs_of(geo), request.feedback, report)
    by_name = {
        "ENERGY": styles.style_energy,
        "ROUGHNESS": styles.style_magnitude,
        "DEVIATION": styles.style_difference,
    }
    request.finish(name, path, by_name[name])
    return path
