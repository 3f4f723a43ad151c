"""A LAS, LAZ or COPC file becomes a pyramid file."""

from __future__ import annotations

import os

from qgis.core import (
    QgsProcessingException,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterCrs,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFile,
    QgsProcessingParameterString,
)

from ..parameters.analysis_options import (
    add_weights_parameter,
    vertical_unit,
    weight_options,
    weights_refusal,
)
from ..ui import dependencies
from ._analysis import AnalysisAlgorithm

#: Dimensions that are offered by name; any other can be written in.
ATTRIBUTES = ("classification", "hag", "intensity", "rgb", "return_number", "number_of_returns")


class AnalysePointCloud(AnalysisAlgorithm):
    """Point cloud file to pyramid."""

    def name(self):
        """Return the public id."""
        return "analysepointcloud"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Analyse point cloud")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr("las,laz,copc,lidar,point cloud,tin,pyramid,wavelet,multiresolution").split(
            ","
        )

    def about(self):
        """Return what it does."""
        return self.tr(
            "Triangulates the points of a LAS, LAZ or COPC file and turns them into a reversible "
            "wavelet pyramid. Attributes such as class, intensity, colour or height above ground "
            "are transformed together with the elevation. <i>Reconstruct</i> gives the file back "
            "with its very integers."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        self.add(
            QgsProcessingParameterFile(
                "INPUT",
                self.tr("Point cloud file"),
                fileFilter=self.tr("LAS, LAZ and COPC (*.las *.laz *.LAS *.LAZ)"),
            ),
            self.tr(
                "Read with the Python package laspy, so no point cloud support in QGIS is needed."
            ),
        )
        self.add(
            QgsProcessingParameterEnum(
                "ATTRIBUTES",
                self.tr("Attributes"),
                options=list(ATTRIBUTES),
                allowMultiple=True,
                defaultValue=[],
                optional=True,
                usesStaticStrings=True,
            ),
            self.tr(
                "What is transformed along with the elevation. <i>hag</i> is the height above the "
                "TIN of the ground points (class 2), in the unit of elevation."
            ),
        )
        self.add(
            QgsProcessingParameterString(
                "OTHER_ATTRIBUTES", self.tr("Other attributes"), optional=True
            ),
            self.tr("Names of further dimensions of the file, separated by commas."),
            advanced=True,
        )
        add_weights_parameter(self)
        self.add(
            QgsProcessingParameterString("CLASSES", self.tr("Classes"), optional=True),
            self.tr(
                "Only points of these ASPRS classes, separated by commas: 2 for the ground, 2,9 "
                "for ground and water. Empty for all points."
            ),
        )
        self.add(
            QgsProcessingParameterBoolean("CARRY", self.tr("Keep all other dimensions"), True),
            self.tr(
                "Keep what is not transformed (GPS time, flags, ...) in the pyramid, so that the "
                "reconstructed file has it too."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterCrs("CRS", self.tr("CRS of the points"), optional=True),
            self.tr("Instead of the CRS in the file, or where it has none."),
            advanced=True,
        )
        self.add_analysis_parameters()

    def checkParameterValues(self, parameters, context):
        """Refuse a file that is not there, and classes that are no numbers."""
        is_fine, message = super().checkParameterValues(parameters, context)
        if not is_fine:
            return is_fine, message
        path = self.parameterAsFile(parameters, "INPUT", context)
        if not os.path.isfile(path):
            return False, self.tr("{}: there is no such file; choose a LAS or LAZ file.").format(
                path
            )
        try:
            self._classes(parameters, context)
        except ValueError:
            return False, self.tr("Classes are numbers separated by commas, such as 2,9.")
        refusal = weights_refusal(self, parameters, context)
        return refusal is None, refusal or ""

    def packages(self, parameters, context):
        """Return what reading and triangulating the file needs."""
        path = self.parameterAsFile(parameters, "INPUT", context)
        return (*dependencies.for_las(path), dependencies.PYTHONCDT)

    def terrain(self, parameters, context, feedback):
        """Return the terrain in the file."""
        from qgis.core import QgsCoordinateReferenceSystem

        from wavelet_gis.io.las import read_cloud
        from wavelet_gis.model.terrain import terrain_of_cloud

        from ..qgis_io.crs_and_progress import coordinate_system, require_running

        path = self.parameterAsFile(parameters, "INPUT", context)
        feedback.setProgressText(self.tr("Reading the points"))
        cloud, place = read_cloud(
            path,
            attributes=self._attributes(parameters, context),
            classes=self._classes(parameters, context),
            carry=self.parameterAsBool(parameters, "CARRY", context),
        )
        require_running(feedback)
        crs = self.parameterAsCrs(parameters, "CRS", context)
        if not crs.isValid() and place.wkt:
            crs = QgsCoordinateReferenceSystem.fromWkt(place.wkt)
            if not crs.isValid():
                raise QgsProcessingException(
                    self.tr("{}: QGIS does not understand the CRS in the file; choose one.").format(
                        path
                    )
                )
        feedback.setProgressText(self.tr("Triangulating {} points").format(cloud.n_points))
        return terrain_of_cloud(
            path,
            cloud,
            coordinate_system(crs),
            vertical_unit(self, parameters, context) or place.vertical_unit,
            fault=place.fault,
        )

    def more_options(self, parameters, context, terrain):
        """Return the weights of the attributes."""
        from wavelet_gis.io.las import ALIASES

        names_of_dimension = {}
        for attribute in terrain.original.attributes:
            names_of_dimension.setdefault(attribute.dimension, []).append(attribute.name)
        names = terrain.mesh.attribute_names
        groups = {**ALIASES, **names_of_dimension}
        return weight_options(self, parameters, context, names, groups)

    def _attributes(self, parameters, context):
        named = self.parameterAsEnumStrings(parameters, "ATTRIBUTES", context)
        others = self.parameterAsString(parameters, "OTHER_ATTRIBUTES", context).split(",")
        return [*named, *(name.strip() for name in others if name.strip())]

    def _classes(self, parameters, context):
        text = self.parameterAsString(parameters, "CLASSES", context).strip()
        return [int(number) for number in text.split(",")] if text else None
