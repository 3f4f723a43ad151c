"""The quality of a pyramid on one HTML page."""

from __future__ import annotations

import json

from qgis.core import QgsProcessingParameterFileDestination, QgsProcessingParameterString

from ..base import Values
from ..parameters.pyramid import add_figure_outputs, figures
from ..parameters.request import Request
from ..parameters.text_output import write_text_output
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm


class QualityReport(PyramidAlgorithm):
    """Pyramid to report."""

    GROUP = "quality"
    PAGE = "report"

    def name(self) -> str:
        """Return the public id."""
        return "qualityreport"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Quality report")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("Sizes, errors and triangle shapes of every level of a pyramid, as a web page")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "report,html,rmse,error,accuracy,statistics,triangle quality,pyramid,wavelet"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Writes one HTML page on a pyramid: sizes, errors and triangle quality of every level, "
            "curves of the RMSE, histograms of the details, hillshades of the input and of chosen "
            "levels, where the error is, and all parameters. The page needs no network."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self.add(
            QgsProcessingParameterString("LEVELS", tr("Levels shown as pictures"), optional=True),
            tr(
                "Numbers separated by commas. Empty for those with about a quarter and a twentieth "
                "of the vertices, and the coarsest."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFileDestination(
                "OUTPUT", tr("Quality report"), tr("HTML page (*.html)")
            ),
            tr("Opens in the results viewer and in any browser."),
        )
        self.add(
            QgsProcessingParameterFileDestination(
                "FIGURES",
                tr("Figures of the report"),
                tr("JSON (*.json)"),
                optional=True,
                createByDefault=False,
            ),
            tr("All numbers of the report, for other programs."),
            advanced=True,
        )
        add_figure_outputs(self)

    def work(self, request: Request) -> Values:
        """Measure, draw, write."""
        from wavelet_gis.report.page import report_page

        geo = self.geo_pyramid(request)
        request.stage(tr("Measuring and drawing"))
        levels = request.whole_numbers("LEVELS") or None
        page, numbers = request.computed(
            lambda work: report_page(geo, levels, work.progress), 0.1, 0.9
        )
        measured = (
            geo
            if geo.errors
            else request.computed(lambda work: geo.with_errors(work.progress), 0.9, 1.0)
        )
        return {
            **figures(measured),
            **write_text_output(request, "OUTPUT", lambda: page),
            **write_text_output(
                request, "FIGURES", lambda: json.dumps(numbers, indent=1, allow_nan=False)
            ),
        }
