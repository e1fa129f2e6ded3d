"""One lane of a patient's course, and the axis of dates under all of them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QMouseEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.summary.course_lanes import CourseLane, CourseVisit, LaneLine, LanePoint
from app.summary.course_words import day_of
from app.theme.notifier import ThemeNotifier
from app.theme.theme import Theme
from app.widgets.painted_text import CENTRE, RIGHT, PaintedText
from app.widgets.themed import Themed
from app.wording.measures import least_span
from app.wording.numbers import MINUS
from app.wording.translation import figure_text
from core.body import Side

AXIS, INSET = 40, 10  # px: for the figures of the values, and from the plot's edges to the first and last visit
APART = 18  # px between two visits, whatever their days
HALF_LINE = 8  # of the figures
LEAST_HEIGHT, DATES = 66, 26
DOT, CAP, TICK = 5, 5, 4
STEPS = (1, 2, 5, 10)
MOST_STEPS = 2


@dataclass(frozen=True, slots=True)
class LaneScale:
    """Round values at the lower and upper edge of a lane; `decimals` of the figures at its lines."""

    low: float
    high: float
    step: float
    decimals: int

    @classmethod
    def of(cls, lane: CourseLane) -> "LaneScale":
        """Round all that is drawn, and not less than what is worth a lane."""
        values = lane.values or [0.0]
        middle = (min(values) + max(values)) / 2
        half = max(max(values) - min(values), least_span(lane.kind.column)) / 2
        power = math.floor(math.log10(2 * half / MOST_STEPS))
        step = next(one * 10.0**power for one in STEPS if one * 10.0**power >= 2 * half / MOST_STEPS - 1e-9)
        low, high = math.floor((middle - half) / step + 1e-6), math.ceil((middle + half) / step - 1e-6)
        return cls(low * step, high * step, step, max(0, -math.floor(math.log10(step) + 1e-9)))

    @property
    def ticks(self) -> list[float]:
        return [self.low + k * self.step for k in range(round((self.high - self.low) / self.step) + 1)]


class DatedPlot(Themed):
    """A plot over the dates of visits. Signals: `pointed` at the visit of a number, and `opened`."""

    pointed = Signal(int)
    opened = Signal(int)

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self.visits: tuple[CourseVisit, ...] = ()
        self._number: int | None = None
        self._places: list[float] = []
        self._places_of: object = None  # what they were found for; a pointer that moves asks for all of them
        self.setMouseTracking(True)

    @property
    def plot(self) -> QRectF:
        """Where values lie; half a line of figures is over and under them."""
        px = self._look.theme.px
        return QRectF(px(AXIS), px(HALF_LINE), self.width() - px(AXIS), self.height() - 2 * px(HALF_LINE))

    def point_at(self, number: int | None) -> None:
        """Mark a visit."""
        if number != self._number:
            self._number = number
            self.update()

    def x_of(self, number: int) -> float:
        """The place of a visit: by its day, and beside one that is too near to be distinguished from it."""
        seen = (self.visits, self.width(), self._look.theme.scale)
        if self._places_of != seen:
            self._places_of, self._places = seen, self._found_places()
        return self._places[number]

    def _found_places(self) -> list[float]:
        plot, px = self.plot, self._look.theme.px
        days = np.array([visit.day.toordinal() for visit in self.visits], float)
        room, span = plot.width() - 2 * px(INSET), max(days[-1] - days[0], 1.0)
        steps = np.arange(len(days)) * min(px(APART), room / max(len(days) - 1, 1))
        by_day = room * (days - days[0]) / span if days[-1] > days[0] else (room - steps[-1:]) / 2 + steps
        places = np.minimum(np.maximum.accumulate(by_day - steps), room - steps[-1]) + steps
        return [float(place) for place in plot.left() + px(INSET) + places]

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self.visits:
            self.pointed.emit(self._nearest(event.position().x()))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if self.visits and event.button() == Qt.MouseButton.LeftButton:
            self.opened.emit(self._nearest(event.position().x()))

    def _nearest(self, x: float) -> int:
        return min(range(len(self.visits)), key=lambda number: abs(self.x_of(number) - x))

    def paint_pointer(self, painter: QPainter) -> None:
        """A line at the visit that is pointed at."""
        if self._number is not None:
            painter.setPen(self._look.theme.pen(self._look.theme.colours.control, 1))
            x = self.x_of(self._number)
            painter.drawLine(QPointF(x, 0), QPointF(x, self.height()))

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.update()


class LanePlot(DatedPlot):
    """The values of a lane with their whiskers, over the first visit's less and plus the error of a change."""

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__(look)
        self.lane: CourseLane | None = None
        self._marks: Sequence[str] = ()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def show_lane(self, lane: CourseLane, visits: Sequence[CourseVisit], conditions: Sequence[str]) -> None:
        """Draw a lane; `conditions` in the order of their marks."""
        self.lane, self.visits, self._marks, self._number = lane, tuple(visits), tuple(conditions), None
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(self._look.theme.px(200), self._look.theme.px(LEAST_HEIGHT))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def y_of(self, value: float) -> float:
        assert self.lane is not None
        plot, scale = self.plot, LaneScale.of(self.lane)
        return plot.bottom() - (value - scale.low) / (scale.high - scale.low) * plot.height()

    def painted_texts(self) -> list[PaintedText]:
        if self.lane is None:
            return []
        theme, scale, half = self._look.theme, LaneScale.of(self.lane), self._look.theme.px(HALF_LINE)
        texts, ticks = [], scale.ticks
        every = 1 if self.plot.height() / max(len(ticks) - 1, 1) >= 2 * half else 2
        for tick in ticks[::every]:
            words = figure_text(tick if abs(tick) > 1e-9 else 0.0, f".{scale.decimals}f").replace("-", MINUS)
            box = QRectF(0, self.y_of(tick) - half, theme.px(AXIS - 8), 2 * half)
            texts.append(PaintedText(words, box, theme.font(12), "ink2", RIGHT))
        return texts

    def paintEvent(self, _event: QPaintEvent) -> None:
        if self.lane is None:
            return
        theme, plot = self._look.theme, self.plot
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self.lane.band is not None:
            low, high = (self.y_of(end) for end in self.lane.band)
            painter.fillRect(QRectF(plot.left(), high, plot.width(), low - high), QColor(theme.colours.band_2sd))
        painter.setPen(theme.pen(theme.colours.line, 1))
        for tick in LaneScale.of(self.lane).ticks:
            painter.drawLine(QPointF(plot.left(), self.y_of(tick)), QPointF(plot.right(), self.y_of(tick)))
        self.paint_pointer(painter)
        painter.setPen(_goal_pen(theme))
        for value in self.lane.goal_values:
            painter.drawLine(QPointF(plot.left(), self.y_of(value)), QPointF(plot.right(), self.y_of(value)))
        for line in reversed(self.lane.lines):  # where marks lie on one another, the first condition's is seen whole
            self._paint_line(painter, line)
        for text in self.painted_texts():
            text.paint(painter, theme.colours)

    def _paint_line(self, painter: QPainter, line: LaneLine) -> None:
        """Adjacent points are joined; what lies beyond a visit that cannot be read is not."""
        theme = self._look.theme
        colour = QColor(theme.colours.ink) if line.side is None else theme.curve(line.side)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(_line_pen(theme, line.side, colour, self._mark_of(line)))
        for one, other in pairwise(line.points):
            if one.is_reported and other.is_reported:
                painter.drawLine(self._at(one), self._at(other))
        painter.setPen(theme.pen(colour, 1.5))
        for point in line.reported:
            if math.isfinite(point.whisker):
                self._paint_whisker(painter, point)
        for point in line.reported:
            paint_mark(painter, theme, self._at(point), self._mark_of(line), colour, line.side)

    def _paint_whisker(self, painter: QPainter, point: LanePoint) -> None:
        x, cap = self.x_of(point.visit), self._look.theme.px(CAP)
        ends = [self.y_of(point.value + sign * point.whisker) for sign in (-1, 1)]
        painter.drawLine(QPointF(x, ends[0]), QPointF(x, ends[1]))
        for y in ends:
            painter.drawLine(QPointF(x - cap, y), QPointF(x + cap, y))

    def _at(self, point: LanePoint) -> QPointF:
        return QPointF(self.x_of(point.visit), self.y_of(point.value))

    def _mark_of(self, line: LaneLine) -> int:
        return self._marks.index(line.condition)


class DateAxis(DatedPlot):
    """A tick at every visit; dates that would touch are left out, the first and the last stay."""

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__(look)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def show_visits(self, visits: Sequence[CourseVisit]) -> None:
        self.visits, self._number = tuple(visits), None
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(self._look.theme.px(200), self._look.theme.px(DATES))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def labels(self) -> dict[int, PaintedText]:
        """The dates that find room, by the number of their visit."""
        theme, font = self._look.theme, self._look.theme.font(12)
        metrics, gap, last = QFontMetrics(font), self._look.theme.px(8), len(self.visits) - 1
        kept: dict[int, PaintedText] = {}
        for number in sorted(range(len(self.visits)), key=lambda k: (k not in (0, last), k != last, k)):
            words = day_of(number, self.visits)
            width = metrics.horizontalAdvance(words) + 2
            left = min(max(self.x_of(number) - width / 2, 0), self.width() - width)
            box = QRectF(left, theme.px(TICK + 2), width, self.height() - theme.px(TICK + 2))
            if not any(box.adjusted(-gap, 0, gap, 0).intersects(other.box) for other in kept.values()):
                kept[number] = PaintedText(words, box, font, "ink2", CENTRE)
        return {number: kept[number] for number in sorted(kept)}

    def painted_texts(self) -> list[PaintedText]:
        return list(self.labels().values())

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme, plot = self._look.theme, self.plot
        painter = QPainter(self)
        painter.setPen(theme.pen(theme.colours.control, 1))
        painter.drawLine(QPointF(plot.left(), 0.5), QPointF(plot.right(), 0.5))
        for number in range(len(self.visits)):
            x = self.x_of(number)
            painter.drawLine(QPointF(x, 0), QPointF(x, theme.px(TICK)))
        for text in self.painted_texts():
            text.paint(painter, theme.colours)


class ConditionMark(QWidget):
    """The mark of a condition, before its name."""

    def __init__(self, look: ThemeNotifier, mark: int) -> None:
        super().__init__()
        self._look, self._mark = look, mark
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def sizeHint(self) -> QSize:
        side = self._look.theme.px(4 * DOT)
        return QSize(side, side)

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        centre = QPointF(self.width() / 2, self.height() / 2)
        paint_mark(painter, self._look.theme, centre, self._mark, QColor(self._look.theme.colours.ink), None)


def paint_mark(painter: QPainter, theme: Theme, at: QPointF, mark: int, colour: QColor, side: Side | None) -> None:
    """Draw the mark of a condition: filled dot, open square, filled diamond, open dot. The right leg's are open."""
    surface, radius = QColor(theme.colours.surface), DOT * theme.scale
    is_filled = mark % 2 == 0 and side is not Side.RIGHT
    painter.setPen(theme.pen(colour, 1.75))
    painter.setBrush(colour if is_filled else surface)
    if mark == 1:
        painter.drawRect(QRectF(at.x() - radius, at.y() - radius, 2 * radius, 2 * radius))
    elif mark == 2:
        far = 1.3 * radius
        ends = ((0, -far), (far, 0), (0, far), (-far, 0))
        painter.drawPolygon(QPolygonF([QPointF(at.x() + x, at.y() + y) for x, y in ends]))
    else:
        painter.drawEllipse(at, radius, radius)
    painter.setBrush(Qt.BrushStyle.NoBrush)


def _goal_pen(theme: Theme) -> QPen:
    pen = theme.pen(theme.colours.ink, 1.75)
    pen.setStyle(Qt.PenStyle.DotLine)
    return pen


def _line_pen(theme: Theme, side: Side | None, colour: QColor, mark: int) -> QPen:
    """Solid for the first condition, dotted for the others; the right leg's dashed."""
    pen = theme.side_pen(side, 1.75) if side is not None else theme.pen(colour, 1.75)
    if mark:
        pen.setStyle(Qt.PenStyle.DotLine)
    return pen
