"""A library that goes away while it is open is missed within a second, and welcomed back with what was recorded."""

import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from uuid import UUID

import pytest
from PySide6.QtTest import QSignalSpy
from pytestqt.qtbot import QtBot

from app.home.settings.controller import _slots
from app.storage.bringing_home import bring_home
from app.storage.database.ids import uuid7
from app.storage.journal.disk import Room
from app.storage.journal.payloads import Belonging
from app.storage.journal.writer import JournalWriter
from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.storage.login_delay import LoginDelay
from app.storage.opened import OpenedLibrary, held_alone
from app.storage.recovery import find_interrupted
from app.storage.root import LibraryGoneError
from app.storage.stored import LibraryError, Operator, Role
from app.workers.library_controller import LibraryController
from app.workers.library_state import Unlocked
from core.session import Patient, Recording, RecordingKind, Session
from tests.app.library_answers import Asker
from tests.app.library_answers import opened as opened_at
from tests.quick_library import CHEAP, PASSPHRASE, quick_library

ANY_ROOM = Room(start_bytes=0, kept_bytes=0)


@pytest.fixture(autouse=True)
def _own_data_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.storage.root.platformdirs.user_data_path", lambda *_, **__: tmp_path / "data")


@pytest.fixture(scope="module")
def untouched(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("watched")
    quick_library(folder).library.close()
    return folder


@pytest.fixture
def folder(untouched: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(untouched, tmp_path / "library"))


@pytest.fixture
def controller(qtbot: QtBot, folder: Path) -> Iterator[LibraryController]:
    controller = LibraryController()
    opened_at(qtbot, controller, folder, PASSPHRASE)
    yield controller
    controller.finish()


def opened_of(controller: LibraryController) -> OpenedLibrary:
    assert controller.state is not None
    return controller.state.library


def visit_of(opened: OpenedLibrary) -> UUID:
    patient = opened.library.patients.create(Patient(code="P-001"))
    return opened.library.sessions.create(patient.id, Session(())).id


def take_away(qtbot: QtBot, controller: LibraryController, folder: Path) -> Path:
    """Rename the library's folder, and wait until it is missed; where it is now."""
    elsewhere = folder.with_name("renamed")
    with qtbot.waitSignal(controller.gone):
        folder.rename(elsewhere)
    return elsewhere


def fill_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let nothing be copied home."""

    def full(_source: Path, _target: Path) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("app.storage.bringing_home._copy", full)


def record_away(opened: OpenedLibrary, session_id: UUID, name: str = "walk 1") -> UUID:
    """A recording that was made while the library was gone."""
    recording_id, reported = uuid7(), Recording(name, RecordingKind.WALKING, name.replace(" ", "_"), {})
    writer = JournalWriter.create(
        opened.recordings, recording_id, opened.data_key, room=ANY_ROOM, shelter=opened.shelter
    )
    writer.mark(Belonging(session_id, reported).text())
    assert writer.stop().is_away
    return recording_id


@pytest.mark.endurance
def test_it_is_missed_within_a_second_and_stated_where_recordings_go(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    opened = opened_of(controller)
    elsewhere = folder.with_name("renamed")
    seen = [controller.is_gone]
    began_s = time.monotonic()
    with qtbot.waitSignal(controller.gone) as stated:
        folder.rename(elsewhere)
    assert time.monotonic() - began_s < 1.5
    what, then = stated.args or ["", ""]
    assert what == f"The library is no longer in {folder}."
    assert opened.shelter is not None
    assert str(opened.shelter.folder) in then
    assert "connect its disk" in then
    seen.append(controller.is_gone)
    with qtbot.waitSignal(controller.back) as stated:
        elsewhere.rename(folder)
    assert stated.args == ["The library is available again.", "There were no recordings to add."]
    assert [*seen, controller.is_gone] == [False, True, False]
    assert not opened.shelter.folder.exists()


@pytest.mark.endurance
def test_what_was_recorded_meanwhile_is_home_once_it_is_back(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    opened = opened_of(controller)
    session_id = visit_of(opened)
    elsewhere = take_away(qtbot, controller, folder)
    recording_id = record_away(opened, session_id)
    with qtbot.waitSignal(controller.back) as stated:
        elsewhere.rename(folder)
    assert stated.args is not None
    assert stated.args[1] == "1 recording made meanwhile was added."
    assert [path.name for path in opened.recordings.iterdir()] == [f"{recording_id}.1.journal"]


def test_what_was_recorded_meanwhile_is_home_at_the_next_start(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    """Of this library: of another one nothing is taken."""
    opened = opened_of(controller)
    session_id = visit_of(opened)
    elsewhere = take_away(qtbot, controller, folder)
    recording_id = record_away(opened, session_id)
    with qtbot.waitSignal(controller.closed):
        controller.close()
    elsewhere.rename(folder)
    opened_at(qtbot, controller, folder, PASSPHRASE)
    assert controller.state is not None
    assert controller.state.brought_home == {recording_id}
    assert [(one.recording_id, one.problem) for one in controller.state.interrupted] == [(recording_id, "")]
    opened_at(qtbot, controller, folder, PASSPHRASE)
    assert controller.state.brought_home == frozenset()


@pytest.mark.endurance
def test_a_library_that_stays_is_not_missed(qtbot: QtBot, controller: LibraryController, folder: Path) -> None:
    with qtbot.assertNotEmitted(controller.gone, wait=1200):
        opened_of(controller).library.patients.create(Patient(code="P-002"))


@pytest.mark.endurance
def test_what_cannot_be_brought_home_is_stated_once_and_kept(
    qtbot: QtBot, controller: LibraryController, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = opened_of(controller)
    session_id = visit_of(opened)
    elsewhere = take_away(qtbot, controller, folder)
    recording_id = record_away(opened, session_id)
    fill_disk(monkeypatch)
    with qtbot.waitSignal(controller.refused) as stated:
        elsewhere.rename(folder)
    assert stated.args is not None
    assert "could not be added yet (No space left on device)" in stated.args[0]
    assert opened.shelter is not None
    assert str(opened.shelter.folder) in stated.args[1]
    monkeypatch.undo()
    monkeypatch.setattr("app.storage.root.platformdirs.user_data_path", lambda *_, **__: folder.parent / "data")
    assert bring_home(opened) == {recording_id}


def test_keys_are_changed_of_the_library_that_is_open_only(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    """Another library in its place keeps its own."""
    opened = opened_of(controller)
    assert "hk" in _slots(opened).codes
    take_away(qtbot, controller, folder)
    folder.mkdir()
    KeySlots(folder / KEYS, CHEAP).create("hk", PASSPHRASE)
    with pytest.raises(LibraryGoneError):
        _slots(opened)


@pytest.mark.endurance
def test_after_a_change_of_the_key_the_library_is_watched_as_before(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    """Its database is another file then, and its folder the same."""
    asker, before = Asker(), opened_of(controller)
    gone = QSignalSpy(controller.gone)
    controller.reopen(lambda holder, report: holder.change_key("", report), *asker.all_ears)
    qtbot.waitUntil(lambda: bool(asker.results or asker.refusals))
    assert asker.refusals == []
    assert opened_of(controller) is not before
    qtbot.wait(1200)
    assert gone.count() == 0
    with pytest.raises(LibraryError, match="This library is already open in Gaitwright"), held_alone(folder):
        pass
    elsewhere = take_away(qtbot, controller, folder)
    recording_id = record_away(opened_of(controller), visit_id := uuid7())
    with qtbot.waitSignal(controller.back) as stated:
        elsewhere.rename(folder)
    assert stated.args is not None
    assert stated.args[1] == "1 recording made meanwhile was added."
    (found,) = find_interrupted(opened_of(controller))
    assert (found.recording_id, found.problem) == (recording_id, "")
    assert found.belonging is not None
    assert found.belonging.session_id == visit_id


def test_the_key_is_not_changed_while_the_library_is_gone(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    asker, opened = Asker(), opened_of(controller)
    take_away(qtbot, controller, folder)
    controller.reopen(lambda holder, report: holder.change_key("", report), *asker.all_ears)
    assert asker.refusals == [controller.gone_words]
    assert controller.is_gone
    assert opened_of(controller) is opened


@pytest.mark.endurance
def test_the_key_is_not_changed_while_what_was_recorded_waits_and_nobody_is_removed(
    qtbot: QtBot, controller: LibraryController, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asker, opened = Asker(), opened_of(controller)
    opened.library.operators.add(Operator("ab", "A. Bauer", Role.CLINICIAN))
    assert opened.shelter is not None
    elsewhere = take_away(qtbot, controller, folder)
    record_away(opened, uuid7())
    fill_disk(monkeypatch)
    with qtbot.waitSignals([controller.refused, controller.back]):
        elsewhere.rename(folder)
    controller.reopen(
        lambda holder, report: holder.change_key("ab", report),
        *asker.all_ears,
    )
    qtbot.waitUntil(lambda: bool(asker.results or asker.refusals))
    ((what, remedy),) = asker.refusals
    assert what.startswith("Recordings made while the library was unavailable are not in the library yet")
    assert str(opened.shelter.folder) in remedy
    assert [one.is_active for one in opened_of(controller).library.operators.list()] == [True, True]
    with qtbot.waitSignal(controller.gone):  # it is watched all the same
        folder.rename(elsewhere)


def test_a_library_that_is_closed_while_its_key_changes_stays_closed(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    asker = Asker()
    controller.reopen(lambda holder, report: holder.change_key("", report), *asker.all_ears)
    with qtbot.waitSignal(controller.closed):
        controller.close()
    assert controller.state is None
    assert controller._watch is None
    with held_alone(folder):
        assert not bool(asker.results or asker.refusals)


@pytest.mark.endurance
def test_under_the_lock_files_come_home_and_reading_them_waits_for_the_key(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    asker, opened = Asker(), opened_of(controller)
    elsewhere = take_away(qtbot, controller, folder)
    recording_id = record_away(opened, uuid7())
    controller.lock()
    qtbot.waitUntil(lambda: not opened.data_key)
    with qtbot.waitSignal(controller.back):
        elsewhere.rename(folder)
    assert [path.name for path in opened.recordings.iterdir()] == [f"{recording_id}.1.journal"]
    controller.run_long(lambda library, _report: find_interrupted(library), asker.on_done, asker.on_failed, None, asker)
    qtbot.wait(300)
    assert not bool(asker.results or asker.refusals)
    controller.call(lambda holder: holder.unlock("hk", PASSPHRASE, None), *asker.ears)
    qtbot.waitUntil(lambda: len(asker.results) == 2)
    (found,) = asker.results[1] if isinstance(asker.results[1], tuple) else ()
    assert (found.recording_id, found.problem) == (recording_id, "")


def test_a_passphrase_for_a_library_that_is_gone_counts_as_no_wrong_one(
    qtbot: QtBot, controller: LibraryController, folder: Path
) -> None:
    asker, delay = Asker(), LoginDelay(folder, time.monotonic)
    controller.lock()
    elsewhere = take_away(qtbot, controller, folder)
    for _ in range(4):
        controller.call(lambda holder: holder.unlock("hk", PASSPHRASE, delay), *asker.ears)
    qtbot.waitUntil(lambda: len(asker.refusals) == 4)
    assert {what for what, _ in asker.refusals} == {f"The library is no longer in {folder}."}
    assert delay.left_s("hk") == 0.0
    assert not folder.exists()
    elsewhere.rename(folder)
    controller.call(lambda holder: holder.unlock("hk", PASSPHRASE, delay), *asker.ears)
    qtbot.waitUntil(lambda: asker.results == [Unlocked()])


@pytest.mark.endurance
def test_a_demonstration_that_is_gone_promises_no_shelter(qtbot: QtBot, controller: LibraryController) -> None:
    with qtbot.waitSignal(controller.opened):
        controller.open_demonstration()
    opened = opened_of(controller)
    assert opened.shelter is None
    elsewhere = opened.folder.with_name(f"{opened.folder.name}-renamed")
    with qtbot.waitSignal(controller.gone) as stated:
        opened.folder.rename(elsewhere)
    elsewhere.rename(opened.folder)  # to be removed
    assert stated.args is not None
    assert stated.args[1] == "The demonstration ends here. Open the demonstration again."
