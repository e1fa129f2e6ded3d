"""The patient of a visit, kept as it is typed."""

from collections.abc import Callable
from dataclasses import fields, replace
from enum import Enum, auto

from PySide6.QtCore import QObject, QTimer, Signal

from app.storage.opened import OpenedLibrary
from app.storage.stored import StoredPatient
from app.workers.library_controller import LibraryController
from core.samples import Patient

SAVED_AFTER_MS = 500  # without a key pressed


class RecordPhase(Enum):
    """What is under way with the library, and whether what is held of the patient may be old."""

    SETTLED = auto()  # nothing is under way; what is held is as it was read or saved last
    BUSY = auto()  # saves
    OVERTAKEN = auto()  # saves or reads a patient in whose place another was chosen: the answer is not this one's
    READING = auto()  # chosen from a list, and being read: what is held may be old
    UNREAD = auto()  # chosen from a list, and could not be read: what is held may be old


class PatientRecord(QObject):
    """`told` is what stands on the screen, `stored` what the library holds; the second follows the first.

    A new patient is made by `commit`, when the code has been typed wholly: half a code is nobody's. Whoever types
    another code over that of a patient with sessions means somebody else, and nobody is renamed.
    """

    changed = Signal()
    read_anew = Signal()
    """What stands on the screen was old."""
    code_taken = Signal(str)
    refused = Signal(str, str)

    def __init__(
        self, controller: LibraryController, parent: QObject, refuses: Callable[[str], tuple[str, str]]
    ) -> None:
        """`refuses` says why a code cannot take the place of the patient's, and what to do; empty where it can."""
        super().__init__(parent)
        self._controller, self._refuses = controller, refuses
        self.has_this_session_only = False
        """So another code is a correction of this patient's."""
        self.details = Patient()
        self.stored: StoredPatient | None = None
        self._phase = RecordPhase.SETTLED
        self._pause = QTimer(self)
        self._pause.setSingleShot(True)
        self._pause.setInterval(SAVED_AFTER_MS)
        self._pause.timeout.connect(self.commit)

    @property
    def is_saved(self) -> bool:
        return not self._may_be_old and self.stored is not None and self.stored.details == self.details

    @property
    def _may_be_old(self) -> bool:
        return self._phase in (RecordPhase.READING, RecordPhase.UNREAD)

    def choose(self, stored: StoredPatient) -> None:
        is_under_way = self._phase not in (RecordPhase.SETTLED, RecordPhase.UNREAD)
        self._phase = RecordPhase.OVERTAKEN if is_under_way else RecordPhase.SETTLED
        self._choose(stored)

    def choose_from_list(self, listed: StoredPatient) -> None:
        """Choose a patient as a list has it: the visit before may have changed what was told since it was read."""
        self._phase = RecordPhase.READING
        self._choose(listed)
        self._read(listed)

    def edit(self, told: Patient) -> None:
        """Take what is on the screen; a patient of the library is changed once the typing pauses."""
        self.details = replace(told, code=told.code.strip(), device=told.device.strip())
        if self.stored is not None and self.details.code == self.stored.details.code:
            self._pause.start()

    def commit(self) -> None:
        """Save what is on the screen now, and make the patient if there is none yet."""
        self._pause.stop()
        is_under_way = self._phase not in (RecordPhase.SETTLED, RecordPhase.UNREAD)
        if is_under_way or self.is_saved or not self.details.code:
            return
        if self._may_be_old and self.stored is not None:
            self._read(self.stored)
            return
        if self.stored is not None and self.details.code != self.stored.details.code:
            what, remedy = self._refuses(self.details.code)
            if what:
                self.details = self.stored.details  # what was typed is another's
                self.refused.emit(what, remedy)
                return
        self._phase = RecordPhase.BUSY
        stored, told = self.stored, self.details
        is_renamed = self.has_this_session_only

        def save(opened: OpenedLibrary) -> StoredPatient | None:
            patients = opened.library.patients
            if stored is not None and stored.details.code == told.code:
                return patients.change(stored, told)
            found = patients.find(told.code)
            if found is not None and (stored is None or found.id != stored.id):
                return None
            if found is None and (stored is None or (stored.sessions > 0 and not is_renamed)):
                return patients.create(told)
            assert stored is not None
            return patients.change(stored, told)

        self._controller.run(save, self._on_saved, self._on_refused, self)

    def _choose(self, stored: StoredPatient) -> None:
        self.stored, self.details = stored, stored.details
        self.changed.emit()

    def _read(self, listed: StoredPatient) -> None:
        self._phase = RecordPhase.READING
        self._controller.run(
            lambda opened: opened.library.patients.get(listed.id), self._on_read, self._on_refused, self
        )

    def _on_read(self, stored: StoredPatient) -> None:
        is_awaited, self._phase = self._may_be_old, RecordPhase.SETTLED
        if is_awaited and self.stored is not None:  # else another was chosen meanwhile
            listed, self.stored = self.stored.details, stored
            every = ((field.name, getattr(self.details, field.name)) for field in fields(Patient))
            typed = {name: told for name, told in every if told != getattr(listed, name)}
            self.details = replace(stored.details, **typed)
            if stored.details != listed:
                self.read_anew.emit()
        self.changed.emit()
        if not self.is_saved:
            self._pause.start()  # typed meanwhile

    def _on_saved(self, stored: StoredPatient | None) -> None:
        is_overtaken = self._phase is not RecordPhase.BUSY
        self._end_work()
        if is_overtaken:  # it is saved, and another stands here now
            stored = self.stored
        if stored is None:
            self.code_taken.emit(self.details.code)
            return
        self.stored = stored
        self.changed.emit()
        if not self.is_saved:
            self._pause.start()  # typed on meanwhile

    def _end_work(self) -> None:
        """Nothing is saved or read any more: what was to be read still is."""
        self._phase = RecordPhase.UNREAD if self._may_be_old else RecordPhase.SETTLED

    def _on_refused(self, what: str, remedy: str) -> None:
        self._end_work()
        self.refused.emit(what, remedy)
