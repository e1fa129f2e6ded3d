"""A surface with a hairline round it, on which things that belong together lie."""

from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.theme import CARD_RADIUS, Look


class Card(QWidget):
    def __init__(self, look: Look, padding: float = 16, spacing: float = 8) -> None:
        super().__init__()
        self._look, self._padding, self._spacing = look, padding, spacing
        self.column = QVBoxLayout(self)
        look.changed.connect(self._on_look_changed)
        self._on_look_changed()

    def paintEvent(self, _event: QPaintEvent) -> None:
        theme = self._look.theme
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(theme.pen(theme.colours.line, 1))
        painter.setBrush(QColor(theme.colours.surface))
        radius = CARD_RADIUS * theme.scale
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), radius, radius)

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        side = px(self._padding)
        self.column.setContentsMargins(side, px(self._padding * 0.75), side, px(self._padding * 0.75))
        self.column.setSpacing(px(self._spacing))
        self.update()
