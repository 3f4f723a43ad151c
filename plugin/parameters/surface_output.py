"""A surface out of a pyramid: its figures, and its way to every output that is wanted."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from qgis.core import QgsProcessingOutputNumber, QgsProcessingParameterNumber

from ..ui.enums import REAL_NUMBER
from ..ui.translation import tr
from . import mesh_output, tin_output

if TYPE_CHECKING:
    from wavelet_gis.workflows.extract import Surface

    from ..base import TerrainWaveletsAlgorithm
    from .request import Request

#: What a surface is written to, in this order, and the part of the rest of the bar that it takes
#: where an algorithm has something to write besides.
OUTPUTS, BEFORE_MORE = ("TIN", "VERTICES", "RASTER", "MESH"), 0.95


def add_cell_size_parameter(algorithm: TerrainWaveletsAlgorithm, description: str = "") -> None:
    """Declare CELL_SIZE, of a raster that is written; the description says what holds without."""
    description = description or tr(
        "In the unit of the CRS. Empty for the grid of the DEM that the pyramid was made "
        "from, and for points their mean spacing."
    )
    algorithm.add(
        QgsProcessingParameterNumber(
            "CELL_SIZE",
            tr("Cell size of the raster"),
            REAL_NUMBER,
            None,
            optional=True,
            minValue=0.0,
        ),
        description,
        advanced=True,
    )


def add_error_outputs(algorithm: TerrainWaveletsAlgorithm, where: str) -> None:
    """Declare the errors that `surface_figures` returns; ``where`` they are measured."""
    for name, description in (
        ("RMSE_SURFACE", tr("RMSE {}, in the unit of elevation").format(where)),
        ("MAX_ERROR_SURFACE", tr("Largest error {}, in the unit of elevation").format(where)),
        ("N_UNCOVERED", tr("Input points that the surface does not cover")),
    ):
        algorithm.addOutput(QgsProcessingOutputNumber(name, description))


def surface_figures(surface: Surface) -> dict[str, Any]:
    """Return size and errors of a surface; no errors where they are not known."""
    figures: dict[str, Any] = {
        "N_VERTICES": surface.mesh.n_vertices,
        "N_FACES": surface.mesh.n_faces,
    }
    if surface.errors is not None:
        figures["RMSE_SURFACE"] = surface.errors.rmse
        figures["MAX_ERROR_SURFACE"] = surface.errors.max_error
        figures["N_UNCOVERED"] = surface.errors.n_uncovered
    return figures


def write_surface(request: Request, surface: Surface) -> dict[str, str]:
    """Write a surface to the outputs TIN, VERTICES, RASTER and MESH, those that are wanted.

    Each has as much of what is left of the bar as the others.
    """
    request.begins_at(0.0)
    wanted = [name for name in OUTPUTS if request.wants(name)]
    width = BEFORE_MORE / max(len(wanted), 1)
    parts = {name: (k * width, (k + 1) * width) for k, name in enumerate(wanted)}
    results = tin_output.write_surface(request, surface, parts)
    if "RASTER" in parts:
        results["RASTER"] = mesh_output.write_raster(request, "RASTER", surface, *parts["RASTER"])
    if "MESH" in parts:
        results["MESH"] = mesh_output.write_mesh_file(request, "MESH", surface, *parts["MESH"])
    return results
