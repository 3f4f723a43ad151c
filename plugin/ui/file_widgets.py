"""How a dialog asks for a pyramid or a point cloud: a list of those at hand, and any path.

Of a pyramid it shows the table of its levels, too.

Imported by dialogs alone: ``qgis_process`` has no widgets.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from qgis.core import QgsPointCloudLayer, QgsProcessingContext, QgsProject
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


class FileChoice:
    """A list of what is at hand that takes a path too.

    It holds its widget and is none: QGIS takes the widget over, and with it the Python half of a
    class of widgets, whose slots would never be called again.

    Parameters
    ----------
    offers : list of (str, str, str)
        For each of what is at hand: its title, the value that it stands for, a tooltip.
    hint : str
        Shown where nothing is chosen.
    file_filter : str
        Of the dialog that asks for a file.
    """

    def __init__(self, offers: list[tuple[str, str, str]], hint: str, file_filter: str) -> None:
        self.widget = QWidget()
        self._file_filter = file_filter
        self.combo = QComboBox()
        self.combo.setEditable(True)
        self.combo.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        self.combo.setSizeAdjustPolicy(
            QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon
        )
        for k, (title, value, tip) in enumerate(offers):
            self.combo.addItem(title, value)
            self.combo.setItemData(k, tip, Qt.ItemDataRole.ToolTipRole)
        line = self.combo.lineEdit()
        if line is not None:
            line.setPlaceholderText(hint)
        self.button = QToolButton()
        self.button.setText("…")
        self.button.setToolTip(tr("Select a file"))
        self.button.clicked.connect(self._select_file)
        row = QHBoxLayout()
        row.addWidget(self.combo, 1)
        row.addWidget(self.button)
        self.column = QVBoxLayout(self.widget)
        self.column.setContentsMargins(0, 0, 0, 0)
        self.column.addLayout(row)

    def value(self) -> str:
        """Return what is chosen, or the path that was typed."""
        text, index = self.combo.currentText(), self.combo.currentIndex()
        if index >= 0 and text == self.combo.itemText(index):
            return str(self.combo.itemData(index))
        return text.strip().strip('"')

    def choose(self, value: str) -> None:
        """Choose a value, whether it is in the list or not."""
        index = self.combo.findData(value)
        if index >= 0:
            self.combo.setCurrentIndex(index)
        else:
            self.combo.setEditText(value)

    def _select_file(self) -> None:
        path, _ = QFileDialog.getOpenFileName(
            self.button, tr("Select a file"), self.value(), self._file_filter
        )
        if path:
            self.choose(path)


class PyramidChoice(FileChoice):
    """A list of pyramids, with the levels of the chosen one below it."""

    def __init__(self, shows_levels: bool) -> None:
        self.pyramids: list[KnownPyramid] = known_pyramids(QgsProject.instance())
        super().__init__(
            [(pyramid.title, pyramid.path, pyramid.path) for pyramid in self.pyramids],
            tr("a pyramid of this project or session, or a file"),
            tr("Pyramid (*.gpkg)"),
        )
        self.table: QTableWidget | None = _empty_table() if shows_levels else None
        if self.table is not None:
            self.column.addWidget(self.table)
        self.combo.currentTextChanged.connect(self._show_levels)
        self._show_levels()

    def _show_levels(self, text: str = "") -> None:
        if self.table is None:
            return
        path = self.value()
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


def _cloud_choice() -> FileChoice:
    """Return a list of the project's point cloud layers, of which the first is chosen."""
    project = QgsProject.instance()
    layers = [] if project is None else list(project.mapLayers().values())
    offers = []
    for layer in layers:
        if isinstance(layer, QgsPointCloudLayer):
            subset = layer.subsetString()
            title = f"{layer.name()} [{subset}]" if subset else layer.name()
            offers.append((title, layer.id(), layer.source()))
    return FileChoice(
        sorted(offers),
        tr("a point cloud layer of the project, or a file"),
        tr("LAS, LAZ and COPC (*.las *.laz *.LAS *.LAZ)"),
    )


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


class _FileWrapper(QgsAbstractProcessingParameterWidgetWrapper):
    """The list in a dialog; a click on a level gives it to the parameter that takes one."""

    def __init__(
        self,
        parameter: QgsProcessingParameterDefinition,
        choice_of: Callable[[], FileChoice],
        level: str = "",
    ) -> None:
        super().__init__(parameter, _WIDGETS.Standard)
        self._choice_of = choice_of
        self._level_name = level
        self._level: QgsAbstractProcessingParameterWidgetWrapper | None = None
        self.choice: FileChoice | None = None

    def createWidget(self) -> QWidget:
        """Return the list, with the first of what is at hand chosen."""
        self.choice = self._choice_of()
        self.choice.combo.currentTextChanged.connect(
            lambda text: self.widgetValueHasChanged.emit(self)
        )
        if isinstance(self.choice, PyramidChoice) and self.choice.table is not None:
            self.choice.table.cellClicked.connect(self._take_level)
        return self.choice.widget

    def setWidgetValue(self, value: Any, context: QgsProcessingContext) -> None:
        """Show a value."""
        if self.choice is not None and isinstance(value, str) and value:
            self.choice.choose(value)

    def widgetValue(self) -> Any:
        """Return the value."""
        return None if self.choice is None else self.choice.value() or None

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
        if isinstance(self.choice, PyramidChoice) and self.choice.table is not None:
            item = self.choice.table.item(row, 0)
        if item is not None and self._level is not None:
            self._level.setParameterValue(int(item.text()), QgsProcessingContext())


def _wrapper_in(dialog: Any, parameter: Any, own: Callable[[], Any]) -> Any:
    """Return our list in a dialog, and QGIS's own widgets in models and batches.

    In a model a file mostly comes out of another step, which QGIS's widget offers; in a batch many
    files are chosen at once.
    """
    registry: Any = QgsGui.processingGuiRegistry()
    kind = type(dialog).__name__
    if kind == "ModelerParametersDialog":
        wrapper = registry.createModelerParameterWidget(
            dialog.model, dialog.childId, parameter, dialog.context
        )
    elif kind == "BatchAlgorithmDialog":
        wrapper = registry.createParameterWidgetWrapper(parameter, _WIDGETS.Batch)
    else:
        wrapper = own()
    wrapper.setDialog(dialog)
    return wrapper


class PyramidWrapper:
    """What Processing makes for a pyramid."""

    def __new__(
        cls, parameter: Any, dialog: Any, row: int = 0, column: int = 0, level: str = ""
    ) -> Any:
        """Return the wrapper for a dialog."""
        own = partial(_FileWrapper, parameter, partial(PyramidChoice, bool(level)), level)
        return _wrapper_in(dialog, parameter, own)


class CloudWrapper:
    """What Processing makes for a point cloud."""

    def __new__(cls, parameter: Any, dialog: Any, row: int = 0, column: int = 0) -> Any:
        """Return the wrapper for a dialog."""
        return _wrapper_in(dialog, parameter, partial(_FileWrapper, parameter, _cloud_choice))
