"""The cap of a key, beside what the key does where no button shows it."""

from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainter

from app.theme.current import current_theme, scaled
from app.widgets.painted import Painted

CAP = 20


class KeyCap(Painted):
    """`words` state what the key does, for screen readers and under the mouse."""

    def __init__(self, key: str, words: str) -> None:
        super().__init__()
        self._key = key
        self.setAccessibleName(words)
        self.setToolTip(words)
        scaled(self.setFixedSize, CAP, CAP)

    def draw(self, painter: QPainter) -> None:
        theme, box = current_theme(), QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        theme.paint_cap(painter, box, self._key, theme.colours.ink2, theme.colours.control)
