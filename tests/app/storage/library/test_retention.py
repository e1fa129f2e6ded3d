"""What was deleted can be restored for thirty days; then nothing opens it any more, and a kill changes nothing."""

from collections.abc import Callable
from pathlib import Path
from uuid import UUID

import pytest

from app.storage.journal.header import IDENTITY, WRAPPED_BYTES, JournalRefusedError
from app.storage.journal.reader import JournalReader
from app.storage.opened import OpenedLibrary
from app.storage.retention import destroy_overdue, destroy_recording
from app.storage.stored import LibraryError, StoredRecording
from tests.app.storage.later import Later, go_on, later, timed

Record = Callable[..., StoredRecording]


__all__ = ["later", "timed"]  # fixtures


def test_a_deleted_session_is_destroyed_after_thirty_days_and_not_before(
    timed: OpenedLibrary, session_id: UUID, record: Record, later: Later
) -> None:
    path = timed.recordings / record("walk 1").journals[0].file
    kept = path.read_bytes()
    timed.library.sessions.delete(timed.library.sessions.get(session_id))
    go_on(timed, later, 29.9)
    assert destroy_overdue(timed, later) == 0
    assert path.read_bytes() == kept
    go_on(timed, later, 30.1)
    assert destroy_overdue(timed, later) == 1
    assert not path.exists()
    with pytest.raises(LibraryError):
        timed.library.sessions.get(session_id)
    assert destroy_overdue(timed, later) == 0


def test_a_deleted_patient_goes_with_all_sessions(
    timed: OpenedLibrary, session_id: UUID, record: Record, later: Later
) -> None:
    record("walk 1")
    (patient,) = timed.library.patients.search()
    timed.library.patients.delete(patient)
    go_on(timed, later, 31)
    assert destroy_overdue(timed, later) == 1
    assert timed.library.patients.search(is_deleted=True) == ()
    assert list(timed.recordings.iterdir()) == []
    assert timed.library.audit.verify().faults == ()


@pytest.mark.parametrize("days", [8, 40, 365, 4000])
def test_a_clock_that_was_set_ahead_destroys_nothing_however_often_it_is_started(
    timed: OpenedLibrary, session_id: UUID, record: Record, later: Later, days: float
) -> None:
    path = timed.recordings / record("walk 1").journals[0].file
    timed.library.sessions.delete(timed.library.sessions.get(session_id))
    for ahead in (days, days + 0.1, days + 2):  # then it is noticed
        later.days = ahead
        timed.library.log_in("hk")
        assert destroy_overdue(timed, later) == 0
    later.days = 1
    go_on(timed, later, 22)
    assert destroy_overdue(timed, later) == 0
    assert path.exists()
    go_on(timed, later, 38)
    assert destroy_overdue(timed, later) == 1


def test_a_clock_that_is_a_year_back_destroys_nothing(
    timed: OpenedLibrary, session_id: UUID, record: Record, later: Later
) -> None:
    record("walk 1")
    later.days = -365
    timed.library.sessions.delete(timed.library.sessions.get(session_id))
    later.days = 0
    timed.library.log_in("hk")
    assert destroy_overdue(timed, later) == 0


def test_a_library_that_is_used_once_a_month_destroys_half_a_year_later(
    timed: OpenedLibrary, session_id: UUID, record: Record, later: Later
) -> None:
    record("walk 1")
    timed.library.sessions.delete(timed.library.sessions.get(session_id))
    destroyed = []
    for month in range(1, 8):
        later.days = 30 * month
        timed.library.log_in("hk")
        destroyed.append(destroy_overdue(timed, later))
    assert destroyed == [0, 0, 0, 0, 0, 1, 0]


def test_a_restored_session_stays(timed: OpenedLibrary, session_id: UUID, record: Record, later: Later) -> None:
    recording = record("walk 1")
    timed.library.sessions.delete(timed.library.sessions.get(session_id))
    go_on(timed, later, 29)
    timed.library.sessions.restore(timed.library.sessions.get(session_id))
    go_on(timed, later, 100)
    assert destroy_overdue(timed, later) == 0
    assert list(JournalReader(timed.recordings / recording.journals[0].file, timed.data_key).records())


def test_the_keys_are_gone_before_the_file_is(
    opened: OpenedLibrary, record: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording = record("walk 1")
    path = opened.recordings / recording.journals[0].file
    wrapped = recording.journals[0].wrapped_key
    assert wrapped is not None
    assert wrapped in path.read_bytes()

    def killed(_: Path) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(Path, "unlink", killed)
        with pytest.raises(KeyboardInterrupt):
            destroy_recording(opened, recording)
    assert wrapped not in path.read_bytes()
    with pytest.raises(JournalRefusedError, match="this recording was permanently destroyed"):
        JournalReader(path, opened.data_key)
    destroy_recording(opened, recording)
    assert not path.exists()
    found = opened.library.recordings.find(recording.id)
    assert found is not None
    assert [journal.wrapped_key for journal in found.journals] == [None]
    destroy_recording(opened, found)


def test_a_journal_whose_beginning_is_damaged_is_destroyed_too(
    opened: OpenedLibrary, record: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording = record("walk 1")
    path = opened.recordings / recording.journals[0].file
    with path.open("r+b") as file:
        file.write(b"damaged")
    gone: list[bytes] = []
    monkeypatch.setattr(Path, "unlink", lambda path: gone.append(path.read_bytes()))
    destroy_recording(opened, recording)
    (left,) = gone
    assert left[: IDENTITY.size + WRAPPED_BYTES] == bytes(IDENTITY.size + WRAPPED_BYTES)
