"""A library's folder that goes away is not made again; what is recorded meanwhile comes home, once."""

import errno
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO
from uuid import UUID

import pytest

from app.storage import bringing_home
from app.storage.backup import back_up
from app.storage.bringing_home import bring_home
from app.storage.database.ids import uuid7
from app.storage.exchange import import_session, recording_with_samples
from app.storage.journal.decoding import DecodedJournal, decode
from app.storage.journal.disk import JournalFile, Trouble
from app.storage.journal.header import JournalRefusedError, destroy_key, find_segments
from app.storage.journal.payloads import Belonging
from app.storage.journal.writer import JournalWriter, State
from app.storage.layout import DATABASE
from app.storage.library import Library
from app.storage.opened import OpenedLibrary, open_library
from app.storage.recovery import adopt_home, find_interrupted, recover
from app.storage.root import ID_FILE, LibraryGoneError
from app.storage.stored import LibraryError, RecordingState, StoredJournal
from app.system.progress import nobody
from core.session import Patient, Recording, RecordingKind, Session
from tests.app.storage.library.conftest import ANY_ROOM, PASSPHRASE, Record
from tests.quick_library import quick_library
from tests.safety.homecoming_kills import bring_home_killed
from tests.safety.journal_material import LINES, NO_ROOM_ASKED, LineDecoder, line
from tests.waiting import wait_for

DECODERS = {"lines": LineDecoder}


@pytest.fixture(autouse=True)
def _own_data_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Shelters are in the user's data folder, on every system."""
    monkeypatch.setattr("app.storage.root.platformdirs.user_data_path", lambda *_, **__: tmp_path / "data")


class Lines:
    """A recording of a port that sends numbered lines, in pieces that end amid a line."""

    def __init__(self, opened: OpenedLibrary, session_id: UUID | None = None, *, has_row: bool = False) -> None:
        self.opened, self.id, self.stated, self.number = opened, uuid7(), list[Trouble](), 0
        reported = Recording("walk 1", RecordingKind.WALKING, "walk_1", {})
        if has_row and session_id is not None:
            opened.library.recordings.start(session_id, reported, False, self.id)
        self.writer = JournalWriter.create(
            opened.recordings,
            self.id,
            opened.data_key,
            room=NO_ROOM_ASKED,
            on_trouble=self.stated.append,
            shelter=opened.shelter,
        )
        if has_row:
            header = self.writer.header
            journal = StoredJournal(header.recording_id, header.segment, header.wrapped_key)
            opened.library.recordings.add_journal(self.id, journal)
        elif session_id is not None:
            self.writer.mark(Belonging(session_id, reported).text())
        self.source = self.writer.source(LINES)
        self._rest = b""

    def send(self, count: int) -> None:
        """Some lines, and half of the next."""
        data = self._rest + b"".join(line(k) for k in range(self.number, self.number + count))
        self.number += count
        half = len(line(self.number)) // 2
        self.writer.received(self.source, data + line(self.number)[:half])
        self._rest = line(self.number)[half:]
        self.number += 1

    def written(self) -> None:
        wait_for(lambda: self.writer.status.stuck_s == 0.0)

    def moved(self) -> None:
        wait_for(lambda: self.writer.is_away)

    @property
    def sheltered(self) -> list[str]:
        shelter = self.opened.shelter
        assert shelter is not None
        return sorted(path.name for path in shelter.folder.glob("*")) if shelter.folder.is_dir() else []

    def decoded(self) -> DecodedJournal:
        return decode(list(find_segments(self.opened.recordings)[self.id].values()), self.opened.data_key, DECODERS)

    def numbers(self) -> list[int]:
        block = self.decoded().sensors["line"].block
        return [round(float(one)) for one in block.time_s * 200.0]


@contextmanager
def gone(folder: Path) -> Iterator[Path]:
    """The library's folder under another name, as a clumsy day leaves it."""
    elsewhere = folder.with_name("renamed")
    folder.rename(elsewhere)
    yield elsewhere
    elsewhere.rename(folder)


def test_a_folder_that_is_renamed_while_recording_costs_no_byte(opened: OpenedLibrary, session_id: UUID) -> None:
    lines = Lines(opened, session_id, has_row=True)
    lines.send(50)
    lines.written()
    with gone(opened.folder) as elsewhere:
        began_s = time.monotonic()
        lines.send(20)
        lines.moved()
        assert time.monotonic() - began_s < 1.0
        lines.send(30)
        summary = lines.writer.stop()
        assert (summary.state, summary.is_away, lines.stated) == (State.CLOSED, True, [Trouble.MOVED])
        assert not opened.folder.exists(), "made anew"
        assert lines.sheltered == [f"{lines.id}.2.journal"]
        assert [path.name for path in (elsewhere / "recordings").iterdir()] == [f"{lines.id}.1.journal"]
        with pytest.raises(LibraryGoneError, match="The library is no longer in"):
            bring_home(opened)
    assert bring_home(opened) == {lines.id}
    assert lines.sheltered == []
    (found,) = find_interrupted(opened)
    assert found.problem == ""
    recovered = recover(opened, found, nobody)
    assert recovered.stored.state is RecordingState.CLOSED  # the operator stopped it
    assert recovered.recorded_s == pytest.approx(found.recorded_s)
    assert recovered.recorded_s < 10.0  # not the two parts' sum since the beginning
    decoded = lines.decoded().sensors["line"]
    assert lines.numbers() == list(range(lines.number - 1))
    assert (decoded.counts.damaged, decoded.counts.doubled, decoded.counts.lost) == (0, 0, 0)


def test_a_disk_that_is_taken_out_costs_no_more_than_a_power_cut(
    opened: OpenedLibrary, session_id: UUID, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each call on the open file fails, and its folder is not there."""
    lines = Lines(opened, session_id, has_row=True)
    lines.send(50)
    lines.written()
    first, append = lines.writer._file, JournalFile.append

    def broken(file: JournalFile, data: bytes | bytearray) -> None:
        if file is first:
            raise OSError(errno.EIO, "Input/output error")
        append(file, data)

    monkeypatch.setattr(JournalFile, "append", broken)
    lines.send(20)
    lines.moved()
    lines.send(30)
    assert lines.writer.stop().state is State.CLOSED
    bring_home(opened)
    (found,) = find_interrupted(opened)
    assert recover(opened, found, nobody).stored.state is RecordingState.CLOSED
    assert lines.numbers() == [k for k in range(lines.number - 1) if k != 50]  # it was amid being sent
    assert all(report.missing_records == 0 for report in lines.decoded().reports)


def test_dropped_records_are_reported_once(opened: OpenedLibrary) -> None:
    lines = Lines(opened)
    lines.writer._inlet._limit_bytes = 100
    lines.writer.received(lines.source, bytes(200))
    lines.writer._inlet._limit_bytes = 1 << 20
    lines.send(5)
    with gone(opened.folder):
        lines.moved()
        lines.send(5)
        lines.writer.stop()
    bring_home(opened)
    assert lines.decoded().dropped_records == 1


def test_a_recording_that_begins_while_it_is_gone_is_the_librarys_only(opened: OpenedLibrary, session_id: UUID) -> None:
    """In the shelter from its first record, sealed for this library, and put into its session."""
    with gone(opened.folder):
        lines = Lines(opened, session_id)
        lines.send(50)
        assert lines.writer.stop().is_away
        assert not opened.folder.exists()
        assert opened.shelter is not None
        (path,) = opened.shelter.folder.iterdir()
        assert b"walk_1" not in path.read_bytes()
        assert (path.stat().st_mode & 0o077, opened.shelter.folder.stat().st_mode & 0o077) == (0, 0)
    bring_home(opened)
    (found,) = find_interrupted(opened)
    assert adopt_home(opened, found, nobody).stored.session_id == session_id
    assert lines.numbers() == list(range(50))


def test_a_library_without_a_shelter_ends_its_recording_as_before(opened: OpenedLibrary) -> None:
    journal = JournalWriter.create(opened.recordings, uuid7(), opened.data_key, room=ANY_ROOM)
    with gone(opened.folder), pytest.raises(FileNotFoundError):
        JournalWriter.create(opened.recordings, uuid7(), opened.data_key, room=ANY_ROOM)
    assert journal.stop().state is State.CLOSED


def test_another_library_at_the_same_path_is_not_mistaken_for_it(
    opened: OpenedLibrary, session_id: UUID, tmp_path: Path
) -> None:
    lines = Lines(opened, session_id)
    lines.send(10)
    lines.written()
    with gone(opened.folder):
        quick_library(opened.folder).library.close()
        before = sorted(opened.folder.rglob("*"))
        lines.moved()
        lines.send(10)
        lines.writer.stop()
        with pytest.raises(LibraryGoneError):
            opened.library.patients.create(Patient(code="P-002"))
        with pytest.raises(LibraryGoneError):
            bring_home(opened)
        other = open_library(opened.folder, PASSPHRASE)
        with other:
            assert bring_home(other) == frozenset()
            assert find_interrupted(other) == ()
            assert other.library.patients.search() == ()
        assert [path for path in sorted(opened.folder.rglob("*")) if path.name != f"{DATABASE}-wal"] == before
        shutil.rmtree(opened.folder)
    assert bring_home(opened) == {lines.id}


def test_a_folder_whose_content_is_another_library_is_not_mistaken_either(opened: OpenedLibrary) -> None:
    """The same folder, by its number on the disk: emptied, or filled from elsewhere."""
    file = opened.folder / ID_FILE
    own, seen = file.read_text(), [opened.is_there]
    file.write_text("0" * 32)
    seen.append(opened.is_there)
    file.unlink()
    seen.append(opened.is_there)
    file.write_text(own)
    seen.append(opened.is_there)
    assert seen == [True, False, False, True]


def test_opening_makes_no_library(opened: OpenedLibrary, tmp_path: Path) -> None:
    """Neither a folder, nor a database in one that holds none, nor what is read while it is gone."""
    opened.library.patients.create(Patient(code="P-002"))
    with gone(opened.folder):
        for _ in range(8):  # more than there are connections
            with pytest.raises(LibraryGoneError, match="connect its disk"):
                opened.library.patients.create(Patient(code="P-003"))
        opened.library.database.close()
        with pytest.raises(LibraryGoneError):
            opened.library.patients.search()
        opened.folder.mkdir()
        with pytest.raises(LibraryGoneError):
            opened.library.patients.search()
        with pytest.raises(LibraryGoneError):
            import_session(opened, Session((), patient=Patient(code="P-009")), nobody)
        assert list(opened.folder.iterdir()) == []
        opened.folder.rmdir()
    assert {one.details.code for one in opened.library.patients.search()} == {"P-002"}


def test_what_is_gone_with_the_library_is_not_stated_to_be_missing(opened: OpenedLibrary, record: Record) -> None:
    """No backup is needed of a folder that somebody renamed."""
    stored = record("walk 1")
    record("walk 2", is_stopped=False)
    with gone(opened.folder):
        for ask in (
            lambda: recording_with_samples(opened, stored, {}),
            lambda: find_interrupted(opened),
            lambda: back_up(opened, opened.folder.parent),
        ):
            with pytest.raises(LibraryGoneError):
                ask()
    recording_with_samples(opened, stored, {})
    assert [one.problem for one in find_interrupted(opened)] == [""]
    (opened.recordings / stored.journals[0].file).unlink()
    with pytest.raises(JournalRefusedError, match="from a backup"):
        recording_with_samples(opened, stored, {})


def test_a_copy_in_its_place_is_the_library_once_it_is_taken(opened: OpenedLibrary, tmp_path: Path) -> None:
    """As after a disk was mounted again: the same library, in another folder."""
    opened.library.patients.create(Patient(code="P-002"))
    shutil.copytree(opened.folder, tmp_path / "copy")
    opened.folder.rename(tmp_path / "old")
    (tmp_path / "copy").rename(opened.folder)
    root = opened.library.root
    assert root is not None
    assert (root.is_there(), root.is_another()) == (False, True)
    opened.library.take_back()
    assert (root.is_there(), root.is_another()) == (True, False)
    opened.library.patients.create(Patient(code="P-004"))
    with Library.open(opened.folder, opened.data_key) as again:
        again.log_in("hk")
        assert {one.details.code for one in again.patients.search()} == {"P-002", "P-004"}


def test_moved_to_another_disk_amid_a_recording_nothing_is_lost(
    opened: OpenedLibrary, session_id: UUID, tmp_path: Path
) -> None:
    """Copied, and deleted a while later: the copy lacks what was recorded in between, and its end is torn."""
    lines = Lines(opened, session_id)
    lines.send(50)
    lines.written()
    shutil.copytree(opened.folder, tmp_path / "copy")
    lines.send(50)
    lines.written()
    shutil.rmtree(opened.folder)
    lines.moved()
    lines.send(50)
    lines.writer.stop()
    assert lines.sheltered == [f"{lines.id}.1.journal", f"{lines.id}.2.journal"]
    (tmp_path / "copy").rename(opened.folder)
    opened.library.take_back()
    assert bring_home(opened) == {lines.id}
    (found,) = find_interrupted(opened)
    assert adopt_home(opened, found, nobody).stored.state is RecordingState.CLOSED
    assert lines.numbers() == list(range(lines.number - 1))


class KilledError(BaseException):
    """The program ends here."""


STEPS = ("copy begins", "copy is half done", "before the rename", "after the rename", "key gone", "file gone")


@contextmanager
def killed_at(step: str) -> Iterator[None]:
    """The program ends at this point of bringing home."""

    def ends(call: Callable[..., object], when: str) -> Callable[..., object]:
        def ending(*arguments: object, **named: object) -> object:
            result = call(*arguments, **named)
            if step == when:
                raise KilledError
            return result

        return ending

    copy, rename = shutil.copyfileobj, Path.replace

    def copying(source: BinaryIO, to: BinaryIO) -> None:
        if step == "copy begins":
            raise KilledError
        if step == "copy is half done":
            to.write(source.read(300))
            to.flush()
            raise KilledError
        copy(source, to)

    def renaming(path: Path, target: Path) -> Path:
        if step == "before the rename":
            raise KilledError
        return rename(path, target)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(shutil, "copyfileobj", copying)
        patch.setattr(Path, "replace", ends(renaming, "after the rename"))
        patch.setattr(bringing_home, "destroy_key", ends(destroy_key, "key gone"))
        patch.setattr(Path, "unlink", ends(Path.unlink, "file gone"))
        yield


def recorded_in_two(opened: OpenedLibrary, session_id: UUID, *, has_row: bool = False) -> Lines:
    """A recording whose second half is in the shelter, and its library back."""
    lines = Lines(opened, session_id, has_row=has_row)
    lines.send(50)
    lines.written()
    with gone(opened.folder):
        lines.moved()
        lines.send(50)
        lines.writer.stop()
    return lines


@pytest.mark.endurance
@pytest.mark.parametrize("step", STEPS)
def test_killed_while_bringing_home_it_comes_home_once(opened: OpenedLibrary, session_id: UUID, step: str) -> None:
    lines, shelter = recorded_in_two(opened, session_id), opened.shelter
    assert shelter is not None
    sealed = (shelter.folder / f"{lines.id}.2.journal").read_bytes()
    with killed_at(step), pytest.raises(KilledError):
        bring_home(opened)
    bring_home(opened)
    bring_home(opened)
    files = sorted(path.name for path in opened.recordings.iterdir())
    assert files == [f"{lines.id}.1.journal", f"{lines.id}.2.journal"]
    assert (opened.recordings / f"{lines.id}.2.journal").read_bytes() == sealed
    assert not shelter.folder.exists()
    (found,) = find_interrupted(opened)
    adopt_home(opened, found, nobody)
    assert lines.numbers() == list(range(lines.number - 1))
    assert find_interrupted(opened) == ()
    assert len(opened.library.sessions.get(session_id).recordings) == 1


@pytest.mark.endurance
@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL and fork are POSIX's")
def test_killed_in_earnest_while_bringing_home(tmp_path: Path) -> None:
    found = bring_home_killed(tmp_path, 25, seed=3)
    assert found.faults == []
    assert found.count["of them amid the work"] > 2


def test_what_is_being_recorded_in_the_shelter_stays_there_until_it_is_stopped(
    opened: OpenedLibrary, session_id: UUID
) -> None:
    """What was stopped comes home meanwhile."""
    stopped = recorded_in_two(opened, session_id)
    with gone(opened.folder):
        going_on = Lines(opened, session_id)
        going_on.send(20)
    assert bring_home(opened) == {stopped.id}
    assert going_on.sheltered == [f"{going_on.id}.1.journal"]
    going_on.send(20)
    going_on.writer.stop()
    assert bring_home(opened) == {going_on.id}
    assert going_on.numbers() == list(range(going_on.number - 1))


def test_killed_while_recording_in_the_shelter_it_is_recovered(opened: OpenedLibrary, session_id: UUID) -> None:
    lines, shelter = recorded_in_two(opened, session_id, has_row=True), opened.shelter
    assert shelter is not None
    path = shelter.folder / f"{lines.id}.2.journal"
    with path.open("r+b") as file:
        file.truncate(path.stat().st_size - 40)  # without its footer
    bring_home(opened)
    (found,) = find_interrupted(opened)
    assert recover(opened, found, nobody).stored.state is RecordingState.RECOVERED
    (walk,) = opened.library.recordings.undecided()
    assert walk.recording.id == lines.id


def test_a_part_that_comes_home_late_is_added_to_what_was_recovered_without_it(
    opened: OpenedLibrary, session_id: UUID
) -> None:
    """The library was opened on another computer first, which knows nothing of this one's shelter."""
    lines = recorded_in_two(opened, session_id, has_row=True)
    (found,) = find_interrupted(opened)
    assert found.problem == ""  # no backup ever held what is missing
    assert len(recover(opened, found, nobody).stored.journals) == 1
    assert find_interrupted(opened) == ()
    bring_home(opened)
    (found,) = find_interrupted(opened)
    recovered = recover(opened, found, nobody)
    assert [journal.segment for journal in recovered.stored.journals] == [1, 2]
    assert lines.numbers() == list(range(lines.number - 1))
    assert find_interrupted(opened) == ()


def test_what_is_at_home_with_another_content_is_neither_replaced_nor_lost(
    opened: OpenedLibrary, session_id: UUID
) -> None:
    lines, shelter = recorded_in_two(opened, session_id), opened.shelter
    assert shelter is not None
    name = f"{lines.id}.2.journal"
    (opened.recordings / name).write_bytes(b"somebody else's")
    before = (shelter.folder / name).read_bytes()
    assert bring_home(opened) == frozenset()
    assert (opened.recordings / name).read_bytes() == b"somebody else's"
    assert (shelter.folder / name).read_bytes() == before


def test_a_backup_is_not_made_where_its_disk_was(opened: OpenedLibrary, tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="The backup folder was not found"):
        back_up(opened, tmp_path / "not connected")
    assert not (tmp_path / "not connected").exists()


def is_root_on_linux() -> bool:
    return sys.platform == "linux" and os.geteuid() == 0


@pytest.mark.skipif(not is_root_on_linux(), reason="only root mounts disks")
def test_a_disk_that_is_unmounted_and_mounted_again(untouched: OpenedLibrary, tmp_path: Path) -> None:
    """Its mount point stays, as an empty folder, and takes no file of a library."""
    disk, folder = tmp_path / "disk", tmp_path / "library"
    for one in (disk, folder):
        one.mkdir()
    shutil.copytree(untouched.folder, disk / "library")
    mount = ["mount", "--bind", str(disk / "library"), str(folder)]
    if subprocess.run(mount, check=False, capture_output=True).returncode:
        pytest.skip("mounting is not permitted here")
    is_mounted = True
    try:
        library = Library.open(folder, untouched.data_key)
        library.log_in("hk")
        with OpenedLibrary(library, folder, untouched.data_key) as opened:
            patient = library.patients.create(Patient(code="P-001"))
            visit = library.sessions.create(patient.id, Session(()))
            lines = Lines(opened, visit.id)
            lines.send(50)
            lines.written()
            subprocess.run(["umount", "--lazy", str(folder)], check=True)
            is_mounted = False
            lines.moved()
            lines.send(50)
            lines.writer.stop()
            assert list(folder.iterdir()) == []
            subprocess.run(mount, check=True)
            is_mounted = True
            assert bring_home(opened) == {lines.id}
            (found,) = find_interrupted(opened)
            adopt_home(opened, found, nobody)
            assert lines.numbers() == list(range(lines.number - 1))
    finally:
        if is_mounted:
            subprocess.run(["umount", "--lazy", str(folder)], check=True)
