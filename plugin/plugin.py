"""What QGIS loads and unloads: the provider and the translation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import QgsApplication, QgsSettings
from qgis.PyQt.QtCore import QCoreApplication, QLocale, QTranslator

from .packages import PLUGIN_FOLDER, install_finder, remove_finder
from .provider import TerrainWaveletsProvider
from .ui.warning_log import uninstall

if TYPE_CHECKING:
    from qgis.gui import QgisInterface


class TerrainWaveletsPlugin:
    """Adds the provider ``terrainwavelets`` to Processing; there is no other user interface."""

    def __init__(self, iface: QgisInterface | None) -> None:
        self.iface = iface
        self.provider: TerrainWaveletsProvider | None = None
        self.translator: QTranslator | None = None

    def initProcessing(self) -> None:
        """Register the provider; ``qgis_process`` calls this alone."""
        install_finder()
        self.translator = _installed_translator()
        self.provider = TerrainWaveletsProvider()
        registry = QgsApplication.processingRegistry()
        assert registry is not None  # QGIS makes it before any plugin
        registry.addProvider(self.provider)
        # Models look their steps up in the registry, which has ours only from here on.
        self.provider.refreshAlgorithms()

    def initGui(self) -> None:
        """Register the provider in QGIS with a window."""
        self.initProcessing()

    def unload(self) -> None:
        """Take the provider, the translation and the import finder away again."""
        registry = QgsApplication.processingRegistry()
        if self.provider is not None and registry is not None:
            registry.removeProvider(self.provider)
            self.provider = None
        if self.translator is not None:
            QCoreApplication.removeTranslator(self.translator)
            self.translator = None
        uninstall()
        remove_finder()


def _installed_translator() -> QTranslator | None:
    """Return the translator for the user's language where one is shipped, installed, else None."""
    locale = QgsSettings().value("locale/userLocale", QLocale.system().name())
    path = PLUGIN_FOLDER / "plugin" / "i18n" / f"terrain_wavelets_{str(locale)[:2]}.qm"
    if not path.is_file():
        return None
    translator = QTranslator()
    if not translator.load(str(path)):
        return None
    QCoreApplication.installTranslator(translator)
    return translator
