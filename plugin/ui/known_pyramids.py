"""The pyramids that a user has at hand: those made in this session, and those on the map."""

from __future__ import annotations

import os
import tempfile
from typing import TYPE_CHECKING, Any, NamedTuple

from qgis.core import QgsProcessingUtils

from .translation import tr

if TYPE_CHECKING:
    from qgis.core import QgsProject

#: Files that this session has written, the newest last; written by the algorithms' threads.
_made: dict[str, None] = {}


class KnownPyramid(NamedTuple):
    """A pyramid file and what it says of itself.

    path : str
    title : str
        For a list: its name, what it was made from, its levels.
    levels : list of dict
        See `wavelet_gis.io.pyramid.pyramid_file.read_summary`; the coarsest first.
    """

    path: str
    title: str
    levels: list[dict[str, Any]]


def remember(path: str) -> None:
    """Let dialogs offer a pyramid that was just written."""
    _made.pop(path, None)
    _made[path] = None


def known_pyramids(project: QgsProject | None) -> list[KnownPyramid]:
    """Return the pyramids of this session, the newest first, then those with layers on the map.

    Files that are gone, or hold no pyramid any more, are left out.
    """
    paths = list(_made)[::-1]  # a copy at once: algorithms write to it meanwhile
    if project is not None:
        sources = [layer.source().split("|")[0] for layer in project.mapLayers().values()]
        paths += sorted({path for path in sources if path.lower().endswith(".gpkg")})
    by_path = {os.path.realpath(path): path for path in reversed(paths)}
    found = [pyramid_at(path) for path in reversed(by_path.values())]
    return [pyramid for pyramid in found if pyramid is not None]


def pyramid_at(path: str) -> KnownPyramid | None:
    """Return what a file says of itself; None where there is no file, or no pyramid in it."""
    if not os.path.isfile(path):
        return None
    from wavelet_core.errors import WaveletError
    from wavelet_gis.io.pyramid.pyramid_file import read_summary

    try:
        summary = read_summary(path)
    except WaveletError:
        return None
    source = os.path.basename(str(summary.get("source_name", "")).replace("\\", "/"))
    name = tr("{} (temporary)") if _is_temporary(path) else "{}"
    levels = summary["levels"]
    title = tr("{}: {}, {} levels").format(
        name.format(os.path.basename(path)), source, max(len(levels) - 1, 0)
    )
    return KnownPyramid(path, title, sorted(levels, key=lambda level: int(level["level"])))


def _is_temporary(path: str) -> bool:
    folders = (QgsProcessingUtils.tempFolder(), tempfile.gettempdir())
    real = os.path.realpath(path)
    return any(real.startswith(os.path.realpath(folder) + os.sep) for folder in folders)
