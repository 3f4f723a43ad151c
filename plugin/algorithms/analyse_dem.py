"""A raster layer becomes a pyramid file."""

from __future__ import annotations

from ..ui.translation import tr
from ._analysis import AnalysisAlgorithm
from ._dem_input import DemInput


class AnalyseDem(DemInput, AnalysisAlgorithm):
    """DEM to pyramid."""

    def name(self) -> str:
        """Return the public id."""
        return "analysedem"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Analyse DEM")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("DEM to a reversible pyramid of TINs with details by scale")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "dem,dtm,raster,tin from dem,pyramid,wavelet,multiresolution,level of detail,analyze"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Turns a DEM into a reversible wavelet pyramid: a coarse TIN and one layer of details "
            "for each level of resolution, in one GeoPackage. From it <i>Extract level</i> gives "
            "the terrain at any level and <i>Reconstruct</i> the DEM itself, bit for bit."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_dem_parameters()
        self.add_analysis_parameters()
