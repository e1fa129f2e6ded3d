"""Which sessions are analysed again with this version: a list with a tick before each."""

from collections.abc import Sequence
from dataclasses import dataclass
from uuid import UUID

from PySide6.QtCore import QModelIndex, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QKeyEvent, QPainter
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.theme.current import scaled
from app.theme.icons import Icon, paint_icon
from app.theme.theme import Theme
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import TableCell, TextCell
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr, tr_n

ROW, HEAD, PADDING, MARK = 44, 36, 12, 20
MARGIN, GAP = 24, 12


@dataclass(frozen=True, slots=True)
class AgainLine:
    """A session; `is_current`: this version has analysed it. `failure`: why it could not be, the last time."""

    id: UUID
    patient: str
    when: str
    conditions: str
    is_current: bool
    failure: str = ""

    @property
    def state(self) -> str:
        if self.failure:
            return self.failure
        return tr("analysed with this version") if self.is_current else tr("not with this version")

    @property
    def in_words(self) -> str:
        return ", ".join(filter(None, [self.patient, self.when, self.conditions, self.state]))


@dataclass(frozen=True, slots=True)
class TickCell(TableCell):
    """A box, ticked or not, and the patient's code."""

    line: AgainLine
    is_on: bool

    @property
    def words(self) -> str:
        return self.line.patient

    @property
    def stated(self) -> str:
        return self.line.in_words

    @property
    def is_checked(self) -> bool | None:
        return self.is_on

    def width(self, theme: Theme) -> int:
        return theme.px(MARK + PADDING) + QFontMetrics(theme.font(15, SEMIBOLD)).horizontalAdvance(self.words)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        c, px = theme.colours, theme.px
        box = QRectF(room.left(), room.center().y() - px(MARK) / 2, px(MARK), px(MARK))
        painter.setPen(theme.pen(c.control, 1.25))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRoundedRect(box.adjusted(1, 1, -1, -1), px(4), px(4))
        if self.is_on:
            paint_icon(painter, Icon.CHECK, box, c.ink)
        painter.setFont(theme.font(15, SEMIBOLD))
        painter.setPen(QColor(c.ink))
        words = room.adjusted(px(MARK + PADDING), 0, 0, 0)
        painter.drawText(words, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, self.words)


class TickList(CellTable):
    """Space, Enter or a click turns the tick of a line."""

    def is_opening(self, event: QKeyEvent) -> bool:
        return event.key() == Qt.Key.Key_Space or super().is_opening(event)


class AnalyseAgainPage(QWidget):
    """Knows lines and which of them are ticked."""

    changed = Signal()  # other sessions are ticked

    def __init__(self) -> None:
        super().__init__()
        self._lines: tuple[AgainLine, ...] = ()
        self._ticked: set[UUID] = set()
        self._title = Text(tr("Analyse again"), size=26, weight=SEMIBOLD)
        self._lead = Text(
            tr(
                "The sessions are analysed with this version, on all processors. Entries, corrections and "
                "exclusions are kept. Results and progress across visits are saved in the library."
            ),
            tone="ink2",
            wraps=True,
        )
        self.earlier = Button(tr("Not with this version"), ButtonKind.SECONDARY, height=44)
        self.all = Button(tr("All"), ButtonKind.SECONDARY, height=44)
        self.none = Button(tr("None"), ButtonKind.QUIET, height=44)
        self.list = TickList(tr("Sessions"), row=ROW, head=HEAD, padding=PADDING, edge=PADDING, is_list=True)
        self.list.setAccessibleDescription(tr("Space selects or clears a session."))
        self.nothing = Text(tr("No session here has a recording."), wraps=True)
        self._build()
        self.list.opened.connect(self._turn)
        self.list.clicked.connect(self._on_clicked)
        self.earlier.clicked.connect(self._on_earlier)
        self.all.clicked.connect(self._on_all)
        self.none.clicked.connect(self._on_none)
        self.forget()
        scaled(self._column.setContentsMargins, MARGIN, 16, MARGIN, GAP)
        scaled(self._column.setSpacing, GAP)
        scaled(self._buttons.setSpacing, 8)
        scaled(self.list.setMinimumHeight, HEAD + 3 * ROW)

    @property
    def ticked(self) -> tuple[UUID, ...]:
        """The sessions that are ticked, in the order of the list."""
        return tuple(line.id for line in self._lines if line.id in self._ticked)

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.earlier, self.all, self.none, self.list]

    def focus(self) -> None:
        if self._lines:
            self.list.setFocus()

    def forget(self) -> None:
        """Show no session, and do not say that there is none: they are still to be read."""
        self.show_lines((), ())
        self.nothing.hide()

    def show_lines(self, lines: Sequence[AgainLine], ticked: Sequence[UUID]) -> None:
        """Show these sessions with these ticked."""
        self._lines, self._ticked = tuple(lines), set(ticked)
        self._show()

    def _build(self) -> None:
        self._buttons = lay_out(QHBoxLayout(), self.earlier, self.all, self.none, 1)
        self._card = Card(padding=0)
        lay_out(self._card.column, (self.list, 1), (self.nothing, 1, Qt.AlignmentFlag.AlignCenter))
        self._column = lay_out(QVBoxLayout(self), self._title, self._lead, self._buttons, (self._card, 1))

    def _show(self) -> None:
        row = self.list.currentIndex().row()
        columns = (
            TableColumn(TextCell(tr("Patient"), size=12, tone="ink2")),
            TableColumn(TextCell(tr("Session"), size=12, tone="ink2")),
            TableColumn(TextCell(tr("Conditions"), size=12, tone="ink2", wraps=True), share=1),
            TableColumn(TextCell(tr("Analysis"), size=12, tone="ink2", wraps=True), share=1),
        )
        self.list.show_rows(columns, [self._row(line) for line in self._lines])
        self.list.choose(min(max(row, 0), len(self._lines) - 1))
        self.list.setVisible(bool(self._lines))
        self.nothing.setVisible(not self._lines)
        waiting = sum(not line.is_current for line in self._lines)
        self.earlier.setText(
            tr_n("{count} not with this version", "{count} not with this version", waiting).format(count=waiting)
        )
        self.earlier.setEnabled(bool(waiting))
        self.all.setEnabled(bool(self._lines))
        self.none.setEnabled(bool(self._ticked))
        self.changed.emit()

    def _row(self, line: AgainLine) -> TableRow:
        tone = "ink" if line.failure or not line.is_current else "ink2"
        mark = Icon.WARNING if line.failure else None
        cells: tuple[TableCell, ...] = (
            TickCell(line, line.id in self._ticked),
            TextCell(line.when),
            TextCell(line.conditions, wraps=True),
            TextCell(line.state, tone=tone, mark=mark, wraps=True),
        )
        return TableRow(cells, key=line.id, hint=line.failure)

    def _turn(self, session_id: UUID) -> None:
        self._ticked ^= {session_id}
        self._show()

    def _on_clicked(self, index: QModelIndex) -> None:
        self._turn(self._lines[index.row()].id)

    def _on_earlier(self) -> None:
        self._ticked = {line.id for line in self._lines if not line.is_current}
        self._show()

    def _on_all(self) -> None:
        self._ticked = {line.id for line in self._lines}
        self._show()

    def _on_none(self) -> None:
        self._ticked = set()
        self._show()
