"""The cell of a table that shows a value over time: a small line with its points."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath

from app.theme.theme import Theme
from app.widgets.table_cells import TableCell
from core.body import Side

WIDTH, HEIGHT = 112, 20
DOT, LAST = 2.25, 3.5  # px: radius of a point, and of the last one
LINE = 1.75


@dataclass(frozen=True, slots=True)
class TrendCell(TableCell):
    """Values at `places` between 0 and 1, over `band` in grey; `edges` are the values below and above.

    NaN is a gap: adjacent values are joined, those on either side of one are not. The last value is the larger
    point, so that its absence is seen. `side` gives the colour and the dashes of a leg. `goals` are dotted lines.
    """

    places: tuple[float, ...]
    values: tuple[float, ...]
    edges: tuple[float, float]
    band: tuple[float, float] | None = None
    side: Side | None = None
    spoken: str = ""
    goals: tuple[float, ...] = ()

    @property
    def stated(self) -> str:
        return self.spoken

    def width(self, theme: Theme) -> int:
        return theme.px(WIDTH)

    def points(self, room: QRectF, theme: Theme) -> tuple[QPointF | None, ...]:
        """Where the values lie; None for a gap."""
        inset = LAST * theme.scale + 1
        left, width = room.left() + inset, room.width() - 2 * inset
        return tuple(
            QPointF(left + place * width, self._y(value, room, theme)) if math.isfinite(value) else None
            for place, value in zip(self.places, self.values, strict=True)
        )

    def paint(self, painter: QPainter, room: QRectF, theme: Theme) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self.band is not None:
            low, high = (self._y(value, room, theme) for value in self.band)
            painter.fillRect(QRectF(room.left(), high, room.width(), low - high), QColor(theme.colours.band_2sd))
        dotted = theme.pen(theme.colours.ink, 1.25)
        dotted.setStyle(Qt.PenStyle.DotLine)
        painter.setPen(dotted)
        for value in self.goals:
            height = self._y(value, room, theme)
            painter.drawLine(QPointF(room.left(), height), QPointF(room.right(), height))
        points = self.points(room, theme)
        colour = QColor(theme.colours.ink) if self.side is None else theme.curve(self.side)
        pen = theme.pen(colour, LINE) if self.side is None else theme.side_pen(self.side, LINE)
        painter.strokePath(_line(points), pen)
        painter.setPen(theme.pen(colour, 1))
        painter.setBrush(colour)
        for number, point in enumerate(points, start=1):
            if point is not None:
                radius = (LAST if number == len(points) else DOT) * theme.scale
                painter.drawEllipse(point, radius, radius)

    def _y(self, value: float, room: QRectF, theme: Theme) -> float:
        """Such that a point at either edge is seen whole."""
        low, high = self.edges
        share = (value - low) / (high - low) - 0.5 if high > low else 0.0
        return room.center().y() - share * (theme.px(HEIGHT) - 2 * LAST * theme.scale)


def _line(points: Sequence[QPointF | None]) -> QPainterPath:
    """In one path, so that dashes go on over its points."""
    path = QPainterPath()
    for one, other in pairwise(points):
        if one is not None and other is not None:
            if path.isEmpty() or path.currentPosition() != one:
                path.moveTo(one)
            path.lineTo(other)
    return path
