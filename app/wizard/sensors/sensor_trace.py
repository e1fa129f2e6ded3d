"""Trace of how a sensor turned in the last seconds: a line, drawn ten times a second without its row."""

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPen, QPolygonF

from app.theme.current import current_theme
from app.widgets.painted import Painted
from app.widgets.text import SEMIBOLD
from app.wording.translation import tr
from core.samples import FloatArray

PIXELS_PER_POINT = 2  # closer ones only cost, and blot
SPAN_DEG_S = 120.0  # what fills the trace's height, at least: a sensor at rest draws a still line


class Trace(Painted):
    """How a sensor turned in the last 5 s: flat at rest, and with a word where it has fallen silent."""

    def __init__(self) -> None:
        super().__init__()
        self._values: FloatArray = np.empty(0)
        self._silence = ""
        self._ground = QColor(current_theme().colours.surface)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)  # so that the row is not painted ten times a second

    def show_values(self, values: FloatArray) -> None:
        """Show angular rates (n,), deg/s, oldest first at even steps; NaN where nothing was received."""
        self._values = values
        self.update()

    def show_ground(self, ground: QColor) -> None:
        """Take the colour of the row, which the trace lies on."""
        if ground != self._ground:
            self._ground = ground
            self.update()

    def show_silence(self, silent_s: float) -> None:
        words = tr("no signal {seconds} s").format(seconds=max(round(silent_s), 1)) if silent_s > 0 else ""
        if words != self._silence:
            self._silence = words
            self.update()

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c = theme.colours
        painter.fillRect(self.rect(), self._ground)
        painter.setFont(theme.font(12, SEMIBOLD))
        ink = QColor(c.caution_ink if self._silence else c.ink)
        width = self.width()
        if self._silence:
            words = QFontMetrics(painter.font()).horizontalAdvance(self._silence)
            painter.setPen(ink)
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignRight, self._silence)
            width -= words + theme.px(8)
        painter.setPen(QPen(ink, 1))  # of one pixel: wider ones take many times as long
        for part in _lines(self._values, width, self.height()):
            painter.drawPolyline(part)


def _lines(values: FloatArray, width: int, height: int) -> list[QPolygonF]:
    """Turn values into lines that fill `width`, broken where values are missing."""
    if width < 2 or len(values) < 2:
        return []
    step = max(1, PIXELS_PER_POINT * len(values) // width)
    values = values[::step]
    received = np.isfinite(values)
    if not received.any():
        return []
    span = max(SPAN_DEG_S, float(2 * np.abs(values[received]).max()))
    x = np.linspace(0.0, width - 1.0, len(values))
    y = height / 2 - values / span * (height - 4)
    edges = np.flatnonzero(np.diff(received)) + 1
    parts = np.split(np.arange(len(values)), edges)
    return [QPolygonF([QPointF(x[i], y[i]) for i in part]) for part in parts if received[part[0]] and len(part) > 1]
