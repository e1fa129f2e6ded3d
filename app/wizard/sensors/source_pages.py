"""Where there are no sensors yet: what they can be reached through, and what is being looked for."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QProgressBar, QVBoxLayout, QWidget

from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr


@dataclass(frozen=True, slots=True)
class SourceOption:
    """Something that sensors can be reached through; `note` is what was found there: "6 found".

    `is_last`: offered after all others, and takes the place of none.
    """

    key: str
    name: str
    note: str = ""
    is_last: bool = False


class NoSource(QWidget):
    """One sentence, the sources that can be opened, and why others are not among them."""

    chosen = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.buttons: list[Button] = []
        self._options: list[SourceOption] = []
        sentence = Text(tr("No sensors yet. Choose where to search."), 20, SEMIBOLD, wraps=True)
        sentence.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.notice = Notice(size=16)
        self._left_out = Text(size=14, tone="ink2", wraps=True)
        self._left_out.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._left_out.hide()
        self._row = lay_out(QVBoxLayout(), spacing=12)
        lay_out(QVBoxLayout(self), self.notice, 1, sentence, self._row, self._left_out, 2, spacing=24)

    def show_message(self, what: str, then: str) -> None:
        """Say why nothing is connected, above the sources that may be tried instead."""
        self.notice.show_message(Icon.WARNING if what else None, what, then, is_caution=bool(what))

    @property
    def left_out(self) -> str:
        return self._left_out.text()

    def show_left_out(self, sentence: str) -> None:
        """Say which sources are not for this patient; "" where there are none."""
        if sentence != self._left_out.text():
            self._left_out.setText(sentence)
        self._left_out.setVisible(bool(sentence))

    def show_options(self, options: Sequence[SourceOption]) -> None:
        """Offer these; the focus stays with the source it was on."""
        if list(options) == self._options:
            return
        focused = next((k for k, button in enumerate(self.buttons) if button.hasFocus()), None)
        focused_key = self._options[focused].key if focused is not None else ""
        for button in self.buttons:
            button.setParent(None)
            button.deleteLater()
        self.buttons, self._options = [], list(options)
        for number, option in enumerate(options):
            button = Button(option.name, ButtonKind.PRIMARY if number == 0 else ButtonKind.SECONDARY)
            button.clicked.connect(self._on_clicked)
            scaled(button.setMinimumWidth, 320)
            self._row.addWidget(button, 0, Qt.AlignmentFlag.AlignHCenter)
            button.show()  # at once: what is not in sight yet takes no focus
            self.buttons.append(button)
            if option.key == focused_key:
                button.setFocus()
        hear_as_laid_out(self)

    def _on_clicked(self) -> None:
        button = self.sender()
        assert isinstance(button, Button)
        self.chosen.emit(self._options[self.buttons.index(button)].key)


class Searching(QWidget):
    """What is looked for or read, and the way out."""

    def __init__(self) -> None:
        super().__init__()
        self._sentence = Text(size=20, weight=SEMIBOLD, wraps=True)
        self._sentence.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._line = QProgressBar()
        self._line.setTextVisible(False)
        self._line.setRange(0, 0)
        self.stop = Button(tr("Stop"), ButtonKind.SECONDARY, Icon.STOP)
        middle = Qt.AlignmentFlag.AlignHCenter
        parts = (1, self._sentence, (self._line, 0, middle), (self.stop, 0, middle), 2)
        lay_out(QVBoxLayout(self), *parts, spacing=20)
        scaled(self._line.setFixedSize, 320, 8)

    def focus(self) -> None:
        self.stop.setFocus()

    def begin(self, sentence: str) -> None:
        self._sentence.setText(sentence)
        self._line.setAccessibleName(sentence)
