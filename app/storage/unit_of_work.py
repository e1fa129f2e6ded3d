"""Operator at work, and what they may do. Everything that is read or written passes here."""

import datetime
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from sqlalchemy import exists, func, or_, select
from sqlalchemy.orm import Session as OrmSession

from app.storage.clinic.server_state import refuse_closed
from app.storage.database.engine import Database
from app.storage.database.models import OperatorRow, PatientRow, RecordingRow, SessionRow
from app.storage.stored import BEGINNING, Checkpoint, LibraryError, NotAllowedError, Operator, Role
from app.wording.translation import later, tr

END = "end_of_audit"  # by this name a session keeps how far its entries go
ADDED = "entries_added"  # and by this one how many it added
ROLES = {Role.VIEWER: later("viewer"), Role.CLINICIAN: later("clinician"), Role.ADMINISTRATOR: later("administrator")}
DEMO = "DEMO"  # how codes of patients begin that simulated recordings may be kept for


class UnitOfWork:
    """One operator at one library. `operator` is None while nobody is logged in, and then nothing can be done.

    `station`: which one of a clinic's stations this is; empty where the library has none.
    """

    def __init__(
        self,
        database: Database,
        audit_key: bytes,
        now: Callable[[], datetime.datetime],
        is_demonstration: bool,
        station: str = "",
    ) -> None:
        self.database, self.audit_key, self.now, self.is_demonstration = database, audit_key, now, is_demonstration
        self.station = station
        self.operator: Operator | None = None
        self.end_of_audit = BEGINNING
        self.entries_added = 0  # by this program, since it opened the library

    @property
    def code(self) -> str:
        if self.operator is None:
            raise NotAllowedError("No user is logged in", "Log in first")
        return self.operator.code

    @contextmanager
    def reading(self) -> Iterator[OrmSession]:
        """Give one instant of the library; raises NotAllowedError (not logged in) or LibraryError."""
        _ = self.code
        with self.database.reading() as session:
            yield session

    @contextmanager
    def writing(self, needed: Role) -> Iterator[OrmSession]:
        """Write all or nothing under the lock (`Database.writing`); raises NotAllowedError or LibraryError."""
        code = self.code
        with self.database.writing() as session:
            if self.station:
                refuse_closed(session)
            # as it is now: an administrator at another station may have changed it
            row = session.get(OperatorRow, code)
            if row is None or not row.is_active or not row.role.includes(needed):
                raise NotAllowedError(
                    tr("This requires the role {role}").format(role=tr(ROLES[needed])), "Ask someone with this role"
                )
            yield session
            session.flush()
            self._keep_simulated_apart(session)
        self.note_end(session)

    def note_end(self, session: OrmSession) -> None:
        """Keep how far the audit goes, now that what `session` wrote is on the disk."""
        self.entries_added += session.info.pop(ADDED, 0)
        end: Checkpoint = session.info.get(END, BEGINNING)
        if end.number > self.end_of_audit.number:
            self.end_of_audit = end

    def _keep_simulated_apart(self, session: OrmSession) -> None:
        if self.is_demonstration:
            if session.scalar(select(exists().where(RecordingRow.is_simulated.is_(False)))):
                raise LibraryError("The demonstration stores simulated recordings only", "Open your own library")
            return
        misplaced = (
            select(SessionRow.id)
            .join(PatientRow)
            .outerjoin(RecordingRow, RecordingRow.session_id == SessionRow.id)
            .where(func.substr(PatientRow.code, 1, len(DEMO)) != DEMO)
            .where(or_(SessionRow.is_simulated, RecordingRow.is_simulated))
        )
        if session.scalar(select(misplaced.exists())):
            raise LibraryError(
                tr("Simulated recordings belong to patients whose code starts with {start}").format(start=DEMO),
                "Choose or create a patient with such a code",
            )
