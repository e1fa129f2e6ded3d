"""Differences that leave the measurement error. Grey is the error; what leaves it is filled and has arrows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QAccessible, QColor, QFont, QFontMetrics, QPainter
from PySide6.QtWidgets import QSizePolicy

from app.charts.on_screen import DOT, paint_letter
from app.theme.current import current_theme, on_theme, px
from app.theme.icons import Icon, paint_icon
from app.theme.leg_chip import CHIP, paint_chip
from app.widgets.painted import Painted
from app.widgets.painted_text import CENTRE, PaintedText
from app.widgets.text import SEMIBOLD
from app.wording.numbers import MINUS
from core.body import Side

TITLE, ROW, GAP, AXIS = 26, 30, 8, 28
GREY = 24  # height of the error's bar
MARK = 20
LEAST_PLOT = 110
TICK = 4
LEAST_REACH = 3.0  # degrees; smaller differences are not blown up to the whole width
STEPS = (1, 2, 5, 10, 20, 50, 100)


@dataclass(frozen=True, slots=True)
class Dot:
    """One difference, in the unit of its row; `exceeds` the measurement error or not."""

    letter: str
    value: float
    exceeds: bool


@dataclass(frozen=True, slots=True)
class DifferenceRow:
    """`words` describe the last dot; `error` is that of the last dot, NaN where it is not judged."""

    side: Side | None
    words: str
    dots: tuple[Dot, ...]
    error: float

    @property
    def exceeds(self) -> bool:
        return any(dot.exceeds for dot in self.dots)


@dataclass(frozen=True, slots=True)
class DifferenceGroup:
    """One measure, with a row per leg."""

    title: str
    rows: tuple[DifferenceRow, ...]


class DifferencePlot(Painted):
    """As high as its rows."""

    accessible_role = QAccessible.Role.Chart

    def __init__(self) -> None:
        super().__init__()
        self.groups: tuple[DifferenceGroup, ...] = ()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        on_theme(self._apply_theme)

    def show_groups(self, groups: Sequence[DifferenceGroup], name: str, in_words: str) -> None:
        self.groups = tuple(groups)
        self.setAccessibleName(name)
        self.setAccessibleDescription(in_words)
        self._apply_theme()

    @property
    def reach(self) -> float:
        """What lies at either end of the axis."""
        rows = [row for group in self.groups for row in group.rows]
        values = [abs(dot.value) for row in rows for dot in row.dots] + [row.error for row in rows]
        return 1.1 * max([LEAST_REACH, *filter(math.isfinite, values)])

    def x_of(self, value: float) -> float:
        """The place of a difference, in px of the widget."""
        left, right = self._plot()
        return (left + right) / 2 + value / self.reach * (right - left) / 2

    def painted_texts(self) -> list[PaintedText]:
        theme = current_theme()
        texts = []
        for group, top in zip(self.groups, self._tops(), strict=True):
            box = QRectF(0, top, self.width(), theme.px(TITLE))
            texts.append(PaintedText(group.title, box, self._title_font()))
            for k, row in enumerate(group.rows):
                y = top + theme.px(TITLE) + k * theme.px(ROW)
                left = theme.px(CHIP + 8) if row.side is not None else 0
                box = QRectF(left, y, self._words_right() - left, theme.px(ROW))
                texts.append(PaintedText(row.words, box, self._row_font(row), "ink" if row.exceeds else "ink2"))
        for value in self._ticks():
            x, half = self.x_of(value), theme.px(24)
            box = QRectF(x - half, self.height() - theme.px(AXIS - TICK - 2), 2 * half, theme.px(AXIS - TICK - 2))
            words = f"{value:+d}".replace("-", MINUS) if value else "0"
            texts.append(PaintedText(words, box, theme.font(12), "ink2", CENTRE))
        return texts

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c = theme.colours
        for group, top in zip(self.groups, self._tops(), strict=True):
            painter.setPen(theme.pen(c.line, 1))
            painter.drawLine(QPointF(0, top), QPointF(self.width(), top))
            for k, row in enumerate(group.rows):
                self._paint_row(painter, row, top + px(TITLE) + (k + 0.5) * px(ROW))
        if self.groups:
            self._paint_axis(painter)

    def _paint_row(self, painter: QPainter, row: DifferenceRow, middle: float) -> None:
        theme = current_theme()
        c = theme.colours
        if row.side is not None:
            chip = px(CHIP)
            paint_chip(painter, QRectF(0, middle - chip / 2, chip, chip), row.side, theme)
        half = px(GREY) / 2
        if math.isfinite(row.error):
            left, right = self.x_of(-row.error), self.x_of(row.error)
            painter.fillRect(QRectF(left, middle - half, right - left, 2 * half), QColor(c.band_2sd))
        painter.setPen(theme.pen(c.control, 1))
        painter.drawLine(QPointF(self.x_of(0), middle - half), QPointF(self.x_of(0), middle + half))
        colour = QColor(c.ink) if row.side is None else theme.text(row.side)
        if row.dots:
            painter.setPen(theme.pen(colour, 1.75))
            furthest = max(row.dots, key=lambda dot: abs(dot.value))
            painter.drawLine(QPointF(self.x_of(0), middle), QPointF(self.x_of(furthest.value), middle))
        for dot in row.dots:
            paint_letter(painter, theme, dot.letter, QPointF(self.x_of(dot.value), middle), colour, dot.exceeds)
        if row.exceeds:
            side = px(MARK)
            paint_icon(painter, Icon.DIFFERENCE, QRectF(self.width() - side, middle - side / 2, side, side), c.ink)

    def _paint_axis(self, painter: QPainter) -> None:
        theme = current_theme()
        y = self.height() - theme.px(AXIS)
        left, right = self._plot()
        painter.setPen(theme.pen(theme.colours.control, 1))
        painter.drawLine(QPointF(left, y), QPointF(right, y))
        for value in self._ticks():
            painter.drawLine(QPointF(self.x_of(value), y), QPointF(self.x_of(value), y + theme.px(TICK)))

    def _tops(self) -> list[int]:
        px, top = current_theme().px, 0
        tops = []
        for group in self.groups:
            tops.append(top)
            top += px(TITLE) + len(group.rows) * px(ROW) + px(GAP)
        return tops

    def _ticks(self) -> list[int]:
        """Round values, five or six at most."""
        step = next(step for step in STEPS if self.reach / step <= 2.99 or step == STEPS[-1])
        count = int(self.reach / step)
        return [k * step for k in range(-count, count + 1)] if self.groups else []

    def _plot(self) -> tuple[float, float]:
        return self._words_right() + px(DOT), self.width() - px(DOT + MARK + 2)

    def _words_right(self) -> int:
        """Where the words of the rows end, so that all bars begin at the same place."""
        px, rows = current_theme().px, [row for group in self.groups for row in group.rows]
        needs = [
            QFontMetrics(self._row_font(row)).horizontalAdvance(row.words) + (px(CHIP + 8) if row.side else 0)
            for row in rows
        ]
        return max(needs, default=0) + px(8)

    def _title_font(self) -> QFont:
        return current_theme().font(14, SEMIBOLD)

    def _row_font(self, row: DifferenceRow) -> QFont:
        return current_theme().font(14, SEMIBOLD if row.exceeds else QFont.Weight.Normal)

    def _apply_theme(self) -> None:
        title = max((QFontMetrics(self._title_font()).horizontalAdvance(g.title) for g in self.groups), default=0)
        self.setFixedHeight(sum(px(TITLE) + len(g.rows) * px(ROW) + px(GAP) for g in self.groups) + px(AXIS))
        self.setMinimumWidth(max(title, self._words_right() + px(LEAST_PLOT + 2 * DOT + MARK)))
        self.update()
