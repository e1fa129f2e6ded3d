"""The screen's canvas, and gaps with their bars, which are the screen's alone."""

from collections.abc import Sequence

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QFontMetrics, QFontMetricsF, QPainter, QPainterPath, QPen

from app.charts.canvas import Anchor, Lengths, Tone
from app.charts.cycles import PERCENT
from app.charts.frame import Frame
from app.charts.marks import Gap
from app.charts.places import Box, Layout, layout_of
from app.charts.stride_chart import StrideChart
from app.theme.leg_chip import CHIP, paint_chip
from app.theme.theme import CHIP_RADIUS, Theme
from core.body import Side

TICKS_HEIGHT, TICK = 24, 4
BAR_PX, HAIRLINE_PX, LABEL_DOT, LABEL_DOT_EDGE_PX, HALO_PX = 2.5, 1.0, 4.0, 1.75, 3.5
LINE_HEIGHT, FIRST_SIZE, WORDS_SIZE = 16, 13, 12
HIDDEN_HEIGHT, HIDDEN_PADDING = 46, 10
GAP_BAR, GAP_ROW, LETTER_APART = 4, 6, 4
FAR = 1000.0  # px: a text is aligned in a room that is larger than it
ALIGN: dict[Anchor, Qt.AlignmentFlag] = {
    "start": Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter,
    "middle": Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignVCenter,
    "end": Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter,
}
BEFORE: dict[Anchor, float] = {"start": 0.0, "middle": 0.5, "end": 1.0}  # share of a text that is left of its place


class ScreenCanvas:
    """Draws with a painter, in the theme's colours; an unused painter does for measuring."""

    def __init__(self, painter: QPainter, theme: Theme) -> None:
        self._painter, self._theme = painter, theme
        c, px = theme.colours, theme.px
        self._tones = {Tone.INK: c.ink, Tone.NOTE: c.ink2, Tone.AXIS: c.control, Tone.INSIDE_ERROR: c.control}
        self.lengths = Lengths(
            tick=px(TICK),
            label_apart=2 * px(TICK),
            percents_below=px(TICK) + (px(TICKS_HEIGHT) - px(TICK)) / 2,
            zero=HAIRLINE_PX,
            axis=HAIRLINE_PX,
            bar=BAR_PX,
            leader=HAIRLINE_PX,
            dot=px(LABEL_DOT + LABEL_DOT_EDGE_PX),
            halo=px(HALO_PX),
            line=px(LINE_HEIGHT),
            chip=px(CHIP),
            hidden_padding=px(HIDDEN_PADDING),
            hidden_margins=px(3 * HIDDEN_PADDING + CHIP),
            hidden_height=px(HIDDEN_HEIGHT),
        )

    def stroke(self, start: tuple[float, float], end: tuple[float, float], tone: Tone, width: float) -> None:
        pen = self._theme.pen(self._tones[tone], width)
        self._painter.setPen(flat(pen) if tone is Tone.AXIS else pen)
        self._painter.drawLine(QPointF(*start), QPointF(*end))

    def label(self, x: float, middle: float, stated: str, anchor: Anchor) -> None:
        self._painter.setFont(self._theme.font(WORDS_SIZE))
        self._painter.setPen(QColor(self._theme.colours.ink2))
        room = QRectF(x - 2 * FAR * BEFORE[anchor], middle - FAR, 2 * FAR, 2 * FAR)
        self._painter.drawText(room, ALIGN[anchor], stated)

    def words(self, x: float, middle: float, stated: str, anchor: Anchor, tone: Tone | Side, *, is_first: bool) -> None:
        font = _font(self._theme, is_first=is_first)
        metrics, letters = QFontMetricsF(font), QPainterPath()
        left = x - BEFORE[anchor] * metrics.horizontalAdvance(stated)
        letters.addText(QPointF(left, middle + metrics.capHeight() / 2), font, stated)
        self._painter.strokePath(letters, self._theme.pen(self._theme.colours.surface, HALO_PX))
        colour = self._theme.text(tone) if isinstance(tone, Side) else QColor(self._tones[tone])
        self._painter.fillPath(letters, colour)

    def width_of(self, stated: str, *, is_first: bool) -> float:
        return QFontMetrics(_font(self._theme, is_first=is_first)).horizontalAdvance(stated) + 1

    def dot(self, x: float, y: float, side: Side) -> None:
        theme, is_left = self._theme, side is Side.LEFT
        colour, surface = theme.curve(side), QColor(theme.colours.surface)
        self._painter.setPen(theme.pen(surface if is_left else colour, LABEL_DOT_EDGE_PX))
        self._painter.setBrush(colour if is_left else surface)
        self._painter.drawEllipse(QPointF(x, y), LABEL_DOT * theme.scale, LABEL_DOT * theme.scale)
        self._painter.setBrush(Qt.BrushStyle.NoBrush)

    def chip(self, left: float, middle: float, side: Side) -> None:
        size = self._theme.px(CHIP)
        paint_chip(self._painter, QRectF(left, middle - size / 2, size, size), side, self._theme)

    def hatched_box(self, left: float, top: float, width: float, height: float) -> None:
        theme, painter, room = self._theme, self._painter, QRectF(left, top, width, height)
        theme.paint_box(painter, room, theme.colours.surface, radius=CHIP_RADIUS)
        pen = theme.pen(theme.colours.control, 1)
        pen.setDashPattern([4.0, 3.0])
        painter.setPen(pen)
        painter.setBrush(QBrush(QColor(theme.colours.line), Qt.BrushStyle.BDiagPattern))
        painter.drawRoundedRect(room, CHIP_RADIUS * theme.scale, CHIP_RADIUS * theme.scale)
        painter.setBrush(Qt.BrushStyle.NoBrush)


def flat(pen: QPen) -> QPen:
    pen.setCapStyle(Qt.PenCapStyle.FlatCap)
    return pen


def layout_on_screen(theme: Theme, frame: Frame, chart: StrideChart) -> Layout:
    """Where all words of a chart find room, px."""
    return layout_of(ScreenCanvas(QPainter(), theme), frame, chart, _gap_boxes(theme, frame, chart.gaps))


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
        painter.drawText(_rect(box), ALIGN["start"], gap.joint.side.letter)


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


def _font(theme: Theme, *, is_first: bool) -> QFont:
    return theme.font(FIRST_SIZE, QFont.Weight.DemiBold) if is_first else theme.font(WORDS_SIZE)
