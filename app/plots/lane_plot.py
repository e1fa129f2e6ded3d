"""One lane of a patient's course, and the axis of dates under all of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QSizePolicy

from app.summary.course_lanes import CourseLane, CourseVisit, LaneLine, LanePoint
from app.summary.course_words import day_of
from app.summary.goals import goal_mark
from app.theme.current import current_theme, px, scaled
from app.theme.theme import Theme
from app.widgets.painted import Painted
from app.widgets.painted_text import CENTRE, LEFT, RIGHT, PaintedText
from app.wording.measures import least_span

LEAST_WIDTH = 200
INSET = 8  # px from the plot's edges to the first and last visit
APART = 18  # px between two visits, whatever their days
OVER, UNDER = 15, 8  # the values: a goal's words, half a dot
LEAST_HEIGHT, DATES = 58, 24
DOT, LAST_DOT = 4, 5  # radius
NOT_REPORTED = 9  # high: the tick of a visit without a value
GOAL_LINE = 14


@dataclass(frozen=True, slots=True)
class LaneScale:
    """The values at the lower and upper edge of a lane."""

    low: float
    high: float

    @classmethod
    def of(cls, lane: CourseLane) -> "LaneScale":
        """All that is drawn, and not less than what is worth a lane."""
        values = lane.values or [0.0]
        middle = (min(values) + max(values)) / 2
        half = max(max(values) - min(values), least_span(lane.kind.column)) / 2
        return cls(middle - half, middle + half)


class DatedPlot(Painted):
    """A plot over the dates of visits. Signals: `pointed` at the visit of a number, and `opened`."""

    pointed = Signal(int)
    opened = Signal(int)

    def __init__(self, height: float) -> None:
        super().__init__()
        self.visits: tuple[CourseVisit, ...] = ()
        self._number: int | None = None
        self._places: list[float] = []
        self._places_of: object = None  # what they were found for; a pointer that moves asks for all of them
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        scaled(self.setMinimumSize, LEAST_WIDTH, height)

    @property
    def plot(self) -> QRectF:
        """Where values lie."""
        return QRectF(0, px(OVER), self.width(), self.height() - px(OVER) - px(UNDER))

    def point_at(self, number: int | None) -> None:
        """Mark a visit."""
        if number != self._number:
            self._number = number
            self.update()

    def x_of(self, number: int) -> float:
        """The place of a visit: by its day, and beside one that is too near to be distinguished from it."""
        seen = (self.visits, self.width(), current_theme().scale)
        if self._places_of != seen:
            self._places_of, self._places = seen, self._found_places()
        return self._places[number]

    def _found_places(self) -> list[float]:
        plot, px = self.plot, current_theme().px
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
            painter.setPen(current_theme().pen(current_theme().colours.control, 1))
            x = self.x_of(self._number)
            painter.drawLine(QPointF(x, 0), QPointF(x, self.height()))


class LanePlot(DatedPlot):
    """The values of a lane, over its goals and, between the legs, where healthy people are."""

    def __init__(self) -> None:
        super().__init__(LEAST_HEIGHT)
        self.lane: CourseLane | None = None

    def show_lane(self, lane: CourseLane, visits: Sequence[CourseVisit]) -> None:
        self.lane, self.visits, self._number = lane, tuple(visits), None
        self.update()

    def y_of(self, value: float) -> float:
        assert self.lane is not None
        plot, scale = self.plot, LaneScale.of(self.lane)
        return plot.bottom() - (value - scale.low) / (scale.high - scale.low) * plot.height()

    def painted_texts(self) -> list[PaintedText]:
        """The goals' words over their lines, under those too near the top, at the end that is freer."""
        if self.lane is None:
            return []
        theme, texts = current_theme(), []
        for goal in self.lane.goals:
            line, y = theme.px(GOAL_LINE), self.y_of(goal.value)
            top = y - line if y >= line else y
            box = QRectF(0, top, self.width(), line)
            align = LEFT if self._is_free(box, at_left=True) or not self._is_free(box, at_left=False) else RIGHT
            texts.append(PaintedText(goal_mark(goal), box, theme.font(12), "ink2", align))
        return texts

    def draw(self, painter: QPainter) -> None:
        if self.lane is None:
            return
        theme, plot = current_theme(), self.plot
        if self.lane.healthy is not None:
            low, high = (self.y_of(end) for end in self.lane.healthy)
            painter.fillRect(QRectF(plot.left(), high, plot.width(), low - high), QColor(theme.colours.band_2sd))
            painter.setPen(theme.pen(theme.colours.control, 1))
            painter.drawLine(QPointF(plot.left(), self.y_of(0.0)), QPointF(plot.right(), self.y_of(0.0)))
        self.paint_pointer(painter)
        painter.setPen(_goal_pen(theme))
        for value in self.lane.goal_values:
            painter.drawLine(QPointF(plot.left(), self.y_of(value)), QPointF(plot.right(), self.y_of(value)))
        for line in self.lane.lines:
            self._paint_line(painter, line)

    def _is_free(self, box: QRectF, *, at_left: bool) -> bool:
        """Whether no value lies where words at one end of a line would."""
        assert self.lane is not None
        words = box.adjusted(0, 0, -box.width() * 0.6, 0) if at_left else box.adjusted(box.width() * 0.6, 0, 0, 0)
        return not any(words.contains(self._at(point)) for line in self.lane.lines for point in line.reported)

    def _paint_line(self, painter: QPainter, line: LaneLine) -> None:
        """Adjacent points are joined; what lies beyond a visit that cannot be read is not, and that has a tick."""
        theme = current_theme()
        colour = QColor(theme.colours.ink) if line.side is None else theme.curve(line.side)
        painter.setPen(theme.side_pen(line.side, 2) if line.side is not None else theme.pen(colour, 2))
        for one, other in pairwise(line.points):
            if one.is_reported and other.is_reported:
                painter.drawLine(self._at(one), self._at(other))
        painter.setPen(theme.pen(theme.colours.ink2, 1.25))
        for point in line.points:
            if not point.is_reported:
                x, foot = self.x_of(point.visit), float(self.height())
                painter.drawLine(QPointF(x, foot - theme.px(NOT_REPORTED)), QPointF(x, foot))
        painter.setPen(theme.pen(colour, 2))
        for point in line.reported:
            is_last = point is line.points[-1]
            painter.setBrush(colour if is_last else QColor(theme.colours.surface))
            radius = (LAST_DOT if is_last else DOT) * theme.scale
            painter.drawEllipse(self._at(point), radius, radius)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _at(self, point: LanePoint) -> QPointF:
        return QPointF(self.x_of(point.visit), self.y_of(point.value))


class DateAxis(DatedPlot):
    """The day of every visit; those that would touch are left out, the first and the last stay."""

    def __init__(self) -> None:
        super().__init__(DATES)

    def show_visits(self, visits: Sequence[CourseVisit]) -> None:
        self.visits, self._number = tuple(visits), None
        self.update()

    def labels(self) -> dict[int, PaintedText]:
        """The dates that find room, by the number of their visit."""
        font = current_theme().font(12)
        metrics, gap, last = QFontMetrics(font), px(8), len(self.visits) - 1
        kept: dict[int, PaintedText] = {}
        for number in sorted(range(len(self.visits)), key=lambda k: (k not in (0, last), k != last, k)):
            words = day_of(number, self.visits)
            width = metrics.horizontalAdvance(words) + 2
            left = min(max(self.x_of(number) - width / 2, 0), self.width() - width)
            box = QRectF(left, 0, width, self.height())
            if not any(box.adjusted(-gap, 0, gap, 0).intersects(other.box) for other in kept.values()):
                kept[number] = PaintedText(words, box, font, "ink2", CENTRE)
        return {number: kept[number] for number in sorted(kept)}

    def painted_texts(self) -> list[PaintedText]:
        return list(self.labels().values())


def _goal_pen(theme: Theme) -> QPen:
    pen = theme.pen(theme.colours.ink, 1.75)
    pen.setStyle(Qt.PenStyle.DotLine)
    return pen
