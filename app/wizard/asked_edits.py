"""What two stations changed is asked about one question after the other, never amid a recording or under the lock."""

from collections import deque
from collections.abc import Callable

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from app.editing.dialog import EditDialog
from app.editing.question import EditQuestion
from app.wizard.visit import Visit


class AskedEdits(QObject):
    """`may_ask` returns whether a dialog may open now; `go_on` is to be called when that may have changed."""

    def __init__(self, window: QWidget, may_ask: Callable[[], bool]) -> None:
        super().__init__(window)
        self._window, self._may_ask = window, may_ask
        self._asked: deque[tuple[Visit, EditQuestion]] = deque()
        self._is_covered = False
        self.dialog: EditDialog | None = None

    def ask(self, visit: Visit, question: EditQuestion) -> None:
        self._asked.append((visit, question))
        self.go_on()

    def go_on(self) -> None:
        """Ask the next question, if there is one and nothing forbids it."""
        if not self._asked or self.dialog is not None or self._is_covered or not self._may_ask():
            return
        self.dialog = EditDialog(self._asked[0][1], self._window)
        self.dialog.settled.connect(self._on_settled)
        self.dialog.open()

    def cover(self, is_covered: bool) -> None:
        """Show nothing of a patient while the window is locked; what was asked is asked again after it."""
        self._is_covered = is_covered
        if is_covered and self.dialog is not None:
            dialog, self.dialog = self.dialog, None
            dialog.settled.disconnect(self._on_settled)
            dialog.close()
        self.go_on()

    def forget(self) -> None:
        """Ask no more: the library is closed, and holds the others' values with ours in its history."""
        self._asked.clear()
        self.cover(is_covered=True)
        self._is_covered = False

    def _on_settled(self, fields: frozenset[str]) -> None:
        self.dialog = None
        visit, question = self._asked.popleft()
        visit.settle(question, fields)
        self.go_on()
