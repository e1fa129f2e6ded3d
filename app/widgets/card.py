"""A surface with a hairline round it, on which things that belong together lie."""

from PySide6.QtWidgets import QVBoxLayout

from app.theme.current import scaled
from app.theme.ground import Ground, set_ground
from app.theme.theme import CARD_RADIUS
from app.widgets.themed import Themed


class Card(Themed):
    def __init__(self, padding: float = 16, spacing: float = 8) -> None:
        super().__init__()
        set_ground(self, Ground("surface", "line", radius=CARD_RADIUS))
        self.column = QVBoxLayout(self)
        scaled(self.column.setContentsMargins, padding, padding * 0.75, padding, padding * 0.75)
        scaled(self.column.setSpacing, spacing)
        self._apply_theme()
