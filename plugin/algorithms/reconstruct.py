"""A pyramid file becomes the DEM, the point cloud or the TIN that it was made from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import QgsProcessingOutputNumber, QgsProcessingOutputString

from ..base import Values
from ..parameters.request import Request
from ..parameters.restored_output import (
    add_restored_outputs,
    nothing_written,
    restored_packages,
    write_restored,
)
from ..ui.translation import tr
from ._pyramid_input import PyramidAlgorithm

if TYPE_CHECKING:
    from wavelet_gis.workflows.reconstruct import Reconstruction

    from ..ui.dependencies import Package


class Reconstruct(PyramidAlgorithm):
    """Pyramid to what it was made from."""

    GROUP = "reconstruction"

    def name(self) -> str:
        """Return the public id."""
        return "reconstruct"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Reconstruct")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("The DEM, point cloud or TIN that a pyramid was made from, bit for bit")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr("synthesis,inverse,dem,las,laz,tin,wavelet,pyramid,original").split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Synthesises the finest level of a pyramid and gives back what it was made from: the "
            "DEM bit for bit (same numbers, data type, nodata, grid and CRS), the point cloud with "
            "exactly its integers, in its order, or the TIN. A filtered pyramid gives the filtered "
            "terrain. Choose the output that fits the pyramid; the others stay empty."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_pyramid_parameter()
        add_restored_outputs(
            self,
            tr("Reconstructed DEM"),
            tr("Reconstructed point cloud"),
            tr("Reconstructed TIN"),
        )
        self.addOutput(QgsProcessingOutputNumber("N_VERTICES", tr("Number of vertices")))
        self.addOutput(QgsProcessingOutputString("EXACT", tr("'yes' if bit for bit the original")))

    def packages(self, request: Request) -> tuple[Package, ...]:
        """Return laspy where a point cloud is asked for."""
        return restored_packages(request)

    def work(self, request: Request) -> Values:
        """Synthesise, restore, write what was asked for."""
        from wavelet_gis.workflows.reconstruct import reconstruct

        geo = self.geo_pyramid(request, only_input=True)
        request.stage(tr("Restoring the input"))
        restored = request.computed(lambda work: reconstruct(geo), 0.05, 0.6)
        request.stage(tr("Writing {}").format(restored.size))
        results = write_restored(request, restored)
        if not results:
            raise nothing_written(geo)
        figures = {"N_VERTICES": restored.finest.n_vertices, "EXACT": _exactness(restored)}
        return {**figures, **results}


def _exactness(restored: Reconstruction) -> str:
    if restored.is_exact:
        return "yes"
    return "no" if restored.geo.history else "to rounding"
