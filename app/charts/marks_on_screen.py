"""Painting marks on the screen: brackets, values at peaks, boxes of hidden curves, and gaps with their bars."""

from collections.abc import Sequence

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QFontMetrics, QFontMetricsF, QPainter, QPainterPath

from app.charts.cycles import PERCENT
from app.charts.frame import Frame
from app.charts.marks import CurveLabel, Deviation, Gap, HiddenCurve, Point
from app.charts.places import Box, Layout, MarkPlace, Size, Sizes, ground_of, layout_of
from app.charts.stride_chart import StrideChart
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.theme import CHIP_RADIUS, Theme
from app.wording.verdicts import verdict_alone
from core.body import Side
from core.verdicts.model import Verdict

BAR_PX, HAIRLINE_PX, LABEL_DOT, LABEL_DOT_EDGE_PX, HALO_PX = 2.5, 1.0, 4.0, 1.75, 3.5
LINE_HEIGHT, FIRST_SIZE, WORDS_SIZE = 16, 13, 12
HIDDEN_HEIGHT, HIDDEN_PADDING = 46, 10
GAP_BAR, GAP_ROW, LETTER_APART = 4, 6, 4
AT_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
AT_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter


def layout_on_screen(theme: Theme, frame: Frame, chart: StrideChart) -> Layout:
    """Where all words of a chart find room, px."""
    line, small = theme.px(LINE_HEIGHT), QFontMetrics(_font(theme, is_first=False))
    first = QFontMetrics(_font(theme, is_first=True))

    def of_label(label: CurveLabel) -> Size:
        return first.horizontalAdvance(label.text) + 1 + theme.px(HALO_PX), line

    def of_bracket(bracket: Deviation) -> list[Size]:
        words, more = first.horizontalAdvance(bracket.words) + 1, small.horizontalAdvance(bracket.more) + 1
        return [(words, line), (max(words, more), 2 * line)] if bracket.more else [(words, line)]

    def of_hidden(hidden: HiddenCurve) -> Size:
        words = max(first.horizontalAdvance(_not_reported()), small.horizontalAdvance(hidden.reason))
        return theme.px(3 * HIDDEN_PADDING + CHIP) + words + 1, theme.px(HIDDEN_HEIGHT)

    ground = ground_of(frame, chart, _gap_boxes(theme, frame, chart.gaps))
    return layout_of(ground, chart, Sizes(of_label, of_bracket, of_hidden, theme.px(LABEL_DOT + LABEL_DOT_EDGE_PX)))


def paint_bracket(painter: QPainter, theme: Theme, frame: Frame, bracket: Deviation, place: MarkPlace) -> None:
    """Dots on both points, hairlines to the bar between their heights, and the words beside it."""
    colour = theme.colours.ink if bracket.is_larger_than_error else theme.colours.control
    for point in bracket.points:
        at = _at(frame, point)
        painter.setPen(theme.pen(colour, HAIRLINE_PX))
        painter.drawLine(at, QPointF(place.bar_x, at.y()))
    painter.setPen(theme.pen(colour, BAR_PX))
    painter.drawLine(QPointF(place.bar_x, place.top), QPointF(place.bar_x, place.bottom))
    for point in bracket.points:
        _paint_dot(painter, theme, frame, point)
    if (box := place.words) is None:
        return
    line, align = theme.px(LINE_HEIGHT), AT_LEFT if place.are_words_at_right else AT_RIGHT
    for row, (text, tone) in enumerate(((bracket.words, theme.colours.ink), (bracket.more, theme.colours.ink2))):
        if row < place.lines:
            room = QRectF(box.left, box.top + row * line, box.right - box.left, line)
            _paint_haloed(painter, theme, room, align, text, QColor(tone), is_first=row == 0)


def paint_label(painter: QPainter, theme: Theme, frame: Frame, label: CurveLabel, box: Box | None) -> None:
    """A dot on the curve, and the value beside it in the leg's colour."""
    _paint_dot(painter, theme, frame, label.point)
    if box is not None:
        centre = Qt.AlignmentFlag.AlignCenter
        _paint_haloed(painter, theme, _rect(box), centre, label.text, theme.text(label.side), is_first=True)


def paint_hidden(painter: QPainter, theme: Theme, hidden: HiddenCurve, box: Box) -> None:
    """A hatched box with the leg's chip, so that nobody takes it for a curve."""
    room, padding, chip = _rect(box), theme.px(HIDDEN_PADDING), theme.px(CHIP)
    radius = CHIP_RADIUS * theme.scale
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(theme.colours.surface))
    painter.drawRoundedRect(room, radius, radius)
    pen = theme.pen(theme.colours.control, 1)
    pen.setDashPattern([4.0, 3.0])
    painter.setPen(pen)
    painter.setBrush(QBrush(QColor(theme.colours.line), Qt.BrushStyle.BDiagPattern))
    painter.drawRoundedRect(room, radius, radius)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    paint_chip(painter, QRectF(box.left + padding, room.center().y() - chip / 2, chip, chip), hidden.side, theme)
    lines, line = [text for text in (_not_reported(), hidden.reason) if text], theme.px(LINE_HEIGHT)
    top = room.center().y() - line * len(lines) / 2
    for row, text in enumerate(lines):
        words = QRectF(box.left + 2 * padding + chip, top + row * line, room.width() - 3 * padding - chip + 1, line)
        _paint_haloed(painter, theme, words, AT_LEFT, text, QColor(theme.colours.ink), is_first=row == 0)


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
    painter.setPen(theme.pen(surface if is_left else colour, LABEL_DOT_EDGE_PX))
    painter.setBrush(colour if is_left else surface)
    painter.drawEllipse(centre, LABEL_DOT * theme.scale, LABEL_DOT * theme.scale)
    painter.setBrush(Qt.BrushStyle.NoBrush)


def _paint_haloed(
    painter: QPainter, theme: Theme, room: QRectF, align: Qt.AlignmentFlag, text: str, colour: QColor, *, is_first: bool
) -> None:
    """Words that are read over curves and bands, for what is about them is the surface's colour."""
    font = _font(theme, is_first=is_first)
    metrics = QFontMetricsF(font)
    left = room.left()
    if align & Qt.AlignmentFlag.AlignRight:
        left = room.right() - metrics.horizontalAdvance(text)
    elif align & Qt.AlignmentFlag.AlignHCenter:
        left = room.center().x() - metrics.horizontalAdvance(text) / 2
    letters = QPainterPath()
    letters.addText(QPointF(left, room.center().y() + metrics.capHeight() / 2), font, text)
    painter.strokePath(letters, theme.pen(theme.colours.surface, HALO_PX))
    painter.fillPath(letters, colour)


def _not_reported() -> str:
    return verdict_alone(Verdict.NOT_REPORTED)


def _font(theme: Theme, *, is_first: bool) -> QFont:
    return theme.font(FIRST_SIZE, QFont.Weight.DemiBold) if is_first else theme.font(WORDS_SIZE)


def _at(frame: Frame, point: Point) -> QPointF:
    return QPointF(float(frame.x(point.percent)), float(frame.y(point.angle_deg)))
