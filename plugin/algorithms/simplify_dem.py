"""The TIN of a size, or of an accuracy, straight from a raster layer."""

from __future__ import annotations

from qgis.core import (
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingOutputNumber,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
)

from ..base import TerrainWaveletsAlgorithm
from ..parameters.analysis_options import DOUBLE, INTEGER, add_design_parameters, design_options
from ..parameters.mesh_output import add_mesh_parameter, mesh_packages
from ._dem_input import DemInput

RULES = ("VERTICES", "MAX_ERROR", "RMSE")


class SimplifyDem(DemInput, TerrainWaveletsAlgorithm):
    """DEM to TIN."""

    GROUP = "analysis"

    def name(self):
        """Return the public id."""
        return "simplifydem"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Simplify DEM")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr("simplify,thin,generalise,decimate,tin,mesh,2dm,dem,level of detail").split(
            ","
        )

    def about(self):
        """Return what it does."""
        return self.tr(
            "Gives the TIN of a number of vertices, or the TIN that is exact enough, with a small "
            "error at all cells of the DEM. Say one of the three: how many vertices, the largest "
            "error, or the root mean square error."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        self.add_dem_parameters()
        self.add(
            QgsProcessingParameterNumber(
                "VERTICES", self.tr("Number of vertices"), INTEGER, None, True, 3
            ),
            self.tr("The TIN has exactly so many, if it can get there."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "MAX_ERROR", self.tr("Largest error"), DOUBLE, None, True, 0.0
            ),
            self.tr("No cell is farther above or below the TIN, in the unit of elevation."),
        )
        self.add(
            QgsProcessingParameterNumber("RMSE", self.tr("RMSE"), DOUBLE, None, True, 0.0),
            self.tr("Root mean square error over all cells, in the unit of elevation."),
        )
        add_design_parameters(self)
        self.add(
            QgsProcessingParameterBoolean("FIT", self.tr("Fit the heights to all cells"), True),
            self.tr(
                "Least squares: the smallest RMSE that these triangles can have. Without it, and "
                "where the largest error is kept small, the heights are those of the pyramid's "
                "coarsest level."
            ),
            advanced=True,
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
            self.tr("In the unit of the CRS; empty for the grid of the DEM."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "TIN",
                self.tr("Simplified TIN"),
                QgsProcessing.SourceType.TypeVectorPolygon,
                optional=True,
                createByDefault=True,
            ),
            self.tr("Triangles with mean elevation and slope (degrees)."),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "RASTER", self.tr("Raster of the TIN"), optional=True, createByDefault=False
            ),
            self.tr("The TIN evaluated at the cell centres."),
        )
        add_mesh_parameter(self, self.tr("Mesh of the TIN"))
        self.add(
            QgsProcessingParameterFileDestination(
                "OUTPUT",
                self.tr("Pyramid"),
                self.tr("GeoPackage (*.gpkg)"),
                optional=True,
                createByDefault=False,
            ),
            self.tr("The reversible pyramid whose coarsest level has the triangles of the TIN."),
            advanced=True,
        )
        for name, description in (
            ("N_VERTICES", self.tr("Number of vertices")),
            ("N_FACES", self.tr("Number of triangles")),
            ("RMSE_SURFACE", self.tr("RMSE at all cells, in the unit of elevation")),
            ("MAX_ERROR_SURFACE", self.tr("Largest error at all cells, in the unit of elevation")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def checkParameterValues(self, parameters, context):
        """Refuse anything but one rule."""
        is_fine, message = super().checkParameterValues(parameters, context)
        if not is_fine:
            return is_fine, message
        if sum(parameters.get(name) is not None for name in RULES) != 1:
            return False, self.tr(
                "Say one of the three: the number of vertices, the largest error, or the RMSE."
            )
        return True, ""

    def packages(self, parameters, context):
        """Return what writing the mesh needs."""
        return mesh_packages(self, parameters, context)

    def work(self, parameters, context, feedback):
        """Read, simplify, measure, write what was asked for."""
        from wavelet_core import analyse
        from wavelet_core.accuracy.fitted_heights import fitted

        from ..parameters import mesh_output, tin_output
        from ..parameters import pyramid as pyramids
        from ..qgis_io.crs_and_progress import progress, require_running

        terrain = self.terrain(parameters, context, feedback)
        feedback.setProgressText(
            self.tr("Simplifying (the first run also compiles, up to half a minute)")
        )
        pyramid = analyse(
            terrain.mesh,
            progress=progress(feedback, 0.05, 0.7),
            **self._rule(parameters, context, terrain.frame.z_scale),
            **design_options(self, parameters, context),
        )
        geo = terrain.geo_pyramid(pyramid)
        require_running(feedback)
        coarsest = geo.pyramid.mesh(0)
        is_fitted = self.parameterAsBool(parameters, "FIT", context)
        if is_fitted and pyramid.parameters["norm"] == "rms":
            coarsest = fitted(coarsest, terrain.mesh)
        results = {
            "N_VERTICES": coarsest.n_vertices,
            "N_FACES": coarsest.n_faces,
            **self._errors(geo, coarsest, terrain),
        }
        n_figures = len(results)
        path = self.parameterAsFileOutput(parameters, "OUTPUT", context)
        if path:
            measured = geo.with_errors(progress(feedback, 0.7, 0.75))
            pyramids.save(measured, path, feedback, 0.75, 0.9)
            results["OUTPUT"] = path
        if parameters.get("TIN"):
            results["TIN"] = tin_output.write_tin(
                self, parameters, "TIN", context, geo, 0, feedback, coarsest
            )
        if parameters.get("RASTER"):
            results["RASTER"] = mesh_output.write_raster(
                self, parameters, "RASTER", context, geo, coarsest, feedback
            )
        if parameters.get("MESH"):
            results["MESH"] = mesh_output.write_mesh_file(
                self, parameters, "MESH", context, geo, coarsest
            )
        if len(results) == n_figures:
            raise QgsProcessingException(
                self.tr("No output is chosen; choose a TIN, a raster, a mesh or a pyramid.")
            )
        return results

    def _rule(self, parameters, context, z_scale):
        if parameters.get("VERTICES") is not None:
            return {"target_vertices": self.parameterAsInt(parameters, "VERTICES", context)}
        if parameters.get("MAX_ERROR") is not None:
            error = self.parameterAsDouble(parameters, "MAX_ERROR", context)
            return {"max_error": error * z_scale}
        return {"max_rms": self.parameterAsDouble(parameters, "RMSE", context) * z_scale}

    def _errors(self, geo, coarsest, terrain):
        import numpy as np

        from wavelet_core.mesh.location import surface_errors

        errors = surface_errors(coarsest, terrain.mesh.vertices) / geo.frame.z_scale
        covered = errors[np.isfinite(errors)]
        return {
            "RMSE_SURFACE": float(np.sqrt(np.mean(covered**2))) if len(covered) else 0.0,
            "MAX_ERROR_SURFACE": float(np.abs(covered).max(initial=0.0)),
        }
