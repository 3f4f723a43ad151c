"""A pyramid file becomes the DEM, the point cloud or the TIN that it was made from."""

from __future__ import annotations

from qgis.core import (
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingOutputNumber,
    QgsProcessingOutputString,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterRasterDestination,
)

from .. import dependencies
from ._pyramid_input import PyramidAlgorithm


class Reconstruct(PyramidAlgorithm):
    """Pyramid to what it was made from."""

    GROUP = "reconstruction"

    def name(self):
        """Return the public id."""
        return "reconstruct"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Reconstruct")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr("synthesis,inverse,dem,las,laz,tin,wavelet,pyramid,original").split(",")

    def about(self):
        """Return what it does."""
        return self.tr(
            "Synthesises the finest level of a pyramid and gives back what it was made from: the "
            "DEM bit for bit (same numbers, data type, nodata, grid and CRS), the point cloud with "
            "its very integers, in its order, or the TIN. A filtered pyramid gives the filtered "
            "terrain. Choose the output that fits the pyramid; the others stay empty."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self.add(
            QgsProcessingParameterRasterDestination(
                "DEM", self.tr("Reconstructed DEM"), optional=True, createByDefault=True
            ),
            self.tr("For a pyramid of a DEM."),
        )
        self.add(
            QgsProcessingParameterFileDestination(
                "POINT_CLOUD",
                self.tr("Reconstructed point cloud"),
                self.tr("LAZ (*.laz);;LAS (*.las)"),
                optional=True,
                createByDefault=False,
            ),
            self.tr("For a pyramid of a point cloud file. Needs the Python package laspy."),
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "TIN",
                self.tr("Reconstructed TIN"),
                QgsProcessing.SourceType.TypeVectorPolygon,
                optional=True,
                createByDefault=False,
            ),
            self.tr("The triangles of the finest level, for a pyramid of any kind."),
        )
        self.addOutput(QgsProcessingOutputNumber("N_VERTICES", self.tr("Number of vertices")))
        self.addOutput(
            QgsProcessingOutputString("EXACT", self.tr("'yes' if bit for bit the original"))
        )

    def packages(self, parameters, context):
        """Return laspy where a point cloud is asked for."""
        if parameters.get("POINT_CLOUD"):
            return dependencies.for_las(str(parameters["POINT_CLOUD"]))
        return ()

    def work(self, parameters, context, feedback):
        """Synthesise, restore, write what was asked for."""
        from .. import tin_output
        from ..bridge import require_running
        from ..pyramids import crs_of

        record = self.record(parameters, context, feedback)
        crs = crs_of(record)
        feedback.setProgress(30)
        feedback.setProgressText(self.tr("Synthesising the finest level"))
        finest = record.pyramid.synthesise()
        require_running(feedback)
        feedback.setProgress(60)
        results = {"N_VERTICES": finest.n_vertices, "EXACT": _exactness(record)}
        if record.source.kind == "raster":
            self._write_dem(parameters, context, record, finest, crs, feedback, results)
        elif record.source.kind == "points":
            self._write_cloud(parameters, context, record, finest, feedback, results)
        if parameters.get("TIN"):
            results["TIN"] = tin_output.write_tin(
                self, parameters, "TIN", context, record, record.pyramid.n_levels, feedback
            )
        if len(results) == 2:
            raise QgsProcessingException(self._nothing_to_write(record.source.kind))
        return results

    def _write_dem(self, parameters, context, record, finest, crs, feedback, results):
        from .. import raster_output, styles

        path = self.parameterAsOutputLayer(parameters, "DEM", context)
        if not path:
            return
        dem = record.source.restore(finest, record.frame)
        raster_output.write_dem(path, dem, crs, feedback)
        styles.style_output(context, path, styles.style_hillshade)
        results["DEM"] = path

    def _write_cloud(self, parameters, context, record, finest, feedback, results):
        from wavelet_gis.atomic import new_file
        from wavelet_gis.pointcloud import write_cloud

        path = self.parameterAsFileOutput(parameters, "POINT_CLOUD", context)
        if not path:
            return
        with new_file(path, overwrite=True) as scratch:
            write_cloud(scratch, record.source.restore(finest, record.frame))
        results["POINT_CLOUD"] = path

    def _nothing_to_write(self, kind):
        if kind == "raster":
            return self.tr("This pyramid was made from a DEM; choose where the DEM goes.")
        if kind == "points":
            return self.tr(
                "This pyramid was made from a point cloud; choose a file for the point cloud, or "
                "take the TIN."
            )
        return self.tr("This pyramid was made from a TIN; choose where the TIN goes.")


def _exactness(record) -> str:
    if record.source.is_exact:
        return "yes"
    return "no" if record.history else "to rounding"
