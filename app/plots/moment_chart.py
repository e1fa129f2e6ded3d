"""One kind of joint around the cursor of a clip: its curves, lettered contacts of both feet, and each leg's value."""

from collections.abc import Mapping, Sequence

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetrics, QMouseEvent, QPainter, QPainterPath, QPen, QPolygonF
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy

from app.charts.axes import (
    ABOUT_MEAN_DEG,
    USUAL_DEG,
    angle_in_words,
    degrees_in_words,
    nothing_in_words,
    part_in_words,
    sign_in_words,
    title_in_words,
)
from app.plots.angle_chart import AngleChart, Curve
from app.theme.current import current_theme, px
from app.widgets.card import Card
from app.widgets.chip import SideKey
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr
from core.body import JointKind, Side
from core.samples import FloatArray

LEAST_SIZE = (240, 84)
LETTER, ABOVE = 12, 14  # px: of a contact, and the room for letters over the curves
HANDLE = (9, 6)
DOT = 4
HALO = 3.5
VALUE = 13
APART = 16  # px: nearer, two values are moved apart


class MomentChart(AngleChart):
    """`pointed` gives the time under the mouse, pressed or drawn along."""

    pointed = Signal(float)

    def __init__(self, kind: JointKind, *, has_times: bool) -> None:
        super().__init__(*USUAL_DEG[kind], has_times=has_times)
        self.kind = kind
        self.contacts_s: Mapping[Side, FloatArray] = {}
        self.cursor_s: float | None = None
        self.values_deg: Mapping[Side, float] = {}
        self.has_values = True
        self._is_held = False
        self.view_box.setMouseEnabled(x=False, y=False)

    def minimumSizeHint(self) -> QSize:
        return QSize(px(LEAST_SIZE[0]), px(LEAST_SIZE[1]))

    def set_axis(self, lowest_deg: float, highest_deg: float) -> None:
        """Have other axes from the next curves on."""
        self._fixed = (lowest_deg, highest_deg)

    def set_times_shown(self, has_times: bool) -> None:
        self._has_times = has_times
        self._apply_theme()

    def set_cursor(self, time_s: float | None) -> None:
        """Put the cursor on a time, and read the curves there."""
        self.cursor_s = time_s
        self.values_deg = {
            side: value
            for side, curve in self.curves.items()
            if time_s is not None and np.isfinite(value := self._read(curve, time_s))
        }
        self.viewport().update()

    def _read(self, curve: Curve, time_s: float) -> float:
        return float(np.interp(time_s, self._time_s, curve.angle_deg)) if len(self._time_s) else np.nan

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._is_held = event.button() is Qt.MouseButton.LeftButton
        self._point(event)
        event.ignore()  # the card around takes the focus

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        self._point(event)

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:
        self._is_held = False

    def _point(self, event: QMouseEvent) -> None:
        at = self.mapToScene(event.position().toPoint())
        if self._is_held and (time_s := self.time_at(at.x(), at.y())) is not None:
            self.pointed.emit(time_s)

    def drawForeground(self, painter: QPainter, _rect: QRectF) -> None:  # noqa: N802  Qt names it
        """Contacts, cursor and values over the curves; the scene is in pixels."""
        plot = self.view_box.sceneBoundingRect()
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for side, times_s in self.contacts_s.items():
            for time_s in times_s[(times_s >= self.visible_s[0]) & (times_s <= self.visible_s[1])]:
                self._paint_contact(painter, plot, side, self._x_of(float(time_s)))
        if self.cursor_s is not None and self.visible_s[0] <= self.cursor_s <= self.visible_s[1]:
            self._paint_cursor(painter, plot, self._x_of(self.cursor_s))
        painter.restore()

    def _x_of(self, time_s: float) -> float:
        return float(self.view_box.mapViewToScene(pg.Point(time_s, 0.0)).x())

    def _paint_contact(self, painter: QPainter, plot: QRectF, side: Side, x: float) -> None:
        theme = current_theme()
        pen = QPen(theme.curve(side), theme.scale)
        pen.setStyle(Qt.PenStyle.DashLine if side is Side.RIGHT else Qt.PenStyle.SolidLine)
        painter.setPen(pen)
        painter.drawLine(QPointF(x, plot.top()), QPointF(x, plot.bottom()))
        painter.setPen(theme.text(side))
        painter.setFont(theme.font(LETTER, QFont.Weight.DemiBold))
        box = QRectF(x + px(3), plot.top(), px(ABOVE), px(ABOVE))
        painter.drawText(box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, side.letter)

    def _paint_cursor(self, painter: QPainter, plot: QRectF, x: float) -> None:
        theme = current_theme()
        painter.setPen(theme.pen(theme.colours.ink, 1.5))
        painter.drawLine(QPointF(x, plot.top()), QPointF(x, plot.bottom()))
        half, high = theme.px(HANDLE[0]) / 2, theme.px(HANDLE[1])
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(theme.colours.ink))
        top = plot.top() - high / 2
        painter.drawPolygon(QPolygonF([QPointF(x - half, top), QPointF(x + half, top), QPointF(x, top + high)]))
        if not self.has_values:
            return
        heights = {
            side: float(self.view_box.mapViewToScene(pg.Point(0.0, value)).y())
            for side, value in self.values_deg.items()
        }
        painter.setBrush(QColor(theme.colours.surface))
        for side, y in heights.items():
            painter.setPen(theme.pen(theme.curve(side), 2))
            painter.setBrush(theme.curve(side) if side is Side.LEFT else QColor(theme.colours.surface))
            painter.drawEllipse(QPointF(x, y), theme.px(DOT), theme.px(DOT))
        font = theme.font(VALUE, QFont.Weight.DemiBold)
        for side, y in _apart(heights, theme.px(APART), plot).items():
            words = f"{side.letter} {angle_in_words(self.values_deg[side])}°"
            width = QFontMetrics(font).horizontalAdvance(words)
            is_at_left = x + theme.px(10) + width > plot.right()
            left = x - theme.px(10) - width if is_at_left else x + theme.px(10)
            path = QPainterPath()
            path.addText(QPointF(left, y + theme.px(5)), font, words)
            painter.strokePath(path, theme.pen(theme.colours.surface, HALO))
            painter.fillPath(path, theme.text(side))


def _apart(heights: Mapping[Side, float], least: float, plot: QRectF) -> dict[Side, float]:
    """Move two values that would cover one another apart, and keep them beside the curves."""
    ordered: Sequence[Side] = sorted(heights, key=lambda side: heights[side])
    found = {side: heights[side] for side in ordered}
    if len(ordered) == 2:
        upper, lower = ordered
        lacking = max(0.0, least - (found[lower] - found[upper]))
        found[upper], found[lower] = found[upper] - lacking / 2, found[lower] + lacking / 2
    return {side: min(max(y, plot.top() + least), plot.bottom() - least / 2) for side, y in found.items()}


class MomentFrame(Card):
    """A chart with its title and the key to its curves. About their mean, curves have no values."""

    def __init__(self, kind: JointKind, *, has_times: bool) -> None:
        super().__init__(spacing=0)
        self.chart = MomentChart(kind, has_times=has_times)
        self._sign = Text(sign_in_words(kind), size=12, tone="ink2")
        self._simulated = Text(tr("SIMULATED"), size=12, weight=SEMIBOLD)
        self.keys = {side: SideKey(side) for side in Side}
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        title = Text(title_in_words(kind), size=16, weight=SEMIBOLD)
        head = lay_out(QHBoxLayout(), title, self._sign, self._simulated, 1, *self.keys.values(), spacing=8)
        lay_out(self.column, head, (self.chart, 1))
        self.set_padding(12)

    def show_curves(
        self,
        time_s: FloatArray,
        curves_deg: Mapping[Side, FloatArray],
        contacts_s: Mapping[Side, FloatArray],
        *,
        is_about_mean: bool,
        is_simulated: bool,
    ) -> None:
        """Draw what may be reported of both legs over `time_s` (n,), all in sight."""
        kind, chart = self.chart.kind, self.chart
        chart.set_axis(*(ABOUT_MEAN_DEG if is_about_mean else USUAL_DEG)[kind])
        if is_about_mean:
            curves_deg = {side: curve - np.nanmean(curve) for side, curve in curves_deg.items()}
        chart.has_values, chart.contacts_s = not is_about_mean, contacts_s
        chart.show_curves(time_s, {side: Curve(curve) for side, curve in curves_deg.items()})
        self._sign.setText(tr("about its mean (°)") if is_about_mean else sign_in_words(kind))
        self._simulated.setVisible(is_simulated)
        for side, key in self.keys.items():
            key.setVisible(side in curves_deg)
        chart.setAccessibleName(tr("{joint} around the cursor").format(joint=title_in_words(kind)))
        self.describe()

    def describe(self) -> None:
        """Give readers of screens the values at the cursor."""
        self.chart.setAccessibleDescription(" ".join(self.readings()) or nothing_in_words(self.chart.kind))

    def readings(self) -> list[str]:
        """Each leg's value at the cursor: "Left knee 50°."."""
        if not self.chart.has_values:
            return []
        return [
            f"{part_in_words(side, self.chart.kind)} {degrees_in_words(value, 0)}."
            for side, value in self.chart.values_deg.items()
        ]
