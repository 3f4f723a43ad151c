"""The TIN of a size, or of an accuracy, of a point cloud, and the points that carry it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import QgsProcessingOutputNumber, QgsProcessingParameterFileDestination

from ..base import Values
from ..parameters.request import Request
from ..parameters.tolerance import take_tolerance
from ..ui import dependencies
from ..ui.translation import tr
from ._cloud_input import CloudInput
from ._solver_input import take_sizes
from .simplify_dem import SimplifyDem

if TYPE_CHECKING:
    from wavelet_gis.model.terrain import Terrain
    from wavelet_gis.workflows.options import WaveletOptions
    from wavelet_gis.workflows.simplify import Simplified


class SimplifyPointCloud(CloudInput, SimplifyDem):
    """Point cloud file to TIN, and to fewer points."""

    TAKES_GROUND = True

    def name(self) -> str:
        """Return the public id."""
        return "simplifypointcloud"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Simplify point cloud to TIN")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("LAS, LAZ or COPC file to the TIN of a size or an accuracy, and fewer points")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "simplify,thin,thin point cloud,generalise,generalize,decimate,reduce,las,laz,lidar,"
            "point cloud,ground,tin,tin from point cloud,mesh,2dm,dtm,level of detail,lod"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Gives the TIN of a number of vertices, or the TIN that is accurate enough, of the "
            "ground points of a LAS, LAZ or COPC file, and the points of the file that carry it: "
            "few on plains, many on banks. Give one of three: the number of vertices, the largest "
            "error, or the root mean square error; with none, a twentieth of the points stay."
        )

    def add_input_parameters(self) -> None:
        """Declare the file and what is taken of it."""
        self.add_cloud_parameters()

    def add_more_outputs(self) -> None:
        """Declare the thinned file."""
        self.add(
            QgsProcessingParameterFileDestination(
                "THINNED",
                tr("Thinned point cloud"),
                tr("LAS (*.las);;LAZ (*.laz)"),
                optional=True,
                createByDefault=not self.IS_TIN_BY_DEFAULT,
            ),
            tr(
                "The points that are the vertices of the TIN, exactly as they were, with all their "
                "dimensions. Triangulated again they give other triangles: where a largest error "
                "is asked for, points are added until those keep it too. LAZ needs the Python "
                "package lazrs."
            ),
        )
        for name, description in (
            ("N_THINNED", tr("Points of the thinned point cloud")),
            ("RMSE_THINNED", tr("RMSE of the Delaunay TIN of the thinned points")),
            ("MAX_ERROR_THINNED", tr("Largest error of the Delaunay TIN of the thinned points")),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, description))

    def refusal(self, request: Request) -> str | None:
        """Refuse more than one rule, and what cannot be read."""
        return SimplifyDem.refusal(self, request) or CloudInput.refusal(self, request)

    def take_layers(self, request: Request) -> None:
        """Take from the layers, in their own thread, what reading them needs."""
        CloudInput.take_layers(self, request)
        self.tolerance, self.sizes = take_tolerance(request), take_sizes(request)

    def packages(self, request: Request) -> tuple[dependencies.Package, ...]:
        """Return what reading and writing the files needs."""
        of_mesh = SimplifyDem.packages(self, request)
        of_cloud = dependencies.for_las(request.output_file("THINNED"))
        return (*CloudInput.packages(self, request), *of_cloud, *of_mesh)

    def more_options(self, request: Request, terrain: Terrain) -> WaveletOptions:
        """Return the weights of the attributes."""
        return CloudInput.more_options(self, request, terrain)

    def write_more(self, request: Request, simplified: Simplified) -> Values:
        """Write the thinned file."""
        from wavelet_gis.workflows.save import save

        path = request.output_file("THINNED")
        if not path:
            return {}
        max_error = simplified.limits
        request.stage(tr("Measuring the Delaunay TIN of the points that stay"))
        thinned = request.computed(
            lambda work: simplified.thinned(max_error, work.progress), 0.9, 0.98
        )
        request.stage(tr("Writing {}").format(tr("the thinned point cloud")))
        save(thinned, path, overwrite=True)
        return {
            "THINNED": path,
            "N_THINNED": thinned.cloud.n_points,
            "RMSE_THINNED": thinned.errors.rmse,
            "MAX_ERROR_THINNED": thinned.errors.max_error,
        }
