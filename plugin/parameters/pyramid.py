"""Pyramid files in and out, and what algorithms say of them in figures."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsProcessingContext,
    QgsProcessingOutputNumber,
    QgsProcessingParameterBoolean,
)

from ..qgis_io.crs_and_progress import is_geocentric
from ..qgis_io.geopackage import layer_names
from ..ui.exceptions import QgsProcessingException
from ..ui.known_pyramids import remember
from ..ui.translation import tr

if TYPE_CHECKING:
    from wavelet_gis.model.dem import Dem
    from wavelet_gis.model.geo_pyramid import GeoPyramid

    from ..base import TerrainWaveletsAlgorithm
    from ..qgis_io.background import Work
    from ..qgis_io.raster_reader import RasterInput
    from .request import Request

#: Part of the writing that has gone when the file is handed to the disk.
BEFORE_SYNC = 0.9


def save(
    request: Request,
    geo: GeoPyramid,
    path: str,
    start: float,
    stop: float,
    layers: str = "auto",
) -> None:
    """Write a pyramid with its layers as a GeoPackage, whole or not at all; it replaces another.

    Parameters
    ----------
    request : Request
        Shows the progress.
    geo : GeoPyramid
        What to write.
    path : str
        Where to.
    start, stop : float
        The part of the whole work that this is.
    layers : {"auto", "all", "coarse", "none"}
        See `wavelet_gis.products.layers.pyramid_layers`.
    """
    request.stage(tr("Writing the pyramid"))
    request.computed(partial(_write, geo=geo, path=path, layers=layers), start, stop)
    remember(path)
    _add_to_map(request, path)


def _write(work: Work, geo: GeoPyramid, path: str, layers: str) -> None:
    """Write a pyramid and its layers, in the thread of the work."""
    from wavelet_gis.io.atomic import new_file
    from wavelet_gis.io.pyramid.pyramid_file import SHARE_OF_WRITING, write_pyramid
    from wavelet_gis.io.read_back import read_back
    from wavelet_gis.products.layers import n_features, pyramid_layers

    from ..qgis_io.crs_and_progress import require_running
    from ..qgis_io.geopackage import add_layers

    # a vertex of the pyramid and a row of a layer take about as long; it is read back after both
    n_vertices, n_rows = geo.pyramid.n_vertices(geo.pyramid.n_levels), n_features(geo, layers)
    of_pyramid = n_vertices / (n_vertices + n_rows)
    middle, last = SHARE_OF_WRITING * of_pyramid, 1.0 - (1.0 - SHARE_OF_WRITING) * of_pyramid

    def report(fraction: float) -> bool:
        return work.progress(BEFORE_SYNC * fraction)

    def of_pyramid_file(fraction: float) -> bool:
        if fraction <= SHARE_OF_WRITING:
            return report(middle * fraction / SHARE_OF_WRITING)
        return report(1.0 - (1.0 - last) * (1.0 - fraction) / (1.0 - SHARE_OF_WRITING))

    def of_layers(fraction: float) -> bool:
        return report(middle + (last - middle) * fraction)

    with new_file(path, overwrite=True) as scratch:
        is_alone = layers == "none"
        write_pyramid(scratch, geo, of_pyramid_file, is_alone=is_alone)
        if not is_alone:
            rows = pyramid_layers(geo, layers)
            add_layers(scratch, rows, layer_wkt(geo), work, of_layers, n_rows)
        read_back(scratch, lambda _: require_running(work))  # the last moment to stop it


def add_map_parameter(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare ADD_TO_MAP, at which `save` looks."""
    algorithm.add(
        QgsProcessingParameterBoolean("ADD_TO_MAP", tr("Add the pyramid to the map"), False),
        tr("Opens the layers in the pyramid file, with their styles, when it is written."),
        advanced=True,
    )


def _add_to_map(request: Request, path: str) -> None:
    """Let the layers of a pyramid file open, where that was asked for and there is a map."""
    project = request.context.project()
    if not request.flag("ADD_TO_MAP") or project is None:
        return
    for name in layer_names(path):
        details = QgsProcessingContext.LayerDetails(name, project, name)
        request.context.addLayerToLoadOnCompletion(f"{path}|layername={name}", details)


def crs_of(geo: GeoPyramid) -> QgsCoordinateReferenceSystem:
    """Return the CRS of a pyramid's input; an invalid one where it had none."""
    wkt = layer_wkt(geo)
    return QgsCoordinateReferenceSystem.fromWkt(wkt) if wkt else QgsCoordinateReferenceSystem()


def dem_beside(request: Request, geo: GeoPyramid, raster: RasterInput) -> Dem:
    """Return a DEM to hold against a pyramid, in whose CRS it must lie.

    Raises
    ------
    QgsProcessingException
        It has another CRS.
    """
    from ..qgis_io.raster_reader import read_dem

    own = crs_of(geo)
    if raster.crs.isValid() and own.isValid() and raster.crs != own:
        raise QgsProcessingException(
            tr("{}: its CRS is {}, that of the pyramid is {}; reproject it.").format(
                raster.name, raster.crs.userFriendlyIdentifier(), own.userFriendlyIdentifier()
            )
        )
    if raster.crs.isValid() != own.isValid():
        request.feedback.pushWarning(
            tr(
                "{}: of this layer and the terrain only one has a CRS, so their coordinates "
                "are taken to be alike (assign the CRS that is missing)"
            ).format(raster.name)
        )
    return read_dem(raster, request.feedback)


def layer_wkt(geo: GeoPyramid) -> str | None:
    """Return the CRS for layers; None also for a geocentric one, in which no map is drawn."""
    wkt = geo.system.wkt
    return None if wkt is None or is_geocentric(wkt) else wkt


def checked_level(geo: GeoPyramid, level: int) -> int:
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


def add_figure_outputs(algorithm: TerrainWaveletsAlgorithm) -> None:
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
        ("N_UNCOVERED", tr("Input points that the coarsest surface does not cover")),
    ):
        algorithm.addOutput(QgsProcessingOutputNumber(name, description))


def figures(geo: GeoPyramid) -> dict[str, Any]:
    """Return sizes and errors of a pyramid whose errors have been measured."""
    coarsest, finest = geo.errors_at(0), geo.errors_at(geo.pyramid.n_levels)
    assert coarsest is not None
    assert finest is not None
    return {
        "N_LEVELS": geo.pyramid.n_levels,
        "N_VERTICES": finest.n_vertices,
        "N_FACES": finest.n_faces,
        "COARSE_VERTICES": coarsest.n_vertices,
        "COARSE_FACES": coarsest.n_faces,
        "RMSE_SURFACE": coarsest.rmse_surface,
        "MAX_ERROR_SURFACE": coarsest.max_error_surface,
        "RMSE_COEFFICIENTS": coarsest.rmse_coefficients,
        "N_UNCOVERED": coarsest.n_uncovered,
    }


def log_levels(request: Request, geo: GeoPyramid) -> None:
    """Write the table of levels to the log, with their errors where they are known."""
    if not geo.errors:  # they are measured on request only
        request.say(tr("level   vertices"))
        for level in range(geo.pyramid.n_levels + 1):
            request.say(f"{level:5d} {geo.pyramid.n_vertices(level):10d}")
        return
    request.say(tr("level   vertices  triangles  RMSE of surface  largest error"))
    for errors in geo.errors:
        request.say(
            f"{errors.level:5d} {errors.n_vertices:10d} {errors.n_faces:10d} "
            f"{errors.rmse_surface:16.4f} {errors.max_error_surface:14.4f}"
        )
