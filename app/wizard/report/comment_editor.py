"""The clinical comment: a draft from the findings or typed words, printed once somebody has confirmed them."""

from enum import Enum, auto

from PySide6.QtCore import QEvent, QObject, QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QPlainTextEdit, QVBoxLayout, QWidget

from app.theme.current import current_theme, on_theme, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr

HEIGHT, NOTE_HEIGHT = 112, 36
REBUILT_AFTER_MS = 300  # without a key pressed


class CommentState(Enum):
    """How far the words shown are."""

    EMPTY = auto()
    DRAFT = auto()  # from the findings, as they were drafted
    TYPED = auto()
    CONFIRMED = auto()


class CommentEditor(QWidget):
    """Shows words and what becomes of them."""

    edited = Signal(str)  # the words, once the typing pauses
    confirmed = Signal(str)  # the words as they are to be printed
    left = Signal()  # the words have been left by a key

    def __init__(self) -> None:
        super().__init__()
        self.state, self._known = CommentState.EMPTY, ""
        self.field = QPlainTextEdit()
        self.field.setAccessibleName(tr("Clinical comment, optional, printed once confirmed"))
        self.field.setTabChangesFocus(True)
        self.field.installEventFilter(self)
        self.note = Text(size=13, tone="ink2", wraps=True)
        self.note.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.button = Button(tr("Confirm comment"), ButtonKind.SECONDARY, Icon.CHECK, tr("Ctrl Enter"))
        title = Text(tr("Clinical comment"), size=20, weight=SEMIBOLD)
        lay_out(QVBoxLayout(self), title, self.field, self.note, self.button, margins=0, spacing=8)
        scaled(self.field.setFixedHeight, HEIGHT)
        scaled(self.note.setMinimumHeight, NOTE_HEIGHT)  # of two lines, so that nothing moves with the words
        self._pause = QTimer(self)
        self._pause.setSingleShot(True)
        self._pause.setInterval(REBUILT_AFTER_MS)
        self._pause.timeout.connect(self._on_paused)
        self.field.textChanged.connect(self._on_typed)
        self.button.clicked.connect(self._confirm)
        self.show_comment("", CommentState.EMPTY)
        on_theme(self._apply_theme)

    @property
    def words(self) -> str:
        return self.field.toPlainText()

    @property
    def is_typing(self) -> bool:
        """Whether there are words here that were not passed on yet."""
        return self._pause.isActive()

    def show_comment(self, comment: str, state: CommentState, by: str = "") -> None:
        """Show words and how far they are; the typing goes on where it was if they are the same."""
        self._known = comment
        if comment != self.words:
            with QSignalBlocker(self.field):
                self.field.setPlainText(comment)
        self._show_state(state, by)

    def flush(self) -> None:
        """Pass on words that are still being typed."""
        if self._pause.isActive():
            self._pause.stop()
            self._on_paused()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Let Esc leave the words, and Ctrl Enter confirm them: Enter then saves the report."""
        if watched is self.field and isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress:
            is_enter = event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter)
            has_ctrl = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
            if event.key() == Qt.Key.Key_Escape or (is_enter and has_ctrl):
                if is_enter:
                    self._confirm()
                self.left.emit()
                return True
        return super().eventFilter(watched, event)

    def _show_state(self, state: CommentState, by: str = "") -> None:
        self.state = state
        confirmed = (
            tr("Confirmed by {name}. Printed on page one.").format(name=by)
            if by
            else tr("Confirmed. Printed on page one.")
        )
        note = {
            CommentState.EMPTY: tr("Optional. Printed once confirmed."),
            CommentState.DRAFT: tr("Draft from the findings, printed once you confirm it."),
            CommentState.TYPED: tr("Not confirmed, so not printed."),
            CommentState.CONFIRMED: confirmed,
        }[state]
        self.note.setText(note)
        self.button.setEnabled(state in (CommentState.DRAFT, CommentState.TYPED))

    def _confirm(self) -> None:
        if self.words.strip() and self.state is not CommentState.CONFIRMED:
            self._pause.stop()
            self.confirmed.emit(self.words)

    def _on_typed(self) -> None:
        if self.words == self._known:
            return  # another font alone
        self._known = self.words
        self._show_state(CommentState.TYPED if self.words.strip() else CommentState.EMPTY)
        self._pause.start()

    def _on_paused(self) -> None:
        self.edited.emit(self.words)

    def _apply_theme(self) -> None:
        self.field.setFont(current_theme().font(14))
