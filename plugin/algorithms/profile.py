"""Heights along lines at several levels of a pyramid, as points, a table and a plot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterString,
)

from ..base import Values
from ..parameters.pyramid import crs_of
from ..parameters.request import Request
from ..ui.enums import LINES, POINTS, REAL_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from qgis.core import QgsProcessingFeatureSource

    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.workflows.read_off.profile import Profile as Heights

    from ..qgis_io.background import Work


class Profile(PyramidAlgorithm):
    """Pyramid and lines to a profile."""

    source: QgsProcessingFeatureSource

    GROUP = "readoff"

    def name(self) -> str:
        """Return the public id."""
        return "profile"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Profile along lines")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("Heights along lines at several levels of a pyramid, as points, table and plot")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "profile,section,cross section,transect,elevation profile,plot,chart,level,pyramid,"
            "wavelet"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Walks along lines and reads off the height of several levels of a pyramid. The plot "
            "shows them one above the other, and below, how far each is off the finest. The points "
            "carry the distance from the start of their line and a height for each level."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter("LEVELS")
        self.add(
            QgsProcessingParameterFeatureSource("LINES", tr("Lines"), [LINES]),
            tr("Lines to walk along, in any CRS; each has charts of its own in the plot."),
        )
        self.add(
            QgsProcessingParameterString("LEVELS", tr("Levels"), optional=True),
            tr(
                "Numbers separated by commas; 0 is the coarsest. Empty for the input, those with "
                "about a quarter and a twentieth of its vertices, and the coarsest."
            ),
        )
        self.add(
            QgsProcessingParameterNumber(
                "STEP", tr("Distance between points"), REAL_NUMBER, None, True, 0.0
            ),
            tr(
                "Along the line, whose corners are points, too, in the unit of the CRS, metres for "
                "degrees. Empty for the spacing of the input."
            ),
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "OUTPUT", tr("Points of the profile"), POINTS, optional=True, createByDefault=True
            ),
            tr(
                "Fields: <i>line</i>, <i>distance</i>, and <i>z_…</i> with the height of each "
                "level; NULL where it covers nothing."
            ),
        )
        self.add(
            QgsProcessingParameterFileDestination(
                "PLOT", tr("Plot of the profile"), tr("HTML page (*.html)"), optional=True
            ),
            tr("Opens in the results viewer and in any browser."),
        )
        self.add(
            QgsProcessingParameterFileDestination(
                "PICTURE",
                tr("Picture of the profile"),
                tr("SVG (*.svg)"),
                optional=True,
                createByDefault=False,
            ),
            tr("The same plot for print layouts and reports."),
        )
        self.add(
            QgsProcessingParameterFileDestination(
                "TABLE",
                tr("Table of the profile"),
                tr("CSV (*.csv)"),
                optional=True,
                createByDefault=False,
            ),
            tr("Distance, place and heights of every point, for other programs."),
        )
        for name, description in (
            ("N_LINES", tr("Number of lines")),
            ("N_POINTS", tr("Number of points")),
            ("LENGTH", tr("Length of all lines")),
            ("MAX_DIFFERENCE", tr("Largest difference from the finest level")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def take_layers(self, request: Request) -> None:
        """Take the lines, in their own thread."""
        source = request.source("LINES")
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(request.parameters, "LINES"))
        self.source = source

    def work(self, request: Request) -> Values:
        """Walk along the lines, write what was asked for."""
        from wavelet_gis.report.profile_plot import profile_page, profile_svg
        from wavelet_gis.workflows.read_off.profile import profile

        from ..parameters import tin_output
        from ..parameters.text_output import write_text_output

        levels = request.whole_numbers("LEVELS") or None
        geo = self.geo_pyramid(request)
        lines = self._lines(request, geo)
        step = request.size("STEP")
        request.stage(tr("Walking along the lines"))

        def compute(work: Work) -> Heights:
            return profile(geo, lines, levels=levels, step=step, progress=work.progress)

        found = request.computed(compute, 0.05, 0.8)
        figures = found.figures()
        differences = [
            row["max_difference"] for row in figures["profiles"]
        ]  # NaN beside the terrain
        lengths = {row["line"]: row["length"] for row in figures["profiles"]}
        request.figures = {
            "N_LINES": len(lines),
            "N_POINTS": figures["n_points"],
            "LENGTH": sum(lengths.values()),
            "MAX_DIFFERENCE": max((d for d in differences if d == d), default=0.0),
        }
        request.say(tr("line   level  RMS off the finest  largest"))
        for row in figures["profiles"]:
            request.say(
                f"{row['line']:4d} {row['level']:7d} {row['rms_difference']:19.4f} "
                f"{row['max_difference']:8.4f}"
            )
        results: Values = {}
        if request.wants("OUTPUT"):
            results["OUTPUT"] = tin_output.write_layer(request, "OUTPUT", geo, found.layer())
        results.update(write_text_output(request, "PLOT", lambda: profile_page(found)))
        results.update(write_text_output(request, "PICTURE", lambda: profile_svg(found)))
        results.update(write_text_output(request, "TABLE", found.csv))
        if not results:
            raise QgsProcessingException(
                tr("No output is chosen; choose points, a plot, a picture or a table.")
            )
        return {**request.figures, **results}

    def _lines(self, request: Request, geo: GeoPyramid) -> list[NDArray[np.float64]]:
        """Return x and y of the corners of each line, in the CRS of the terrain."""
        import numpy as np

        from ..qgis_io.vectors import features_in

        lines = []
        part: Any  # of a line layer, a curve
        for feature in features_in(self.source, crs_of(geo), request.transforms, request.feedback):
            for part in feature.geometry().constParts():
                corners = [(vertex.x(), vertex.y()) for vertex in part.vertices()]
                lines.append(np.array(corners, dtype=np.float64))
        if not lines:
            raise QgsProcessingException(
                tr("{}: there is no line; check the layer and its selection.").format(
                    self.source.sourceName()
                )
            )
        return lines
