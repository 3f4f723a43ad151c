"""Make the plugin folder's own ``wavelet_core`` and ``wavelet_gis`` importable by those names.

The two packages are also published on their own, so they import each other by their plain names.
Putting the plugin folder on ``sys.path`` would expose ``plugin`` and all else in it to the whole of
QGIS; a finder for just these two names does not.
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


class OwnPackageFinder(MetaPathFinder):
    """Finds the packages that come with this plugin, and nothing else."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None = None,
        target: ModuleType | None = None,
    ) -> ModuleSpec | None:
        """Return the spec of one of our packages; submodules are then found through it."""
        if fullname not in OWN_PACKAGES:
            return None
        return PathFinder.find_spec(fullname, [str(PLUGIN_FOLDER)])


def install_finder() -> None:
    """Let Python find our packages, ahead of a copy that may be installed elsewhere."""
    if not any(type(finder).__name__ == OwnPackageFinder.__name__ for finder in sys.meta_path):
        sys.meta_path.insert(0, OwnPackageFinder())


def remove_finder() -> None:
    """Undo `install_finder` and forget the modules, so that an upgraded plugin loads its own."""
    sys.meta_path[:] = [
        finder for finder in sys.meta_path if type(finder).__name__ != OwnPackageFinder.__name__
    ]
    for name in list(sys.modules):
        if name.split(".")[0] in OWN_PACKAGES:
            del sys.modules[name]
