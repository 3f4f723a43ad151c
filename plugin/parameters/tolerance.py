"""A largest error that differs from place to place: zones, a raster, and a number elsewhere."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsProcessingFeatureSource,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterRasterLayer,
)

from ..qgis_io.crs_and_progress import require_running
from ..ui.enums import NUMERIC_FIELD, POLYGONS
from ..ui.exceptions import QgsCsException, QgsProcessingException
from ..ui.translation import tr

if TYPE_CHECKING:
    from wavelet_core import TriangleMesh
    from wavelet_gis.workflows.extract import Surface
    from wavelet_gis.workflows.lines.layer_shapes import Place

    from ..base import TerrainWaveletsAlgorithm
    from ..qgis_io.raster_reader import RasterInput
    from .request import Request


#: Places that are transformed between two looks at whether to stop.
CHUNK = 10_000


class LayersByPlace(NamedTuple):
    """What must be taken from the layers in their own thread."""

    zones: QgsProcessingFeatureSource | None
    raster: RasterInput | None


def add_tolerance_parameters(algorithm: TerrainWaveletsAlgorithm) -> None:
    """Declare ZONES, ZONE_FIELD and TOLERANCE."""
    algorithm.add(
        QgsProcessingParameterFeatureSource(
            "ZONES", tr("Zones of other accuracy"), [POLYGONS], optional=True
        ),
        tr(
            "Polygons with a largest error of their own; where several overlap, the least counts. "
            "<i>Largest error</i> holds outside."
        ),
        advanced=True,
    )
    algorithm.add(
        QgsProcessingParameterField(
            "ZONE_FIELD",
            tr("Field with the largest error"),
            None,
            "ZONES",
            NUMERIC_FIELD,
            optional=True,
        ),
        tr("Of the zones, in the unit of elevation."),
        advanced=True,
    )
    algorithm.add(
        QgsProcessingParameterRasterLayer(
            "TOLERANCE", tr("Raster of largest errors"), optional=True
        ),
        tr("Instead of one number: the largest error by place, in the unit of elevation."),
        advanced=True,
    )


def is_by_place(request: Request) -> bool:
    """Return whether zones or a raster say how accurate the surface has to be."""
    return request.has("ZONES") or request.has("TOLERANCE")


def tolerance_refusal(request: Request) -> str | None:
    """Return what is wrong with the parameters."""
    if request.has("ZONES") != request.has("ZONE_FIELD"):
        return tr("Give zones and the field with their largest error, or neither.")
    if request.has("TOLERANCE") and request.has("MAX_ERROR"):
        return tr("Give a raster of largest errors, or one largest error, not both.")
    return None


def take_tolerance(request: Request) -> LayersByPlace:
    """Take from the layers, in their own thread, what reading them needs."""
    return take_layers_by_place(request, "ZONES", "TOLERANCE")


def take_layers_by_place(request: Request, zones: str, raster: str) -> LayersByPlace:
    """Take what two parameters name, in the thread of their layers."""
    from ..qgis_io.raster_reader import RasterInput

    layer = request.algorithm.parameterAsRasterLayer(request.parameters, raster, request.context)
    of_layer = None if layer is None else RasterInput.from_layer(layer, 1)
    return LayersByPlace(request.source(zones), of_layer)


def limits_of(
    request: Request,
    given: LayersByPlace,
    place: Place,
    mesh: TriangleMesh,
) -> NDArray[np.float64]:
    """Return the largest error of each vertex of a mesh; NaN where nothing says it.

    Raises
    ------
    QgsProcessingException
        Zones that no vertex is in.
    """
    return values_at(
        request,
        place,
        mesh,
        ByPlace(request.number("MAX_ERROR"), given.raster, given.zones, request.text("ZONE_FIELD")),
    )


class ByPlace(NamedTuple):
    """What gives a number by place: a raster instead of one number, a field of polygons inside."""

    number: float | None
    raster: RasterInput | None
    zones: QgsProcessingFeatureSource | None
    field: str


def values_at(
    request: Request, place: Place, mesh: TriangleMesh, given: ByPlace
) -> NDArray[np.float64]:
    """Return the number of each vertex of a mesh; NaN where nothing says it.

    Raises
    ------
    QgsProcessingException
        A raster or zones that no vertex is in.
    """
    wkt = place.system.wkt
    crs = QgsCoordinateReferenceSystem.fromWkt(wkt) if wkt else QgsCoordinateReferenceSystem()
    positions = request.computed(lambda work: place.frame.to_file(mesh.vertices), 0.05, 0.05)
    limits = np.full(len(positions), np.nan if given.number is None else given.number)
    if given.raster is not None:
        limits[:] = _of_raster(request, given.raster, positions, crs)
    if given.zones is not None:
        _set_in_zones(request, given.zones, given.field, positions, crs, limits)
    return limits


def log_zones(request: Request, surface: Surface) -> None:
    """Write what came out in each zone to the log."""
    for zone in surface.zones:
        request.say(
            tr(
                "Within {:g}: {} of {} points are vertices; RMSE {:.4g}, largest error {:.4g}"
            ).format(zone.most, zone.n_vertices, zone.n_points, zone.rmse, zone.max_error)
        )


def _of_raster(
    request: Request,
    raster: RasterInput,
    positions: NDArray[np.float64],
    crs: QgsCoordinateReferenceSystem,
) -> NDArray[np.float64]:
    from wavelet_gis.workflows.tolerance.by_place import values_in_cells

    from ..qgis_io.raster_reader import read_dem

    places = positions[:, :2]
    if raster.crs.isValid() and crs.isValid() and raster.crs != crs:
        places = _moved(
            QgsCoordinateTransform(crs, raster.crs, request.transforms), places, request
        )
    values = values_in_cells(read_dem(raster, request.feedback), *places.T)
    if np.isnan(values).all():
        raise QgsProcessingException(
            tr(
                "{}: no point of the terrain is in a cell of it; check that the layers overlap."
            ).format(raster.name)
        )
    return values


def _moved(
    transform: QgsCoordinateTransform, places: NDArray[np.float64], request: Request
) -> NDArray[np.float64]:
    """Return places in another CRS; NaN where it has none."""
    moved = np.full_like(places, np.nan)
    for start in range(0, len(places), CHUNK):
        require_running(request.feedback)
        for row, (x, y) in enumerate(places[start : start + CHUNK].tolist(), start):
            with contextlib.suppress(QgsCsException):
                point = transform.transform(x, y)
                moved[row] = point.x(), point.y()
    return moved


def _set_in_zones(
    request: Request,
    zones: QgsProcessingFeatureSource,
    field: str,
    positions: NDArray[np.float64],
    crs: QgsCoordinateReferenceSystem,
    limits: NDArray[np.float64],
) -> None:
    from ..qgis_io.geometry import rows_in
    from ..qgis_io.vectors import features_in, number_of

    shapes = []
    for feature in features_in(zones, crs, request.transforms, request.feedback):
        value = number_of(feature, field)
        if value is not None and value == value:  # not NaN
            shapes.append((value, feature.geometry()))
    n_inside = 0
    for value, geometry in sorted(shapes, key=lambda shape: -shape[0]):  # the strictest last
        rows = rows_in(geometry, positions, lambda _: not request.feedback.isCanceled())
        limits[rows] = value
        n_inside += len(rows)
    if n_inside == 0:
        raise QgsProcessingException(
            tr("No point of the terrain is inside a zone; check that the layers overlap.")
        )
