"""Patients and sessions as lines of a list: quick with thousands, for only what is in sight is painted."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from heapq import nlargest
from uuid import UUID

from PySide6.QtCore import QModelIndex, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter, QResizeEvent
from PySide6.QtWidgets import QStyle, QStyleOptionViewItem

from app.summary.progress_words import Arrow
from app.theme.current import current_theme, px
from app.theme.icons import Icon, paint_icon
from app.theme.theme import CARD_RADIUS, Theme
from app.widgets.change_arrow import ARROW, paint_change_arrow
from app.widgets.table import CellTable, Index, TableColumn, TableRow
from app.widgets.table_cells import EMPTY, TableCell
from app.widgets.text import MEDIUM, REGULAR, SEMIBOLD

ROW, PATIENT_ROW = 72, 76
TEXT_ROW = 20  # px from one row of words to the next
ROWS_HELD = 3  # rows of words that a line of either kind holds
PAD = 16  # from the list's edge to the words
BAR = 4  # of ink, before the line that is chosen
ICON = 20
NEXT_ROOM = ICON + 16  # at the right of a session
GAP = 12
MEASURED = 20  # of the longest lines, which say how high all of thousands are
WIDE_VISIT_FROM = 560 - 2 * PAD
PILL, PILL_PAD = 26, 11
SPEED, KNEE = 140, 108  # least columns of a visit


@dataclass(frozen=True, slots=True)
class PatientLine:
    """`searched` is what a search looks into, folded; `needs_look`: one of the sessions was recovered.

    `change` is the last one with its arrow, where it is known: it is then shown in place of `sessions`.
    """

    id: UUID
    code: str
    person: str
    when: str
    sessions: str
    searched: str
    needs_look: bool = False
    change: str = ""
    arrow: Arrow | None = None

    @property
    def words(self) -> tuple[str, ...]:
        return self.code, self.person, self.when, self.last

    @property
    def last(self) -> str:
        return self.sessions if self.needs_look else self.change or self.sessions


@dataclass(frozen=True, slots=True)
class SessionLine:
    """`state` is empty where there is nothing to say; `needs_look` puts a triangle before it.

    `ago` is the day again in a word. `is_reported`: its report was written, or is pending; None: neither. `speed` and
    `knee` are values under the condition that is shown.
    """

    id: UUID
    when: str
    conditions: str
    amount: str
    state: str = ""
    needs_look: bool = False
    ago: str = ""
    is_reported: bool | None = None
    speed: str = ""
    knee: str = ""

    @property
    def words(self) -> tuple[str, ...]:
        return self.when, self.ago, self.conditions, self.speed, self.knee, self.amount, self.state


Line = PatientLine | SessionLine
DIGITS = tuple("0123456789LR\N{MINUS SIGN}")  # a value begins so, with its side's letter where there are two


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
    arrow: Arrow | None = None
    is_middle: bool = False
    is_pill: bool = False
    is_pale: bool = False

    def font(self, theme: Theme) -> QFont:
        return theme.font(self.size, self.weight, self.is_code)

    def before(self, theme: Theme) -> int:
        """The room before the words."""
        icon = theme.px(ICON + 4) if self.icon is not None else theme.px(ARROW + 6) if self.arrow is not None else 0
        return icon + (theme.px(PILL_PAD) if self.is_pill else 0)

    def width(self, theme: Theme) -> int:
        width = QFontMetrics(self.font(theme)).horizontalAdvance(self.text) + self.before(theme)
        return width + (theme.px(PILL_PAD) if self.is_pill else 0)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        """Draw it from the left edge of `room`."""
        colour = QColor(getattr(theme.colours, self.tone))
        if self.is_pill:
            high = theme.px(PILL)
            box = QRectF(room.left(), room.center().y() - high / 2, self.width(theme), high)
            edge = None if self.is_pale else theme.colours.ink
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            theme.paint_box(painter, box, theme.colours.ground if self.is_pale else None, edge, 1.25, PILL / 2)
        left = room.left() + (theme.px(PILL_PAD) if self.is_pill else 0)
        if self.icon is not None:
            side = theme.px(ICON if not self.is_pill else 16)
            paint_icon(painter, self.icon, QRectF(left, room.center().y() - side / 2, side, side), colour)
        if self.arrow is not None:
            paint_change_arrow(painter, QRectF(left, room.top(), theme.px(ARROW), room.height()), self.arrow, theme)
        room = room.adjusted(self.before(theme), 0, 0, 0)
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
                if word.is_middle:
                    box.moveTop(room.top() + (room.height() - step) / 2)
                word.paint(painter, box, theme)


@dataclass(frozen=True, slots=True)
class PatientCell(LineCell):
    """Code and day, then the person, then what has changed."""

    line: PatientLine

    def word_rows(self, width: int, theme: Theme) -> list[list[Word]]:
        line = self.line
        code = Word(line.code, 15, SEMIBOLD, is_code=True)
        when = Word(line.when, 12, tone="ink2", is_right=True)
        last = Word(line.last, 13, arrow=line.arrow if line.change else None)
        if line.needs_look:
            last = Word(line.last, 13, SEMIBOLD, icon=Icon.WARNING)
        first = [[code, when]] if _are_beside(code, when, width, theme) else [[code], [replace(when, is_right=False)]]
        rows = [*first, *_wrapped(Word(line.person, 12, tone="ink2"), width, theme), *_wrapped(last, width, theme)]
        return _placed(rows, width, theme)


class VisitColumns:
    """Where values and states of `lines` stand, which share their columns; measured once for each look."""

    def __init__(self, lines: Sequence[SessionLine], heads: tuple[str, str] = ("", "")) -> None:
        self.heads = tuple(Word(head, 12, tone="ink2") for head in heads)
        self._pieces = [visit_words(line) for line in lines]
        self._theme: Theme | None = None
        self._widths = (0, 0, 0)

    def widths(self, theme: Theme) -> tuple[int, int, int]:
        """Of speed, knee and state, with the gap behind each; 0 where no line has any."""
        if theme is not self._theme:
            px = theme.px
            found = []
            for at, least in ((2, SPEED), (3, KNEE), (4, 0)):
                words = [pieces[at] for pieces in self._pieces if pieces[at].text]
                heads = [self.heads[at - 2]] if words and at < 4 else []
                widest = max((word.width(theme) for word in (*words, *heads)), default=0)
                found.append(max(px(least), widest + px(2 * GAP)) if words else 0)
            self._theme, self._widths = theme, (found[0], found[1], found[2])
        return self._widths

    def rights(self, room: int, theme: Theme) -> tuple[int, int, int]:
        """Where date and conditions end, and where speed and knee do, in a room of this width."""
        speed, knee, state = self.widths(theme)
        gap = theme.px(2 * GAP)
        return room - state - knee - speed, room - state - knee - gap, room - state - gap


@dataclass(frozen=True, slots=True)
class VisitCell(LineCell):
    """Date over conditions, values, and what was done with it before an arrow; in columns where there is room."""

    line: SessionLine
    columns: VisitColumns

    def word_rows(self, width: int, theme: Theme) -> list[list[Word]]:
        room = width - theme.px(NEXT_ROOM)
        day, then, speed, knee, state = visit_words(self.line)
        end, speed_end, knee_end = self.columns.rights(room, theme)
        is_wide = width >= WIDE_VISIT_FROM * theme.scale and day.width(theme) <= end
        if not is_wide:
            values = Word("   ".join(filter(None, [self.line.speed, self.line.knee])), 15, SEMIBOLD)
            at_right = replace(state, is_right=True)
            beside = _are_beside(day, at_right, room, theme)
            rows = [[day, at_right]] if beside else [[day], [state]]
            return _placed([*rows, *_wrapped(then, room, theme), [values]], room, theme)
        middle = [
            replace(word, left=left, is_middle=True)
            for word, left in (
                (speed, speed_end - speed.width(theme)),
                (knee, knee_end - knee.width(theme)),
                (state, room - self.columns.widths(theme)[2]),
            )
        ]
        return _placed([[day, *middle], *_wrapped(then, end, theme)], room, theme)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        LineCell.paint(self, painter, room, theme)
        side = theme.px(ICON)
        arrow = QRectF(room.right() - side, room.center().y() - side / 2, side, side)
        paint_icon(painter, Icon.NEXT, arrow, theme.colours.ink2)


@dataclass(frozen=True, slots=True)
class VisitHead(TableCell):
    """What the table is of, and over its columns what they are of."""

    title: str
    columns: VisitColumns

    @property
    def words(self) -> str:
        return ", ".join(filter(None, [self.title, *(head.text for head in self.columns.heads)]))

    def width(self, _theme: Theme) -> int:
        return 0

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        title = Word(self.title, 16, SEMIBOLD)
        title.paint(painter, room, theme)
        if room.width() < WIDE_VISIT_FROM * theme.scale:
            return
        _, *rights = self.columns.rights(int(room.width()) - theme.px(NEXT_ROOM), theme)
        widths = self.columns.widths(theme)[:2]
        for head, right, width in zip(self.columns.heads, rights, widths, strict=True):
            left = right - head.width(theme)
            if width and left > title.width(theme) + theme.px(GAP):
                head.paint(painter, room.adjusted(left, 0, 0, 0), theme)


def visit_words(line: SessionLine) -> tuple[Word, Word, Word, Word, Word]:
    """Date, what is under it, walking speed, knee, and what was done with it."""
    amount = "" if line.speed or line.knee else line.amount
    then = " \N{MIDDLE DOT} ".join(filter(None, [line.ago, line.conditions, amount]))
    state = Word(line.state, 12, MEDIUM, "ink2")
    if line.needs_look:
        state = Word(line.state, 12, SEMIBOLD, icon=Icon.WARNING)
    elif line.is_reported is not None:
        icon = Icon.CHECK if line.is_reported else None
        state = Word(line.state, 12, MEDIUM, "ink2" if line.is_reported else "ink", icon=icon)
        state = replace(state, is_pill=True, is_pale=line.is_reported)
    values = [
        Word(value, 15, SEMIBOLD) if value[:1] in DIGITS else Word(value, 12, tone="ink2")
        for value in (line.speed, line.knee)
    ]
    return Word(line.when, 15, SEMIBOLD), Word(then, 12, tone="ink2"), values[0], values[1], state


class LineList(CellTable):
    """A list of lines, one of which may be chosen. Enter and a click on a visit open it.

    `chosen` and `opened` carry the id of a line; `fitted`: lines may have other heights; `scrolled`: others are in
    sight. `chosen_on`: the token of the chosen line's ground.
    """

    fitted = Signal()
    scrolled = Signal()

    def __init__(
        self,
        name: str,
        is_opened_by_click: bool = False,
        row: int = ROW,
        head: int = 0,
        chosen_on: str = "sunken",
    ) -> None:
        super().__init__(name, row=row, head=head, padding=PAD, edge=PAD, is_list=True)
        self.lines: tuple[Line, ...] = ()
        self._longest: list[LineCell] = []
        self._chosen_on = chosen_on
        self._are_even = not is_opened_by_click  # patients may be thousands, visits are of one patient
        self.verticalScrollBar().valueChanged.connect(self.scrolled)
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
        bar = self.verticalScrollBar().sizeHint().width() if self._are_even else 0
        return self.width() - bar - 2 * px(PAD)

    @property
    def in_sight(self) -> tuple[Line, ...]:
        """Lines of which at least a part is seen."""
        first, last = self.rowAt(0), self.rowAt(self.viewport().height() - 1)
        return self.lines[max(first, 0) : last + 1 if last >= 0 else len(self.lines)] if first >= 0 else ()

    def show_lines(
        self,
        lines: Sequence[Line],
        chosen: UUID | None = None,
        *,
        stays: bool = False,
        head: tuple[str, str] = ("", ""),
    ) -> None:
        """Show other lines with this id chosen; `stays`: keep the scroll position, `head`: column heads."""
        scrolled = self.verticalScrollBar().value()
        self.lines = tuple(lines)
        columns = VisitColumns([line for line in lines if isinstance(line, SessionLine)], head)
        cells: list[LineCell] = [
            PatientCell(line) if isinstance(line, PatientLine) else VisitCell(line, columns) for line in lines
        ]
        self._longest = nlargest(MEASURED, cells, key=lambda cell: len(cell.words))
        self.selectionModel().reset()  # the line that is chosen now is signalled, even if it is the same
        title = VisitHead(self.accessibleName(), columns) if self._head else EMPTY
        self.show_rows(
            [TableColumn(title, share=1, widest=EMPTY)],
            [TableRow((cell,), key=cell.line.id) for cell in cells],
        )
        self.choose_line(chosen)
        if stays:
            self.verticalScrollBar().setValue(scrolled)

    def replace_line(self, line: PatientLine) -> None:
        """Show a patient's line in place of the one with its id, where that is shown."""
        row = next((number for number, one in enumerate(self.lines) if one.id == line.id), None)
        if row is None or self.lines[row] == line:
            return
        self.lines = (*self.lines[:row], line, *self.lines[row + 1 :])
        rows = self.cells.rows
        self.cells.rows = (*rows[:row], TableRow((PatientCell(line),), key=line.id), *rows[row + 1 :])
        self.cells.dataChanged.emit(self.cells.index(row, 0), self.cells.index(row, 0))

    def choose_line(self, line_id: UUID | None) -> None:
        self.choose(next((row for row, line in enumerate(self.lines) if line.id == line_id), -1))

    def fit_rows(self) -> None:
        """Make every line as high as its words in this width, or all of thousands as high as the longest one."""
        if self._are_even:
            heights = [self._height(cell) for cell in self._longest]
            self.verticalHeader().setDefaultSectionSize(max([px(self._row), *heights]))
        else:
            for number, row in enumerate(self.cells.rows):
                self.setRowHeight(number, self._height(row.cells[0]))
        self.fitted.emit()

    def paint_ground(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """A line under each row; the row that is chosen or under the mouse has a round ground."""
        theme = current_theme()
        c, px, rect = theme.colours, theme.px, option.rect
        is_chosen = bool(option.state & QStyle.StateFlag.State_Selected)
        box = QRectF(rect).adjusted(0.5, 0.5, -0.5, -0.5)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if is_chosen or option.state & QStyle.StateFlag.State_MouseOver:
            ground = getattr(c, self._chosen_on) if is_chosen else theme.veil(is_pressed=False)
            edge = c.line if is_chosen and self._chosen_on == "surface" else None
            theme.paint_box(painter, box, ground, edge, 1, CARD_RADIUS)
        if is_chosen:
            bar = QRectF(rect.x(), box.y() + px(12), px(BAR), box.height() - px(24))
            painter.setBrush(QColor(c.ink))
            painter.drawRoundedRect(bar, px(BAR) / 2, px(BAR) / 2)
        elif index.row() + 1 < len(self.lines):
            painter.setPen(theme.pen(c.line, 1))
            painter.drawLine(rect.x() + px(PAD), rect.bottom(), rect.right() - px(PAD), rect.bottom())

    def room_of(self, rect: QRectF, column: int, *, is_heading: bool = False) -> QRectF:
        room = super().room_of(rect, column, is_heading=is_heading)
        room.setWidth(self.word_room)
        return room

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.fit_rows()

    def _height(self, cell: TableCell) -> int:
        assert isinstance(cell, LineCell)
        px, rows = current_theme().px, len(cell.word_rows(self.word_room, current_theme()))
        held = ROWS_HELD if self._are_even else 2
        return px(self._row) + max(0, rows - held) * px(TEXT_ROW)

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
