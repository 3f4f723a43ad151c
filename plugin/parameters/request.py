"""What a user asked of an algorithm, read out of QGIS's parameters."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from qgis.core import QgsPointCloudLayer, QgsProcessingFeedback

from ..qgis_io.background import Result, computed
from ..qgis_io.crs_and_progress import progress, require_running
from ..ui.layer_styles import finish_output

if TYPE_CHECKING:
    from qgis.core import (
        QgsCoordinateReferenceSystem,
        QgsCoordinateTransformContext,
        QgsProcessingAlgorithm,
        QgsProcessingContext,
        QgsProcessingFeatureSource,
    )

    from ..qgis_io.background import Work

#: A choice that leaves it to the workflow, whose defaults are those of the command line.
DEFAULT = "default"


class Request:
    """One run of an algorithm: its parameters, with the log and the cancel button that go with it.

    Parameters
    ----------
    algorithm : QgsProcessingAlgorithm
        Whose parameters.
    parameters : dict
        As QGIS hands them over; what a model leaves open is None.
    context : QgsProcessingContext
        In which they are read.
    feedback : QgsProcessingFeedback, optional
        The log; none before the run.
    """

    def __init__(
        self,
        algorithm: QgsProcessingAlgorithm,
        parameters: dict[str, Any],
        context: QgsProcessingContext,
        feedback: QgsProcessingFeedback | None = None,
    ) -> None:
        self.algorithm = algorithm
        self.parameters = parameters
        self.context = context
        self.feedback = feedback or QgsProcessingFeedback()
        #: Sizes and errors of what was made, for the metadata of every layer.
        self.figures: dict[str, Any] = {}
        self._shown = 0.0  # where the bar stands
        self._from, self._to = 0.0, 0.0  # a part of the work begins here, and there on the bar

    # What was asked for.

    def has(self, name: str) -> bool:
        """Return whether a parameter says anything."""
        return self.parameters.get(name) not in (None, "")

    def wants(self, name: str) -> bool:
        """Return whether the algorithm has an output of this name, and it is wanted."""
        definition = self.algorithm.parameterDefinition(name)
        return definition is not None and definition.isDestination() and self.has(name)

    def text(self, name: str) -> str:
        """Return a text without blanks around it; "" where there is none."""
        return self.algorithm.parameterAsString(self.parameters, name, self.context).strip()

    def choice(self, name: str) -> str | None:
        """Return what was chosen of a list; None where that is left to the workflow."""
        chosen = self.text(name)
        return None if chosen in ("", DEFAULT) else chosen

    def flag(self, name: str) -> bool:
        """Return whether a box is ticked."""
        return self.algorithm.parameterAsBool(self.parameters, name, self.context)

    def whole(self, name: str) -> int | None:
        """Return a whole number, its default where it is left open, None where it has none."""
        if self._is_open(name):
            return None
        return self.algorithm.parameterAsInt(self.parameters, name, self.context)

    def number(self, name: str) -> float | None:
        """Return a number, its default where it is left open, None where it has none."""
        if self._is_open(name):
            return None
        return self.algorithm.parameterAsDouble(self.parameters, name, self.context)

    def size(self, name: str) -> float | None:
        """Return a length; None where it is left open or 0."""
        return self.number(name) or None

    def words(self, name: str) -> list[str]:
        """Return the words of a list with commas."""
        return [word.strip() for word in self.text(name).split(",") if word.strip()]

    def whole_numbers(self, name: str) -> list[int]:
        """Return the whole numbers of a list with commas.

        Raises
        ------
        ValueError
            One that is no whole number.
        """
        return [int(word) for word in self.words(name)]

    def strings(self, name: str) -> list[str]:
        """Return the names that were chosen of several, such as those of fields."""
        return self.algorithm.parameterAsStrings(self.parameters, name, self.context)

    def choices(self, name: str) -> list[str]:
        """Return what was chosen of a list that allows several."""
        return self.algorithm.parameterAsEnumStrings(self.parameters, name, self.context)

    def pairs(self, name: str) -> list[tuple[Any, Any]]:
        """Return the rows of a matrix of two columns; cells left empty do not count.

        Raises
        ------
        ValueError
            A cell without its partner.
        """
        cells = self.algorithm.parameterAsMatrix(self.parameters, name, self.context)
        cells = [cell for cell in cells if cell not in (None, "")]
        return list(zip(cells[::2], cells[1::2], strict=True))

    def crs(self, name: str) -> QgsCoordinateReferenceSystem:
        """Return a CRS; an invalid one where none was chosen."""
        return self.algorithm.parameterAsCrs(self.parameters, name, self.context)

    def input_file(self, name: str) -> str:
        """Return the path of a file that is read, without the name of a layer in it."""
        return file_of(self.algorithm, self.parameters, name, self.context)

    def input_cloud(self, name: str) -> QgsPointCloudLayer | None:
        """Return the layer that a file's parameter names; None where it names a file."""
        value = self.algorithm.parameterAsString(self.parameters, name, self.context)
        return _cloud_layer(value, self.context)

    def source(self, name: str) -> QgsProcessingFeatureSource | None:
        """Return the features of a layer; None where none was chosen."""
        return self.algorithm.parameterAsSource(self.parameters, name, self.context)

    # Where results go.

    def output_file(self, name: str) -> str:
        """Return the path of a file that is written; "" where it is not wanted."""
        return self.algorithm.parameterAsFileOutput(self.parameters, name, self.context)

    def output_layer(self, name: str) -> str:
        """Return the path of a raster that is written; "" where it is not wanted."""
        return self.algorithm.parameterAsOutputLayer(self.parameters, name, self.context)

    def finish(self, name: str, destination: str, style: Callable[[Any], None]) -> None:
        """Let an output open with a style, and with metadata on what it is and what made it.

        Parameters
        ----------
        name : str
            Of the output.
        destination : str
            Where it is.
        style : callable
            One of `plugin.ui.layer_styles` that take a layer.
        """
        definition = self.algorithm.parameterDefinition(name)
        help_text = "" if definition is None else definition.help()
        shown = definition or self.algorithm.outputDefinition(name)
        title = name if shown is None else shown.description()
        # The help of a file says what can be chosen; the first sentence of others, what it is.
        is_layer = definition is not None and definition.type() in ("sink", "rasterDestination")
        abstract = f"{self.algorithm.displayName()}: {title}. "
        abstract += without_tags(help_text) if is_layer else ""
        if self.figures:
            abstract += "\n" + "\n".join(f"{key} = {value}" for key, value in self.figures.items())
        command = getattr(self.algorithm, "command", "")
        finish_output(self.context, destination, style, abstract=abstract, command=command)

    # How it goes.

    @property
    def transforms(self) -> QgsCoordinateTransformContext:
        """How coordinates are transformed in this project."""
        return self.context.transformContext()

    def say(self, text: str) -> None:
        """Write a line to the log."""
        self.feedback.pushInfo(text)

    def stage(self, text: str) -> None:
        """Show what is being done; stop here if the user has cancelled."""
        self.feedback.setProgressText(text)
        require_running(self.feedback)

    def begins_at(self, start: float) -> None:
        """Let the parts that follow share what is left of the bar, named as if it stood at `start`.

        For a first part that takes long: the algorithms need not know.
        """
        self._from, self._to = start, self._shown

    def _on_bar(self, start: float, stop: float) -> tuple[float, float]:
        """Return where a part begins and ends on the bar, which never runs back.

        One whose place has been passed by others has its width of what is left, at most half.
        """
        scale = (1.0 - self._to) / (1.0 - self._from)
        begin, end = (self._to + scale * (part - self._from) for part in (start, stop))
        width = min(end - begin, (1.0 - self._shown) / 2)
        return max(begin, self._shown), max(end, self._shown + width)

    def progress(self, start: float = 0.0, stop: float = 1.0) -> Callable[[float], bool]:
        """Return a progress function that drives a part of QGIS's bar.

        The bar never runs back: which parts there are depends on the outputs that are wanted, and
        what a file is read back by reports after all that was written to it.
        """
        start, stop = self._on_bar(start, stop)
        drive = progress(self.feedback)

        def report(fraction: float) -> bool:
            self._shown = max(self._shown, start + (stop - start) * fraction)
            return drive(self._shown)

        return report

    def computed(
        self, function: Callable[[Work], Result], start: float = 0.0, stop: float = 1.0
    ) -> Result:
        """Return what a function computes, which may take long without reporting anything.

        Parameters
        ----------
        function : callable
            Takes a `plugin.qgis_io.background.Work`. It must neither write nor use layers.
        start, stop : float
            The part of the bar that it drives.
        """
        start, self._shown = self._on_bar(start, stop)
        return computed(self.feedback, function, start, self._shown)

    def _is_open(self, name: str) -> bool:
        definition = self.algorithm.parameterDefinition(name)
        has_default = definition is not None and definition.defaultValue() is not None
        return self.parameters.get(name) is None and not has_default


def file_of(
    algorithm: QgsProcessingAlgorithm,
    parameters: dict[str, Any],
    name: str,
    context: QgsProcessingContext,
) -> str:
    """Return the path of a file that is read: as it is named, or that of a point cloud layer."""
    value = algorithm.parameterAsString(parameters, name, context)
    layer = _cloud_layer(value, context)
    return value.split("|")[0] if layer is None else layer.source()


def _cloud_layer(value: str, context: QgsProcessingContext) -> QgsPointCloudLayer | None:
    """Return the point cloud layer of the project with an id, or a name; None for all else."""
    project = context.project()
    if project is None or not value or os.path.exists(value):
        return None
    for layer in (project.mapLayer(value), *project.mapLayersByName(value)):
        if isinstance(layer, QgsPointCloudLayer):
            return layer
    return None


def without_tags(text: str) -> str:
    """Return a help text as metadata hold it, without HTML.

    Examples
    --------
    >>> without_tags("Fields: <i>level</i>")
    'Fields: level'
    """
    return re.sub(r"<[^>]*>", "", text)
