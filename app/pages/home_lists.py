"""Patients and sessions as lines of a list: quick with thousands, for only what is in sight is painted."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from heapq import nlargest
from typing import Any
from uuid import UUID

from PySide6.QtCore import QAbstractListModel, QModelIndex, QPersistentModelIndex, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFocusEvent, QFont, QFontMetrics, QKeyEvent, QPainter
from PySide6.QtWidgets import QAbstractItemView, QListView, QStyle, QStyledItemDelegate, QStyleOptionViewItem

from app.icons import Icon, paint_icon
from app.theme import Look
from app.tokens import CONTROL_RADIUS
from app.widgets.text import REGULAR, SEMIBOLD

ROW = 72
PAD = 24  # from the list's edge to the words
BAR = 4  # of ink, before the line that is chosen
ICON = 20
GAP = 12
MEASURED = 20  # of the longest lines, which say how high all of thousands are
WIDE_SESSION_FROM = 500
DATE, AMOUNT, STATE = 112, 110, 178  # columns of a session

ModelIndex = QModelIndex | QPersistentModelIndex
ROOT = QModelIndex()


@dataclass(frozen=True, slots=True)
class PatientLine:
    """`searched` is what a search looks into, folded; `needs_look`: one of the sessions was recovered."""

    id: UUID
    code: str
    person: str
    when: str
    sessions: str
    searched: str
    needs_look: bool = False


@dataclass(frozen=True, slots=True)
class SessionLine:
    """`state` is empty where there is nothing to say; `needs_look` puts a triangle before it."""

    id: UUID
    when: str
    conditions: str
    amount: str
    state: str = ""
    needs_look: bool = False


Line = PatientLine | SessionLine


class Role(IntEnum):
    LINE = Qt.ItemDataRole.UserRole


class Lines(QAbstractListModel):
    """The lines of one list, replaced as a whole."""

    def __init__(self) -> None:
        super().__init__()
        self._lines: Sequence[Line] = ()
        self.longest: Sequence[Line] = ()
        self.has_states = False

    @property
    def lines(self) -> Sequence[Line]:
        return self._lines

    def show(self, lines: Sequence[Line]) -> None:
        self.beginResetModel()
        self._lines = tuple(lines)
        self.longest = nlargest(MEASURED, self._lines, key=lambda line: sum(map(len, _words(line))))
        self.has_states = any(isinstance(line, SessionLine) and line.state for line in lines)
        self.endResetModel()

    def rowCount(self, parent: ModelIndex = ROOT) -> int:
        return 0 if parent.isValid() else len(self._lines)

    def data(self, index: ModelIndex, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        line = self._lines[index.row()]
        if role == Role.LINE:
            return line
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.AccessibleTextRole):
            return ", ".join(filter(None, _words(line)))
        return None


class LineList(QListView):
    """A list of lines, one of which may be chosen. Enter and a click on a session open it."""

    chosen = Signal(object)  # the line's id, or None
    opened = Signal(object)

    def __init__(self, look: Look, name: str, is_opened_by_click: bool = False) -> None:
        super().__init__()
        self._look = look
        self.lines = Lines()
        self.setModel(self.lines)
        self.setItemDelegate(_LineDelegate(look, self))
        self.setAccessibleName(name)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setMouseTracking(True)
        self.setFrameShape(QListView.Shape.NoFrame)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.viewport().setAutoFillBackground(False)
        self.setUniformItemSizes(not is_opened_by_click)  # patients may be thousands, sessions are of one patient
        if is_opened_by_click:
            self.clicked.connect(self._on_opened)
        self.selectionModel().currentChanged.connect(self._on_current_changed)

    @property
    def line(self) -> Line | None:
        """The line that is chosen."""
        index = self.currentIndex()
        return index.data(Role.LINE) if index.isValid() else None

    @property
    def room(self) -> int:
        """The width that lines have, whether or not there is a scroll bar."""
        return self.width() - self.verticalScrollBar().sizeHint().width()

    def show_lines(self, lines: Sequence[Line], chosen: UUID | None = None) -> None:
        """Show other lines, with the one that has this id chosen, where it is among them."""
        self.selectionModel().blockSignals(True)
        self.lines.show(lines)
        self.selectionModel().blockSignals(False)
        self.choose(chosen)

    def choose(self, line_id: UUID | None) -> None:
        row = next((k for k, line in enumerate(self.lines.lines) if line.id == line_id), -1)
        self.setCurrentIndex(self.lines.index(row))
        if row >= 0:
            self.scrollTo(self.lines.index(row))

    def step(self, rows: int) -> None:
        """Choose the line above or below, as the arrow keys do."""
        last = self.lines.rowCount() - 1
        if last >= 0:
            row = self.currentIndex().row()
            self.setCurrentIndex(self.lines.index(min(max(row + rows, 0), last)))

    def focusInEvent(self, event: QFocusEvent) -> None:
        super().focusInEvent(event)
        if not self.currentIndex().isValid() and event.reason() != Qt.FocusReason.MouseFocusReason:
            self.step(1)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.currentIndex().isValid():
            self._on_opened(self.currentIndex())
            return
        super().keyPressEvent(event)

    def _on_opened(self, index: ModelIndex) -> None:
        self.opened.emit(index.data(Role.LINE).id)

    def _on_current_changed(self, index: ModelIndex, _before: ModelIndex) -> None:
        self.chosen.emit(index.data(Role.LINE).id if index.isValid() else None)


class _LineDelegate(QStyledItemDelegate):
    def __init__(self, look: Look, view: LineList) -> None:
        super().__init__(view)
        self._look, self._view = look, view

    def sizeHint(self, _option: QStyleOptionViewItem, index: ModelIndex) -> QSize:
        px = self._look.theme.px
        width = self._view.room
        lines = self._view.lines.longest if self._view.uniformItemSizes() else (index.data(Role.LINE),)
        rows = max(2, *(len(self._rows(line, width)) for line in lines))
        return QSize(0, px(ROW) + (rows - 2) * px(22))

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: ModelIndex) -> None:
        theme = self._look.theme
        c, px = theme.colours, theme.px
        line: Line = index.data(Role.LINE)
        rect: QRect = option.rect
        state: QStyle.StateFlag = option.state
        is_chosen = bool(state & QStyle.StateFlag.State_Selected)
        is_under_mouse = bool(state & QStyle.StateFlag.State_MouseOver)
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        box = QRectF(rect.adjusted(px(6), px(6), -px(6), -px(6)))
        if is_chosen or is_under_mouse:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(c.sunken) if is_chosen else theme.veil(is_pressed=False))
            painter.drawRoundedRect(box, CONTROL_RADIUS * theme.scale, CONTROL_RADIUS * theme.scale)
        if is_chosen:
            painter.setBrush(QColor(c.ink))
            bar = QRectF(rect.x() + px(5), box.y() + px(10), px(BAR), box.height() - px(20))
            painter.drawRoundedRect(bar, px(BAR) / 2, px(BAR) / 2)
        if index.row() + 1 < self._view.lines.rowCount() and not is_chosen:
            painter.setPen(theme.pen(c.line, 1))
            painter.drawLine(rect.x() + px(20), rect.bottom(), rect.right() - px(20), rect.bottom())
        self._paint_words(painter, rect, line)
        painter.restore()

    def _paint_words(self, painter: QPainter, rect: QRect, line: Line) -> None:
        px = self._look.theme.px
        rows = self._rows(line, self._view.room)
        step = px(23)
        top = rect.y() + (rect.height() - step * len(rows)) // 2
        right = rect.x() + self._view.room - px(PAD)
        if isinstance(line, SessionLine):
            side = px(ICON)
            arrow = QRectF(right - side + px(4), rect.center().y() - side / 2, side, side)
            paint_icon(painter, Icon.NEXT, arrow, self._look.theme.colours.ink2)
            right -= side + px(8)
        for number, row in enumerate(rows):
            for word in row:
                x = rect.x() + px(PAD) + word.left
                if word.is_right:
                    x = right - self._width(word)
                self._paint_word(painter, word, x, top + number * step, step)

    def _paint_word(self, painter: QPainter, word: "_Word", x: int, y: int, height: int) -> None:
        theme = self._look.theme
        colour = QColor(getattr(theme.colours, word.tone))
        if word.icon is not None:
            side = theme.px(ICON)
            paint_icon(painter, word.icon, QRectF(x, y + (height - side) / 2, side, side), colour)
            x += side + theme.px(8)
        painter.setFont(self._font(word))
        painter.setPen(colour)
        flags = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter | Qt.TextFlag.TextSingleLine
        painter.drawText(QRect(x, y, self._width(word), height), flags, word.text)

    def _rows(self, line: Line, width: int) -> list[list["_Word"]]:
        """Arrange a line's words in rows, as many as the width asks for."""
        room = width / self._look.theme.scale
        if isinstance(line, PatientLine):
            return self._patient_rows(line, width)
        date = _Word(line.when, 15, SEMIBOLD)
        conditions = _Word(line.conditions)
        amount = _Word(line.amount, tone="ink2")
        state = _Word(line.state, weight=SEMIBOLD if line.needs_look else REGULAR)
        state.icon = Icon.WARNING if line.needs_look else None
        px = self._look.theme.px
        left = width - px(2 * PAD + ICON + 8)  # what the words have, beside the arrow
        if room >= WIDE_SESSION_FROM:
            state.left = left - px(STATE)
            amount.left = state.left - px(AMOUNT) if self._view.lines.has_states else left - px(AMOUNT)
            conditions.left = px(DATE)
            needed = conditions.left + self._width(conditions) + px(GAP)
            first = [date, amount, *([state] if line.state else [])]
            if needed <= amount.left:
                return [[*first, conditions]]
            conditions.left = 0
            return [first, *([row] for row in self._wrapped(conditions, left))]
        state.is_right = True
        rows = [[date], [word for word in (conditions, amount) if word.text]]
        if line.state:
            fits = self._beside(date, state, width)
            rows = [[date, state], *rows[1:]] if fits else [[date], [_lefted(state)], *rows[1:]]
        if conditions.text:
            amount.is_right = True
            if not self._beside(conditions, amount, width):
                rows = [*rows[:-1], *([row] for row in self._wrapped(conditions, left)), [_lefted(amount)]]
        return [row for row in rows if row]

    def _patient_rows(self, line: PatientLine, width: int) -> list[list["_Word"]]:
        code = _Word(line.code, 16, SEMIBOLD, is_code=True)
        when = _Word(line.when, tone="ink2", is_right=True)
        person = _Word(line.person, tone="ink2")
        sessions = _Word(line.sessions, tone="ink2", is_right=True)
        if line.needs_look:
            sessions = _Word(line.sessions, weight=SEMIBOLD, is_right=True, icon=Icon.WARNING)
        rows: list[list[_Word]] = []
        for first, second in ((code, when), (person, sessions)):
            if self._beside(first, second, width):
                rows.append([first, second])
            else:
                room = width - 2 * self._look.theme.px(PAD)
                rows += [*([row] for row in self._wrapped(first, room)), [_lefted(second)]]
        return [[word for word in row if word.text] for row in rows]

    def _beside(self, first: "_Word", second: "_Word", width: int) -> bool:
        """Tell whether both find room in one row."""
        px = self._look.theme.px
        arrow = px(ICON + 8)
        return self._width(first) + px(GAP) + self._width(second) + 2 * px(PAD) + arrow <= width

    def _wrapped(self, word: "_Word", room: int) -> list["_Word"]:
        """Break a long text between its words."""
        rows: list[str] = []
        for part in word.text.split(" "):
            longer = f"{rows[-1]} {part}" if rows else part
            if rows and self._width(replace(word, text=longer)) <= room:
                rows[-1] = longer
            else:
                rows.append(part)
        return [replace(word, text=row) for row in rows]

    def _width(self, word: "_Word") -> int:
        width = QFontMetrics(self._font(word)).horizontalAdvance(word.text)
        return width + (self._look.theme.px(ICON + 8) if word.icon is not None else 0)

    def _font(self, word: "_Word") -> QFont:
        return self._look.theme.font(word.size, word.weight, word.is_code)


@dataclass(slots=True)
class _Word:
    """A piece of a row; `left` in px of the screen from where words begin."""

    text: str
    size: float = 14
    weight: QFont.Weight = REGULAR
    tone: str = "ink"
    is_code: bool = False
    is_right: bool = False
    icon: Icon | None = None
    left: int = 0


def _lefted(word: _Word) -> _Word:
    word.is_right = False
    return word


def _words(line: Line) -> tuple[str, ...]:
    if isinstance(line, PatientLine):
        return (line.code, line.person, line.when, line.sessions)
    return (line.when, line.conditions, line.amount, line.state)
