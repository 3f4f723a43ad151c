"""A surface written as a raster or as a mesh file."""

from __future__ import annotations

import os

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingUtils,
)

from . import styles
from .pyramids import crs_of
from .translation import tr

#: Stands for no data in rasters that are made here.
NODATA = -9999.0


def write_raster(algorithm, parameters, name, context, record, surface, feedback) -> str:
    """Write the surface, in the CRS of the input, as a raster and return its path.

    The grid is that of the DEM the record came from, or, with CELL_SIZE, one over the surface.
    """
    import numpy as np
    from wavelet_gis.dem import Dem
    from wavelet_gis.rasterise import rasterise

    from .rasters import write_dem

    path = algorithm.parameterAsOutputLayer(parameters, name, context)
    geometry = _geometry(algorithm, parameters, context, record, surface)
    values = rasterise(surface, geometry)
    valid = np.isfinite(values)
    values[~valid] = NODATA
    dem = Dem(values.astype(np.float32), valid, geometry, NODATA)
    write_dem(path, dem, crs_of(record), feedback)
    styles.style_output(context, path, styles.HILLSHADE)
    return path


def _geometry(algorithm, parameters, context, record, surface):
    from wavelet_gis.rasterise import geometry_over

    cell_size = 0.0
    if parameters.get("CELL_SIZE") is not None:
        cell_size = algorithm.parameterAsDouble(parameters, "CELL_SIZE", context)
    if cell_size == 0.0 and record.source.kind == "raster":
        return record.source.geometry
    if cell_size == 0.0:
        raise QgsProcessingException(
            tr("A raster of a pyramid that was made from points needs a cell size; give one.")
        )
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    return geometry_over((low[0], low[1], high[0], high[1]), cell_size)


def write_mesh_file(algorithm, parameters, name, context, record, surface) -> str:
    """Write the surface as a mesh file; a 2DM opens as a mesh layer where a project is at hand."""
    from wavelet_gis.atomic import new_file
    from wavelet_gis.meshfiles import write_mesh

    path = algorithm.parameterAsFileOutput(parameters, name, context)
    with new_file(path, overwrite=True) as scratch:
        write_mesh(scratch, surface, record.system.wkt)
    if path.lower().endswith(".2dm") and context.project() is not None:
        details = QgsProcessingContext.LayerDetails(
            os.path.splitext(os.path.basename(path))[0],
            context.project(),
            name,
            QgsProcessingUtils.LayerHint.Mesh,
        )
        context.addLayerToLoadOnCompletion(path, details)
        styles.style_output(context, path, styles.MESH)
    return path
