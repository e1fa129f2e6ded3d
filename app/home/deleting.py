"""What is deleted goes out of sight, and can be had back: by a word for a few seconds, in the settings for 30 days."""

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple
from uuid import UUID

from PySide6.QtCore import QObject, Signal

from app.wording import tr
from app.workers.library_controller import LibraryController

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.storage.stored import StoredPatient

Call = Callable[["OpenedLibrary"], UUID]  # the patient's


class _Asked(NamedTuple):
    words: str
    restore: Call


class Deleting(QObject):
    """The last deletion is the one that `undo` takes back.

    Signals
    -------
    done
        What was deleted, in a sentence.
    undone
        The id of the patient who came back, or whose session did.
    """

    done = Signal(str)
    undone = Signal(object)
    refused = Signal(str, str)

    def __init__(self, controller: LibraryController, parent: QObject) -> None:
        super().__init__(parent)
        self._controller = controller
        self._asked: deque[_Asked] = deque()  # and not answered yet, oldest first
        self._restore: Call | None = None

    def patient(self, patient: "StoredPatient") -> None:
        patient_id = patient.id

        def delete(opened: "OpenedLibrary") -> UUID:
            opened.library.patients.delete(opened.library.patients.get(patient_id))
            return patient_id

        def restore(opened: "OpenedLibrary") -> UUID:
            return opened.library.patients.restore(opened.library.patients.get(patient_id)).id

        self._ask(tr("{code} is deleted, for good in 30 days.").format(code=patient.details.code), delete, restore)

    def session(self, session_id: UUID) -> None:
        def delete(opened: "OpenedLibrary") -> UUID:
            session = opened.library.sessions.get(session_id)
            opened.library.sessions.delete(session)
            return session.patient_id

        def restore(opened: "OpenedLibrary") -> UUID:
            session = opened.library.sessions.get(session_id)
            opened.library.sessions.restore(session)
            return session.patient_id

        self._ask(tr("The session is deleted, for good in 30 days."), delete, restore)

    def undo(self) -> None:
        restore, self._restore = self._restore, None
        if restore is not None:
            self._controller.run(restore, self._on_restored, self._on_not_restored, self)

    def forget(self) -> None:
        """Another library is open, or none."""
        self._restore = None

    def _ask(self, words: str, delete: Call, restore: Call) -> None:
        self._asked.append(_Asked(words, restore))
        self._controller.run(delete, self._on_deleted, self._on_not_deleted, self)

    def _on_deleted(self, _patient_id: UUID) -> None:
        words, self._restore = self._asked.popleft()
        self.done.emit(words)

    def _on_not_deleted(self, what: str, remedy: str) -> None:
        self._asked.popleft()
        self.refused.emit(what, remedy)

    def _on_restored(self, patient_id: UUID) -> None:
        self.undone.emit(patient_id)

    def _on_not_restored(self, what: str, remedy: str) -> None:
        self.refused.emit(what, remedy)
