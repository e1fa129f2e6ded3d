"""What was just done and can be undone. It goes by itself, but not while somebody reaches for it."""

from PySide6.QtCore import QEvent, QTimer, Signal
from PySide6.QtGui import (
    QAccessible,
    QAccessibleAnnouncementEvent,
    QEnterEvent,
    QHideEvent,
)
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QWidget

from app.theme.current import on_theme, px
from app.theme.ground import Ground, set_ground
from app.widgets.action_bar import BarAction, VerbButton
from app.widgets.button import ButtonKind
from app.widgets.lay_out import lay_out
from app.widgets.text import Text
from app.wording.translation import tr

WIDTH = 320
HEIGHT = 56
STAYS_MS = 6000


class Toast(QWidget):
    """Hidden until it has something to offer. The shell places it and knows its key."""

    accessible_role = QAccessible.Role.AlertMessage

    undone = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._room = 10_000
        set_ground(self, Ground("inv", "surface"))  # with a line that shows on the inverse bar too
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self._text = Text(tone="inv_ink", wraps=True)
        self.button = VerbButton(self)
        self._clock = QTimer(self)
        self._clock.setSingleShot(True)
        self._clock.setInterval(STAYS_MS)
        lay_out(QHBoxLayout(self), (self._text, 1), self.button, margins=(16, 4, 4, 4), spacing=12)
        self._clock.timeout.connect(self._on_timeout)
        self.button.clicked.connect(self.undo)
        self.hide()
        on_theme(self._fit)

    @property
    def text(self) -> str:
        return self._text.text()

    def offer(self, what: str) -> None:
        """Show what was done; what was shown before can no longer be undone from here."""
        self._text.setText(what)
        self.button.show_verb(BarAction(tr("Undo"), self.undo, tr("Ctrl Z")), ButtonKind.QUIET, is_inverse=True)
        self.setAccessibleName(what)
        self._fit()
        self.show()
        self.raise_()
        if not self.underMouse():
            self._clock.start()
        words = tr("{what} Press Ctrl Z to undo.").format(what=what)
        QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, words))

    def set_room(self, width: int) -> None:
        """Say how many pixels wide it may be at most."""
        if width != self._room:
            self._room = width
            self._fit()

    def undo(self) -> None:
        """Ask for what is offered to be taken back, if it still is."""
        if self.isVisible():
            self.hide()
            self.undone.emit()

    def enterEvent(self, event: QEnterEvent) -> None:
        super().enterEvent(event)
        self._clock.stop()

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        if self.isVisible():
            self._clock.start()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._clock.stop()

    def _on_timeout(self) -> None:
        if self.button.hasFocus():
            self._clock.start()  # who has come to it by Tab is about to press it
        else:
            self.hide()

    def _fit(self) -> None:
        width = min(max(px(WIDTH), self.button.sizeHint().width() + px(180 + 32)), self._room)
        room = width - self.button.sizeHint().width() - px(16 + 12 + 4)
        self.setFixedSize(width, max(px(HEIGHT), self._text.heightForWidth(room) + px(16)))
