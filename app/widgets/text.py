"""A piece of text that follows the theme. It is never cut short: it wraps, or it asks for the room it needs."""

import re

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QFont, QPalette
from PySide6.QtWidgets import QLabel, QWidget

from app.theme.current import current_theme, on_theme

REGULAR = QFont.Weight.Normal
MEDIUM = QFont.Weight.Medium
SEMIBOLD = QFont.Weight.DemiBold
JOINER = "\N{WORD JOINER}"
UNIT = re.compile(r"(?<=[m°]/)(?=s\b)")  # m/s and °/s, which Qt would break behind the stroke


class Text(QLabel):
    """`tone` is the token of its colour; `wraps` lets it take several lines."""

    def __init__(
        self,
        text: str = "",
        size: float = 14,
        weight: QFont.Weight = REGULAR,
        tone: str = "ink",
        wraps: bool = False,
        is_code: bool = False,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._size, self._weight, self._tone, self._is_code = size, weight, tone, is_code
        self.setTextFormat(Qt.TextFormat.PlainText)  # what files hold is never markup
        self.setWordWrap(wraps)
        self.setText(text)
        on_theme(self._apply_theme)

    def setText(self, text: str) -> None:  # noqa: N802  Qt names it
        super().setText(UNIT.sub(JOINER, text) if self.wordWrap() else text)

    def text(self) -> str:
        """Give the words as they were given, without what keeps a unit in one line."""
        return super().text().replace(JOINER, "")

    def set_size(self, size: float) -> None:
        if size != self._size:
            self._size = size
            self._apply_theme()

    def set_tone(self, tone: str) -> None:
        if tone != self._tone:
            self._tone = tone
            self._apply_theme()

    def _apply_theme(self) -> None:
        theme = current_theme()
        self.setFont(theme.font(self._size, self._weight, self._is_code))
        palette = self.palette()
        palette.setColor(QPalette.ColorRole.WindowText, QColor(getattr(theme.colours, self._tone)))
        self.setPalette(palette)
