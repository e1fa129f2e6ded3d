"""The command line opens a library with a passphrase that nobody sees, recovers, and analyses its sessions."""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from uuid import UUID, uuid4

import pytest

from app.cli import main as cli
from app.storage.database.ids import uuid7
from app.storage.exchange import import_session
from app.storage.journal.disk import Room
from app.storage.journal.payloads import Belonging
from app.storage.journal.writer import JournalWriter
from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.storage.opened import OpenedLibrary, held_alone
from app.storage.recovery import find_interrupted
from app.storage.slots import Cost
from app.storage.stored import Action, StoredRecording
from app.system.progress import nobody
from core.session import Recording, RecordingKind
from tests.app.storage.library.folder_export import write_folder
from tests.simulated import SHORT_VISIT, session_of

PASSPHRASE = "four short words here"
ANY_ROOM = Room(start_bytes=0, kept_bytes=0)
FILES = ("summary.json", "walk_1/angles.csv", "walk_1/strides.csv", "free_motion/angles.csv")

Record = Callable[..., StoredRecording]


@pytest.fixture
def key(tmp_path: Path) -> list[str]:
    file = tmp_path / "passphrase"
    file.write_text(f"{PASSPHRASE}\nanything\n", encoding="utf-8")
    return ["--passphrase-file", str(file)]


def test_recover_closes_what_was_interrupted_and_states_so(
    opened: OpenedLibrary, record: Record, session_id: UUID, key: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    record("walk 1")
    record("walk 2", is_stopped=False)
    (opened.recordings / record("walk 3", is_stopped=False).journals[0].file).unlink()
    record("left over", is_stopped=False, has_row=False)
    assert cli.main(["recover", str(opened.folder), *key]) == 0
    second, third, orphan = sorted(capsys.readouterr().out.splitlines(), key=lambda line: line.startswith("- "))
    assert second.startswith("walk 2: 00:00 was recovered. ")
    assert str(session_id) in second
    assert third == "- walk 3: part 1 of this recording is missing. Restore this recording from a backup."
    assert "belongs to no session" in orphan
    assert cli.main(["recover", str(opened.folder), *key, "--into", f"library:{session_id}"]) == 0
    assert f"was recovered into library:{session_id}" in capsys.readouterr().out
    assert [one.stored.details.name for one in find_interrupted(opened) if one.stored] == ["walk 3"]


def test_recover_states_when_there_is_nothing_to_do(
    opened: OpenedLibrary, key: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["recover", str(opened.folder), *key, "--operator", "hk"]) == 0
    assert capsys.readouterr().out == "Every recording was stopped. Nothing had to be recovered.\n"


def test_what_does_not_open_is_one_line_without_the_passphrase(
    opened: OpenedLibrary, tmp_path: Path, key: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = tmp_path / "wrong"
    wrong.write_text("nobody's passphrase")
    binary = tmp_path / "binary"
    binary.write_bytes(b"\xff\xfe\xfd")
    here = str(opened.folder)
    for arguments in (
        [here, "--passphrase-file", str(wrong)],
        [here, "--passphrase-file", str(binary)],
        [here, "--passphrase-file", str(tmp_path / "none")],
        [here, *key, "--operator", "somebody"],
        [str(tmp_path), *key],
        [here],
        [here, *key, "--into", str(uuid4())],
    ):
        code = cli.main(["recover", *arguments])
        stated = capsys.readouterr()
        if "--into" in arguments:
            assert code == 0  # there was nothing to put there
            continue
        assert code == 2, arguments
        assert stated.err.count("\n") == 1
        assert "passphrase's" not in stated.err
        assert PASSPHRASE not in stated.err


def test_where_there_are_several_users_the_option_that_names_one_is_reported(
    opened: OpenedLibrary, key: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert opened.data_key is not None
    slots = KeySlots(opened.folder / KEYS, Cost(passes=1, memory_kib=64))
    slots.add(opened.data_key, "ab", "lamp river onion seventeen cloud")
    assert cli.main(["recover", str(opened.folder), *key]) == 2
    assert "This library has several users. Enter your user code (--operator CODE)." in capsys.readouterr().err


def test_a_library_that_is_in_use_is_not_recovered(
    opened: OpenedLibrary, record: Record, key: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    record("walk 1", is_stopped=False)
    with held_alone(opened.folder):
        assert cli.main(["recover", str(opened.folder), *key]) == 2
    assert "This library is already open in Gaitwright" in capsys.readouterr().err
    assert len(find_interrupted(opened)) == 1


def test_on_a_terminal_the_passphrase_is_asked_for_and_not_shown(
    opened: OpenedLibrary, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stdin, "isatty", lambda: True)
    monkeypatch.setattr("getpass.getpass", lambda prompt: PASSPHRASE)
    assert cli.main(["recover", str(opened.folder)]) == 0
    stated = capsys.readouterr()
    assert PASSPHRASE not in stated.out + stated.err


@pytest.mark.endurance
def test_a_session_of_the_library_gives_the_same_results_as_its_folder(
    opened: OpenedLibrary, tmp_path: Path, key: list[str]
) -> None:
    session = session_of(SHORT_VISIT)
    imported = import_session(opened, session, nobody, room=Room(start_bytes=0, kept_bytes=0))
    write_folder(opened, imported.session_id, tmp_path / "folder", {}, is_identified=True)
    by_folder, by_library = tmp_path / "one", tmp_path / "two"
    assert cli.main(["analyse", str(tmp_path / "folder"), "--out", str(by_folder), "--no-rrd"]) == 0
    place = ["--library", str(opened.folder), *key]
    required = f"library:{imported.session_id}"
    assert cli.main(["analyse", required, "--out", str(by_library), "--no-rrd", *place]) == 0
    for name in FILES:
        assert (by_folder / name).read_bytes() == (by_library / name).read_bytes(), name
    assert opened.library.audit.entries()[-1].action == Action.VIEW
    assert cli.main(["analyse", f"library:{uuid4()}", "--out", str(tmp_path / "three"), *place]) == 2
    assert cli.main(["analyse", required, "--out", str(opened.folder / "out"), *place]) == 2
    assert not (tmp_path / "three").exists()


@pytest.mark.parametrize("session", ["library:", "library:12", "library:../../etc"])
def test_what_is_no_id_is_refused_as_usage(session: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        cli.main(["analyse", session, "--out", "out"])
    assert ended.value.code == 2
    assert "with the id of a session" in capsys.readouterr().err


def test_an_audit_that_nobody_changed_is_followed_to_its_end(
    opened: OpenedLibrary, session_id: UUID, key: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["audit", str(opened.folder), *key]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    opened.library.sessions.view(session_id)
    assert cli.main(["audit", str(opened.folder), *key, "--since", line]) == 0
    (later,) = capsys.readouterr().out.splitlines()
    assert int(later.split()[1]) > int(line.split()[1])


def test_an_audit_whose_entry_was_changed_or_whose_end_is_missing_is_refused(
    opened: OpenedLibrary, session_id: UUID, key: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    opened.library.sessions.view(session_id)
    assert cli.main(["audit", str(opened.folder), *key]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    longer = line.replace(f" {line.split()[1]} ", " 1000 ")
    assert cli.main(["audit", str(opened.folder), *key, "--since", longer]) == 2
    assert "entry 1000 is not what the checkpoint names, or is missing" in capsys.readouterr().out
    with opened.library.database.rebuilding() as connection:
        connection.exec_driver_sql("DROP TRIGGER audit_no_update")
        connection.exec_driver_sql("UPDATE audit SET action = 'view' WHERE number = 2")
    assert cli.main(["audit", str(opened.folder), *key]) == 2
    reported = capsys.readouterr()
    assert "- entry 2 was changed." in reported.out
    assert "a fault in the audit" in reported.err
    assert cli.main(["audit", str(opened.folder), *key, "--since", "nonsense"]) == 2
    assert "is no line of an earlier audit" in capsys.readouterr().err


def test_recover_brings_home_what_was_recorded_while_the_library_was_gone(
    opened: OpenedLibrary,
    session_id: UUID,
    key: list[str],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("app.storage.root.platformdirs.user_data_path", lambda *_, **__: tmp_path / "data")
    opened.folder.rename(tmp_path / "renamed")
    reported = Recording("walk 1", RecordingKind.WALKING, "walk_1", {})
    with JournalWriter.create(
        opened.recordings, uuid7(), opened.data_key, room=ANY_ROOM, shelter=opened.shelter
    ) as writer:
        writer.mark(Belonging(session_id, reported).text())
    (tmp_path / "renamed").rename(opened.folder)
    assert cli.main(["recover", str(opened.folder), *key]) == 0
    assert f"was recovered into library:{session_id}" in capsys.readouterr().out
    assert not list((tmp_path / "data").rglob("*.journal"))


def test_wrong_passphrases_make_the_command_line_wait_too(
    opened: OpenedLibrary,
    tmp_path: Path,
    key: list[str],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    waited: list[float] = []
    sleep = time.sleep  # the database's, for a moment where its log is busy, stay what they are
    monkeypatch.setattr(time, "sleep", lambda left_s: waited.append(left_s) if left_s > 0.1 else sleep(left_s))
    (tmp_path / "wrong").write_text("nobody's passphrase")
    where = ["recover", str(opened.folder)]
    for expected in (0, 0, 0, 1):
        assert cli.main([*where, "--passphrase-file", str(tmp_path / "wrong")]) != 0
        assert len(waited) == expected
    assert waited[0] == pytest.approx(2.0, abs=0.5)
    assert "this waits for 2 s" in capsys.readouterr().err
    assert cli.main([*where, *key]) == 0
    assert waited[1] == pytest.approx(4.0, abs=0.5)
    assert cli.main([*where, *key]) == 0
    assert len(waited) == 2
