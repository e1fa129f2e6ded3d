"""A surface with a hairline round it, on which things that belong together lie."""

from PySide6.QtCore import QRectF
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QVBoxLayout

from app.theme.notifier import ThemeNotifier
from app.theme.theme import CARD_RADIUS
from app.widgets.themed import Themed


class Card(Themed):
    def __init__(self, look: ThemeNotifier, padding: float = 16, spacing: float = 8) -> None:
        super().__init__()
        self._look, self._padding, self._spacing = look, padding, spacing
        self.column = QVBoxLayout(self)
        self._on_look_changed()

    def paintEvent(self, _event: QPaintEvent) -> None:
        c, box = self._look.theme.colours, QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
        self._look.theme.paint_box(QPainter(self), box, c.surface, c.line, 1, CARD_RADIUS)

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        side = px(self._padding)
        self.column.setContentsMargins(side, px(self._padding * 0.75), side, px(self._padding * 0.75))
        self.column.setSpacing(px(self._spacing))
