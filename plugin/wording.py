"""Messages of the shared layers, which speak of the command line, in the words of a dialog."""

from __future__ import annotations

import re

from .translation import tr

_OPTION = re.compile(r"--([a-z]+(?:-[a-z]+)*)")


def for_dialog(message: str) -> str:
    """Return a message with the names of parameters where it has options of the command line.

    ``leave hag out of --attributes`` becomes ``leave hag out of 'attributes'``. The CRS is a
    property of the layer in QGIS and no parameter for most inputs, so it is told apart.
    """
    text = re.sub(r"give (one|another|the right (?:one|CRS)) with --crs", _give_crs, str(message))
    text = _OPTION.sub(lambda option: "'" + option.group(1).replace("-", " ") + "'", text)
    return text[:1].upper() + text[1:]


def _give_crs(match) -> str:
    word = match.group(1)
    return tr("assign {} in the layer's properties").format(
        {"one": tr("one"), "another": tr("another")}.get(word, tr("the right one"))
    )
