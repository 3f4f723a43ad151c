"""How results look when they open: thin-edged TIN, details by level and size, hillshaded DEM."""

from __future__ import annotations

import os
from collections import deque

from qgis.core import (
    Qgis,
    QgsCategorizedSymbolRenderer,
    QgsCoordinateReferenceSystem,
    QgsHillshadeRenderer,
    QgsPalettedRasterRenderer,
    QgsProcessingLayerPostProcessorInterface,
    QgsRandomColorRamp,
    QgsRendererCategory,
    QgsVectorLayerUtils,
)
from qgis.PyQt.QtXml import QDomDocument

from .translation import tr


class _Style(QgsProcessingLayerPostProcessorInterface):
    """Gives a loaded layer its style, in the main thread, after the algorithm is done."""

    def __init__(self, function):
        super().__init__()
        self.function = function

    def postProcessLayer(self, layer, context, feedback):
        """Style the layer."""
        self.function(layer)
        layer.triggerRepaint()


def apply_qml(layer, qml: str) -> None:
    """Give a layer the style in a QML text."""
    document = QDomDocument()
    document.setContent(qml)
    layer.importNamedStyle(document)


def style_details(layer) -> None:
    """Colour the points by level and size them by magnitude (the paper's Fig. 10b).

    Each level looks as its own layer does in a pyramid file.
    """
    import numpy as np

    from wavelet_gis.products.styles import detail_style

    values, _ = QgsVectorLayerUtils.getValues(layer, "magnitude")
    magnitude = np.array(values, dtype=np.float64)
    levels = sorted(layer.uniqueValues(layer.fields().lookupField("level")))
    n_levels = 1 + max(levels, default=0)
    categories = []
    for level in levels:
        apply_qml(layer, detail_style(level, n_levels, magnitude))
        symbol = layer.renderer().symbol().clone()
        categories.append(QgsRendererCategory(level, symbol, tr("level {}").format(level)))
    if categories:
        layer.setRenderer(QgsCategorizedSymbolRenderer("level", categories))


def style_hillshade(layer) -> None:
    """Show a DEM as its hillshade, lit from several sides."""
    provider = layer.dataProvider()
    renderer = QgsHillshadeRenderer(provider, 1, 315.0, 45.0)
    renderer.setMultiDirectional(True)
    if layer.crs().isGeographic():
        renderer.setZFactor(1.0 / 111_320.0)
    layer.setRenderer(renderer)
    # Elevations are resampled before they are shaded: steps of nearest cells would show as stripes.
    methods = provider.ResamplingMethod
    provider.enableProviderResampling(True)
    provider.setZoomedInResamplingMethod(methods.Cubic)
    provider.setZoomedOutResamplingMethod(methods.Bilinear)
    layer.setResamplingStage(Qgis.RasterResamplingStage.Provider)


def set_mesh_crs(layer) -> None:
    """Give a mesh the CRS that its file cannot hold, from the .prj written beside it."""
    path = os.path.splitext(layer.source())[0] + ".prj"
    if not layer.crs().isValid() and os.path.isfile(path):
        with open(path, encoding="utf-8") as file:
            layer.setCrs(QgsCoordinateReferenceSystem.fromWkt(file.read()))


def style_labels(layer) -> None:
    """Give each label of a raster a colour of its own."""
    provider = layer.dataProvider()
    ramp = QgsRandomColorRamp()
    classes = QgsPalettedRasterRenderer.classDataFromRaster(provider, 1, ramp)
    layer.setRenderer(QgsPalettedRasterRenderer(provider, 1, classes))


#: Post-processors that were handed out. Some versions of QGIS take them over, others do not, so
#: these references keep them alive until they have surely been used.
_handed_out = deque(maxlen=1000)


def style_output(context, destination, style) -> None:
    """Let ``destination`` open with a style, if it opens at all.

    Parameters
    ----------
    context : QgsProcessingContext
    destination : str
        As ``parameterAsSink`` or the output map names it.
    style : callable
        One of the functions here that take a layer.
    """
    if destination and context.willLoadLayerOnCompletion(destination):
        processor = _Style(style)
        _handed_out.append(processor)
        context.layerToLoadOnCompletionDetails(destination).setPostProcessor(processor)
