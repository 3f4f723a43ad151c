"""The page in the Processing options: which packages are there, what each adds, and the command."""

from __future__ import annotations

from processing.core.ProcessingConfig import ProcessingConfig, Setting

from . import dependencies
from .translation import tr


class _Shown(Setting):
    """A text that is shown to be read and copied, and never stored."""

    def read(self, qsettings: object = None) -> None:
        """Keep the text: it is found out anew in each session."""

    def save(self, qsettings: object = None) -> None:
        """Store nothing."""


def add_page(group: str, icon: object) -> None:
    """Add the page, under the name of the provider.

    Parameters
    ----------
    group : str
        Name of the provider.
    icon : QIcon
        Beside it.
    """
    ProcessingConfig.settingIcons[group] = icon
    for key, description, text in rows():
        ProcessingConfig.addSetting(_Shown(group, key, description, text))


def remove_page() -> None:
    """Take the page away."""
    for key, _, _ in rows():
        ProcessingConfig.removeSetting(key)


def rows() -> list[tuple[str, str, str]]:
    """Return the key of each package, what it adds, and that it is there or the command for it."""
    found = []
    for package, gain in dependencies.optional_packages():
        key = f"TERRAIN_WAVELETS_{package.module.upper()}"
        name = package.pip.split("[")[0]
        if not dependencies.missing([package]):
            found.append((key, f"{name}: {gain}", tr("installed")))
            continue
        place, command = dependencies.place_and_command([package])
        found.append((key, tr("{}: {}; missing, install it {}").format(name, gain, place), command))
    return found
