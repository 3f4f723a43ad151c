"""Labelled vertices as a layer, each label in its own colour."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavelet_gis.model.geo_pyramid import GeoPyramid
from wavelet_gis.products.layers import Layer
from wavelet_gis.products.styles import quoted
from wavelet_gis.products.wkb import points_wkb

__all__ = ["label_colour", "label_layer"]

#: Okabe and Ito's colours, told apart by most eyes; labels beyond them start again.
_COLOURS = [
    (0, 114, 178),
    (230, 159, 0),
    (0, 158, 115),
    (204, 121, 167),
    (86, 180, 233),
    (213, 94, 0),
    (240, 228, 66),
    (90, 90, 90),
]

#: Colours of ASPRS classes by custom: ground brown, vegetation green, buildings red, water blue.
_CLASS_COLOURS = {
    2: (160, 120, 80),
    3: (170, 210, 130),
    4: (110, 180, 80),
    5: (40, 130, 50),
    6: (200, 60, 50),
    9: (60, 120, 200),
    17: (120, 120, 130),
}


def label_colour(label: int, name: str = "cluster") -> tuple[int, int, int]:
    """Return red, green and blue of a label, the same wherever it is shown.

    Parameters
    ----------
    label : int
        A cluster's number, or an ASPRS class.
    name : {"cluster", "class"}
        What it is.
    """
    by_custom = _CLASS_COLOURS if name == "class" else {}
    return by_custom.get(label, _COLOURS[label % len(_COLOURS)])


def label_layer(
    geo: GeoPyramid,
    labels: NDArray[np.int64],
    confidence: NDArray[np.float64],
    name: str = "cluster",
) -> Layer:
    """Return every vertex of the input with its label.

    Parameters
    ----------
    geo : GeoPyramid
        Whose vertices.
    labels : (n_vertices,) int64
        What is shown.
    confidence : (n_vertices,) float64
        0 to 1.
    name : {"cluster", "class"}
        Of the field, and in the plural of the layer.
    """
    mesh = geo.pyramid.synthesise()
    plural = {"cluster": "clusters", "class": "classes"}[name]
    return Layer(
        plural,
        "Point Z",
        points_wkb(geo.frame.to_file(mesh.vertices)),
        {
            "vertex_id": np.arange(mesh.n_vertices, dtype=np.int64),
            name: labels.astype(np.int32),
            "confidence": np.asarray(confidence, dtype=np.float64),
        },
        _style(name, np.unique(labels).tolist()),
        f"Vertices by {name}",
        "One input vertex a row, with how clearly it belongs there",
    )


def _style(field: str, labels: list[int]) -> str:
    categories, symbols = [], []
    for k, label in enumerate(labels):
        red, green, blue = label_colour(label, field)
        categories.append(
            f'<category symbol="{k}" value="{label}" label="{field} {label}" render="true" '
            'type="integer"/>'
        )
        options = "".join(
            f'<Option type="QString" name={quoted(key)} value={quoted(value)}/>'
            for key, value in (
                ("name", "circle"),
                ("color", f"{red},{green},{blue},255"),
                ("outline_style", "no"),
                ("size", "0.8"),
                ("size_unit", "MM"),
            )
        )
        symbols.append(
            f'<symbol type="marker" name="{k}" alpha="1" clip_to_extent="1" force_rhr="0">'
            '<layer class="SimpleMarker" enabled="1" locked="0" pass="0">'
            f'<Option type="Map">{options}</Option></layer></symbol>'
        )
    return (
        "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
        '<qgis version="3.28.0" styleCategories="Symbology">\n'
        f'<renderer-v2 type="categorizedSymbol" attr="{field}" symbollevels="0" '
        'enableorderby="0" forceraster="0">\n'
        f"<categories>{''.join(categories)}</categories>\n<symbols>{''.join(symbols)}</symbols>\n"
        "</renderer-v2>\n<blendMode>0</blendMode>\n</qgis>\n"
    )
