"""A changed data key locks out who is left out, keeps everybody else, and survives a kill at any point."""

import base64
import json
import os
import secrets
import shutil
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from uuid import UUID

import pytest
from cryptography.hazmat.primitives.ciphers.aead import AESGCM
from cryptography.hazmat.primitives.kdf.argon2 import Argon2id

from app.storage.backup import back_up, restore
from app.storage.bringing_home import bring_home
from app.storage.data_key import DataKey
from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.ids import uuid7
from app.storage.derived_keys import derived_from
from app.storage.journal.header import find_segments, read_header
from app.storage.journal.payloads import Belonging
from app.storage.journal.reader import JournalReader
from app.storage.journal.writer import JournalWriter
from app.storage.journal_headers import write_headers
from app.storage.key_change import change_data_key
from app.storage.keys import KeyRefusedError, KeySlots
from app.storage.layout import DATABASE, KEYS, NEW_DATABASE, NEW_KEYS
from app.storage.library import Library
from app.storage.opened import OpenedLibrary, open_library
from app.storage.recovery import adopt_home, find_interrupted
from app.storage.root import LibraryGoneError
from app.storage.slots import Cost
from app.storage.stored import LibraryBusyError, LibraryError, Operator, Role, StoredRecording
from app.system.progress import nobody
from core.session import Recording, RecordingKind
from tests.app.storage.library.conftest import ANY_ROOM, PASSPHRASE

LEAVING = "another four short words"

Record = Callable[..., StoredRecording]


@pytest.fixture
def slots(opened: OpenedLibrary) -> KeySlots:
    """With a second operator, `ab`, who is to leave."""
    assert opened.data_key is not None
    slots = KeySlots(opened.folder / KEYS, Cost(passes=1, memory_kib=64))
    slots.add(opened.data_key, "ab", LEAVING)
    opened.library.operators.add(Operator("ab", "A. Bauer", Role.CLINICIAN))
    return slots


def samples_of(opened: OpenedLibrary) -> dict[str, int]:
    """Records by journal, each of which opens with its row's key and with its own header's."""
    found = {}
    for paths in find_segments(opened.recordings).values():
        for path in paths.values():
            reader = JournalReader(path, opened.data_key)
            found[path.name] = sum(1 for _ in reader.records())
            assert reader.report.is_whole
    return found


def test_who_leaves_opens_nothing_new_with_an_old_copy_of_the_keys(
    opened: OpenedLibrary, slots: KeySlots, record: Record, tmp_path: Path
) -> None:
    record("walk 1")
    shutil.copy(opened.folder / KEYS, tmp_path / KEYS)
    before, old_samples = bytes(opened.data_key or b""), samples_of(opened)
    changed = change_data_key(opened, ["hk"], nobody)
    stolen = KeySlots(tmp_path / KEYS).open("ab", LEAVING)
    assert bytes(stolen) == before != bytes(changed.data_key)
    with pytest.raises(KeyRefusedError):
        slots.open("ab", LEAVING)
    with pytest.raises(LibraryError, match="This key does not open the library, or the start of its file is damaged"):
        Library.open(opened.folder, stolen)
    with open_library(opened.folder, PASSPHRASE) as again:
        assert again.data_key == changed.data_key
        assert samples_of(again) == old_samples
        for paths in find_segments(again.recordings).values():
            with pytest.raises(Exception, match="the key of this recording is damaged or belongs to another library"):
                read_header(paths[1]).key(stolen, "journal")
        assert not again.library.faults()
        assert not again.library.audit.verify().faults
    left = sorted(path.name for path in opened.folder.iterdir())
    assert left == ["keys.json", "keys.json.lock", "library-id", DATABASE, "recordings"]


def test_all_others_and_the_recovery_key_open_as_before(opened: OpenedLibrary, slots: KeySlots) -> None:
    assert opened.data_key is not None
    slots.add(opened.data_key, "cd", "one more passphrase of words")
    secret = b"what a keyring holds"
    slots.set_keyring_slot(opened.data_key, "hk", secret)
    slots.set_keyring_slot(opened.data_key, "ab", secret)
    text = slots.renew_recovery_key(opened.data_key)
    changed = change_data_key(opened, ["hk", "cd"], nobody)
    assert changed.left_out == ()
    assert changed.recovery_key == ""
    assert slots.codes == ("hk", "cd")
    keyring = slots.keyring_slot("hk")
    assert keyring is not None
    assert slots.keyring_slot("ab") is None
    for key in (
        slots.open("hk", PASSPHRASE),
        slots.open("cd", "one more passphrase of words"),
        slots.open_with_recovery_key(text),
        keyring.opened(secret),
    ):
        assert key == changed.data_key


def test_the_audit_goes_on_and_pseudonyms_stay(opened: OpenedLibrary, slots: KeySlots) -> None:
    first = derived_from(opened.data_key)
    end = opened.library.audit.verify().end
    change_data_key(opened, ["hk"], nobody)
    with open_library(opened.folder, PASSPHRASE) as again:
        assert again.library.pseudonyms_key == first.pseudonyms
        assert again.library.audit.verify(end).faults == ()
        change_data_key(again, ["hk"], nobody)
    with open_library(opened.folder, PASSPHRASE) as again:
        assert again.library.pseudonyms_key == first.pseudonyms
        assert again.library.audit.verify(end).faults == ()


def test_a_backup_of_before_keeps_its_old_key_and_one_of_after_has_the_new(
    opened: OpenedLibrary, slots: KeySlots, record: Record, tmp_path: Path
) -> None:
    record("walk 1")
    for name in ("backups", "later"):
        (tmp_path / name).mkdir()
    before = back_up(opened, tmp_path / "backups")
    change_data_key(opened, ["hk"], nobody)
    old_key = KeySlots(before.folder / KEYS).open("ab", LEAVING)
    assert restore(before.folder, tmp_path / "restored", old_key, "hk") == ()
    with open_library(opened.folder, PASSPHRASE) as again:
        assert back_up(again, tmp_path / "later").faults == ()


def test_a_key_is_not_changed_while_something_is_being_recorded(
    opened: OpenedLibrary, slots: KeySlots, record: Record
) -> None:
    record("walk 1", is_stopped=False)
    with pytest.raises(LibraryError, match="is running or was not completed"):
        change_data_key(opened, ["hk"], nobody)
    assert slots.open("ab", LEAVING) == opened.data_key


def test_a_key_is_not_changed_while_a_recording_waits_to_come_home(
    opened: OpenedLibrary, slots: KeySlots, session_id: UUID, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its journal has the old key, and would open no more; once it is in the library it gets the new one."""
    monkeypatch.setattr("app.storage.root.platformdirs.user_data_path", lambda *_, **__: tmp_path / "data")
    opened.folder.rename(tmp_path / "renamed")
    reported = Recording("walk 1", RecordingKind.WALKING, "walk_1", {})
    with JournalWriter.create(
        opened.recordings, uuid7(), opened.data_key, room=ANY_ROOM, shelter=opened.shelter
    ) as writer:
        writer.mark(Belonging(session_id, reported).text())
    with pytest.raises(LibraryGoneError):
        change_data_key(opened, ["hk"], nobody)
    (tmp_path / "renamed").rename(opened.folder)
    with pytest.raises(
        LibraryError, match="Recordings made while the library was unavailable are not in the library yet"
    ) as refused:
        change_data_key(opened, ["hk"], nobody)
    assert opened.shelter is not None
    assert str(opened.shelter.folder) in refused.value.remedy
    assert slots.open("ab", LEAVING) == opened.data_key
    bring_home(opened)
    (home,) = find_interrupted(opened)
    adopt_home(opened, home, nobody)
    opened.shelter.made()  # that a folder was left over is in nobody's way
    change_data_key(opened, ["hk"], nobody)
    with open_library(opened.folder, PASSPHRASE) as again:
        assert samples_of(again)


def test_a_key_is_not_changed_under_another_program(opened: OpenedLibrary, slots: KeySlots) -> None:
    with open_library(opened.folder, PASSPHRASE, "hk") as other:
        with pytest.raises(LibraryBusyError, match="has the library open"):
            change_data_key(opened, ["hk"], nobody)
        assert other.library.audit.verify().faults == ()
    assert slots.open("ab", LEAVING) == opened.data_key
    with open_library(opened.folder, PASSPHRASE, "hk") as again:
        assert again.library.faults() == ()


def first_format(data_key: DataKey, code: str, secret: str) -> dict[str, object]:
    """A slot as the first format had it, where the wrapped key is the data key itself."""
    salt, nonce = secrets.token_bytes(16), secrets.token_bytes(12)
    key = Argon2id(salt=salt, length=32, iterations=1, lanes=1, memory_cost=64).derive(secret.encode())
    text = {name: base64.b64encode(value).decode() for name, value in (("salt", salt), ("nonce", nonce))}
    bound = f"gaitwright-keys/1 {code} {text['salt']} 1 64".encode()
    wrapped = base64.b64encode(AESGCM(key).encrypt(nonce, bytes(data_key), bound)).decode()
    return {"code": code, **text, "wrapped": wrapped, "passes": 1, "memory_kib": 64}


@pytest.mark.endurance
def test_slots_of_the_first_format_open_and_become_new_ones(opened: OpenedLibrary, slots: KeySlots) -> None:
    assert opened.data_key is not None
    path = opened.folder / KEYS
    old = [first_format(opened.data_key, code, secret) for code, secret in (("hk", PASSPHRASE), ("ab", LEAVING))]
    recovery = first_format(opened.data_key, "recovery", "x" * 20)
    path.write_text(json.dumps({"format": "gaitwright-keys/1", "slots": [*old, recovery]}))
    with pytest.raises(KeyRefusedError, match="Log in with the passphrase once"):
        slots.sealed_again(opened.data_key, DataKey(bytes(32)), ["hk", "ab"])
    assert slots.open("hk", PASSPHRASE) == opened.data_key
    assert slots.is_recovery_key_confirmed
    changed = change_data_key(opened, ["hk", "ab"], nobody)
    assert changed.left_out == ("ab",)
    assert slots.open("hk", PASSPHRASE) == slots.open_with_recovery_key(changed.recovery_key) == changed.data_key
    assert not slots.is_recovery_key_confirmed


def test_to_a_public_key_that_an_outsider_put_there_nothing_is_sealed(opened: OpenedLibrary, slots: KeySlots) -> None:
    path = opened.folder / KEYS
    content = json.loads(path.read_bytes())
    foreign = KeySlots(opened.folder / "other.json", Cost(passes=1, memory_kib=64))
    foreign.create("ab", LEAVING)
    (planted,) = (s for s in json.loads((opened.folder / "other.json").read_bytes())["slots"] if s["code"] == "ab")
    content["slots"] = [planted if slot["code"] == "ab" else slot for slot in content["slots"]]
    path.write_text(json.dumps(content))
    changed = change_data_key(opened, ["hk", "ab"], nobody)
    assert changed.left_out == ("ab",)
    with pytest.raises(KeyRefusedError):
        slots.open("ab", LEAVING)


def test_headers_that_a_kill_left_are_written_at_the_next_start(
    opened: OpenedLibrary, slots: KeySlots, record: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    record("walk 1")

    def fail(_database: Database, _library: Path) -> None:
        raise OSError(5, "killed here")

    monkeypatch.setattr("app.storage.key_change.write_headers", fail)
    with pytest.raises(OSError, match="killed"):
        change_data_key(opened, ["hk"], nobody)
    with open_library(opened.folder, PASSPHRASE) as again:
        (recording,) = (recording for paths in find_segments(again.recordings).values() for recording in paths.values())
        row = again.library.recordings.known()
        assert row
        with pytest.raises(Exception, match="the key of this recording is damaged or belongs to another library"):
            JournalReader(recording, again.data_key)
        database = Database(sqlite_engine(again.folder / DATABASE, again.data_key))
        write_headers(database, again.folder)
        database.close()
        assert samples_of(again)


@pytest.mark.endurance
@pytest.mark.skipif(not hasattr(os, "fork"), reason="the child is a fork")
@pytest.mark.parametrize("at", [3, 12, 20, 24, 28, 32])
def test_a_kill_at_any_point_leaves_the_old_key_or_the_new_one(
    opened: OpenedLibrary, slots: KeySlots, record: Record, at: int
) -> None:
    record("walk 1")
    expected = samples_of(opened)
    opened.library.close()
    if (child := os.fork()) == 0:
        seen = [0]

        def kill(event: str, _arguments: object) -> None:
            if event in ("open", "os.rename", "os.remove", "sqlite3.connect"):
                seen[0] += 1
                if seen[0] == at:
                    os.kill(os.getpid(), signal.SIGKILL)

        try:
            again = open_library(opened.folder, PASSPHRASE, "hk")
            sys.addaudithook(kill)
            change_data_key(again, ["hk"], nobody)
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    with open_library(opened.folder, PASSPHRASE, "hk") as after:
        database = Database(sqlite_engine(after.folder / DATABASE, after.data_key))
        write_headers(database, after.folder)
        database.close()
        assert samples_of(after) == expected
        assert not after.library.faults()
        assert not after.library.audit.verify().faults
    assert not (opened.folder / NEW_KEYS).exists()
    assert not (opened.folder / NEW_DATABASE).exists()
