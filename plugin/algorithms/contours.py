"""Contours of a level of a pyramid, as lines."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import (
    QgsFeature,
    QgsFeatureSink,
    QgsField,
    QgsFields,
    QgsGeometry,
    QgsLineString,
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
)

from ..base import Values
from ..parameters.pyramid import checked_level, crs_of
from ..parameters.request import Request
from ..ui.enums import DOUBLE, INTEGER, LINE_Z, LINES, REAL_NUMBER, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wavelet_gis.model.geo_pyramid import GeoPyramid

    from ..qgis_io.patience import Work

#: Of an interval, how large the RMSE may be of the level that is taken where none is named.
FITTING_ERROR = 0.2
#: Every which contour is drawn thick.
INDEX = 5


class Contours(PyramidAlgorithm):
    """Pyramid to contours."""

    GROUP = "reconstruction"

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
        from wavelet_gis.products.contours import contour_lines, contour_values, round_interval

        geo = self.geo_pyramid(request)
        given = request.size("INTERVAL")
        level = request.whole("LEVEL")
        base = request.number("BASE") or 0.0
        request.stage(tr("Drawing the contours"))

        def compute(work: Work) -> tuple[int, float, list[tuple[float, NDArray[np.float64]]]]:
            finest = geo.frame.to_file(geo.pyramid.synthesise().vertices)
            relief = float(finest[:, 2].max() - finest[:, 2].min())
            interval = given or round_interval(relief)
            found = _fitting_level(geo, interval) if level is None else checked_level(geo, level)
            mesh = geo.pyramid.mesh(found)
            vertices = geo.frame.to_file(mesh.vertices)
            values = contour_values(vertices[:, 2], interval, base)
            lines = list(contour_lines(vertices, mesh.faces, values, work.progress))
            return found, interval, lines

        found, interval, lines = request.computed(compute, 0.05, 0.8)
        request.say(tr("Level {}, a contour each {:g}").format(found, interval))
        request.figures = {
            "N_CONTOURS": len(lines),
            "FOUND_LEVEL": found,
            "FOUND_INTERVAL": interval,
        }
        return {**request.figures, "OUTPUT": _write(request, geo, lines, interval, base)}


def _fitting_level(geo: GeoPyramid, interval: float) -> int:
    """Return the coarsest level that is accurate enough for an interval."""
    measured = geo if geo.errors else geo.with_errors(None)
    for errors in measured.errors or ():
        if errors.rmse_surface <= FITTING_ERROR * interval:
            return errors.level
    return geo.pyramid.n_levels


def _write(
    request: Request,
    geo: GeoPyramid,
    lines: list[tuple[float, NDArray[np.float64]]],
    interval: float,
    base: float,
) -> str:
    from ..qgis_io.crs_and_progress import require_running
    from ..ui import layer_styles as styles

    fields = QgsFields()
    fields.append(QgsField("elevation", DOUBLE))
    fields.append(QgsField("is_index", INTEGER))
    algorithm = request.algorithm
    sink, destination = algorithm.parameterAsSink(
        request.parameters, "OUTPUT", request.context, fields, LINE_Z, crs_of(geo)
    )
    if sink is None:
        raise QgsProcessingException(algorithm.invalidSinkError(request.parameters, "OUTPUT"))
    report = request.progress(0.8, 1.0)
    for k, (value, line) in enumerate(lines):
        if k % 1000 == 0:
            require_running(request.feedback)
            report(k / len(lines))
        feature = QgsFeature(fields)
        x, y, z = line.T.tolist()
        feature.setGeometry(QgsGeometry(QgsLineString(x, y, z)))
        is_index = round((value - base) / interval) % INDEX == 0
        feature.setAttributes([value, int(is_index)])
        if not sink.addFeature(feature, QgsFeatureSink.Flag.FastInsert):
            raise QgsProcessingException(
                tr("The features could not be written ({}); check the disk and the name.").format(
                    sink.lastError()
                )
            )
    request.finish("OUTPUT", destination, styles.style_contours)
    return destination
