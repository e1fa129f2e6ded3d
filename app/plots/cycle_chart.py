"""A joint over one stride: each side on its own stride, the mean on the band of a cited group.

The chart paints itself: nobody zooms a stride, and so every label finds its place.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QAccessible, QColor, QMouseEvent, QPainter, QPaintEvent, QPixmap
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.charts.axes import (
    range_for,
    sign_in_words,
)
from app.charts.cycles import Band, SideCycle
from app.charts.frame import Frame
from app.charts.marks import CurveLabel, Deviation, Gap, HiddenCurve, laid_at_height_of
from app.charts.marks_on_screen import layout_on_screen
from app.charts.on_screen import frame_of, paint, paint_cursor, paint_words
from app.charts.places import Layout
from app.charts.stride_chart import (
    SCREEN_TICK_DEG,
    Axis,
    StrideChart,
    StrideCurve,
    curves_of_walk,
    usual_range_deg,
)
from app.theme.current import current_theme, on_theme, px
from core.body import JointKind, Side
from core.samples import FloatArray

LEAST_SIZE, TIGHT_SIZE = (284, 144), (160, 100)  # of two charts, or of three where there is little room
NONE_HIDDEN: Mapping[Side, str] = {}
EARLIER = (0, 2)  # the thin one of two curves, as in every comparison


class CycleChart(QWidget):
    """One joint over 0 to 100 % of the stride; its axis stays unless a mean curve leaves it."""

    accessible_role = QAccessible.Role.Chart

    picked = Signal(float, float)  # percent of the stride, degrees

    def __init__(self, kind: JointKind) -> None:
        super().__init__()
        self._kind = kind
        self.range_deg = usual_range_deg(kind, is_about_mean=False)
        self.cycles: Mapping[Side, SideCycle] = {}
        self.band: Band | None = None
        self.is_simulated = False
        self.has_band, self.has_strides = True, False
        self.is_about_mean = False
        self.not_reported: Mapping[Side, str] = {}  # of whom no mean is drawn, with value and limit
        self.beside: tuple[StrideCurve, ...] = ()  # of another walk, of legs whose mean is drawn
        self.stride: tuple[Side, FloatArray] | None = None
        self.readings: Mapping[Side, float] = {}  # percent of each leg's own stride
        self.deviations: tuple[Deviation, ...] = ()
        self.gaps: tuple[Gap, ...] = ()
        self.labels: tuple[CurveLabel, ...] = ()
        self._picture: QPixmap | None = None
        self._layout: Layout | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._least = LEAST_SIZE
        on_theme(self.redraw)

    @property
    def is_widened(self) -> bool:
        return self.range_deg != self._usual_deg

    @property
    def _usual_deg(self) -> tuple[float, float]:
        return usual_range_deg(self._kind, is_about_mean=self.is_about_mean)

    def minimumSizeHint(self) -> QSize:
        return QSize(*map(px, self._least))

    def set_tight(self, is_tight: bool) -> None:
        self._least = TIGHT_SIZE if is_tight else LEAST_SIZE
        self.updateGeometry()

    def show_cycles(
        self,
        cycles: Mapping[Side, SideCycle],
        is_simulated: bool,
        not_reported: Mapping[Side, str] = NONE_HIDDEN,
        is_about_mean: bool = False,
        beside: Mapping[Side, StrideCurve] | None = None,
    ) -> None:
        """Draw each side's strides, `beside` them another walk's means, and widen the axis where a mean leaves it."""
        self.cycles, self.is_simulated = cycles, is_simulated
        self.not_reported, self.is_about_mean = not_reported, is_about_mean
        self.deviations, self.gaps, self.labels = (), (), ()
        drawn = self.sides_with_mean
        self.beside = tuple(
            replace(curve, order=EARLIER) for side, curve in (beside or {}).items() if side in drawn and curve.is_known
        )
        means = [cycle.mean.mean for side, cycle in cycles.items() if side not in not_reported]
        means += [curve.angle_deg for curve in self.beside]
        self.range_deg = range_for(self._usual_deg, means)
        self.redraw()

    @property
    def described(self) -> StrideChart:
        """What is drawn; no band where curves are drawn about their own mean."""
        return StrideChart(
            axis=Axis(*self.range_deg, SCREEN_TICK_DEG, SCREEN_TICK_DEG),
            curves=self._curves(),
            band=self._drawn_band(),
            is_simulated=self.is_simulated,
            beside=() if self.has_strides else self.beside,
            chosen=self.stride,
            sign=sign_in_words(self._kind),
            deviations=self.deviations,
            gaps=self.gaps,
            labels=() if self.has_strides else self.labels,
            hidden=tuple(HiddenCurve(side, why) for side, why in self.not_reported.items()),
        )

    def _drawn_band(self) -> Band | None:
        """At the hip laid at the height of the curves, for its group's zero is another one."""
        if self.band is None or not self.has_band or self.is_about_mean:
            return None
        if self._kind is not JointKind.HIP:
            return self.band
        means = [curve.angle_deg for curve in self._curves() if curve.is_known]
        return laid_at_height_of(np.mean(means, axis=0), self.band) if means else None

    def _curves(self) -> tuple[StrideCurve, ...]:
        return curves_of_walk(self.cycles, frozenset(self.not_reported), has_strides=self.has_strides)

    @property
    def sides_with_mean(self) -> frozenset[Side]:
        return frozenset(curve.side for curve in self._curves() if curve.is_known)

    @property
    def frame(self) -> Frame:
        """The room inside the axes, in px of the widget."""
        return frame_of(current_theme(), self.width(), self.height(), self.described)

    def at(self, percent: float, angle_deg: float) -> QPointF:
        """The place of a point of the chart in px of the widget."""
        return QPointF(float(self.frame.x(percent)), float(self.frame.y(angle_deg)))

    @property
    def layout_of_words(self) -> Layout:
        """Where brackets, labels and boxes of hidden curves find room, px of the widget."""
        if self._layout is None:
            self._layout = layout_on_screen(current_theme(), self.frame, self.described)
        return self._layout

    def redraw(self) -> None:
        """Paint again, since what is shown has changed."""
        self._picture = self._layout = None
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        ratio, theme = self.devicePixelRatioF(), current_theme()
        if self._picture is None or self._picture.size() != self.size() * ratio:
            self._picture, self._layout = QPixmap(self.size() * ratio), None
            self._picture.setDevicePixelRatio(ratio)
            self._picture.fill(QColor(theme.colours.surface))
            paint(QPainter(self._picture), theme, self.frame, self.width(), self.described)
        painter = QPainter(self)
        painter.drawPixmap(0, 0, self._picture)
        read = {self.readings[side] for side in self.sides_with_mean if side in self.readings}
        paint_cursor(painter, theme, self.frame, read)
        paint_words(painter, theme, self.frame, self.layout_of_words)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        frame, at = self.frame, event.position()
        is_inside = QRectF(frame.left, frame.top, frame.width, frame.height).contains(at)
        if event.button() is not Qt.MouseButton.LeftButton or not is_inside:
            super().mousePressEvent(event)
            return
        self.picked.emit(frame.percent_at(at.x()), frame.angle_at(at.y()))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """The cursor follows the mouse while its button is down, also beside the plot."""
        if self.readings and event.buttons() & Qt.MouseButton.LeftButton:
            frame, at = self.frame, event.position()
            self.picked.emit(min(max(frame.percent_at(at.x()), 0.0), 100.0), frame.angle_at(at.y()))
