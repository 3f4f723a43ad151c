"""Messages of the shared layers, which speak of the command line, in the words of a dialog."""

from __future__ import annotations

import re

from .translation import tr

_OPTION = re.compile(r"--([a-z]+(?:-[a-z]+)*)")


def for_dialog(message: str, has_crs: bool = False) -> str:
    """Return a message with the names of parameters where it has options of the command line.

    ``leave hag out of --attributes`` becomes ``leave hag out of 'attributes'``. The CRS is a
    property of the layer in QGIS and no parameter for most inputs, so it is told apart.

    Parameters
    ----------
    message : str
        Or an exception or a warning that says it.
    has_crs : bool
        Whether the dialog has a parameter for the CRS.
    """
    text = str(message).replace("'terrain-wavelets analyse'", tr("one of the analyses"))
    if not has_crs:
        text = re.sub(r"give (one|another|the right (?:one|CRS)) with --crs", _give_crs, text)
    text = _OPTION.sub(lambda option: "'" + option.group(1).replace("-", " ") + "'", text)
    # What starts with the name of a layer or a file keeps it as it is.
    return text if ": " in text.split(";")[0] else text[:1].upper() + text[1:]


def _give_crs(match) -> str:
    word = match.group(1)
    return tr("assign {} in the layer's properties").format(
        {"one": tr("one"), "another": tr("another")}.get(word, tr("the right one"))
    )
