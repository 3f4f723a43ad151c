"""QGIS styles (QML) of the layers, so that a pyramid opens ready to read.

The TIN is coloured by elevation with thin edges; details are points, sized by magnitude and
coloured by level. Written as text: QGIS 3.28 to 4 read it, and nothing need be installed.
"""

from __future__ import annotations

from html import escape
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

__all__ = ["contour_style", "detail_style", "tile_style", "tin_style", "vertex_style"]

#: Elevation tints from low to high: green plains, ochre hills, brown and pale heights.
_TERRAIN = [
    (58, 125, 84),
    (120, 163, 94),
    (184, 194, 116),
    (222, 205, 135),
    (205, 164, 104),
    (171, 121, 83),
    (143, 97, 78),
    (172, 150, 142),
    (214, 206, 203),
    (245, 244, 243),
]

#: Levels from the coarsest to the finest: matplotlib's viridis without its palest end.
_LEVELS = [
    (68, 1, 84),
    (71, 44, 122),
    (59, 81, 139),
    (44, 113, 142),
    (33, 144, 141),
    (39, 173, 129),
    (92, 200, 99),
    (170, 220, 50),
]

#: Contours: their colour, and the width in millimetres of common ones and of index contours.
_CONTOUR, _CONTOUR_WIDTHS = "133,91,52,255", (0.15, 0.4)

#: Tiles by status: a name for it, the colour of the fill, that of the outline.
_TILES = {
    "whole": ("whole", "44,113,142,20", "44,113,142,255"),
    "loose": ("points without a surface", "205,164,104,120", "171,121,83,255"),
    "empty": ("without data", "255,255,255,0", "150,150,150,255"),
    "failed": ("set aside", "202,0,32,110", "202,0,32,255"),
}

_HEADER = "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"

#: Diameter in millimetres of details without magnitude, and bounds of the largest ones'.
_SMALLEST, _LARGEST = 0.05, (0.8, 4.0)

#: Width in millimetres that the whole layer is expected to have on a screen.
_MAP_WIDTH = 250.0


def quoted(text: str) -> str:
    """Return a text as the value of an XML attribute, quotation marks included."""
    return f'"{escape(text)}"'


def tin_style(elevation: NDArray[np.float64]) -> str:
    """QML of a TIN, its triangles coloured by the field ``elevation``.

    Parameters
    ----------
    elevation : (n,) float64
        Of the triangles; the classes hold the same number of them each.
    """
    breaks = _breaks(elevation, len(_TERRAIN))
    symbols, ranges = [], []
    for k, (low, high) in enumerate(pairwise(breaks)):
        symbols.append(_fill_symbol(k, _TERRAIN[k * len(_TERRAIN) // (len(breaks) - 1)]))
        label = quoted(f"{low:.4g} - {high:.4g}")
        ranges.append(
            f'<range symbol="{k}" lower="{low!r}" upper="{high!r}" label={label} render="true"/>'
        )
    return (
        _HEADER + '<qgis version="3.28.0" styleCategories="Symbology">\n'
        '<renderer-v2 type="graduatedSymbol" attr="elevation" graduatedMethod="GraduatedColor" '
        'symbollevels="0" enableorderby="0" forceraster="0">\n'
        f"<ranges>{''.join(ranges)}</ranges>\n<symbols>{''.join(symbols)}</symbols>\n"
        "</renderer-v2>\n<blendMode>0</blendMode>\n</qgis>\n"
    )


def vertex_style() -> str:
    """QML of the vertices of a TIN: small dark points."""
    return _single_marker((60, 60, 60), 0.8, "0.1")


def contour_style() -> str:
    """QML of contours: brown, those with 1 in the field ``is_index`` thick."""
    symbols, categories = [], []
    for is_index, width in enumerate(_CONTOUR_WIDTHS):
        options = _options(
            {
                "line_color": _CONTOUR,
                "line_style": "solid",
                "line_width": f"{width:g}",
                "line_width_unit": "MM",
                "joinstyle": "round",
                "capstyle": "round",
            }
        )
        symbols.append(
            f'<symbol type="line" name="{is_index}" alpha="1" clip_to_extent="1" force_rhr="0">'
            f'<layer class="SimpleLine" enabled="1" locked="0" pass="0">{options}</layer></symbol>'
        )
        label = "index contour" if is_index else "contour"
        categories.append(
            f'<category symbol="{is_index}" value="{is_index}" type="integer" label="{label}" '
            'render="true"/>'
        )
    return (
        _HEADER + '<qgis version="3.28.0" styleCategories="Symbology">\n'
        '<renderer-v2 type="categorizedSymbol" attr="is_index" symbollevels="0" '
        'enableorderby="0" forceraster="0">\n'
        f"<categories>{''.join(categories)}</categories>\n<symbols>{''.join(symbols)}</symbols>\n"
        "</renderer-v2>\n<blendMode>0</blendMode>\n</qgis>\n"
    )


def tile_style() -> str:
    """QML of the footprints of tiles: coloured by ``status``, outlines wider at each ``stage``."""
    symbols, categories = [], []
    wider = _data_defined("outlineWidth", '0.2 + 0.25 * "stage"')
    for k, (status, (label, fill, outline)) in enumerate(_TILES.items()):
        options = _options(
            {
                "color": fill,
                "style": "solid",
                "joinstyle": "miter",
                "outline_color": outline,
                "outline_style": "solid",
                "outline_width": "0.2",
                "outline_width_unit": "MM",
            }
        )
        symbols.append(
            f'<symbol type="fill" name="{k}" alpha="1" clip_to_extent="1" force_rhr="0">'
            f'<layer class="SimpleFill" enabled="1" locked="0" pass="0">{options}{wider}'
            "</layer></symbol>"
        )
        categories.append(
            f'<category symbol="{k}" value="{status}" type="string" label="{label}" render="true"/>'
        )
    return (
        _HEADER + '<qgis version="3.28.0" styleCategories="Symbology">\n'
        '<renderer-v2 type="categorizedSymbol" attr="status" symbollevels="0" '
        'enableorderby="0" forceraster="0">\n'
        f"<categories>{''.join(categories)}</categories>\n<symbols>{''.join(symbols)}</symbols>\n"
        "</renderer-v2>\n<blendMode>0</blendMode>\n</qgis>\n"
    )


def detail_style(level: int, n_levels: int, magnitude: NDArray[np.float64]) -> str:
    """QML of a layer of details: points sized by ``magnitude``, in the colour of their level.

    Parameters
    ----------
    level, n_levels : int
        Choose the colour: dark for coarse levels, bright for fine ones.
    magnitude : (n,) float64
        Its 98th percentile gets the largest size, so that few outliers do not hide the rest.
    """
    position = level / max(n_levels - 1, 1) * (len(_LEVELS) - 1)
    colour = _LEVELS[round(position)]
    largest = float(np.percentile(magnitude, 98)) if len(magnitude) else 1.0
    largest = largest if np.isfinite(largest) and largest > 0 else 1.0
    # Half more than the points' mean spacing at full extent: large ones stand out, few merge.
    diameter = float(np.clip(1.5 * _MAP_WIDTH / max(len(magnitude), 1) ** 0.5, *_LARGEST))
    expression = (
        f'scale_linear(min("magnitude", {largest!r}), 0, {largest!r}, '
        f"{_SMALLEST:g}, {diameter:.3g})"
    )
    return _single_marker(colour, 2.0, "0", expression)


def _breaks(values: NDArray[np.float64], n_classes: int) -> list[float]:
    if len(values) == 0:
        return [0.0, 1.0]
    edges = np.unique(np.quantile(values, np.linspace(0, 1, n_classes + 1)))
    if len(edges) < 2:
        edges = np.array([edges[0], edges[0]])
    return [float(edge) for edge in edges]


def _fill_symbol(name: int, colour: tuple[int, int, int]) -> str:
    red, green, blue = colour
    options = _options(
        {
            "color": f"{red},{green},{blue},255",
            "style": "solid",
            "joinstyle": "round",
            "outline_color": "70,70,70,90",
            "outline_style": "solid",
            "outline_width": "0.06",
            "outline_width_unit": "MM",
        }
    )
    return (
        f'<symbol type="fill" name="{name}" alpha="1" clip_to_extent="1" force_rhr="0">'
        f'<layer class="SimpleFill" enabled="1" locked="0" pass="0">{options}</layer></symbol>'
    )


def _single_marker(
    colour: tuple[int, int, int], size: float, outline_width: str, size_expression: str = ""
) -> str:
    red, green, blue = colour
    options = _options(
        {
            "name": "circle",
            "color": f"{red},{green},{blue},255",
            "outline_style": "no" if outline_width == "0" else "solid",
            "outline_color": "255,255,255,160",
            "outline_width": outline_width,
            "outline_width_unit": "MM",
            "size": f"{size:g}",
            "size_unit": "MM",
            "scale_method": "diameter",
        }
    )
    data_defined = _data_defined("size", size_expression) if size_expression else ""
    return (
        _HEADER + '<qgis version="3.28.0" styleCategories="Symbology">\n'
        '<renderer-v2 type="singleSymbol" symbollevels="0" enableorderby="0" forceraster="0">\n'
        '<symbols><symbol type="marker" name="0" alpha="1" clip_to_extent="1" force_rhr="0">'
        f'<layer class="SimpleMarker" enabled="1" locked="0" pass="0">{options}{data_defined}'
        "</layer></symbol></symbols>\n</renderer-v2>\n<blendMode>0</blendMode>\n</qgis>\n"
    )


def _data_defined(name: str, expression: str) -> str:
    """Return what makes a property of a symbol's layer follow an expression."""
    return (
        '<data_defined_properties><Option type="Map">'
        '<Option type="QString" name="name" value=""/>'
        f'<Option type="Map" name="properties"><Option type="Map" name="{name}">'
        '<Option type="bool" name="active" value="true"/>'
        f'<Option type="QString" name="expression" value={quoted(expression)}/>'
        '<Option type="int" name="type" value="3"/></Option></Option>'
        '<Option type="QString" name="type" value="collection"/></Option>'
        "</data_defined_properties>"
    )


def _options(values: dict[str, str]) -> str:
    inner = "".join(
        f'<Option type="QString" name={quoted(name)} value={quoted(value)}/>'
        for name, value in values.items()
    )
    return f'<Option type="Map">{inner}</Option>'
