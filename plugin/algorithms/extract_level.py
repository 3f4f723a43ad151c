"""One level of a pyramid as TIN, points, raster or mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import (
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
)

from ..base import Values
from ..parameters.mesh_output import add_mesh_parameter, mesh_packages
from ..parameters.pyramid import checked_level
from ..parameters.request import Request
from ..parameters.surface_output import add_error_outputs, surface_figures, write_surface
from ..ui.enums import POINTS, POLYGONS, REAL_NUMBER, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from ..ui.dependencies import Package


class ExtractLevel(PyramidAlgorithm):
    """Pyramid to the surface at one level."""

    GROUP = "reconstruction"

    def name(self) -> str:
        """Return the public id."""
        return "extractlevel"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Extract level")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("One level of a pyramid as TIN, points, raster or mesh")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "tin,mesh,2dm,raster,level of detail,lod,generalise,generalize,coarse,wavelet,pyramid"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Synthesises the terrain at one level of a pyramid and gives it as triangles, "
            "vertices, a raster or a mesh file for hydraulic models. Level 0 is the coarsest; the "
            "analysis says how large and how accurate each level is."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        self.add(
            QgsProcessingParameterNumber("LEVEL", tr("Level"), WHOLE_NUMBER, 0, minValue=0),
            tr("0 is the coarsest; the number of levels is the input itself."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "CELL_SIZE",
                tr("Cell size of the raster"),
                REAL_NUMBER,
                None,
                optional=True,
                minValue=0.0,
            ),
            tr(
                "In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made "
                "from, and for points the mean spacing of the level's vertices."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "TIN", tr("TIN of the level"), POLYGONS, optional=True, createByDefault=True
            ),
            tr("Triangles with mean elevation and slope (degrees)."),
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "VERTICES",
                tr("Vertices of the level"),
                POINTS,
                optional=True,
                createByDefault=False,
            ),
            tr("Points with elevation and attributes; <i>vertex_id</i> is that of the input."),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "RASTER", tr("Raster of the level"), optional=True, createByDefault=False
            ),
            tr("The TIN evaluated at the cell centres, 32-bit floats."),
        )
        add_mesh_parameter(self, tr("Mesh of the level"))
        self.addOutput(QgsProcessingOutputNumber("N_VERTICES", tr("Number of vertices")))
        self.addOutput(QgsProcessingOutputNumber("N_FACES", tr("Number of triangles")))
        add_error_outputs(self, tr("of the surface"))

    def packages(self, request: Request) -> tuple[Package, ...]:
        """Return what writing the mesh needs."""
        return mesh_packages(request)

    def work(self, request: Request) -> Values:
        """Synthesise the level and write what was asked for."""
        from wavelet_gis.workflows.extract import extract

        geo = self.geo_pyramid(request)
        level = checked_level(geo, request.whole("LEVEL") or 0)
        request.progress()(0.3)
        request.stage(tr("Synthesising level {}").format(level))
        surface = extract(geo, level=level)
        request.progress()(0.6)
        results = write_surface(request, surface)
        if not results:
            raise QgsProcessingException(
                tr("No output is chosen; choose a TIN, vertices, a raster or a mesh.")
            )
        return {**surface_figures(surface), **results}
