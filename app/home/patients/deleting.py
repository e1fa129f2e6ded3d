"""What is deleted goes out of sight, and can be had back: by a word for a few seconds, in the settings for 30 days."""

import datetime
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple
from uuid import UUID

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from app.home.patients.deletion_dialog import DeletionDialog
from app.wording.translation import tr
from app.workers.library_controller import LibraryController

if TYPE_CHECKING:
    from app.storage.opened import OpenedLibrary
    from app.storage.stored import WhatGoes

Call = Callable[["OpenedLibrary"], UUID]  # the patient's


class _Asked(NamedTuple):
    words: str
    restore: Call


class Deleting(QObject):
    """The last deletion is the one that `undo` takes back."""

    done = Signal(str)  # what was deleted, in a sentence
    undone = Signal(object)  # the id of the patient who came back, or whose session did
    refused = Signal(str, str)

    def __init__(self, controller: LibraryController, parent: QWidget) -> None:
        super().__init__(parent)
        self._controller, self._window = controller, parent
        self.dialog: DeletionDialog | None = None
        self._goes: WhatGoes | None = None  # of the patient whom the dialog is about
        self._asked: deque[_Asked] = deque()  # and not answered yet, oldest first
        self._undoing: deque[_Asked] = deque()
        self._last: _Asked | None = None  # which can be undone

    def patient(self, patient_id: UUID) -> None:
        """Ask whether a patient is to be deleted, once it is known what goes."""

        def read(opened: "OpenedLibrary") -> "WhatGoes":
            return opened.library.patients.what_goes(patient_id)

        self._controller.run(read, self._on_read, self._on_not_read, self)

    def close_dialog(self) -> None:
        """Ask no more: the window is locked, or the library left. Nothing is deleted."""
        self._goes = None
        if self.dialog is not None:
            self.dialog.close()

    def _on_read(self, goes: "WhatGoes") -> None:
        self.close_dialog()
        if not self._window.isVisible():  # it was locked meanwhile
            return
        self._goes = goes
        self.dialog = DeletionDialog(goes, datetime.datetime.now().astimezone(), self._window)
        self.dialog.confirmed.connect(self._on_confirmed)
        self.dialog.finished.connect(self._on_finished)
        self.dialog.open()

    def _on_not_read(self, what: str, remedy: str) -> None:
        self.refused.emit(what, remedy)

    def _on_finished(self, _result: int) -> None:
        self.dialog = None
        self._window.window().activateWindow()  # its keys undo; not every desktop gives the keyboard back by itself

    def _on_confirmed(self) -> None:
        goes, self._goes = self._goes, None
        if goes is None:
            return
        patient_id = goes.patient_id

        def delete(opened: "OpenedLibrary") -> UUID:
            opened.library.patients.delete(opened.library.patients.get(patient_id), goes)
            return patient_id

        def restore(opened: "OpenedLibrary") -> UUID:
            return opened.library.patients.restore(opened.library.patients.get(patient_id)).id

        self._ask(
            tr("{code} was deleted. The deletion becomes permanent in 30 days.").format(code=goes.code), delete, restore
        )

    def session(self, session_id: UUID) -> None:
        def delete(opened: "OpenedLibrary") -> UUID:
            session = opened.library.sessions.get(session_id)
            opened.library.sessions.delete(session)
            return session.patient_id

        def restore(opened: "OpenedLibrary") -> UUID:
            session = opened.library.sessions.get(session_id)
            opened.library.sessions.restore(session)
            return session.patient_id

        self._ask(tr("The session was deleted. The deletion becomes permanent in 30 days."), delete, restore)

    def undo(self) -> None:
        last, self._last = self._last, None
        if last is not None:
            self._undoing.append(last)
            self._controller.run(last.restore, self._on_restored, self._on_not_restored, self)

    def forget(self) -> None:
        """Another library is open, or none."""
        self._last = None
        self._undoing.clear()
        self.close_dialog()

    def _ask(self, words: str, delete: Call, restore: Call) -> None:
        self._asked.append(_Asked(words, restore))
        self._controller.run(delete, self._on_deleted, self._on_not_deleted, self)

    def _on_deleted(self, _patient_id: UUID) -> None:
        self._last = self._asked.popleft()
        self.done.emit(self._last.words)

    def _on_not_deleted(self, what: str, remedy: str) -> None:
        self._asked.popleft()
        self.refused.emit(what, remedy)

    def _on_restored(self, patient_id: UUID) -> None:
        if self._undoing:
            self._undoing.popleft()
        self.undone.emit(patient_id)

    def _on_not_restored(self, what: str, remedy: str) -> None:
        asked = self._undoing.popleft() if self._undoing else None
        if asked is not None and self._last is None:  # nothing else was deleted since: it is offered again
            self._last = asked
            self.done.emit(asked.words)
        self.refused.emit(what, remedy)
