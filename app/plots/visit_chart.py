"""How did the knee's range change from visit to visit? One point per visit and leg, at its date."""

import datetime
from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPaintEvent, QPolygonF
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme import Look
from app.wording import side_name, tr
from core.body import Side

HEIGHT = 132
AXIS, BELOW = 36, 28  # px for the figures at the left and the dates below
STEP_DEG = 10
LEAST_SPAN_DEG = 20
DOT = 5


@dataclass(frozen=True, slots=True)
class VisitRange:
    """The knee's range of one visit; None for a leg that was not measured. `label` is the visit's date in words."""

    day: datetime.date
    label: str
    left_deg: float | None
    right_deg: float | None

    def of(self, side: Side) -> float | None:
        return self.left_deg if side is Side.LEFT else self.right_deg


class VisitChart(QWidget):
    """Left: solid with filled points; right: dashed with open ones."""

    def __init__(self, look: Look) -> None:
        super().__init__()
        self._look = look
        self._visits: Sequence[VisitRange] = ()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        look.changed.connect(self._on_look_changed)

    def show_visits(self, visits: Sequence[VisitRange]) -> None:
        self._visits = sorted(visits, key=lambda visit: visit.day)
        said = [
            tr("{date}: {side} {value}°").format(date=visit.label, side=side_name(side), value=f"{value:.1f}")
            for visit in self._visits
            for side in Side
            if (value := visit.of(side)) is not None
        ]
        self.setAccessibleName(tr("Knee range by visit"))
        self.setAccessibleDescription(", ".join(said))
        self.update()

    @property
    def limits_deg(self) -> tuple[int, int]:
        """The ends of the axis: whole tens round all values."""
        values = [value for visit in self._visits for side in Side if (value := visit.of(side)) is not None]
        if not values:
            return 0, LEAST_SPAN_DEG
        low = int(min(values) // STEP_DEG) * STEP_DEG
        high = -int(-max(values) // STEP_DEG) * STEP_DEG
        return low, max(high, low + LEAST_SPAN_DEG)

    def sizeHint(self) -> QSize:
        px = self._look.theme.px
        return QSize(px(240), px(HEIGHT))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def paintEvent(self, _event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        frame = self._frame()
        self._paint_axis(painter, frame)
        self._paint_dates(painter, frame)
        for side in (Side.RIGHT, Side.LEFT):
            self._paint_side(painter, frame, side)

    def point(self, visit: VisitRange, value_deg: float) -> QPointF:
        """The place of a value."""
        frame = self._frame()
        first, last = self._visits[0].day, self._visits[-1].day
        days = (last - first).days
        share = (visit.day - first).days / days if days else 0.5
        low, high = self.limits_deg
        return QPointF(
            frame.left() + share * frame.width(), frame.bottom() - (value_deg - low) / (high - low) * frame.height()
        )

    def _frame(self) -> QRectF:
        px = self._look.theme.px
        return QRectF(self.rect()).adjusted(px(AXIS), px(8), -px(AXIS), -px(BELOW))

    def _paint_axis(self, painter: QPainter, frame: QRectF) -> None:
        theme = self._look.theme
        painter.setFont(theme.font(12))
        low, high = self.limits_deg
        step = STEP_DEG if (high - low) <= 4 * STEP_DEG else 2 * STEP_DEG
        for value in range(low, high + 1, step):
            y = frame.bottom() - (value - low) / (high - low) * frame.height()
            painter.setPen(theme.pen(theme.colours.line, 1))
            painter.drawLine(QPointF(frame.left(), y), QPointF(frame.right(), y))
            painter.setPen(QColor(theme.colours.ink2))
            box = QRectF(0, y - theme.px(10), frame.left() - theme.px(12), theme.px(20))
            painter.drawText(box, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, str(value))

    def _paint_dates(self, painter: QPainter, frame: QRectF) -> None:
        """Name the first and the last visit, and what fits between."""
        theme = self._look.theme
        metrics = QFontMetrics(theme.font(12))
        painter.setFont(theme.font(12))
        painter.setPen(QColor(theme.colours.ink2))
        taken: list[tuple[float, float]] = []
        order = [*self._visits[:1], *self._visits[:0:-1]]
        for visit in order:
            width = metrics.horizontalAdvance(visit.label)
            x = self.point(visit, 0).x() - width / 2
            x = min(max(x, 0.0), self.width() - width)
            if all(x > right + theme.px(12) or x + width < left - theme.px(12) for left, right in taken):
                taken.append((x, x + width))
                box = QRectF(x, frame.bottom() + theme.px(6), width, theme.px(20))
                painter.drawText(box, Qt.AlignmentFlag.AlignCenter, visit.label)

    def _paint_side(self, painter: QPainter, frame: QRectF, side: Side) -> None:
        theme = self._look.theme
        points = [self.point(visit, value) for visit in self._visits if (value := visit.of(side)) is not None]
        painter.setPen(theme.side_pen(side, 2))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolyline(QPolygonF(points))
        painter.setPen(theme.pen(theme.curve(side), 2))
        painter.setBrush(theme.curve(side) if side is Side.LEFT else QColor(theme.colours.surface))
        for point in points:
            painter.drawEllipse(point, theme.px(DOT), theme.px(DOT))

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.update()
