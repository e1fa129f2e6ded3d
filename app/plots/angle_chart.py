"""One kind of joint over time: left solid, right dashed, certainty as a band, gaps as gaps, always the same axes."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QAccessible, QColor, QPainter, QPainterPath, QPen, QPolygonF
from PySide6.QtWidgets import QStyleOptionGraphicsItem, QWidget

from app.charts.axes import AXIS_WIDTH, RIGHT_MARGIN, range_for
from app.charts.marks import stretches
from app.plots.thinning import envelope, thin
from app.theme.current import current_theme, on_theme, px
from app.wording.numbers import MINUS, clock
from app.wording.translation import figure_text
from core.body import Side
from core.samples import FloatArray

LEAST_SIZE = (320, 88)  # what can just be read; the page gives more where it has more
LEAST_OF_THREE = 66  # px high: each of three over one another
AXIS_HEIGHT, BARE_AXIS_HEIGHT = 24, 6
FOOT = 6  # over and under an axis, whose last figure is half beyond it
CURVE_PX = 2.0
HAIR_PX = 1.0
LINE_PIECE = 64  # points that are stroked at a time: the time for one line grows faster than its points
DENSE_FROM = 3.0  # samples per column from which on wide, smooth lines take seconds and show no more than hairlines
DASHED_UP_TO = 15.0  # samples per column; beyond, a swing is too narrow for its dashes, which would take seconds
BAND_PIECE = 32  # points of a dense band that are filled at a time
SECOND_PX = 1.0  # the thin curve of another method beside the result
TICK_DEG = 20
SHORTEST_VIEW_S = 0.2


@dataclass(frozen=True, slots=True)
class Curve:
    """What one leg draws, degrees, all (n,) on the chart's time; `sd_deg` and `second_deg` None where not shown."""

    angle_deg: FloatArray
    sd_deg: FloatArray | None = None
    second_deg: FloatArray | None = None


class AngleAxis(pg.AxisItem):  # type: ignore[misc]  # pyqtgraph has no types
    def tickStrings(self, values: list[float], _scale: float, _spacing: float) -> list[str]:
        return [f"{value:.0f}".replace("-", MINUS) for value in values]


class AngleAxes(pg.GraphicsView):  # type: ignore[misc]  # pyqtgraph has no types
    """Angles over time in a view of their own.

    It is put together from its parts, because a `PlotItem` brings menus and forty controls that nobody would see.
    """

    def __init__(self, beneath: pg.AxisItem, *, has_mouse: bool) -> None:
        super().__init__(useOpenGL=False)
        for part in (self, self.viewport()):  # a click goes on to the page's control, which takes the focus
            part.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.view_box = pg.ViewBox(enableMenu=False, enableMouse=has_mouse)
        self._angle_axis, self._beneath = AngleAxis("left"), beneath
        self._layout = pg.GraphicsLayout()
        self._layout.setSpacing(0)
        self._layout.addItem(self._angle_axis, 0, 0)
        self._layout.addItem(self.view_box, 0, 1)
        self._layout.addItem(beneath, 1, 1)
        self._angle_axis.linkToView(self.view_box)
        self.view_box.setDefaultPadding(0.0)
        self.view_box.disableAutoRange()
        self.setCentralItem(self._layout)

    def sizeHint(self) -> QSize:
        return self.minimumSizeHint()  # Qt's own goes by the scene

    def _apply_theme(self) -> None:
        theme = current_theme()
        self.setBackground(theme.colours.surface)
        self._angle_axis.setWidth(theme.px(AXIS_WIDTH))
        for axis in (self._angle_axis, self._beneath):
            axis.setPen(theme.pen(theme.colours.control, 1))
            axis.setTextPen(QColor(theme.colours.ink2))
            axis.setStyle(tickFont=theme.font(12), tickLength=theme.px(4), maxTickLevel=0)
        self._layout.setContentsMargins(0, theme.px(FOOT), theme.px(RIGHT_MARGIN), 0)


class AngleChart(AngleAxes):
    """Axes that stay `lowest_deg` to `highest_deg` unless a curve leaves them.

    Above another chart on the same time, `has_times` is False: its times would say the same twice.
    """

    accessible_role = QAccessible.Role.Chart

    view_moved = Signal()

    def __init__(self, lowest_deg: float, highest_deg: float, has_times: bool = True) -> None:
        super().__init__(_TimeAxis("bottom"), has_mouse=True)
        self._has_times, self._is_of_three = has_times, False
        self._fixed = (lowest_deg, highest_deg)
        self.range_deg = self._fixed
        self.curves: Mapping[Side, Curve] = {}
        self._time_s: FloatArray = np.zeros(0)
        self._beneath.linkToView(self.view_box)
        self.view_box.setMouseEnabled(x=True, y=False)
        self.view_box.setYRange(*self._fixed, padding=0)
        self._zero = pg.InfiniteLine(0.0, angle=0)
        self.reading_line = pg.InfiniteLine(angle=90)
        self.reading_line.hide()
        self._items = {side: _CurveItem(side) for side in Side}
        for item in (self._zero, *self._items.values(), self.reading_line):
            self.view_box.addItem(item, ignoreBounds=True)
        self.view_box.sigXRangeChanged.connect(self._on_x_range_changed)
        self.view_box.sigResized.connect(self._redraw)  # no finer than the screen: its width has changed
        on_theme(self._apply_theme)

    def minimumSizeHint(self) -> QSize:
        less = 0 if self._has_times else AXIS_HEIGHT - BARE_AXIS_HEIGHT
        return QSize(px(LEAST_SIZE[0]), px((LEAST_OF_THREE if self._is_of_three else LEAST_SIZE[1]) - less))

    def set_of_three(self, is_of_three: bool) -> None:
        """Let it be lower, where three charts share the room of two."""
        self._is_of_three = is_of_three
        self.updateGeometry()

    @property
    def is_widened(self) -> bool:
        return self.range_deg != self._fixed

    @property
    def visible_s(self) -> tuple[float, float]:
        first, last = self.view_box.viewRange()[0]
        return float(first), float(last)

    @property
    def whole_s(self) -> tuple[float, float]:
        """First and last stamp; a second from zero where there is no sample."""
        if len(self._time_s) == 0:
            return 0.0, 1.0
        first, last = float(self._time_s[0]), float(self._time_s[-1])
        return first, max(last, first + SHORTEST_VIEW_S)

    def show_curves(self, time_s: FloatArray, curves: Mapping[Side, Curve]) -> None:
        """Draw `curves` over `time_s`, and widen the axis where they leave it."""
        self._time_s, self.curves = time_s, curves
        drawn = [values for curve in curves.values() for values in (curve.angle_deg, curve.second_deg)]
        self.range_deg = range_for(self._fixed, [values for values in drawn if values is not None])
        self.view_box.setYRange(*self.range_deg, padding=0)
        first, last = self.whole_s
        self.view_box.setLimits(xMin=first, xMax=last, minXRange=SHORTEST_VIEW_S)
        span = self.range_deg[1] - self.range_deg[0]
        step = TICK_DEG if span <= 8 * TICK_DEG else None
        self._angle_axis.setTickSpacing(levels=[(step, 0)] if step else None)
        self._redraw()

    def see(self, first_s: float, last_s: float) -> None:
        self.view_box.setXRange(first_s, last_s, padding=0)

    def link_time(self, other: "AngleChart") -> None:
        """Show the same stretch of time as `other` from now on."""
        self.view_box.setXLink(other.view_box)

    def set_cursor(self, time_s: float | None) -> None:
        self.reading_line.setVisible(time_s is not None)
        if time_s is not None:
            self.reading_line.setPos(time_s)

    def time_at(self, scene_x: float, scene_y: float) -> float | None:
        """Give the time under a point of the scene; None beside the axes."""
        if not self.view_box.sceneBoundingRect().contains(scene_x, scene_y):
            return None
        return float(self.view_box.mapSceneToView(pg.Point(scene_x, scene_y)).x())

    def curve_points(self, side: Side) -> tuple[FloatArray, FloatArray]:
        """Give time and angle of the points that are drawn."""
        item = self._items[side]
        return item.time_s, item.angle_deg

    def _redraw(self) -> None:
        """Hand the items what is in sight, no finer than the screen."""
        first, last = np.searchsorted(self._time_s, self.visible_s)
        part = slice(max(int(first) - 1, 0), int(last) + 1)
        columns = max(int(self.view_box.width()), 100)
        for side, item in self._items.items():
            item.setData(self._time_s[part], self.curves.get(side), part, columns)

    def _on_x_range_changed(self) -> None:
        self._redraw()
        self.view_moved.emit()

    def _apply_theme(self) -> None:
        super()._apply_theme()
        c = current_theme().colours
        self._beneath.setHeight(px(AXIS_HEIGHT if self._has_times else BARE_AXIS_HEIGHT))
        self._beneath.setStyle(showValues=self._has_times)
        self._zero.setPen(pg.mkPen(c.control, width=1))
        self.reading_line.setPen(pg.mkPen(c.ink, width=1))
        for item in self._items.values():
            item.update()


class _TimeAxis(pg.AxisItem):  # type: ignore[misc]  # pyqtgraph has no types
    """Ticks that carry their unit: "2.5 s" up to two minutes, "3:20" beyond."""

    def tickStrings(self, values: list[float], _scale: float, spacing: float) -> list[str]:
        if self.range[1] <= 120 or spacing < 1:
            decimals = max(0, int(np.ceil(-np.log10(spacing) - 1e-9)))
            return [f"{figure_text(value, f'.{decimals}f')} s".replace("-", MINUS) for value in values]
        return [clock(value) for value in values]


class _CurveItem(pg.GraphicsObject):  # type: ignore[misc]  # pyqtgraph has no types
    """Band and curves of one leg in one item: pyqtgraph's own curves join their bands across gaps."""

    def __init__(self, side: Side) -> None:
        super().__init__()
        self._side = side
        self.time_s: FloatArray = np.zeros(0)
        self.angle_deg: FloatArray = np.zeros(0)
        self._line: list[tuple[FloatArray, FloatArray]] = []
        self._second: list[tuple[FloatArray, FloatArray]] = []
        self._bands: list[QPainterPath] = []
        self._bounds = QRectF()
        self._is_dense = False
        self._is_dashed = True
        # moving the cursor over it must not paint thousands of dashes again
        self.setCacheMode(pg.GraphicsObject.CacheMode.DeviceCoordinateCache)

    def setData(self, time_s: FloatArray, curve: Curve | None, part: slice, columns: int) -> None:
        self.prepareGeometryChange()
        self._line, self._second, self._bands = [], [], []
        self.time_s, self.angle_deg = np.zeros(0), np.zeros(0)
        self._is_dense = len(time_s) > DENSE_FROM * columns
        self._is_dashed = len(time_s) <= DASHED_UP_TO * columns
        if curve is not None:
            # of each part the lowest and the highest: of smooth, wide lines, which cost most, a point per column
            parts = columns if self._is_dense else columns // 2
            self.time_s, self.angle_deg = thin(time_s, curve.angle_deg[part], parts)
            self._line = _runs(self.time_s, self.angle_deg)
            if curve.second_deg is not None:
                self._second = _runs(*thin(time_s, curve.second_deg[part], parts))
            if curve.sd_deg is not None:
                angle_deg, reach_deg = curve.angle_deg[part], 2 * curve.sd_deg[part]
                band = envelope(time_s, angle_deg - reach_deg, angle_deg + reach_deg, parts)
                self._bands = _band_paths(*band, BAND_PIECE if self._is_dense else len(time_s))
        self._bounds = QRectF()
        for run in (*self._line, *self._second):
            self._bounds = self._bounds.united(_polygon(*run).boundingRect())
        for band_path in self._bands:
            self._bounds = self._bounds.united(band_path.boundingRect())
        self.update()

    def boundingRect(self) -> QRectF:
        reach = CURVE_PX * current_theme().scale
        x, y = reach * (self.pixelWidth() or 0.0), reach * (self.pixelHeight() or 0.0)
        return self._bounds.adjusted(-x, -y, x, y)

    def viewTransformChanged(self) -> None:
        self.prepareGeometryChange()
        super().viewTransformChanged()

    def paint(self, painter: QPainter, _option: QStyleOptionGraphicsItem, _widget: QWidget | None = None) -> None:
        theme = current_theme()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, not self._is_dense)
        for band in self._bands:
            painter.fillPath(band, theme.band(self._side))
        self._stroke(painter, self._second, SECOND_PX)
        self._stroke(painter, self._line, CURVE_PX if not self._is_dense else HAIR_PX)

    def _stroke(self, painter: QPainter, runs: list[tuple[FloatArray, FloatArray]], width: float) -> None:
        """Draw a line in pieces that meet on a point; each one's dashes go on where the last one's ended."""
        pen = self._pen(width)
        is_dashed = pen.style() is Qt.PenStyle.CustomDashLine
        transform = painter.worldTransform()
        for x, y in runs:
            length_px = _lengths(x * transform.m11(), y * transform.m22()) if is_dashed else x
            for first in range(0, max(len(x) - 1, 1), LINE_PIECE):
                part = slice(first, first + LINE_PIECE + 1)
                if is_dashed:
                    pen.setDashOffset(float(length_px[first]) / pen.widthF())
                painter.setPen(pen)
                painter.drawPolyline(_polygon(x[part], y[part]))

    def _pen(self, width: float) -> QPen:
        pen = current_theme().side_pen(self._side, width)
        if not self._is_dashed:
            pen.setStyle(Qt.PenStyle.SolidLine)
            pen.setWidthF(0)
        return pen


def runs(values: FloatArray) -> list[slice]:
    """Give the stretches without a gap."""
    return [slice(first, last + 1) for first, last in stretches(np.isfinite(values))]


def _polygon(x: FloatArray, y: FloatArray) -> QPolygonF:
    return pg.functions.arrayToQPolygonF(x, y)


def _runs(time_s: FloatArray, values: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
    return [(time_s[run], values[run]) for run in runs(values)]


def _lengths(x: FloatArray, y: FloatArray) -> FloatArray:
    """Give how long the line is up to each point."""
    return np.concatenate([[0.0], np.hypot(np.diff(x), np.diff(y)).cumsum()])


def _band_paths(time_s: FloatArray, low: FloatArray, high: FloatArray, most: int) -> list[QPainterPath]:
    """Give the band in pieces of at most `most` points: the time to fill one grows with the square of its points."""
    paths = []
    for run in runs(low):
        for first in range(run.start, max(run.stop - 1, run.start + 1), max(most, 1)):
            part = slice(first, min(first + most + 1, run.stop))  # pieces meet on one point
            path = QPainterPath()
            x = np.concatenate([time_s[part], time_s[part][::-1]])
            path.addPolygon(_polygon(x, np.concatenate([low[part], high[part][::-1]])))
            path.closeSubpath()
            paths.append(path)
    return paths
