"""Contours of a level of a pyramid, as lines."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import (
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
)

from ..base import Values
from ..parameters.pyramid import checked_level
from ..parameters.request import Request
from ..ui.enums import LINES, REAL_NUMBER, WHOLE_NUMBER
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.workflows.read_off.contours import Contours as Drawn

    from ..qgis_io.background import Work


class Contours(PyramidAlgorithm):
    """Pyramid to contours."""

    GROUP = "readoff"

    def name(self) -> str:
        """Return the public id."""
        return "contours"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Contours of level")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("Contour lines of one level of a pyramid, the smoother the coarser the level")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "contour,contours,isolines,lines,elevation,tin,generalise,generalize,smooth,level,"
            "wavelet,pyramid"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Draws the contours of one level of a pyramid, straight in each triangle and never "
            "crossing. A coarse level has few and smooth ones. Higher ground is on the right of a "
            "line; every fifth is marked, and drawn thick."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter("LEVEL")
        self.add(
            QgsProcessingParameterNumber(
                "INTERVAL", tr("Interval"), REAL_NUMBER, None, optional=True, minValue=0.0
            ),
            tr("In the unit of elevation; empty or 0 for a round one that gives about twenty."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "LEVEL", tr("Level"), WHOLE_NUMBER, None, optional=True, minValue=0
            ),
            tr(
                "0 is the coarsest. Empty for the coarsest whose RMSE is at most a fifth of the "
                "interval."
            ),
        )
        self.add(
            QgsProcessingParameterNumber("BASE", tr("Base"), REAL_NUMBER, 0.0),
            tr("Height that the intervals are counted from."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFeatureSink("OUTPUT", tr("Contours"), LINES),
            tr("Lines with Z and the fields <i>elevation</i> and <i>is_index</i>."),
        )
        for name, description in (
            ("N_CONTOURS", tr("Number of contours")),
            ("FOUND_LEVEL", tr("Level")),
            ("FOUND_INTERVAL", tr("Interval")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def work(self, request: Request) -> Values:
        """Choose a level, draw its contours, write them."""
        from wavelet_gis.workflows.read_off.contours import contours

        from ..parameters import tin_output

        geo = self.geo_pyramid(request)
        interval, base = request.size("INTERVAL"), request.number("BASE") or 0.0
        given = request.whole("LEVEL")
        level = None if given is None else checked_level(geo, given)
        request.stage(tr("Drawing the contours"))

        def compute(work: Work) -> Drawn:
            return contours(geo, interval=interval, level=level, base=base, progress=work.progress)

        found = request.computed(compute, 0.05, 0.8)
        request.say(tr("Level {}, a contour each {:g}").format(found.level, found.interval))
        request.figures = {
            "N_CONTOURS": len(found.lines),
            "FOUND_LEVEL": found.level,
            "FOUND_INTERVAL": found.interval,
        }
        layer = request.computed(lambda work: found.layer(), 0.8, 0.85)
        return {
            **request.figures,
            "OUTPUT": tin_output.write_layer(request, "OUTPUT", geo, layer),
        }
