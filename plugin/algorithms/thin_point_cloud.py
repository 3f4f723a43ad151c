"""A point cloud to those of its points that carry its surface best."""

from __future__ import annotations

from ..ui.translation import tr
from .simplify_point_cloud import SimplifyPointCloud


class ThinPointCloud(SimplifyPointCloud):
    """Point cloud file to fewer points."""

    IS_TIN_BY_DEFAULT = False

    def name(self) -> str:
        """Return the public id."""
        return "thinpointcloud"

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return tr("Thin point cloud")

    def shortDescription(self) -> str:
        """Return what it does in one line."""
        return tr("LAS, LAZ or COPC file to those of its points that carry its surface best")

    def tags(self) -> list[str]:
        """Return the words under which the toolbox finds it."""
        return tr(
            "thin,thinning,decimate,subsample,reduce,simplify,generalise,generalize,las,laz,lidar,"
            "point cloud,ground,key points,model key points"
        ).split(",")

    def about(self) -> str:
        """Return what it does."""
        return tr(
            "Writes the points of a LAS, LAZ or COPC file that carry its surface best, exactly as "
            "they were, with all their dimensions: few on plains, many on banks. The ground is "
            "taken where the file has it marked. Give one of three: the number of points, the "
            "largest error, or the root mean square error of the surface through them; with none, "
            "a twentieth stays."
        )
