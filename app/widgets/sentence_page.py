"""A sentence in the place of what is not there yet, and one button that leads on."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text


class SentencePage(QWidget):
    pressed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._what = Text(size=22, weight=SEMIBOLD, wraps=True)
        self._then = Text(size=14, tone="ink2", wraps=True)
        for text in (self._what, self._then):
            text.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.button = Button("", ButtonKind.SECONDARY, Icon.CHEVRON)
        self.button.clicked.connect(self.pressed)
        parts = (1, self._what, self._then, (self.button, 0, Qt.AlignmentFlag.AlignHCenter), 1)
        lay_out(QVBoxLayout(self), *parts, margins=24, spacing=16)

    def focus(self) -> None:
        """Give the focus to the button; without one the bar has it."""
        if self.button.isVisibleTo(self):
            self.button.setFocus()

    def show_sentence(self, what: str, then: str = "", button: str = "") -> None:
        """Say what is not there, what follows or what to do, and what the button does; without words there is none."""
        self._what.setText(what)
        self._then.setText(then)
        self._then.setVisible(bool(then))
        self.button.setText(button)
        self.button.setAccessibleName(button)
        self.button.setVisible(bool(button))
