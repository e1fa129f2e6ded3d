"""Home with a library of its own: patients found, sessions listed, deleted and had back, imported, recovered."""

import os
import shutil
import signal
import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from uuid import UUID

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.home.home import Home
from app.importing.untrusted_files import read_foreign_session, the_reader
from app.storage.database.ids import uuid7
from app.storage.exchange import import_session
from app.storage.journal.disk import Room
from app.storage.journal.payloads import Belonging, layout_of
from app.storage.journal.writer import JournalWriter
from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.storage.library import Library
from app.storage.opened import OpenedLibrary
from app.storage.recovery import adopt_home, find_interrupted, recover
from app.storage.rollback import Rollback
from app.storage.stored import LibraryError, PlacedSensor, RecordingState, Role, StoredJournal, StoredPatient
from app.system.settings import Scheme, Settings
from app.widgets.button import Button
from app.widgets.line_list import PatientLine, SessionLine
from app.workers.library_controller import LibraryController
from app.workers.refusals import Refusal
from core.body import Site
from core.samples import ImuBlock, SensorInfo
from core.session import Patient, Recording, RecordingKind, Session
from devices.files.session_folder import write_session
from devices.source import SourceInfo
from tests.app.home.home_library import PASSPHRASE, delete_patient, open_library
from tests.waiting import PATIENCE_S

ANY_ROOM = Room(start_bytes=0, kept_bytes=0)


def lines(home: Home) -> list[PatientLine]:
    return [line for line in home.page.patients.lines if isinstance(line, PatientLine)]


def codes(home: Home) -> list[str]:
    return [line.code for line in lines(home)]


def sessions(home: Home) -> list[SessionLine]:
    return [line for line in home.page.sessions.lines if isinstance(line, SessionLine)]


def delete_session(qtbot: QtBot, home: Home) -> None:
    """The latest of the patient in sight, by its key."""
    qtbot.waitUntil(lambda: len(sessions(home)) == 3)
    home.page.sessions.setFocus()
    QTest.keyClick(home.page.sessions, Qt.Key.Key_Delete)


def restores(home: Home) -> dict[str, Button]:
    """The buttons that bring back what was deleted, by name."""
    buttons = home.settings.page.findChildren(Button)
    return {one.accessibleName(): one for one in buttons if one.accessibleName().startswith("Restore,")}


def test_the_latest_seen_comes_first_with_its_sessions(qtbot: QtBot, home: Home) -> None:
    assert codes(home) == ["P-0163", "P-0147"]
    qtbot.waitUntil(lambda: len(sessions(home)) == 3)
    assert [line.when for line in sessions(home)] == ["20 May 2026", "20 Apr 2026", "20 Mar 2026"]
    first = home.page.patients.lines[0]
    assert isinstance(first, PatientLine)
    assert (first.person, first.sessions) == ("1951, female · right affected", "3 sessions")
    assert home.bar.primary.text() == "New session for P-0163"


def test_typing_finds_by_code_birth_year_and_device(home: Home) -> None:
    both = ["P-0147", "P-0163"]
    for typed, found in (("0147", ["P-0147"]), ("1951", ["P-0163"]), ("MICRO knee", ["P-0147"]), ("p-", both)):
        home.page.search.clear()
        QTest.keyClicks(home.page.search, typed)
        assert sorted(codes(home)) == found
    QTest.keyClicks(home.page.search, "nobody")
    assert codes(home) == []
    assert home.page.patient_id is None
    assert not home.bar.primary.isVisible()
    QTest.keyClick(home.page.search, Qt.Key.Key_Escape)
    assert len(codes(home)) == 2


def test_arrows_choose_while_typing_and_enter_begins(qtbot: QtBot, home: Home) -> None:
    assert home.page.search.hasFocus()
    QTest.keyClick(home.page.search, Qt.Key.Key_Down)
    assert home.bar.primary.text() == "New session for P-0147"
    with qtbot.waitSignal(home.session_requested) as reported:
        QTest.keyClick(home.page.search, Qt.Key.Key_Return)
    (patient,) = reported.args or []
    assert isinstance(patient, StoredPatient)
    assert patient.details.code == "P-0147"


def test_a_session_is_opened_by_a_click_and_by_enter(qtbot: QtBot, home: Home) -> None:
    qtbot.waitUntil(lambda: len(sessions(home)) == 3)
    place = home.page.sessions.visualRect(home.page.sessions.cells.index(1, 0)).center()
    with qtbot.waitSignal(home.session_opened) as reported:
        QTest.mouseClick(home.page.sessions.viewport(), Qt.MouseButton.LeftButton, pos=place)
    assert reported.args == [sessions(home)[1].id]
    QTest.keyClick(home.page.sessions, Qt.Key.Key_Down)
    with qtbot.waitSignal(home.session_opened) as reported:
        QTest.keyClick(home.page.sessions, Qt.Key.Key_Return)
    assert reported.args == [sessions(home)[2].id]


def test_a_deleted_patient_comes_back_by_undo(qtbot: QtBot, home: Home) -> None:
    delete_patient(qtbot, home)
    qtbot.waitUntil(lambda: codes(home) == ["P-0147"])
    assert home.toast.text == "P-0163 was deleted. The deletion becomes permanent in 30 days."
    home.toast.undo()
    qtbot.waitUntil(lambda: codes(home) == ["P-0163", "P-0147"])
    assert home.bar.primary.text() == "New session for P-0163"


def test_what_is_taken_back_while_the_settings_are_in_sight_is_not_listed_there_any_more(
    qtbot: QtBot, home: Home
) -> None:
    delete_patient(qtbot, home)
    qtbot.waitUntil(lambda: codes(home) == ["P-0147"])
    home.show_settings()
    rows = home.settings.page.deleted_rows
    qtbot.waitUntil(lambda: rows.count() == 1)
    home.toast.undo()
    qtbot.waitUntil(lambda: rows.count() == 0)


def test_what_was_deleted_earlier_is_restored_in_the_settings(qtbot: QtBot, home: Home) -> None:
    delete_session(qtbot, home)
    qtbot.waitUntil(lambda: len(sessions(home)) == 2)
    delete_patient(qtbot, home)
    qtbot.waitUntil(lambda: codes(home) == ["P-0147"])
    home.show_settings()
    patient, session = "Restore, P-0163, 1951, female · right affected", "Restore, P-0163, 20 May 2026"
    qtbot.waitUntil(lambda: list(restores(home)) == [patient])
    restores(home)[patient].click()
    qtbot.waitUntil(lambda: list(restores(home)) == [session])
    restores(home)[session].click()
    qtbot.waitUntil(lambda: restores(home) == {})
    qtbot.waitUntil(lambda: [one.sessions for one in lines(home)] == ["3 sessions", "0 sessions"])
    assert not home.settings.page.none_deleted.isHidden()


def test_a_deleted_session_comes_back_by_undo(qtbot: QtBot, home: Home) -> None:
    delete_session(qtbot, home)
    qtbot.waitUntil(lambda: len(sessions(home)) == 2)
    home.toast.undo()
    qtbot.waitUntil(lambda: len(sessions(home)) == 3)


def test_of_two_deletions_the_last_comes_back_by_its_keys_also_from_the_search(qtbot: QtBot, home: Home) -> None:
    delete_session(qtbot, home)
    delete_patient(qtbot, home)
    qtbot.waitUntil(lambda: codes(home) == ["P-0147"])
    assert home.toast.text == "P-0163 was deleted. The deletion becomes permanent in 30 days."
    home.page.search.setFocus()
    home.page.search.insert("0")  # what may be taken back here, too
    QTest.keyClick(home.page.search, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: codes(home) == ["P-0163", "P-0147"])
    qtbot.waitUntil(lambda: len(sessions(home)) == 2)  # the session stays deleted
    assert home.page.search.text() == "0"


def test_an_empty_library_begins_with_a_new_patient(qtbot: QtBot, home: Home) -> None:
    with qtbot.waitSignal(home.session_requested) as requested:
        home.page.empty.new_patient.click()
    assert requested.args == [None]


def write_visit(folder: Path) -> None:
    """A session folder of a walk of 3 s."""
    block = ImuBlock("LT-1", np.arange(300) / 100, np.zeros((300, 3)), np.tile([0.0, 0.0, 9.81], (300, 1)))
    recording = Recording("walk 1", RecordingKind.WALKING, "walk_1", {Site.LEFT_THIGH: block})
    write_session(Session((recording,), Patient(code="P-0200"), started="2026-11-02T10:00:00"), folder)


@pytest.mark.endurance
def test_a_session_folder_is_imported_for_a_patient(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    write_visit(tmp_path / "visit")
    home.page.empty.importing.clicked.emit()
    home.importing.read([tmp_path / "visit"])
    qtbot.waitUntil(lambda: home.current is home.importing.page)
    assert home.importing.page.code.text == "P-0200"
    assert home.bar.primary.text() == "Import for P-0200"
    QTest.keyClick(home.importing.page.code.line_edit, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: home.current is home.page and "P-0200" in codes(home))
    assert home.bar.primary.text() == "New session for P-0200"
    qtbot.waitUntil(lambda: [line.amount for line in sessions(home)] == ["1 recording"])


@pytest.mark.parametrize("is_done", [False, True])
def test_a_stopped_import_states_what_came_of_it_once_that_is_known(
    qtbot: QtBot,
    home: Home,
    controller: LibraryController,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    is_done: bool,
) -> None:
    write_visit(tmp_path / "visit")
    go_on = threading.Event()

    def held(opened: OpenedLibrary, session: Session, report: Callable[[float, str], None], code: str) -> object:
        assert go_on.wait(PATIENCE_S)
        return import_session(opened, session, (lambda _share, _what: None) if is_done else report, code)

    monkeypatch.setattr("app.home.importing.controller.import_session", held)
    home.importing.read([tmp_path / "visit"])
    qtbot.waitUntil(lambda: home.current is home.importing.page)
    home.importing.take_in()
    home.working.stop.click()
    assert "being stopped" in home.banner.text
    assert "added to the library" not in home.banner.text
    go_on.set()
    what = "finished before it could be stopped. The session is in" if is_done else "stopped. No session was added to"
    qtbot.waitUntil(lambda: what in home.banner.text)
    assert controller.state is not None
    library = controller.state.library.library
    patient = library.patients.find("P-0200")
    assert patient is not None
    assert len(library.sessions.list(patient.id)) == int(is_done)


@pytest.mark.endurance
@pytest.mark.skipif(os.name == "nt", reason="signals of this kind are not for Windows")
def test_stop_ends_a_reading_that_would_never_end(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    write_visit(tmp_path / "visit")
    read_foreign_session(tmp_path / "visit", lambda: None)
    process = the_reader().process
    assert process is not None
    os.kill(process.pid, signal.SIGSTOP)
    home.importing.read([tmp_path / "visit"])
    qtbot.wait(200)
    assert home.working.isVisible()
    assert process.poll() is None
    home.working.stop.click()
    assert home.page.isVisible()
    assert home.banner.text.startswith("Stopped.")
    qtbot.waitUntil(lambda: process.poll() is not None)

    def is_read() -> bool:
        if home.page.isVisible():  # what was stopped has not ended yet
            home.importing.read([tmp_path / "visit"])
        return home.importing.page.isVisible()

    qtbot.waitUntil(is_read)


def test_a_folder_that_is_no_session_is_refused_in_words(qtbot: QtBot, home: Home, tmp_path: Path) -> None:
    (tmp_path / "nothing").mkdir()
    home.importing.read([tmp_path / "nothing"])
    qtbot.waitUntil(home.banner.isVisible)
    assert "session.toml" in home.banner.text
    assert home.current is home.page


Start = Callable[[], Home]


@pytest.fixture
def start(qtbot: QtBot, controller: LibraryController, settings: Settings, folder: Path) -> Start:
    """Home as at the program's start, once the library is open."""

    def started() -> Home:
        home = Home(controller, settings)
        qtbot.addWidget(home)
        home.show()
        open_library(qtbot, controller, home, folder)
        return home

    return started


def leave_open(folder: Path, has_row: bool = True, states_session: bool = False) -> UUID:
    """Leave a walk of 4 s as a kill does, in the latest session; without a row the database did not answer."""
    data_key = KeySlots(folder / KEYS).open("hk", PASSPHRASE)
    with Library.open(folder, data_key) as library:
        library.log_in("hk")
        opened = OpenedLibrary(library, folder, data_key)
        line = library.sessions.list()[0]
        library.sessions.place(line.id, {Site.LEFT_THIGH: PlacedSensor("LT-1", SensorInfo())})
        recording_id = uuid7()
        reported = Recording("walk 3", RecordingKind.WALKING, "walk_3", {})
        if has_row:
            library.recordings.start(line.id, reported, False, recording_id)
        writer = JournalWriter.create(opened.recordings, recording_id, data_key, room=ANY_ROOM)
        header = writer.header
        journal = StoredJournal(header.recording_id, header.segment, header.wrapped_key)
        if has_row:
            library.recordings.add_journal(recording_id, journal)
        if states_session:
            writer.mark(Belonging(line.id, reported).text())
        block = ImuBlock("LT-1", np.arange(400) / 100, np.ones((400, 3)), np.ones((400, 3)))
        source = writer.source(SourceInfo("file", "1", sensors=("LT-1",)), layout_of(block))
        writer.samples(source, 0, block, waits=True)
        summary = writer.stop()
        with summary.path.open("r+b") as file:  # without its footer, as a kill leaves it
            file.truncate(summary.bytes - 40)
        return line.id


def test_what_was_being_recorded_is_recovered_and_marked(qtbot: QtBot, start: Start, folder: Path) -> None:
    session_id = leave_open(folder)
    home = start()
    qtbot.waitUntil(home.banner.isVisible)
    assert "of walk 3 was recovered" in home.banner.text
    qtbot.waitUntil(lambda: any(line.needs_look for line in sessions(home)))
    (marked,) = (line for line in sessions(home) if line.needs_look)
    assert (marked.id, marked.state) == (session_id, "include or exclude?")
    qtbot.waitUntil(lambda: [one.needs_look for one in lines(home)] == [True, False])


def test_a_recovered_walk_is_asked_for_at_every_start_until_it_is_decided(
    qtbot: QtBot, start: Start, controller: LibraryController, folder: Path
) -> None:
    """The library knows it, so a new program does: nothing of this is remembered in a window."""
    session_id = leave_open(folder)
    recover_all(folder)
    home = start()
    qtbot.waitUntil(home.banner.isVisible)
    asked = "walk 3 of P-0163 was recovered earlier and still awaits a decision."
    assert home.banner.text == f"{asked} Review the recording, then include or exclude it."
    qtbot.waitUntil(lambda: [one.needs_look for one in lines(home)] == [True, False])
    qtbot.waitUntil(lambda: [one.id for one in sessions(home) if one.needs_look] == [session_id])
    home.session_opened.emit(session_id)  # looking is not deciding
    home.patients.read()
    qtbot.waitUntil(lambda: any(one.needs_look for one in sessions(home)))
    with Library.open(folder, KeySlots(folder / KEYS).open("hk", PASSPHRASE)) as library:
        library.log_in("hk")
        (walk,) = library.recordings.undecided()
        library.recordings.decide(walk.recording, is_kept=True)
    home.patients.read()
    qtbot.waitUntil(lambda: not any_needs_look(home))
    with qtbot.waitSignal(controller.closed):
        controller.close()
    later = start()
    qtbot.waitUntil(lambda: len(sessions(later)) == 3)
    assert later.banner.isHidden()
    assert not any_needs_look(later)


def test_several_recovered_walks_are_asked_for_together(qtbot: QtBot, start: Start, folder: Path) -> None:
    leave_open(folder)
    leave_open(folder, has_row=False, states_session=True)
    recover_all(folder)
    home = start()
    qtbot.waitUntil(home.banner.isVisible)
    assert home.banner.text.startswith("2 walks were recovered earlier and still await a decision.")


def any_needs_look(home: Home) -> bool:
    return any(line.needs_look for line in sessions(home)) or any(line.needs_look for line in lines(home))


def recover_all(folder: Path) -> None:
    """As another program has done before: the command line, or this one when it was last started."""
    data_key = KeySlots(folder / KEYS).open("hk", PASSPHRASE)
    with Library.open(folder, data_key) as library:
        library.log_in("hk")
        opened = OpenedLibrary(library, folder, data_key)
        for one in find_interrupted(opened):
            (recover if one.stored is not None else adopt_home)(opened, one, lambda _share, _what: None)


def test_what_the_library_did_not_answer_for_goes_into_its_session_or_out(
    qtbot: QtBot, start: Start, controller: LibraryController, folder: Path, tmp_path: Path
) -> None:
    """One states of which session it is; of two others nobody knows, so their samples can be had as files."""
    leave_open(folder, has_row=False, states_session=True)
    leave_open(folder, has_row=False)
    leave_open(folder, has_row=False)
    home = start()
    qtbot.waitUntil(home.banner.isVisible)
    assert (
        "of walk 3 was recorded while the library did not respond. The recording is now in its session."
        in home.banner.text
    )
    qtbot.waitUntil(lambda: any(line.needs_look for line in sessions(home)))
    home.banner.dismiss.click()
    assert home.banner.text.startswith("2 recordings, 00:00 in total, are not assigned to a session.")
    assert home.banner.act.text() == "Export"
    home.recovering.export(tmp_path / "out")
    qtbot.waitUntil(lambda: "2 recordings were exported." in home.banner.text)
    assert len(list((tmp_path / "out").glob("*/LT-1.csv"))) == 2
    assert home.banner.act.isHidden()
    assert controller.state is not None
    left = list(controller.state.library.recordings.iterdir())
    home.banner.dismiss.click()
    looked_through: list[object] = []
    home.recovering.recovered.connect(lambda: looked_through.append(None))
    open_library(qtbot, controller, home, folder)
    qtbot.waitUntil(lambda: bool(looked_through))
    assert controller.state is not None
    assert len(controller.state.interrupted) == 2  # they are kept, but informed of no more
    assert home.banner.text.startswith("walk 3 of P-0163 was recovered earlier")
    home.banner.dismiss.click()
    assert home.banner.isHidden()
    assert set(left) <= set(controller.state.library.recordings.iterdir())


def test_nothing_is_left_for_whoever_comes_next(home: Home) -> None:
    home.clear()
    assert codes(home) == []
    assert sessions(home) == []
    assert home.page.panel.code.text() == ""


def test_light_or_dark_is_set_for_the_next_start_too(home: Home, settings: Settings) -> None:
    home.rail.below_pressed.emit("look")
    assert settings.scheme is Scheme.DARK


def test_the_passphrase_is_changed_with_the_old_one_only(qtbot: QtBot, home: Home, folder: Path) -> None:
    home.show_settings()
    page = home.settings.page
    new = "four other words here"
    for old, is_right in (("not this one", False), (PASSPHRASE, True)):
        for field, text in ((page.old, old), (page.new, new), (page.again, new)):
            field.set_text(text)
        QTest.mouseClick(page.change, Qt.MouseButton.LeftButton)
        qtbot.waitUntil(lambda: page.old.is_wrong or page.old.text == "")
        assert page.old.is_wrong is not is_right
    KeySlots(folder / KEYS).open("hk", new)


def test_a_new_recovery_key_ends_the_old_one(qtbot: QtBot, home: Home, folder: Path) -> None:
    home.show_settings()
    page = home.settings.page
    QTest.mouseClick(page.renew, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: bool(page.recovery_key))
    KeySlots(folder / KEYS).open_with_recovery_key(page.recovery_key)
    assert page.print.isVisible()


def test_a_backup_is_made_and_checked_and_its_folder_is_named_for_no_other_library(
    qtbot: QtBot, home: Home, controller: LibraryController, tmp_path: Path
) -> None:
    page, state = home.settings.page, controller.state
    assert state is not None
    (tmp_path / "disk").mkdir()
    home.settings.set_backup_folder(str(tmp_path / "disk"))
    qtbot.waitUntil(lambda: "disk" in page.backup_folder.text())
    page.backup_requested.emit()
    qtbot.waitUntil(lambda: "checked" in page.backup_stated.text())
    assert [one.name.startswith("gaitwright-backup-") for one in (tmp_path / "disk").iterdir()] == [True]
    home.settings.show_library(replace(state, library=replace(state.library, data_key=None)))
    assert page.backup_folder.text() == "No backup folder chosen yet."


def test_an_older_state_of_the_library_is_stated_and_an_administrator_may_accept_it(
    qtbot: QtBot, home: Home, controller: LibraryController, snapshot: SnapshotAssertion
) -> None:
    state, notice = controller.state, home.notices.rollback
    assert state is not None
    home.show_library(state)
    assert not notice.isVisible()
    stated = {}
    for role in (Role.CLINICIAN, Role.ADMINISTRATOR):
        home.show_library(replace(state, operator=replace(state.operator, role=role), rollback=Rollback(5, 9)))
        button = notice.findChildren(Button)[0]
        assert button.isVisible() is (role is Role.ADMINISTRATOR)
        stated[role.name] = notice.text
    assert stated == snapshot
    button.click()
    qtbot.waitUntil(lambda: not notice.isVisible())


def test_what_is_the_matter_with_a_library_is_stated_and_of_others_nothing(
    home: Home, controller: LibraryController, snapshot: SnapshotAssertion
) -> None:
    state = controller.state
    assert state is not None

    def stated(**changed: object) -> list[str]:
        home.show_library(replace(state, **changed))  # type: ignore[arg-type]  # of several types
        return [one.text for one in (home.banner, home.notices.away) if one.isVisible()]

    assert stated() == []
    assert {
        "its end is lost": stated(is_end_lost=True),
        "offline": stated(is_away=True),
        "brought": stated(brought_from_away=1),
        "still here": stated(still_away=Refusal("It is full.", "Ask.")),
    } == snapshot
    home.clear()
    assert not home.notices.away.isVisible()


@pytest.mark.endurance
def test_an_operator_is_removed_with_a_change_of_the_key_and_comes_back_with_a_new_passphrase(
    qtbot: QtBot, home: Home, controller: LibraryController, folder: Path
) -> None:
    home.show_settings()
    page = home.settings.page

    def add(passphrase: str) -> None:
        page.operators.code.set_text("ab")
        page.operators.name.set_text("A. Bauer")
        page.operators.first.set_text(passphrase)
        page.operators.add.click()

    def row() -> tuple[Button, str]:
        found = page.operators.rows.itemAt(0)
        widget = found.widget() if found is not None else None
        assert widget is not None
        button = widget.findChild(Button)
        assert button is not None
        return button, button.text()

    add("first words for now")
    qtbot.waitUntil(lambda: page.operators.rows.count() == 2)
    shutil.copy(folder / KEYS, folder.parent / "old.json")
    row()[0].click()
    assert (
        "Earlier backups keep their old key: anyone who has such a backup can still read it with the old passphrase"
    ) in page.operators.leaving_words.text()
    page.operators.keep.click()
    assert not page.operators.remove.isVisible()
    row()[0].click()
    page.operators.remove.click()
    assert not page.operators.isEnabled()
    qtbot.waitUntil(lambda: row()[1] == "Reactivate user")
    assert "has a new key" in page.operators.leaving_words.text()
    stolen = KeySlots(folder.parent / "old.json").open("ab", "first words for now")
    with pytest.raises(LibraryError):
        Library.open(folder, stolen)
    assert controller.state is not None
    assert controller.state.library.data_key == KeySlots(folder / KEYS).open("hk", PASSPHRASE)
    row()[0].click()
    assert page.operators.first.is_wrong
    add("other words for then")
    qtbot.waitUntil(lambda: row()[1] == "Remove user")
    assert KeySlots(folder / KEYS).open("ab", "other words for then") == controller.state.library.data_key


def test_an_operator_is_added_and_may_log_in(
    qtbot: QtBot, home: Home, controller: LibraryController, folder: Path
) -> None:
    page = home.settings.page
    page.operators.code.set_text("vi")
    page.operators.name.set_text("V. Iten")
    page.operators.first.set_text("first words for now")
    page.operators.role.setCurrentIndex(page.operators.role.findData("viewer"))
    page.operators.add.click()
    qtbot.waitUntil(lambda: page.operators.rows.count() == 2)
    controller.close()
    with qtbot.waitSignal(controller.opened) as reported:
        controller.open(lambda holder: holder.open(folder, "first words for now", "vi"))
    (state,) = reported.args or []
    assert state.operator.role is Role.VIEWER
    home.show_library(state)
    home.show_settings()
    assert not page.operators.isVisible()
    assert not page.backup_card.isVisible()
    assert page.access_card.isVisible()


def test_under_a_patients_code_stand_no_sessions_of_another_while_theirs_are_read(qtbot: QtBot, home: Home) -> None:
    page = home.page
    visited = next(line.id for line in lines(home) if line.code == "P-0163")
    page.patients.choose_line(visited)
    qtbot.waitUntil(lambda: len(sessions(home)) == 3)
    page.patients.choose_line(next(line.id for line in lines(home) if line.code == "P-0147"))
    assert sessions(home) == []
    assert not page.panel.none_yet.isVisible()
    qtbot.waitUntil(page.panel.none_yet.isVisible)


def closed_amid(folder: Path, name: str) -> UUID:
    """A walk of the latest session that ended with the program: nobody stated whether it is kept."""
    data_key = KeySlots(folder / KEYS).open("hk", PASSPHRASE)
    with Library.open(folder, data_key) as library:
        library.log_in("hk")
        line = library.sessions.list()[0]
        reported = Recording(name, RecordingKind.WALKING, name.replace(" ", "_"), {}, condition="Shoes")
        walk = library.recordings.start(line.id, reported, False, is_decided=False)
        library.recordings.add_journal(walk.id, StoredJournal(walk.id, 1, b"key"))
        library.recordings.close(walk.id, RecordingState.CLOSED, {1: ""})
        return line.id


def test_a_walk_that_ended_with_the_program_is_asked_about_at_the_next_start(
    qtbot: QtBot, start: Start, folder: Path
) -> None:
    session_id = closed_amid(folder, "walk 3")
    home = start()
    qtbot.waitUntil(home.banner.isVisible)
    asked = "The program was closed before A Shoes of P-0163 was included or excluded."
    assert (
        home.banner.text.replace("B Shoes", "A Shoes") == f"{asked} Review the recording, then include or exclude it."
    )
    qtbot.waitUntil(lambda: [one.id for one in sessions(home) if one.needs_look] == [session_id])
    (marked,) = (line for line in sessions(home) if line.needs_look)
    assert marked.state == "include or exclude?"
