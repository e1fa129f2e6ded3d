"""Painting on the screen: the parts of a chart in the theme's colours."""

from collections.abc import Mapping, Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter, QPolygonF

from app.charts.cycles import PERCENT
from app.charts.frame import Frame
from app.charts.marks import Deviation, Gap, Point
from app.charts.places import USUAL_EMPTY_PERCENT, Box, Ground, MarkPlace, place_mark
from app.icons import Icon, paint_icon
from app.tokens import Theme
from core.body import Side
from core.samples import FloatArray

BAR_PX, HAIRLINE_PX, DOT_RADIUS, DOT_EDGE_PX = 2.5, 1.0, 5.0, 2.0
LINE_HEIGHT, WORDS_SIZE, TRIANGLE, TRIANGLE_APART = 16, 12, 16, 4
GAP_BAR, GAP_ROW, LETTER_APART = 4, 6, 4
AT_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
AT_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter


def polygon(x: FloatArray, y: FloatArray) -> QPolygonF:
    return QPolygonF([QPointF(*at) for at in zip(x.tolist(), y.tolist(), strict=True)])


def place_deviation(theme: Theme, ground: Ground, deviation: Deviation) -> MarkPlace:
    """Where a difference finds room, in px."""
    frame = ground.frame
    ends = [(float(frame.x(point.percent)), float(frame.y(point.angle_deg))) for point in deviation.points]
    first = QFontMetrics(_font(theme, is_first=True)).horizontalAdvance(deviation.words) + 1
    first += theme.px(TRIANGLE + TRIANGLE_APART) if deviation.is_larger_than_error else 0
    second = QFontMetrics(_font(theme, is_first=False)).horizontalAdvance(deviation.more) + 1
    line = theme.px(LINE_HEIGHT)
    sizes = [(first, line), (max(first, second), 2 * line)] if deviation.more else [(first, line)]
    return place_mark(ground, ends, sizes, USUAL_EMPTY_PERCENT[deviation.is_knee])


def paint_deviation(painter: QPainter, theme: Theme, frame: Frame, deviation: Deviation, place: MarkPlace) -> None:
    """Dots on both points, hairlines to the bar between their heights, and the words beside it."""
    colour = theme.colours.ink if deviation.is_larger_than_error else theme.colours.control
    for point in deviation.points:
        x, y = float(frame.x(point.percent)), float(frame.y(point.angle_deg))
        painter.setPen(theme.pen(colour, HAIRLINE_PX))
        painter.drawLine(QPointF(x, y), QPointF(place.bar_x, y))
    painter.setPen(theme.pen(colour, BAR_PX))
    painter.drawLine(QPointF(place.bar_x, place.top), QPointF(place.bar_x, place.bottom))
    for point in deviation.points:
        _paint_dot(painter, theme, frame, point)
    _paint_words(painter, theme, deviation, place)


def paint_gaps(
    painter: QPainter, theme: Theme, frame: Frame, gaps: Sequence[Gap], curves: Mapping[Side, FloatArray]
) -> None:
    """Fill what lies between each curve (101,) and the limit that it leaves."""
    painter.setPen(Qt.PenStyle.NoPen)
    for gap in gaps:
        at = slice(gap.first_percent, gap.last_percent + 1)
        x, curve, limit = frame.x(PERCENT[at]), frame.y(curves[gap.joint.side][at]), frame.y(gap.limit_deg[at])
        painter.setBrush(theme.soft(gap.joint.side))
        painter.drawPolygon(polygon(np.concatenate([x, x[::-1]]), np.concatenate([curve, limit[::-1]])))
    painter.setBrush(Qt.BrushStyle.NoBrush)


def paint_gap_bars(painter: QPainter, theme: Theme, frame: Frame, gaps: Sequence[Gap]) -> None:
    """Mark the gaps on the axis by bars, the right leg's above the left one's; the longest has its letter."""
    for gap in gaps:
        painter.fillRect(_rect(_gap_bar(theme, frame, gap)), theme.curve(gap.joint.side))
    painter.setFont(_font(theme, is_first=True))
    for gap, box in _gap_letters(theme, frame, gaps):
        painter.setPen(theme.text(gap.joint.side))
        painter.drawText(_rect(box), AT_LEFT, gap.joint.side[0].upper())


def gap_boxes(theme: Theme, frame: Frame, gaps: Sequence[Gap]) -> list[Box]:
    """What the gaps' bars and letters take, px."""
    return [_gap_bar(theme, frame, gap) for gap in gaps] + [box for _, box in _gap_letters(theme, frame, gaps)]


def _gap_bar(theme: Theme, frame: Frame, gap: Gap) -> Box:
    bottom = frame.bottom - (theme.px(GAP_ROW) if gap.joint.side is Side.RIGHT else 0)
    left, right = (float(frame.x(percent)) for percent in (gap.first_percent, gap.last_percent))
    return Box(left, bottom - theme.px(GAP_BAR), right, bottom)


def _gap_letters(theme: Theme, frame: Frame, gaps: Sequence[Gap]) -> list[tuple[Gap, Box]]:
    """At the longest bar of each leg, right of it where there is room; higher where the other letter stands there."""
    metrics, height, apart = QFontMetrics(_font(theme, is_first=True)), theme.px(LINE_HEIGHT), theme.px(LETTER_APART)
    letters: list[tuple[Gap, Box]] = []
    for side in Side:
        of_side = [gap for gap in gaps if gap.joint.side is side]
        if not of_side:
            continue
        longest = max(of_side, key=lambda gap: gap.last_percent - gap.first_percent)
        bar, width = _gap_bar(theme, frame, longest), metrics.horizontalAdvance(side[0].upper()) + 1
        left = bar.right + apart if bar.right + apart + width <= frame.right else bar.left - apart - width
        box = Box(left, frame.bottom - height, left + width, frame.bottom)
        obstacles = [other for _, other in letters] + [_gap_bar(theme, frame, gap) for gap in gaps]
        while any(map(box.overlaps, obstacles)):
            box = Box(box.left, box.top - apart, box.right, box.bottom - apart)
        letters.append((longest, box))
    return letters


def _rect(box: Box) -> QRectF:
    return QRectF(QPointF(box.left, box.top), QPointF(box.right, box.bottom))


def _paint_dot(painter: QPainter, theme: Theme, frame: Frame, point: Point) -> None:
    """Left filled, right outlined."""
    side, centre = point.joint.side, QPointF(float(frame.x(point.percent)), float(frame.y(point.angle_deg)))
    colour, surface = theme.curve(side), QColor(theme.colours.surface)
    is_left = side is Side.LEFT
    painter.setPen(theme.pen(surface if is_left else colour, DOT_EDGE_PX))
    painter.setBrush(colour if is_left else surface)
    painter.drawEllipse(centre, DOT_RADIUS * theme.scale, DOT_RADIUS * theme.scale)
    painter.setBrush(Qt.BrushStyle.NoBrush)


def _paint_words(painter: QPainter, theme: Theme, deviation: Deviation, place: MarkPlace) -> None:
    if place.words is None:
        return
    box, line, c = place.words, theme.px(LINE_HEIGHT), theme.colours
    align = AT_LEFT if place.are_words_at_right else AT_RIGHT
    left = box.left
    if deviation.is_larger_than_error:
        side = theme.px(TRIANGLE)
        width = QFontMetrics(_font(theme, is_first=True)).horizontalAdvance(deviation.words) + 1
        at = left if place.are_words_at_right else box.right - width - theme.px(TRIANGLE_APART) - side
        paint_icon(painter, Icon.WARNING, QRectF(at, box.top + (line - side) / 2, side, side), c.ink)
        left = at + side + theme.px(TRIANGLE_APART)
    painter.setFont(_font(theme, is_first=True))
    painter.setPen(QColor(c.ink))
    painter.drawText(QRectF(left, box.top, box.right - left, line), align, deviation.words)
    if place.lines > 1:
        painter.setFont(_font(theme, is_first=False))
        painter.setPen(QColor(c.ink2))
        painter.drawText(QRectF(box.left, box.top + line, box.right - box.left, line), align, deviation.more)


def _font(theme: Theme, *, is_first: bool) -> QFont:
    return theme.font(WORDS_SIZE, QFont.Weight.DemiBold if is_first else QFont.Weight.Normal)
