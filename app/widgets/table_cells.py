"""The cells of a table: text with what is beside it, and a difference over the grey strip of its error."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter

from app.theme.icons import Icon, paint_icon
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.theme import Theme
from app.widgets.text import MEDIUM, REGULAR
from core.body import Side

LEFT, RIGHT, CENTRE = Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignRight, Qt.AlignmentFlag.AlignHCenter
MIDDLE = Qt.AlignmentFlag.AlignVCenter
SMALL = 12  # px of the letters behind a text
SMALL_GAP, CHIP_GAP, MARK_GAP = 4, 8, 4
MARK = 16
LINE = 18  # from one line of a text to the next
ONE_LINE = 28
STRIP_WIDTH, STRIP_HEIGHT = 120, 18
DOT = 11
INTERVAL_WIDTH, CIRCLE, SPAN_WIDTH = 146, 11, 96


class TableCell(ABC):
    """What one cell shows and what is read out of it. Cells are values: whoever shows others makes others."""

    __slots__ = ()

    @property
    def span(self) -> int:
        """The columns it goes over; the cells that it covers are there and empty."""
        return 1

    @property
    def words(self) -> str:
        """What is copied, and read out where nothing else is."""
        return ""

    @property
    def stated(self) -> str:
        """What a screen reader reads out for the cell alone, so with its row and its column."""
        return self.words

    @property
    def is_checked(self) -> bool | None:
        """None where there is nothing to tick."""
        return None

    @abstractmethod
    def width(self, theme: Theme) -> int:
        """The px of the screen that it needs."""

    def height(self, theme: Theme) -> int:
        """The px of the screen that it needs; rows are as high as their highest cell."""
        return theme.px(ONE_LINE)

    @abstractmethod
    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        """Draw it into `room`, which has the row's height and no padding."""


@dataclass(frozen=True, slots=True)
class TextCell(TableCell):
    r"""A text in one or several lines ("\n"), with a mark or the chip of a leg before and smaller words behind it.

    `align` is LEFT, RIGHT or CENTRE, `tone` the token of the text's colour. `wraps`: it asks for the room of its
    longest word only. `small_yields`: it asks for no room for its small words, which are cut where there is none.
    `spoken` represents its words where these alone would not be understood.
    """

    text: str = ""
    small: str = ""
    align: Qt.AlignmentFlag = LEFT
    size: float = 14
    weight: QFont.Weight = REGULAR
    tone: str = "ink"
    mark: Icon | None = None
    side: Side | None = None
    span: int = 1
    wraps: bool = False
    small_yields: bool = False
    spoken: str = ""

    @property
    def words(self) -> str:
        letter = self.side.letter if self.side is not None else ""
        return " ".join(filter(None, [letter, self.text.replace("\n", " "), self.small]))

    @property
    def stated(self) -> str:
        return self.spoken or self.words

    def width(self, theme: Theme) -> int:
        small = 0 if self.small_yields else self._small_width(theme)
        return self._mark_width(theme) + self._chip_width(theme) + self._text_width(theme) + small

    def height(self, theme: Theme) -> int:
        return theme.px(ONE_LINE) + self.text.count("\n") * theme.px(LINE)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        """Draw mark, chip, text and small words side by side, from the edge that they are aligned to."""
        if self.align == CENTRE:
            spare = max(0.0, room.width() - self.width(theme))
            room = room.adjusted(spare / 2, 0, -spare / 2, 0)
        parts = [
            (self._mark_width(theme), self._paint_mark),
            (self._chip_width(theme), self._paint_chip),
            (self._text_width(theme), self._paint_text),
            (self._small_width(theme), self._paint_small),
        ]
        for width, paint in reversed(parts) if self.align == RIGHT else parts:
            if width:
                paint(painter, room, theme)
                room = room.adjusted(0, 0, -width, 0) if self.align == RIGHT else room.adjusted(width, 0, 0, 0)

    def _paint_mark(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        assert self.mark is not None
        width = self._mark_width(theme)
        paint_icon(painter, self.mark, self._square(room, theme.px(MARK), width), theme.colours.ink)

    def _paint_chip(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        assert self.side is not None
        paint_chip(painter, self._square(room, theme.px(CHIP), self._chip_width(theme)), self.side, theme)

    def _paint_text(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        gap = theme.px(SMALL_GAP) if self.small and self.align == RIGHT else 0
        painter.setFont(theme.font(self.size, self.weight))
        painter.setPen(QColor(getattr(theme.colours, self.tone)))
        flags = int(self._way | MIDDLE) | (int(Qt.TextFlag.TextWordWrap) if self.wraps else 0)
        painter.drawText(room.adjusted(0, 0, -gap, 0), flags, self.text)

    def _paint_small(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        painter.setFont(theme.font(SMALL))
        painter.setPen(QColor(theme.colours.ink2))
        small = self.small
        if self.small_yields:
            small = QFontMetrics(theme.font(SMALL)).elidedText(small, Qt.TextElideMode.ElideRight, int(room.width()))
        painter.drawText(room, int(self._way | MIDDLE), small)

    @property
    def _way(self) -> Qt.AlignmentFlag:
        return RIGHT if self.align == RIGHT else LEFT

    def _square(self, room: QRectF, side: int, width: int) -> QRectF:
        """The place of a mark or a chip at the edge of `room`, where it takes `width` with the gap to the text."""
        left = room.right() - width if self.align == RIGHT else room.left()
        return QRectF(left, room.center().y() - side / 2, side, side)

    def _mark_width(self, theme: Theme) -> int:
        return theme.px(MARK) + self._gap(MARK_GAP, theme) if self.mark is not None else 0

    def _chip_width(self, theme: Theme) -> int:
        return theme.px(CHIP) + self._gap(CHIP_GAP, theme) if self.side is not None else 0

    def _gap(self, length: int, theme: Theme) -> int:
        """The room between a mark or a chip and the text, where there is one."""
        return theme.px(length) if self.text or self.small else 0

    def _text_width(self, theme: Theme) -> int:
        metrics = QFontMetrics(theme.font(self.size, self.weight))
        lines = self.text.split(" ") if self.wraps else self.text.split("\n")
        gap = theme.px(SMALL_GAP) if self.small and self.text else 0
        return max(map(metrics.horizontalAdvance, lines), default=0) + gap

    def _small_width(self, theme: Theme) -> int:
        return QFontMetrics(theme.font(SMALL)).horizontalAdvance(self.small) if self.small else 0


EMPTY = TextCell()


@dataclass(frozen=True, slots=True)
class ErrorStrip(TableCell):
    """A difference from zero in the middle, over its measurement error in grey; all three numbers in one unit.

    The edges of the strip are -`scale` and `scale`. Outside the error the dot is filled, inside it is hollow; what lies
    beyond the edge ends there in an arrow. Not judged: a grey bar, without dot and error. NaN: not known, not drawn.
    """

    difference: float
    error: float
    scale: float
    is_judged: bool
    spoken: str = ""

    @property
    def exceeds(self) -> bool:
        return self.is_judged and abs(self.difference) > self.error

    @property
    def stated(self) -> str:
        return self.spoken

    def width(self, theme: Theme) -> int:
        return theme.px(STRIP_WIDTH)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        c, px = theme.colours, theme.px
        strip = QRectF(room.left(), room.center().y() - px(STRIP_HEIGHT) / 2, room.width(), px(STRIP_HEIGHT))
        zero, middle = strip.center().x(), strip.center().y()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self.is_judged and math.isfinite(self.error):
            half = self._x(self.error, strip, theme) - zero
            painter.fillRect(QRectF(zero - half, strip.top(), 2 * half, strip.height()), QColor(c.band_2sd))
        if math.isfinite(self.difference):
            end = QPointF(self._x(self.difference, strip, theme), middle)
            if self.is_judged:
                self._paint_difference(painter, QPointF(zero, middle), end, theme)
            else:
                left, right = sorted((zero, end.x()))
                painter.fillRect(QRectF(left, middle - px(2), right - left, 2 * px(2)), QColor(c.control))
        painter.setPen(theme.pen(c.control, 1))
        painter.drawLine(QPointF(zero, strip.top()), QPointF(zero, strip.bottom()))

    def _paint_difference(self, painter: QPainter, start: QPointF, end: QPointF, theme: Theme) -> None:
        c, px = theme.colours, theme.px
        painter.setPen(theme.pen(c.ink, 1.75))
        painter.drawLine(start, end)
        if abs(self.difference) > self.scale:
            back = math.copysign(px(DOT) / 2, self.difference)
            for height in (-px(DOT) / 2, px(DOT) / 2):
                painter.drawLine(end, QPointF(end.x() - back, end.y() + height))
            return
        painter.setBrush(QColor(c.ink if self.exceeds else c.surface))
        painter.drawEllipse(end, px(DOT) / 2 - 1, px(DOT) / 2 - 1)

    def _x(self, value: float, strip: QRectF, theme: Theme) -> float:
        """The place of a value, such that a dot at the very edge is seen whole."""
        reach = (strip.width() - theme.px(DOT)) / 2
        part = min(max(value / self.scale, -1.0), 1.0) if self.scale > 0 else 0.0
        return strip.center().x() + part * reach


@dataclass(frozen=True, slots=True)
class IntervalStrip(TableCell):
    """A difference as a dot on its likely interval, over the grey zone of what healthy people differ by; one unit.

    `half` and `zone` are the halves of both, NaN where not known. The edges of the strip are -`scale` and `scale`; the
    line in the middle is no difference. What reaches beyond an edge ends there.
    """

    difference: float
    half: float
    zone: float
    scale: float
    spoken: str = ""

    @property
    def stated(self) -> str:
        return self.spoken

    def width(self, theme: Theme) -> int:
        return theme.px(INTERVAL_WIDTH)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        c, px, middle, zero = theme.colours, theme.px, room.center().y(), room.center().x()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if math.isfinite(self.zone):
            edge = self._x(self.zone, room, theme) - zero
            painter.fillRect(QRectF(zero - edge, middle - px(8), 2 * edge, 2 * px(8)), QColor(c.band_2sd))
        painter.setPen(theme.pen(c.control, 1))
        painter.drawLine(QPointF(zero, middle - px(9)), QPointF(zero, middle + px(9)))
        if not math.isfinite(self.difference):
            return
        painter.setPen(theme.pen(c.ink, 1.5))
        if math.isfinite(self.half):
            ends = [self._x(self.difference + sign * self.half, room, theme) for sign in (-1.0, 1.0)]
            painter.drawLine(QPointF(ends[0], middle), QPointF(ends[1], middle))
            for end in ends:
                painter.drawLine(QPointF(end, middle - px(4)), QPointF(end, middle + px(4)))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(c.ink))
        dot = px(9 if abs(self.difference) > self.half else 7) / 2
        painter.drawEllipse(QPointF(self._x(self.difference, room, theme), middle), dot, dot)

    def _x(self, value: float, room: QRectF, theme: Theme) -> float:
        reach = room.width() / 2 - theme.px(5)
        return room.center().x() + reach * min(max(value / self.scale, -1.0), 1.0)


@dataclass(frozen=True, slots=True)
class SpanStrip(TableCell):
    """From when to when something lasted, on a line from 0 to `whole`, all in one unit."""

    start: float
    end: float
    whole: float
    is_marked: bool = False

    def width(self, theme: Theme) -> int:
        return theme.px(SPAN_WIDTH)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        c, px, middle = theme.colours, theme.px, room.center().y()
        painter.fillRect(QRectF(room.left(), middle - px(2), room.width(), px(4)), QColor(c.track))
        if not (self.whole > 0.0 and math.isfinite(self.end - self.start)):
            return
        left, right = (room.left() + room.width() * value / self.whole for value in (self.start, self.end))
        box = QRectF(left, middle - px(6), max(right - left, px(2)), px(12))
        painter.fillRect(box, QColor(c.ink if self.is_marked else c.ink2))


@dataclass(frozen=True, slots=True)
class MarkCell(TableCell):
    """What a difference is beyond: a filled or an outlined circle, or none, and the words for it."""

    text: str
    has_circle: bool = False
    is_filled: bool = False

    @property
    def words(self) -> str:
        return self.text

    def width(self, theme: Theme) -> int:
        font = theme.font(SMALL, MEDIUM if self.is_filled else REGULAR)
        return theme.px(CIRCLE) + theme.px(CHIP_GAP) + QFontMetrics(font).horizontalAdvance(self.text)

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        c, px, radius = theme.colours, theme.px, theme.px(CIRCLE) / 2
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self.has_circle:
            painter.setPen(theme.pen(c.ink, 1.5))
            painter.setBrush(QColor(c.ink) if self.is_filled else Qt.BrushStyle.NoBrush)
            painter.drawEllipse(QPointF(room.left() + radius, room.center().y()), radius - 1, radius - 1)
        painter.setFont(theme.font(SMALL, MEDIUM if self.is_filled else REGULAR))
        painter.setPen(QColor(c.ink if self.has_circle else c.ink2))
        painter.drawText(room.adjusted(px(CIRCLE) + px(CHIP_GAP), 0, 0, 0), int(LEFT | MIDDLE), self.text)
