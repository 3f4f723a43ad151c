"""The triangles of each level of a pyramid as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsFeature,
    QgsFeatureSink,
    QgsField,
    QgsFields,
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterString,
)

from ..base import Values
from ..parameters.request import Request
from ..ui.enums import DOUBLE, INTEGER, NO_GEOMETRY, TABLE
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.workflows.read_off.quality import LevelQuality

    from ..qgis_io.background import Work


class MeshQuality(PyramidAlgorithm):
    """Pyramid to a table of triangles."""

    GROUP = "readoff"
    PAGE = "report"

    def name(self) -> str:
        """Return the public id."""
        return "meshquality"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Mesh quality")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("Angles, edges and areas of the triangles of every level, as a table")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "mesh quality,triangle quality,angle,sliver,edge length,area,statistics,table,tin,"
            "pyramid,wavelet"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Measures the triangles of each level in plan: what a solver asks of a mesh before it "
            "is taken. A sliver is a triangle with an angle below 10 degrees."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter("LEVELS")
        self.add(
            QgsProcessingParameterString("LEVELS", tr("Levels"), optional=True),
            tr("Numbers separated by commas; 0 is the coarsest. Empty for all."),
        )
        self.add(
            QgsProcessingParameterFeatureSink("OUTPUT", tr("Mesh quality by level"), TABLE),
            tr(
                "One row a level. Angles are in degrees, lengths in the unit of the CRS, metres "
                "for degrees; <i>low_angle</i> is what 95 % of the smallest angles are above."
            ),
        )
        for name, description in (
            ("SMALLEST_ANGLE", tr("Smallest angle of the levels, in degrees")),
            ("LARGEST_ANGLE", tr("Largest angle of the levels, in degrees")),
            ("SHORTEST_EDGE", tr("Shortest edge of the levels")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def work(self, request: Request) -> Values:
        """Measure and write."""
        from wavelet_gis.workflows.read_off.quality import LevelQuality, mesh_quality

        levels = request.whole_numbers("LEVELS") or None
        geo = self.geo_pyramid(request)
        request.stage(tr("Measuring the triangles"))

        def compute(work: Work) -> list[LevelQuality]:
            return mesh_quality(geo, levels=levels, progress=work.progress)

        rows = request.computed(compute, 0.05, 0.95)
        meshed = [row for row in rows if row.n_triangles] or rows  # all others are NaN
        request.figures = {
            "SMALLEST_ANGLE": min(row.smallest_angle for row in meshed),
            "LARGEST_ANGLE": max(row.largest_angle for row in meshed),
            "SHORTEST_EDGE": min(row.shortest_edge for row in meshed),
        }
        fields = QgsFields()
        for name in LevelQuality._fields:
            is_count = name == "level" or name.startswith("n_")
            fields.append(QgsField(name, INTEGER if is_count else DOUBLE))
        sink, destination = self.parameterAsSink(
            request.parameters,
            "OUTPUT",
            request.context,
            fields,
            NO_GEOMETRY,
            QgsCoordinateReferenceSystem(),
        )
        if sink is None:
            raise QgsProcessingException(self.invalidSinkError(request.parameters, "OUTPUT"))
        for row in rows:
            feature = QgsFeature(fields)
            feature.setAttributes([None if value != value else value for value in row])
            if not sink.addFeature(feature, QgsFeatureSink.Flag.FastInsert):
                raise QgsProcessingException(
                    tr(
                        "The features could not be written ({}); check the disk and the name."
                    ).format(sink.lastError())
                )
        request.finish("OUTPUT", destination, lambda layer: None)
        return {**request.figures, "OUTPUT": destination}
