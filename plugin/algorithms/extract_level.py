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
from ..parameters.pyramid import checked_level, log_levels
from ..parameters.request import Request
from ..parameters.surface_output import (
    add_cell_size_parameter,
    add_error_outputs,
    surface_figures,
    write_surface,
)
from ..parameters.tolerance import (
    LayersByPlace,
    add_tolerance_parameters,
    is_by_place,
    limits_of,
    log_zones,
    take_tolerance,
    tolerance_refusal,
)
from ..ui.enums import POINTS, POLYGONS, REAL_NUMBER, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.workflows.extract import Surface
    from wavelet_gis.workflows.tolerance.by_place import MaxError

    from ..qgis_io.background import Work
    from ..ui.dependencies import Package


class ExtractLevel(PyramidAlgorithm):
    """Pyramid to the surface at one level."""

    tolerance: LayersByPlace

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
            "vertices, a raster or a mesh file for hydraulic models. Instead of a level, give a "
            "number of vertices or the largest error, and you get a size between two levels. The "
            "log shows how large and how accurate each level is; level 0 is the coarsest."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter("LEVEL")
        self.add(
            QgsProcessingParameterNumber("LEVEL", tr("Level"), WHOLE_NUMBER, 0, minValue=0),
            tr(
                "0 is the coarsest; the number of levels is the input itself. In the dialog, click "
                "a row of the table of levels."
            ),
        )
        self.add(
            QgsProcessingParameterNumber(
                "VERTICES_WANTED", tr("Number of vertices"), WHOLE_NUMBER, None, True, 1
            ),
            tr("Instead of a level: exactly this many, from those of the coarsest level to all."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "MAX_ERROR", tr("Largest error"), REAL_NUMBER, None, True, 0.0
            ),
            tr(
                "Instead of a level: the smallest size found at which no input point is farther "
                "above or below the surface, in the unit of elevation."
            ),
        )
        add_tolerance_parameters(self)
        self.add(
            QgsProcessingParameterNumber(
                "REFINE", tr("Rounds of refinement"), WHOLE_NUMBER, 0, minValue=0
            ),
            tr(
                "With the largest error: how often edges are turned, vertices moved, and taken out "
                "where it allows. Vertices are then points of the input."
            ),
            advanced=True,
        )
        add_cell_size_parameter(
            self,
            tr(
                "In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made "
                "from, and for points the mean spacing of the level's vertices."
            ),
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
        self.addOutput(
            QgsProcessingOutputNumber("FOUND_LEVEL", tr("Level, or the finer one of two"))
        )
        add_error_outputs(self, tr("of the surface"))

    def refusal(self, request: Request) -> str | None:
        """Refuse more than one rule."""
        has_error = request.has("MAX_ERROR") or is_by_place(request)
        rules = [request.has("VERTICES_WANTED"), has_error, request.whole("LEVEL")]
        if sum(map(bool, rules)) > 1:
            return tr("Give one of three: a level, a number of vertices, or the largest error.")
        if request.whole("REFINE") and not has_error:
            return tr("Rounds of refinement are of the largest error; give both or none.")
        return tolerance_refusal(request) or super().refusal(request)

    def take_layers(self, request: Request) -> None:
        """Take from the layers, in their own thread, what reading them needs."""
        self.tolerance = take_tolerance(request)

    def packages(self, request: Request) -> tuple[Package, ...]:
        """Return what writing the mesh needs."""
        return mesh_packages(request)

    def work(self, request: Request) -> Values:
        """Synthesise the level and write what was asked for."""
        from wavelet_gis.workflows.extract import extract

        vertices = request.whole("VERTICES_WANTED")
        max_error: MaxError | None = request.number("MAX_ERROR")
        by_place = is_by_place(request)
        is_level = vertices is None and max_error is None and not by_place
        geo = self.geo_pyramid(request, (request.whole("LEVEL") or 0) if is_level else None)
        log_levels(request, geo)
        request.stage(tr("Synthesising the surface"))
        level = checked_level(geo, request.whole("LEVEL") or 0) if is_level else None
        if by_place:
            finest = request.computed(lambda work: geo.pyramid.synthesise(), 0.05, 0.1)
            max_error = limits_of(request, self.tolerance, geo, finest)
        refine = request.whole("REFINE")

        def compute(work: Work) -> Surface:
            return extract(
                geo,
                level=level,
                vertices=vertices,
                max_error=max_error,
                refine=refine,
                progress=work.progress,
            )

        surface = request.computed(compute, 0.1, 0.6)
        log_zones(request, surface)
        request.figures = {**surface_figures(surface), "FOUND_LEVEL": surface.level}
        results = write_surface(request, surface)
        if not results:
            raise QgsProcessingException(
                tr("No output is chosen; choose a TIN, vertices, a raster or a mesh.")
            )
        return {**request.figures, **results}
