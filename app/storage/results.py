"""What was computed already, and from what? The same inputs are never computed twice, other inputs never confused."""

import hashlib
from dataclasses import asdict
from typing import Any
from uuid import UUID

from sqlalchemy import select

from app.storage.audit import canonical
from app.storage.database.models import ResultRow
from app.storage.database.values import stored_result
from app.storage.desk import Desk
from app.storage.stored import AnalysisInputs, ResultKind, Role, StoredResult


class Results:
    """Calibrations and analyses. They can all be computed again from the journals."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def find(self, session_id: UUID, kind: ResultKind, inputs: AnalysisInputs) -> StoredResult | None:
        """What was computed from these very inputs; None: not yet."""
        with self._desk.reading() as session:
            row = session.scalars(_wanted(session_id, kind, key_of(inputs))).first()
            return None if row is None else stored_result(row)

    def keep(
        self, session_id: UUID, kind: ResultKind, inputs: AnalysisInputs, content_format: str, content: bytes
    ) -> StoredResult:
        """Store what was computed. Where two computed it at once, the first one stays: they are equal.

        Raises
        ------
        LibraryError
            There is no such session.
        """
        with self._desk.writing(Role.CLINICIAN) as session:
            row = session.scalars(_wanted(session_id, kind, key_of(inputs))).first()
            if row is None:
                row = ResultRow(
                    session_id=session_id,
                    kind=kind,
                    key=key_of(inputs),
                    inputs=_plain(inputs),
                    algorithm=inputs.algorithm,
                    format=content_format,
                    content=content,
                    created_at=self._desk.now(),
                )
                session.add(row)
                session.flush()
            return stored_result(row)


def key_of(inputs: AnalysisInputs) -> str:
    """SHA-256 of all that a result depends on. Figures count to their last bit."""
    return hashlib.sha256(canonical(_plain(inputs)).encode()).hexdigest()


def _plain(inputs: AnalysisInputs) -> dict[str, Any]:
    return asdict(inputs)


def _wanted(session_id: UUID, kind: ResultKind, key: str) -> Any:
    return select(ResultRow).where(ResultRow.session_id == session_id, ResultRow.kind == kind, ResultRow.key == key)
