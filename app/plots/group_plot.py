"""Means of groups below one another: a dot, the 95 % interval of its mean as a bar, and how many stand behind it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QEvent, QPointF, QRectF, Qt
from PySide6.QtGui import QAccessible, QColor, QFontMetrics, QHelpEvent, QPainter
from PySide6.QtWidgets import QSizePolicy, QToolTip

from app.theme.current import current_theme, on_theme, px
from app.widgets.painted import Painted
from app.widgets.painted_text import CENTRE, LEFT, RIGHT, PaintedText
from app.widgets.text import MEDIUM
from app.wording.numbers import MINUS
from app.wording.translation import figure_text

ROW, AXIS, GAP = 32, 44, 16  # px
LEAST_PLOT = 180
MOST_LABEL_SHARE = 0.34  # of the width; a longer name is cut, and whole under the mouse
DOT, CAP, TICK = 5, 6, 4
STEPS = (1, 2, 5, 10)
MOST_STEPS = 5
HALF_TICK_WORDS = 36


@dataclass(frozen=True, slots=True)
class GroupLine:
    """One group: its name, its mean, half of the interval (NaN: none is reported), and `count` in words."""

    label: str
    mean: float
    half: float
    count: str


class GroupPlot(Painted):
    """As high as its groups. `unit` is under the axis."""

    accessible_role = QAccessible.Role.Chart

    def __init__(self) -> None:
        super().__init__()
        self.lines: tuple[GroupLine, ...] = ()
        self._unit = ""
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        on_theme(self._apply_theme)

    def show_groups(self, lines: Sequence[GroupLine], unit: str, name: str, in_words: str) -> None:
        """Draw these; a reader of screens gets `name` and `in_words`."""
        self.lines, self._unit = tuple(lines), unit
        self.setAccessibleName(name)
        self.setAccessibleDescription(in_words)
        self._apply_theme()

    @property
    def axis(self) -> tuple[float, float, float]:
        """Give the round ends of the axis and the tick step, in the means' unit."""
        ends = [
            line.mean + sign * (line.half if math.isfinite(line.half) else 0.0)
            for line in self.lines
            for sign in (-1, 1)
        ]
        low, high = (min(ends), max(ends)) if ends else (0.0, 1.0)
        span = max(high - low, 0.02 * max(abs(low), abs(high)), 1e-6)
        power = 10.0 ** math.floor(math.log10(span / MOST_STEPS))
        step = next(one * power for one in STEPS if one * power >= span / MOST_STEPS * (1 - 1e-9))
        return (
            math.floor(low / step + 1e-6) * step,
            math.ceil(high / step - 1e-6) * step + (step if low == high else 0),
            step,
        )

    def x_of(self, value: float) -> float:
        """The place of a value, in px of the widget."""
        low, high, _ = self.axis
        left, right = self._plot()
        return left + (value - low) / (high - low) * (right - left)

    def painted_texts(self) -> list[PaintedText]:
        theme = current_theme()
        px, texts, font = theme.px, [], theme.font(14, MEDIUM)
        label, count = self._label_width(), self._count_width()
        metrics = QFontMetrics(font)
        for k, line in enumerate(self.lines):
            words = metrics.elidedText(line.label, Qt.TextElideMode.ElideRight, label)
            texts.append(PaintedText(words, QRectF(0, k * px(ROW), label + 1, px(ROW)), font, "ink", LEFT))
            box = QRectF(self.width() - count - 1, k * px(ROW), count + 1, px(ROW))
            texts.append(PaintedText(line.count, box, theme.font(14), "ink2", RIGHT))
        top, half = len(self.lines) * px(ROW) + px(TICK + 2), px(HALF_TICK_WORDS)
        for value in self._ticks() if self.lines else ():
            box = QRectF(self.x_of(value) - half, top, 2 * half, px(16))
            texts.append(PaintedText(self._figure(value), box, theme.font(12), "ink2", CENTRE))
        if self.lines:
            left, right = self._plot()
            box = QRectF(left - half, top + px(18), right - left + 2 * half, px(18))
            texts.append(PaintedText(self._unit, box, theme.font(12), "ink2", CENTRE))
        return texts

    def draw(self, painter: QPainter) -> None:
        if not self.lines:
            return
        theme = current_theme()
        c = theme.colours
        bottom = len(self.lines) * px(ROW)
        left, right = self._plot()
        painter.setPen(theme.pen(c.line, 1))
        for value in self._ticks():
            painter.drawLine(QPointF(self.x_of(value), 0), QPointF(self.x_of(value), bottom))
        painter.setPen(theme.pen(c.control, 1))
        painter.drawLine(QPointF(left, bottom), QPointF(right, bottom))
        for value in self._ticks():
            painter.drawLine(QPointF(self.x_of(value), bottom), QPointF(self.x_of(value), bottom + px(TICK)))
        for k, line in enumerate(self.lines):
            self._paint_line(painter, line, (k + 0.5) * px(ROW))

    def event(self, event: QEvent) -> bool:
        """Show the whole of a name that is cut, under the mouse."""
        if isinstance(event, QHelpEvent) and event.type() is QEvent.Type.ToolTip:
            row = int(event.pos().y() // px(ROW))
            is_label = event.pos().x() <= self._label_width() and 0 <= row < len(self.lines)
            QToolTip.showText(event.globalPos(), self.lines[row].label if is_label else "", self)
            return True
        return super().event(event)

    def _paint_line(self, painter: QPainter, line: GroupLine, y: float) -> None:
        """A filled dot has an interval; without one, of too few sessions, it is hollow."""
        theme = current_theme()
        c, cap = theme.colours, theme.px(CAP)
        painter.setPen(theme.pen(c.ink, 1.75))
        if math.isfinite(line.half):
            ends = [self.x_of(line.mean + sign * line.half) for sign in (-1, 1)]
            painter.drawLine(QPointF(ends[0], y), QPointF(ends[1], y))
            for x in ends:
                painter.drawLine(QPointF(x, y - cap), QPointF(x, y + cap))
        painter.setBrush(QColor(c.ink if math.isfinite(line.half) else c.surface))
        painter.drawEllipse(QPointF(self.x_of(line.mean), y), DOT * theme.scale, DOT * theme.scale)
        painter.setBrush(Qt.BrushStyle.NoBrush)

    def _ticks(self) -> list[float]:
        low, high, step = self.axis
        return [low + k * step for k in range(round((high - low) / step) + 1)]

    def _figure(self, value: float) -> str:
        decimals = max(0, -math.floor(math.log10(self.axis[2]) + 1e-9))
        value = value if abs(value) > self.axis[2] * 1e-6 else 0.0
        return figure_text(value, f".{decimals}f").replace("-", MINUS)

    def _plot(self) -> tuple[float, float]:
        inset = px(GAP)
        return self._label_width() + inset, max(
            self.width() - self._count_width() - inset, self._label_width() + 2 * inset
        )

    def _label_width(self) -> int:
        metrics = QFontMetrics(current_theme().font(14, MEDIUM))
        widest = max((metrics.horizontalAdvance(line.label) for line in self.lines), default=0)
        return min(widest + 1, int(self.width() * MOST_LABEL_SHARE))

    def _count_width(self) -> int:
        metrics = QFontMetrics(current_theme().font(14))
        return max((metrics.horizontalAdvance(line.count) for line in self.lines), default=0) + 1

    def _apply_theme(self) -> None:
        """Have a line's height for each group."""
        self.setFixedHeight(len(self.lines) * px(ROW) + px(AXIS))
        self.setMinimumWidth(px(LEAST_PLOT) + self._count_width() + 2 * px(GAP))
        self.update()
