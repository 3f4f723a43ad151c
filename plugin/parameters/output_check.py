"""Outputs looked at before the long work: refused at once, or taken back where it fails."""

from __future__ import annotations

import contextlib
import os
import re
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsProcessing,
    QgsProcessingOutputLayerDefinition,
    QgsProcessingParameterFileDestination,
)

from .request import file_of

if TYPE_CHECKING:
    from qgis.core import (
        QgsProcessingAlgorithm,
        QgsProcessingContext,
        QgsProcessingParameterDefinition,
    )


def check_outputs(
    algorithm: QgsProcessingAlgorithm, parameters: dict[str, Any], context: QgsProcessingContext
) -> None:
    """Refuse an output that cannot be written, or that is the input itself.

    Call it in the thread that the layers live in.

    Raises
    ------
    OutputFileError
    """
    from wavelet_gis.io.atomic import check_output

    inputs = _input_files(algorithm, parameters, context)
    for definition in algorithm.destinationParameterDefinitions():
        if definition.type() == "folderDestination":  # its writer looks at what is there
            continue
        path = _chosen_file(definition, parameters.get(definition.name()))
        if path is not None:
            suffixes: tuple[str, ...] = ()
            if isinstance(definition, QgsProcessingParameterFileDestination):
                suffixes = tuple(re.findall(r"\*(\.\w+)", definition.fileFilter()))
            check_output(path, overwrite=True, suffixes=suffixes, inputs=inputs)


class ChosenFiles:
    """The files that a user chose for outputs, and whether they were there before the run."""

    def __init__(self, algorithm: QgsProcessingAlgorithm, parameters: dict[str, Any]) -> None:
        self._before: dict[str, tuple[int, int] | None] = {}
        for definition in algorithm.destinationParameterDefinitions():
            value = parameters.get(definition.name())
            path = _chosen_file(definition, value)
            is_folder = definition.type() == "folderDestination"
            if path is not None and not is_folder and not _appends(value):
                self._before[path] = _state_of(path)

    def take_back(self) -> None:
        """Remove what the run has written, were it whole: half of the outputs is no result."""
        for path, before in self._before.items():
            if _state_of(path) not in (None, before):
                for name in (path, f"{path}.aux.xml"):
                    with contextlib.suppress(OSError):
                        os.unlink(name)


def _appends(value: Any) -> bool:
    """Return whether features are added to a layer of the user's, which holds others already."""
    return isinstance(value, QgsProcessingOutputLayerDefinition) and value.useRemapping()


def _state_of(path: str) -> tuple[int, int] | None:
    """Return what tells a file from the one that it was; None where there is none."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def _chosen_file(definition: QgsProcessingParameterDefinition, value: Any) -> str | None:
    """Return the path that a user chose; None for what is temporary or goes into a database."""
    if isinstance(value, QgsProcessingOutputLayerDefinition):
        value = value.sink.staticValue()
    if not isinstance(value, str) or value in ("", QgsProcessing.TEMPORARY_OUTPUT):
        return None
    # A sink may also be a table in a database, or memory.
    return value if definition.type() != "sink" or os.path.isabs(value) else None


def _input_files(
    algorithm: QgsProcessingAlgorithm, parameters: dict[str, Any], context: QgsProcessingContext
) -> tuple[str, ...]:
    """Return the files that are read; those that are in use by a layer too."""
    files = []
    for definition in algorithm.parameterDefinitions():
        name, kind = definition.name(), definition.type()
        if kind == "file":
            files.append(file_of(algorithm, parameters, name, context))
        elif kind == "raster":
            raster = algorithm.parameterAsRasterLayer(parameters, name, context)
            files.append(raster.source() if raster else "")
        elif kind == "source":
            layer = algorithm.parameterAsVectorLayer(parameters, name, context)
            files.append(layer.source() if layer else "")
    return tuple(file.split("|")[0] for file in files if file)
