"""A raster layer becomes a pyramid file."""

from __future__ import annotations

from qgis.core import (
    QgsProcessingParameterBand,
    QgsProcessingParameterRasterLayer,
)

from ..base import TerrainWaveletsAlgorithm
from ..design import add_design_parameters


class AnalyseDem(TerrainWaveletsAlgorithm):
    """DEM to pyramid."""

    GROUP = "analysis"

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
            "Turns a DEM into a reversible wavelet pyramid: a coarse TIN and a layer of details."
        )

    def initAlgorithm(self, configuration=None):
        """Declare parameters and outputs."""
        self.add(
            QgsProcessingParameterRasterLayer("INPUT", self.tr("DEM")),
            self.tr("Raster of elevations. Cells without data become holes."),
        )
        self.add(
            QgsProcessingParameterBand("BAND", self.tr("Band"), 1, "INPUT"),
            self.tr("Band with the elevations."),
        )
        add_design_parameters(self)
