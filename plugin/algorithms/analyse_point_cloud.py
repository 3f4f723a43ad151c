"""A LAS, LAZ or COPC file becomes a pyramid file."""

from __future__ import annotations

from ..ui.translation import tr
from ._analysis import AnalysisAlgorithm
from ._cloud_input import CloudInput


class AnalysePointCloud(CloudInput, AnalysisAlgorithm):
    """Point cloud file to pyramid."""

    def name(self) -> str:
        """Return the public id."""
        return "analysepointcloud"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Analyse point cloud")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("LAS, LAZ or COPC file to a reversible pyramid of TINs with details by scale")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "las,laz,copc,lidar,point cloud,tin,pyramid,wavelet,multiresolution,analyze"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Triangulates the points of a LAS, LAZ or COPC file and turns them into a reversible "
            "wavelet pyramid. Attributes such as class, intensity, colour or height above ground "
            "are transformed together with the elevation. <i>Reconstruct</i> gives the file back "
            "with exactly its integers."
        )

    def declare(self) -> None:
        """Declare parameters and outputs."""
        self.add_cloud_parameters()
        self.add_analysis_parameters()
