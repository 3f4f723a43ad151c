"""What all algorithms share: help, the check of packages, and errors turned into QGIS's."""

from __future__ import annotations

import html

from qgis.core import (
    QgsProcessingAlgorithm,
    QgsProcessingException,
    QgsProcessingParameterDefinition,
)
from qgis.PyQt.QtGui import QIcon

from .packages import ICON, install_finder
from .ui import dependencies
from .ui.translation import tr
from .ui.warning_log import shown_in
from .ui.wording import for_dialog

ADVANCED = QgsProcessingParameterDefinition.Flag.FlagAdvanced


class TerrainWaveletsAlgorithm(QgsProcessingAlgorithm):
    """Base of every algorithm.

    A subclass gives ``name`` (public, never changed), ``displayName``, ``GROUP``, ``tags``,
    ``about``, ``initAlgorithm`` and ``work``; the rest is here.
    """

    #: Id and translatable name of the group in the toolbox; see ``groups.py``.
    GROUP = None
    #: Packages needed beyond numpy and scipy, as ``dependencies.Package``.
    PACKAGES = ()

    def tr(self, text):
        """Return ``text`` in the user's language."""
        return tr(text)

    def createInstance(self):
        """Return a new algorithm of the same kind."""
        return type(self)()

    def groupId(self):
        """Return the id of the group in the toolbox."""
        return self.GROUP

    def group(self):
        """Return the name of the group in the toolbox."""
        return {
            "analysis": self.tr("Analysis"),
            "reconstruction": self.tr("Reconstruction"),
            "details": self.tr("Details"),
            "quality": self.tr("Quality"),
        }[self.GROUP]

    def icon(self):
        """Return the provider's icon."""
        return QIcon(ICON)

    def svgIconPath(self):
        """Return the file of the provider's icon."""
        return ICON

    def about(self):
        """Return what the algorithm does, in a few sentences of HTML."""
        raise AssertionError(f"{self.name()} says nothing about itself")

    def shortHelpString(self):
        """Return the help: what the algorithm does, then what each parameter and output is."""
        lines = [f"<p>{self.about()}</p>"]
        helped = [p for p in self.parameterDefinitions() if p.help()]
        if helped:
            lines.append(f"<h3>{self.tr('Parameters')}</h3>")
        lines += [f"<p><b>{html.escape(p.description())}</b><br>{p.help()}</p>" for p in helped]
        numbers = [
            o for o in self.outputDefinitions() if o.type() in ("outputNumber", "outputString")
        ]
        if numbers:
            lines.append(f"<h3>{self.tr('Also returned')}</h3><ul>")
            lines += [f"<li>{html.escape(o.description())} ({o.name()})</li>" for o in numbers]
            lines.append("</ul>")
        return "\n".join(lines)

    def add(self, parameter, help_text, advanced=False):
        """Declare ``parameter`` with its help; ``advanced`` ones are folded away in the dialog."""
        parameter.setHelp(help_text)
        if advanced:
            parameter.setFlags(parameter.flags() | ADVANCED)
        self.addParameter(parameter)

    def canExecute(self):
        """Return True always; what is missing is told, with the remedy, when it is run."""
        return True, ""

    def packages(self, parameters, context):
        """Return what these parameters need beyond numpy and scipy."""
        return self.PACKAGES

    def prepareAlgorithm(self, parameters, context, feedback):
        """Refuse where a package is missing, then take what needs the layers' own thread."""
        refusal = dependencies.refusal(self.packages(parameters, context))
        if refusal:
            raise QgsProcessingException(refusal)
        install_finder()
        from wavelet_core.errors import WaveletError

        from .parameters.output_check import check_outputs

        try:
            check_outputs(self, parameters, context)
        except WaveletError as error:
            raise QgsProcessingException(self.in_words(error)) from error
        self.prepare(parameters, context, feedback)
        return True

    def in_words(self, message):
        """Return a message of the shared layers in the words of this algorithm's dialog."""
        return for_dialog(message, has_crs=self.parameterDefinition("CRS") is not None)

    def prepare(self, parameters, context, feedback):
        """Take from layers, in their own thread, what `work` needs of them."""

    def processAlgorithm(self, parameters, context, feedback):
        """Run, with every error of ours as a message in the log rather than a traceback."""
        slow = dependencies.slow_without_numba()
        if slow:
            feedback.pushWarning(slow)
        from wavelet_core.errors import Cancelled, WaveletError

        try:
            with shown_in(feedback, self.in_words):
                return self.work(parameters, context, feedback)
        except Cancelled:
            feedback.pushInfo(self.tr("Cancelled; nothing was written."))
            return {}
        except WaveletError as error:
            raise QgsProcessingException(self.in_words(error)) from error
        except MemoryError as error:
            raise QgsProcessingException(
                self.tr(
                    "There is not enough memory for this input (some 700 bytes a vertex are "
                    "needed). Cut it, or take a coarser one."
                )
            ) from error

    def work(self, parameters, context, feedback):
        """Do the work and return the outputs; ours to raise are the errors of ``wavelet_core``."""
        raise AssertionError(f"{self.name()} does nothing")
