"""What was not stopped is listed quickly, closed as it is, and never lost from sight."""

import time
from collections.abc import Callable
from datetime import timedelta, timezone
from pathlib import Path
from uuid import UUID

import numpy as np
import pytest

from app.storage.audit import about
from app.storage.database.ids import uuid7
from app.storage.exchange import export_orphan, was_exported
from app.storage.journal.decoding import decode
from app.storage.journal.header import HEADER_BYTES, RESTORE, JournalRefusedError
from app.storage.journal.reader import JournalReader
from app.storage.opened import OpenedLibrary, held_alone
from app.storage.recovery import adopt, adopt_home, find_interrupted, recover
from app.storage.stored import Action, LibraryError, RecordingState, StoredRecording
from app.system.progress import nobody
from core.session import Recording, RecordingKind
from devices.files.formats import read_trial
from devices.files.site_files import read_site
from tests.app.storage.library.conftest import SENSOR, samples

Record = Callable[..., StoredRecording]


def test_an_interrupted_recording_is_listed_then_closed_with_all_that_there_is(
    opened: OpenedLibrary, record: Record
) -> None:
    record("walk 1")
    killed = record("walk 2", 3000, is_stopped=False)
    path = opened.recordings / killed.journals[0].file
    before = path.read_bytes()
    (found,) = find_interrupted(opened)
    assert found.stored is not None
    assert found.stored.details.name == "walk 2"
    assert not found.is_orphan
    assert found.began_at is not None
    recovered = recover(opened, found, nobody)
    assert recovered.stored.state is RecordingState.RECOVERED
    assert recovered.recorded_s == pytest.approx(found.recorded_s)
    assert path.read_bytes() == before
    (journal,) = recovered.stored.journals
    assert journal.sha256 == recovered.reports[0].sha256
    (sensor,) = decode([path], opened.data_key, {}).sensors.values()
    assert len(sensor.block) == 3000
    assert find_interrupted(opened) == ()


def test_what_a_kill_left_between_file_and_row_is_found(opened: OpenedLibrary, record: Record) -> None:
    record("walk 1", is_stopped=False, is_reported=False)
    (found,) = find_interrupted(opened)
    recovered = recover(opened, found, nobody)
    (journal,) = recovered.stored.journals
    assert journal.wrapped_key == JournalReader(opened.recordings / journal.file, opened.data_key).header.wrapped_key


def test_a_row_without_any_journal_is_closed_as_empty(opened: OpenedLibrary, session_id: UUID) -> None:
    opened.library.recordings.start(session_id, Recording("walk 1", RecordingKind.WALKING, "walk_1", {}), False)
    (found,) = find_interrupted(opened)
    assert (found.began_at, found.recorded_s, found.problem) == (None, 0.0, "")
    assert recover(opened, found, nobody).stored.state is RecordingState.RECOVERED
    assert find_interrupted(opened) == ()


def test_a_recording_that_only_its_row_does_not_know_as_stopped_is_closed(
    opened: OpenedLibrary, record: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(type(opened.library.recordings), "close", lambda _self, recording_id, *_: recording_id)
    record("walk 1")
    monkeypatch.undo()
    (found,) = find_interrupted(opened)
    assert recover(opened, found, nobody).stored.state is RecordingState.CLOSED


def test_an_orphan_is_listed_until_somebody_states_where_it_belongs(
    opened: OpenedLibrary, session_id: UUID, record: Record
) -> None:
    record("walk 1")
    left = record("left over", is_stopped=False, has_row=False)
    (found,) = find_interrupted(opened)
    assert found.is_orphan
    assert found.recording_id == left.id
    with pytest.raises(ValueError, match="adopt it"):
        recover(opened, found, nobody)
    with pytest.raises(LibraryError, match="of this name"):
        adopt(opened, found, session_id, Recording("walk 1", RecordingKind.WALKING, "walk_1", {}), nobody)
    recovered = adopt(opened, found, session_id, Recording("walk 9", RecordingKind.WALKING, "walk_9", {}), nobody)
    assert recovered.stored.id == left.id
    assert recovered.stored.placement is not None
    assert find_interrupted(opened) == ()
    assert [one.details.name for one in opened.library.sessions.get(session_id).recordings] == ["walk 1", "walk 9"]


def test_an_orphan_goes_into_the_session_that_it_was_begun_in(
    opened: OpenedLibrary, session_id: UUID, record: Record
) -> None:
    """With what was given of it; under another name where its own was given again meanwhile."""
    record("walk 1", is_stopped=False, has_row=False, states_session=session_id)
    record("walk 2", has_row=False, states_session=session_id, is_stopped=False)
    record("walk 2")
    found = find_interrupted(opened)
    assert [one.belonging is not None for one in found] == [True, True]
    recovered = [adopt_home(opened, one, nobody).stored for one in found]
    assert [(one.details.name, one.details.folder, one.details.condition) for one in recovered] == [
        ("walk 1", "walk_1", "barefoot"),
        ("walk 3", "walk_3", "barefoot"),
    ]
    assert all(one.session_id == session_id and one.placement is not None for one in recovered)
    assert find_interrupted(opened) == ()


def test_an_orphan_of_no_session_is_exported_and_stays(opened: OpenedLibrary, record: Record, tmp_path: Path) -> None:
    """It gives nothing of its session, or that one is not there any more: its samples come out all the same."""
    silent_one = record("left over", is_stopped=False, has_row=False)
    record("left over", 700, is_stopped=False, has_row=False, states_session=uuid7())
    found = find_interrupted(opened)
    for one in found:
        with pytest.raises(LibraryError):
            adopt_home(opened, one, nobody)
        export_orphan(opened, one, tmp_path / str(one.recording_id), {}, nobody)
    assert find_interrupted(opened) == found
    block, findings = read_site(tmp_path / str(silent_one.id) / "LT-1.csv", "", "", SENSOR, is_rate_derived=False)
    assert (len(block), findings) == (500, ())
    np.testing.assert_array_equal(block.gyr_rad_s, samples(500).gyr_rad_s)
    noted = opened.library.audit.entries(about("recording", silent_one.id))
    assert [entry.action for entry in noted] == [Action.EXPORT] * 2  # before, and when it was done
    assert all(was_exported(opened, one) for one in found)


@pytest.mark.parametrize("is_simulated", [True, False])
def test_what_was_simulated_stays_so_when_its_files_are_imported(
    opened: OpenedLibrary, record: Record, tmp_path: Path, is_simulated: bool
) -> None:
    record("left over", is_stopped=False, has_row=False, is_simulated=is_simulated)
    (found,) = find_interrupted(opened)
    export_orphan(opened, found, tmp_path / "files", {}, nobody)
    assert read_trial("csv", [tmp_path / "files" / "LT-1.csv"], None).is_simulated is is_simulated


def test_an_export_that_was_broken_off_is_none(opened: OpenedLibrary, record: Record, tmp_path: Path) -> None:
    record("left over", is_stopped=False, has_row=False)
    (found,) = find_interrupted(opened)
    (tmp_path / "a file").touch()
    with pytest.raises(OSError, match="a file"):
        export_orphan(opened, found, tmp_path / "a file", {}, nobody)
    assert opened.library.audit.entries(about("recording", found.recording_id))
    assert not was_exported(opened, found)


def test_an_orphan_comes_where_it_was_made(opened: OpenedLibrary, session_id: UUID, record: Record) -> None:
    """Between the recordings begun before and after it, also where these say their time as another zone's clocks."""
    began = {"walk 1": 0, "walk 4": 3}
    left = record("walk 2", is_stopped=False, has_row=False, states_session=session_id)
    record("walk 3", is_stopped=False, has_row=False, states_session=session_id)
    first, second = find_interrupted(opened)
    assert first.recording_id == left.id
    assert first.began_at is not None
    for name, hour in began.items():
        at = (first.began_at + timedelta(hours=hour - 1)).astimezone(timezone(timedelta(hours=-hour)))
        opened.library.recordings.start(
            session_id,
            Recording(name, RecordingKind.WALKING, name, {}, started=at.isoformat(timespec="seconds")),
            False,
        )
    before = {one.id: one.version for one in opened.library.sessions.get(session_id).recordings}
    for one in (second, first):
        adopt_home(opened, one, nobody)
    session = opened.library.sessions.get(session_id)
    assert [one.details.name for one in session.recordings] == ["walk 1", "walk 2", "walk 3", "walk 4"]
    assert [one.version for one in session.recordings if one.id in before] == list(before.values())
    assert [one.is_decided for one in session.recordings] == [True, False, False, True]  # asked: keep or discard


@pytest.mark.parametrize(
    "damage",
    [
        "missing",
        "Recordings made while the library was unavailable are not in the library yet",
        "The library refers to an invalid recording file",
    ],
)
def test_what_cannot_be_recovered_stays_open_and_states_what_to_do(
    opened: OpenedLibrary, record: Record, damage: str
) -> None:
    path = opened.recordings / record("walk 1", is_stopped=False).journals[0].file
    content = path.read_bytes()
    path.unlink()
    if damage == "The library refers to an invalid recording file":
        path.write_bytes(bytes(len(content)))
    elif damage == "Recordings made while the library was unavailable are not in the library yet":
        other = record("walk 2").journals[0]
        path.write_bytes((opened.recordings / other.file).read_bytes()[:HEADER_BYTES] + content[HEADER_BYTES:])
    (found,) = find_interrupted(opened)
    assert found.problem
    assert found.remedy == RESTORE
    with pytest.raises(JournalRefusedError):
        recover(opened, found, nobody)
    path.write_bytes(content)  # restored
    (found,) = find_interrupted(opened)
    recover(opened, found, nobody)
    assert find_interrupted(opened) == ()


@pytest.mark.endurance
def test_fifty_journals_are_listed_within_two_seconds(opened: OpenedLibrary, record: Record) -> None:
    for number in range(50):
        record(f"walk {number}", 4000, is_stopped=False, has_row=number % 5 > 0)
    began_s = time.monotonic()
    found = find_interrupted(opened)
    assert time.monotonic() - began_s < 2.0
    assert sum(one.is_orphan for one in found) == 10
    assert sum(one.recorded_s > 0 for one in found) == 50


def test_a_long_torn_tail_is_read_past(opened: OpenedLibrary, record: Record) -> None:
    path = opened.recordings / record("walk 1", 4000, is_stopped=False).journals[0].file
    (whole,) = find_interrupted(opened)
    with path.open("ab") as file:
        file.write(b"\xa7GWr" * 50_000)
    (found,) = find_interrupted(opened)
    assert found.recorded_s == whole.recorded_s
    assert recover(opened, found, nobody).reports[0].damaged_bytes >= 200_000


def test_progress_is_reported_and_a_stop_leaves_the_recording_open(opened: OpenedLibrary, record: Record) -> None:
    record("walk 1", 200_000, is_stopped=False)
    (found,) = find_interrupted(opened)

    def stop(_share: float, _what: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        recover(opened, found, stop)
    assert find_interrupted(opened) == (found,)


def test_only_one_program_records_into_a_library(tmp_path: Path) -> None:
    with (
        held_alone(tmp_path),
        pytest.raises(LibraryError, match="This library is already open in Gaitwright"),
        held_alone(tmp_path),
    ):
        raise AssertionError
    with held_alone(tmp_path):
        pass


def test_the_key_is_not_printed(opened: OpenedLibrary) -> None:
    assert opened.data_key is not None
    assert repr(opened.data_key) not in repr(opened)
    assert opened.data_key.hex() not in repr(opened)
