"""Terrain Wavelets: this folder, taken whole, is the QGIS plugin."""


def classFactory(iface):  # noqa: D103 - the name and the call are QGIS's
    from .plugin.plugin import TerrainWaveletsPlugin

    return TerrainWaveletsPlugin(iface)
