"""Whatever is done to the audit by somebody without its key shows, and nobody's entry is lost among many writers."""

import random
import subprocess
import sys
import threading
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest
from sqlalchemy import Engine, text

from app.storage.audit import hash_of, verify
from app.storage.database.engine import Database
from app.storage.derived_keys import derived_from
from app.storage.layout import DATABASE
from app.storage.library import Library
from app.storage.root import ID_FILE
from app.storage.stored import BEGINNING, Action, AuditEntry, Checkpoint, LibraryError, NotAllowedError, Operator, Role
from core.session import Patient

DATA_KEY = bytes(range(32))
KEY = derived_from(DATA_KEY).audit
FORGED = derived_from(bytes(32)).audit
REPORTED = ("at", "operator", "action", "subject", "details")
WRITE = """
import sys
from pathlib import Path
from app.storage.library import Library
from app.storage.stored import Action
with Library.open(Path(sys.argv[1]), bytes(range(32))) as library:
    library.log_in("hk")
    for k in range(int(sys.argv[3])):
        library.audit.note(Action.PRINT, f"writer:{sys.argv[2]}", k=k)
"""


def chain(length: int) -> list[AuditEntry]:
    entries: list[AuditEntry] = []
    for k in range(length):
        before = entries[-1].hash if entries else BEGINNING.hash
        at = datetime(2026, 1, 1, 12, k % 60, tzinfo=UTC).isoformat()
        entry = AuditEntry(k + 1, at, f"op{k % 3}", "view", f"session:{k % 7}", f'{{"k":{k}}}', before, "")
        entries.append(replace(entry, hash=hash_of(entry, KEY)))
    return entries


def linked(entries: list[AuditEntry], start: int) -> list[AuditEntry]:
    """What a forger does who knows all but the key: numbers and hashes from `start` on made again, with another key."""
    result = entries[:start]
    for entry in entries[start:]:
        before = result[-1] if result else None
        number, previous = (before.number + 1, before.hash) if before else (1, BEGINNING.hash)
        entry = replace(entry, number=number, previous_hash=previous)
        result.append(replace(entry, hash=hash_of(entry, FORGED)))
    return result


def renumbered(entries: list[AuditEntry]) -> list[AuditEntry]:
    return [replace(entry, number=k + 1) for k, entry in enumerate(entries)]


def tampered(entries: list[AuditEntry], rng: random.Random) -> list[AuditEntry]:
    """Insert, edit, remove or move something, more or less cleverly."""
    n, changed = len(entries), list(entries)
    at = rng.randrange(n)
    match rng.choice(["insert", "edit", "remove", "swap", "move"]):
        case "insert":
            at = rng.randrange(n + 1)
            changed.insert(at, replace(rng.choice(entries), details=f'{{"forged":{rng.random()}}}'))
        case "edit":
            field = rng.choice(REPORTED)
            changed[at] = replace(entries[at], **{field: getattr(entries[at], field) + rng.choice(" x0")})
        case "remove":
            del changed[at : at + rng.choice([1, 1, 3])]
        case "swap":
            other = rng.choice([k for k in range(n) if k != at])
            at, other = min(at, other), max(at, other)
            changed[at], changed[other] = changed[other], changed[at]
        case "move":
            entry = changed.pop(at)
            other = rng.choice([k for k in range(n) if k != at])
            changed.insert(other, entry)
            at = min(at, other)
    match rng.choice(["as it is", "renumbered", "linked"]):
        case "renumbered":
            return renumbered(changed)
        case "linked":
            return linked(changed, at)
    return changed


@pytest.mark.parametrize("times", [200, pytest.param(1000, marks=pytest.mark.endurance)])
def test_every_insertion_edit_deletion_and_reordering_is_noticed(times: int) -> None:
    entries = chain(60)
    checkpoint = Checkpoint(60, entries[-1].hash)
    rng = random.Random(1)
    unnoticed = 0
    for _ in range(times):
        changed = tampered(entries, rng)
        assert changed != entries
        unnoticed += not verify(changed, KEY, checkpoint).faults
    assert unnoticed == 0
    assert verify(entries, KEY, checkpoint).faults == ()


def test_one_change_is_reported_once_and_where() -> None:
    entries = chain(60)
    entries[30] = replace(entries[30], operator="somebody")
    (fault,) = verify(entries, KEY).faults
    assert (fault.number, fault.what) == (31, "was changed")
    del entries[30]
    (fault,) = verify(entries, KEY).faults
    assert (fault.number, fault.what) == (32, "follows number 30")


def test_a_missing_end_shows_against_a_checkpoint_only() -> None:
    entries = chain(60)
    checkpoint = Checkpoint.parsed(str(verify(entries, KEY).end))
    assert checkpoint == Checkpoint(60, entries[-1].hash)
    assert verify(entries[:50], KEY).faults == ()
    (fault,) = verify(entries[:50], KEY, checkpoint).faults
    assert fault.number == 60
    assert verify(chain(70), KEY, checkpoint).faults == ()


def test_who_has_the_key_can_forge_but_not_against_a_checkpoint() -> None:
    entries = chain(60)
    checkpoint = Checkpoint(60, entries[-1].hash)
    entries[10] = replace(entries[10], operator="somebody")
    forged = entries[:10]
    for entry in entries[10:]:
        entry = replace(entry, previous_hash=forged[-1].hash)
        forged.append(replace(entry, hash=hash_of(entry, KEY)))
    assert verify(forged, KEY).faults == ()
    assert len(verify(forged, KEY, checkpoint).faults) == 1


@pytest.mark.parametrize("words", ["", "gaitwright-audit/1 x y", "gaitwright-audit/2 1 " + "0" * 64])
def test_what_is_no_checkpoint_is_refused(words: str) -> None:
    with pytest.raises(LibraryError, match="not a checkpoint"):
        Checkpoint.parsed(words)


def test_the_library_notes_what_is_done_in_it_and_beside_it(library: Library) -> None:
    patient = library.patients.create(Patient(code="P-1"))
    library.patients.change(patient, replace(patient.details, aids="cane"))
    library.audit.note(Action.BACKUP, "library", bytes=12)
    entries = library.audit.entries()
    assert [entry.action for entry in entries] == ["create", "login", "create", "edit", "backup"]
    assert [entry.number for entry in entries] == [1, 2, 3, 4, 5]
    assert {entry.operator for entry in entries} == {"hk"}
    assert library.audit.entries(f"patient:{patient.id}") == entries[2:4]
    assert library.audit.entries(last=2) == entries[3:]
    report = library.audit.verify()
    assert report.faults == ()
    assert report.end == Checkpoint(5, entries[-1].hash)
    assert library.audit.verify(report.end).faults == ()


def test_the_audit_holds_no_values(library: Library) -> None:
    patient = library.patients.create(Patient(code="Mustermann"))
    library.patients.change(patient, replace(patient.details, aids="Mustermann's cane"))
    assert "Mustermann" not in str(library.audit.entries())


def test_the_database_refuses_to_change_or_remove_an_entry(library: Library, database: Database) -> None:
    def execute(statement: str) -> None:
        with database.writing() as session:
            session.execute(text(statement))

    for statement in ("UPDATE audit SET operator = 'x'", "DELETE FROM audit"):
        with pytest.raises(LibraryError):
            execute(statement)
    assert library.audit.verify().end.number == 2


def test_what_is_changed_in_the_database_is_found_in_the_library(library: Library, database: Database) -> None:
    with database.writing() as session:
        if database.engine.dialect.name == "sqlite":
            session.execute(text("DROP TRIGGER audit_no_update"))
        else:
            session.execute(text("ALTER TABLE audit DISABLE TRIGGER audit_append_only"))
        session.execute(text("UPDATE audit SET operator = 'x' WHERE number = 2"))
    (fault,) = library.audit.verify().faults
    assert fault.number == 2


def test_what_is_rolled_back_is_not_noted(library: Library) -> None:
    library.patients.create(Patient(code="P-1"))
    end = library.audit.verify().end
    with pytest.raises(LibraryError, match="has this code"):
        library.patients.create(Patient(code="p-1"))
    assert library.audit.verify().end == end


def test_eight_writers_at_once_make_one_chain(
    library: Library, database: Database, make_engine: Callable[[], Engine]
) -> None:
    failed: list[Exception] = []

    def write(writer: int) -> None:
        try:
            with Library(Database(make_engine(), busy_s=60.0), DATA_KEY) as own:
                own.log_in("hk")
                for k in range(12):
                    own.audit.note(Action.PRINT, f"writer:{writer}", k=k)
        except Exception as error:  # it is shown below
            failed.append(error)

    writers = [threading.Thread(target=write, args=(writer,)) for writer in range(8)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert failed == []
    report = library.audit.verify()
    assert report.faults == ()
    assert report.end.number == 2 + 8 * 13
    for number in range(8):
        assert [entry.details for entry in library.audit.entries(f"writer:{number}")] == [
            f'{{"k":{k}}}' for k in range(12)
        ]


@pytest.mark.endurance
def test_eight_processes_at_once_make_one_chain(tmp_path: Path) -> None:
    with Library.create(tmp_path, DATA_KEY, Operator("hk", "", Role.ADMINISTRATOR)) as library:
        command = [sys.executable, "-c", WRITE, str(tmp_path)]
        writers = [subprocess.Popen([*command, str(writer), "200"]) for writer in range(8)]
        assert [writer.wait() for writer in writers] == [0] * 8
        report = library.audit.verify()
        assert report.faults == ()
        assert report.end.number == 2 + 8 * 201
    assert {path.name for path in tmp_path.iterdir()} == {DATABASE, ID_FILE}


def test_nobody_logged_in_can_neither_read_nor_write_it(library: Library) -> None:
    library.log_out()
    with pytest.raises(NotAllowedError, match="Log in"):
        library.audit.entries()
    with pytest.raises(NotAllowedError, match="Log in"):
        library.audit.note(Action.PRINT, "x")
