"""A level of a pyramid written to the sinks of an algorithm."""

from __future__ import annotations

from functools import partial

from qgis.core import QgsProcessingException

from ..qgis_io import vectors
from ..ui import layer_styles as styles
from .pyramid import crs_of


def write_tin(algorithm, parameters, name, context, geo, level, feedback, mesh=None) -> str:
    """Write the triangles of a level to the sink ``name`` and return where they are.

    ``mesh`` is the level with other heights, if they were fitted.
    """
    tin, _ = _level_layers(geo, level) if mesh is None else _layers_of(geo, level, mesh)
    destination = write_layer(algorithm, parameters, name, context, geo, tin, feedback)
    styles.style_output(context, destination, partial(styles.apply_qml, qml=tin.style))
    return destination


def write_vertices(algorithm, parameters, name, context, geo, level, feedback) -> str:
    """Write the vertices of a level, with their attributes, to the sink ``name``."""
    _, vertices = _level_layers(geo, level)
    return write_layer(algorithm, parameters, name, context, geo, vertices, feedback)


def _level_layers(geo, level):
    from wavelet_gis.products.layers import coarse_layers

    return coarse_layers(geo, level)


def _layers_of(geo, level, mesh):
    from wavelet_gis.products.layers import tin_layers

    return tin_layers(geo, mesh, geo.pyramid.vertex_ids(level))


def write_layer(algorithm, parameters, name, context, geo, layer, feedback) -> str:
    """Write a ``wavelet_gis.products.layers.Layer`` to the sink ``name`` and return where it is."""
    sink, destination = algorithm.parameterAsSink(
        parameters,
        name,
        context,
        vectors.fields_of(layer),
        vectors.wkb_type_of(layer),
        crs_of(geo),
    )
    if sink is None:
        raise QgsProcessingException(algorithm.invalidSinkError(parameters, name))
    vectors.add_layer(sink, layer, feedback)
    return destination
