"""The Processing provider ``terrainwavelets``: its algorithms and its models."""

from __future__ import annotations

from pathlib import Path

from qgis.core import QgsProcessingAlgorithm, QgsProcessingModelAlgorithm, QgsProcessingProvider
from qgis.PyQt.QtGui import QIcon

from .algorithms import ALGORITHMS
from .packages import ICON, PLUGIN_FOLDER
from .ui.options_page import add_page, remove_page
from .ui.translation import tr

MODELS = PLUGIN_FOLDER / "processing_models"


class ShippedModel(QgsProcessingModelAlgorithm):
    """A model that comes with the plugin; its id is the name of its file, which never changes.

    QGIS itself takes the name that people read for the id.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path = path
        self.is_read = self.fromFile(str(path))
        self.setSourceFilePath(str(path))

    def name(self) -> str:
        """Return the public id."""
        return self._path.stem

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return super().name()

    def createInstance(self) -> QgsProcessingAlgorithm:
        """Return the same model anew."""
        return ShippedModel(self._path)


class TerrainWaveletsProvider(QgsProcessingProvider):
    """Lists every algorithm and model, whatever packages are missing; running one says which."""

    def id(self) -> str:
        """Return the provider's id, part of every algorithm's public name."""
        return "terrainwavelets"

    def name(self) -> str:
        """Return the name in the toolbox."""
        return "Terrain Wavelets"

    def longName(self) -> str:
        """Return the name with what it is for."""
        return tr("Terrain Wavelets: reversible multiresolution TINs")

    def icon(self) -> QIcon:
        """Return the icon in the toolbox."""
        return QIcon(ICON)

    def svgIconPath(self) -> str:
        """Return the icon's file, which Processing renders at any size."""
        return ICON

    def load(self) -> bool:
        """Add the page of options, then the algorithms."""
        add_page(self.name(), self.icon())
        self.refreshAlgorithms()
        return True

    def unload(self) -> None:
        """Take the page of options away."""
        remove_page()

    def loadAlgorithms(self) -> None:
        """Add every algorithm, then every model."""
        for algorithm in ALGORITHMS:
            self.addAlgorithm(algorithm())
        for path in sorted(MODELS.glob("*.model3")):
            model = ShippedModel(path)
            if model.is_read:
                self.addAlgorithm(model)
