"""A level of a pyramid written to the sinks of an algorithm."""

from __future__ import annotations

from functools import partial

from qgis.core import QgsProcessingException

from . import styles, vectors
from .pyramids import crs_of


def write_tin(algorithm, parameters, name, context, record, level, feedback) -> str:
    """Write the triangles of a level to the sink ``name`` and return where they are."""
    tin, _ = _level_layers(record, level)
    destination = write_layer(algorithm, parameters, name, context, record, tin, feedback)
    styles.style_output(context, destination, partial(styles.apply_qml, qml=tin.style))
    return destination


def write_vertices(algorithm, parameters, name, context, record, level, feedback) -> str:
    """Write the vertices of a level, with their attributes, to the sink ``name``."""
    _, vertices = _level_layers(record, level)
    return write_layer(algorithm, parameters, name, context, record, vertices, feedback)


def _level_layers(record, level):
    from wavelet_gis.layers import coarse_layers

    return coarse_layers(record, level)


def write_layer(algorithm, parameters, name, context, record, layer, feedback) -> str:
    """Write a ``wavelet_gis.layers.Layer`` to the sink ``name`` and return where it is."""
    sink, destination = algorithm.parameterAsSink(
        parameters,
        name,
        context,
        vectors.fields_of(layer),
        vectors.wkb_type_of(layer),
        crs_of(record),
    )
    if sink is None:
        raise QgsProcessingException(algorithm.invalidSinkError(parameters, name))
    vectors.add_layer(sink, layer, feedback)
    return destination
