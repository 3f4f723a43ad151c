"""A level of a pyramid written to the sinks of an algorithm."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ..qgis_io import vectors
from ..ui import layer_styles as styles
from ..ui.exceptions import QgsProcessingException
from .pyramid import crs_of

if TYPE_CHECKING:
    from wavelet_gis.model.geo_pyramid import GeoPyramid
    from wavelet_gis.products.layers import Layer
    from wavelet_gis.workflows.extract import Surface

    from .request import Request


def write_level(request: Request, name: str, geo: GeoPyramid, level: int) -> str:
    """Write the triangles of a level to the sink ``name`` and return where they are."""
    from wavelet_gis.products.layers import coarse_layers

    layer = request.computed(lambda work: next(coarse_layers(geo, level)), 0.8, 0.85)
    return write_layer(request, name, geo, layer)


def write_surface(
    request: Request, surface: Surface, tin: str = "TIN", vertices: str = "VERTICES"
) -> dict[str, str]:
    """Write the triangles and the vertices of a surface, each where it is wanted.

    Parameters
    ----------
    request : Request
        What was asked for.
    surface : Surface
        A level of a pyramid, or what lies between two, with its heights.
    tin, vertices : str
        Names of the sinks.
    """
    from wavelet_gis.products.layers import tin_layers

    results: dict[str, str] = {}
    layers = tin_layers(surface.geo, surface.mesh, surface.vertex_ids)
    for name in (tin, vertices):
        if request.wants(name) or request.wants(vertices):  # which are the second layer
            layer = request.computed(lambda work: next(layers), 0.8, 0.85)
            if request.wants(name):
                results[name] = write_layer(request, name, surface.geo, layer)
    return results


def write_layer(request: Request, name: str, geo: GeoPyramid, layer: Layer) -> str:
    """Write a layer, with its style, to the sink ``name`` and return where it is."""
    sink, destination = request.algorithm.parameterAsSink(
        request.parameters,
        name,
        request.context,
        vectors.fields_of(layer),
        vectors.wkb_type_of(layer),
        crs_of(geo),
    )
    if sink is None:
        raise QgsProcessingException(request.algorithm.invalidSinkError(request.parameters, name))
    vectors.add_layer(sink, layer, request.feedback, report=request.progress(0.85, 0.95))
    request.finish(name, destination, partial(styles.apply_qml, qml=layer.style))
    return destination
