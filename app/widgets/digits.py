"""A figure that is read from across the room: every digit in a cell of its own, so that nothing trembles."""

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter
from PySide6.QtWidgets import QSizePolicy, QWidget

from app.theme.current import current_theme, px, scaled
from app.widgets.painted import Painted
from app.widgets.text import SEMIBOLD

UNIT_SHARE = 0.3  # of the figure's size


class Digits(Painted):
    """`widest` is the longest text that is to come, for which the size is made to fit; `size` in px is the most."""

    def __init__(self, size: float, widest: str, unit: str = "", parent: QWidget | None = None):
        super().__init__(parent)
        self._most, self._widest, self._unit, self._text = size, widest, unit, ""
        scaled(self.setMinimumSize, 120, 72)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    @property
    def text(self) -> str:
        return self._text

    def show_text(self, text: str, unit: str | None = None, widest: str | None = None) -> None:
        """Show a figure, with its unit after it. Whoever shows it also has it read out, and not at every frame."""
        shown = (text, self._unit if unit is None else unit, self._widest if widest is None else widest)
        if shown != (self._text, self._unit, self._widest):
            self._text, self._unit, self._widest = shown
            self.update()

    def sizeHint(self) -> QSize:
        return QSize(px(self._most * 2), px(self._most))

    def cells(self) -> list[tuple[str, QRectF]]:
        """Each sign in its cell, from the left; the same place for the same length of text whatever its digits are."""
        size = self._size()
        metrics = QFontMetricsF(current_theme().font(size, SEMIBOLD))
        digit = max(metrics.horizontalAdvance(one) for one in "0123456789")
        found, x = [], 0.0
        for sign in self._text:
            width = digit if sign.isdigit() else metrics.horizontalAdvance(sign)
            found.append((sign, QRectF(x, 0.0, width, self.height())))
            x += width
        return found

    def draw(self, painter: QPainter) -> None:
        theme, size = current_theme(), self._size()
        painter.setPen(QColor(theme.colours.ink))
        painter.setFont(theme.font(size, SEMIBOLD))
        end = 0.0
        for sign, box in self.cells():
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, sign)
            end = box.right()
        if self._unit:
            font = theme.font(size * UNIT_SHARE, SEMIBOLD)
            big, small = QFontMetricsF(theme.font(size, SEMIBOLD)), QFontMetricsF(font)
            baseline = 0.5 * (self.height() + big.ascent() - big.descent())
            painter.setFont(font)
            painter.setPen(QColor(theme.colours.ink2))
            painter.drawText(QRectF(end + theme.px(12), baseline - small.ascent(), 400, small.height()), 0, self._unit)

    def _size(self) -> float:
        """As large as the widest text leaves room for, in logical px."""
        theme = current_theme()
        metrics = QFontMetricsF(theme.font(100.0, SEMIBOLD))
        digit = max(metrics.horizontalAdvance(one) for one in "0123456789")
        wide = sum(digit if one.isdigit() else metrics.horizontalAdvance(one) for one in self._widest)
        unit = QFontMetricsF(theme.font(100.0 * UNIT_SHARE, SEMIBOLD)).horizontalAdvance(self._unit)
        room = max(1.0, self.width() - theme.px(16))
        high = metrics.ascent()
        return max(12.0, min(self._most, 100.0 * room / (wide + unit), 100.0 * self.height() / high))
