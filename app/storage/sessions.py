"""The visits of a library's patients: created, found, corrected, deleted."""

import datetime
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from uuid import UUID

from sqlalchemy import ColumnElement, delete, func, or_, select
from sqlalchemy.orm import Session as OrmSession

from app.storage.audit import about, note
from app.storage.corrections import apply, differences, unchanged
from app.storage.database.models import (
    JointRow,
    PatientRow,
    PlacedSensorRow,
    PlacementRow,
    RecordingRow,
    SessionRow,
)
from app.storage.database.values import SENSOR_FIELDS, SESSION_FIELDS, placement_of, stored_session
from app.storage.edited_fields import SESSION_CORRECTABLE
from app.storage.stored import (
    KEPT_DELETED,
    Action,
    Change,
    LibraryError,
    Limits,
    PlacedSensor,
    Placement,
    Role,
    SessionSummary,
    StoredSession,
)
from app.storage.unit_of_work import UnitOfWork
from app.wording.translation import filled, tr
from core.body import LEG_JOINTS, Joint, Site
from core.session import Session
from devices.files.session_toml import SIGN, ZERO, ExpectedError

NO_LIMITS = Limits()
SEARCHED = (SessionRow.notes, SessionRow.operator, SessionRow.surface, SessionRow.comment, PatientRow.code)


class Sessions:
    """One row for each visit; its recordings are `Recordings`' business."""

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit

    def create(self, patient_id: UUID, reported: Session, limits: Limits = NO_LIMITS) -> StoredSession:
        """Add a visit without recordings; raises LibraryError (no patient, simulated mismatch, out of range)."""
        if reported.recordings or reported.sensors:
            raise ValueError("a session is created without recordings and sensors: place and start them")
        _refuse_wrong_joints(reported)
        with self._unit.writing(Role.CLINICIAN) as session:
            patient = session.get(PatientRow, patient_id)
            if patient is None or patient.deleted_at or patient.merged_into_id:
                raise LibraryError("This patient is no longer in the library", "Reload the list")
            row = SessionRow(
                patient=patient,
                comment="",
                cannot_stand=limits.cannot_stand,
                findings=[asdict(finding) for finding in reported.findings],
                created_at=self._unit.now(),
                joints=[
                    JointRow(
                        joint=joint,
                        zero_rad=reported.zero_rad.get(joint),
                        turned_sign=reported.turned_sign.get(joint),
                        is_absent=_is_absent(joint, limits),
                    )
                    for joint in LEG_JOINTS
                ],
                **{name: getattr(reported, name) for name in SESSION_FIELDS},
            )
            session.add(row)
            session.flush()
            note(self._unit, session, Action.CREATE, about("session", row.id))
            return stored_session(row)

    def get(self, session_id: UUID) -> StoredSession:
        """Give a visit, to go on with what is open already; raises LibraryError where there is none."""
        with self._unit.reading() as session:
            return stored_session(existing_session(session, session_id))

    def view(self, session_id: UUID) -> StoredSession:
        """Give a visit for viewing, noted in the audit; raises LibraryError, also where it cannot be noted."""
        with self._unit.writing(Role.VIEWER) as session:
            row = existing_session(session, session_id)
            note(self._unit, session, Action.VIEW, about("session", session_id))
            return stored_session(row)

    def list(
        self, patient_id: UUID | None = None, text: str = "", is_deleted: bool = False
    ) -> tuple[SessionSummary, ...]:
        """Give visits with `text` in words, conditions or code, latest first; `is_deleted`: the deleted ones."""
        is_required: list[ColumnElement[bool]] = [
            PatientRow.deleted_at.is_(None),
            SessionRow.deleted_at.is_not(None) if is_deleted else SessionRow.deleted_at.is_(None),
        ]
        if patient_id is not None:
            is_required.append(SessionRow.patient_id == patient_id)
        if text := text.strip().lower():
            in_condition = select(RecordingRow.session_id).where(
                func.lower(RecordingRow.condition).contains(text, autoescape=True)
            )
            in_words = [func.lower(column).contains(text, autoescape=True) for column in SEARCHED]
            is_required.append(or_(*in_words, SessionRow.id.in_(in_condition)))
        with self._unit.reading() as session:
            return _lines(session, is_required)

    def change(
        self, visit: StoredSession, reported: Session, comment: str | None = None, limits: Limits | None = None
    ) -> StoredSession:
        """Correct a visit's entries, undoable from the history; raises ChangedMeanwhileError or LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = unchanged(existing_session(session, visit.id), visit.version)
            apply(self._unit, session, session_changes(row, reported, comment, limits), row.patient_id, row.id)
            session.flush()
            return stored_session(row)

    def place(self, session_id: UUID, sensors: Mapping[Site, PlacedSensor]) -> Placement:
        """Store which sensor is worn where from now on; raises LibraryError for one sensor at two sites."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = new_placement(self._unit, session, existing_session(session, session_id), sensors)
            note(self._unit, session, Action.EDIT, about("session", session_id), fields=["placement"])
            return placement_of(row)

    def delete(self, visit: StoredSession) -> None:
        """Take a visit out of sight; it can be restored for 30 days."""
        self._set_deleted(visit, self._unit.now(), Action.DELETE)

    def restore(self, visit: StoredSession) -> None:
        self._set_deleted(visit, None, Action.EDIT)

    def deleted_before(self, before: datetime.datetime) -> tuple[StoredSession, ...]:
        """Find the visits that were deleted, or whose patient was, before an instant."""
        with self._unit.reading() as session:
            needed = select(SessionRow).join(PatientRow)
            rows = session.scalars(needed.where(or_(SessionRow.deleted_at <= before, PatientRow.deleted_at <= before)))
            return tuple(stored_session(row) for row in rows)

    def destroy(self, session_id: UUID) -> None:
        """Remove a visit for good, after its journals' keys; raises LibraryError unless deleted 30 days ago."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = existing_session(session, session_id)
            deleted = [at for at in (row.deleted_at, row.patient.deleted_at) if at is not None]
            refuse_early(min(deleted, default=None), self._unit.now())
            session.execute(delete(SessionRow).where(SessionRow.id == session_id))
            note(self._unit, session, Action.DELETE, about("session", session_id), is_final=True)

    def _set_deleted(self, visit: StoredSession, at: datetime.datetime | None, action: Action) -> None:
        with self._unit.writing(Role.CLINICIAN) as session:
            row = unchanged(existing_session(session, visit.id), visit.version)
            row.deleted_at = at
            note(self._unit, session, action, about("session", visit.id), is_deleted=at is not None)


def new_placement(
    unit: UnitOfWork, session: OrmSession, visit: SessionRow, sensors: Mapping[Site, PlacedSensor]
) -> PlacementRow:
    """Add what is stated now about which sensor is worn where; raises as `Sessions.place`."""
    if len({sensor.name for sensor in sensors.values()}) < len(sensors):
        raise LibraryError("One sensor cannot have two positions", "Assign each sensor once")
    row = PlacementRow(
        session_id=visit.id,
        number=len(visit.placements) + 1,
        made_at=unit.now(),
        made_by=unit.code,
        sensors=[
            PlacedSensorRow(site=site, name=one.name, **{name: getattr(one.info, name) for name in SENSOR_FIELDS})
            for site, one in sensors.items()
        ],
    )
    visit.placements.append(row)
    session.flush()
    return row


def session_changes(
    row: SessionRow,
    reported: Session,
    comment: str | None = None,
    limits: Limits | None = None,
    confirmed: str | None = None,
) -> list[Change]:
    """What has to change in `row` and its joints so that they match `reported`; raises as `Sessions.change`."""
    _refuse_wrong_joints(reported)
    needed = {name: getattr(reported, name) for name in SESSION_CORRECTABLE}
    if comment is not None:
        needed["comment"] = comment
    if confirmed is not None:
        needed["comment_confirmed"] = confirmed
    if limits is not None:
        needed["cannot_stand"] = limits.cannot_stand
    changes = differences(row, needed)
    for joint in row.joints:
        stated: dict[str, object] = {
            "zero_rad": reported.zero_rad.get(joint.joint),
            "turned_sign": reported.turned_sign.get(joint.joint),
        }
        if limits is not None:
            stated["is_absent"] = _is_absent(joint.joint, limits)
        changes += differences(joint, stated)
    return changes


def refuse_early(deleted_at: datetime.datetime | None, now: datetime.datetime) -> None:
    """Raise LibraryError where what is to be destroyed was not deleted long enough ago."""
    if deleted_at is None or now - deleted_at < KEPT_DELETED:
        raise LibraryError(
            tr("Deleted data can be destroyed only after {days} days").format(days=KEPT_DELETED.days),
            "Wait until this period is over",
        )


def _is_absent(joint: Joint, limits: Limits) -> bool:
    return not joint.is_knee and joint.side in limits.without_ankle


def _refuse_wrong_joints(reported: Session) -> None:
    """What no session folder could hold; the limits are its own."""
    try:
        for joint, zero_rad in reported.zero_rad.items():
            ZERO[joint][1](math.degrees(zero_rad))
        for joint, sign in reported.turned_sign.items():
            SIGN[joint][1](sign)
    except ExpectedError as error:
        what = tr("The joint value must be {required}").format(required=filled(error.what, error.values))
        raise LibraryError(what, "Correct the value") from None


def existing_session(session: OrmSession, session_id: UUID) -> SessionRow:
    row = session.get(SessionRow, session_id)
    if row is None:
        raise LibraryError("This session is no longer in the library", "Reload the list")
    return row


def _lines(session: OrmSession, is_required: Sequence[ColumnElement[bool]]) -> tuple[SessionSummary, ...]:
    # columns, not rows: a library may hold thousands of sessions
    visits = (
        select(
            SessionRow.id,
            SessionRow.patient_id,
            PatientRow.code,
            SessionRow.started,
            SessionRow.operator,
            SessionRow.is_simulated,
            SessionRow.deleted_at,
        )
        .join(PatientRow)
        .where(*is_required)
        .order_by(SessionRow.started.desc(), SessionRow.id.desc())
    )
    recordings = (
        select(RecordingRow.session_id, RecordingRow.condition)
        .join(SessionRow)
        .join(PatientRow)
        .where(*is_required)
        .order_by(RecordingRow.number)
    )
    conditions: dict[UUID, list[str]] = {}
    for session_id, condition in session.execute(recordings):
        conditions.setdefault(session_id, []).append(condition)
    lines = []
    for session_id, patient_id, code, started, operator, is_simulated, deleted_at in session.execute(visits):
        own = conditions.get(session_id, [])
        named = tuple(dict.fromkeys(condition for condition in own if condition))
        lines.append(
            SessionSummary(session_id, patient_id, code, started, operator, named, len(own), is_simulated, deleted_at)
        )
    return tuple(lines)
