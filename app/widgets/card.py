"""A surface with a hairline round it, on which things that belong together lie."""

from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.theme.current import scaled
from app.theme.ground import Ground, set_ground
from app.theme.theme import CARD_RADIUS


class Card(QWidget):
    def __init__(self, padding: float = 16, spacing: float = 8) -> None:
        super().__init__()
        set_ground(self, Ground("surface", "line", radius=CARD_RADIUS))
        self.column = QVBoxLayout(self)
        self.set_padding(padding)
        scaled(self.column.setSpacing, spacing)

    def set_padding(self, padding: float) -> None:
        """Leave so much at the sides, px of the design, and three quarters of it above and below."""
        side = padding or 0.5  # one pixel: the line round the card stays in sight
        scaled(self.column.setContentsMargins, side, side * 0.75, side, side * 0.75)
