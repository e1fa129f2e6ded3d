"""A library that was put back to an older state is noticed by the computer that saw it, and by no other."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from app.storage.backup import back_up, restore
from app.storage.library import Library
from app.storage.opened import OpenedLibrary, open_library
from app.storage.rollback import Rollback, SeenLibraries
from app.storage.stored import Action, NotAllowedError, Operator, Role
from core.session import Patient

PASSPHRASE = "four short words here"

Seen = Callable[[], SeenLibraries]


@pytest.fixture
def seen(tmp_path: Path) -> Seen:
    """This computer, started again."""
    return lambda: SeenLibraries(tmp_path / "seen")


def work_on(opened: OpenedLibrary, seen: SeenLibraries, patients: int = 3) -> int:
    """Add patients, which this computer sees; gives the number of the last entry."""
    for _ in range(patients):
        count = len(opened.library.patients.search())
        opened.library.patients.create(Patient(code=f"P-{count}"))
    seen.remember(opened.library)
    return opened.library.audit.end.number


def test_an_older_copy_that_was_put_back_is_noticed(opened: OpenedLibrary, seen: Seen, tmp_path: Path) -> None:
    kept = work_on(opened, seen())
    opened.library.close()
    shutil.copytree(opened.folder, tmp_path / "copy")
    with open_library(opened.folder, PASSPHRASE) as later:
        assert seen().look(later.library) is None
        last = work_on(later, seen())
    shutil.rmtree(opened.folder)
    shutil.copytree(tmp_path / "copy", opened.folder)
    for _ in range(3):  # until it is accepted, and however much is added meanwhile
        with open_library(opened.folder, PASSPHRASE) as old:
            assert seen().look(old.library) == Rollback(kept + 1, last)
            assert old.library.audit.verify().faults == ()  # it is whole: nothing else reports
            work_on(old, seen(), patients=5)


def test_a_restored_backup_is_stated_once_and_accepted_by_an_administrator(
    opened: OpenedLibrary, seen: Seen, tmp_path: Path
) -> None:
    opened.library.operators.add(Operator("ab", "A. Bauer", Role.CLINICIAN))
    common = work_on(opened, seen())
    (tmp_path / "backups").mkdir()
    backup = back_up(opened, tmp_path / "backups")
    last = work_on(opened, seen())
    assert restore(backup.folder, tmp_path / "restored", opened.data_key, "hk") == ()
    with open_library(tmp_path / "restored", PASSPHRASE) as restored:
        rollback = seen().look(restored.library)
        assert rollback is not None
        assert rollback == Rollback(common + 1, last)
        restored.library.log_in("ab")
        with pytest.raises(NotAllowedError):
            seen().accept(restored.library, rollback)
        assert seen().look(restored.library) == rollback
        restored.library.log_in("hk")
        seen().accept(restored.library, rollback)
        entry = restored.library.audit.entries()[-1]
        assert (entry.action, entry.subject) == (Action.EDIT, "library")
        assert str(last) in entry.details
    with open_library(tmp_path / "restored", PASSPHRASE) as again:
        assert seen().look(again.library) is None
        work_on(again, seen())
    with open_library(tmp_path / "restored", PASSPHRASE) as again:
        assert seen().look(again.library) is None


def test_another_computer_states_nothing(opened: OpenedLibrary, seen: Seen, tmp_path: Path) -> None:
    work_on(opened, seen())
    opened.library.close()
    shutil.copytree(opened.folder, tmp_path / "copy")
    with open_library(opened.folder, PASSPHRASE) as later:
        work_on(later, seen())
    with open_library(tmp_path / "copy", PASSPHRASE) as old:
        assert SeenLibraries(tmp_path / "second computer").look(old.library) is None
        assert seen().look(old.library) is not None


def test_work_that_this_computer_has_not_seen_is_no_rollback(opened: OpenedLibrary, seen: Seen) -> None:
    work_on(opened, seen())
    opened.library.patients.create(Patient(code="elsewhere"))  # by the command line, or from another computer
    opened.library.close()
    with open_library(opened.folder, PASSPHRASE) as again:
        assert seen().look(again.library) is None


def test_another_library_is_another_memory(opened: OpenedLibrary, seen: Seen, tmp_path: Path) -> None:
    work_on(opened, seen(), patients=9)
    operator = Operator("hk", "H. Keller", Role.ADMINISTRATOR)
    Library.create(tmp_path / "other", bytes(range(32)), operator).close()
    with Library.open(tmp_path / "other", bytes(range(32))) as other:
        other.log_in("hk")
        assert seen().look(other) is None


@pytest.mark.parametrize("content", [b"", b"{}", b'{"format": "gaitwright-seen/1", "seen": ["x"], "missing_from": 0}'])
def test_a_damaged_memory_is_none(opened: OpenedLibrary, seen: Seen, tmp_path: Path, content: bytes) -> None:
    work_on(opened, seen())
    (file,) = (tmp_path / "seen").iterdir()
    file.write_bytes(content)
    assert seen().look(opened.library) is None
