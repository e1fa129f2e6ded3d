"""A backup opens and holds everything, or there is none; a restored library is the one that was backed up."""

import datetime
import errno
import json
import os
import shutil
import stat
from collections.abc import Callable
from functools import partial
from pathlib import Path
from uuid import UUID

import pytest
import sqlcipher3.dbapi2 as sqlite

from app.storage.backup import LIST, back_up, find_backups, remove_old_backups, restore
from app.storage.files import held
from app.storage.journal.reader import JournalReader
from app.storage.keys import KeySlots
from app.storage.layout import DATABASE, IN_USE, KEYS, RECORDINGS
from app.storage.opened import OpenedLibrary, held_alone, open_library
from app.storage.stored import Action, LibraryError, StoredRecording
from core.session import Patient

PASSPHRASE = "four short words here"
NOON = datetime.datetime(2026, 11, 21, 12, tzinfo=datetime.UTC)

Record = Callable[..., StoredRecording]


class StoppedError(Exception):
    """What a report raises when nobody waits any more."""


@pytest.fixture(autouse=True)
def _backups(tmp_path: Path) -> None:
    """A backup makes no folder for itself: where there is none, a disk is not connected."""
    (tmp_path / "backups").mkdir()


def test_a_restored_library_opens_with_the_same_passphrase_and_holds_the_same(
    opened: OpenedLibrary, session_id: UUID, record: Record, tmp_path: Path
) -> None:
    recordings = [record("walk 1"), record("walk 2", is_stopped=False)]
    backup = back_up(opened, tmp_path / "backups", now=lambda: NOON)
    assert backup.faults == ()
    assert backup.files == 4
    key = KeySlots(backup.folder / KEYS).open("hk", PASSPHRASE)
    assert restore(backup.folder, tmp_path / "restored", key, "hk") == ()
    with open_library(tmp_path / "restored", PASSPHRASE) as restored:
        assert restored.library.faults() == ()
        assert restored.library.audit.verify(backup.checkpoint).faults == ()
        assert restored.library.audit.entries()[-2].details == '{"is_restored":true}'
        assert restored.library.sessions.get(session_id) == opened.library.sessions.get(session_id)
        for recording in recordings:
            (journal,) = recording.journals
            original, copy = ((place.recordings / journal.file).read_bytes() for place in (opened, restored))
            assert copy == original
            assert list(JournalReader(restored.recordings / journal.file, key).records())


def test_a_backup_that_is_copied_to_a_librarys_place_is_that_library_as_the_manual_states(
    opened: OpenedLibrary, session_id: UUID, record: Record, tmp_path: Path
) -> None:
    record("walk 1")
    backup = back_up(opened, tmp_path / "backups", now=lambda: NOON)
    shutil.copytree(backup.folder, tmp_path / "copied")
    with open_library(tmp_path / "copied", PASSPHRASE) as copied:
        assert copied.library.faults() == ()
        assert copied.library.sessions.get(session_id) == opened.library.sessions.get(session_id)


def test_a_backup_is_encrypted_and_its_owners(opened: OpenedLibrary, record: Record, tmp_path: Path) -> None:
    record("walk 1")
    opened.library.patients.create(Patient(code="Kowalczyk"))
    folder = back_up(opened, tmp_path / "backups").folder
    files = [path for path in folder.rglob("*") if path.is_file()]
    assert {path.name for path in files if path.parent == folder} == {DATABASE, KEYS, LIST}
    assert not [path for path in files if b"Kowalczyk" in path.read_bytes() or b"walk 1" in path.read_bytes()]
    if os.name != "nt":
        assert {stat.S_IMODE(path.stat().st_mode) for path in files} == {0o600}
        assert {stat.S_IMODE(path.stat().st_mode) for path in (folder, folder / RECORDINGS)} == {0o700}


def test_the_library_is_used_while_it_is_copied(opened: OpenedLibrary, record: Record, tmp_path: Path) -> None:
    record("walk 1")
    made: list[int] = []

    def use(_share: float, _what: str) -> None:
        made.append(opened.library.patients.create(Patient(code=f"P-1{len(made):03d}")).version)

    backup = back_up(opened, tmp_path / "backups", use)
    assert len(made) > 3
    assert restore(backup.folder, tmp_path / "restored", opened.data_key, "hk") == ()


def test_progress_only_grows_and_ends_with_everything(opened: OpenedLibrary, record: Record, tmp_path: Path) -> None:
    record("walk 1", 20_000)
    shares: list[float] = []
    back_up(opened, tmp_path / "backups", lambda share, _: shares.append(share))
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0, abs=0.05)
    assert len(shares) > 4


@pytest.mark.parametrize("reports", [1, 2, 4, 6])
def test_a_backup_that_is_stopped_leaves_nothing(
    opened: OpenedLibrary, record: Record, tmp_path: Path, reports: int
) -> None:
    record("walk 1", 20_000)
    reported: list[float] = []

    def stop(share: float, _: str) -> None:
        reported.append(share)
        if len(reported) == reports:
            raise StoppedError

    with pytest.raises(StoppedError):
        back_up(opened, tmp_path / "backups", stop)
    assert list((tmp_path / "backups").iterdir()) == []
    assert '"is_checked":true' not in [entry.details for entry in opened.library.audit.entries()]


def test_what_is_damaged_on_the_way_is_no_backup(opened: OpenedLibrary, record: Record, tmp_path: Path) -> None:
    record("walk 1")

    def damage(_share: float, what: str) -> None:
        for copy in (tmp_path / "backups").rglob("*.journal"):
            if what == "backup" and copy.stat().st_size > 1000:
                flip(copy, 700)

    with pytest.raises(LibraryError, match="does not match the original"):
        back_up(opened, tmp_path / "backups", damage)
    assert list((tmp_path / "backups").iterdir()) == []


def flip(path: Path, offset: int) -> None:
    with path.open("r+b") as file:
        file.seek(offset)
        (byte,) = file.read(1)
        file.seek(offset)
        file.write(bytes([byte ^ 1]))


def test_what_the_library_lacks_already_is_reported_and_the_rest_is_kept(
    opened: OpenedLibrary, record: Record, tmp_path: Path
) -> None:
    files = [record(f"walk {k}").journals[0].file for k in (1, 2, 3)]
    (opened.recordings / files[0]).unlink()
    flip(opened.recordings / files[1], 700)
    backup = back_up(opened, tmp_path / "backups")
    assert sorted(backup.faults) == sorted(
        [f"{files[0]} is missing", f"{files[1]} is not what it was when it was closed"]
    )
    assert restore(backup.folder, tmp_path / "restored", opened.data_key, "hk") == backup.faults


@pytest.mark.parametrize("what", [DATABASE, KEYS, RECORDINGS])
def test_a_backup_that_was_damaged_since_is_not_restored(
    opened: OpenedLibrary, record: Record, tmp_path: Path, what: str
) -> None:
    record("walk 1")
    folder = back_up(opened, tmp_path / "backups").folder
    for file in [folder / what] if (folder / what).is_file() else (folder / what).iterdir():
        flip(file, file.stat().st_size // 2)
    with pytest.raises(LibraryError):
        restore(folder, tmp_path / "restored", opened.data_key, "hk")
    assert not (tmp_path / "restored").exists()


def test_nothing_is_restored_over_a_library_nor_with_another_key_nor_by_a_stranger(
    opened: OpenedLibrary, record: Record, tmp_path: Path
) -> None:
    record("walk 1")
    folder = back_up(opened, tmp_path / "backups").folder
    before = {path: path.stat().st_mtime_ns for path in opened.recordings.iterdir()}
    with pytest.raises(LibraryError, match="This folder is not empty"):
        restore(folder, opened.folder, opened.data_key, "hk")
    assert {path: path.stat().st_mtime_ns for path in opened.recordings.iterdir()} == before
    with pytest.raises(LibraryError, match="This key does not open the library, or the start of its file is damaged"):
        restore(folder, tmp_path / "restored", bytes(32), "hk")
    with pytest.raises(LibraryError, match="This user is not active in this library"):
        restore(folder, tmp_path / "restored", opened.data_key, "somebody")
    assert not (tmp_path / "restored").exists()


def test_a_list_cannot_lead_out_of_its_backup(opened: OpenedLibrary, tmp_path: Path) -> None:
    folder = back_up(opened, tmp_path / "backups").folder
    reported = json.loads((folder / LIST).read_text())
    (tmp_path / "elsewhere").write_text("mine")
    reported["files"] |= {"../../elsewhere": "0" * 64, "recordings/../../elsewhere": "0" * 64, str(tmp_path): "0" * 64}
    (folder / LIST).write_text(json.dumps(reported))
    assert restore(folder, tmp_path / "restored", opened.data_key, "hk") == ()
    assert not (tmp_path / "restored" / "elsewhere").exists()
    del reported["files"][KEYS]
    (folder / LIST).write_text(json.dumps(reported))
    with pytest.raises(LibraryError, match="This version cannot read this folder as a backup"):
        restore(folder, tmp_path / "again", opened.data_key, "hk")


def test_a_backup_is_outside_of_its_library_and_needs_room(
    opened: OpenedLibrary, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(LibraryError, match="A backup cannot be stored inside its own library"):
        back_up(opened, opened.folder / "backups")
    monkeypatch.setattr("app.storage.backup.SPARE_BYTES", 10**18)
    with pytest.raises(LibraryError, match="MB free"):
        back_up(opened, tmp_path / "backups")


def test_old_backups_go_and_the_latest_never(opened: OpenedLibrary, tmp_path: Path) -> None:
    into = tmp_path / "backups"
    for days in (200, 100, 50):
        made_at = NOON - datetime.timedelta(days)
        back_up(opened, into, now=partial(made_at.replace, microsecond=0))
    (into / "gaitwright-backup-of-somebody-else").mkdir()
    assert [(NOON - backup.made_at).days for backup in find_backups(into)] == [200, 100, 50]
    assert [len(remove_old_backups(into, lambda: NOON)) for _ in range(3)] == [1, 1, 0]
    assert len(remove_old_backups(into, lambda: NOON + datetime.timedelta(1000))) == 0
    assert [(NOON - backup.made_at).days for backup in find_backups(into)] == [50]
    assert (into / "gaitwright-backup-of-somebody-else").exists()


def test_what_a_kill_left_of_a_backup_goes_a_day_later(
    opened: OpenedLibrary, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    into = tmp_path / "backups"

    def killed(_share: float, _what: str) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("shutil.rmtree", lambda *_, **__: None)
        with pytest.raises(KeyboardInterrupt):
            back_up(opened, into, killed)
    assert find_backups(into) == ()
    remove_old_backups(into)
    (left,) = into.iterdir()
    assert left.name.startswith(".")
    remove_old_backups(into, lambda: datetime.datetime.now(datetime.UTC) + datetime.timedelta(2))
    assert list(into.iterdir()) == []


def test_a_backup_is_in_the_audit_before_it_is_made(opened: OpenedLibrary, tmp_path: Path) -> None:
    back_up(opened, tmp_path / "backups")
    noted = [entry for entry in opened.library.audit.entries() if entry.action == Action.BACKUP]
    assert [json.loads(entry.details) for entry in noted] == [
        {},
        {"is_checked": True, "files": 2, "faults": 0, "has_videos": False},
    ]


def test_what_a_kill_left_of_a_restore_is_gone_at_the_next_start(
    opened: OpenedLibrary, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    backup = back_up(opened, tmp_path / "backups")
    opened.library.close()
    target = tmp_path / "rs"

    def killed(_share: float, _what: str) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("shutil.rmtree", lambda *_, **__: None)
        with pytest.raises(KeyboardInterrupt):
            restore(backup.folder, target, opened.data_key, "hk", killed)
    assert list(tmp_path.glob(".rs-*"))
    somebodys = tmp_path / ".rs-notes"
    somebodys.mkdir()
    restore(backup.folder, target, opened.data_key, "hk")
    with held_alone(target):
        assert list(tmp_path.glob(".rs-*")) == [somebodys]


def test_a_restore_is_not_held_up_by_what_a_kill_left_where_an_open_file_does_not_go(
    opened: OpenedLibrary, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on a disk of the network, or on Windows."""
    backup = back_up(opened, tmp_path / "backups")
    left, remove = tmp_path / ".rs-abcdefgh", shutil.rmtree
    left.mkdir()
    (left / IN_USE).touch()

    def remove_closed(folder: Path, *, ignore_errors: bool = False) -> None:
        if (folder / IN_USE).exists():
            try:
                with held(folder / IN_USE):
                    pass
            except BlockingIOError:
                raise OSError(errno.ENOTEMPTY, "Directory not empty") from None
        remove(folder, ignore_errors=ignore_errors)

    monkeypatch.setattr("shutil.rmtree", remove_closed)
    restore(backup.folder, tmp_path / "rs", opened.data_key, "hk")
    assert not left.exists()


def test_a_disk_that_refuses_the_copy_of_the_database_is_stated_and_nothing_is_left(
    opened: OpenedLibrary, tmp_path: Path
) -> None:
    def refuse(share: float, _what: str) -> None:
        if share:  # amid the copying of the database
            raise sqlite.OperationalError("disk I/O error")

    with pytest.raises(LibraryError, match=r"This folder is not writable \(disk I/O error\)"):
        back_up(opened, tmp_path / "backups", refuse)
    assert list((tmp_path / "backups").iterdir()) == []
