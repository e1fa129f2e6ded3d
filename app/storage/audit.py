"""Record of who did what, and proof that it is whole. Every entry's hash is keyed and covers the hash before it.

This is tamper-evident against outsiders only: who has no data key, a database server's keeper for one, can neither
change, remove, add nor move an entry unseen. They can cut entries off at the end, which a checkpoint kept elsewhere
shows. Whoever has the data key and the skill can make the whole chain again; against them only the checkpoint helps.
Entries name rows by their ids and hold no names and no values, so they may outlive what they report of.
"""

import datetime
import hmac
import json
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, replace
from uuid import UUID

from sqlalchemy import func, select, text
from sqlalchemy.orm import Session as OrmSession

from app.storage.database.engine import ONLY_READS
from app.storage.database.models import AuditRow, ReadingRow
from app.storage.stored import BEGINNING, Action, AuditEntry, AuditFault, AuditReport, Checkpoint, LibraryError, Role
from app.storage.unit_of_work import ADDED, END, UnitOfWork

MANY = 1000  # rows held at a time
APPEND = text("SELECT append_audit(:number, :at, :operator, :action, :subject, :details, :previous_hash, :hash)")
NOTE_READING = text("SELECT note_reading(:by, :did, :subject, :details)")
REPORT_FORMAT = "report"  # the format of an export by which a session is reported
LETTER_FORMAT = "letter"


class Audit:
    """The library's record of what was done."""

    def __init__(self, unit: UnitOfWork) -> None:
        self._unit = unit
        with unit.database.reading() as session:
            first = session.get(AuditRow, 1)
            self.library_id = first.hash[:32] if first is not None else ""

    @property
    def end(self) -> Checkpoint:
        """How far it has come, as far as this program was informed."""
        return self._unit.end_of_audit

    def times(self) -> Iterator[datetime.datetime]:
        """When each entry was made, from the last to the first, by the clock of the computer that made it."""
        required = select(AuditRow.at).order_by(AuditRow.number.desc()).execution_options(yield_per=MANY)
        with self._unit.reading() as session:
            yield from map(datetime.datetime.fromisoformat, session.scalars(required))

    def entries_of_others(self) -> int:
        """Count entries not added by this program, which show that another station acted; raises LibraryError."""
        added = self._unit.entries_added  # first: of its own one more may come meanwhile, which is then looked at twice
        with self._unit.reading() as session:
            return (session.scalar(select(func.max(AuditRow.number))) or 0) - added

    def holds(self, checkpoint: Checkpoint) -> bool:
        """Whether the entry that a checkpoint names is there. The chain is not followed; see `verify`."""
        with self._unit.reading() as session:
            row = session.get(AuditRow, checkpoint.number)
            return row is not None and hmac.compare_digest(row.hash, checkpoint.hash)

    def note_rollback(self, first: int, last: int) -> None:
        """Record that an administrator gives up the seen entries `first` to `last`; raises NotAllowedError."""
        with self._unit.writing(Role.ADMINISTRATOR) as session:
            note(self._unit, session, Action.EDIT, "library", accepted_without_entries=[first, last])

    def note(self, action: Action, subject: str, **details: str | float | bool) -> None:
        """Record an export, print or backup, without names in `details`; on LibraryError it must not be done."""
        with self._unit.writing(Role.VIEWER) as session:
            note(self._unit, session, action, subject, **details)

    @contextmanager
    def exporting(self, subject: str, **details: str | float | bool) -> Iterator[None]:
        """Record an export before it is made, and its abortion; raises LibraryError, and then it is not made."""
        self.note(Action.EXPORT, subject, **details)
        try:
            yield
        except BaseException:
            with suppress(LibraryError):
                self.note(Action.EXPORT, subject, **details, is_broken_off=True)
            raise

    def entries(self, subject: str = "", last: int = 1000) -> tuple[AuditEntry, ...]:
        """The latest entries, oldest first; all of them or those about one `subject`."""
        required = select(AuditRow).order_by(AuditRow.number.desc()).limit(last)
        with self._unit.reading() as session:
            rows = session.scalars(required.where(AuditRow.subject == subject) if subject else required)
            return tuple(entry_of(row) for row in rows)[::-1]

    def reported(self, session_ids: Collection[UUID]) -> frozenset[UUID]:
        """Those sessions whose report was written, as the latest entry about it states."""
        ids = {about("session", session_id): session_id for session_id in session_ids}
        required = select(AuditRow).where(AuditRow.subject.in_(ids), AuditRow.action == Action.EXPORT)
        latest: dict[UUID, bool] = {}
        with self._unit.reading() as session:
            for row in session.scalars(required.order_by(AuditRow.number)):
                details = json.loads(row.details)
                if details.get("format") == REPORT_FORMAT and details.get("is_document", True):
                    latest[ids[row.subject]] = not details.get("is_broken_off", False)
        return frozenset(session_id for session_id, is_written in latest.items() if is_written)

    def deletions(self, subjects: Collection[str]) -> dict[str, AuditEntry]:
        """The latest deletion of each subject that was ever deleted."""
        required = select(AuditRow).where(AuditRow.subject.in_(subjects), AuditRow.action == Action.DELETE)
        with self._unit.reading() as session:
            return {row.subject: entry_of(row) for row in session.scalars(required.order_by(AuditRow.number))}

    def verify(self, checkpoint: Checkpoint = BEGINNING) -> AuditReport:
        """Check every link, and that the chain still holds what `checkpoint` names."""
        with self._unit.reading() as session:
            return verify_rows(session, self._unit.audit_key, checkpoint)


def note(unit: UnitOfWork, session: OrmSession, action: Action, subject: str, **details: object) -> None:
    """Add an entry in the same transaction as what it describes."""
    append(session, unit.audit_key, unit.now(), unit.code, action, subject, details)


def end_of_audit(session: OrmSession) -> Checkpoint:
    last = session.scalars(select(AuditRow).order_by(AuditRow.number.desc()).limit(1)).first()
    return Checkpoint(last.number, last.hash) if last is not None else BEGINNING


def append(
    session: OrmSession,
    key: bytes,
    at: datetime.datetime,
    operator: str,
    action: Action,
    subject: str,
    details: Mapping[str, object],
) -> Checkpoint:
    """Add an entry under the write lock of `session`; a read-only login's waits for a station's next entry."""
    connection = session.connection()
    if connection.info.get(ONLY_READS, False):
        session.execute(
            NOTE_READING, {"by": operator, "did": action, "subject": subject, "details": canonical(details)}
        )
        return end_of_audit(session)
    if connection.dialect.name == "postgresql":
        _add_readings(session, key, at)
    return _link(session, key, _unlinked(at, operator, action, subject, details))


def _add_readings(session: OrmSession, key: bytes, at: datetime.datetime) -> None:
    """Add what logins that only look have noted, each with its own time and login among its details."""
    # a login that only looks writes its readings itself, so nothing in them is taken at its word
    waiting = session.scalars(select(ReadingRow).order_by(ReadingRow.at).limit(MANY)).all()
    for row in waiting:
        details = {"read_at": row.at, "login": row.login, "as": row.action, "details": row.details}
        _link(session, key, _unlinked(at, row.operator, Action.VIEW, row.subject, details))
        session.delete(row)


def _unlinked(
    at: datetime.datetime, operator: str, action: Action, subject: str, details: Mapping[str, object]
) -> AuditEntry:
    """An entry that follows no other yet."""
    stated_at = at.astimezone(datetime.UTC).isoformat()
    return AuditEntry(0, stated_at, operator, action.value, subject, canonical(details), "", "")


def _link(session: OrmSession, key: bytes, unlinked: AuditEntry) -> Checkpoint:
    before = end_of_audit(session)
    unsealed = replace(unlinked, number=before.number + 1, previous_hash=before.hash)
    entry = replace(unsealed, hash=hash_of(unsealed, key))
    if session.connection().dialect.name == "postgresql":  # where nobody but this function may
        session.execute(APPEND, asdict(entry))
    else:
        session.add(AuditRow(**asdict(entry)))
        session.flush()  # the next one in this transaction has to see it
    end = Checkpoint(entry.number, entry.hash)
    session.info[END] = end
    session.info[ADDED] = session.info.get(ADDED, 0) + 1
    return end


def canonical(content: object) -> str:
    """The one way of writing `content` as JSON."""
    return json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)


def hash_of(entry: AuditEntry, key: bytes) -> str:
    """HMAC-SHA256 of all that an entry contains and of the hash before it."""
    content = [entry.number, entry.at, entry.operator, entry.action, entry.subject, entry.details, entry.previous_hash]
    return hmac.digest(key, canonical(content).encode(), "sha256").hex()


def verify_rows(session: OrmSession, key: bytes, checkpoint: Checkpoint = BEGINNING) -> AuditReport:
    rows = session.scalars(select(AuditRow).order_by(AuditRow.number).execution_options(yield_per=MANY))
    return verify(map(entry_of, rows), key, checkpoint)


def verify(entries: Iterable[AuditEntry], key: bytes, checkpoint: Checkpoint = BEGINNING) -> AuditReport:
    """Follow the chain from its beginning; after a fault it goes on from what is there, so one is reported once."""
    end, faults = BEGINNING, []
    is_held = checkpoint.number == 0
    for entry in entries:
        if entry.number != end.number + 1:
            faults.append(AuditFault(entry.number, f"follows number {end.number}"))
        elif entry.previous_hash != end.hash:
            faults.append(AuditFault(entry.number, "does not follow from the entry before"))
        if not hmac.compare_digest(entry.hash, hash_of(entry, key)):
            faults.append(AuditFault(entry.number, "was changed"))
        end = Checkpoint(entry.number, entry.hash)
        is_held = is_held or end == checkpoint
    if not is_held:
        faults.append(AuditFault(checkpoint.number, "is not what the checkpoint names, or is missing"))
    return AuditReport(end, tuple(faults))


def entry_of(row: AuditRow) -> AuditEntry:
    return AuditEntry(**{name: getattr(row, name) for name in AuditEntry.__slots__})


def about(kind: str, row: UUID | str) -> str:
    """How an entry names what it is about."""
    return f"{kind}:{row}"
