"""What is said of a recording is asked once, and taken back in the order in which it was said."""

import time
from dataclasses import replace

import pytest

from app.storage.library import Library
from app.storage.stored import StoredSession
from core.samples import Patient, Recording, RecordingKind, Session

WALK = Recording("walk 1", RecordingKind.WALKING, "walk_1", {}, condition="alignment A")


@pytest.fixture
def visit(library: Library) -> StoredSession:
    return library.sessions.create(library.patients.create(Patient(code="P-1")).id, Session(()))


def test_corrections_are_taken_back_in_their_order_whatever_the_clock_says(
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
