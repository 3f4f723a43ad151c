"""The details of a pyramid's levels as a layer of points."""

from __future__ import annotations

from qgis.core import (
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
)

from ..parameters.analysis_options import DOUBLE, INTEGER
from ._pyramid_input import PyramidAlgorithm


class DetailLayers(PyramidAlgorithm):
    """Pyramid to points with detail vectors."""

    GROUP = "details"

    def name(self):
        """Return the public id."""
        return "detaillayers"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Detail layers")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr("wavelet coefficients,detail,scale,vertex-frequency,points,pyramid").split(
            ","
        )

    def about(self):
        """Return what it does."""
        return self.tr(
            "Shows at which scale the terrain has its detail: a point for every vertex that the "
            "analysis removed, with the level at which it went and its detail vector (the wavelet "
            "coefficients). Points are coloured by level and sized by magnitude, as in Fig. 10b "
            "of the paper. Level 0 is the coarsest. For scales that mean the same everywhere, "
            "analyse with the partition <i>random</i> and the prediction <i>plane</i>; the default "
            "partition takes detail out where it matters least first."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self.add(
            QgsProcessingParameterNumber(
                "FIRST_LEVEL", self.tr("Coarsest level"), INTEGER, 0, minValue=0
            ),
            self.tr("Details of this level and finer ones."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "LAST_LEVEL", self.tr("Finest level"), INTEGER, None, optional=True, minValue=0
            ),
            self.tr("Details of this level and coarser ones; empty for all."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "MIN_MAGNITUDE", self.tr("Smallest magnitude"), DOUBLE, 0.0, minValue=0.0
            ),
            self.tr(
                "Leave out points whose detail vector is shorter (in the unit of elevation where "
                "elevation alone is lifted)."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "OUTPUT", self.tr("Details by level"), QgsProcessing.SourceType.TypeVectorPoint
            ),
            self.tr(
                "Fields: <i>vertex_id</i> in the input, <i>level</i>, <i>w_…</i> the detail of a "
                "channel, <i>magnitude</i> the length of the detail vector."
            ),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "ENERGY", self.tr("Energy by level"), optional=True, createByDefault=False
            ),
            self.tr(
                "A raster with one band a level: the root mean square detail around each place, in "
                "the unit of elevation. It maps at which scale the terrain is rough."
            ),
        )
        self.add(
            QgsProcessingParameterNumber(
                "CELL_SIZE",
                self.tr("Cell size of the raster"),
                DOUBLE,
                None,
                optional=True,
                minValue=0.0,
            ),
            self.tr(
                "In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made "
                "from, and for points their mean spacing."
            ),
            advanced=True,
        )
        self.addOutput(QgsProcessingOutputNumber("N_DETAILS", self.tr("Number of points")))
        self.addOutput(QgsProcessingOutputNumber("MAX_MAGNITUDE", self.tr("Largest magnitude")))

    def work(self, parameters, context, feedback):
        """Walk the levels from coarse to fine and add their points."""
        import numpy as np

        from wavelet_gis.products.layers import detail_layers

        from ..parameters.pyramid import checked_level, crs_of
        from ..qgis_io import vectors
        from ..qgis_io.crs_and_progress import require_running
        from ..ui import layer_styles as styles

        geo = self.geo_pyramid(parameters, context, feedback)
        n_levels = geo.pyramid.n_levels
        if n_levels == 0:
            raise QgsProcessingException(
                self.tr("This pyramid has no level, so it has no details.")
            )
        first = checked_level(geo, self.parameterAsInt(parameters, "FIRST_LEVEL", context))
        last = n_levels - 1
        if parameters.get("LAST_LEVEL") is not None:
            last = min(self.parameterAsInt(parameters, "LAST_LEVEL", context), last)
        if first > last:
            raise QgsProcessingException(
                self.tr(
                    "The coarsest level, {}, is finer than the finest, {}; exchange them."
                ).format(first, last)
            )
        smallest = self.parameterAsDouble(parameters, "MIN_MAGNITUDE", context)
        sink, destination = None, None
        n_details, largest = 0, 0.0
        for level, layer in enumerate(detail_layers(geo)):
            require_running(feedback)
            if sink is None:  # all levels have the same fields
                sink, destination = self.parameterAsSink(
                    parameters,
                    "OUTPUT",
                    context,
                    vectors.fields_of(layer),
                    vectors.wkb_type_of(layer),
                    crs_of(geo),
                )
                if sink is None:
                    raise QgsProcessingException(self.invalidSinkError(parameters, "OUTPUT"))
            if level > last:
                break
            if level < first:
                continue
            magnitude = layer.fields["magnitude"]
            rows = np.flatnonzero(magnitude >= smallest)
            n_details += vectors.add_layer(sink, layer, feedback, rows)
            largest = max(largest, float(magnitude.max(initial=0.0)))
            feedback.setProgress(60 * (level - first + 1) / (last - first + 1))
        styles.style_output(context, destination, styles.style_details)
        results = {"OUTPUT": destination, "N_DETAILS": n_details, "MAX_MAGNITUDE": largest}
        if parameters.get("ENERGY"):
            results["ENERGY"] = self._write_energy(parameters, context, geo, feedback)
        return results

    def _write_energy(self, parameters, context, geo, feedback):
        from wavelet_gis.products.vertex_raster import value_bands
        from wavelet_gis.products.vertex_tables import band_names, energy_columns

        from ..parameters.pyramid import cell_size, crs_of
        from ..qgis_io.crs_and_progress import progress
        from ..qgis_io.raster_writer import write_bands

        path = self.parameterAsOutputLayer(parameters, "ENERGY", context)
        feedback.setProgressText(self.tr("Gathering the energy of each level"))
        columns = energy_columns(geo, progress=progress(feedback, 0.6, 0.9))
        finest = geo.pyramid.synthesise()
        size = cell_size(self, parameters, context)
        bands = value_bands(geo, finest, columns, band_names(geo), size)
        write_bands(path, bands, crs_of(geo), feedback)
        return path
