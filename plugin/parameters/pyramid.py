"""Pyramid files in and out, and what algorithms say of them in numbers."""

from __future__ import annotations

import os
from itertools import chain

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsProcessingException,
    QgsProcessingOutputNumber,
)

from ..qgis_io.crs_and_progress import is_geocentric, progress
from ..ui.translation import tr


def load(path: str):
    """Return the ``GeoPyramid`` in a pyramid file."""
    from wavelet_gis.io.pyramid_file import read_pyramid

    # A layer of the file may have been handed on by a model, as 'file.gpkg|layername=coarse_tin'.
    return read_pyramid(path.split("|")[0])


def save(geo, path: str, feedback, start: float, stop: float) -> None:
    """Write a pyramid with its layers as a GeoPackage, whole or not at all; it replaces another."""
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.io.pyramid_file import write_pyramid
    from wavelet_gis.products.layers import coarse_layers, detail_layers

    from ..qgis_io.geopackage import add_layers

    middle = (start + stop) / 2
    with new_file(path, overwrite=True) as scratch:
        write_pyramid(scratch, geo, progress(feedback, start, middle))
        layers = chain(coarse_layers(geo), detail_layers(geo))
        add_layers(scratch, layers, layer_wkt(geo), feedback)
    progress(feedback, middle, stop)(1.0)


def crs_of(geo) -> QgsCoordinateReferenceSystem:
    """Return the CRS of a pyramid's input; an invalid one where it had none."""
    wkt = layer_wkt(geo)
    return QgsCoordinateReferenceSystem.fromWkt(wkt) if wkt else QgsCoordinateReferenceSystem()


def layer_wkt(geo) -> str | None:
    """Return the CRS for layers; None also for a geocentric one, in which no map is drawn."""
    wkt = geo.system.wkt
    return None if wkt is None or is_geocentric(wkt) else wkt


def cell_size(algorithm, parameters, context):
    """Return the parameter CELL_SIZE, or None where it is empty or 0."""
    if parameters.get("CELL_SIZE") is None:
        return None
    return algorithm.parameterAsDouble(parameters, "CELL_SIZE", context) or None


def checked_level(geo, level: int) -> int:
    """Return a level that the pyramid has.

    Raises
    ------
    QgsProcessingException
        When there is no such level.
    """
    n_levels = geo.pyramid.n_levels
    if not 0 <= level <= n_levels:
        raise QgsProcessingException(
            tr("There is no level {}; the levels of this pyramid are 0 (coarsest) to {}.").format(
                level, n_levels
            )
        )
    return level


def add_figure_outputs(algorithm) -> None:
    """Declare the numbers that `figures` returns."""
    for name, description in (
        ("N_LEVELS", tr("Number of levels")),
        ("N_VERTICES", tr("Vertices of the input")),
        ("N_FACES", tr("Triangles of the input")),
        ("COARSE_VERTICES", tr("Vertices of the coarsest level")),
        ("COARSE_FACES", tr("Triangles of the coarsest level")),
        (
            "RMSE_SURFACE",
            tr("RMSE of the coarsest surface at all input points, in the unit of elevation"),
        ),
        (
            "MAX_ERROR_SURFACE",
            tr("Largest error of the coarsest surface, in the unit of elevation"),
        ),
        ("RMSE_COEFFICIENTS", tr("RMSE of the coefficients at the coarsest level (no unit)")),
    ):
        algorithm.addOutput(QgsProcessingOutputNumber(name, description))


def figures(geo) -> dict:
    """Return sizes and errors of a pyramid whose errors have been computed."""
    coarsest, finest = geo.errors[0], geo.errors[-1]
    return {
        "N_LEVELS": geo.pyramid.n_levels,
        "N_VERTICES": finest.n_vertices,
        "N_FACES": finest.n_faces,
        "COARSE_VERTICES": coarsest.n_vertices,
        "COARSE_FACES": coarsest.n_faces,
        "RMSE_SURFACE": coarsest.rmse_surface,
        "MAX_ERROR_SURFACE": coarsest.max_error_surface,
        "RMSE_COEFFICIENTS": coarsest.rmse_coefficients,
    }


def level_figures(geo, level: int) -> dict:
    """Return the errors of a level as the file tells them; empty where it does not."""
    for errors in geo.errors or ():
        if errors.level == level:
            return {
                "RMSE_SURFACE": errors.rmse_surface,
                "MAX_ERROR_SURFACE": errors.max_error_surface,
            }
    return {}


def log_levels(geo, feedback) -> None:
    """Write the table of levels to the log."""
    feedback.pushInfo(tr("level   vertices  triangles  RMSE of surface  largest error"))
    for errors in reversed(geo.errors):
        feedback.pushInfo(
            f"{errors.level:5d} {errors.n_vertices:10d} {errors.n_faces:10d} "
            f"{errors.rmse_surface:16.4f} {errors.max_error_surface:14.4f}"
        )


def default_name(path: str) -> str:
    """Return the file's name without folder and suffix."""
    return os.path.splitext(os.path.basename(path))[0]
