"""How results look when they open: thin-edged TIN, details by level and size, hillshaded DEM."""

from __future__ import annotations

from qgis.core import (
    QgsApplication,
    QgsClassificationEqualInterval,
    QgsGraduatedSymbolRenderer,
    QgsHillshadeRenderer,
    QgsFillSymbol,
    QgsMarkerSymbol,
    QgsProcessingLayerPostProcessorInterface,
    QgsProperty,
    QgsRendererRangeLabelFormat,
    QgsStyle,
    QgsSymbolLayer,
)
from qgis.PyQt.QtGui import QColor

#: Names of colour ramps in QGIS's own style, and what stands in where it lacks one.
RAMPS = {"elevation": ("Viridis", "Greys"), "slope": ("YlOrBr", "Greys"), "level": ("Spectral", "Viridis")}


class _Style(QgsProcessingLayerPostProcessorInterface):
    """Gives a loaded layer its style, in the main thread, after the algorithm is done."""

    def __init__(self, function):
        super().__init__()
        self.function = function

    def postProcessLayer(self, layer, context, feedback):
        """Style the layer."""
        self.function(layer)
        layer.triggerRepaint()


def style_tin(layer) -> None:
    """Fill the faces by elevation, with hair-thin edges."""
    symbol = QgsFillSymbol.createSimple(
        {"outline_color": "60,60,60,120", "outline_width": "0.06", "style": "solid"}
    )
    _graduate(layer, "z", symbol, "elevation", 9, 0)


def style_details(layer) -> None:
    """Colour the points by level and size them by magnitude (the paper's Fig. 10b)."""
    symbol = QgsMarkerSymbol.createSimple(
        {"name": "circle", "size": "1.2", "outline_style": "no"}
    )
    largest = layer.maximumValue(layer.fields().lookupField("magnitude"))
    largest = float(largest) if isinstance(largest, (int, float)) and largest > 0 else 1.0
    # Area, not width, shows the magnitude; the smallest stay visible.
    size = QgsProperty.fromExpression(f'0.3 + 3.2 * sqrt("magnitude" / {largest!r})')
    symbol.symbolLayer(0).setDataDefinedProperty(QgsSymbolLayer.Property.PropertySize, size)
    levels = layer.uniqueValues(layer.fields().lookupField("level"))
    _graduate(layer, "level", symbol, "level", max(len(levels), 1), 0)


def style_hillshade(layer) -> None:
    """Show a DEM as its hillshade, lit from several sides."""
    provider = layer.dataProvider()
    renderer = QgsHillshadeRenderer(provider, 1, 315.0, 45.0)
    renderer.setMultiDirectional(True)
    if layer.crs().isGeographic():
        renderer.setZFactor(1.0 / 111_320.0)
    layer.setRenderer(renderer)


def _graduate(layer, field, symbol, ramp_name, n_classes, decimals) -> None:
    renderer = QgsGraduatedSymbolRenderer(field)
    renderer.setSourceSymbol(symbol)
    renderer.setClassificationMethod(QgsClassificationEqualInterval())
    label = QgsRendererRangeLabelFormat("%1 – %2", decimals)
    del label
    renderer.updateClasses(layer, n_classes)
    renderer.updateColorRamp(_ramp(ramp_name))
    layer.setRenderer(renderer)


def _ramp(name):
    style = QgsStyle.defaultStyle()
    for candidate in RAMPS[name]:
        ramp = style.colorRamp(candidate)
        if ramp is not None:
            return ramp
    return style.colorRamp(style.colorRampNames()[0])


# Processing keeps no reference to a post-processor, so these live as long as the module.
TIN = _Style(style_tin)
DETAILS = _Style(style_details)
HILLSHADE = _Style(style_hillshade)


def style_output(context, destination, style) -> None:
    """Let ``destination`` open with ``style``, if it opens at all.

    Parameters
    ----------
    context : QgsProcessingContext
    destination : str
        As ``parameterAsSink`` or the output map names it.
    style : _Style
        ``TIN``, ``DETAILS`` or ``HILLSHADE``.
    """
    if destination and context.willLoadLayerOnCompletion(destination):
        context.layerToLoadOnCompletionDetails(destination).setPostProcessor(style)
