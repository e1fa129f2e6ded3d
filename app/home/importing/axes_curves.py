"""The three axes of one quantity over the first seconds: x solid, y dashed, z dotted."""

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QAccessible, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QSizePolicy

from app.plots.thinning import thin
from app.theme.current import current_theme, px
from app.widgets.painted import Painted
from app.widgets.painted_text import LEFT, RIGHT, PaintedText
from app.wording.numbers import MINUS
from app.wording.translation import figure_text, tr
from core.samples import FloatArray

AXES = ("x", "y", "z")
HEIGHT, LEAST_WIDTH = 132, 240
HEAD, FOOT, MARGIN = 22, 18, 60  # px round the curves: names, times, figures
KEY = 28  # px of a line in the key
DASHES: tuple[Sequence[float], ...] = ((), (5.0, 3.0), (1.0, 2.5))
WIDTHS = (1.5, 1.5, 2.0)


class AxesCurves(Painted):
    """`name`: the quantity and its unit."""

    accessible_role = QAccessible.Role.Graphic

    def __init__(self, name: str) -> None:
        super().__init__()
        self._name = name
        self._time_s: FloatArray = np.empty(0)
        self._values: FloatArray = np.empty((0, 3))
        self._low = self._high = 0.0
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName(name)

    def show_curves(self, time_s: FloatArray, values: FloatArray) -> None:
        """Show times (n,) and values (n, 3); what is missing is NaN."""
        self._time_s, self._values = time_s - time_s[:1].sum(), values
        known = values[np.isfinite(values)]
        self._low, self._high = (float(known.min()), float(known.max())) if len(known) else (0.0, 0.0)
        if len(known) and self._high == self._low:
            self._low, self._high = self._low - 1.0, self._high + 1.0
        columns = [column[np.isfinite(column)] for column in values.T]
        means = {axis: float(column.mean()) for axis, column in zip(AXES, columns, strict=True) if len(column)}
        stated = ", ".join(f"{axis} {_figure(mean, '.1f')}" for axis, mean in means.items())
        described = tr("From {low} to {high}. Means: {means}.").format(
            low=_figure(self._low, ".3g"), high=_figure(self._high, ".3g"), means=stated
        )
        self.setAccessibleDescription(described if means else tr("not in this file"))
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(px(LEAST_WIDTH), px(HEIGHT))

    def minimumSizeHint(self) -> QSize:
        return self.sizeHint()

    def draw(self, painter: QPainter) -> None:
        """Draw frame, zero and the three lines, each with its key."""
        theme, room = current_theme(), self._room
        painter.setPen(theme.pen(theme.colours.line, 1))
        painter.drawRect(room)
        if self._low < 0.0 < self._high:
            (y,) = self._y(np.zeros(1)).tolist()
            painter.drawLine(QPointF(room.left(), y), QPointF(room.right(), y))
        for axis, pen in enumerate(self._pens):
            painter.setPen(pen)
            self._draw_axis(painter, axis)
            key = self._key(axis)
            painter.drawLine(QPointF(key.left(), key.center().y()), QPointF(key.right(), key.center().y()))

    def painted_texts(self) -> Sequence[PaintedText]:
        """The name, the axes, the lowest and highest value, and the times at both ends."""
        theme, room = current_theme(), self._room
        font, line = theme.font(12), px(FOOT)
        texts = [
            PaintedText(self._name, QRectF(0, 0, self._key(0).left() - px(8), px(HEAD)), theme.font(14), wraps=False)
        ]
        for axis, name in enumerate(AXES):
            key = self._key(axis)
            texts.append(PaintedText(name, QRectF(key.right() + px(4), 0, px(14), px(HEAD)), font, "ink2"))
        if self._high > self._low:
            for value, y in ((self._high, room.top()), (self._low, room.bottom() - line)):
                box = QRectF(0, y, px(MARGIN) - px(6), line)
                texts.append(PaintedText(_figure(value, ".3g"), box, font, "ink2", RIGHT))
            end = tr("{length} s").format(length=figure_text(float(self._time_s[-1]), ".1f"))
            below = QRectF(room.left(), room.bottom(), room.width(), line)
            texts += [PaintedText("0", below, font, "ink2", LEFT), PaintedText(end, below, font, "ink2", RIGHT)]
        else:
            texts.append(PaintedText(tr("not in this file"), room, font, "ink2", Qt.AlignmentFlag.AlignCenter))
        return texts

    @property
    def _room(self) -> QRectF:
        return QRectF(px(MARGIN), px(HEAD), self.width() - px(MARGIN) - 1, self.height() - px(HEAD) - px(FOOT))

    @property
    def _pens(self) -> list[QPen]:
        theme = current_theme()
        pens = [theme.pen(theme.colours.ink, width) for width in WIDTHS]
        for pen, dashes in zip(pens, DASHES, strict=True):
            if dashes:
                pen.setDashPattern(list(dashes))
        return pens

    def _key(self, axis: int) -> QRectF:
        """Where the key's line of an axis is."""
        each = px(KEY + 4 + 14 + 8)
        return QRectF(self.width() - (3 - axis) * each, 0, px(KEY), px(HEAD))

    def _y(self, value: FloatArray) -> FloatArray:
        room = self._room
        return room.bottom() - px(3) - (value - self._low) / (self._high - self._low) * (room.height() - px(6))

    def _draw_axis(self, painter: QPainter, axis: int) -> None:
        if self._high <= self._low or len(self._time_s) < 2:
            return
        room = self._room
        time_s, values = thin(self._time_s, self._values[:, axis], round(room.width()))
        span_s = float(self._time_s[-1]) or 1.0
        known = np.isfinite(values)
        ends = np.flatnonzero(np.diff(known.astype(np.int8), prepend=0, append=0))
        for start, end in zip(ends[::2], ends[1::2], strict=True):
            x = room.left() + time_s[start:end] / span_s * room.width()
            points = zip(x.tolist(), self._y(values[start:end]).tolist(), strict=True)
            painter.drawPolyline(QPolygonF([QPointF(*one) for one in points]))


def _figure(value: float, form: str) -> str:
    return figure_text(value, form).replace("-", MINUS)
