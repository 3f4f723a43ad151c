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

#: The part of the bar that an output has, by its name.
Parts = dict[str, tuple[float, float]]


def write_level(request: Request, name: str, geo: GeoPyramid, level: int) -> str:
    """Write the triangles of a level to the sink ``name`` and return where they are."""
    from wavelet_gis.products.layers import coarse_layers

    layer = request.computed(lambda work: next(coarse_layers(geo, level)), 0.8, 0.85)
    return write_layer(request, name, geo, layer)


def write_surface(request: Request, surface: Surface, parts: Parts) -> dict[str, str]:
    """Write the triangles and the vertices of a surface, each where it is wanted.

    Parameters
    ----------
    request : Request
        What was asked for.
    surface : Surface
        A level of a pyramid, or what lies between two, with its heights.
    parts : dict of str to (float, float)
        The parts of the bar that the sinks TIN and VERTICES have, those that are wanted.
    """
    from wavelet_gis.products.layers import tin_layers

    results: dict[str, str] = {}
    layers = tin_layers(surface.geo, surface.mesh, surface.vertex_ids)
    names = [name for name in ("TIN", "VERTICES") if name in parts]
    if names == ["VERTICES"]:  # the second of the layers
        request.computed(lambda work: next(layers), *parts["VERTICES"])
    for name in names:
        start, stop = parts[name]
        middle = (start + stop) / 2
        layer = request.computed(lambda work: next(layers), start, middle)
        results[name] = write_layer(request, name, surface.geo, layer, middle, stop)
    return results


def write_layer(
    request: Request,
    name: str,
    geo: GeoPyramid,
    layer: Layer,
    start: float = 0.85,
    stop: float = 0.95,
) -> str:
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
    vectors.add_layer(sink, layer, request.feedback, report=request.progress(start, stop))
    request.finish(name, destination, partial(styles.apply_qml, qml=layer.style))
    return destination
