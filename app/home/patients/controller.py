"""Sessions that home shows. The patients are read from the library, and all of the one who is chosen."""

import datetime
from dataclasses import dataclass
from typing import TYPE_CHECKING
from uuid import UUID

from PySide6.QtCore import QObject, QTimer, Signal

from app.editing.deleted_elsewhere import deleted_by, deletion_message
from app.home.patients.home_page import HomePage
from app.home.patients.lines import patient_line
from app.home.patients.reading import PatientReading, read_patient
from app.summary.course_lanes import CourseVisit
from app.summary.progress_words import ProgressWords
from app.widgets.line_list import PatientLine
from app.wording.patients import aids_in_words, person
from app.workers.library_controller import LibraryController

if TYPE_CHECKING:
    from collections.abc import Callable

    from app.storage import stored
    from app.storage.opened import OpenedLibrary

LOOK_AFTER_MS = 50  # nobody types or scrolls any more


@dataclass(frozen=True, slots=True)
class _Patients:
    """All patients, and which of them have a walk that was recovered and is not decided yet.

    `required` is to be chosen now that they are read; None: who is chosen then. `deleted_by`: who deleted the patient
    that was in sight, if another did.
    """

    every: "tuple[stored.StoredPatient, ...]"
    undecided: frozenset[UUID]
    required: UUID | None
    deleted_by: str = ""


class PatientsAtHome(QObject):
    """`is_awaited` returns for a patient's code whether sessions are still being made, as in the demonstration."""

    chosen = Signal()  # who is in sight, or nobody
    refused = Signal(str, str)

    def __init__(
        self, controller: LibraryController, page: HomePage, is_awaited: "Callable[[str], bool]", parent: QObject
    ) -> None:
        super().__init__(parent)
        self._controller, self._page, self._is_awaited = controller, page, is_awaited
        self._patients: dict[UUID, stored.StoredPatient] = {}
        self._is_forgotten = True
        self._sessions_of: UUID | None = None  # the patient whose sessions are shown, or being read
        self._reading: PatientReading | None = None
        self._changes: dict[UUID, ProgressWords] = {}
        self._undecided: frozenset[UUID] = frozenset()
        self._fresh: set[UUID] = set()  # whose change is of what the library holds now
        self._is_looking = False
        self._looking = QTimer(self, singleShot=True, interval=LOOK_AFTER_MS)
        self._looking.timeout.connect(self._look_for_changes)
        page.patient_chosen.connect(self._on_chosen)
        page.patients.scrolled.connect(self._looking.start)
        page.patients.fitted.connect(self._looking.start)

    @property
    def patient(self) -> "stored.StoredPatient | None":
        """The patient whose sessions are shown."""
        return self.known(self._page.patient_id) if self._page.patient_id is not None else None

    def known(self, patient_id: UUID) -> "stored.StoredPatient | None":
        """A patient of those that were read; None: not among them, or no longer."""
        return self._patients.get(patient_id)

    @property
    def visits(self) -> tuple[CourseVisit, ...]:
        """Those of the patient in sight."""
        return self._reading.visits(_now()) if self._reading is not None else ()

    def read(self, required: UUID | None = None, *, is_deleted_here: bool = False) -> None:
        """Read the patients and choose `required`, else the former one; who deleted it is shown, unless here."""
        self._is_forgotten = False
        shown = None if is_deleted_here else self.patient

        def read(opened: "OpenedLibrary") -> _Patients:
            undecided = frozenset(walk.patient_id for walk in opened.library.recordings.undecided())
            every = opened.library.patients.search()
            is_gone = shown is not None and all(one.id != shown.id for one in every)
            by = deleted_by(opened, shown.id) if shown is not None and is_gone else ""
            return _Patients(every, undecided, required, by)

        self._controller.run(read, self._on_read, self._on_refused, self)

    def forget(self) -> None:
        """Keep nothing of any patient, nor what is still being read."""
        self._is_forgotten = True
        self._looking.stop()
        self._patients.clear()
        self._changes.clear()
        self._fresh.clear()
        self._sessions_of = self._reading = None
        self._page.search.clear()
        self._page.forget_patients()
        self._page.show_patient("", "")

    def _on_read(self, patients: _Patients) -> None:
        if self._is_forgotten:  # the library was left meanwhile
            return
        before = self.patient
        if patients.deleted_by and before is not None:
            self.refused.emit(*deletion_message(before.details.code, patients.deleted_by))
        self._patients = {patient.id: patient for patient in patients.every}
        self._undecided = patients.undecided
        self._fresh.clear()
        now = _now()
        self._page.show_patients([self._line(patient, now) for patient in patients.every], patients.required)
        self._on_chosen(self._page.patient_id)

    def _on_chosen(self, patient_id: UUID | None) -> None:
        patient = self.known(patient_id) if patient_id is not None else None
        self.chosen.emit()
        if patient is None:
            self._sessions_of = self._reading = None
            self._page.show_patient("", "")
            self._page.forget_sessions()
            return
        reported = patient.details
        self._page.show_patient(
            reported.code, " · ".join(filter(None, [person(reported), reported.device, aids_in_words(reported.aids)]))
        )
        own = patient.id
        if own != self._sessions_of:  # what is there is another patient's
            self._sessions_of, self._reading = own, None
            self._page.forget_sessions()

        def read(opened: "OpenedLibrary") -> PatientReading:
            return read_patient(opened, own)

        self._controller.run(read, self._on_sessions, self._on_refused, self)

    def _on_sessions(self, reading: PatientReading) -> None:
        if self._is_forgotten or reading.patient_id != self._page.patient_id:
            return  # another was chosen meanwhile
        if reading == self._reading:
            return  # somebody may be moving in what is there
        now = _now()
        self._reading = reading
        patient = self.patient
        self._page.panel.say_none_yet(is_awaited=patient is not None and self._is_awaited(patient.details.code))
        self._page.show_sessions(
            reading.lines(now),
            reading.visits(now),
            reading.next_step(now),
            reading.goals,
            is_simulated=reading.is_simulated,
            has_video_consent=reading.has_video_consent,
        )
        self._show_change(reading)

    def _line(self, patient: "stored.StoredPatient", now: datetime.datetime) -> PatientLine:
        return patient_line(patient, now, patient.id in self._undecided, self._changes.get(patient.id))

    def _look_for_changes(self) -> None:
        """Read changes of the patients in sight only, one at a time; thousands would take minutes."""
        seen = [line.id for line in self._page.patients.in_sight]
        one = next((own for own in seen if own in self._patients and own not in self._fresh), None)
        if one is None or self._is_looking or self._is_forgotten:
            return
        if not self._patients[one].sessions:
            self._fresh.add(one)
            self._looking.start()
            return
        self._is_looking = True

        def read(opened: "OpenedLibrary") -> PatientReading:
            return read_patient(opened, one)

        self._controller.run(read, self._on_change_read, self._on_no_change, self)

    def _on_change_read(self, reading: PatientReading) -> None:
        self._is_looking = False
        if self._is_forgotten:
            return
        self._show_change(reading)
        self._look_for_changes()

    def _on_no_change(self, _what: str, _remedy: str) -> None:
        """Whoever chooses the patient learns why; the list goes without."""
        self._is_looking = False

    def _show_change(self, reading: PatientReading) -> None:
        patient, now = self._patients.get(reading.patient_id), _now()
        self._fresh.add(reading.patient_id)
        if patient is not None:
            self._changes[reading.patient_id] = reading.progress(now)
            self._page.change_patient(self._line(patient, now))

    def _on_refused(self, what: str, remedy: str) -> None:
        self.refused.emit(what, remedy)


def _now() -> datetime.datetime:
    return datetime.datetime.now().astimezone()
