"""A sentence in the place of what is not there yet, and one button that leads on."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QVBoxLayout

from app.theme.icons import Icon
from app.theme.notifier import ThemeNotifier
from app.widgets.button import Button, ButtonKind
from app.widgets.text import SEMIBOLD, Text
from app.widgets.themed import Themed


class SentencePage(Themed):
    pressed = Signal()

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look = look
        self._what = Text(look, size=22, weight=SEMIBOLD, wraps=True)
        self._then = Text(look, size=14, tone="ink2", wraps=True)
        for text in (self._what, self._then):
            text.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.button = Button(look, "", ButtonKind.SECONDARY, Icon.CHEVRON)
        self.button.clicked.connect(self.pressed)
        self._column = QVBoxLayout(self)
        self._column.addStretch(1)
        self._column.addWidget(self._what)
        self._column.addWidget(self._then)
        self._column.addWidget(self.button, 0, Qt.AlignmentFlag.AlignHCenter)
        self._column.addStretch(1)
        self._on_look_changed()

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
        self.button.updateGeometry()

    def _on_look_changed(self) -> None:
        px = self._look.theme.px
        self._column.setContentsMargins(px(24), px(24), px(24), px(24))
        self._column.setSpacing(px(16))
