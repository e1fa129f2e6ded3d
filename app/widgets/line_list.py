"""Patients and sessions as lines of a list: quick with thousands, for only what is in sight is painted."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from heapq import nlargest
from uuid import UUID

from PySide6.QtCore import QModelIndex, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter, QResizeEvent
from PySide6.QtWidgets import QStyle, QStyleOptionViewItem

from app.theme.icons import Icon, paint_icon
from app.theme.notifier import ThemeNotifier
from app.theme.theme import Theme
from app.widgets.table import CellTable, Index, TableColumn, TableRow
from app.widgets.table_cells import EMPTY, TableCell
from app.widgets.text import REGULAR, SEMIBOLD

ROW = 72
TEXT_ROW = 23  # px from one row of words to the next
MORE_HEIGHT = 22  # of a line for each row of words over two
PAD = 24  # from the list's edge to the words
BAR = 4  # of ink, before the line that is chosen
ICON = 20
ARROW = ICON + 8  # at the right of a session
GAP = 12
MEASURED = 20  # of the longest lines, which say how high all of thousands are
WIDE_SESSION_FROM = 500 - 2 * PAD
DATE, AMOUNT, STATE = 112, 110, 178  # columns of a session


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

    @property
    def words(self) -> tuple[str, ...]:
        return self.code, self.person, self.when, self.sessions


@dataclass(frozen=True, slots=True)
class SessionLine:
    """`state` is empty where there is nothing to say; `needs_look` puts a triangle before it, else: `mark`."""

    id: UUID
    when: str
    conditions: str
    amount: str
    state: str = ""
    needs_look: bool = False
    mark: Icon | None = None

    @property
    def words(self) -> tuple[str, ...]:
        return self.when, self.conditions, self.amount, self.state


Line = PatientLine | SessionLine


@dataclass(frozen=True, slots=True)
class Word:
    """A piece of a row; `left` in px of the screen from where words begin, or it ends where they end."""

    text: str
    size: float = 14
    weight: QFont.Weight = REGULAR
    tone: str = "ink"
    is_code: bool = False
    is_right: bool = False
    icon: Icon | None = None
    left: int = 0

    def font(self, theme: Theme) -> QFont:
        return theme.font(self.size, self.weight, self.is_code)

    def width(self, theme: Theme) -> int:
        width = QFontMetrics(self.font(theme)).horizontalAdvance(self.text)
        return width + (theme.px(ICON + 8) if self.icon is not None else 0)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        """Draw it from the left edge of `room`."""
        colour = QColor(getattr(theme.colours, self.tone))
        if self.icon is not None:
            side = theme.px(ICON)
            paint_icon(painter, self.icon, QRectF(room.left(), room.center().y() - side / 2, side, side), colour)
            room = room.adjusted(theme.px(ICON + 8), 0, 0, 0)
        painter.setFont(self.font(theme))
        painter.setPen(colour)
        flags = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter | Qt.TextFlag.TextSingleLine
        painter.drawText(room, flags, self.text)


@dataclass(frozen=True, slots=True)
class LineCell(TableCell):
    """All of one line: its words in rows, as many as the width asks for."""

    line: Line

    @property
    def words(self) -> str:
        return ", ".join(filter(None, self.line.words))

    def width(self, _theme: Theme) -> int:
        return 0  # words are arranged in what there is

    @abstractmethod
    def word_rows(self, width: int, theme: Theme) -> list[list[Word]]:
        """Arrange the words in a room of this width, in px of the screen."""

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        rows, step = self.word_rows(int(room.width()), theme), theme.px(TEXT_ROW)
        top = int(room.top()) + (int(room.height()) - step * len(rows)) // 2
        for number, row in enumerate(rows):
            for word in row:
                box = QRectF(room.left() + word.left, top + number * step, word.width(theme), step)
                word.paint(painter, box, theme)


@dataclass(frozen=True, slots=True)
class PatientCell(LineCell):
    """Code and person at the left, at the right when and how often they came."""

    line: PatientLine

    def word_rows(self, width: int, theme: Theme) -> list[list[Word]]:
        line = self.line
        code = Word(line.code, 16, SEMIBOLD, is_code=True)
        when = Word(line.when, tone="ink2", is_right=True)
        person = Word(line.person, tone="ink2")
        sessions = Word(line.sessions, tone="ink2", is_right=True)
        if line.needs_look:
            sessions = Word(line.sessions, weight=SEMIBOLD, is_right=True, icon=Icon.WARNING)
        rows: list[list[Word]] = []
        for first, second in ((code, when), (person, sessions)):
            if _are_beside(first, second, width, theme):
                rows.append([first, second])
            else:
                rows += [*_wrapped(first, width, theme), [replace(second, is_right=False)]]
        return _placed(rows, width, theme)


class SessionColumns:
    """How wide date, amount and state of `lines` are, which share their columns; measured once for each look."""

    def __init__(self, lines: Sequence[SessionLine]) -> None:
        self._pieces = [_pieces(line) for line in lines]
        self._theme: Theme | None = None
        self._widths = (0, 0, 0)

    def widths(self, theme: Theme) -> tuple[int, int, int]:
        """With the gap behind each; 0 for states where no line has one."""
        if theme is not self._theme:
            px = theme.px
            dates, _conditions, amounts, states = zip(*self._pieces, strict=True)
            date, amount, state = (
                max(px(least), *(word.width(theme) + px(GAP) for word in words))
                for least, words in ((DATE, dates), (AMOUNT, amounts), (STATE, states))
            )
            has_states = any(word.text for word in states)
            self._theme, self._widths = theme, (date, amount, state if has_states else 0)
        return self._widths


@dataclass(frozen=True, slots=True)
class SessionCell(LineCell):
    """Date, conditions, amount and state before an arrow, in columns where there is room for them."""

    line: SessionLine
    columns: SessionColumns

    def word_rows(self, width: int, theme: Theme) -> list[list[Word]]:
        room, is_wide = width - theme.px(ARROW), width >= WIDE_SESSION_FROM * theme.scale
        return _placed(self._in_columns(room, theme) if is_wide else self._stacked(room, theme), room, theme)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        LineCell.paint(self, painter, room, theme)
        side = theme.px(ICON)
        arrow = QRectF(room.right() - side + theme.px(4), room.center().y() - side / 2, side, side)
        paint_icon(painter, Icon.NEXT, arrow, theme.colours.ink2)

    def _in_columns(self, room: int, theme: Theme) -> list[list[Word]]:
        px, (date, conditions, amount, state) = theme.px, _pieces(self.line)
        dates, amounts, states = self.columns.widths(theme)
        state = replace(state, left=room - states)
        amount = replace(amount, left=state.left - amounts)
        if date.width(theme) + px(GAP) > amount.left:
            return self._stacked(room, theme)
        if dates + conditions.width(theme) + px(GAP) <= amount.left:
            return [[date, amount, state, replace(conditions, left=dates)]]
        return [[date, amount, state], *_wrapped(conditions, room, theme)]

    def _stacked(self, room: int, theme: Theme) -> list[list[Word]]:
        date, conditions, amount, state = _pieces(self.line)
        at_right = replace(state, is_right=True)
        rows = [[date, at_right]] if _are_beside(date, at_right, room, theme) else [[date], [state]]
        if _are_beside(conditions, amount, room, theme):
            return [*rows, [conditions, replace(amount, is_right=bool(conditions.text))]]
        return [*rows, *_wrapped(conditions, room, theme), [amount]]


def _pieces(line: SessionLine) -> tuple[Word, Word, Word, Word]:
    state = Word(
        line.state,
        weight=SEMIBOLD if line.needs_look or line.mark is Icon.INFO else REGULAR,
        icon=Icon.WARNING if line.needs_look else line.mark,
    )
    return Word(line.when, 15, SEMIBOLD), Word(line.conditions), Word(line.amount, tone="ink2"), state


class LineList(CellTable):
    """A list of lines, one of which may be chosen. Enter and a click on a session open it.

    `chosen` and `opened` carry the id of a line; `fitted`: lines may have other heights.
    """

    fitted = Signal()

    def __init__(self, look: ThemeNotifier, name: str, is_opened_by_click: bool = False, row: int = ROW) -> None:
        super().__init__(look, name, row=row, head=0, padding=PAD, edge=PAD, is_list=True)
        self.lines: tuple[Line, ...] = ()
        self._longest: list[LineCell] = []
        self._are_even = not is_opened_by_click  # patients may be thousands, sessions are of one patient
        if is_opened_by_click:
            self.clicked.connect(self._on_clicked)

    @property
    def line(self) -> Line | None:
        """The line that is chosen."""
        index = self.currentIndex()
        return self.lines[index.row()] if index.isValid() else None

    @property
    def word_room(self) -> int:
        """The width that words have, whether or not there is a scroll bar."""
        return self.width() - self.verticalScrollBar().sizeHint().width() - 2 * self._look.theme.px(PAD)

    def show_lines(self, lines: Sequence[Line], chosen: UUID | None = None, *, stays: bool = False) -> None:
        """Show other lines, with the one that has this id chosen, where it is among them.

        `stays`: the list was only read again, and is not scrolled.
        """
        scrolled = self.verticalScrollBar().value()
        self.lines = tuple(lines)
        columns = SessionColumns([line for line in lines if isinstance(line, SessionLine)])
        cells: list[LineCell] = [
            PatientCell(line) if isinstance(line, PatientLine) else SessionCell(line, columns) for line in lines
        ]
        self._longest = nlargest(MEASURED, cells, key=lambda cell: len(cell.words))
        self.selectionModel().reset()  # the line that is chosen now is signalled, even if it is the same
        self.show_rows(
            [TableColumn(share=1, widest=EMPTY)],
            [TableRow((cell,), key=cell.line.id) for cell in cells],
        )
        self.choose_line(chosen)
        if stays:
            self.verticalScrollBar().setValue(scrolled)

    def choose_line(self, line_id: UUID | None) -> None:
        self.choose(next((row for row, line in enumerate(self.lines) if line.id == line_id), -1))

    def fit_rows(self) -> None:
        """Make every line as high as its words in this width, or all of thousands as high as the longest one."""
        if self._are_even:
            heights = [self._height(cell) for cell in self._longest]
            self.verticalHeader().setDefaultSectionSize(max([self._look.theme.px(self._row), *heights]))
        else:
            for number, row in enumerate(self.cells.rows):
                self.setRowHeight(number, self._height(row.cells[0]))
        self.fitted.emit()

    def paint_ground(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """A line under each row; the row that is chosen or under the mouse has a round ground."""
        theme = self._look.theme
        c, px, rect = theme.colours, theme.px, option.rect
        is_chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        box = QRectF(rect.adjusted(px(6), px(6), -px(6), -px(6)))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if is_chosen or option.state & QStyle.StateFlag.State_MouseOver:
            theme.paint_box(painter, box, c.sunken if is_chosen else theme.veil(is_pressed=False))
        if is_chosen:
            bar = QRectF(rect.x() + px(5), box.y() + px(10), px(BAR), box.height() - px(20))
            painter.setBrush(QColor(c.ink))
            painter.drawRoundedRect(bar, px(BAR) / 2, px(BAR) / 2)
        elif index.row() + 1 < len(self.lines):
            painter.setPen(theme.pen(c.line, 1))
            painter.drawLine(rect.x() + px(20), rect.bottom(), rect.right() - px(20), rect.bottom())

    def room_of(self, rect: QRectF, column: int, *, is_heading: bool = False) -> QRectF:
        room = super().room_of(rect, column, is_heading=is_heading)
        room.setWidth(self.word_room)
        return room

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.fit_rows()

    def _height(self, cell: TableCell) -> int:
        assert isinstance(cell, LineCell)
        px, rows = self._look.theme.px, len(cell.word_rows(self.word_room, self._look.theme))
        rows_held = 2 if self._row == ROW else 1
        return px(self._row) + max(0, rows - rows_held) * px(MORE_HEIGHT)

    def _on_clicked(self, _index: QModelIndex) -> None:
        self.opened.emit(self.key)


def _are_beside(first: Word, second: Word, room: int, theme: Theme) -> bool:
    """Return whether both find room in one row."""
    return first.width(theme) + theme.px(GAP) + second.width(theme) <= room


def _wrapped(word: Word, room: int, theme: Theme) -> list[list[Word]]:
    """Break a long text between its words, into a row each."""
    rows: list[str] = []
    for part in word.text.split(" "):
        longer = f"{rows[-1]} {part}" if rows else part
        if rows and replace(word, text=longer).width(theme) <= room:
            rows[-1] = longer
        else:
            rows.append(part)
    return [[replace(word, text=row)] for row in rows]


def _placed(rows: list[list[Word]], room: int, theme: Theme) -> list[list[Word]]:
    """Put what belongs at the right there, and leave out words that are empty."""
    placed = [
        [replace(word, left=room - word.width(theme)) if word.is_right else word for word in row if word.text]
        for row in rows
    ]
    return [row for row in placed if row]
