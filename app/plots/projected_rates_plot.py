"""Check whether both axes of a joint point the same way.

The turning beside the axis, as paired and with one axis reversed.
"""

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QAccessible, QColor, QFont, QPainter, QPen, QPolygonF, QResizeEvent
from PySide6.QtWidgets import QSizePolicy

from app.summary.diagnostics import parts_deg_s
from app.theme.current import current_theme, on_theme, px
from app.widgets.painted import Painted
from app.widgets.painted_text import CENTRE, PaintedText
from app.widgets.text import MEDIUM
from app.wording.translation import tr
from core.body import Side
from core.published.figures import ProjectedRates
from core.samples import ComplexArray, FloatArray

LEAST_PANEL, MOST_PANEL, BETWEEN = 150, 300, 16
TITLE, SCALE = 44, 22
CURVE_PX, OTHER_PX = 2.5, 1.25
START = 4
FOOT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignBottom
STEPS = (5, 10, 20, 50, 100, 200, 500, 1000, 2000)


class ProjectedRatesPlot(Painted):
    """Two panels of one size and one scale."""

    accessible_role = QAccessible.Role.Chart

    def __init__(self) -> None:
        super().__init__()
        self._side = Side.LEFT
        self._shown: ProjectedRates | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        on_theme(self._apply_theme)

    def show_rates(self, shown: ProjectedRates | None, side: Side) -> None:
        """Draw both pairings; None where no second showed them."""
        self._shown, self._side = shown, side
        self.setAccessibleName(tr("Off-axis rotation"))
        self.setAccessibleDescription(". ".join(self._titles()) if shown is not None else "")
        self._apply_theme()

    @property
    def reach_deg_s(self) -> int:
        """Half the width of a panel."""
        if self._shown is None:
            return STEPS[0]
        curves = (self._shown.proximal, self._shown.distal, self._shown.reversed_distal)
        most = float(np.rad2deg(max(np.abs(curve).max() for curve in curves)))
        return next((step for step in STEPS if most <= step), STEPS[-1])

    def curves_deg_s(self) -> list[tuple[FloatArray, FloatArray]]:
        """Both coordinates (k,) of the curves: the nearer sensor's, the farther one's as paired, and reversed."""
        if self._shown is None:
            return []
        return [parts_deg_s(z) for z in (self._shown.proximal, self._shown.distal, self._shown.reversed_distal)]

    def near_pen(self) -> QPen:
        """The pen of the nearer sensor's curve."""
        return current_theme().side_pen(self._side, CURVE_PX)

    def far_pen(self) -> QPen:
        return current_theme().pen(current_theme().colours.ink, OTHER_PX)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.setFixedHeight(self._height_for(event.size().width()))

    def _height_for(self, width: int) -> int:
        return min((width - px(BETWEEN)) // 2, px(MOST_PANEL)) + px(TITLE + SCALE)

    def painted_texts(self) -> list[PaintedText]:
        if self._shown is None:
            return []
        theme = current_theme()
        texts = []
        for (panel, title), tone in zip(zip(self._panels(), self._titles(), strict=True), ("ink", "ink2"), strict=True):
            box = QRectF(panel.left(), 0, panel.width(), theme.px(TITLE - 4))
            texts.append(PaintedText(title, box, self._font(MEDIUM), tone, FOOT, wraps=True))
            below = QRectF(panel.left(), panel.bottom() + 2, panel.width(), theme.px(SCALE - 2))
            words = tr("edge: {reach} °/s").format(reach=self.reach_deg_s)
            texts.append(PaintedText(words, below, theme.font(12), "ink2", CENTRE))
        return texts

    def draw(self, painter: QPainter) -> None:
        if self._shown is None:
            return
        theme = current_theme()
        c = theme.colours
        for panel, distal in zip(self._panels(), (self._shown.distal, self._shown.reversed_distal), strict=True):
            painter.setPen(theme.pen(c.line, 1))
            painter.drawRect(panel)
            middle = panel.center()
            painter.drawLine(QPointF(panel.left(), middle.y()), QPointF(panel.right(), middle.y()))
            painter.drawLine(QPointF(middle.x(), panel.top()), QPointF(middle.x(), panel.bottom()))
            near, far = self._polygon(self._shown.proximal, panel), self._polygon(distal, panel)
            painter.setPen(self.near_pen())
            painter.drawPolyline(near)
            painter.setPen(self.far_pen())
            painter.drawPolyline(far)
            painter.setBrush(theme.curve(self._side))
            painter.setPen(theme.pen(c.surface, 1))
            painter.drawEllipse(near.at(0), theme.px(START), theme.px(START))
            painter.setBrush(QColor(c.ink))
            painter.drawEllipse(far.at(0), theme.px(START) - 1, theme.px(START) - 1)
            painter.setBrush(Qt.BrushStyle.NoBrush)

    def _polygon(self, z: ComplexArray, panel: QRectF) -> QPolygonF:
        x, y = parts_deg_s(z)
        scale = panel.width() / 2 / self.reach_deg_s
        return pg.functions.arrayToQPolygonF(panel.center().x() + scale * x, panel.center().y() - scale * y)

    def _panels(self) -> tuple[QRectF, QRectF]:
        side = min((self.width() - px(BETWEEN)) / 2, self.height() - px(TITLE + SCALE)) - 1
        return QRectF(0.5, px(TITLE), side, side), QRectF(side + px(BETWEEN) + 0.5, px(TITLE), side, side)

    def _titles(self) -> tuple[str, str]:
        assert self._shown is not None
        paired, turned = (100 * share for share in (self._shown.congruence, self._shown.reversed_congruence))
        return (
            tr("As paired: {percent} % agreement").format(percent=f"{paired:.0f}"),
            tr("With one axis reversed: {percent} % agreement").format(percent=f"{turned:.0f}"),
        )

    def _font(self, weight: QFont.Weight) -> QFont:
        return current_theme().font(14, weight)

    def _apply_theme(self) -> None:
        self.setMinimumWidth(current_theme().px(2 * LEAST_PANEL + BETWEEN))
        self.setFixedHeight(self._height_for(max(self.width(), self.minimumWidth())))
        self.update()
