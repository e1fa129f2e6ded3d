"""The recordings of a library's sessions: which journals they are in, and what was entered about them."""

import datetime
import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from uuid import UUID

from sqlalchemy import and_, or_, select, update
from sqlalchemy.orm import Session as OrmSession

from app.storage.audit import about, note
from app.storage.corrections import apply, differences, unchanged
from app.storage.database.ids import uuid7
from app.storage.database.models import AuditRow, JournalRow, PatientRow, RecordingRow, SessionRow
from app.storage.database.values import RECORDING_FIELDS, left_out_in_row, stored_recording
from app.storage.edited_fields import RECORDING_CORRECTABLE
from app.storage.sessions import existing_session
from app.storage.stored import (
    Action,
    Change,
    LibraryError,
    RecordingState,
    Role,
    StoredJournal,
    StoredRecording,
    UndecidedWalk,
)
from app.storage.unit_of_work import UnitOfWork
from core.alignment import alignment_text
from core.session import Recording, RecordingKind
from core.timed.protocols import planned_text


class Recordings:
    """One row for each start and stop. The row comes first, then the journal; the samples are there, not here."""

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit

    def new_id(self) -> UUID:
        """For a recording whose row may come later than its journal."""
        return uuid7()

    def start(
        self,
        session_id: UUID,
        reported: Recording,
        is_simulated: bool,
        recording_id: UUID | None = None,
        *,
        is_decided: bool = True,
        began_at: datetime.datetime | None = None,
    ) -> StoredRecording:
        """Add an open recording, worn as the latest placement; `recording_id`: of an unknown journal.
        `is_decided` False: whether it is kept is to be asked; `began_at`: its place in order, None: last.
        Raises LibraryError (no session, name taken, simulated for a patient who is not).
        """
        with self._unit.writing(Role.CLINICIAN) as session:
            visit = existing_session(session, session_id)
            _refuse_taken(visit, reported.name)
            row = RecordingRow(
                id=recording_id or uuid7(),
                session_id=session_id,
                placement=visit.placements[-1] if visit.placements else None,
                number=_free_number(session, visit, began_at),
                is_simulated=is_simulated,
                is_decided=is_decided,
                state=RecordingState.OPEN,
                station=self._unit.station,
                left_out=left_out_in_row(reported.left_out_s),
                alignment=alignment_text(reported.alignment),
                test=planned_text(reported.test),
                **{name: getattr(reported, name) for name in RECORDING_FIELDS},
            )
            session.add(row)
            visit.is_simulated = visit.is_simulated or is_simulated
            session.flush()
            note(self._unit, session, Action.CREATE, about("recording", row.id))
            return stored_recording(row)

    def add_journal(self, recording_id: UUID, journal: StoredJournal) -> None:
        """Register the file and sealing key of the next segment; raises LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = existing_recording(session, recording_id)
            if any(other.segment == journal.segment for other in row.journals):
                raise LibraryError("The recording already has this part", "Recover the recording first")
            row.journals.append(JournalRow(**asdict(journal)))

    def close(self, recording_id: UUID, state: RecordingState, sha256: Mapping[int, str]) -> StoredRecording:
        """End a recording, closed or recovered, with the `sha256` of each segment's file; raises LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = existing_recording(session, recording_id)
            if {journal.segment for journal in row.journals} != set(sha256):
                raise LibraryError("The files of the recording do not match the library", "Recover the recording first")
            for journal in row.journals:
                journal.sha256 = sha256[journal.segment]
            row.state = state
            session.flush()
            note(self._unit, session, Action.EDIT, about("recording", row.id), state=state.value)
            return stored_recording(row)

    def withdraw(self, recording_id: UUID) -> None:
        """Take back a recording that did not begin, freeing its name; LibraryError where it has journals."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = existing_recording(session, recording_id)
            if row.journals:
                raise LibraryError("This recording has already started", "Stop it, then exclude it")
            session.delete(row)
            note(self._unit, session, Action.DELETE, about("recording", row.id), is_final=True)

    def discard(self, recording_id: UUID) -> None:
        """Forget a recording's keys, after those in its files: nothing opens it any more; raises LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = existing_recording(session, recording_id)
            for journal in row.journals:
                journal.wrapped_key = None
            row.state = RecordingState.DISCARDED
            note(self._unit, session, Action.DELETE, about("recording", row.id), is_final=True)

    def change(self, recording: StoredRecording, reported: Recording) -> StoredRecording:
        """Correct a recording's data, undoable; raises ChangedMeanwhileError, LibraryError (name taken)."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = current_recording(session, recording)
            visit = session.get_one(SessionRow, row.session_id)
            apply(self._unit, session, recording_changes(visit, row, reported), visit.patient_id, visit.id)
            session.flush()
            return stored_recording(row)

    def decide(self, recording: StoredRecording, is_kept: bool) -> StoredRecording:
        """Store whether a recording is kept and, after a crash, who decided; raises ChangedMeanwhileError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = current_recording(session, recording)
            decide_row(self._unit, session, session.get_one(SessionRow, row.session_id), row, is_kept)
            return stored_recording(row)

    def find(self, recording_id: UUID) -> StoredRecording | None:
        """The recording that a journal names as its own; None: an orphan."""
        with self._unit.reading() as session:
            row = session.get(RecordingRow, recording_id)
            return None if row is None else stored_recording(row)

    def begun_at(self, utc_s: int) -> tuple[StoredRecording, ...]:
        """Those that were begun in this second since 1970, of no deleted patient or session; oldest first."""
        required = (
            select(RecordingRow.id, RecordingRow.started)
            .join(SessionRow, RecordingRow.session_id == SessionRow.id)
            .join(PatientRow, SessionRow.patient_id == PatientRow.id)
            .where(SessionRow.deleted_at.is_(None), PatientRow.deleted_at.is_(None))
            .where(RecordingRow.state != RecordingState.DISCARDED, RecordingRow.started != "")
            .order_by(RecordingRow.id)
        )
        with self._unit.reading() as session:
            ids = [one for one, started in session.execute(required) if _utc_s(started) == utc_s]
            return tuple(stored_recording(session.get_one(RecordingRow, one)) for one in ids)

    def known(self) -> Mapping[UUID, frozenset[int]]:
        """All that have a row, and which segments it knows of: a journal of any other recording is an orphan."""
        with self._unit.reading() as session:
            segments: dict[UUID, set[int]] = {one: set() for one in session.scalars(select(RecordingRow.id))}
            for recording_id, segment in session.execute(select(JournalRow.recording_id, JournalRow.segment)):
                segments[recording_id].add(segment)
        return {recording_id: frozenset(own) for recording_id, own in segments.items()}

    def note_kept(self, recording_id: UUID, segment: int, kept_as: str) -> None:
        """Store a segment's name in the clinic's shared place; raises LibraryError."""
        with self._unit.writing(Role.VIEWER) as session:  # whoever is logged in when it is handed over
            row = next(
                (one for one in existing_recording(session, recording_id).journals if one.segment == segment), None
            )
            if row is not None:
                row.kept_as = kept_as

    def kept(self, recording_ids: Iterable[UUID]) -> dict[UUID, dict[int, str]]:
        """What segments of these are called in the clinic's shared place, as far as they are there."""
        required = select(JournalRow.recording_id, JournalRow.segment, JournalRow.kept_as).where(
            JournalRow.recording_id.in_(list(recording_ids)), JournalRow.kept_as != ""
        )
        found: dict[UUID, dict[int, str]] = {}
        with self._unit.reading() as session:
            for recording_id, segment, kept_as in session.execute(required):
                found.setdefault(recording_id, {})[segment] = kept_as
        return found

    def destroyed(self, recording_ids: Iterable[UUID]) -> frozenset[UUID]:
        """Which of these were ended and then destroyed for good, as the audit shows even where their rows are gone."""
        ids = {about("recording", one): one for one in recording_ids}
        required = select(AuditRow.subject, AuditRow.action, AuditRow.details).where(AuditRow.subject.in_(ids))
        ended, gone = set(), set()
        with self._unit.reading() as session:
            for subject, action, details in session.execute(required):
                if action == Action.DELETE and "is_final" in json.loads(details):
                    gone.add(ids[subject])
                elif action == Action.EDIT and "state" in json.loads(details):
                    ended.add(ids[subject])  # else it was taken back before it began
        return frozenset(ended & gone)

    def readable_files(self) -> frozenset[str]:
        """Every journal that was not destroyed."""
        required = (
            select(JournalRow)
            .join(RecordingRow)
            .where(RecordingRow.state != RecordingState.DISCARDED, JournalRow.wrapped_key.is_not(None))
        )
        with self._unit.reading() as session:
            return frozenset(journal.file for journal in session.scalars(required))

    def undecided(self) -> tuple[UndecidedWalk, ...]:
        """Give walks neither kept nor discarded (recovered, closed early), in time order, none of the deleted."""
        is_recovered = and_(RecordingRow.state == RecordingState.RECOVERED, RecordingRow.judged_by == "")
        is_closed = and_(
            RecordingRow.state == RecordingState.CLOSED,
            RecordingRow.is_decided.is_(False),
            RecordingRow.station == self._unit.station,  # at another it may be asked at this moment
        )
        required = (
            select(RecordingRow, PatientRow.id, PatientRow.code)
            .join(SessionRow, RecordingRow.session_id == SessionRow.id)
            .join(PatientRow, SessionRow.patient_id == PatientRow.id)
            .where(or_(is_recovered, is_closed), RecordingRow.is_kept)
            .where(RecordingRow.kind == RecordingKind.WALKING, RecordingRow.journals.any())
            .where(SessionRow.deleted_at.is_(None), PatientRow.deleted_at.is_(None))
            .order_by(RecordingRow.id)
        )
        with self._unit.reading() as session:
            return tuple(
                UndecidedWalk(stored_recording(row), patient_id, code)
                for row, patient_id, code in session.execute(required)
            )

    def still_open(self) -> tuple[StoredRecording, ...]:
        """Those of this station that nobody stopped: to be recovered, unless they are being recorded now."""
        with self._unit.reading() as session:
            rows = session.scalars(
                select(RecordingRow)
                .where(RecordingRow.state == RecordingState.OPEN, RecordingRow.station == self._unit.station)
                .order_by(RecordingRow.id)
            )
            return tuple(stored_recording(row) for row in rows)


def _utc_s(started: str) -> int | None:
    try:
        return int(datetime.datetime.fromisoformat(started).timestamp())
    except ValueError:
        return None


def recording_changes(visit: SessionRow, row: RecordingRow, reported: Recording) -> list[Change]:
    """What has to change in `row` so that it contains what `reported` does; raises as `Recordings.change`."""
    if reported.name != row.name:
        _refuse_taken(visit, reported.name)
    required = {name: getattr(reported, name) for name in RECORDING_CORRECTABLE}
    in_row = {"left_out": left_out_in_row(reported.left_out_s), "alignment": alignment_text(reported.alignment)}
    in_row |= {"test": planned_text(reported.test)}
    return differences(row, required | in_row)


def decide_row(unit: UnitOfWork, session: OrmSession, visit: SessionRow, row: RecordingRow, is_kept: bool) -> None:
    """Take the answer whether a recording is kept, as `Recordings.decide`."""
    is_recovered = row.state is RecordingState.RECOVERED
    required: dict[str, object] = {"is_kept": is_kept}
    if is_recovered:
        required["judged_by"] = unit.code
    apply(unit, session, differences(row, required), visit.patient_id, visit.id)
    row.is_decided = True
    session.flush()
    details = {"is_recovered": is_recovered, "is_kept": is_kept}
    note(unit, session, Action.EDIT, about("recording", row.id), **details)


def current_recording(session: OrmSession, recording: StoredRecording) -> RecordingRow:
    """Give the row if it matches `recording`; raises ChangedMeanwhileError."""
    return unchanged(existing_recording(session, recording.id), recording.version)


def _free_number(session: OrmSession, visit: SessionRow, began_at: datetime.datetime | None) -> int:
    """The place of a recording to come; those that come after it are moved on."""
    last = max((other.number for other in visit.recordings), default=0)
    begun = {other.number: _instant(other.started) for other in visit.recordings}
    if began_at is None or all(at is None for at in begun.values()):
        return last + 1
    number = max((place for place, at in begun.items() if at is not None and at <= began_at), default=0) + 1
    later = update(RecordingRow).where(RecordingRow.session_id == visit.id)
    # twice, because no two may have one number at any time
    session.execute(later.where(RecordingRow.number >= number).values(number=-RecordingRow.number - 1))
    session.execute(later.where(RecordingRow.number < 0).values(number=-RecordingRow.number))
    return number


def _instant(started: str) -> datetime.datetime | None:
    """When a recording was begun; without a zone, as clocks show it here. None: nobody has stated it."""
    try:
        return datetime.datetime.fromisoformat(started).astimezone()
    except ValueError:
        return None


def existing_recording(session: OrmSession, recording_id: UUID) -> RecordingRow:
    row = session.get(RecordingRow, recording_id)
    if row is None:
        raise LibraryError("This recording is no longer in the library", "Reload the session")
    return row


def _refuse_taken(visit: SessionRow, name: str) -> None:
    if any(other.name == name for other in visit.recordings):
        raise LibraryError("The session already has a recording of this name", "Choose another name")
