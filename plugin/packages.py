"""Make the packages that come with the plugin importable by their names.

``wavelet_core`` and ``wavelet_gis`` are also published on their own, so they import each other by
their plain names. Putting the plugin folder on ``sys.path`` would expose ``plugin`` and all else in
it to the whole of QGIS; a finder for just these two names does not. A second one finds laspy, of
which the zip holds a copy (``scripts/plugin_zip.py``), where none is installed.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType

PLUGIN_FOLDER = Path(__file__).resolve().parent.parent
ICON = str(PLUGIN_FOLDER / "plugin" / "icons" / "terrain_wavelets.svg")
OWN_PACKAGES = ("wavelet_core", "wavelet_gis")
VENDORED_FOLDER = PLUGIN_FOLDER / "vendored"
VENDORED_PACKAGES = ("laspy",)


class OwnPackageFinder(MetaPathFinder):
    """Finds some packages in a folder of this plugin, and nothing else."""

    def __init__(self, folder: Path, packages: tuple[str, ...]) -> None:
        self.folder, self.packages = folder, packages

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None = None,
        target: ModuleType | None = None,
    ) -> ModuleSpec | None:
        """Return the spec of one of our packages; submodules are then found through it."""
        if fullname not in self.packages:
            return None
        return PathFinder.find_spec(fullname, [str(self.folder)])


def install_finder() -> None:
    """Let Python find our packages ahead of installed ones, and other people's behind them."""
    if not any(type(finder).__name__ == OwnPackageFinder.__name__ for finder in sys.meta_path):
        sys.meta_path.insert(0, OwnPackageFinder(PLUGIN_FOLDER, OWN_PACKAGES))
        sys.meta_path.append(OwnPackageFinder(VENDORED_FOLDER, VENDORED_PACKAGES))


def remove_finder() -> None:
    """Undo `install_finder` and forget the modules, so that an upgraded plugin loads its own."""
    sys.meta_path[:] = [
        finder for finder in sys.meta_path if type(finder).__name__ != OwnPackageFinder.__name__
    ]
    for name, module in list(sys.modules.items()):
        top = name.split(".")[0]
        is_copy = top in VENDORED_PACKAGES and str(VENDORED_FOLDER) in str(
            getattr(module, "__file__", "")
        )
        if top in OWN_PACKAGES or is_copy:
            del sys.modules[name]
