"""A point cloud to the same with its ground points marked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import (
    QgsProcessingOutputNumber,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
)

from ..base import Values
from ..parameters.analysis_options import add_vertical_unit, vertical_unit
from ..parameters.request import Request
from ..ui import dependencies
from ..ui.enums import REAL_NUMBER
from ..ui.translation import tr
from ._cloud_input import CloudInput
from ._cloud_source import cloud_source

if TYPE_CHECKING:
    from wavelet_gis.workflows.ground import ClassifiedGround

    from ..qgis_io.background import Work

#: As `wavelet_core.features.ground` has them, which cannot be imported before numpy is sure.
LARGEST_OBJECT, LEAST_SLOPE, HEIGHT_TOLERANCE = 60.0, 0.1, 0.15


class ClassifyGround(CloudInput):
    """Point cloud file to the same with other classes."""

    GROUP = "analysis"

    def name(self) -> str:
        """Return the public id."""
        return "classifyground"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Classify ground")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("LAS, LAZ or COPC file to the same with its ground points marked")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "ground,ground filter,classify,classification,bare earth,dtm,smrf,csf,las,laz,lidar,"
            "point cloud,vegetation,buildings"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Marks the ground points of a LAS, LAZ or COPC file, from their heights alone and "
            "without training: what stands above the lows around it, at any scale, by more than "
            "the slope of the ground explains, is no ground. The ground gets class 2, all else 1; "
            "noise and withheld points keep their class, and nothing but classes is changed."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_input_parameter()
        self.add(
            QgsProcessingParameterNumber(
                "LARGEST_OBJECT", tr("Largest object"), REAL_NUMBER, LARGEST_OBJECT, minValue=0.1
            ),
            tr("Width of the largest building, in metres; wider ones are taken for ground."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "LEAST_SLOPE", tr("Least slope"), REAL_NUMBER, LEAST_SLOPE, minValue=0.001
            ),
            tr(
                "Rise over run that the ground may have everywhere; on slopes more, by itself. "
                "Larger values keep more banks and let more low things through."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterNumber(
                "HEIGHT_TOLERANCE",
                tr("Height tolerance"),
                REAL_NUMBER,
                HEIGHT_TOLERANCE,
                minValue=0.001,
            ),
            tr("Points so far above or below the ground's surface are part of it, in metres."),
            advanced=True,
        )
        add_vertical_unit(self)
        self.add_crs_parameter()
        self.add(
            QgsProcessingParameterFileDestination(
                "OUTPUT", tr("Classified point cloud"), tr("LAS (*.las);;LAZ (*.laz)")
            ),
            tr("All points, with all their dimensions. LAZ needs the Python package lazrs."),
        )
        for name, description in (
            ("N_POINTS", tr("Points")),
            ("N_GROUND", tr("Points of the ground")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def refusal(self, request: Request) -> str | None:
        """Refuse a file that is not there."""
        return cloud_source(request, "INPUT").fault

    def packages(self, request: Request) -> tuple[dependencies.Package, ...]:
        """Return what reading and writing the files needs."""
        of_output = dependencies.for_las(request.output_file("OUTPUT"))
        return (*CloudInput.packages(self, request), *of_output)

    def work(self, request: Request) -> Values:
        """Read, classify, write."""
        from wavelet_gis.io.atomic import new_file
        from wavelet_gis.workflows.ground import ground_of_cloud

        cloud, place = self.read_points(request)
        system, unit = self.system_of(request, place), vertical_unit(request) or place.vertical_unit
        options = {
            name.lower(): request.number(name) or 0.0
            for name in ("LARGEST_OBJECT", "LEAST_SLOPE", "HEIGHT_TOLERANCE")
        }
        request.stage(tr("Looking for the ground among {} points").format(cloud.n_points))

        def classify(work: Work) -> ClassifiedGround:
            return ground_of_cloud(
                self.source.path,
                cloud,
                system,
                unit,
                fault=place.fault,
                progress=work.progress,
                **options,
            )

        found = request.computed(classify, 0.05, 0.8)
        figures = found.figures()
        path = request.output_file("OUTPUT")
        request.stage(tr("Writing {}").format(tr("the classified point cloud")))
        with new_file(path, overwrite=True) as scratch:
            request.computed(lambda work: found.write(scratch), 0.8, 1.0)
        request.say(
            tr("{} of {} points are ground").format(figures["n_ground"], figures["n_points"])
        )
        return {"OUTPUT": path, "N_POINTS": figures["n_points"], "N_GROUND": figures["n_ground"]}
