"""What the three analyses share: the work after the terrain is read, and its outputs."""

from __future__ import annotations

from qgis.core import (
    QgsProcessing,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
)

from ..base import TerrainWaveletsAlgorithm
from ..parameters.analysis_options import (
    add_design_parameters,
    add_rule_parameters,
    design_options,
    rule_options,
)


class AnalysisAlgorithm(TerrainWaveletsAlgorithm):
    """Base of the algorithms that make a pyramid file."""

    GROUP = "analysis"

    def add_analysis_parameters(self):
        """Declare the design, the pyramid file, the coarse TIN and the figures."""
        from ..parameters.pyramid import add_figure_outputs

        add_rule_parameters(self)
        add_design_parameters(self)
        self.add(
            QgsProcessingParameterFileDestination(
                "OUTPUT", self.tr("Pyramid"), self.tr("GeoPackage (*.gpkg)")
            ),
            self.tr(
                "One GeoPackage with everything: the arrays from which every level is rebuilt "
                "exactly, the coarse TIN and the details of each level as styled layers."
            ),
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "COARSE_TIN",
                self.tr("Coarse TIN"),
                QgsProcessing.SourceType.TypeVectorPolygon,
                optional=True,
                createByDefault=True,
            ),
            self.tr("The triangles of the coarsest level, with elevation and slope."),
        )
        add_figure_outputs(self)

    def terrain(self, parameters, context, feedback):
        """Return the ``wavelet_gis.model.terrain.Terrain`` that the parameters name."""
        raise AssertionError(f"{self.name()} reads no terrain")

    def work(self, parameters, context, feedback):
        """Read, analyse, measure, write."""
        from wavelet_core import analyse

        from ..parameters import pyramid as pyramids
        from ..parameters import tin_output
        from ..qgis_io.crs_and_progress import progress, require_running

        output = self.parameterAsFileOutput(parameters, "OUTPUT", context)
        terrain = self.terrain(parameters, context, feedback)
        feedback.pushInfo(
            self.tr("{} vertices, {} triangles").format(
                terrain.mesh.n_vertices, terrain.mesh.n_faces
            )
        )
        feedback.setProgressText(
            self.tr("Analysing (the first run also compiles, up to half a minute)")
        )
        pyramid = analyse(
            terrain.mesh,
            progress=progress(feedback, 0.05, 0.55),
            **rule_options(self, parameters, context, terrain.frame.z_scale),
            **design_options(self, parameters, context),
            **self.more_options(parameters, context, terrain),
        )
        feedback.setProgressText(self.tr("Measuring the errors of every level"))
        geo = terrain.geo_pyramid(pyramid)
        require_running(feedback)
        geo = geo.with_errors(progress(feedback, 0.55, 0.75))
        pyramids.log_levels(geo, feedback)
        feedback.setProgressText(self.tr("Writing the pyramid"))
        pyramids.save(geo, output, feedback, 0.75, 0.95)
        results = {"OUTPUT": output, **pyramids.figures(geo)}
        if parameters.get("COARSE_TIN"):
            results["COARSE_TIN"] = tin_output.write_tin(
                self, parameters, "COARSE_TIN", context, geo, 0, feedback
            )
        feedback.setProgress(100)
        return results

    def more_options(self, parameters, context, terrain):
        """Return options of ``wavelet_core.analyse`` beyond the design."""
        return {}
