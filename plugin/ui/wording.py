"""Messages of the shared layers in the words of a dialog.

The messages name the parameters of Python functions, and the errors, warnings and notes that carry
them keep these names apart from the text (``in_words``); here each becomes the label that the
dialog shows.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from .translation import tr

if TYPE_CHECKING:
    from qgis.core import QgsProcessingAlgorithm

#: Parameters of Python functions that dialogs know by another id than the same in capitals, the
#: first that a dialog has.
IDS = {
    "target_vertices": ("TARGET_VERTICES", "VERTICES"),
    "vertices": ("VERTICES_WANTED", "VERTICES", "TARGET_VERTICES"),
    "max_rms": ("MAX_RMS", "RMSE"),
    "sigma": ("SIGMA_OF_NOISE",),
    "n_pyramids": ("PYRAMIDS",),
    "levels": ("LEVELS", "FIRST_LEVEL"),
    "metres": ("SMALLEST_SIZE", "LEVEL_METRES"),
    "distance": ("LEVEL_METRES",),
    "level": ("LEVEL", "FIRST_LEVEL"),
    "learn": ("LEARN_FROM",),
    "labels": ("TRAINING",),
    "what": ("ENERGY",),
}


class Message(Protocol):
    """An error, a warning or a note that keeps its parameters apart from its text."""

    def in_words(self, name_of: Callable[[str], str]) -> str:
        """Return the text with the parameters named as the reader knows them."""


def labels_of(algorithm: QgsProcessingAlgorithm) -> Callable[[str], str]:
    """Return the function from a parameter's name in Python to its label in the dialog.

    Parameters
    ----------
    algorithm : QgsProcessingAlgorithm
        Whose dialog.

    Returns
    -------
    callable
        A parameter that the dialog does not have keeps its name. The CRS is a property of the
        layer for most inputs, and a mesh file has that of its plane.
    """

    def label_of(parameter: str) -> str:
        for identifier in IDS.get(parameter, (parameter.upper(),)):
            definition = algorithm.parameterDefinition(identifier)
            if definition is not None:
                return f"'{definition.description()}'"
        if parameter == "nodata":
            return tr("the layer's additional nodata value")
        if parameter == "crs":
            return tr("the layer's properties")
        if parameter == "to_crs":
            return tr("a layer reprojected before")
        return parameter.replace("_", " ")

    return label_of


def in_words(message: Message | Warning, name_of: Callable[[str], str]) -> str:
    """Return the text of a message as a sentence.

    Parameters
    ----------
    message : WaveletError, Warning or Note
        What is to be said; a warning of the mathematics is about no parameter.
    name_of : callable
        From `labels_of`.
    """
    in_words = getattr(message, "in_words", None)
    text: str = str(message) if in_words is None else in_words(name_of)
    # What starts with the name of a layer or a file keeps it as it is.
    return text if ": " in text.split(";")[0] else text[:1].upper() + text[1:]
