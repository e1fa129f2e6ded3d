"""Edits of what another station may have changed meanwhile: merged, and where both changed the same, both reported.

Under the write lock the library compares what was shown, what is entered and what it holds. A value that is contested
stays as the other side has it, and what was entered for it is in the history, made and taken back: whoever is asked
may choose it later, and nothing is lost where nobody answers.
"""

import datetime
import json
from collections.abc import Callable, Mapping, Sequence
from uuid import UUID

from sqlalchemy.orm import Session as OrmSession

from app.storage.corrections import apply, author_of, differences, take_back
from app.storage.database.models import PatientRow, RecordingRow, SessionRow
from app.storage.database.values import placement_of, reported_patient, stored_patient, stored_recording, stored_session
from app.storage.edited_fields import (
    KEPT,
    PLACEMENT,
    patient_fields,
    recording_fields,
    session_fields,
    with_patient_fields,
    with_recording_fields,
    with_session_fields,
)
from app.storage.patients import existing_patient, patient_changes
from app.storage.recordings import decide_row, existing_recording, recording_changes
from app.storage.sessions import existing_session, new_placement, session_changes
from app.storage.stored import (
    Change,
    LibraryError,
    Limits,
    PlacedSensor,
    RecordingState,
    Role,
    StoredPatient,
    StoredRecording,
    StoredSession,
)
from app.storage.three_way import Edited, MergeConflict, OtherChange, Value, Values, three_way
from app.storage.unit_of_work import UnitOfWork
from core.body import Site
from core.session import Session

Changes = Callable[[Values], list[Change]]
Worn = Mapping[Site, PlacedSensor]


class SharedEdits:
    """`base` are the fields as they were shown, `stated` what was made of them; the same fields, or some of them."""

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit

    def patient(self, patient_id: UUID, base: Values, stated: Values) -> Edited[StoredPatient]:
        """Apply edits of a patient; raises LibraryError as `Patients.change`, or if deleted or merged."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = existing_patient(session, patient_id)
            if row.merged_into_id is not None:
                raise LibraryError(
                    "This patient has since been merged with another", "Open the other patient in the list"
                )
            _refuse_deleted(row)

            def changes(values: Values) -> list[Change]:
                return patient_changes(session, row, with_patient_fields(reported_patient(row), values))

            edit = _Edit(self._unit, session, row.id, None, changes)
            contests, others = edit.take(base, stated, patient_fields(reported_patient(row)))
            return Edited(stored_patient(session, row), contests, others)

    def session(self, session_id: UUID, base: Values, stated: Values) -> Edited[StoredSession]:
        """Apply edits of a session; raises LibraryError as `Sessions.change`, or where it was deleted."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = existing_session(session, session_id)
            _refuse_deleted(row)

            def changes(values: Values) -> list[Change]:
                held = stored_session(row)
                return session_changes(row, *with_session_fields(*_whole(held), values))

            held = stored_session(row)
            edit = _Edit(self._unit, session, row.patient_id, row.id, changes)
            contests, others = edit.take(base, stated, session_fields(*_whole(held)))
            return Edited(stored_session(row), contests, others)

    def recording(self, recording_id: UUID, base: Values, stated: Values) -> Edited[StoredRecording]:
        """Apply edits of a recording; raises LibraryError as `Recordings.change`, or for a deleted session."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = existing_recording(session, recording_id)
            edit = self._of_recording(session, row)
            contests, others = edit.take(base, stated, recording_fields(stored_recording(row).details))
            return Edited(stored_recording(row), contests, others)

    def decision(self, recording_id: UUID, is_kept: bool) -> Edited[StoredRecording]:
        """Store whether a recording is kept, contested if another decided otherwise; raises LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = existing_recording(session, recording_id)
            edit = self._of_recording(session, row)
            is_answered = row.is_decided and (row.state is not RecordingState.RECOVERED or bool(row.judged_by))
            if not is_answered:
                decide_row(self._unit, session, session.get_one(SessionRow, row.session_id), row, is_kept)
                return Edited(stored_recording(row))
            contests, _ = edit.take({KEPT: None}, {KEPT: is_kept}, {KEPT: row.is_kept})
            return Edited(stored_recording(row), contests)

    def placement(
        self, session_id: UUID, seen: Mapping[UUID, UUID | None], worn: Sequence[tuple[Sequence[UUID], Worn]]
    ) -> Edited[StoredSession]:
        """Store past recordings' placements, none if one is contested; `seen`: as shown; raises LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            visit = existing_session(session, session_id)
            _refuse_deleted(visit)
            required: list[Change] = []
            contests: list[MergeConflict] = []
            for recording_ids, sensors in worn:
                rows = [existing_recording(session, recording_id) for recording_id in recording_ids]
                other = [row for row in rows if _names(_worn(row)) != _names(sensors)]  # else it is stated already
                if not other:
                    continue
                placement = new_placement(self._unit, session, visit, sensors)
                changes = [change for row in other for change in differences(row, {"placement_id": placement.id})]
                required += changes
                for row, change in zip(other, changes, strict=True):
                    if row.placement_id != seen[row.id] and not contests:
                        by, at = author_of(session, visit.patient_id, change)
                        contests.append(MergeConflict(PLACEMENT, _names(sensors), _names(_worn(row)), by, at))
            if contests:
                take_back(self._unit, session, required, visit.patient_id, visit.id)
            else:
                apply(self._unit, session, required, visit.patient_id, visit.id)
            session.flush()
            session.expire_all()
            return Edited(stored_session(visit), tuple(contests))

    def _of_recording(self, session: OrmSession, row: RecordingRow) -> "_Edit":
        visit = session.get_one(SessionRow, row.session_id)
        _refuse_deleted(visit)

        def changes(values: Values) -> list[Change]:
            return recording_changes(visit, row, with_recording_fields(stored_recording(row).details, values))

        return _Edit(self._unit, session, visit.patient_id, visit.id, changes)


class _Edit:
    """One edit of one thing. `changes` returns what has to change in its rows so that they hold values."""

    def __init__(
        self, unit: UnitOfWork, session: OrmSession, patient_id: UUID, session_id: UUID | None, changes: Changes
    ) -> None:
        self._unit, self._session, self._changes = unit, session, changes
        self._patient_id, self._session_id = patient_id, session_id

    def take(
        self, base: Values, stated: Values, held: Values
    ) -> tuple[tuple[MergeConflict, ...], tuple[OtherChange, ...]]:
        """Write what nobody contests, keep what is contested in the history, and report both."""
        merge = three_way(base, stated, {field: held[field] for field in stated})
        contests = tuple(
            MergeConflict(field, stated[field], held[field], *self._author(field, stated[field]))
            for field in merge.contested
        )
        others = tuple(
            OtherChange(field, merge.merged[field], *self._author(field, base[field])) for field in merge.theirs_only
        )
        apply(self._unit, self._session, self._changes(merge.merged), self._patient_id, self._session_id)
        self._session.flush()
        if contests:
            required = self._changes({contest.field: contest.mine for contest in contests})
            take_back(self._unit, self._session, required, self._patient_id, self._session_id)
        return contests, others

    def _author(self, field: str, another: Value) -> tuple[str, datetime.datetime | None]:
        """Who made a field what it is; `another` is any value that it does not have."""
        change = next(iter(self._changes({field: another})), None)
        return ("", None) if change is None else author_of(self._session, self._patient_id, change)


def _refuse_deleted(row: PatientRow | SessionRow) -> None:
    patient = row if isinstance(row, PatientRow) else row.patient
    if patient.deleted_at is not None:
        raise LibraryError(
            "This patient has since been deleted", "Restore the patient in the settings, then make your change"
        )
    if row.deleted_at is not None:
        raise LibraryError(
            "This session has since been deleted", "Restore the session in the settings, then make your change"
        )


def _worn(row: RecordingRow) -> Worn:
    return placement_of(row.placement).sensors if row.placement is not None else {}


def _names(sensors: Worn) -> str:
    """Which sensor is worn where, in one line that can be compared and read again."""
    return json.dumps({site.value: sensors[site].name for site in Site if site in sensors}, ensure_ascii=False)


def _whole(held: StoredSession) -> tuple[Session, str, Limits, str]:
    """All that can be edited of a session, as `session_fields` takes it."""
    return held.details, held.comment, held.limits, held.comment_confirmed
