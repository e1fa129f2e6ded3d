"""The patient of a visit, kept as it is typed."""

from collections.abc import Callable
from dataclasses import replace
from enum import Enum, auto

from PySide6.QtCore import QObject, QTimer, Signal

from app.editing.edited_record import EditedRecord
from app.storage.edited_fields import patient_fields, with_patient_fields
from app.storage.opened import OpenedLibrary
from app.storage.stored import StoredPatient
from app.storage.three_way import Edited, Values, rebased
from app.workers.library_controller import LibraryController
from core.session import Patient

SAVED_AFTER_MS = 500  # without a key pressed


class RecordPhase(Enum):
    """What is under way with the library, and whether what is held of the patient may be old."""

    SETTLED = auto()  # nothing is under way; what is held is as it was read or saved last
    BUSY = auto()  # saves
    OVERTAKEN = auto()  # saves or reads a patient in whose place another was chosen: the answer is not this one's
    READING = auto()  # chosen from a list, and being read: what is held may be old
    UNREAD = auto()  # chosen from a list, and could not be read: what is held may be old


class PatientRecord(EditedRecord[StoredPatient]):
    """`reported` is what is on the screen, `stored` what the library holds; the second follows the first.

    A new patient is made by `commit`, when the code has been typed wholly: half a code is nobody's. Whoever types
    another code over that of a patient with sessions means somebody else, and nobody is renamed.
    """

    read_again = Signal()
    """What is on the screen was old."""
    code_taken = Signal(str)

    def __init__(
        self, controller: LibraryController, parent: QObject, refuses: Callable[[str], tuple[str, str]]
    ) -> None:
        """`refuses` returns why a code cannot take the place of the patient's, and what to do; empty where it can."""
        super().__init__(controller, parent)
        self._refuses = refuses
        self.has_this_session_only = False
        """So another code is a correction of this patient's."""
        self.details = Patient()
        self.stored: StoredPatient | None = None
        self._base = patient_fields(self.details)
        """What was shown when `details` were typed."""
        self._sent: Values = {}
        self._phase = RecordPhase.SETTLED
        self._pause = QTimer(self)
        self._pause.setSingleShot(True)
        self._pause.setInterval(SAVED_AFTER_MS)
        self._pause.timeout.connect(self.commit)

    @property
    def is_saved(self) -> bool:
        return not self._may_be_old and self.stored is not None and self.stored.details == self.details

    @property
    def is_busy(self) -> bool:
        """Whether the library is still to answer."""
        return self._phase not in (RecordPhase.SETTLED, RecordPhase.UNREAD)

    @property
    def is_saving(self) -> bool:
        """Whether the library is still to answer, or to be sent what was typed meanwhile."""
        return self.is_busy or self._pause.isActive()

    @property
    def _may_be_old(self) -> bool:
        return self._phase in (RecordPhase.READING, RecordPhase.UNREAD)

    def choose(self, stored: StoredPatient) -> None:
        self._phase = RecordPhase.OVERTAKEN if self.is_busy else RecordPhase.SETTLED
        self._show(stored)

    def choose_from_list(self, listed: StoredPatient) -> None:
        """Choose a patient as a list has it: the visit before may have changed what was entered since it was read."""
        self._phase = RecordPhase.READING
        self._show(listed)
        self._read(listed)

    def edit(self, reported: Patient) -> None:
        """Take what is on the screen; a patient of the library is changed once the typing pauses."""
        self.details = replace(reported, code=reported.code.strip(), device=reported.device.strip())
        if self.stored is not None and self.details.code == self.stored.details.code:
            self._pause.start()

    def commit(self) -> None:
        """Save what is on the screen now, and make the patient if there is none yet."""
        self._pause.stop()
        if self.is_busy or self.is_saved or not self.details.code:
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
        stored, reported = self.stored, self.details
        is_renamed = self.has_this_session_only
        base = self._base
        self._sent = stated = patient_fields(reported)

        def save(opened: OpenedLibrary) -> Edited[StoredPatient] | None:
            patients, edits = opened.library.patients, opened.library.edits
            if stored is not None and stored.details.code == reported.code:
                return edits.patient(stored.id, base, stated)
            found = patients.find(reported.code)
            if found is not None and (stored is None or found.id != stored.id):
                return None
            if found is None and (stored is None or (stored.sessions > 0 and not is_renamed)):
                return Edited(patients.create(reported))
            assert stored is not None
            return edits.patient(stored.id, base, stated)

        self._run(save, self._on_saved)

    def _show(self, stored: StoredPatient) -> None:
        self.stored, self.details, self._base = stored, stored.details, patient_fields(stored.details)
        self.changed.emit()

    def _read(self, listed: StoredPatient) -> None:
        self._phase = RecordPhase.READING
        self._run(lambda opened: opened.library.patients.get(listed.id), self._on_read)

    def _on_read(self, stored: StoredPatient) -> None:
        is_awaited, self._phase = self._may_be_old, RecordPhase.SETTLED
        if is_awaited and self.stored is not None:  # else another was chosen meanwhile
            self._take(stored, self._base)
        else:
            self.changed.emit()
        if not self.is_saved:
            self._pause.start()  # typed meanwhile

    def _on_saved(self, edited: Edited[StoredPatient] | None) -> None:
        is_overtaken = self._phase is not RecordPhase.BUSY
        self._end_work()
        if edited is not None:
            self._ask(edited)  # before anybody goes on
        if is_overtaken:  # it is saved, and another is shown now
            self.changed.emit()
        elif edited is None:
            self.code_taken.emit(self.details.code)
            return
        else:
            self._take(edited.stored, self._sent)
        if edited is not None:
            self._show_message(edited)
        if not self.is_saved:
            self._pause.start()  # typed on meanwhile

    def _take(self, stored: StoredPatient, base: Values) -> None:
        """Go on from what the library holds; what was typed since `base` stays typed."""
        before = patient_fields(self.details)
        self._base, stated = rebased(base, before, patient_fields(stored.details))
        self.stored, self.details = stored, with_patient_fields(stored.details, stated)
        if stated != before:
            self.read_again.emit()
        self.changed.emit()

    def _called(self, stored: StoredPatient) -> str:
        return stored.details.code

    def _choose(self, stored: StoredPatient, base: Values, stated: Values) -> None:
        self._run(lambda opened: opened.library.edits.patient(stored.id, base, stated), self._on_settled)

    def _on_settled(self, edited: Edited[StoredPatient]) -> None:
        self._ask(edited)
        if self.stored is not None and self.stored.id == edited.stored.id:
            self._take(edited.stored, self._base)
        self._show_message(edited)

    def _end_work(self) -> None:
        """Nothing is saved or read any more: what was to be read still is."""
        self._phase = RecordPhase.UNREAD if self._may_be_old else RecordPhase.SETTLED

    def _on_refused(self, what: str, remedy: str) -> None:
        self._end_work()
        super()._on_refused(what, remedy)
