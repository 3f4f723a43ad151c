"""How a dialog asks for a pyramid: a list of those at hand, any path, and the table of its levels.

Imported by dialogs alone: ``qgis_process`` has no widgets.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from qgis.core import QgsProcessingContext, QgsProject
from qgis.gui import QgsAbstractProcessingParameterWidgetWrapper, QgsGui, QgsProcessingGui
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import (
    QAbstractItemView,
    QComboBox,
    QFileDialog,
    QHBoxLayout,
    QHeaderView,
    QTableWidget,
    QTableWidgetItem,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from .known_pyramids import KnownPyramid, known_pyramids, pyramid_at
from .translation import tr

if TYPE_CHECKING:
    from collections.abc import Iterable

    from qgis.core import QgsProcessingParameterDefinition

#: Height in pixels that the table of levels takes at most; a dialog has other parameters too.
TABLE_HEIGHT = 150

_WIDGETS: Any = QgsProcessingGui.WidgetType


class PyramidChoice:
    """A list of pyramids that takes a path too, with the levels of the chosen one below it.

    It holds its widget and is none: QGIS takes the widget over, and with it the Python half of a
    class of widgets, whose slots would never be called again.
    """

    def __init__(self, shows_levels: bool) -> None:
        self.widget = QWidget()
        self.pyramids: list[KnownPyramid] = known_pyramids(QgsProject.instance())
        self.combo = QComboBox()
        self.combo.setEditable(True)
        self.combo.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        self.combo.setSizeAdjustPolicy(
            QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon
        )
        for pyramid in self.pyramids:
            self.combo.addItem(pyramid.title, pyramid.path)
            self.combo.setItemData(
                self.combo.count() - 1, pyramid.path, Qt.ItemDataRole.ToolTipRole
            )
        line = self.combo.lineEdit()
        if line is not None:
            line.setPlaceholderText(tr("a pyramid of this project or session, or a file"))
        self.button = QToolButton()
        self.button.setText("…")
        self.button.setToolTip(tr("Select a file"))
        self.button.clicked.connect(self._select_file)
        row = QHBoxLayout()
        row.addWidget(self.combo, 1)
        row.addWidget(self.button)
        column = QVBoxLayout(self.widget)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(row)
        self.table: QTableWidget | None = _empty_table() if shows_levels else None
        if self.table is not None:
            column.addWidget(self.table)
        self.combo.currentTextChanged.connect(self._show_levels)
        self._show_levels()

    def path(self) -> str:
        """Return the path of what is chosen, or what was typed."""
        text, index = self.combo.currentText(), self.combo.currentIndex()
        if index >= 0 and text == self.combo.itemText(index):
            return str(self.combo.itemData(index))
        return text.strip().strip('"')

    def choose(self, path: str) -> None:
        """Choose the pyramid of a path, whether it is in the list or not."""
        index = self.combo.findData(path)
        if index >= 0:
            self.combo.setCurrentIndex(index)
        else:
            self.combo.setEditText(path)

    def _select_file(self) -> None:
        path, _ = QFileDialog.getOpenFileName(
            self.button, tr("Pyramid"), self.path(), tr("Pyramid (*.gpkg)")
        )
        if path:
            self.choose(path)

    def _show_levels(self, text: str = "") -> None:
        if self.table is None:
            return
        path = self.path()
        listed = [pyramid for pyramid in self.pyramids if pyramid.path == path]
        pyramid = listed[0] if listed else pyramid_at(path)
        rows = [] if pyramid is None else pyramid.levels
        self.table.setRowCount(len(rows))
        for k, level in enumerate(rows):
            for column, shown in enumerate(_shown(level)):
                item = QTableWidgetItem(shown)
                item.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
                self.table.setItem(k, column, item)
        self.table.setVisible(bool(rows))


def _shown(level: dict[str, Any]) -> tuple[str, str, str, str]:
    """Return level, vertices, RMSE and largest error as they are shown."""
    errors = [level["rmse_surface"], level["max_error_surface"]]
    known = [e is not None and math.isfinite(e) for e in errors]
    rmse, largest = (
        f"{error:.4g}" if is_known else tr("not measured")
        for error, is_known in zip(errors, known, strict=True)
    )
    return str(level["level"]), f"{level['n_vertices']:,}", rmse, largest


def _empty_table() -> QTableWidget:
    table = QTableWidget(0, 4)
    table.setHorizontalHeaderLabels([tr("level"), tr("vertices"), tr("RMSE"), tr("largest error")])
    table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
    table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
    table.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
    table.setMaximumHeight(TABLE_HEIGHT)
    across, down = table.horizontalHeader(), table.verticalHeader()
    if across is not None and down is not None:
        across.setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        down.setVisible(False)
        down.setDefaultSectionSize(20)
    return table


class _PyramidWrapper(QgsAbstractProcessingParameterWidgetWrapper):
    """The list in a dialog; a click on a level gives it to the parameter that takes one."""

    def __init__(
        self, parameter: QgsProcessingParameterDefinition, dialog: Any, level: str
    ) -> None:
        super().__init__(parameter, _WIDGETS.Standard)
        self._level_name = level
        self._level: QgsAbstractProcessingParameterWidgetWrapper | None = None
        self._choice: PyramidChoice | None = None

    def createWidget(self) -> QWidget:
        """Return the list, with the newest pyramid chosen."""
        self._choice = PyramidChoice(bool(self._level_name))
        self._choice.combo.currentTextChanged.connect(
            lambda text: self.widgetValueHasChanged.emit(self)
        )
        if self._choice.table is not None:
            self._choice.table.cellClicked.connect(self._take_level)
        return self._choice.widget

    def setWidgetValue(self, value: Any, context: QgsProcessingContext) -> None:
        """Show a path."""
        if self._choice is not None and isinstance(value, str) and value:
            self._choice.choose(value)

    def widgetValue(self) -> Any:
        """Return the path."""
        return None if self._choice is None else self._choice.path() or None

    def postInitialize(
        self, wrappers: Iterable[QgsAbstractProcessingParameterWidgetWrapper]
    ) -> None:
        """Find the parameter that a click on a level fills."""
        for wrapper in wrappers:
            definition = wrapper.parameterDefinition()
            if definition is not None and definition.name() == self._level_name:
                self._level = wrapper

    def _take_level(self, row: int, column: int) -> None:
        item = None
        if self._choice is not None and self._choice.table is not None:
            item = self._choice.table.item(row, 0)
        if item is not None and self._level is not None:
            self._level.setParameterValue(int(item.text()), QgsProcessingContext())


class PyramidWrapper:
    """What Processing makes for the parameter: our list in a dialog, QGIS's own widgets elsewhere.

    In a model a pyramid mostly comes out of another step, which QGIS's widget offers; in a batch
    many files are chosen at once.
    """

    def __new__(  # Processing calls a class and takes what it gives
        cls, parameter: Any, dialog: Any, row: int = 0, column: int = 0, level: str = ""
    ) -> Any:
        """Return the wrapper for a dialog."""
        registry: Any = QgsGui.processingGuiRegistry()
        kind = type(dialog).__name__
        if kind == "ModelerParametersDialog":
            wrapper = registry.createModelerParameterWidget(
                dialog.model, dialog.childId, parameter, dialog.context
            )
        elif kind == "BatchAlgorithmDialog":
            wrapper = registry.createParameterWidgetWrapper(parameter, _WIDGETS.Batch)
        else:
            wrapper = _PyramidWrapper(parameter, dialog, level)
        wrapper.setDialog(dialog)
        return wrapper
