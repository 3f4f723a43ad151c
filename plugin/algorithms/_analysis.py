"""What the three analyses share: the work after the terrain is read, and its outputs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import QgsProcessingParameterFeatureSink, QgsProcessingParameterFileDestination

from ..base import TerrainWaveletsAlgorithm, Values
from ..parameters.analysis_options import (
    add_design_parameters,
    add_rule_parameters,
    design_options,
    stop_rules,
)
from ..parameters.choices import choice
from ..parameters.pyramid import (
    add_figure_outputs,
    add_map_parameter,
    figures,
    log_levels,
    save,
)
from ..parameters.request import Request
from ..ui.enums import POLYGONS
from ..ui.translation import tr

if TYPE_CHECKING:
    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.model.terrain import Terrain
    from wavelet_gis.workflows.analyse import Analysis
    from wavelet_gis.workflows.options import WaveletOptions

    from ..qgis_io.background import Work


class AnalysisAlgorithm(TerrainWaveletsAlgorithm):
    """Base of the algorithms that make a pyramid file."""

    GROUP = "analysis"

    def add_analysis_parameters(self) -> None:
        """Declare the design, the pyramid file, the coarse TIN and the figures."""
        add_rule_parameters(self)
        add_design_parameters(self)
        self.add(
            QgsProcessingParameterFileDestination(
                "OUTPUT", tr("Pyramid"), tr("GeoPackage (*.gpkg)")
            ),
            tr(
                "One GeoPackage with everything: the arrays from which every level is rebuilt "
                "exactly, and the coarse TIN and details as styled layers."
            ),
        )
        self.add(
            choice("LAYERS", tr("Layers in the pyramid"), ("auto", "all", "coarse", "none")),
            tr(
                "Which layers the pyramid file has, which is complete without them: the coarse "
                "TIN, up to 50,000 vertices, and the details of the coarser levels, up to 80,000 "
                "features (auto), those of all levels, the coarse TIN only, or none."
            ),
            advanced=True,
        )
        add_map_parameter(self)
        self.add(
            QgsProcessingParameterFeatureSink(
                "COARSE_TIN", tr("Coarse TIN"), POLYGONS, optional=True, createByDefault=True
            ),
            tr("The triangles of the coarsest level, with elevation and slope."),
        )
        add_figure_outputs(self)

    def terrain(self, request: Request) -> Terrain:
        """Return the terrain that the parameters name."""
        raise AssertionError(f"{self.name()} reads no terrain")

    def work(self, request: Request) -> Values:
        """Read, analyse, measure, write."""
        from wavelet_gis.workflows.analyse import analyse

        from ..parameters import tin_output

        output = request.output_file("OUTPUT")
        terrain = self.terrain(request)
        request.say(
            tr("{} vertices, {} triangles").format(terrain.mesh.n_vertices, terrain.mesh.n_faces)
        )
        stages = {
            "analyse": tr("Analysing (the first run also compiles, up to half a minute)"),
            "verify": tr("Checking that the input comes back"),
            "errors": tr("Measuring the errors of every level"),
        }
        options: WaveletOptions = {
            **design_options(request),
            **self.more_options(request, terrain),
        }
        rules = stop_rules(request)

        def compute(work: Work) -> Analysis:
            show = work.in_log(request.stage)
            return analyse(
                terrain,
                progress=work.progress,
                on_stage=lambda name: show(stages[name]),
                **rules,
                **options,
            )

        analysis = request.computed(compute, 0.15, 0.75)
        geo = analysis.geo
        log_levels(request, geo)
        save(request, geo, output, 0.75, 0.95, request.text("LAYERS") or "auto")
        request.figures = {**figures(geo), **self.more_figures(request, geo)}
        results = {"OUTPUT": output, **request.figures}
        if request.wants("COARSE_TIN"):
            results["COARSE_TIN"] = tin_output.write_level(request, "COARSE_TIN", geo, 0)
        request.feedback.setProgress(100)
        return results

    def more_figures(self, request: Request, geo: GeoPyramid) -> Values:
        """Return figures of the analysis beyond sizes and errors."""
        return {}

    def more_options(self, request: Request, terrain: Terrain) -> WaveletOptions:
        """Return options of the analysis beyond the design."""
        return {}
