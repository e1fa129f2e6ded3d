"""A patient agrees to video no longer: asked once more, then all the patient's videos are destroyed."""

from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from app.storage.videos.destroying import withdraw_consent
from app.widgets.question_dialog import QuestionDialog
from app.wording.cameras import withdrawal_words
from app.workers.library_controller import LibraryController

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary

WITHDRAW = "withdraw"


class Withdrawing(QObject):
    done = Signal()
    refused = Signal(str, str)

    def __init__(self, controller: LibraryController, parent: QWidget) -> None:
        super().__init__(parent)
        self._controller, self._window = controller, parent
        self.dialog: QuestionDialog | None = None

    def ask(self, patient_id: UUID) -> None:
        question, follows, answer = withdrawal_words()
        self.dialog = QuestionDialog(question, follows, ((WITHDRAW, answer),), self._window)
        self.dialog.answered.connect(lambda _answer: self._withdraw(patient_id))
        self._controller.locking.connect(self.dialog.reject)
        self.dialog.open()

    def _withdraw(self, patient_id: UUID) -> None:
        def withdraw(opened: "OpenedLibrary") -> int:
            return withdraw_consent(opened, patient_id)

        self._controller.run(withdraw, self._on_withdrawn, self._on_refused, self)

    def _on_withdrawn(self, _count: int) -> None:
        self.done.emit()

    def _on_refused(self, what: str, remedy: str) -> None:
        self.refused.emit(what, remedy)
