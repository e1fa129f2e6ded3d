"""The letter of a walk in its frame, before what the walk is called."""

from PySide6.QtCore import QRectF

from app.theme.current import current_theme, scaled
from app.theme.ground import Ground, set_ground
from app.widgets.painted import Painted
from app.widgets.painted_text import CENTRE, PaintedText
from app.widgets.text import SEMIBOLD

BADGE = 28


class Badge(Painted):
    """A screen reader has the letter from the row that it is in."""

    def __init__(self) -> None:
        super().__init__()
        self._letter, self._tone = "", "ink"
        scaled(self.setFixedSize, BADGE, BADGE)

    def show_letter(self, letter: str, tone: str, ground: Ground) -> None:
        """Show a letter on its ground; without one there is neither."""
        self._letter, self._tone = letter, tone
        set_ground(self, ground if letter else None)
        self.update()

    def painted_texts(self) -> list[PaintedText]:
        font = current_theme().font(14, SEMIBOLD)
        return [PaintedText(self._letter, QRectF(self.rect()), font, self._tone, CENTRE)]
