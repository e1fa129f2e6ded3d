"""A surface with a hairline round it, on which things that belong together lie."""

from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QVBoxLayout

from app.theme.current import current_theme
from app.theme.theme import CARD_RADIUS
from app.widgets.themed import Themed


class Card(Themed):
    def __init__(self, padding: float = 16, spacing: float = 8) -> None:
        super().__init__()
        self._padding, self._spacing = padding, spacing
        self.column = QVBoxLayout(self)
        self._apply_theme()

    def paintEvent(self, _event: QPaintEvent) -> None:
        c, box = current_theme().colours, QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        current_theme().paint_box(QPainter(self), box, c.surface, c.line, 1, CARD_RADIUS)

    def _apply_theme(self) -> None:
        px = current_theme().px
        side = px(self._padding)
        self.column.setContentsMargins(side, px(self._padding * 0.75), side, px(self._padding * 0.75))
        self.column.setSpacing(px(self._spacing))
