"""What is stated about a recording is asked once, and taken back in the order in which it was stated."""

import json
import time
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import pytest

from app.storage.clinic.rows import copy_rows
from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.schema import bring_up_to_date
from app.storage.journal.payloads import BELONGING, Belonging, key_text, with_keys
from app.storage.library import Library
from app.storage.stored import StoredSession
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.session import Patient, Recording, RecordingKind, Session
from core.timed.protocols import KeyMeaning, PlannedTest, TimedProtocol

WALK = Recording("walk 1", RecordingKind.WALKING, "walk_1", {}, condition="alignment A")

TURNED = replace(
    WALK,
    condition="alignment B",
    alignment=AlignmentChange("alignment A", (PartChange(ProsthesisPart.FOOT_FRONT_SCREW, turns=0.5, text="tight"),)),
)


@pytest.fixture
def visit(library: Library) -> StoredSession:
    return library.sessions.create(library.patients.create(Patient(code="P-1")).id, Session(()))


def test_corrections_are_taken_back_in_their_order_whatever_the_clock_states(
    library: Library, visit: StoredSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Set back between two, it makes the later one's id sort before the earlier one's."""
    walk = library.recordings.start(visit.id, WALK, is_simulated=False)
    first = library.recordings.change(walk, replace(WALK, condition="barefoot"))
    true_ns = time.time_ns
    monkeypatch.setattr(time, "time_ns", lambda: true_ns() - 86_400_000_000_000)
    library.recordings.change(first, replace(WALK, condition="shoes"))
    latest, earliest = library.corrections.of_session(visit.id)
    assert [latest.changes[0].new, earliest.changes[0].new] == ["shoes", "barefoot"]
    assert latest.id < earliest.id  # the clock was set back indeed
    library.corrections.undo(latest.id)
    assert [one.undoes for one in library.corrections.of_session(visit.id)] == [latest.id, None, None]
    library.corrections.undo(earliest.id)
    found = library.recordings.find(walk.id)
    assert found is not None
    assert found.details == WALK


def test_whether_a_walk_is_kept_is_answered_once_for_all(library: Library, visit: StoredSession) -> None:
    asked = library.recordings.start(visit.id, WALK, is_simulated=False, is_decided=False)
    assert not asked.is_decided
    kept = library.recordings.decide(asked, is_kept=True)
    assert (kept.is_decided, kept.details, kept.judged_by) == (True, WALK, "")
    assert library.corrections.of_session(visit.id) == ()
    assert library.audit.entries(f"recording:{asked.id}")[-1].details == '{"is_kept":true,"is_recovered":false}'
    discarded = library.recordings.decide(kept, is_kept=False)
    assert not discarded.details.is_kept
    assert [change.field for change in library.corrections.of_session(visit.id)[0].changes] == ["is_kept"]


def test_what_was_turned_is_in_the_row_and_in_its_history(library: Library, visit: StoredSession) -> None:
    walk = library.recordings.start(visit.id, TURNED, is_simulated=False)
    assert walk.details == TURNED
    changed = library.recordings.change(walk, replace(TURNED, alignment=None))
    assert changed.details.alignment is None
    (correction,) = library.corrections.of_session(visit.id)
    assert [change.field for change in correction.changes] == ["alignment"]
    library.corrections.undo(correction.id)
    found = library.recordings.find(walk.id)
    assert found is not None
    assert found.details == TURNED


def test_what_was_turned_goes_with_the_rows_to_another_database(
    library: Library, visit: StoredSession, tables: Database, tmp_path: Path
) -> None:
    library.recordings.start(visit.id, TURNED, is_simulated=False)
    engine = sqlite_engine(tmp_path / "other.db", bytes(range(32)), try_s=0.1)
    other = Database(engine, busy_s=1.0)
    bring_up_to_date(other)
    with tables.reading() as source, other.writing() as target:
        copy_rows(source.connection(), target.connection())
    with Library(other, bytes(range(32))) as there:
        there.log_in("hk")
        assert there.sessions.get(visit.id).recordings[0].details == TURNED
    engine.dispose()


def test_a_journal_states_what_was_turned_and_one_of_an_earlier_version_is_read() -> None:
    reported_at = UUID(int=1)
    belonging = Belonging(reported_at, TURNED)
    assert Belonging.parsed(belonging.text()) == belonging
    without = replace(WALK, note="")  # which a journal does not say
    earlier = json.loads(Belonging(reported_at, without).text().removeprefix(BELONGING))
    assert "alignment" not in earlier  # which earlier versions could not read
    assert Belonging.parsed(BELONGING + json.dumps(earlier)) == Belonging(reported_at, without)


TIMED = replace(WALK, test=PlannedTest(TimedProtocol.SIX_MINUTES, start_key_s=2.5))


def test_which_test_it_was_is_in_the_row_its_history_and_its_journal(library: Library, visit: StoredSession) -> None:
    walk = library.recordings.start(visit.id, TIMED, is_simulated=False)
    assert walk.details == TIMED
    changed = library.recordings.change(walk, replace(TIMED, test=None))
    assert changed.details.test is None
    (correction,) = library.corrections.of_session(visit.id)
    assert [change.field for change in correction.changes] == ["test"]
    library.corrections.undo(correction.id)
    found = library.recordings.find(walk.id)
    assert found is not None
    assert found.details == TIMED
    belonging = Belonging(UUID(int=1), TIMED)
    assert Belonging.parsed(belonging.text()) == belonging
    assert "test" not in json.loads(Belonging(UUID(int=1), WALK).text().removeprefix(BELONGING))


def test_keys_that_a_journal_shows_are_the_tests_unless_the_row_has_its_own() -> None:
    marks = [(1.0, "left_foot silent"), (2.0, key_text(KeyMeaning.START)), (9.5, key_text(KeyMeaning.END))]
    plain = PlannedTest(TimedProtocol.TEN_METRES)
    assert with_keys(plain, marks) == replace(plain, start_key_s=2.0, end_key_s=9.5)
    assert with_keys(plain, marks[:1]) == plain
    own = replace(plain, end_key_s=8.0)
    assert with_keys(own, marks) == own
    assert with_keys(None, marks) is None
