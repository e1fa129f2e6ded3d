"""A few figures beside a sentence: each under its name, with what belongs to it below."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QRectF, QSize
from PySide6.QtGui import QAccessible, QFontMetrics, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy

from app.theme.notifier import ThemeNotifier
from app.widgets.painted_text import LEFT, PaintedText
from app.widgets.text import SEMIBOLD
from app.widgets.themed import Themed

CELL, HEIGHT = 108, 76
PADDING = 12
ROWS = (0, 22, 50)  # where each line begins, px
ROW_HEIGHTS = (22, 28, 22)
NAME, VALUE, NOTE = 12, 20, 12


@dataclass(frozen=True, slots=True)
class KeyFigure:
    """`key` distinguishes it from the others in every language. `value` is a dash or a word where it is not known,
    and then without `unit`; `words` is how it is read out.
    """

    key: str
    name: str
    value: str
    unit: str
    note: str
    words: str


class FactStrip(Themed):
    """As wide as its figures need; with a hairline before each."""

    accessible_role = QAccessible.Role.Grouping

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self.figures: Sequence[KeyFigure] = ()
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def show_figures(self, figures: Sequence[KeyFigure]) -> None:
        self.figures = tuple(figures)
        self.setAccessibleName(" ".join(figure.words for figure in figures))
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(sum(self._widths()), self._look.theme.px(HEIGHT))

    def texts(self) -> list[PaintedText]:
        """What is painted, and where."""
        theme = self._look.theme
        px, found, left = theme.px, [], 0
        for figure, width in zip(self.figures, self._widths(), strict=True):
            x, room = left + px(PADDING), width - px(PADDING)
            boxes = [QRectF(x, px(ROWS[k]), room, px(ROW_HEIGHTS[k])) for k in range(3)]
            value = theme.font(VALUE, SEMIBOLD)
            found += [
                PaintedText(figure.name, boxes[0], theme.font(NAME), "ink2"),
                PaintedText(figure.value, boxes[1], value),
                PaintedText(figure.note, boxes[2], theme.font(NOTE), "ink2"),
            ]
            if figure.unit:
                after = QFontMetrics(value).horizontalAdvance(figure.value) + px(4)
                found.append(
                    PaintedText(figure.unit, boxes[1].adjusted(after, px(2), 0, px(2)), theme.font(NAME), "ink2", LEFT)
                )
            left += width
        return [text for text in found if text.text]

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        painter = QPainter(self)
        left = 0
        painter.setPen(theme.pen(theme.colours.line, 1))
        for width in self._widths():
            painter.drawLine(left, 0, left, self.height())
            left += width
        for text in self.texts():
            text.paint(painter, theme.colours)

    def _widths(self) -> list[int]:
        theme = self._look.theme
        small, large = QFontMetrics(theme.font(NAME)), QFontMetrics(theme.font(VALUE, SEMIBOLD))
        found = []
        for figure in self.figures:
            unit = theme.px(4) + small.horizontalAdvance(figure.unit) if figure.unit else 0
            lines = (
                small.horizontalAdvance(figure.name),
                large.horizontalAdvance(figure.value) + unit,
                small.horizontalAdvance(figure.note),
            )
            found.append(max(theme.px(CELL), max(lines) + 2 * theme.px(PADDING)))
        return found

    def _on_look_changed(self) -> None:
        self.updateGeometry()
        self.update()
