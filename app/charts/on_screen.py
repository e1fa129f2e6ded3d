"""Painting on the screen: a chart of the stride in the theme's colours, its axes, curves, letters and marks."""

from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter, QPen, QPolygonF

from app.charts.cycles import PERCENT
from app.charts.frame import Frame
from app.charts.marks_on_screen import ALIGN, LINE_HEIGHT, TICKS_HEIGHT, ScreenCanvas, flat, paint_gap_bars, paint_gaps
from app.charts.places import Layout
from app.charts.stride_chart import StrideChart, StrideCurve, toe_off_labels, toe_offs_in_order
from app.charts.stride_drawing import draw_axes, draw_marks
from app.theme.theme import Theme
from app.wording.translation import later, tr
from core.body import Side
from core.samples import FloatArray

LABEL_HEIGHT = 24  # toe-off is above the plot
LEFT_MARGIN = 32
RIGHT_MARGIN = 24  # half of "100 %" is beside the plot, and SIMULATED upright
SIMULATED = later("SIMULATED")
MEAN_PX, CASING_PX, STRIDE_PX, TOE_OFF_PX = 2.5, 2.0, 1.0, 1.25
STRIDE_ALPHA = 0.7
SMOOTH_UP_TO = 40  # strides; smooth lines take ten times as long
FIRST_PX, LAST_PX, FIRST_ALPHA = 1.25, 2.75, 0.65  # of curves that are compared
COMPARED_TOE_OFF_PX, DASH_PX = 0.75, (9.0, 5.0)
DOT, LETTER_PX, LETTERS_APART = 10, 12, 4  # DOT: radius of a letter's circle
LEADER_PERCENT = 16  # from where the curves are read to their letters
CURSOR_PX, HANDLE = 1.5, (9, 6)


def frame_of(theme: Theme, width: float, height: float, chart: StrideChart) -> Frame:
    """The room inside the axes of a chart of this size, px."""
    left, top = theme.px(LEFT_MARGIN), theme.px(LABEL_HEIGHT)
    inside = width - left - theme.px(RIGHT_MARGIN), height - top - theme.px(TICKS_HEIGHT)
    return Frame(left, top, *inside, chart.axis.low, chart.axis.high)


def paint(painter: QPainter, theme: Theme, frame: Frame, width: float, chart: StrideChart) -> None:
    """Draw a chart whose plot is `frame`, in a widget of this width; what `paint_words` draws lies over it."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    if (band := chart.band) is not None:
        with _clipped(painter, frame):
            for sds, colour in ((2, theme.colours.band_2sd), (1, theme.colours.band_1sd)):
                _fill(painter, frame, band.mean_deg, sds * band.sd_deg, QColor(colour))
    draw_axes(ScreenCanvas(painter, theme), frame, chart.axis)
    with _clipped(painter, frame):
        paint_gaps(painter, theme, frame, chart)
        if chart.is_comparison:
            for curve in chart.curves:
                _paint_toe_off(painter, frame, curve, _pen(theme, curve, COMPARED_TOE_OFF_PX))
        for curve in chart.curves:
            _paint_strides(painter, theme, frame, curve)
        for curve in (*chart.beside, *_solid_last(chart)):
            if curve.is_known:
                _paint_mean(painter, theme, frame, curve)
        if chart.chosen is not None:
            _paint_chosen(painter, theme, frame, *chart.chosen)
    if chart.is_comparison:
        _paint_letters(painter, theme, frame, chart)
    else:
        _paint_toe_offs(painter, theme, frame, width, chart)
    if chart.is_simulated:
        _paint_simulated(painter, theme, frame, width)
    paint_gap_bars(painter, theme, frame, chart.gaps)


def paint_words(painter: QPainter, theme: Theme, frame: Frame, layout: Layout) -> None:
    """Draw what is read on the curves: brackets, values at peaks, boxes of hidden curves."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    draw_marks(ScreenCanvas(painter, theme), frame, layout)


def paint_cursor(painter: QPainter, theme: Theme, frame: Frame, percents: Collection[float]) -> None:
    """A line with a handle at each of these places, percent."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    ink, half, height = QColor(theme.colours.ink), theme.px(HANDLE[0]) / 2, theme.px(HANDLE[1])
    for percent in percents:
        x = float(frame.x(percent))
        painter.setPen(theme.pen(ink, CURSOR_PX))
        painter.drawLine(QPointF(x, frame.top), QPointF(x, frame.bottom))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(ink)
        corners = (x - half, frame.top), (x + half, frame.top), (x, frame.top + height)
        painter.drawPolygon(QPolygonF([QPointF(*corner) for corner in corners]))
    painter.setBrush(Qt.BrushStyle.NoBrush)


def paint_letter(
    painter: QPainter, theme: Theme, letter: str, centre: QPointF, colour: QColor, is_filled: bool
) -> None:
    """Draw a letter in its circle, filled or hollow."""
    c, radius = theme.colours, DOT * theme.scale
    painter.setPen(theme.pen(colour, 1.5))
    painter.setBrush(colour if is_filled else QColor(c.surface))
    painter.drawEllipse(centre, radius, radius)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QColor(c.ground if theme.is_dark else c.surface) if is_filled else colour)
    painter.setFont(theme.font(LETTER_PX, QFont.Weight.DemiBold))
    room = QRectF(centre.x() - radius, centre.y() - radius, 2 * radius, 2 * radius)
    painter.drawText(room, Qt.AlignmentFlag.AlignCenter, letter)


@contextmanager
def _clipped(painter: QPainter, frame: Frame) -> Iterator[None]:
    painter.save()
    painter.setClipRect(QRectF(frame.left, frame.top, frame.width, frame.height))
    yield
    painter.restore()


def _at(frame: Frame, percent: float, angle_deg: float) -> QPointF:
    return QPointF(float(frame.x(percent)), float(frame.y(angle_deg)))


def _polygon(frame: Frame, percent: FloatArray, angle_deg: FloatArray) -> QPolygonF:
    return pg.functions.arrayToQPolygonF(frame.x(percent), frame.y(angle_deg))


def _fill(painter: QPainter, frame: Frame, mean: FloatArray, reach: FloatArray, colour: QColor) -> None:
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(colour)
    there_and_back = np.concatenate([PERCENT, PERCENT[::-1]])
    painter.drawPolygon(_polygon(frame, there_and_back, np.concatenate([mean - reach, (mean + reach)[::-1]])))
    painter.setBrush(Qt.BrushStyle.NoBrush)


def _paint_strides(painter: QPainter, theme: Theme, frame: Frame, curve: StrideCurve) -> None:
    """Fine lines; of many, hairlines in the pale colour, a cloud from which the mean is set apart."""
    is_few = len(curve.strides_deg) <= SMOOTH_UP_TO
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, is_few)
    colour = theme.curve(curve.side) if is_few else theme.soft(curve.side)
    if curve.is_not_reported:
        colour = QColor(theme.colours.control)  # evidence, not to be read
    colour.setAlphaF(STRIDE_ALPHA if is_few else 1.0)
    painter.setPen(QPen(colour, STRIDE_PX * theme.scale if is_few else 0))
    for stride_deg in curve.strides_deg:
        painter.drawPolyline(_polygon(frame, PERCENT, stride_deg))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)


def _width_px(curve: StrideCurve) -> float:
    return MEAN_PX if curve.order is None else FIRST_PX + _lateness(curve) * (LAST_PX - FIRST_PX)


def _lateness(curve: StrideCurve) -> float:
    """0 of the earliest curve of a comparison, 1 of the last and of one alone."""
    k, count = curve.order or (0, 1)
    return k / (count - 1) if count > 1 else 1.0


def _pen(theme: Theme, curve: StrideCurve, width: float | None = None) -> QPen:
    """Left solid, right dashed; of curves that are compared thin and pale to begin with, thick at the end."""
    full = _width_px(curve)
    pen = theme.side_pen(curve.side, full)
    if curve.side is Side.RIGHT:
        pen.setDashPattern([length / full for length in DASH_PX])  # of one length, however thick
    if curve.order is not None:
        colour = theme.text(curve.side) if not theme.is_dark else theme.curve(curve.side)
        if curve.is_few:
            colour = QColor(theme.colours.control)
        colour.setAlphaF(FIRST_ALPHA + _lateness(curve) * (1 - FIRST_ALPHA))
        pen.setColor(colour)
    if width is not None:
        pen.setWidthF(width * theme.scale)
    return pen


def _paint_mean(painter: QPainter, theme: Theme, frame: Frame, curve: StrideCurve) -> None:
    """On a casing that lifts it off the band."""
    line = _polygon(frame, PERCENT, curve.angle_deg)
    painter.setPen(flat(theme.pen(theme.colours.surface, _width_px(curve) + CASING_PX)))
    painter.drawPolyline(line)
    painter.setPen(_pen(theme, curve))
    painter.drawPolyline(line)


def _paint_chosen(painter: QPainter, theme: Theme, frame: Frame, side: Side, stride_deg: FloatArray) -> None:
    """The stride in force in ink, whether it is used or not; solid or dashed, as its side is."""
    line = _polygon(frame, PERCENT, stride_deg)
    painter.setPen(theme.pen(theme.colours.surface, MEAN_PX + CASING_PX))
    painter.drawPolyline(line)
    pen = theme.side_pen(side, MEAN_PX)
    pen.setColor(QColor(theme.colours.ink))
    painter.setPen(pen)
    painter.drawPolyline(line)


def _paint_toe_off(painter: QPainter, frame: Frame, curve: StrideCurve, pen: QPen) -> None:
    if np.isfinite(curve.toe_off_percent):
        x = float(frame.x(curve.toe_off_percent))
        painter.setPen(pen)
        painter.drawLine(QPointF(x, frame.top), QPointF(x, frame.bottom))


def _solid_last(chart: StrideChart) -> list[StrideCurve]:
    """The order of painting: of both legs of one walk the dashed line first."""
    return [*chart.curves] if chart.is_comparison else sorted(chart.curves, key=lambda curve: curve.side, reverse=True)


def _paint_simulated(painter: QPainter, theme: Theme, frame: Frame, width: float) -> None:
    """Turned, at the right edge."""
    painter.save()
    painter.setFont(theme.font(12, QFont.Weight.DemiBold))
    painter.setPen(QColor(theme.colours.ink2))
    painter.translate(width, frame.top + frame.height / 2)
    painter.rotate(-90)
    height = theme.px(LINE_HEIGHT)
    painter.drawText(QRectF(-frame.height, -height, 2 * frame.height, height), ALIGN["middle"], tr(SIMULATED))
    painter.restore()


def _paint_toe_offs(painter: QPainter, theme: Theme, frame: Frame, width: float, chart: StrideChart) -> None:
    """What is positive, and each side's toe-off with its words above the plot, the earlier at the left of its line."""
    metrics = QFontMetrics(theme.font(12, QFont.Weight.Medium))
    painter.setFont(theme.font(12))
    painter.setPen(QColor(theme.colours.ink2))
    painter.drawText(QRectF(0, 0, width, frame.top), ALIGN["start"], chart.sign)
    least: float = QFontMetrics(theme.font(12)).horizontalAdvance(chart.sign) + theme.px(8)
    painter.setFont(theme.font(12, QFont.Weight.Medium))
    labels = toe_off_labels(chart.curves)
    for first in toe_offs_in_order(chart.curves, 0)[:1]:  # its word goes where the sign leaves it no room
        if float(frame.x(first.toe_off_percent)) - metrics.horizontalAdvance(labels[first.side]) - theme.px(5) < least:
            labels = toe_off_labels(chart.curves, has_word=False)
    for i, curve in enumerate(toe_offs_in_order(chart.curves, 0)):
        _paint_toe_off(painter, frame, curve, theme.side_pen(curve.side, TOE_OFF_PX))
        painter.setPen(theme.text(curve.side))
        x, label = float(frame.x(curve.toe_off_percent)), labels[curve.side]
        needed = metrics.horizontalAdvance(label) + 1
        left = x - needed - theme.px(4) if i == 0 else x + theme.px(4)
        left = min(max(left, least), width - needed)  # what is positive is known, and gives way last
        painter.drawText(QRectF(left, 0, needed, frame.top), ALIGN["start"], label)
        least = left + needed + theme.px(4)


def _paint_letters(painter: QPainter, theme: Theme, frame: Frame, chart: StrideChart) -> None:
    """Each curve's letter beside it, the last one's filled."""
    for curve, centre, on_curve in _letters(theme, frame, [curve for curve in chart.curves if curve.is_known]):
        painter.setPen(theme.pen(theme.colours.ink2, 0.75))
        way = 1 if centre.x() > on_curve.x() else -1
        elbow = QPointF(centre.x() - way * theme.px(DOT + 8), centre.y())
        painter.drawLine(on_curve, elbow)
        painter.drawLine(elbow, centre)
        is_last = curve.letter == chart.curves[-1].letter
        paint_letter(painter, theme, curve.letter, centre, theme.text(curve.side), is_last)


def _letters(theme: Theme, frame: Frame, curves: Sequence[StrideCurve]) -> list[tuple[StrideCurve, QPointF, QPointF]]:
    """Give each curve's letter centre and its point on the curve, where the curves lie furthest apart."""
    if not curves:
        return []
    means = np.array([curve.angle_deg for curve in curves])
    at = int(np.argmax(np.ptp(means[:, 5:96], axis=0))) + 5 if len(curves) > 1 else int(np.argmax(means[0]))
    order = np.argsort(-means[:, at], kind="stable")
    spacing = min(theme.px(2 * DOT + LETTERS_APART), (frame.height - theme.px(2 * DOT)) / len(order))
    percent = at + LEADER_PERCENT if at + LEADER_PERCENT < 95 else at - LEADER_PERCENT
    height = spacing * (len(order) - 1)
    top = float(frame.y(float(means[:, at].mean()))) - height / 2
    top = min(max(top, frame.top + theme.px(DOT + 1)), frame.bottom - theme.px(DOT + 1) - height)
    return [
        (curves[k], QPointF(float(frame.x(percent)), top + row * spacing), _at(frame, at, float(means[k, at])))
        for row, k in enumerate(order)
    ]
