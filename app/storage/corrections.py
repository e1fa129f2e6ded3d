"""Corrections made after the fact: what, by whom and when, and how they are taken back."""

import datetime
import uuid
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from enum import StrEnum
from itertools import pairwise
from typing import Any, TypeVar
from uuid import UUID

from sqlalchemy import ColumnElement, func, or_, select
from sqlalchemy.orm import DeclarativeBase, aliased
from sqlalchemy.orm import Session as OrmSession
from sqlalchemy.orm.attributes import flag_modified

from app.storage.audit import about, note
from app.storage.database.engine import changed_meanwhile
from app.storage.database.ids import uuid7
from app.storage.database.models import (
    CorrectionRow,
    JointRow,
    OperatorRow,
    PatientRow,
    RecordingRow,
    SessionRow,
    Versioned,
)
from app.storage.stored import Action, Change, Correction, LibraryError, Role
from app.storage.unit_of_work import UnitOfWork

CORRECTED: Mapping[str, type[DeclarativeBase]] = {
    row.__tablename__: row for row in (PatientRow, SessionRow, JointRow, RecordingRow)
}
Value = str | float | bool | None
SEARCHED = 500  # of a patient's corrections, the latest
R = TypeVar("R", bound=Versioned)


class Corrections:
    """The history of patients and sessions."""

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit

    def of_patient(self, patient_id: UUID) -> tuple[Correction, ...]:
        """All that was corrected about a patient and the patient's sessions, latest first."""
        with self._unit.reading() as session:
            own = select(SessionRow.id).where(SessionRow.patient_id == patient_id)
            return _listed(session, or_(CorrectionRow.patient_id == patient_id, CorrectionRow.session_id.in_(own)))

    def of_session(self, session_id: UUID) -> tuple[Correction, ...]:
        """Latest first."""
        with self._unit.reading() as session:
            return _listed(session, CorrectionRow.session_id == session_id)

    def undo(self, correction_id: UUID) -> None:
        """Put back what a correction changed, undone by itself; raises ChangedMeanwhileError, LibraryError."""
        with self._unit.writing(Role.CLINICIAN) as session:
            row = session.get(CorrectionRow, correction_id)
            if row is None:
                raise LibraryError("This correction no longer exists", "Reload this view")
            if session.scalar(select(CorrectionRow.id).where(CorrectionRow.undoes_id == row.id)):
                raise LibraryError("This correction was already undone", "Reload this view")
            back = [Change(c.table, c.row, c.field, old=c.new, new=c.old) for c in reversed(_changes(row))]
            apply(self._unit, session, back, row.patient_id, row.session_id, undoes=row.id)


def unchanged(row: R, version: int) -> R:
    """Give the row if it has the version that was shown; raises ChangedMeanwhileError."""
    if row.version != version:
        raise changed_meanwhile()
    return row


def apply(
    unit: UnitOfWork,
    session: OrmSession,
    changes: Sequence[Change],
    patient_id: UUID,
    session_id: UUID | None = None,
    undoes: UUID | None = None,
) -> UUID | None:
    """Apply `changes` and give the correction's id, None if nothing changes; raises ChangedMeanwhileError."""
    if not changes:
        return None
    for change in changes:
        row: Any = session.get(CORRECTED[change.table], change.row)
        if row is None or plain(getattr(row, change.field)) != change.old:
            raise changed_meanwhile()
        setattr(row, change.field, _typed(type(row), change.field, change.new))
        if isinstance(row, JointRow):  # it is part of its session, whose version has to show it
            flag_modified(session.get_one(SessionRow, row.session_id), "started")
    last = session.scalar(select(func.max(CorrectionRow.number))) or 0  # the write lock is held: nobody takes the next
    correction = CorrectionRow(
        id=uuid7(),
        number=last + 1,
        patient_id=patient_id,
        session_id=session_id,
        at=unit.now(),
        operator=unit.code,
        changes=[{**asdict(change), "row": str(change.row)} for change in changes],
        undoes_id=undoes,
    )
    session.add(correction)
    details: dict[str, object] = {"fields": sorted({change.field for change in changes}), "correction": correction.id}
    subject = about("patient", patient_id) if session_id is None else about("session", session_id)
    note(unit, session, Action.EDIT, subject, **{key: plain(value) for key, value in details.items()})
    return correction.id


def take_back(
    unit: UnitOfWork, session: OrmSession, changes: Sequence[Change], patient_id: UUID, session_id: UUID | None = None
) -> None:
    """Make `changes` and take them back at once: they were requested, did not take effect, and are in the history."""
    session.flush()
    made = apply(unit, session, changes, patient_id, session_id)
    session.flush()
    back = [Change(c.table, c.row, c.field, old=c.new, new=c.old) for c in reversed(changes)]
    apply(unit, session, back, patient_id, session_id, undoes=made)
    session.flush()


def author_of(session: OrmSession, patient_id: UUID, change: Change) -> tuple[str, datetime.datetime | None]:
    """Who made one value of a row what it is, `change.old`, and when; nobody where no correction names them."""
    latest = select(CorrectionRow).where(CorrectionRow.patient_id == patient_id).order_by(CorrectionRow.number.desc())
    rows = session.scalars(latest.limit(SEARCHED)).all()
    taken_back = {
        one.id
        for later, before in pairwise(rows)
        if later.undoes_id == before.id and later.operator == before.operator
        for one in (later, before)
    }
    required = (change.table, change.row, change.field, change.old)
    for row in rows:
        made = {(one.table, one.row, one.field, one.new) for one in _changes(row)}
        if row.id not in taken_back and required in made:
            operator = session.get(OperatorRow, row.operator)
            return (operator.name if operator is not None else "") or row.operator, row.at
    return "", None


def differences(row: Any, required: Mapping[str, object]) -> list[Change]:
    """What has to change in `row` so that its fields are as `required`."""
    pairs = ((field, plain(getattr(row, field)), plain(value)) for field, value in required.items())
    return [Change(row.__tablename__, row.id, field, old, new) for field, old, new in pairs if old != new]


def plain(value: Any) -> Any:
    """A value as JSON holds it."""
    return str(value) if isinstance(value, UUID | StrEnum) else value


def _typed(row: type[DeclarativeBase], field: str, value: Value) -> object:
    if not isinstance(value, str):
        return value
    return row.__table__.columns[field].type.python_type(value)


def _changes(row: CorrectionRow) -> list[Change]:
    return [Change(**{**record, "row": uuid.UUID(record["row"])}) for record in row.changes]


def _listed(session: OrmSession, is_required: ColumnElement[bool]) -> tuple[Correction, ...]:
    undoing = aliased(CorrectionRow)
    required = (
        select(CorrectionRow, undoing.id)
        .outerjoin(undoing, undoing.undoes_id == CorrectionRow.id)
        .where(is_required)
        .order_by(CorrectionRow.number.desc())
    )
    return tuple(
        Correction(row.id, row.at, row.operator, tuple(_changes(row)), row.undoes_id, is_undone=undone_by is not None)
        for row, undone_by in session.execute(required)
    )
