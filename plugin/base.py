"""What all algorithms share: help, the check of packages, and errors turned into QGIS's."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any, ClassVar

from qgis.core import QgsProcessingAlgorithm
from qgis.PyQt.QtGui import QIcon

from .packages import ICON, PLUGIN_FOLDER, install_finder
from .parameters.request import Request
from .ui import dependencies
from .ui.enums import ADVANCED
from .ui.exceptions import QgsProcessingException, held_by_nobody
from .ui.translation import tr
from .ui.warning_log import shown_in
from .ui.wording import in_words, labels_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from qgis.core import (
        QgsProcessingContext,
        QgsProcessingFeedback,
        QgsProcessingParameterDefinition,
    )

    from wavelet_gis.notes import Note

#: What QGIS hands over for each parameter, by its name, and takes back for each output.
Values = dict[str, Any]


class TerrainWaveletsAlgorithm(QgsProcessingAlgorithm):
    """Base of every algorithm.

    A subclass gives ``name`` (public, never changed), ``displayName``, ``GROUP``, ``tags``,
    ``about``, ``declare`` and ``work``; the rest is here.
    """

    #: Id of the group in the toolbox.
    GROUP: ClassVar[str]
    #: Page of the help that describes it.
    PAGE: ClassVar[str] = "qgis"
    #: Packages needed beyond NumPy and SciPy.
    PACKAGES: ClassVar[tuple[dependencies.Package, ...]] = ()
    #: What is being run, as Python takes it; for the metadata of its outputs.
    command: str = ""

    def createInstance(self) -> TerrainWaveletsAlgorithm:
        """Return a new algorithm of the same kind."""
        return type(self)()

    def groupId(self) -> str:
        """Return the id of the group in the toolbox."""
        return self.GROUP

    def group(self) -> str:
        """Return the name of the group in the toolbox."""
        return {
            "analysis": tr("Analysis"),
            "reconstruction": tr("Reconstruction"),
            "readoff": tr("Read off"),
            "details": tr("Details"),
            "quality": tr("Quality"),
        }[self.GROUP]

    def icon(self) -> QIcon:
        """Return the provider's icon."""
        return QIcon(ICON)

    def svgIconPath(self) -> str:
        """Return the file of the provider's icon."""
        return ICON

    def about(self) -> str:
        """Return what the algorithm does, in a few sentences of HTML."""
        raise AssertionError(f"{self.name()} says nothing about itself")

    def shortHelpString(self) -> str:
        """Return the help: what the algorithm does, then what each parameter and output is."""
        lines = [f"<p>{self.about()}</p>"]
        helped = [p for p in self.parameterDefinitions() if p.help()]
        if helped:
            lines.append(f"<h3>{tr('Parameters')}</h3>")
        lines += [f"<p><b>{html.escape(p.description())}</b><br>{p.help()}</p>" for p in helped]
        figures = [
            o for o in self.outputDefinitions() if o.type() in ("outputNumber", "outputString")
        ]
        if figures:
            lines.append(f"<h3>{tr('Also returned')}</h3><ul>")
            lines += [f"<li>{html.escape(o.description())} ({o.name()})</li>" for o in figures]
            lines.append("</ul>")
        return "\n".join(lines)

    def helpUrl(self) -> str:
        """Return the page that the zip brings; none where this is no zip."""
        path = PLUGIN_FOLDER / "help" / f"{self.PAGE}.html"
        return path.as_uri() if path.is_file() else ""

    def initAlgorithm(self, configuration: Values | None = None) -> None:
        """Declare parameters and outputs."""
        self.declare()

    def declare(self) -> None:
        """Declare parameters and outputs; a subclass says which."""
        raise AssertionError(f"{self.name()} has no parameters")

    def add(
        self,
        parameter: QgsProcessingParameterDefinition,
        help_text: str,
        advanced: bool = False,
    ) -> None:
        """Declare a parameter with its help; ``advanced`` ones are folded away in the dialog."""
        parameter.setHelp(help_text)
        if advanced:
            parameter.setFlags(parameter.flags() | ADVANCED)
        self.addParameter(parameter)

    def canExecute(self) -> tuple[bool, str]:
        """Return True always; what is missing is said, with the remedy, when it is run."""
        return True, ""

    def checkParameterValues(
        self, parameters: Values, context: QgsProcessingContext
    ) -> tuple[bool, str]:
        """Refuse, before anything is started, what cannot be meant."""
        missing = dependencies.refusal()
        if missing:
            return False, missing
        is_fine, message = super().checkParameterValues(parameters, context)
        if not is_fine:
            return False, message or ""
        refusal = self.refusal(Request(self, parameters, context))
        return refusal is None, refusal or ""

    def refusal(self, request: Request) -> str | None:
        """Return why these parameters cannot be meant, or None where they can."""
        return None

    def packages(self, request: Request) -> Iterable[dependencies.Package]:
        """Return what these parameters need beyond NumPy and SciPy."""
        return self.PACKAGES

    @held_by_nobody
    def prepareAlgorithm(
        self,
        parameters: Values,
        context: QgsProcessingContext,
        feedback: QgsProcessingFeedback | None,
    ) -> bool:
        """Refuse where a package is missing, then take what needs the layers' own thread."""
        request = Request(self, parameters, context, feedback)
        missing = dependencies.refusal(tuple(self.packages(request)))
        if missing:
            raise QgsProcessingException(missing)
        install_finder()
        from wavelet_core.errors import WaveletError

        from .parameters.output_check import check_outputs

        try:
            check_outputs(self, parameters, context)
        except WaveletError as error:
            raise QgsProcessingException(self.in_words(error)) from error
        self.command = self.asPythonCommand(parameters, context)
        self.take_layers(request)
        return True

    def in_words(self, message: Any) -> str:
        """Return an error, a warning or a note in the words of this algorithm's dialog."""
        return in_words(message, labels_of(self))

    def take_layers(self, request: Request) -> None:
        """Take from layers, in their own thread, what `work` needs of them."""

    @held_by_nobody
    def processAlgorithm(
        self,
        parameters: Values,
        context: QgsProcessingContext,
        feedback: QgsProcessingFeedback | None,
    ) -> Values:
        """Run, with every error of ours as a message in the log rather than a traceback."""
        request = Request(self, parameters, context, feedback)
        slow = dependencies.slow_without_numba()
        if slow:
            request.feedback.pushWarning(slow)
        from wavelet_core.errors import Cancelled, WaveletError
        from wavelet_gis.notes import collected

        from .parameters.output_check import ChosenFiles

        files = ChosenFiles(self, parameters)
        results: Values | None = None
        refusal = ""
        try:
            with shown_in(request.feedback, self.in_words), collected() as notes:
                reason = self.refusal(request)  # a model asks none of its steps before they run
                if reason:
                    raise QgsProcessingException(reason)
                results = self.work(request)
        except Cancelled:
            pass
        except WaveletError as error:
            refusal = dependencies.with_remedy(self.in_words(error))
        except MemoryError:
            refusal = tr(
                "There is not enough memory for this input (some 700 bytes a vertex are "
                "needed). Cut it, or take a coarser one."
            )
        except QgsProcessingException as error:
            refusal = str(error)
        # Here what the work held is closed and gone, which a traceback would have kept for QGIS.
        if results is None:
            files.take_back()
        if refusal:
            raise QgsProcessingException(refusal)
        if results is None:
            request.say(self.cancelled())
            return {}
        self._log_notes(request, notes)
        return results

    def cancelled(self) -> str:
        """Return what is told after a cancel."""
        return tr("Cancelled; nothing was written.")

    def work(self, request: Request) -> Values:
        """Do the work and return the outputs; ours to raise are the errors of ``wavelet_core``."""
        raise AssertionError(f"{self.name()} does nothing")

    def _log_notes(self, request: Request, notes: list[Note]) -> None:
        """Write what was noted on the way to the log; warnings are there already."""
        for note in notes:
            if not note.is_warning:
                request.say(self.in_words(note))
