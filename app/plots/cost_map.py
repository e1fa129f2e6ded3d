"""Axis that fits the movement, among all that one sensor could have. A map of all directions, dark where they fit.

The map shows the whole globe without stretching any part (Hammer's projection): the axis in use lies in the middle of
its right half, its opposite, which is the same line, in the middle of the left.
"""

import math

import numpy as np
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QAccessible, QColor, QImage, QPainter, QPolygonF, QResizeEvent
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, on_theme, px
from app.widgets.painted import Painted
from app.widgets.painted_text import LEFT, RIGHT, PaintedText
from app.wording.translation import figure_text, tr
from core.body import Side
from core.published.figures import CostOverSphere
from core.samples import BoolArray, FloatArray

LEAST_WIDTH = 208
MOST_HEIGHT = 340
SCALE_HEIGHT = 24  # the scale of greys under the map, with its ends
RAMP = 80
BANDS = 10  # steps of colour: their borders are the map's contours
CROSS, RING = 8, 5
FULL_MARKS_FROM = 360  # marks shrink on smaller maps
CIRCLE_STEPS = 73
X_REACH, Y_REACH = 2 * math.sqrt(2), math.sqrt(2)  # half axes of Hammer's ellipse


class CostMap(Painted):
    """One sensor of one joint."""

    accessible_role = QAccessible.Role.Chart

    def __init__(self) -> None:
        super().__init__()
        self._side = Side.LEFT
        self._cost: CostOverSphere | None = None
        self._axis_sd_rad: float | None = None
        self._image: QImage | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        on_theme(self._apply_theme)

    def show_cost(self, cost: CostOverSphere, side: Side, axis_sd_rad: float | None, name: str) -> None:
        """Draw the map of the sensor on the segment `name`; the circle about the axis is 2 SD wide."""
        self._cost, self._side, self._axis_sd_rad = cost, side, axis_sd_rad
        stated = tr(
            "{sensor}: the axis in use is {apart}° from the best-fitting direction; fit errors range from "
            "{low} to {high} °/s."
        )
        low, high = self.limits_deg_s
        apart = figure_text(math.degrees(cost.apart_rad), ".1f")
        self.setAccessibleName(tr("Fit error of all axes, {sensor}").format(sensor=name))
        self.setAccessibleDescription(stated.format(sensor=name, apart=apart, low=f"{low:.0f}", high=f"{high:.0f}"))
        self._apply_theme()

    @property
    def limits_deg_s(self) -> tuple[float, float]:
        """The ends of the scale: the least and the greatest misfit."""
        if self._cost is None:
            return 0.0, 0.0
        return float(np.rad2deg(self._cost.rms_rad_s.min())), float(np.rad2deg(self._cost.rms_rad_s.max()))

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.setFixedHeight(self._height_for(event.size().width()))

    def _height_for(self, width: int) -> int:
        return min(width // 2, px(MOST_HEIGHT)) + px(SCALE_HEIGHT + 4)

    def globe(self) -> QRectF:
        """The ellipse of the map, twice as wide as high, in px of the widget."""
        room = self.height() - px(SCALE_HEIGHT + 4)
        width = min(float(self.width()), 2.0 * room) - 2
        return QRectF((self.width() - width) / 2, 1, width, width / 2)

    def place(self, direction: FloatArray) -> QPointF:
        """The place of a unit vector (3,) of the sensor, in px of the widget."""
        assert self._cost is not None
        globe, (across, axis, north) = self.globe(), self._frame()
        longitude = math.atan2(float(direction @ axis), float(direction @ across))
        latitude = math.asin(min(max(float(direction @ north), -1.0), 1.0))
        z = math.sqrt(1 + math.cos(latitude) * math.cos(longitude / 2))
        x = X_REACH * math.cos(latitude) * math.sin(longitude / 2) / z
        y = Y_REACH * math.sin(latitude) / z
        return QPointF(
            globe.center().x() + x / X_REACH * globe.width() / 2, globe.center().y() - y / Y_REACH * globe.height() / 2
        )

    def painted_texts(self) -> list[PaintedText]:
        if self._cost is None:
            return []
        px, font, (low, high) = current_theme().px, current_theme().font(12), self.limits_deg_s
        half = self.width() / 2 - px(RAMP / 2 + 8)
        box = QRectF(0, self.height() - px(SCALE_HEIGHT), half, px(SCALE_HEIGHT))
        return [
            PaintedText(f"{low:.0f} °/s", box, font, "ink2", RIGHT),
            PaintedText(f"{high:.0f} °/s", box.translated(self.width() - half, 0), font, "ink2", LEFT),
        ]

    def draw(self, painter: QPainter) -> None:
        if self._cost is None:
            return
        theme, globe = current_theme(), self.globe()
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.drawImage(globe, self._picture())
        painter.setPen(theme.pen(theme.colours.control, 1.25))
        painter.drawEllipse(globe)
        self._paint_marks(painter)
        self._paint_scale(painter)

    def _paint_marks(self, painter: QPainter) -> None:
        """A cross at the axis in use and its opposite, with the circle of its certainty; a ring at the best fit."""
        assert self._cost is not None
        theme, c = current_theme(), current_theme().colours
        for sign in (1.0, -1.0):
            at = self.place(sign * self._cost.axis)
            best = self.place(sign * self._cost.lowest)
            small = min(1.0, self.globe().width() / theme.px(FULL_MARKS_FROM))
            reach, ring = CROSS * small * theme.scale, RING * small * theme.scale
            arms = [QPointF(reach, 0), QPointF(0, reach)]
            circle = self._circle(sign)
            for colour, width in ((c.surface, 3.0), (c.ink, 1.25)):  # a casing, so that it is seen on dark and on pale
                painter.setPen(theme.pen(colour, width))
                for arm in arms:
                    painter.drawLine(at - arm, at + arm)
                painter.drawEllipse(best, ring, ring)
                if circle is not None:
                    painter.drawPolyline(circle)

    def _circle(self, sign: float) -> QPolygonF | None:
        if self._cost is None or self._axis_sd_rad is None or not math.isfinite(self._axis_sd_rad):
            return None
        across, axis, north = self._frame()
        reach = min(2 * self._axis_sd_rad, math.radians(80))
        turn = np.linspace(0, 2 * np.pi, CIRCLE_STEPS)[:, None]
        points = np.cos(reach) * sign * axis + np.sin(reach) * (np.cos(turn) * across + np.sin(turn) * north)
        return QPolygonF([self.place(point) for point in points])

    def _paint_scale(self, painter: QPainter) -> None:
        width = px(RAMP) / BANDS
        top = self.height() - px(SCALE_HEIGHT) + px(SCALE_HEIGHT - 10) / 2
        left = (self.width() - px(RAMP)) / 2
        for k, colour in enumerate(self._ramp()):
            painter.fillRect(QRectF(left + k * width, top, width, px(10)), colour)
        painter.setPen(current_theme().pen(current_theme().colours.control, 1))
        painter.drawRect(QRectF(left, top, px(RAMP), px(10)))

    def _ramp(self) -> list[QColor]:
        """From what fits, in the leg's own colour, to what does not, the colour of the ground."""
        theme = current_theme()
        dark, pale = theme.curve(self._side), QColor(theme.colours.ground)
        return [_mixed(dark, pale, k / (BANDS - 1)) for k in range(BANDS)]

    def _frame(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The directions at longitude 0, at 90 degrees, which is the axis in use, and at the north pole."""
        assert self._cost is not None
        grid = self._cost.direction
        rows, columns = grid.shape[:2]
        return grid[rows // 2, (columns - 1) // 2], self._cost.axis, grid[-1, 0]

    def _picture(self) -> QImage:
        size = self.globe().size() * self.devicePixelRatioF()
        width, height = max(int(size.width()), 2), max(int(size.height()), 2)
        if self._image is None or (self._image.width(), self._image.height()) != (width, height):
            self._image = self._drawn(width, height)
        return self._image

    def _drawn(self, width: int, height: int) -> QImage:
        """The map's pixels, transparent outside the globe."""
        assert self._cost is not None
        x = (np.arange(width) + 0.5) / width * 2 * X_REACH - X_REACH
        y = Y_REACH - (np.arange(height) + 0.5) / height * 2 * Y_REACH
        values, is_inside = _sampled(self._cost.rms_rad_s, *np.meshgrid(x, y))
        low, high = float(self._cost.rms_rad_s.min()), float(self._cost.rms_rad_s.max())
        share = (values - low) / max(high - low, 1e-12)
        band = np.clip((share * BANDS).astype(int), 0, BANDS - 1)
        colours = np.array([colour.rgba() for colour in self._ramp()], dtype=np.uint32)
        pixels = np.where(is_inside, colours[band], np.uint32(0))
        return QImage(pixels.tobytes(), width, height, 4 * width, QImage.Format.Format_ARGB32).copy()

    def _apply_theme(self) -> None:
        self._image = None
        self.setMinimumWidth(px(LEAST_WIDTH))
        self.setFixedHeight(self._height_for(max(self.width(), self.minimumWidth())))
        self.update()


def _sampled(grid: FloatArray, x: FloatArray, y: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Values of a grid of latitudes and longitudes at points of Hammer's map, and which of them lie on the globe."""
    is_inside = (x / X_REACH) ** 2 + (y / Y_REACH) ** 2 <= 1
    z = np.sqrt(np.maximum(1 - (x / 4) ** 2 - (y / 2) ** 2, 0.5))
    longitude = 2 * np.arctan2(z * x, 2 * (2 * z**2 - 1))
    latitude = np.arcsin(np.clip(z * y, -1.0, 1.0))
    rows, columns = grid.shape
    row = np.clip((latitude / np.pi + 0.5) * (rows - 1), 0, rows - 1.001)
    column = np.clip((longitude / (2 * np.pi) + 0.5) * (columns - 1), 0, columns - 1.001)
    i, j = row.astype(int), column.astype(int)
    down, right = row - i, column - j
    above = (1 - right) * grid[i, j] + right * grid[i, j + 1]
    below = (1 - right) * grid[i + 1, j] + right * grid[i + 1, j + 1]
    return (1 - down) * above + down * below, is_inside


def _mixed(one: QColor, other: QColor, share: float) -> QColor:
    parts = zip((one.redF(), one.greenF(), one.blueF()), (other.redF(), other.greenF(), other.blueF()), strict=True)
    red, green, blue = ((1 - share) * a + share * b for a, b in parts)
    return QColor.fromRgbF(red, green, blue)
