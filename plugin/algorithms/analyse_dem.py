"""A raster layer becomes a pyramid file."""

from __future__ import annotations

from ._analysis import AnalysisAlgorithm
from ._dem_input import DemInput


class AnalyseDem(DemInput, AnalysisAlgorithm):
    """DEM to pyramid."""

    def name(self):
        """Return the public id."""
        return "analysedem"

    def displayName(self):
        """Return the name in the toolbox."""
        return self.tr("Analyse DEM")

    def tags(self):
        """Return the words under which the toolbox finds it."""
        return self.tr("dem,raster,tin,pyramid,wavelet,multiresolution,level of detail").split(",")

    def about(self):
        """Return what it does."""
        return self.tr(
            "Turns a DEM into a reversible wavelet pyramid: a coarse TIN and one layer of details "
            "for each level of resolution, in one GeoPackage. From it <i>Extract level</i> gives "
            "the terrain at any level and <i>Reconstruct</i> the DEM itself, bit for bit."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        self.add_dem_parameters()
        self.add_analysis_parameters()
