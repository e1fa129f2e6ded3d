"""Results that were computed already, and from what.

The same inputs are never computed twice, other inputs never confused.
"""

import hashlib
from dataclasses import asdict
from typing import Any
from uuid import UUID

from sqlalchemy import delete, select

from app.storage.audit import canonical
from app.storage.database.models import ResultRow
from app.storage.database.values import stored_result
from app.storage.sessions import existing_session
from app.storage.stored import AnalysisInputs, ResultKind, Role, StoredResult
from app.storage.unit_of_work import UnitOfWork

MOST_KEPT = 2  # of a session and kind: what holds, and what did before the last correction, should that be undone


class Results:
    """Calibrations and analyses. They can all be computed again from the journals."""

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit

    def find(self, session_id: UUID, kind: ResultKind, inputs: AnalysisInputs) -> StoredResult | None:
        """What was computed from these very inputs; None: not yet."""
        with self._unit.reading() as session:
            row = session.scalars(_required(session_id, kind, key_of(inputs))).first()
            return None if row is None else stored_result(row)

    def analysed_by(self, algorithm: str) -> frozenset[UUID]:
        """The sessions that have an analysis of this code, even if of what was entered about them before."""
        required = select(ResultRow.session_id).where(
            ResultRow.kind == ResultKind.ANALYSIS, ResultRow.algorithm == algorithm
        )
        with self._unit.reading() as session:
            return frozenset(session.scalars(required))

    def keep(
        self, session_id: UUID, kind: ResultKind, inputs: AnalysisInputs, content_format: str, content: bytes
    ) -> StoredResult:
        """Store a result in place of the eldest or of the same inputs; viewers may, too; raises LibraryError."""
        key = key_of(inputs)
        with self._unit.writing(Role.VIEWER) as session:
            existing_session(session, session_id)
            row = session.scalars(_required(session_id, kind, key)).first()
            if row is not None and (row.format, row.content) != (content_format, content):
                session.delete(row)
                session.flush()
                row = None
            if row is None:
                row = ResultRow(
                    session_id=session_id,
                    kind=kind,
                    key=key,
                    inputs=_plain(inputs),
                    algorithm=inputs.algorithm,
                    format=content_format,
                    content=content,
                    created_at=self._unit.now(),
                )
                session.add(row)
                session.flush()
                other = (ResultRow.session_id == session_id, ResultRow.kind == kind, ResultRow.id != row.id)
                elder = select(ResultRow.id).where(*other).order_by(ResultRow.id.desc())
                too_many = session.scalars(elder.offset(MOST_KEPT - 1)).all()  # never this one: clocks are set back
                session.execute(delete(ResultRow).where(ResultRow.id.in_(too_many)))
            return stored_result(row)


def key_of(inputs: AnalysisInputs) -> str:
    """SHA-256 of all that a result depends on. Figures count to their last bit."""
    return hashlib.sha256(canonical(_plain(inputs)).encode()).hexdigest()


def _plain(inputs: AnalysisInputs) -> dict[str, Any]:
    return asdict(inputs)


def _required(session_id: UUID, kind: ResultKind, key: str) -> Any:
    return select(ResultRow).where(ResultRow.session_id == session_id, ResultRow.kind == kind, ResultRow.key == key)
