"""A question before something that cannot be taken back, or that leaves the library."""

from collections.abc import Sequence
from functools import partial

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QBoxLayout, QDialog, QHBoxLayout, QVBoxLayout, QWidget

from app.theme.current import px
from app.theme.ground import Ground, set_ground
from app.widgets.button import Button, ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr

WIDTH, EDGE = 520, 24


class QuestionDialog(QDialog):
    """Enter and Escape both leave everything as it is: an answer is pressed, or reached by Tab.

    `answers`: what each is called by whoever asks, and its words. `answered`: which of them was pressed.
    """

    answered = Signal(str)

    def __init__(
        self, title: str, sentences: Sequence[str], answers: Sequence[tuple[str, str]], parent: QWidget
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.cancel = Button(tr("Cancel"), ButtonKind.PRIMARY, key=tr("Esc"))
        self.answers = {name: Button(words, ButtonKind.SECONDARY) for name, words in answers}
        for name, button in self.answers.items():
            button.clicked.connect(partial(self._on_answer, name))
        self.cancel.clicked.connect(self.reject)
        width = min(px(WIDTH), parent.window().width() - px(EDGE))
        needed = sum(button.sizeHint().width() for button in (*self.answers.values(), self.cancel))
        does_fit = needed + px(2 * EDGE + 8 * len(self.answers)) <= width
        buttons = lay_out(QHBoxLayout(), *self.answers.values(), 1, self.cancel)
        if not does_fit:
            buttons.setDirection(QBoxLayout.Direction.TopToBottom)
        words = [Text(title, size=20, weight=SEMIBOLD, wraps=True), *(Text(one, wraps=True) for one in sentences)]
        column = lay_out(QVBoxLayout(self), *words, buttons)
        lay_out(column, margins=(EDGE, 20, EDGE, 20), spacing=12)
        set_ground(self, Ground("surface", radius=0, inset=0))
        self.resize(width, column.totalHeightForWidth(width))
        self.cancel.setFocus()

    def _on_answer(self, name: str) -> None:
        self.accept()
        self.answered.emit(name)
