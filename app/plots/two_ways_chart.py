"""Two ways to one angle: the gyroscopes' drifts, the accelerometers' scatters, both together do neither."""

from typing import TypeVar

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QAccessible, QColor, QPainter, QPaintEvent, QPen, QPixmap
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.charts.axes import AXIS_WIDTH, KNEE_DEG, RIGHT_MARGIN, USUAL_DEG, angle_in_words, range_for
from app.plots.angle_chart import DENSE_FROM, runs
from app.plots.thinning import thin
from app.theme.current import current_theme, on_theme, px, scaled
from app.widgets.painted_text import CENTRE, RIGHT, PaintedText
from app.wording.translation import figure_text, tr
from core.body import Joint, Side
from core.samples import FloatArray

LEAST_SIZE = (320, 220)
TOP, BELOW, TICK = 8, 24, 4
TICK_DEG = 20
FUSED_PX, CASING_PX, RATES_PX, FORCES_PX = 2.5, 4.5, 1.75, 1.0
SECONDS = (0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300)
MOST_TICKS = 8

T = TypeVar("T", float, FloatArray)


class TwoWaysChart(QWidget):
    """Degrees over seconds; the axis widens for drift, while the accelerometers' spikes are cut at its ends."""

    accessible_role = QAccessible.Role.Chart

    def __init__(self) -> None:
        super().__init__()
        self._side = Side.LEFT
        self._fixed = KNEE_DEG
        self.time_s: FloatArray = np.zeros(0)
        self.curves_deg: tuple[FloatArray, ...] = ()
        self.visible_s = (0.0, 1.0)
        self.range_deg = KNEE_DEG
        self._picture: QPixmap | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        scaled(self.setMinimumSize, *LEAST_SIZE)
        on_theme(self._apply_theme)

    def show_angles(
        self, joint: Joint, time_s: FloatArray, from_rates: FloatArray, from_forces: FloatArray, fused: FloatArray
    ) -> None:
        """Draw the angles (n,) in degrees over `time_s` (n,); NaN in gaps."""
        self._side, self._fixed = joint.side, USUAL_DEG[joint.kind]
        self.time_s, self.curves_deg = time_s, (from_forces, from_rates, fused)
        self.see_all()

    @property
    def whole_s(self) -> tuple[float, float]:
        known = self.time_s[np.isfinite(self.time_s)]
        return (float(known[0]), max(float(known[-1]), float(known[0]) + 0.1)) if len(known) else (0.0, 1.0)

    def see_all(self) -> None:
        self.see(*self.whole_s)

    def see(self, first_s: float, last_s: float) -> None:
        """Show a stretch of time on the axis that its own curves need."""
        self.visible_s = first_s, last_s
        is_seen = (self.time_s >= first_s) & (self.time_s <= last_s)
        self.range_deg = range_for(self._fixed, [curve[is_seen] for curve in self.curves_deg[1:]])
        self._apply_theme()

    @property
    def cut_share(self) -> float:
        """How much of the accelerometers' angle in sight lies beyond the axis, 0 to 1."""
        if not self.curves_deg:
            return 0.0
        first, last = self.visible_s
        seen = self.curves_deg[0][(self.time_s >= first) & (self.time_s <= last)]
        seen = seen[np.isfinite(seen)]
        return float(np.mean((seen < self.range_deg[0]) | (seen > self.range_deg[1]))) if len(seen) else 0.0

    def plot_area(self) -> QRectF:
        left = px(AXIS_WIDTH)
        return QRectF(left, px(TOP), self.width() - left - px(RIGHT_MARGIN), self.height() - px(TOP + BELOW))

    def painted_texts(self) -> list[PaintedText]:
        theme, area = current_theme(), self.plot_area()
        px, font = theme.px, theme.font(12)
        texts = []
        for angle in self._angles():
            box = QRectF(0, self._y(angle) - px(9), area.left() - px(2 * TICK), px(18))
            texts.append(PaintedText(angle_in_words(angle), box, font, "ink2", RIGHT))
        for time_s, words in self._times():
            box = QRectF(self._x(time_s) - px(30), area.bottom() + px(TICK), px(60), px(BELOW - TICK))
            if box.right() <= self.width() + px(RIGHT_MARGIN) / 2:
                texts.append(PaintedText(words, box, font, "ink2", CENTRE))
        return texts

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the picture that was drawn before: who scrolls must not wait for thousands of lines."""
        ratio = self.devicePixelRatioF()
        if self._picture is None or self._picture.size() != self.size() * ratio:
            self._picture = QPixmap(self.size() * ratio)
            self._picture.setDevicePixelRatio(ratio)
            self._picture.fill(QColor(current_theme().colours.surface))
            self._paint(QPainter(self._picture))
        QPainter(self).drawPixmap(0, 0, self._picture)

    def _paint(self, painter: QPainter) -> None:
        theme, area = current_theme(), self.plot_area()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_axes(painter, area)
        painter.save()
        painter.setClipRect(area)
        casing = theme.pen(theme.colours.surface, CASING_PX)
        casing.setCapStyle(Qt.PenCapStyle.FlatCap)
        first, last = self.visible_s
        is_dense = np.count_nonzero((self.time_s >= first) & (self.time_s <= last)) > DENSE_FROM * area.width()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, not is_dense)
        if self.curves_deg:
            from_forces, from_rates, fused = self.curves_deg
            for pen, curve in (
                (self.forces_pen(), from_forces),
                (self.rates_pen(), from_rates),
                (casing, fused),
                (self.fused_pen(), fused),
            ):
                if is_dense:
                    pen.setStyle(Qt.PenStyle.SolidLine)
                    pen.setWidthF(0)
                painter.setPen(pen)
                self._paint_curve(painter, curve, area)
        painter.restore()
        for text in self.painted_texts():
            text.paint(painter, theme.colours)

    def forces_pen(self) -> QPen:
        """The pen of the accelerometers' angle."""
        return current_theme().pen(current_theme().colours.control, FORCES_PX)

    def rates_pen(self) -> QPen:
        """The pen of the gyroscopes' angle."""
        return current_theme().pen(current_theme().colours.ink, RATES_PX)

    def fused_pen(self) -> QPen:
        return current_theme().side_pen(self._side, FUSED_PX)

    def _paint_axes(self, painter: QPainter, area: QRectF) -> None:
        theme = current_theme()
        tick = theme.px(TICK)
        painter.setPen(theme.pen(theme.colours.control, 1))
        painter.drawLine(area.topLeft(), area.bottomLeft())
        painter.drawLine(area.bottomLeft(), area.bottomRight())
        painter.drawLine(QPointF(area.left(), self._y(0.0)), QPointF(area.right(), self._y(0.0)))
        for angle in self._angles():
            painter.drawLine(QPointF(area.left() - tick, self._y(angle)), QPointF(area.left(), self._y(angle)))
        for time_s, _ in self._times():
            painter.drawLine(QPointF(self._x(time_s), area.bottom()), QPointF(self._x(time_s), area.bottom() + tick))

    def _paint_curve(self, painter: QPainter, curve: FloatArray, area: QRectF) -> None:
        first, last = np.searchsorted(_ascending(self.time_s), self.visible_s)
        part = slice(max(int(first) - 1, 0), int(last) + 1)
        time_s, values = thin(self.time_s[part], curve[part], max(int(area.width()), 50))
        for run in runs(values + time_s):
            x, y = self._x(time_s[run]), self._y(values[run])
            painter.drawPolyline(pg.functions.arrayToQPolygonF(x, y))

    def _x(self, time_s: T) -> T:
        area, (first, last) = self.plot_area(), self.visible_s
        return area.left() + area.width() * (time_s - first) / (last - first)

    def _y(self, angle_deg: T) -> T:
        area, (lowest, highest) = self.plot_area(), self.range_deg
        return area.bottom() - area.height() * (angle_deg - lowest) / (highest - lowest)

    def _angles(self) -> list[float]:
        lowest, highest = self.range_deg
        step = TICK_DEG * max(1, int(np.ceil((highest - lowest) / TICK_DEG / MOST_TICKS)))
        return [float(k * step) for k in range(int(np.ceil(lowest / step)), int(np.floor(highest / step)) + 1)]

    def _times(self) -> list[tuple[float, str]]:
        first, last = self.visible_s
        step = next((s for s in SECONDS if (last - first) / s <= MOST_TICKS), (last - first) / MOST_TICKS)
        ticks = [k * step for k in range(int(np.ceil(first / step - 1e-9)), int(np.floor(last / step + 1e-9)) + 1)]
        stated = [tr("{seconds} s").format(seconds=figure_text(t, ".1f") if step < 1 else f"{t:.0f}") for t in ticks]
        return [(float(t), words) for t, words in zip(ticks, stated, strict=True)]

    def _apply_theme(self) -> None:
        self._picture = None
        self.update()


def _ascending(time_s: FloatArray) -> FloatArray:
    """The times, with the one before in the place of what parts two stretches."""
    return np.fmax.accumulate(time_s) if len(time_s) else time_s
