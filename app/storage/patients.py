"""The patients of a library: found, created, corrected, merged, deleted."""

import datetime
from dataclasses import replace
from uuid import UUID

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session as OrmSession

from app.storage.audit import about, note
from app.storage.corrections import apply, differences, unchanged
from app.storage.database.engine import changed_meanwhile
from app.storage.database.models import AuditRow, PatientRow, RecordingRow, SessionRow, folded
from app.storage.database.values import (
    patient_in_row,
    reported_patient,
    stored_patient,
    stored_patients,
)
from app.storage.edited_fields import PATIENT_CORRECTABLE
from app.storage.sessions import refuse_early
from app.storage.stored import (
    Action,
    Change,
    LibraryError,
    RecordingState,
    Role,
    StoredPatient,
    WhatGoes,
)
from app.storage.unit_of_work import UnitOfWork
from app.wording.translation import filled, tr
from core.goals import brought_together, goals_text
from core.prosthesis import prostheses_text
from core.session import Patient
from devices.files.session_toml import PATIENT, ExpectedError

AT_IT = datetime.timedelta(hours=12)  # a working day: who opened a patient within it may have it open still


class Patients:
    """One row for each person, by a code that the clinic gives."""

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit

    def create(self, reported: Patient) -> StoredPatient:
        """Add a patient; raises LibraryError: code empty or taken, or a value out of range."""
        with self._unit.writing(Role.CLINICIAN) as session:
            reported = _checked(reported)
            _refuse_taken(session, reported.code)
            row = PatientRow(created_at=self._unit.now(), **patient_in_row(reported))
            session.add(row)
            session.flush()
            note(self._unit, session, Action.CREATE, about("patient", row.id))
            return stored_patient(session, row)

    def get(self, patient_id: UUID) -> StoredPatient:
        """Give a patient, deleted or not; raises LibraryError where there is none, or destroyed."""
        with self._unit.reading() as session:
            return stored_patient(session, existing_patient(session, patient_id))

    def find(self, code: str) -> StoredPatient | None:
        """The patient with this code, however it is typed, or the one whom that patient was merged into."""
        with self._unit.reading() as session:
            row = session.scalars(select(PatientRow).where(PatientRow.code_folded == folded(code))).first()
            if row is not None and row.merged_into_id is not None:
                row = session.get_one(PatientRow, row.merged_into_id)
            return None if row is None or row.deleted_at else stored_patient(session, row)

    def search(self, text: str = "", is_deleted: bool = False) -> tuple[StoredPatient, ...]:
        """Those whose code holds `text`, the latest seen first; or those that are deleted and can be restored."""
        with self._unit.reading() as session:
            found = stored_patients(
                session,
                PatientRow.code_folded.contains(folded(text), autoescape=True),
                PatientRow.merged_into_id.is_(None),
                PatientRow.deleted_at.is_not(None) if is_deleted else PatientRow.deleted_at.is_(None),
            )
        return tuple(sorted(found, key=lambda patient: (patient.last_session, str(patient.id)), reverse=True))

    def change(self, patient: StoredPatient, reported: Patient) -> StoredPatient:
        """Correct a patient's data, undoable; raises ChangedMeanwhileError, or LibraryError as `create`."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = _current(session, patient)
            apply(self._unit, session, patient_changes(session, row, reported), patient.id)
            session.flush()
            return stored_patient(session, row)

    def merge(self, kept: StoredPatient, double: StoredPatient) -> StoredPatient:
        """Move all of `double` to `kept`, one undoable correction; raises ChangedMeanwhileError, LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row, other = _current(session, kept), _current(session, double)
            if row is other or row.deleted_at or other.deleted_at:
                raise LibraryError("These two patients cannot be merged", "Choose two patients who are not deleted")
            filled = {
                name: getattr(other, name)
                for name in PATIENT_CORRECTABLE
                if getattr(row, name) in (None, "") and getattr(other, name) not in (None, "")
            }
            own, others = (reported_patient(one) for one in (row, other))
            joined = {
                "goals": goals_text(brought_together(own.goals, others.goals)),
                "prostheses": prostheses_text({**others.prostheses, **own.prostheses}),
            }
            moved = session.scalars(select(SessionRow).where(SessionRow.patient_id == other.id))
            changes = differences(row, filled | joined)
            changes += [change for visit in moved for change in differences(visit, {"patient_id": row.id})]
            doubles = [*session.scalars(select(PatientRow).where(PatientRow.merged_into_id == other.id)), other]
            changes += [change for one in doubles for change in differences(one, {"merged_into_id": row.id})]
            apply(self._unit, session, changes, row.id)
            session.flush()
            return stored_patient(session, row)

    def what_goes(self, patient_id: UUID) -> WhatGoes:
        """Give what `delete` would hide and who works with it; raises LibraryError, also if not allowed to."""
        with self._unit.writing(Role.CLINICIAN) as session:
            return self._what_goes(session, existing_patient(session, patient_id))

    def delete(self, patient: StoredPatient, agreed: WhatGoes | None = None) -> StoredPatient:
        """Hide a patient and all sessions, restorable for 30 days; raises ChangedMeanwhileError."""
        return self._set_deleted(patient, self._unit.now(), Action.DELETE, agreed)

    def restore(self, patient: StoredPatient) -> StoredPatient:
        return self._set_deleted(patient, None, Action.EDIT)

    def destroy(self, patient_id: UUID) -> None:
        """Remove a patient for good, after all journals' keys; LibraryError unless deleted 30 days ago."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = existing_patient(session, patient_id)
            refuse_early(row.deleted_at, self._unit.now())
            gone = [row.id, *session.scalars(select(PatientRow.id).where(PatientRow.merged_into_id == row.id))]
            session.execute(delete(SessionRow).where(SessionRow.patient_id.in_(gone)))
            # the doubles before the one that they refer to
            session.execute(delete(PatientRow).where(PatientRow.merged_into_id == row.id))
            session.execute(delete(PatientRow).where(PatientRow.id == row.id))
            note(self._unit, session, Action.DELETE, about("patient", patient_id), is_final=True)

    def _what_goes(self, session: OrmSession, row: PatientRow) -> WhatGoes:
        visits = [
            *session.scalars(
                select(SessionRow.id).where(SessionRow.patient_id == row.id, SessionRow.deleted_at.is_(None))
            )
        ]
        count = select(func.count()).select_from(RecordingRow)
        counted = count.where(RecordingRow.session_id.in_(visits), RecordingRow.state != RecordingState.DISCARDED)
        running = counted.where(RecordingRow.state == RecordingState.OPEN)
        by_others = (
            select(AuditRow)
            .where(AuditRow.subject.in_([about("patient", row.id), *(about("session", one) for one in visits)]))
            .where(AuditRow.operator != self._unit.code)
            .where(AuditRow.action.in_([Action.VIEW, Action.CREATE, Action.EDIT]))
            .order_by(AuditRow.number.desc())
            .limit(1)
        )
        last = session.scalars(by_others).first()
        at = datetime.datetime.fromisoformat(last.at) if last is not None else None
        is_at_it = at is not None and self._unit.now() - at < AT_IT
        return WhatGoes(
            row.id,
            row.code,
            len(visits),
            session.scalar(counted) or 0,
            bool(session.scalar(running)),
            last.operator if last is not None and is_at_it else "",
            at if is_at_it else None,
        )

    def _set_deleted(
        self, patient: StoredPatient, at: datetime.datetime | None, action: Action, agreed: WhatGoes | None = None
    ) -> StoredPatient:
        with self._unit.writing(Role.CLINICIAN) as session:
            row = _current(session, patient)
            if agreed is not None and agreed != self._what_goes(session, row):
                raise changed_meanwhile()
            row.deleted_at = at
            note(self._unit, session, action, about("patient", patient.id), is_deleted=at is not None)
            session.flush()
            return stored_patient(session, row)


def patient_changes(session: OrmSession, row: PatientRow, reported: Patient) -> list[Change]:
    """What has to change in `row` so that it contains what `reported` does; raises as `Patients.change`."""
    reported = _checked(reported)
    if folded(reported.code) != row.code_folded:
        _refuse_taken(session, reported.code)
    return differences(row, patient_in_row(reported, PATIENT_CORRECTABLE))


def existing_patient(session: OrmSession, patient_id: UUID) -> PatientRow:
    row = session.get(PatientRow, patient_id)
    if row is None:
        raise LibraryError("This patient is no longer in the library", "Reload the list")
    return row


def _current(session: OrmSession, patient: StoredPatient) -> PatientRow:
    return unchanged(existing_patient(session, patient.id), patient.version)


def _refuse_taken(session: OrmSession, code: str) -> None:
    row = session.scalars(select(PatientRow).where(PatientRow.code_folded == folded(code))).first()
    if row is None:
        return
    if row.deleted_at is not None:
        raise LibraryError("A deleted patient has this code", "Restore the deleted patient, or choose another code")
    if row.merged_into_id is not None:
        raise LibraryError(
            "The patient with this code was merged with another patient",
            "Open the other patient, or choose another code",
        )
    raise LibraryError("Another patient has this code", "Open the other patient, or choose another code")


def _checked(reported: Patient) -> Patient:
    """What a session folder can hold too; the limits are its own."""
    reported = replace(reported, code=reported.code.strip())
    if not reported.code:
        raise LibraryError("A patient needs a code", "Enter the code your clinic uses for this patient")
    for key, (name, check) in PATIENT.items():
        value = getattr(reported, name)
        try:
            if value is not None:
                check(value)
        except ExpectedError as error:
            what = tr("{field} must be {required}").format(field=key, required=filled(error.what, error.values))
            raise LibraryError(what, "Correct the value") from None
    return reported
