"""Dialog of what would leave without the name.

All of it is shown before it is written; what was typed freely leaves only where it is ticked.
"""

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QDialog, QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.theme.current import current_theme, px
from app.widgets.button import Button, ButtonKind
from app.widgets.chips import Chips
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import ReadingArea
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.translation import tr

SIZE = (640, 600)
Rows = Sequence[tuple[str, str]]


class LeavingDialog(QDialog):
    """`previews`: for each choice of what was typed freely all that then leaves beside the figures, name and value."""

    confirmed = Signal(object)  # frozenset of keys: what was typed freely and leaves

    def __init__(self, previews: Mapping[frozenset[str], Rows], parent: QWidget) -> None:
        super().__init__(parent)
        self._previews = previews
        self.setWindowTitle(tr("Export without the name"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._title = Text(tr("Export without the name"), size=20, weight=SEMIBOLD, wraps=True)
        self._lead = Text(
            tr(
                "Besides measured values, the XLSX, C3D, OpenSim and FHIR files contain only what is listed "
                "here. The report saved with them shows the patient code and belongs in the patient's file. "
                "Dates are shifted by the same amount for every visit of the patient."
            ),
            tone="ink2",
            wraps=True,
        )
        self._also = Text(tr("Free text may contain a name: exported only if ticked"), weight=MEDIUM, wraps=True)
        self.typed = Chips(tr("Export as typed"), self._options())
        self._table = QWidget()
        self._grid = QGridLayout(self._table)
        self._grid.setColumnStretch(1, 1)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self.go = Button(tr("Choose the folder"), ButtonKind.PRIMARY)
        self.cancel = Button(tr("Cancel"), ButtonKind.SECONDARY)
        self._build()
        self.typed.turned.connect(self._show)
        self.go.clicked.connect(self._on_go_clicked)
        self.cancel.clicked.connect(self.reject)
        self._show()
        self.resize(px(SIZE[0]), px(SIZE[1]))

    @property
    def shown(self) -> list[tuple[str, str]]:
        """What is in the table."""
        return [(self._word(row, 0), self._word(row, 1)) for row in range(self._grid.rowCount()) if self._word(row, 0)]

    def _options(self) -> list[tuple[str, str]]:
        return [
            ("device", tr("Device")),
            ("aids", tr("Aids and footwear")),
            ("surface", tr("Surface")),
            ("conditions", tr("Conditions")),
            ("changes", tr("Prosthesis changes")),
        ]

    def _build(self) -> None:
        scroll = ReadingArea(self._table, tr("Everything exported besides measured values"))
        buttons = lay_out(QHBoxLayout(), 1, self.cancel, self.go)
        above = (self._title, self._lead, self._also, self.typed)
        lay_out(QVBoxLayout(self), *above, (scroll, 1), buttons, margins=(24, 20, 24, 20), spacing=12)
        palette = self.palette()
        palette.setColor(QPalette.ColorRole.Window, QColor(current_theme().colours.surface))
        self.setPalette(palette)

    def _show(self) -> None:
        while (item := self._grid.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for row, (name, value) in enumerate(self._previews[frozenset(self.typed.chosen)]):
            self._grid.addWidget(Text(tr(name), tone="ink2"), row, 0, Qt.AlignmentFlag.AlignTop)
            self._grid.addWidget(Text(value, wraps=True), row, 1, Qt.AlignmentFlag.AlignTop)
        self._grid.setRowStretch(self._grid.rowCount(), 1)

    def _word(self, row: int, column: int) -> str:
        item = self._grid.itemAtPosition(row, column)
        widget = item.widget() if item is not None else None
        return widget.text() if isinstance(widget, Text) else ""

    def _on_go_clicked(self) -> None:
        self.confirmed.emit(frozenset(self.typed.chosen))
        self.accept()
