"""A pyramid file becomes the DEM, the point cloud or the TIN that it was made from."""

from __future__ import annotations

from qgis.core import QgsProcessingOutputNumber, QgsProcessingOutputString

from ..parameters.restored_output import add_restored_outputs, nothing_written, write_restored
from ..ui import dependencies
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
        add_restored_outputs(
            self,
            self.tr("Reconstructed DEM"),
            self.tr("Reconstructed point cloud"),
            self.tr("Reconstructed TIN"),
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
        from ..qgis_io.crs_and_progress import require_running

        geo = self.geo_pyramid(parameters, context, feedback)
        feedback.setProgress(30)
        feedback.setProgressText(self.tr("Synthesising the finest level"))
        finest = geo.pyramid.synthesise()
        require_running(feedback)
        feedback.setProgress(60)
        results = write_restored(self, parameters, context, geo, finest, feedback)
        if not results:
            raise nothing_written(geo.origin.kind)
        return {"N_VERTICES": finest.n_vertices, "EXACT": _exactness(geo), **results}


def _exactness(geo) -> str:
    if geo.origin.is_exact:
        return "yes"
    return "no" if geo.history else "to rounding"
