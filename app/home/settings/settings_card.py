"""A card of the settings: a title, texts as wide as the card, and controls as wide as their words."""

from PySide6.QtWidgets import QHBoxLayout, QWidget

from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text

PADDING, SPACING = 20, 10


class SettingsCard(Card):
    def __init__(self, title: str) -> None:
        super().__init__(padding=PADDING, spacing=SPACING)
        self.fill(Text(title, size=16, weight=SEMIBOLD, wraps=True))

    def fill(self, *parts: QWidget) -> None:
        """Put parts below each other, as wide as the card."""
        lay_out(self.column, *parts)

    def add_left(self, *controls: QWidget) -> None:
        """Give controls the width that they need, one beside the other."""
        self.column.addLayout(lay_out(QHBoxLayout(), *controls, 1))
