"""What a pyramid was made from, written to the outputs of an algorithm."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterRasterDestination,
)

from ..ui import dependencies
from ..ui.enums import POLYGONS
from ..ui.exceptions import QgsProcessingException
from ..ui.translation import tr
from .pyramid import crs_of

if TYPE_CHECKING:
    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.workflows.reconstruct import Reconstruction

    from ..base import TerrainWaveletsAlgorithm
    from .request import Request


def add_restored_outputs(
    algorithm: TerrainWaveletsAlgorithm, dem_name: str, cloud_name: str, tin_name: str
) -> None:
    """Declare DEM, POINT_CLOUD and TIN, of which the one that fits the pyramid is written."""
    algorithm.add(
        QgsProcessingParameterRasterDestination(
            "DEM", dem_name, optional=True, createByDefault=True
        ),
        tr("For a pyramid of a DEM."),
    )
    algorithm.add(
        QgsProcessingParameterFileDestination(
            "POINT_CLOUD",
            cloud_name,
            tr("LAZ (*.laz);;LAS (*.las)"),
            optional=True,
            createByDefault=False,
        ),
        tr("For a pyramid of a point cloud file. Needs the Python package laspy."),
    )
    algorithm.add(
        QgsProcessingParameterFeatureSink(
            "TIN", tin_name, POLYGONS, optional=True, createByDefault=False
        ),
        tr("The triangles of the finest level, for a pyramid of any kind."),
    )


def restored_packages(request: Request) -> tuple[dependencies.Package, ...]:
    """Return what writing the point cloud needs, where one is wanted."""
    if not request.wants("POINT_CLOUD"):
        return ()
    return dependencies.for_las(request.output_file("POINT_CLOUD"))


def write_restored(request: Request, restored: Reconstruction) -> dict[str, Any]:
    """Write what was asked for and fits the pyramid; return where it is, by the output's name."""
    from . import tin_output

    results = {}
    write = {"raster": _write_dem, "points": _write_cloud, "tin": _write_nothing_more}
    results.update(write[restored.geo.origin.kind](request, restored))
    if request.wants("TIN"):
        level = restored.geo.pyramid.n_levels
        results["TIN"] = tin_output.write_level(request, "TIN", restored.geo, level)
    return results


def nothing_written(geo: GeoPyramid) -> QgsProcessingException:
    """Return what to say to a user who chose no output that fits the pyramid."""
    texts = {
        "raster": tr("This pyramid was made from a DEM; choose where the DEM goes."),
        "points": tr(
            "This pyramid was made from a point cloud; choose a file for the point cloud, or take "
            "the TIN."
        ),
        "tin": tr("This pyramid was made from a TIN; choose where the TIN goes."),
    }
    return QgsProcessingException(texts[geo.origin.kind])


def _write_dem(request: Request, restored: Reconstruction) -> dict[str, Any]:
    from wavelet_gis.model.dem import Dem

    from ..qgis_io.raster_writer import write_dem
    from ..ui import layer_styles as styles

    path = request.output_layer("DEM")
    if not path:
        return {}
    assert isinstance(restored.original, Dem)
    write_dem(
        path, restored.original, crs_of(restored.geo), request.feedback, request.progress(0.9, 0.95)
    )
    # Details without the coarsest surface, and a change, are about zero: no terrain to be shaded.
    is_difference = request.flag("DROP_COARSE") or request.text("LOOK") == "difference"
    style = styles.style_difference if is_difference else styles.style_hillshade
    request.finish("DEM", path, style)
    return {"DEM": path}


def _write_cloud(request: Request, restored: Reconstruction) -> dict[str, Any]:
    from wavelet_gis.workflows.save import save

    path = request.output_file("POINT_CLOUD")
    if not path:
        return {}
    save(restored, path, overwrite=True)
    return {"POINT_CLOUD": path}


def _write_nothing_more(request: Request, restored: Reconstruction) -> dict[str, Any]:
    """Return nothing: a TIN goes to the output TIN, which any pyramid has."""
    return {}
