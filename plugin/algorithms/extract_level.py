"""One level of a pyramid as TIN, points, raster or mesh."""

from __future__ import annotations

from qgis.core import (
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
)

from ..parameters.analysis_options import DOUBLE, INTEGER
from ..parameters.mesh_output import add_mesh_parameter, mesh_packages
from ._pyramid_input import PyramidAlgorithm


class ExtractLevel(PyramidAlgorithm):
    """Pyramid to the surface at one level."""

    GROUP = "reconstruction"

    def name(self):
        """Return the public id."""
        return "extractlevel"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Extract level")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr(
            "tin,mesh,2dm,raster,level of detail,generalise,coarse,wavelet,pyramid"
        ).split(",")

    def about(self):
        """Return what it does."""
        return self.tr(
            "Synthesises the terrain at one level of a pyramid and gives it as triangles, "
            "vertices, a raster or a mesh file for hydraulic models. Level 0 is the coarsest; the "
            "analysis says how large and how exact each level is."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self.add(
            QgsProcessingParameterNumber("LEVEL", self.tr("Level"), INTEGER, 0, minValue=0),
            self.tr("0 is the coarsest; the number of levels is the input itself."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "CELL_SIZE",
                self.tr("Cell size of the raster"),
                DOUBLE,
                None,
                optional=True,
                minValue=0.0,
            ),
            self.tr(
                "In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made "
                "from, and for points the mean spacing of the level's vertices."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "TIN",
                self.tr("TIN of the level"),
                QgsProcessing.SourceType.TypeVectorPolygon,
                optional=True,
                createByDefault=True,
            ),
            self.tr("Triangles with mean elevation and slope (degrees)."),
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "VERTICES",
                self.tr("Vertices of the level"),
                QgsProcessing.SourceType.TypeVectorPoint,
                optional=True,
                createByDefault=False,
            ),
            self.tr("Points with elevation and attributes; <i>vertex_id</i> is that of the input."),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "RASTER", self.tr("Raster of the level"), optional=True, createByDefault=False
            ),
            self.tr("The TIN evaluated at the cell centres, 32-bit floats."),
        )
        add_mesh_parameter(self, self.tr("Mesh of the level"))
        self.addOutput(QgsProcessingOutputNumber("N_VERTICES", self.tr("Number of vertices")))
        self.addOutput(QgsProcessingOutputNumber("N_FACES", self.tr("Number of triangles")))
        self.addOutput(
            QgsProcessingOutputNumber(
                "RMSE_SURFACE", self.tr("RMSE of the surface, in the unit of elevation")
            )
        )
        self.addOutput(
            QgsProcessingOutputNumber(
                "MAX_ERROR_SURFACE",
                self.tr("Largest error of the surface, in the unit of elevation"),
            )
        )

    def packages(self, parameters, context):
        """Return what writing the mesh needs."""
        return mesh_packages(self, parameters, context)

    def work(self, parameters, context, feedback):
        """Synthesise the level and write what was asked for."""
        from ..parameters import mesh_output, tin_output
        from ..parameters.pyramid import checked_level, level_figures
        from ..qgis_io.crs_and_progress import require_running

        geo = self.geo_pyramid(parameters, context, feedback)
        level = checked_level(geo, self.parameterAsInt(parameters, "LEVEL", context))
        feedback.setProgress(30)
        feedback.setProgressText(self.tr("Synthesising level {}").format(level))
        mesh = geo.pyramid.mesh(level)
        require_running(feedback)
        feedback.setProgress(60)
        results = {
            "N_VERTICES": mesh.n_vertices,
            "N_FACES": mesh.n_faces,
            **level_figures(geo, level),
        }
        n_figures = len(results)
        if parameters.get("TIN"):
            results["TIN"] = tin_output.write_tin(
                self, parameters, "TIN", context, geo, level, feedback
            )
        if parameters.get("VERTICES"):
            results["VERTICES"] = tin_output.write_vertices(
                self, parameters, "VERTICES", context, geo, level, feedback
            )
        if parameters.get("RASTER"):
            results["RASTER"] = mesh_output.write_raster(
                self, parameters, "RASTER", context, geo, mesh, feedback
            )
        if parameters.get("MESH"):
            results["MESH"] = mesh_output.write_mesh_file(
                self, parameters, "MESH", context, geo, mesh
            )
        if len(results) == n_figures:
            raise QgsProcessingException(
                self.tr("No output is chosen; choose a TIN, vertices, a raster or a mesh.")
            )
        return results
