"""Painting marks on the screen: differences with their words, and gaps with their bars on the axis."""

from collections.abc import Sequence

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter

from app.charts.cycles import PERCENT
from app.charts.frame import Frame
from app.charts.marks import Deviation, Gap, Point
from app.charts.places import USUAL_EMPTY_PERCENT, Box, Ground, MarkPlace, ground_of, place_mark
from app.charts.stride_chart import StrideChart
from app.theme.icons import Icon, paint_icon
from app.theme.theme import Theme
from core.body import Side

BAR_PX, HAIRLINE_PX, DOT_RADIUS, DOT_EDGE_PX = 2.5, 1.0, 5.0, 2.0
LINE_HEIGHT, WORDS_SIZE, TRIANGLE, TRIANGLE_APART = 16, 12, 16, 4
GAP_BAR, GAP_ROW, LETTER_APART = 4, 6, 4
AT_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
AT_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter


def places_of(theme: Theme, frame: Frame, chart: StrideChart) -> list[MarkPlace]:
    """Where each deviation finds room, px."""
    ground = ground_of(frame, chart, _gap_boxes(theme, frame, chart.gaps))
    return [_place_deviation(theme, ground, deviation) for deviation in chart.deviations]


def _place_deviation(theme: Theme, ground: Ground, deviation: Deviation) -> MarkPlace:
    """Where a difference finds room, in px."""
    frame = ground.frame
    ends = [(float(frame.x(point.percent)), float(frame.y(point.angle_deg))) for point in deviation.points]
    first = QFontMetrics(_font(theme, is_first=True)).horizontalAdvance(deviation.words) + 1
    first += theme.px(TRIANGLE + TRIANGLE_APART) if deviation.is_larger_than_error else 0
    second = QFontMetrics(_font(theme, is_first=False)).horizontalAdvance(deviation.more) + 1
    line = theme.px(LINE_HEIGHT)
    sizes = [(first, line), (max(first, second), 2 * line)] if deviation.more else [(first, line)]
    return place_mark(ground, ends, sizes, USUAL_EMPTY_PERCENT[deviation.kind])


def paint_deviation(painter: QPainter, theme: Theme, frame: Frame, deviation: Deviation, place: MarkPlace) -> None:
    """Dots on both points, hairlines to the bar between their heights, and the words beside it."""
    colour = theme.colours.ink if deviation.is_larger_than_error else theme.colours.control
    for point in deviation.points:
        at = _at(frame, point)
        painter.setPen(theme.pen(colour, HAIRLINE_PX))
        painter.drawLine(at, QPointF(place.bar_x, at.y()))
    painter.setPen(theme.pen(colour, BAR_PX))
    painter.drawLine(QPointF(place.bar_x, place.top), QPointF(place.bar_x, place.bottom))
    for point in deviation.points:
        _paint_dot(painter, theme, frame, point)
    _paint_words(painter, theme, deviation, place)


def paint_gaps(painter: QPainter, theme: Theme, frame: Frame, chart: StrideChart) -> None:
    """Fill what lies between each curve and the limit that it leaves."""
    curves = {curve.side: curve.angle_deg for curve in chart.curves}
    painter.setPen(Qt.PenStyle.NoPen)
    for gap in chart.gaps:
        at = slice(gap.first_percent, gap.last_percent + 1)
        there_and_back = np.concatenate([PERCENT[at], PERCENT[at][::-1]])
        outline = np.concatenate([curves[gap.joint.side][at], gap.limit_deg[at][::-1]])
        painter.setBrush(theme.soft(gap.joint.side))
        painter.drawPolygon(pg.functions.arrayToQPolygonF(frame.x(there_and_back), frame.y(outline)))
    painter.setBrush(Qt.BrushStyle.NoBrush)


def paint_gap_bars(painter: QPainter, theme: Theme, frame: Frame, gaps: Sequence[Gap]) -> None:
    """Mark the gaps on the axis by bars, the right leg's above the left one's; the longest has its letter."""
    for gap in gaps:
        painter.fillRect(_rect(_gap_bar(theme, frame, gap)), theme.curve(gap.joint.side))
    painter.setFont(_font(theme, is_first=True))
    for gap, box in _gap_letters(theme, frame, gaps):
        painter.setPen(theme.text(gap.joint.side))
        painter.drawText(_rect(box), AT_LEFT, gap.joint.side.letter)


def _gap_boxes(theme: Theme, frame: Frame, gaps: Sequence[Gap]) -> list[Box]:
    """What the gaps' bars and letters take, px."""
    return [_gap_bar(theme, frame, gap) for gap in gaps] + [box for _, box in _gap_letters(theme, frame, gaps)]


def _gap_bar(theme: Theme, frame: Frame, gap: Gap) -> Box:
    bottom = frame.bottom - (theme.px(GAP_ROW) if gap.joint.side is Side.RIGHT else 0)
    left, right = (float(frame.x(percent)) for percent in (gap.first_percent, gap.last_percent))
    return Box(left, bottom - theme.px(GAP_BAR), right, bottom)


def _gap_letters(theme: Theme, frame: Frame, gaps: Sequence[Gap]) -> list[tuple[Gap, Box]]:
    """At the longest bar of each leg, right of it where there is room; higher where the other letter is there."""
    metrics, height, apart = QFontMetrics(_font(theme, is_first=True)), theme.px(LINE_HEIGHT), theme.px(LETTER_APART)
    letters: list[tuple[Gap, Box]] = []
    for side in Side:
        of_side = [gap for gap in gaps if gap.joint.side is side]
        if not of_side:
            continue
        longest = max(of_side, key=lambda gap: gap.last_percent - gap.first_percent)
        bar, width = _gap_bar(theme, frame, longest), metrics.horizontalAdvance(side.letter) + 1
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
    side, centre = point.joint.side, _at(frame, point)
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
        paint_icon(painter, Icon.DIFFERENCE, QRectF(at, box.top + (line - side) / 2, side, side), c.ink)
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


def _at(frame: Frame, point: Point) -> QPointF:
    return QPointF(float(frame.x(point.percent)), float(frame.y(point.angle_deg)))
