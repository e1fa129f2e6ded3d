"""A key as its cap shows it, beside a control that the key leads to."""

from PySide6.QtCore import QRectF, QSize
from PySide6.QtGui import QFontMetrics, QPainter
from PySide6.QtWidgets import QSizePolicy

from app.theme.current import current_theme, px
from app.widgets.painted import Painted
from app.widgets.text import MEDIUM

HEIGHT, LEAST, AROUND = 22, 24, 12


class KeyCap(Painted):
    """`words` state what the key does, for screen readers and under the mouse; none where its control names it."""

    def __init__(self, key: str, words: str = "") -> None:
        super().__init__()
        self._key = key
        self.setAccessibleName(words)
        self.setToolTip(words)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)

    def sizeHint(self) -> QSize:
        letters = QFontMetrics(current_theme().font(12, MEDIUM)).horizontalAdvance(self._key)
        return QSize(max(px(LEAST), letters + px(AROUND)), px(HEIGHT))

    def draw(self, painter: QPainter) -> None:
        colours = current_theme().colours
        box = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        current_theme().paint_cap(painter, box, self._key, colours.ink2, colours.control)
