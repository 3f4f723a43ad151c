"""How results look when they open: thin-edged TIN, details by level and size, hillshaded DEM."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from qgis.core import (
    Qgis,
    QgsCategorizedSymbolRenderer,
    QgsColorRampShader,
    QgsCoordinateReferenceSystem,
    QgsHillshadeRenderer,
    QgsPalettedRasterRenderer,
    QgsProcessingLayerPostProcessorInterface,
    QgsRasterShader,
    QgsRendererCategory,
    QgsSingleBandPseudoColorRenderer,
    QgsVectorLayerUtils,
)
from qgis.PyQt.QtGui import QColor
from qgis.PyQt.QtXml import QDomDocument

from .enums import INTERPOLATED
from .translation import tr

if TYPE_CHECKING:
    from qgis.core import QgsMapLayer, QgsProcessingContext, QgsProcessingFeedback

Colour = tuple[int, int, int]

#: From what was taken away through nothing to what was added: ColorBrewer's RdBu.
_DIVERGING = ((33, 102, 172), (146, 197, 222), (247, 247, 247), (244, 165, 130), (178, 24, 43))
#: From nothing to much: matplotlib's magma, the dark end first.
_SEQUENTIAL = ((0, 0, 4), (81, 18, 124), (183, 55, 121), (252, 137, 97), (252, 253, 191))
#: From flat to steep: ColorBrewer's YlOrBr.
_SLOPE = ((255, 255, 229), (254, 227, 145), (254, 153, 41), (204, 76, 2), (102, 37, 6))
#: North, east, south, west, and north again: the slopes that the sun leaves are the dark ones.
_COMPASS = ((52, 62, 104), (94, 145, 113), (250, 224, 137), (214, 112, 88), (52, 62, 104))
#: Share of the cells, at either end, that a ramp leaves beyond its last colours.
_TAIL = 0.02
#: Cells of a raster that are looked at to choose the ramp.
_SAMPLE_SIZE = 250_000
#: Metres of a degree of latitude, to shade elevations in metres over degrees.
_METRES_A_DEGREE = 111_320.0


class _Finish(QgsProcessingLayerPostProcessorInterface):
    """Gives a loaded layer its style and metadata, in the main thread, after the work is done."""

    def __init__(self, style: Callable[[Any], None], abstract: str, command: str) -> None:
        super().__init__()
        self._style = style
        self._abstract = abstract
        self._command = command

    def postProcessLayer(
        self,
        layer: QgsMapLayer | None,
        context: QgsProcessingContext,
        feedback: QgsProcessingFeedback | None,
    ) -> None:
        """Finish the layer."""
        if layer is None:
            return
        self._style(layer)
        metadata = layer.metadata()
        metadata.setAbstract(self._abstract)
        metadata.addHistoryItem(self._command)
        metadata.setCrs(layer.crs())
        layer.setMetadata(metadata)
        layer.triggerRepaint()


def apply_qml(layer: Any, qml: str) -> None:
    """Give a layer the style in a QML text."""
    document = QDomDocument()
    document.setContent(qml)
    layer.importNamedStyle(document)


def style_details(layer: Any) -> None:
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


def style_hillshade(layer: Any) -> None:
    """Show a DEM as its hillshade, lit from several sides."""
    provider = layer.dataProvider()
    renderer = QgsHillshadeRenderer(provider, 1, 315.0, 45.0)
    renderer.setMultiDirectional(True)
    if layer.crs().isGeographic():
        renderer.setZFactor(1.0 / _METRES_A_DEGREE)
    layer.setRenderer(renderer)
    # Elevations are resampled before they are shaded: steps of nearest cells would show as stripes.
    methods = provider.ResamplingMethod
    provider.enableProviderResampling(True)
    provider.setZoomedInResamplingMethod(methods.Cubic)
    provider.setZoomedOutResamplingMethod(methods.Bilinear)
    layer.setResamplingStage(Qgis.RasterResamplingStage.Provider)


def style_difference(layer: Any) -> None:
    """Show what was added in red, what was taken away in blue, and what stayed in white."""
    low, high = _range(layer, 1)
    largest = max(abs(low), abs(high)) or 1.0
    _show_band(layer, 1, -largest, largest, _DIVERGING)


def style_energy(layer: Any) -> None:
    """Show one band of a raster of energies, that of the roughest level; the others are there."""
    ranges = [_range(layer, band) for band in range(1, layer.bandCount() + 1)]
    largest = [high for _, high in ranges]
    band = 1 + largest.index(max(largest))
    _show_band(layer, band, 0.0, largest[band - 1] or 1.0, _SEQUENTIAL)


def style_magnitude(layer: Any) -> None:
    """Show the first band from nothing to much."""
    _show_band(layer, 1, 0.0, _range(layer, 1)[1] or 1.0, _SEQUENTIAL)


def style_landforms(layer: Any) -> None:
    """Show each landform in its colour, by its name."""
    forms = (
        (tr("planar"), (235, 230, 215)),
        (tr("pit"), (8, 48, 107)),
        (tr("channel"), (66, 146, 198)),
        (tr("pass"), (120, 180, 120)),
        (tr("ridge"), (217, 140, 70)),
        (tr("peak"), (165, 15, 21)),
    )
    classes = []
    for label, (name, colour) in enumerate(forms):
        classes.append(QgsPalettedRasterRenderer.Class(label, QColor(*colour), name))
    layer.setRenderer(QgsPalettedRasterRenderer(layer.dataProvider(), 1, classes))


def style_shape(layer: Any, name: str) -> None:
    """Show slope from flat to steep, aspect round the compass, curvature red where convex.

    Parameters
    ----------
    layer : QgsRasterLayer
        Of one band.
    name : str
        One of ``wavelet_core.SHAPE_NAMES``.
    """
    if name == "slope":
        _show_band(layer, 1, 0.0, _range(layer, 1)[1] or 1.0, _SLOPE)
    elif name == "aspect":
        _show_band(layer, 1, 0.0, 360.0, _COMPASS)
    else:
        style_difference(layer)


def style_labels(layer: Any, name: str) -> None:
    """Give each label of a raster the colour that the vertices with this label have.

    Parameters
    ----------
    layer : QgsRasterLayer
        Of labels.
    name : {"cluster", "class"}
        What a label is.
    """
    from wavelet_gis.products.label_layer import label_colour

    word = tr("class") if name == "class" else tr("cluster")
    provider = layer.dataProvider()
    classes = QgsPalettedRasterRenderer.classDataFromRaster(provider, 1)
    for entry in classes:
        label = int(entry.value)
        entry.color = QColor(*label_colour(label, name))
        entry.label = f"{word} {label}"
    layer.setRenderer(QgsPalettedRasterRenderer(provider, 1, classes))


def set_mesh_crs(layer: Any) -> None:
    """Give a mesh the CRS that its file cannot hold, from the .prj written beside it."""
    path = os.path.splitext(layer.source())[0] + ".prj"
    if not layer.crs().isValid() and os.path.isfile(path):
        with open(path, encoding="utf-8") as file:
            layer.setCrs(QgsCoordinateReferenceSystem.fromWkt(file.read()))


#: Post-processors that were handed out. Some versions of QGIS take them over, others do not, so
#: these references keep them alive until they have surely been used.
_handed_out: deque[_Finish] = deque(maxlen=1000)


def finish_output(
    context: QgsProcessingContext,
    destination: str,
    style: Callable[[Any], None],
    *,
    abstract: str,
    command: str,
) -> None:
    """Let ``destination`` open with a style and metadata, if it opens at all.

    Parameters
    ----------
    context : QgsProcessingContext
        Knows what is opened.
    destination : str
        As ``parameterAsSink`` or the output map names it.
    style : callable
        One of the functions here that take a layer.
    abstract : str
        What the layer is.
    command : str
        What made it, as Python takes it.
    """
    if destination and context.willLoadLayerOnCompletion(destination):
        processor = _Finish(style, abstract, command)
        _handed_out.append(processor)
        context.layerToLoadOnCompletionDetails(destination).setPostProcessor(processor)


def _range(layer: Any, band: int) -> tuple[float, float]:
    """Return the values of a band between which nearly all of its cells are."""
    provider = layer.dataProvider()
    low, high = provider.cumulativeCut(band, _TAIL, 1 - _TAIL, layer.extent(), _SAMPLE_SIZE)
    return float(low), float(high)


def _show_band(layer: Any, band: int, low: float, high: float, ramp: Sequence[Colour]) -> None:
    """Show one band in colours that run from ``low`` to ``high``."""
    step = (high - low) / (len(ramp) - 1)
    function = QgsColorRampShader(low, high, None, INTERPOLATED)
    function.setColorRampItemList(
        [
            QgsColorRampShader.ColorRampItem(
                low + k * step, QColor(*colour), f"{low + k * step:.3g}"
            )
            for k, colour in enumerate(ramp)
        ]
    )
    shader = QgsRasterShader()
    shader.setRasterShaderFunction(function)
    renderer = QgsSingleBandPseudoColorRenderer(layer.dataProvider(), band, shader)
    renderer.setClassificationMin(low)
    renderer.setClassificationMax(high)
    layer.setRenderer(renderer)
