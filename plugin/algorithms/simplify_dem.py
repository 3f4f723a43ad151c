"""The TIN of a size, or of an accuracy, straight from a raster layer."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from qgis.core import (
    QgsProcessingOutputNumber,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterRasterDestination,
)

from ..base import Values
from ..parameters.analysis_options import add_design_parameters, design_options
from ..parameters.mesh_output import add_mesh_parameter, mesh_packages
from ..parameters.pyramid import add_map_parameter, save
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
from ..ui.enums import POLYGONS, REAL_NUMBER, WHOLE_NUMBER
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from ._dem_input import DemInput
from ._solver_input import (
    add_solver_parameters,
    before_meshing,
    for_solver,
    solver_packages,
    solver_refusal,
    take_sizes,
)

if TYPE_CHECKING:
    from wavelet_gis.model.terrain import Terrain
    from wavelet_gis.workflows.options import WaveletOptions
    from wavelet_gis.workflows.simplify import Simplified
    from wavelet_gis.workflows.tolerance.by_place import MaxError

    from ..qgis_io.background import Work
    from ..ui.dependencies import Package

RULES = ("VERTICES", "MAX_ERROR", "RMSE")
IN_RULES = (*RULES, "ZONES", "TOLERANCE")
#: Share of the vertices that stays where no rule is given.
DEFAULT_SHARE = 0.05


class SimplifyDem(DemInput):
    """DEM to TIN."""

    GROUP = "analysis"
    PAGE = "surface"
    tolerance: LayersByPlace
    sizes: LayersByPlace
    #: Whether the TIN is what a first click gives.
    IS_TIN_BY_DEFAULT: ClassVar[bool] = True

    def name(self) -> str:
        """Return the public id."""
        return "simplifydem"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Simplify DEM to TIN")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("DEM to the TIN or mesh of a size, or of an accuracy, with a small error")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "simplify,thin,generalise,generalize,decimate,reduce,tin,tin from dem,mesh,"
            "mesh from dem,dem to mesh,raster to tin,2dm,dem,level of detail,lod"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Gives the TIN of a number of vertices, or the TIN that is accurate enough, with a "
            "small error at all cells of the DEM. Give one of three: the number of vertices, the "
            "largest error, or the root mean square error; with none, a twentieth of the cells "
            "become vertices."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_input_parameters()
        self.add(
            QgsProcessingParameterNumber(
                "VERTICES", tr("Number of vertices"), WHOLE_NUMBER, None, True, 3
            ),
            tr("The TIN has exactly this many, if it can get there."),
        )
        self.add(
            QgsProcessingParameterNumber(
                "MAX_ERROR", tr("Largest error"), REAL_NUMBER, None, True, 0.0
            ),
            tr("No cell or point is farther above or below the TIN, in the unit of elevation."),
        )
        self.add(
            QgsProcessingParameterNumber("RMSE", tr("RMSE"), REAL_NUMBER, None, True, 0.0),
            tr("Root mean square error over all cells or points, in the unit of elevation."),
        )
        add_tolerance_parameters(self)
        add_design_parameters(self)
        self.add(
            QgsProcessingParameterBoolean("FIT", tr("Fit the heights to all that is given"), True),
            tr(
                "Least squares: the smallest RMSE that these triangles can have. Without it the "
                "TIN is the pyramid's coarsest level as it is; where the largest error is kept "
                "small, heights are those of the input."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterNumber(
                "REFINE",
                tr("Rounds of refinement"),
                WHOLE_NUMBER,
                # edges are turned away from Delaunay's, to which points alone go back
                None if self.IS_TIN_BY_DEFAULT else 0,
                True,
                0,
            ),
            tr(
                "Each moves, replaces and reconnects vertices for a smaller error, or for fewer "
                "vertices within a tolerance. Empty for as many as pay, 0 for none."
            ),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterBoolean(
                "KEEP_POINTS", tr("Vertices are points of the input"), False
            ),
            tr("Height and all, also where the RMSE counts: heights are not fitted."),
            advanced=True,
        )
        add_solver_parameters(self)
        add_cell_size_parameter(
            self,
            tr("In the unit of the CRS; empty for the grid of the DEM, or the spacing of points."),
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                "TIN",
                tr("Simplified TIN"),
                POLYGONS,
                optional=True,
                createByDefault=self.IS_TIN_BY_DEFAULT,
            ),
            tr("Triangles with mean elevation and slope (degrees)."),
        )
        self.add(
            QgsProcessingParameterRasterDestination(
                "RASTER", tr("Raster of the TIN"), optional=True, createByDefault=False
            ),
            tr("The TIN evaluated at the cell centres."),
        )
        add_mesh_parameter(self, tr("Mesh of the TIN"))
        self.add(
            QgsProcessingParameterFileDestination(
                "OUTPUT",
                tr("Pyramid"),
                tr("GeoPackage (*.gpkg)"),
                optional=True,
                createByDefault=False,
            ),
            tr("The reversible pyramid whose coarsest level the TIN was made from."),
            advanced=True,
        )
        add_map_parameter(self)
        self.add_more_outputs()
        self.addOutput(QgsProcessingOutputNumber("N_VERTICES", tr("Number of vertices")))
        self.addOutput(QgsProcessingOutputNumber("N_FACES", tr("Number of triangles")))
        self.addOutput(
            QgsProcessingOutputNumber("N_INPUT_VERTICES", tr("Cells with data, or points"))
        )
        self.addOutput(QgsProcessingOutputNumber("N_LEVELS", tr("Number of levels")))
        add_error_outputs(self, tr("at all cells or points"))

    def add_input_parameters(self) -> None:
        """Declare what is simplified."""
        self.add_dem_parameters()

    def add_more_outputs(self) -> None:
        """Declare outputs that this kind of input has besides."""

    def write_more(self, request: Request, simplified: Simplified) -> Values:
        """Write them."""
        return {}

    def more_options(self, request: Request, terrain: Terrain) -> WaveletOptions:
        """Return options that this kind of input has besides the design."""
        return {}

    def refusal(self, request: Request) -> str | None:
        """Refuse more than one rule."""
        by_place = is_by_place(request)
        rules = request.has("VERTICES"), request.has("MAX_ERROR") or by_place, request.has("RMSE")
        if sum(rules) > 1:
            return tr("Give one of three: the number of vertices, the largest error, or the RMSE.")
        return tolerance_refusal(request) or solver_refusal(request)

    def take_layers(self, request: Request) -> None:
        """Take from the layers, in their own thread, what reading them needs."""
        super().take_layers(request)
        self.tolerance, self.sizes = take_tolerance(request), take_sizes(request)

    def packages(self, request: Request) -> tuple[Package, ...]:
        """Return what writing the mesh needs."""
        return (*mesh_packages(request), *solver_packages(request))

    def work(self, request: Request) -> Values:
        """Read, simplify, measure, write what was asked for."""
        from wavelet_gis.workflows.simplify import simplify

        terrain = self.terrain(request)
        stages = {
            "simplify": tr("Simplifying (the first run also compiles, up to half a minute)"),
            "fit": tr("Refining the TIN"),
            "errors": tr("Measuring the errors"),
        }
        vertices = _vertices(request, terrain)
        max_error: MaxError | None = request.number("MAX_ERROR")
        if is_by_place(request):
            max_error = limits_of(request, self.tolerance, terrain, terrain.mesh)
        max_rms, fit = request.number("RMSE"), request.flag("FIT")
        refine, keep_points = request.whole("REFINE"), request.flag("KEEP_POINTS")
        options: WaveletOptions = {
            **design_options(request),
            **self.more_options(request, terrain),
        }

        def compute(work: Work) -> Simplified:
            show = work.in_log(request.stage)
            return simplify(
                terrain,
                vertices=vertices,
                max_error=max_error,
                max_rms=max_rms,
                fit=fit,
                refine=refine,
                keep_points=keep_points,
                progress=work.progress,
                on_stage=lambda name: show(stages[name]),
                **options,
            )

        tin = request.computed(compute, 0.15, before_meshing(request))
        simplified = for_solver(request, tin, self.sizes)
        figures = {
            **surface_figures(simplified),
            "N_INPUT_VERTICES": terrain.mesh.n_vertices,
            "N_LEVELS": simplified.geo.pyramid.n_levels,
        }
        request.figures = figures
        log_zones(request, simplified)
        results: Values = {}
        path = request.output_file("OUTPUT")
        if path:
            request.stage(tr("Measuring the errors of every level"))
            analysis = request.computed(
                lambda work: simplified.analysis(progress=work.progress), 0.7, 0.75
            )
            save(request, analysis.geo, path, 0.75, 0.9)
            results["OUTPUT"] = path
        results.update(write_surface(request, simplified))
        results.update(self.write_more(request, simplified))
        if not results:
            raise QgsProcessingException(
                tr("No output is chosen; choose a TIN, a raster, a mesh or a pyramid.")
            )
        return {**figures, **results}


def _vertices(request: Request, terrain: Terrain) -> int | None:
    """Return the number of vertices that is wanted; None where another rule is given."""
    if any(request.has(name) for name in IN_RULES):
        return request.whole("VERTICES")
    return max(round(DEFAULT_SHARE * terrain.mesh.n_vertices), 3)
