"""The quality of a pyramid on one HTML page."""

from __future__ import annotations

import json

from qgis.core import (
    QgsProcessingException,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterString,
)

from ._pyramid_input import PyramidAlgorithm


class QualityReport(PyramidAlgorithm):
    """Pyramid to report."""

    GROUP = "quality"

    def name(self):
        """Return the public id."""
        return "qualityreport"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Quality report")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr("report,html,rmse,error,statistics,triangle quality,pyramid,wavelet").split(
            ","
        )

    def about(self):
        """Return what it does."""
        return self.tr(
            "Writes one HTML page on a pyramid: sizes, errors and triangle quality of every level, "
            "curves of the RMSE, histograms of the details, hillshades of the input and of chosen "
            "levels, where the error is, and all parameters. The page needs no network."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        from ..parameters.pyramid import add_figure_outputs

        self.add_pyramid_parameter()
        self.add(
            QgsProcessingParameterString("LEVELS", self.tr("Levels to picture"), optional=True),
            self.tr(
                "Numbers separated by commas. Empty for those with about a quarter and a twentieth "
                "of the vertices, and the coarsest."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFileDestination(
                "OUTPUT", self.tr("Quality report"), self.tr("HTML page (*.html)")
            ),
            self.tr("Opens in the results viewer and in any browser."),
        )
        self.add(
            QgsProcessingParameterFileDestination(
                "FIGURES",
                self.tr("Figures of the report"),
                self.tr("JSON (*.json)"),
                optional=True,
                createByDefault=False,
            ),
            self.tr("All numbers of the report, for other programs."),
            advanced=True,
        )
        add_figure_outputs(self)

    def checkParameterValues(self, parameters, context):
        """Refuse levels that are no numbers."""
        is_fine, message = super().checkParameterValues(parameters, context)
        if not is_fine:
            return is_fine, message
        try:
            self._levels(parameters, context)
        except ValueError:
            return False, self.tr("Levels are numbers separated by commas, such as 0,4,8.")
        return True, ""

    def work(self, parameters, context, feedback):
        """Measure, draw, write."""
        from wavelet_gis.io.atomic import new_file
        from wavelet_gis.io.read_back import write_text
        from wavelet_gis.report.page import report_page

        from ..parameters.pyramid import figures
        from ..qgis_io.crs_and_progress import progress

        geo = self.geo_pyramid(parameters, context, feedback)
        feedback.setProgressText(self.tr("Measuring and drawing"))
        page, numbers = report_page(
            geo, self._levels(parameters, context), progress(feedback, 0.1, 0.95)
        )
        texts = {"OUTPUT": page, "FIGURES": json.dumps(numbers, indent=1, allow_nan=False)}
        measured = geo if geo.errors else geo.with_errors(progress(feedback, 0.95, 1.0))
        results = figures(measured)
        for name, text in texts.items():
            path = self.parameterAsFileOutput(parameters, name, context)
            if not path:
                continue
            with new_file(path, overwrite=True) as scratch:
                write_text(scratch, text)
            results[name] = path
        if "OUTPUT" not in results:
            raise QgsProcessingException(self.tr("Choose a file for the report."))
        return results

    def _levels(self, parameters, context):
        text = self.parameterAsString(parameters, "LEVELS", context).strip()
        return [int(number) for number in text.split(",")] if text else None
