"""What a pyramid was made from, written to the outputs of an algorithm."""

from __future__ import annotations

from qgis.core import (
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterRasterDestination,
)

from ..ui.translation import tr


def add_restored_outputs(algorithm, dem_name, cloud_name, tin_name) -> None:
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
            "TIN",
            tin_name,
            QgsProcessing.SourceType.TypeVectorPolygon,
            optional=True,
            createByDefault=False,
        ),
        tr("The triangles of the finest level, for a pyramid of any kind."),
    )


def write_restored(algorithm, parameters, context, geo, finest, feedback) -> dict:
    """Write what was asked for and fits the pyramid.

    Parameters
    ----------
    algorithm : TerrainWaveletsAlgorithm
    parameters : dict
    context : QgsProcessingContext
    geo : GeoPyramid
    finest : TriangleMesh
        Its finest level.
    feedback : QgsProcessingFeedback

    Returns
    -------
    dict
        The outputs that were written, by name.
    """
    from . import tin_output

    results = {}
    if geo.origin.kind == "raster":
        results.update(_write_dem(algorithm, parameters, context, geo, finest, feedback))
    elif geo.origin.kind == "points":
        results.update(_write_cloud(algorithm, parameters, context, geo, finest))
    if parameters.get("TIN"):
        results["TIN"] = tin_output.write_tin(
            algorithm, parameters, "TIN", context, geo, geo.pyramid.n_levels, feedback
        )
    return results


def nothing_written(kind: str) -> QgsProcessingException:
    """Return what to tell a user who chose no output that fits the pyramid."""
    if kind == "raster":
        text = tr("This pyramid was made from a DEM; choose where the DEM goes.")
    elif kind == "points":
        text = tr(
            "This pyramid was made from a point cloud; choose a file for the point cloud, or take "
            "the TIN."
        )
    else:
        text = tr("This pyramid was made from a TIN; choose where the TIN goes.")
    return QgsProcessingException(text)


def _write_dem(algorithm, parameters, context, geo, finest, feedback) -> dict:
    from ..qgis_io import raster_writer as raster_output
    from ..ui import layer_styles as styles
    from .pyramid import crs_of

    path = algorithm.parameterAsOutputLayer(parameters, "DEM", context)
    if not path:
        return {}
    dem = geo.origin.restore(finest, geo.frame)
    raster_output.write_dem(path, dem, crs_of(geo), feedback)
    styles.style_output(context, path, styles.style_hillshade)
    return {"DEM": path}


def _write_cloud(algorithm, parameters, context, geo, finest) -> dict:
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.io.las import write_cloud

    path = algorithm.parameterAsFileOutput(parameters, "POINT_CLOUD", context)
    if not path:
        return {}
    with new_file(path, overwrite=True) as scratch:
        write_cloud(scratch, geo.origin.restore(finest, geo.frame))
    return {"POINT_CLOUD": path}
