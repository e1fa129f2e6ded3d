"""A curve as large as a line of words: whether there is anything in a recording, and when."""

import numpy as np
from PySide6.QtCore import QPointF
from PySide6.QtGui import QAccessible, QPainter, QPolygonF

from app.theme.current import current_theme, scaled
from app.widgets.painted import Painted
from core.samples import FloatArray

SIZE = (120, 28)


class SmallCurve(Painted):
    """`name` is what readers of screens say of it. A gap in the values is one in the line."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, name: str) -> None:
        super().__init__()
        self._time_s: FloatArray = np.empty(0)
        self._values: FloatArray = np.empty(0)
        scaled(self.setFixedSize, *SIZE)
        self.setAccessibleName(name)

    def show_curve(self, time_s: FloatArray, values: FloatArray) -> None:
        """(n,) each, thinned already; the lowest value is at the bottom."""
        self._time_s, self._values = time_s, values
        self.update()

    def draw(self, painter: QPainter) -> None:
        known = np.isfinite(self._values)
        if known.sum() < 2:
            return
        time_s, values = self._time_s, self._values
        least, most = float(np.min(values[known])), float(np.max(values[known]))
        span_s, height = float(time_s[-1] - time_s[0]) or 1.0, (most - least) or 1.0
        x = 1 + (time_s - time_s[0]) / span_s * (self.width() - 2)
        y = self.height() - 1 - (values - least) / height * (self.height() - 2)
        painter.setPen(current_theme().pen(current_theme().colours.ink2, 1))
        ends = np.flatnonzero(np.diff(known.astype(np.int8), prepend=0, append=0))
        for start, end in zip(ends[::2], ends[1::2], strict=True):
            part = zip(x[start:end], y[start:end], strict=True)
            painter.drawPolyline(QPolygonF([QPointF(float(a), float(b)) for a, b in part]))
