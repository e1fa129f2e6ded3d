"""A disk that refuses to be written, or was remounted read-only, costs nothing that was stated to be saved."""

import errno
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import pytest

from app.storage.backup import back_up, find_backups, restore
from app.storage.bringing_home import bring_home
from app.storage.database.ids import uuid7
from app.storage.journal.decoding import decode
from app.storage.journal.disk import Trouble
from app.storage.journal.header import find_segments
from app.storage.journal.writer import JournalWriter, State
from app.storage.layout import IN_USE
from app.storage.opened import OpenedLibrary, logged_in
from app.storage.recovery import find_interrupted, recover
from app.storage.stored import LibraryError, StoredJournal
from app.system.progress import nobody
from core.session import Patient, Recording, RecordingKind, Session
from tests.quick_library import quick_library
from tests.safety.failing_disk import FailingDisk, failing_disk, missing
from tests.safety.journal_material import LINES, NO_ROOM_ASKED, LineDecoder, line, record_some
from tests.waiting import wait_for

pytestmark = [
    pytest.mark.endurance,
    pytest.mark.skipif(bool(missing()), reason=f"no disk can be made to fail here: {missing()}"),
]

REFUSED = pytest.mark.parametrize("number", [errno.EIO, errno.EROFS], ids=["EIO", "EROFS"])
MOST_WRITES = 3000  # by far more than a save or a backup needs
SENTENCES = {
    "The library file cannot be read or written. Check the disk, then try again.",
    "The library file cannot be opened for writing. Check the permissions of its folder.",
}


@pytest.fixture
def disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[FailingDisk]:
    monkeypatch.setattr("app.storage.root.platformdirs.user_data_path", lambda *_, **__: tmp_path / "data")
    with failing_disk(tmp_path) as disk:
        yield disk


def made(folder: Path) -> OpenedLibrary:
    """A library with a visit."""
    opened = quick_library(folder)
    patient = opened.library.patients.create(Patient(code="P-1"))
    opened.library.sessions.create(patient.id, Session((), started="2026-11-20T09:00:00", notes="before"))
    return opened


@pytest.fixture
def opened(disk: FailingDisk) -> Iterator[OpenedLibrary]:
    """A library on that disk."""
    with made(disk.folder / "library") as opened:
        yield opened


def visit_of(opened: OpenedLibrary) -> UUID:
    (line,) = opened.library.sessions.list()
    return line.id


def again(opened: OpenedLibrary) -> OpenedLibrary:
    """As the next start finds it."""
    opened.library.close()
    assert opened.data_key is not None
    found = logged_in(opened.folder, opened.data_key, "hk")
    assert found.library.faults() == ()
    assert found.library.audit.verify().faults == ()
    return found


@REFUSED
@pytest.mark.parametrize("has_shelter", [True, False])
def test_a_recording_keeps_what_was_written_and_states_what_happened(
    disk: FailingDisk, opened: OpenedLibrary, number: int, has_shelter: bool
) -> None:
    recording_id, stated = uuid7(), list[Trouble]()
    reported = Recording("walk", RecordingKind.WALKING, "walk", {})
    opened.library.recordings.start(visit_of(opened), reported, False, recording_id)
    writer = JournalWriter.create(
        opened.recordings,
        recording_id,
        opened.data_key,
        room=NO_ROOM_ASKED,
        on_trouble=stated.append,
        shelter=opened.shelter if has_shelter else None,
    )
    header = writer.header
    opened.library.recordings.add_journal(recording_id, StoredJournal(recording_id, header.segment, header.wrapped_key))
    source = writer.source(LINES)
    for sent in range(600):
        if sent == 300:
            wait_for(lambda: writer.status.records >= 301)  # the source, and each line
            disk.fail(number)
        writer.received(source, line(sent))
        time.sleep(0.001)
    wait_for(lambda: bool(stated))
    summary = writer.stop()
    assert stated == [Trouble.MOVED if has_shelter else Trouble.DISK_GONE]
    assert summary.state is (State.CLOSED if has_shelter else State.BROKEN)
    disk.mend()
    with again(opened) as later:
        bring_home(later)
        (found,) = find_interrupted(later)
        assert found.problem == ""
        recover(later, found, nobody)
        paths = list(find_segments(later.recordings)[recording_id].values())
        block = decode(paths, later.data_key, {"lines": LineDecoder}).sensors["line"].block
    numbers = [round(float(one)) for one in block.time_s * 200.0]
    assert numbers == list(range(600 if has_shelter else len(numbers)))
    assert len(numbers) >= 300


@REFUSED
@pytest.mark.parametrize("closes_first", [False, True])
def test_what_was_saved_is_there_and_what_was_not_is_stated(
    disk: FailingDisk, opened: OpenedLibrary, number: int, closes_first: bool
) -> None:
    """The disk fails at every third write of a save in turn, and, where it `closes_first`, at those of closing."""
    visit_id, stated, saved = visit_of(opened), list[str](), 0
    for after in range(0, MOST_WRITES, 3):
        visit, required = opened.library.sessions.get(visit_id), f"note {after}"
        disk.fail(number, after)
        try:
            opened.library.sessions.change(visit, replace(visit.details, notes=required))
            may_be = {required}
            saved += 1
        except LibraryError as error:
            may_be = {visit.details.notes, required}
            stated.append(str(error))
        if closes_first:
            opened.library.close()
        disk.mend()
        opened = again(opened)
        assert opened.library.sessions.get(visit_id).details.notes in may_be
        if saved == 3:
            break
    opened.library.close()
    assert len(stated) > 3
    assert set(stated) <= SENTENCES


@REFUSED
def test_a_backup_onto_it_is_refused_and_none_is_half_there(disk: FailingDisk, tmp_path: Path, number: int) -> None:
    into, stated, after = disk.folder / "backups", list[str](), 0
    into.mkdir()
    with made(tmp_path / "sound") as opened:
        record_some(opened.recordings, opened.data_key)
        while not find_backups(into):
            disk.fail(number, after)
            try:
                assert back_up(opened, into).faults == ()
            except LibraryError as error:
                stated.append(error.what)
            disk.mend()
            after += 1 + after // 4
            assert after < MOST_WRITES
        (found,) = find_backups(into)  # whole, also where it was refused after it had its name
        assert restore(found.folder, tmp_path / "restored", opened.data_key, "hk") == ()
    assert len(stated) > 10
    assert {one.partition(" (")[0] for one in stated} <= {
        "This folder is not writable",
        "The library file cannot be read or written",  # of the copy, which is opened as a library is
        "The library file cannot be opened for writing",
    }


@REFUSED
def test_a_backup_of_it_is_refused_and_made_once_it_can_be_noted(
    disk: FailingDisk, opened: OpenedLibrary, tmp_path: Path, number: int
) -> None:
    into = tmp_path / "backups"
    into.mkdir()
    disk.fail(number)
    with pytest.raises(LibraryError, match="library file cannot be"):
        back_up(opened, into)
    disk.mend()
    with again(opened) as later:
        assert find_backups(into) == ()
        assert back_up(later, into).faults == ()


def test_what_a_kill_left_goes_where_a_file_that_is_open_keeps_its_name(disk: FailingDisk, tmp_path: Path) -> None:
    """As on a disk of the network: a folder is not empty as long as a file in it is open."""
    with made(tmp_path / "sound") as opened:
        done = back_up(opened, tmp_path)
        left = disk.folder / ".restored-abcdefgh"
        left.mkdir()
        (left / IN_USE).touch()
        assert restore(done.folder, disk.folder / "restored", opened.data_key, "hk") == ()
    assert [one.name for one in disk.folder.iterdir()] == ["restored"]
