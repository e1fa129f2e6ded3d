"""One row of the rail: a step and how far it is, or a way on."""

from dataclasses import dataclass
from enum import Enum, auto

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QEnterEvent,
    QFocusEvent,
    QFont,
    QFontMetrics,
    QKeyEvent,
    QPainter,
    QPaintEvent,
)
from PySide6.QtWidgets import QAbstractButton, QSizePolicy

from app.theme.current import current_theme, px
from app.theme.icons import Icon, paint_icon
from app.theme.theme import CHIP_RADIUS, CONTROL_RADIUS
from app.widgets.painted import smooth_painter
from app.widgets.painted_text import CENTRE, PaintedText, height_for
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wording.translation import tr

RING = 26
ICON, ICON_ALONE = 20, 26
BAR = 4


class StepState(Enum):
    DONE = auto()
    CURRENT = auto()
    TODO = auto()
    ATTENTION = auto()
    SKIPPED = auto()


class RailForm(Enum):
    """How wide the rail is, in px; COMPACT shows no words but under the mouse and on the row that has the focus."""

    COMPACT = 64
    USUAL = 216
    WIDE = 240


@dataclass(frozen=True, slots=True)
class RailRow:
    """`note` is what came of the step. With an icon it is no step: no number, and no line to the next."""

    title: str
    note: str = ""
    state: StepState = StepState.TODO
    icon: Icon | None = None


@dataclass(frozen=True, slots=True)
class BelowRow:
    """One of the rows at the bottom; `name` is what `below_pressed` carries."""

    name: str
    title: str
    icon: Icon
    key: str = ""


class RailButton(QAbstractButton):
    """A step with its number, or a way on with its icon."""

    moved = Signal(int)  # by so many rows, with the arrows
    looked_at = Signal(bool)  # it got the focus or the mouse, or lost it

    def __init__(self) -> None:
        super().__init__()
        self._form = RailForm.USUAL
        self._row, self._number, self._count = RailRow(""), 0, 0
        self._key = ""
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self.setCursor(Qt.CursorShape.PointingHandCursor)

    @property
    def is_current(self) -> bool:
        return self._row.state is StepState.CURRENT

    def show_row(self, row: RailRow, number: int, count: int) -> None:
        if (row, number, count) == (self._row, self._number, self._count):
            return
        self._row, self._number, self._count = row, number, count
        parts = [row.title, _state_word(row.state) if row.icon is None or self.is_current else "", row.note]
        if row.icon is None:
            parts.insert(0, tr("Step {number} of {count}").format(number=number, count=count))
        self.setText(row.title)
        self.setAccessibleName(", ".join(filter(None, parts)))
        self._refresh()

    def show_below(self, row: BelowRow) -> None:
        self._row, self._number, self._count = RailRow(row.title, icon=row.icon), 0, 0
        self._key = row.key
        self.setText(row.title)
        self.setAccessibleName(row.title)
        self.setAccessibleDescription(tr("Key {key}").format(key=row.key) if row.key else "")
        self._refresh()

    def set_form(self, form: RailForm) -> None:
        self._form = form
        self._refresh()

    @property
    def note(self) -> str:
        return self._row.note

    @property
    def _is_step(self) -> bool:
        return self._number > 0

    def sizeHint(self) -> QSize:
        if self._form is RailForm.COMPACT:
            return QSize(px(44), px(48 if self._is_step else 44))
        title, note = self._heights()
        return QSize(px(150), max(title + note + px(14), px(56 if self._is_step else 44)))

    def painted_texts(self) -> list[PaintedText]:
        """Give what is painted now, each in its box."""
        theme = current_theme()
        texts = []
        if self._is_step and self._row.icon is None and self._row.state in (StepState.CURRENT, StepState.TODO):
            tone = "inv_ink" if self.is_current else "ink2"
            texts.append(PaintedText(str(self._number), self._ring(), theme.font(13, SEMIBOLD), tone, CENTRE))
        if self._form is RailForm.COMPACT:
            return texts
        title, note = self._heights()
        left, width = self._text_left(), self._text_width()
        top = (self.height() - title - note) / 2
        is_done = self.is_current or self._row.state in (StepState.DONE, StepState.ATTENTION)
        tone = "ink" if is_done else "ink2"
        texts.append(
            PaintedText(self._row.title, QRectF(left, top, width, title), self._title_font(), tone, wraps=True)
        )
        if note:
            box = QRectF(left, top + title, width, note)
            texts.append(PaintedText(self._row.note, box, theme.font(12), "ink2", wraps=True))
        if self._key:
            texts.append(PaintedText(self._key, self._cap(), theme.font(12, MEDIUM), "ink2", CENTRE))
        return texts

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = current_theme()
        c = theme.colours
        painter = smooth_painter(self)
        if self.is_current:
            self._paint_join(painter)
        elif self.underMouse() or self.isDown():
            box = QRectF(self.rect()).adjusted(0, 2, -theme.px(6), -2)
            theme.paint_box(painter, box, theme.veil(self.isDown()))
        if self._row.icon is not None:
            tone = c.ink if self.is_current else c.ink2
            paint_icon(painter, self._row.icon, self.icon_box(), tone)
        else:
            self._paint_line(painter)
            self._paint_ring(painter)
        if self._key and self._form is not RailForm.COMPACT:
            theme.paint_box(painter, self._cap(), None, c.control, 1, CHIP_RADIUS)
        for text in self.painted_texts():
            text.paint(painter, c)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        key = Qt.Key
        steps = {key.Key_Up: -1, key.Key_Down: 1, key.Key_Home: -99, key.Key_End: 99}.get(key(event.key()))
        if steps is not None:
            self.moved.emit(steps)
        elif event.key() in (key.Key_Return, key.Key_Enter):
            self.click()
        else:
            super().keyPressEvent(event)

    def focusInEvent(self, event: QFocusEvent) -> None:
        super().focusInEvent(event)
        self.looked_at.emit(True)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        self.looked_at.emit(False)

    def enterEvent(self, event: QEnterEvent) -> None:
        super().enterEvent(event)
        self.looked_at.emit(True)

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        self.looked_at.emit(self.hasFocus())

    def _paint_join(self, painter: QPainter) -> None:
        """Draw the ground that joins the row to the page, and the bar at its outer edge."""
        theme = current_theme()
        c, px = theme.colours, theme.px
        beyond = CONTROL_RADIUS * theme.scale  # its right corners lie outside
        theme.paint_box(painter, QRectF(self.rect()).adjusted(0, px(2), beyond, -px(2)), c.ground)
        reach = px(32)
        theme.paint_box(painter, QRectF(0, (self.height() - reach) / 2, px(BAR), reach), c.ink, radius=BAR / 2)

    def _paint_line(self, painter: QPainter) -> None:
        """Draw this row's part of the line that joins the rings."""
        theme = current_theme()
        ring = self._ring()
        gap = theme.px(4)
        painter.setPen(theme.pen(theme.colours.control, 1.25))
        x = ring.center().x()
        if self._number > 1:
            painter.drawLine(QPointF(x, 0), QPointF(x, ring.top() - gap))
        if self._number < self._count:
            painter.drawLine(QPointF(x, ring.bottom() + gap), QPointF(x, self.height()))

    def _paint_ring(self, painter: QPainter) -> None:
        theme = current_theme()
        c = theme.colours
        ring = self._ring().adjusted(1, 1, -1, -1)
        state = self._row.state
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if state is StepState.ATTENTION:
            paint_icon(painter, Icon.WARNING, ring, c.ink)
            return
        if state is StepState.CURRENT:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(c.inv))
        elif state is StepState.DONE:
            painter.setPen(theme.pen(c.ink, 1.75))
        else:
            pen = theme.pen(c.control, 1.5)
            if state is StepState.SKIPPED:
                pen.setDashPattern([0.1, 2.4])  # round ends: dots
            painter.setPen(pen)
        painter.drawEllipse(ring)
        if state is StepState.DONE:
            inset = ring.width() * 0.14
            paint_icon(painter, Icon.CHECK, ring.adjusted(inset, inset, -inset, -inset), c.ink)
        elif state is StepState.SKIPPED:
            inset = ring.width() * 0.25
            paint_icon(painter, Icon.STILL, ring.adjusted(inset, inset, -inset, -inset), c.ink2)

    def _ring(self) -> QRectF:
        side = px(RING)
        middle = px(26 if self._form is RailForm.COMPACT else 30)
        return QRectF(middle - side / 2, (self.height() - side) / 2, side, side)

    def icon_box(self) -> QRectF:
        """Give the box of the icon of a row that is no step: as large as a step's ring where no word is beside it."""
        ring, side = self._ring(), px(ICON_ALONE if self._form is RailForm.COMPACT else ICON)
        inset = (ring.width() - side) / 2
        return ring.adjusted(inset, inset, -inset, -inset)

    def _cap(self) -> QRectF:
        """Give the box of the key cap, at the right."""
        width = QFontMetrics(current_theme().font(12, MEDIUM)).horizontalAdvance(self._key) + px(14)
        return QRectF(self.width() - px(17) - width, (self.height() - px(22)) / 2, width, px(22)).adjusted(0, 0.5, 0, 0)

    def _text_left(self) -> int:
        return px(56)

    def _text_width(self) -> int:
        """Give the room for words, from the rail's width and not the row's own: it must not wait for a layout."""
        width = px(self._form.value) - px(12) - self._text_left() - px(4)
        return width - px(13) - round(self._cap().width()) - px(8) if self._key else width

    def _title_font(self) -> QFont:
        size = 15 if self._is_step and self._row.icon is None else 14
        return current_theme().font(size, SEMIBOLD if self.is_current else MEDIUM)

    def _heights(self) -> tuple[int, int]:
        """Give the heights of title and note in the lines they take."""
        width = self._text_width()
        return (
            height_for(self._row.title, self._title_font(), width),
            height_for(self._row.note, current_theme().font(12), width),
        )

    def _refresh(self) -> None:
        self.updateGeometry()
        self.update()


def _state_word(state: StepState) -> str:
    return {
        StepState.DONE: tr("done"),
        StepState.CURRENT: tr("current"),
        StepState.TODO: tr("to do"),
        StepState.ATTENTION: tr("needs checking"),
        StepState.SKIPPED: tr("skipped"),
    }[state]
