"""Form for the DOTs that are worn and how they are to measure.

It has a list with a tick before each, and three choices beside it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QModelIndex, QRectF, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QKeyEvent, QPainter
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.theme.current import current_theme, scaled
from app.theme.icons import Icon, paint_icon
from app.theme.theme import Theme
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import TableCell, TextCell
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr, tr_n

ROW, HEAD, PADDING, MARK = 44, 32, 10, 20
STRONG_DBM, FAIR_DBM = -60, -75
LOW = 0.15  # of a battery
AT_LEAST_ROWS = 3
NOTE_SHARE = 0.6  # of a note's width: broken into two lines it needs no more


@dataclass(frozen=True, slots=True)
class DotLine:
    """One sensor that was found. `note`: what is the matter with it; `firmware` empty until it was asked."""

    name: str
    is_worn: bool = True
    rssi_dbm: int | None = None
    battery: float | None = None
    firmware: str = ""
    note: str = ""

    @property
    def signal(self) -> str:
        if self.rssi_dbm is None:
            return tr("unknown")
        words = tr("weak")
        if self.rssi_dbm >= FAIR_DBM:
            words = tr("strong") if self.rssi_dbm >= STRONG_DBM else tr("fair")
        return tr("{words}, {dbm} dBm").format(words=words, dbm=f"\N{MINUS SIGN}{-self.rssi_dbm}")

    @property
    def charge(self) -> str:
        return tr("unknown") if self.battery is None else tr("{percent} %").format(percent=round(100 * self.battery))


@dataclass(frozen=True, slots=True)
class DotChoice:
    """How they are to measure: what is live, and walks in memories (0 Hz: those are live too)."""

    rate_hz: int = 60
    record_hz: int = 120
    profile: int = 0


@dataclass(frozen=True, slots=True)
class _TickCell(TableCell):
    """A box, ticked or not, and a sensor's name."""

    name: str
    is_on: bool

    @property
    def words(self) -> str:
        return self.name

    @property
    def is_checked(self) -> bool | None:
        return self.is_on

    def width(self, theme: Theme) -> int:
        return theme.px(MARK + PADDING) + QFontMetrics(theme.font(15, SEMIBOLD, is_code=True)).horizontalAdvance(
            self.words
        )

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        c, px = theme.colours, theme.px
        box = QRectF(room.left(), room.center().y() - px(MARK) / 2, px(MARK), px(MARK))
        painter.setPen(theme.pen(c.control, 1.25))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRoundedRect(box.adjusted(1, 1, -1, -1), px(4), px(4))
        if self.is_on:
            paint_icon(painter, Icon.CHECK, box, c.ink)
        painter.setFont(theme.font(15, SEMIBOLD, is_code=True))
        painter.setPen(QColor(c.ink))
        words = room.adjusted(px(MARK + PADDING), 0, 0, 0)
        painter.drawText(words, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, self.words)


class DotList(CellTable):
    """Space or a click turns the tick of a line; Enter goes past it, to the primary button."""

    def is_opening(self, event: QKeyEvent) -> bool:
        return event.key() == Qt.Key.Key_Space

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            event.ignore()
        else:
            super().keyPressEvent(event)


class DotForm(QWidget):
    """The list of DOT sensors found, and how they are to measure."""

    turned = Signal(int)  # the number of a sensor whose tick was turned
    identify_pressed = Signal(int)  # the number of the sensor whose light is to blink
    changed = Signal()  # they are to measure otherwise

    def __init__(self) -> None:
        super().__init__()
        self._is_narrow = False
        self._room, self._is_window_narrow = math.inf, False
        self._lines: tuple[DotLine, ...] = ()
        self._title = Text(size=20, weight=SEMIBOLD, wraps=True)
        self._lead = Text(size=14, tone="ink2", wraps=True)
        self.list = DotList(tr("Sensors found"), row=ROW, head=HEAD, padding=PADDING, is_list=True)
        self.list.setAccessibleDescription(tr("Press Space to tick or untick a sensor, I to make its LED blink."))
        self.identify = Button(tr("Identify"), ButtonKind.SECONDARY, Icon.LIGHT, key="I", height=44)
        self.walks = self._choice(
            tr("Walks"),
            {
                120: tr("in sensor memory, 120 Hz"),
                60: tr("in sensor memory, 60 Hz"),
                0: tr("sent live"),
            },
        )
        self.rate = self._choice(tr("Live"), {60: tr("60 Hz"), 30: tr("30 Hz")})
        self.profile = self._choice(tr("Filter"), {0: tr("General"), 1: tr("Dynamic, for fast and jerky motion")})
        self._consequence = Text(size=14, tone="ink2", wraps=True)
        self.notice = Notice(size=16)
        self.back = Button(tr("Other sources"), ButtonKind.QUIET)
        self._build()
        self._connect()
        self._show_consequence()

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.list, self.identify, self.walks, self.rate, self.profile, self.back]

    @property
    def choice(self) -> DotChoice:
        return DotChoice(int(self.rate.currentData()), int(self.walks.currentData()), int(self.profile.currentData()))

    @property
    def consequence(self) -> str:
        """What is stated about how walks are recorded."""
        return self._consequence.text()

    def focus(self) -> None:
        self.list.setFocus()

    def show_choice(self, choice: DotChoice) -> None:
        for box, key in ((self.rate, choice.rate_hz), (self.walks, choice.record_hz), (self.profile, choice.profile)):
            with QSignalBlocker(box):
                box.setCurrentIndex(max(box.findData(key), 0))
            box.update()
        self._show_consequence()

    def show_dots(self, lines: Sequence[DotLine]) -> None:
        """Show what was found, and what is known of each."""
        if tuple(lines) == self._lines:
            return
        self._lines = tuple(lines)
        row = self.list.currentIndex().row()
        heads = [tr("Worn"), tr("Signal"), tr("Battery"), tr("Firmware")]
        columns = [TableColumn(TextCell(head, size=12, tone="ink2")) for head in heads]
        columns.append(TableColumn(TextCell("", size=12, tone="ink2", wraps=True), share=1))
        self.list.show_rows(columns, [self._row(number, line) for number, line in enumerate(lines)])
        self.list.choose(min(max(row, 0), len(lines) - 1))
        self._fit()
        count = len(lines)
        title = tr_n("{count} Movella DOT found", "{count} Movella DOTs found", count)
        self._title.setText(title.format(count=count))
        self._lead.setText(
            tr(
                "Tick the sensors that are worn. Place them side by side near this computer until they are "
                "synchronised."
            )
        )

    def show_message(self, what: str, then: str = "") -> None:
        """Say why they were not synchronised, and what to do; "" takes it back."""
        self.notice.show_message(Icon.WARNING if what else None, what, then, is_caution=bool(what))
        self.notice.setVisible(bool(what))
        self._lead.setVisible(not what)  # `then` states it, and the list needs the room

    def identify_selected(self) -> bool:
        """Let the chosen sensor blink; whether one is chosen."""
        row = self.list.currentIndex().row()
        if row < 0:
            return False
        self.identify_pressed.emit(row)
        return True

    def set_room(self, width: int, *, is_narrow: bool) -> None:
        """Lay list and choices one below the other in a narrow window, and where both need more than `width` px."""
        self._room, self._is_window_narrow = width, is_narrow
        self._fit()

    def _fit(self) -> None:
        """See whether notes have the room beside the choices to wrap into two lines, which a row holds."""
        metrics = QFontMetrics(current_theme().font(14))
        note = max((metrics.horizontalAdvance(line.note) for line in self._lines), default=0)
        least = self.list.minimumSizeHint().width() + NOTE_SHARE * note + self._choices.minimumSize().width()
        margins = self._card.column.contentsMargins()
        beside = margins.left() + margins.right() + self._body.spacing()
        is_narrow = self._is_window_narrow or least + beside > self._room
        if is_narrow != self._is_narrow:
            self._is_narrow = is_narrow
            way = QBoxLayout.Direction.TopToBottom if is_narrow else QBoxLayout.Direction.LeftToRight
            self._body.setDirection(way)

    def _choice(self, label: str, options: dict[int, str]) -> Choice:
        choice = Choice(label)
        choice.offer(((words, key) for key, words in options.items()), chosen=None)
        return choice

    def _row(self, number: int, line: DotLine) -> TableRow:
        is_low = line.battery is not None and line.battery < LOW
        is_weak = line.rssi_dbm is not None and line.rssi_dbm < FAIR_DBM
        cells: tuple[TableCell, ...] = (
            _TickCell(line.name, line.is_worn),
            TextCell(line.signal, mark=Icon.WARNING if is_weak else None),
            TextCell(line.charge, mark=Icon.WARNING if is_low else None),
            TextCell(line.firmware or "\N{EN DASH}"),
            TextCell(line.note, wraps=True, mark=Icon.WARNING if line.note else None),
        )
        return TableRow(cells, key=number)

    def _build(self) -> None:
        self._card = Card()
        heading = lay_out(QVBoxLayout(), self._title, self._lead, spacing=4)
        left = lay_out(QVBoxLayout(), (self.list, 1), lay_out(QHBoxLayout(), self.identify, 1))
        self._choices = lay_out(QVBoxLayout(), spacing=6)
        for choice in (self.walks, self.rate, self.profile):
            lay_out(self._choices, Text(choice.accessibleName(), 14, tone="ink2"), choice)
        lay_out(self._choices, self._consequence, 1)
        self._body = lay_out(QBoxLayout(QBoxLayout.Direction.LeftToRight), (left, 3), (self._choices, 2), spacing=32)
        lay_out(self._card.column, heading, self.notice, (self._body, 1))
        verbs = lay_out(QHBoxLayout(), self.back, 1)
        lay_out(QVBoxLayout(self), (self._card, 1), verbs, margins=0, spacing=12)
        scaled(self.list.setMinimumHeight, HEAD + AT_LEAST_ROWS * ROW)
        self.show_message("")

    def _connect(self) -> None:
        self.list.opened.connect(self._on_opened)
        self.list.clicked.connect(self._on_clicked)
        self.identify.clicked.connect(self._on_identify_clicked)
        for choice in (self.walks, self.rate, self.profile):
            choice.activated.connect(self._on_chosen)

    def _show_consequence(self) -> None:
        record_hz = self.choice.record_hz
        if record_hz == 120:
            stated = tr(
                "No walk data are lost in radio transmission, at any distance. Curves appear once the walk is "
                "fetched from the sensors. The sensors are synchronised again before the first walk."
            )
        elif record_hz:
            stated = tr(
                "No walk data are lost in radio transmission, at any distance. Curves appear once the walk is "
                "fetched from the sensors."
            )
        else:
            stated = tr("Curves are shown during walking. Data lost in radio transmission are missing.")
        self._consequence.setText(stated)

    def _on_clicked(self, index: QModelIndex) -> None:
        if index.column() == 0:
            self.turned.emit(index.row())

    def _on_opened(self, number: object) -> None:
        assert isinstance(number, int)
        self.turned.emit(number)

    def _on_identify_clicked(self) -> None:
        self.identify_selected()

    def _on_chosen(self) -> None:
        self._show_consequence()
        self.changed.emit()
