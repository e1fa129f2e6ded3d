"""The window as a whole: the first start, logging in, the cover when nobody is there, folders, sizes."""

import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple
from uuid import UUID

import pytest
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QLabel, QLineEdit, QWidget
from pytestqt.qtbot import QtBot

from app import main_window
from app.home import session_screen
from app.home.home import Home
from app.home.login.controller import SHORTEST, Entry
from app.home.login.first_start_page import FirstStartPage
from app.home.login.log_in_page import LogInPage
from app.home.settings.settings_page import SettingsPage
from app.live_output.output import live_output
from app.main_window import MainWindow
from app.storage import keys
from app.storage.data_key import DataKey
from app.storage.database.ids import uuid7
from app.storage.journal.disk import Room
from app.storage.journal.payloads import Belonging
from app.storage.journal.writer import JournalWriter
from app.storage.keys import KeyRefusedError, KeySlots
from app.storage.layout import DATABASE_VARIABLE, KEYS, STATION, default_folder
from app.storage.library import Library
from app.storage.login_delay import LoginDelay
from app.storage.opened import OpenedLibrary
from app.storage.stored import LibraryError, Operator, Role
from app.system.progress import Report
from app.system.settings import Scheme, Settings
from app.theme.colours import DARK, LIGHT
from app.theme.current import current_theme, set_scale
from app.wizard.keys import Intent, KeyAction
from app.wording.translation import use_language
from core.session import Patient, Recording, RecordingKind, Session
from tests.app.room import is_cut
from tests.quick_library import CHEAP, PASSPHRASE, quick_library

SECRET_CODE = "P-0147"
ANY_ROOM = Room(start_bytes=0, kept_bytes=0)


@pytest.fixture(autouse=True)
def quick_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keys that the program derives cost next to nothing, as those of `quick_library`."""
    monkeypatch.setattr(KeySlots.__init__, "__defaults__", (CHEAP,))


@pytest.fixture(autouse=True)
def nothing_ahead(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is made before it is needed: the wizard and the settings would be, in every test."""
    monkeypatch.setattr(main_window, "MAKE_EVERY_MS", 3_600_000)


@pytest.fixture(scope="module")
def untouched(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A closed library of `hk`, with a patient."""
    folder = tmp_path_factory.mktemp("window")
    with quick_library(folder) as opened:
        opened.library.patients.create(Patient(code=SECRET_CODE, birth_year=1968))
    return folder


@pytest.fixture
def folder(untouched: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(untouched, tmp_path / "library"))


Open = Callable[[Path | None], MainWindow]


@pytest.fixture
def open_window(qtbot: QtBot, settings: Settings) -> Open:
    """Open a window with the library in a folder, or without any."""

    def end(window: MainWindow) -> None:
        window.close()
        window.finish()

    def open_it(library: Path | None) -> MainWindow:
        window = MainWindow(settings, library)
        window.resize(1280, 800)
        qtbot.addWidget(window, before_close_func=end)
        with qtbot.waitActive(window):
            window.show()
            window.activateWindow()
        return window

    return open_it


@pytest.fixture
def window(open_window: Open) -> MainWindow:
    """A window that knows of no library."""
    return open_window(None)


def logged_in(qtbot: QtBot, window: MainWindow) -> None:
    assert window.entry is not None
    page = window.entry.log_in
    qtbot.waitUntil(lambda: page.operator.count() == 1)
    QTest.keyClicks(page.passphrase.line_edit, PASSPHRASE)
    QTest.keyClick(page.passphrase.line_edit, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: window.home is not None and window.screens.currentWidget() is window.home)
    assert window.home is not None
    qtbot.waitUntil(lambda: window.home is not None and window.home.page.patients.line is not None)


class Desk(NamedTuple):
    """A window with an open library: home is in sight."""

    window: MainWindow
    home: Home
    entry: Entry


@pytest.fixture
def desk(qtbot: QtBot, open_window: Open, folder: Path) -> Desk:
    window = open_window(folder)
    logged_in(qtbot, window)
    assert window.home is not None
    assert window.entry is not None
    return Desk(window, window.home, window.entry)


def at_log_in(qtbot: QtBot, open_window: Open, folder: Path) -> tuple[MainWindow, LogInPage]:
    """A window that asks for the passphrase."""
    window = open_window(folder)
    assert window.entry is not None
    page = window.entry.log_in
    qtbot.waitUntil(lambda: page.operator.count() == 1)
    return window, page


def first_start(window: MainWindow) -> FirstStartPage:
    assert window.entry is not None
    return window.entry.first_start


def enter(page: LogInPage, passphrase: str = PASSPHRASE) -> None:
    page.passphrase.set_text(passphrase)
    QTest.keyClick(page.passphrase.line_edit, Qt.Key.Key_Return)


def words_in_sight(window: MainWindow) -> str:
    shown = [one for one in window.findChildren(QWidget) if one.isVisible()]
    words = [one.text() for one in shown if isinstance(one, QLabel | QAbstractButton | QLineEdit)]
    names = [f"{one.accessibleName()} {one.accessibleDescription()}" for one in shown]
    return " ".join([*words, *names])


def test_home_and_wizard_are_made_while_somebody_types_the_passphrase(
    qtbot: QtBot, open_window: Open, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(main_window, "MAKE_EVERY_MS", 1)
    window, page = at_log_in(qtbot, open_window, folder)
    QTest.keyClicks(page.passphrase.line_edit, PASSPHRASE[:5])
    typing, shown = QApplication.focusWidget(), window.screens.currentWidget()
    assert typing is page.passphrase.line_edit
    window.preparing.done.emit(None)
    qtbot.waitUntil(lambda: window.wizard is not None)
    assert window.home is not None
    assert window.screens.currentWidget() is shown
    assert QApplication.focusWidget() is typing


def test_without_a_library_the_two_ways_on_are_offered(window: MainWindow) -> None:
    assert window.screens.currentWidget() is window.session
    assert window.session.empty.open_folder.isVisible()
    assert not window.session.bar.back.isVisible()


def test_the_first_start_makes_a_library_and_shows_its_recovery_key_once(
    qtbot: QtBot, open_window: Open, tmp_path: Path
) -> None:
    window = open_window(tmp_path / "new")
    page = first_start(window)
    assert page.isVisible()
    for field, text in ((page.code, "hk"), (page.name, "H. Keller"), (page.passphrase, PASSPHRASE)):
        QTest.keyClicks(field.line_edit, text)
    QTest.keyClicks(page.again.line_edit, PASSPHRASE[:-1])
    QTest.mouseClick(page.make, Qt.MouseButton.LeftButton)
    assert page.again.is_wrong
    QTest.keyClicks(page.again.line_edit, PASSPHRASE[-1])
    QTest.mouseClick(page.make, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: page.typed.isVisible())
    key = page.recovery_key
    asked = "-".join(key.split("-")[-2:])
    assert "Last two groups" in page.typed.line_edit.accessibleName()
    for wrong in ("", key[:-1] + "?", asked[:-1], asked[:-1] + "?"):
        page.typed.set_text(wrong)
        QTest.keyClick(page.typed.line_edit, Qt.Key.Key_Return)
        assert page.typed.is_wrong
        assert window.home is None
        page.typed.set_wrong("")
    page.typed.set_text(asked.replace("-", " ").lower())
    QTest.keyClick(page.typed.line_edit, Qt.Key.Key_Return)
    assert window.screens.currentWidget() is window.home
    assert key not in " ".join(label.text() for label in page.findChildren(QLabel))
    slots = KeySlots(tmp_path / "new" / KEYS)
    assert slots.open_with_recovery_key(key)
    qtbot.waitUntil(lambda: slots.is_recovery_key_confirmed)


def test_a_recovery_key_that_was_never_typed_back_is_asked_for_until_it_is(
    qtbot: QtBot, open_window: Open, folder: Path
) -> None:
    slots = KeySlots(folder / KEYS)
    key = slots.renew_recovery_key(slots.open("hk", PASSPHRASE))
    for put_off in (True, False):
        window, log_in = at_log_in(qtbot, open_window, folder)
        page = first_start(window)
        enter(log_in)
        qtbot.waitUntil(page.later.isVisible)
        assert "It is the only way to open the library if the passphrase is forgotten" in words_in_sight(window)
        assert key not in words_in_sight(window)
        if put_off:
            page.later.click()
            assert window.screens.currentWidget() is window.home
            window.controller.close()
            window.close()
            continue
        page.typed.set_text("-".join(key.split("-")[-2:]))  # which is not enough where it is not shown
        page.go.click()
        qtbot.waitUntil(lambda page=page: page.typed.is_wrong)  # type: ignore[misc]  # pytest-qt's types
        page.typed.set_text(key)
        page.go.click()
        qtbot.waitUntil(lambda window=window: window.screens.currentWidget() is window.home)  # type: ignore[misc]  # pytest-qt's types
    assert slots.is_recovery_key_confirmed


@pytest.mark.usefixtures("no_visits")
def test_who_asks_for_the_demonstration_while_a_library_opens_gets_it_and_no_question_of_that_library(
    qtbot: QtBot, open_window: Open, folder: Path
) -> None:
    slots = KeySlots(folder / KEYS)
    slots.renew_recovery_key(slots.open("hk", PASSPHRASE))  # which nobody has typed back
    window = open_window(folder)
    assert window.entry is not None
    log_in = window.entry.log_in
    shown: list[QWidget] = []
    qtbot.waitUntil(lambda: log_in.operator.count() == 1)
    window.entry.shown.connect(shown.append)
    enter(log_in)
    window.open_demonstration()
    qtbot.waitUntil(lambda: window.home is not None and window.screens.currentWidget() is window.home)
    assert window.controller.state is not None
    assert window.controller.state.is_demonstration
    assert shown == [window.entry.waiting]


@pytest.fixture
def no_visits(monkeypatch: pytest.MonkeyPatch) -> None:
    """A demonstration that nobody waits for."""
    monkeypatch.setattr("app.demonstration.patients.simulated_patients", lambda _now: ())


def in_demonstration(qtbot: QtBot, window: MainWindow) -> None:
    """Open it from home, as by its button."""
    window.open_demonstration()
    qtbot.waitUntil(lambda: window.screens.currentWidget() is window.home and window.controller.state is not None)
    assert window.controller.state is not None
    assert window.controller.state.is_demonstration


@pytest.mark.usefixtures("no_visits")
def test_who_leaves_the_demonstration_is_in_the_own_library_without_a_passphrase(qtbot: QtBot, desk: Desk) -> None:
    window, home, entry = desk
    in_demonstration(qtbot, window)
    shown: list[QWidget] = []
    entry.shown.connect(shown.append)
    home.own_library_requested.emit()
    assert home.state is None  # nothing of the demonstration is left in sight
    qtbot.waitUntil(lambda: home.page.patients.line is not None)
    assert window.screens.currentWidget() is home
    assert SECRET_CODE in words_in_sight(window)
    assert shown == [entry.waiting]  # and no log-in


@pytest.mark.usefixtures("no_visits")
def test_five_minutes_without_anybody_log_out_behind_the_demonstration(qtbot: QtBot, desk: Desk) -> None:
    window, home, entry = desk
    in_demonstration(qtbot, window)
    window.lock()  # as `idle` asks for it
    qtbot.waitUntil(lambda: window.controller.kept is None)
    assert window.screens.currentWidget() is home  # simulated patients are shown on
    home.own_library_requested.emit()
    assert window.screens.currentWidget() is entry.log_in


def test_a_demonstration_that_does_not_open_leaves_the_library_open_and_is_reported(
    qtbot: QtBot, desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_folder: Path) -> None:
        raise LibraryError("There is no room", "Make some")

    monkeypatch.setattr("app.workers.library_holder.demonstration", refuse)
    window = desk.window
    with qtbot.waitSignal(window.controller.opened):
        window.open_demonstration()
    assert window.screens.currentWidget() is desk.home
    assert "There is no room." in words_in_sight(window)


def test_another_language_opens_the_window_again_where_it_was_and_without_a_passphrase(
    qtbot: QtBot, desk: Desk, open_window: Open, folder: Path
) -> None:
    window = desk.window
    window.close()
    kept = window.finish(must_keep=True)
    assert kept is not None
    following = open_window(folder)
    following.go_on(kept)
    qtbot.waitUntil(lambda: following.controller.state is not None)
    assert following.home is not None
    assert following.screens.currentWidget() is following.home
    assert isinstance(following.home.current, SettingsPage)
    following.idle.lock_now()  # which asks for the passphrase as ever
    assert following.is_covered
    qtbot.waitUntil(lambda: not _key_of(following))


def test_whoever_changes_the_language_stays_logged_in(
    qtbot: QtBot, qapp: QApplication, folder: Path, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(main_window, "default_folder", lambda: folder)
    seen: list[str] = []

    def window() -> MainWindow:
        (shown,) = [one for one in qapp.topLevelWidgets() if isinstance(one, MainWindow) and one.isVisible()]
        return shown

    def first() -> int:
        logged_in(qtbot, window())
        settings.language = "de"
        return main_window.IN_ANOTHER_LANGUAGE

    def second() -> int:
        qtbot.waitUntil(lambda: window().controller.state is not None)
        seen.append(words_in_sight(window()))
        return 0

    turns = iter((first, second))
    monkeypatch.setattr(QApplication, "exec", lambda *_: next(turns)())
    try:
        code, kept = main_window.show_window(qapp, settings, [], None)
        assert (code, kept is not None) == (main_window.IN_ANOTHER_LANGUAGE, True)
        assert main_window.show_window(qapp, settings, [], kept) == (0, None)
    finally:
        use_language("en")
    assert "Einstellungen" in seen[0]


def _key_of(window: MainWindow) -> DataKey | None:
    assert window.controller.state is not None
    return window.controller.state.library.data_key


def renewed(qtbot: QtBot, open_window: Open, folder: Path) -> tuple[MainWindow, KeySlots]:
    """A window that shows a recovery key made again, since the one before was never typed back."""
    slots = KeySlots(folder / KEYS)
    slots.renew_recovery_key(slots.open("hk", PASSPHRASE))
    window, log_in = at_log_in(qtbot, open_window, folder)
    page = first_start(window)
    enter(log_in)
    qtbot.waitUntil(page.renew.isVisible)
    page.renew.click()
    qtbot.waitUntil(lambda: bool(page.recovery_key))
    return window, slots


def test_a_recovery_key_that_is_lost_is_made_again(qtbot: QtBot, open_window: Open, folder: Path) -> None:
    window, slots = renewed(qtbot, open_window, folder)
    page = first_start(window)
    assert page.print.isVisible()
    page.typed.set_text("-".join(page.recovery_key.split("-")[-2:]))
    page.go.click()
    assert window.screens.currentWidget() is window.home
    qtbot.waitUntil(lambda: slots.is_recovery_key_confirmed)


def test_a_new_recovery_key_is_covered_by_the_lock_and_not_shown_again(
    qtbot: QtBot, open_window: Open, folder: Path
) -> None:
    window, slots = renewed(qtbot, open_window, folder)
    assert window.entry is not None
    page, log_in = window.entry.first_start, window.entry.log_in
    key = page.recovery_key
    window.idle.lock_now()
    assert window.is_covered
    assert log_in.isVisible()
    assert key[:4] not in words_in_sight(window)
    enter(log_in)
    qtbot.waitUntil(lambda: not window.is_covered)
    assert page.recovery_key == ""
    assert key[:4] not in words_in_sight(window)
    assert page.renew.isVisible()  # or the old one is typed from its sheet
    page.typed.set_text(key)
    page.go.click()
    qtbot.waitUntil(lambda: window.screens.currentWidget() is window.home)
    assert slots.is_recovery_key_confirmed


def test_who_was_given_a_passphrase_chooses_an_own_one_before_anything_is_shown(
    qtbot: QtBot, open_window: Open, folder: Path
) -> None:
    slots, own = KeySlots(folder / KEYS), "seven other quiet words"
    data_key = slots.open("hk", PASSPHRASE)
    slots.add(data_key, "ab", "the first one she got", is_given=True)
    with Library.open(folder, data_key) as library:
        library.log_in("hk")
        library.operators.add(Operator("ab", "A. Berg", Role.CLINICIAN))
    window = open_window(folder)
    assert window.entry is not None
    page = window.entry.log_in
    qtbot.waitUntil(lambda: page.operator.count() == 2)
    page.operator.setCurrentIndex(page.operator.findData("ab"))
    page.passphrase.set_text("the first one she got")
    page.go.click()
    qtbot.waitUntil(page.new_passphrase.isVisible)
    assert not page.passphrase.isVisible()
    for key in (Qt.Key.Key_O, Qt.Key.Key_D, Qt.Key.Key_Escape):
        QTest.keyClick(window, key, Qt.KeyboardModifier.ControlModifier)
    window.idle.lock_now()  # which asks for the passphrase, and then for an own one again
    assert page.passphrase.isVisible()
    page.passphrase.set_text("the first one she got")
    page.go.click()
    qtbot.waitUntil(page.new_passphrase.isVisible)
    for passphrase in ("the first one she got", own):
        assert window.screens.currentWidget() is page
        page.new_passphrase.set_wrong("")
        page.new_passphrase.set_text(passphrase)
        page.again.set_text(passphrase)
        page.go.click()
        qtbot.waitUntil(lambda: page.new_passphrase.is_wrong or window.screens.currentWidget() is window.home)
        assert page.new_passphrase.is_wrong is (passphrase != own)
    assert page.new_passphrase.text == ""
    assert not slots.is_given("ab")
    slots.open("ab", own)
    with pytest.raises(KeyRefusedError):
        slots.open("ab", "the first one she got")


def test_the_passphrase_opens_home_and_nothing_of_it_is_kept(desk: Desk) -> None:
    _, home, entry = desk
    assert entry.log_in.passphrase.text == ""
    assert QApplication.focusWidget() is home.page.search


def test_escape_leads_back_to_the_patients_from_a_search_the_settings_and_the_help(desk: Desk) -> None:
    window, home, _ = desk
    QTest.keyClicks(home.page.search, "nobody")
    QTest.keyClick(home.page.search, Qt.Key.Key_Escape)
    assert home.page.search.text() == ""
    home.show_settings()
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert home.current is home.page
    QTest.keyClick(home.page.search, Qt.Key.Key_F1)
    assert window.screens.currentWidget() is not home
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert window.screens.currentWidget() is home


def test_a_session_is_begun_in_the_wizard_and_left_for_the_settings_and_for_home(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    window, home, _ = desk
    QTest.keyClick(home.page.search, Qt.Key.Key_Return)
    wizard = window.wizard
    assert wizard is not None
    assert window.screens.currentWidget() is wizard
    visit = wizard.visit
    assert visit is not None
    assert visit.patient.details.code == SECRET_CODE
    wizard.settings_required.emit()
    assert window.screens.currentWidget() is home
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert window.screens.currentWidget() is wizard
    assert wizard.visit is visit
    received: list[Intent] = []
    with monkeypatch.context() as patched:
        patched.setattr(wizard, "act_on", received.append)
        QTest.keyClick(window, Qt.Key.Key_Escape)
    assert received == [Intent(KeyAction.LEAVE)]  # which the step in sight is asked
    wizard.leave()
    assert window.screens.currentWidget() is home


@pytest.mark.endurance
def test_after_three_wrong_passphrases_the_next_try_waits_and_states_so(
    qtbot: QtBot, open_window: Open, folder: Path
) -> None:
    _, page = at_log_in(qtbot, open_window, folder)
    for _ in range(3):
        enter(page, "not this one")
        qtbot.waitUntil(lambda: page.passphrase.is_wrong)
        page.passphrase.set_wrong("")
    assert page.go.text() == "Next try in 2 s"
    assert not page.go.isEnabled()
    qtbot.waitUntil(page.go.isEnabled)


def test_the_wait_after_wrong_passphrases_outlives_the_program(qtbot: QtBot, open_window: Open, folder: Path) -> None:
    delay = LoginDelay(folder, time.monotonic)
    for _ in range(6):
        with suppress(KeyRefusedError), delay.trying("hk"):
            raise KeyRefusedError(
                "This passphrase does not open the library", "Enter the passphrase again, or use the recovery key"
            )
    window = open_window(folder)
    assert window.entry is not None
    page = window.entry.log_in
    qtbot.waitUntil(lambda: page.passphrase.is_wrong)
    assert page.go.text() == "Next try in 16 s"
    assert not page.go.isEnabled()
    page.use_recovery.click()
    assert page.go.isEnabled()


def test_who_leaves_the_desk_locks_the_library_at_once(desk: Desk) -> None:
    window, home, _ = desk
    (row,) = [one for one in home.rail.below if one.accessibleName() == "Lock"]
    row.click()
    assert window.is_covered
    assert window.idle.is_locked
    assert "Locked by hk" in words_in_sight(window)
    assert SECRET_CODE not in words_in_sight(window)


def test_five_minutes_without_anybody_cover_the_library(qtbot: QtBot, desk: Desk) -> None:
    window, _, entry = desk
    assert SECRET_CODE in words_in_sight(window)
    window.lock()
    assert window.is_covered
    assert SECRET_CODE not in words_in_sight(window)
    assert "Locked after five minutes without activity" in words_in_sight(window)
    for key in (Qt.Key.Key_O, Qt.Key.Key_D):
        QTest.keyClick(window, key, Qt.KeyboardModifier.ControlModifier)
    assert window.is_covered
    page = entry.log_in
    assert page.isVisible()
    enter(page, "not this one")
    qtbot.waitUntil(lambda: page.passphrase.is_wrong)
    assert window.is_covered
    enter(page)
    qtbot.waitUntil(lambda: not window.is_covered)
    assert SECRET_CODE in words_in_sight(window)


def test_the_lock_leaves_no_question_about_a_patient_in_sight_and_states_that_a_recording_goes_on(
    qtbot: QtBot, desk: Desk
) -> None:
    window, home, entry = desk
    home.page.panel.delete_patient.trigger()
    qtbot.waitUntil(lambda: home.deleting.dialog is not None)
    window.lock()
    assert home.deleting.dialog is None
    assert SECRET_CODE not in words_in_sight(window)
    entry.cover("hk", is_recording=True)
    assert "Recording continues" in words_in_sight(window)
    assert not entry.log_in.leave.isVisible()
    entry.show_recording(False)
    assert "Recording continues" not in words_in_sight(window)


def test_activity_puts_the_cover_off(open_window: Open, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    window = open_window(folder)
    noted: list[None] = []
    monkeypatch.setattr(window.idle, "note_activity", lambda: noted.append(None))
    handle = window.windowHandle()
    assert handle is not None
    QTest.keyClick(handle, Qt.Key.Key_A)  # as the desktop hands it over
    assert noted


def test_another_operator_leaves_nothing_behind(qtbot: QtBot, desk: Desk) -> None:
    window, home, entry = desk
    window.lock()
    with qtbot.waitSignal(window.controller.closed):
        QTest.mouseClick(entry.log_in.leave, Qt.MouseButton.LeftButton)
    assert not window.is_covered
    assert len(home.page.patients.lines) == 0
    logged_in(qtbot, window)


def test_a_folder_is_opened_without_any_library_and_left_for_the_log_in(
    qtbot: QtBot, open_window: Open, folder: Path, tmp_path: Path
) -> None:
    window = open_window(folder)
    window.open_folder(tmp_path)
    qtbot.waitUntil(window.session.banner.isVisible)
    assert window.screens.currentWidget() is window.session
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert window.entry is not None
    assert window.screens.currentWidget() is window.entry.log_in


def dropped(path: Path) -> QDropEvent:
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path))])
    event = QDropEvent(
        QPointF(50, 50),
        Qt.DropAction.CopyAction,
        data,
        Qt.MouseButton.LeftButton,
        Qt.KeyboardModifier.NoModifier,
    )
    event.data_kept_alive = data  # type: ignore[attr-defined]  # Qt does not own it
    return event


def test_a_dropped_folder_is_opened_also_by_its_toml(
    monkeypatch: pytest.MonkeyPatch, window: MainWindow, tmp_path: Path
) -> None:
    asked: list[Path] = []
    monkeypatch.setattr(window.session, "open_folder", asked.append)
    (tmp_path / "session.toml").touch()
    window.dropEvent(dropped(tmp_path))
    window.dropEvent(dropped(tmp_path / "session.toml"))
    assert asked == [tmp_path, tmp_path]
    assert not window.session.banner.isVisible()


def test_a_dropped_file_is_refused_in_words(window: MainWindow, tmp_path: Path) -> None:
    (tmp_path / "left_thigh.csv").touch()
    window.dropEvent(dropped(tmp_path / "left_thigh.csv"))
    assert "Drop the folder" in window.session.banner.text
    assert not window.session.is_working


def test_escape_stops_an_analysis(qtbot: QtBot, window: MainWindow, monkeypatch: pytest.MonkeyPatch) -> None:
    def work(report: Report) -> None:
        while True:
            report(0.4, "left_knee")

    monkeypatch.setattr(session_screen, "opening_folder", lambda _folder: work)
    window.open_folder(Path("visit"))
    qtbot.waitUntil(lambda: window.session.working.progress[0] > 0)
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert not window.session.is_working
    assert window.session.pages.currentWidget() is window.session.empty


def test_keys_change_the_size_of_everything_and_it_is_kept(window: MainWindow, settings: Settings) -> None:
    for _ in range(9):
        QTest.keyClick(window, Qt.Key.Key_Plus, Qt.KeyboardModifier.ControlModifier)
    assert current_theme().scale == settings.scale == 2.0
    QTest.keyClick(window, Qt.Key.Key_0, Qt.KeyboardModifier.ControlModifier)
    assert current_theme().scale == settings.scale == 1.0
    for _ in range(4):
        QTest.keyClick(window, Qt.Key.Key_Minus, Qt.KeyboardModifier.ControlModifier)
    assert current_theme().scale == settings.scale == 0.8


def test_light_and_dark_follow_what_is_set(window: MainWindow, settings: Settings) -> None:
    settings.scheme = Scheme.DARK
    assert current_theme().colours is DARK
    settings.scheme = Scheme.LIGHT
    assert current_theme().colours is LIGHT


def test_the_window_states_what_it_is_for(open_window: Open) -> None:
    assert open_window(None).windowTitle() == "Gaitwright – Research use. Not a medical device."


def test_the_language_is_kept_and_only_another_one_is_reported(qtbot: QtBot, settings: Settings) -> None:
    assert settings.language == "en"
    with qtbot.assertNotEmitted(settings.language_changed):
        settings.language = "en"
    with qtbot.waitSignal(settings.language_changed):
        settings.language = "de"
    assert settings.language == "de"
    settings.language = "fr"
    assert settings.language == "en", "there is no catalogue of it"


def test_a_language_chosen_in_the_settings_is_set(desk: Desk, settings: Settings) -> None:
    window, home, _ = desk
    home.show_settings()
    (page,) = window.findChildren(SettingsPage)
    assert page.language.choice == "en"
    page.language.segments[1].click()
    assert settings.language == "de"


@pytest.mark.parametrize("language", ["en", "pseudo"])
@pytest.mark.parametrize(
    ("size", "scale"), [((1280, 800), 1.0), ((1280, 800), 2.0), ((800, 560), 1.0), ((800, 560), 0.8)]
)
@pytest.mark.endurance
def test_every_word_fits(
    qtbot: QtBot,
    qapp: QApplication,
    open_window: Open,
    folder: Path,
    language: str,
    size: tuple[int, int],
    scale: float,
) -> None:
    use_language(language)
    try:
        window = open_window(folder)
        logged_in(qtbot, window)
        set_scale(scale)
        window.resize(*size)
        assert window.entry is not None
        home, entry = window.home, window.entry
        assert home is not None
        entry.log_in.show_operators(("hk", "vi"), ("hk",), "vi", can_remember=True)
        entry.log_in.refuse(
            "This passphrase does not open the library. Enter the passphrase again, or use the recovery key.", 5.0
        )
        entry.first_start.make.click()
        showings: list[tuple[str, Callable[[], object]]] = [
            ("home", lambda: window._show(home)),
            ("settings", home.show_settings),
            ("log in", lambda: window._show(entry.log_in)),
            ("recovery", entry.log_in.use_recovery.click),
            ("first start", lambda: window._show(entry.first_start)),
            ("recovery key", lambda: entry.first_start.show_recovery_key("-".join(["7K3M"] * 8 + ["X"]))),
        ]
        for name, show in showings:
            show()
            for _ in range(4):  # what wraps settles its height in a second round
                qapp.processEvents()
            shown = [widget for widget in window.findChildren(QWidget) if widget.isVisible()]
            cut = [(name, type(w).__name__, getattr(w, "text", str)()) for w in shown if is_cut(w)]
            assert cut == []
            takers = [w for w in shown if w.focusPolicy() & Qt.FocusPolicy.TabFocus and w.isEnabled()]
            assert takers
            assert [(name, w) for w in takers if not w.accessibleName()] == []
    finally:
        use_language("en")


def test_what_the_window_may_not_import_is_the_same_there() -> None:
    assert SHORTEST == keys.MIN_PASSPHRASE


def test_the_window_waits_for_no_slow_import() -> None:
    slow = ("numpy", "scipy", "pyqtgraph", "rerun", "sqlalchemy", "cryptography", "keyring", "PySide6.QtPrintSupport")
    check = f"import sys, app.main_window; print([m for m in {slow} if m in sys.modules])"
    stated = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True, check=True)
    assert stated.stdout.strip() == "[]"


@pytest.mark.endurance
def test_a_library_that_was_here_and_is_missing_is_not_made_again(
    qtbot: QtBot, open_window: Open, settings: Settings, folder: Path
) -> None:
    """It opens by itself when it is back; a new one is made only by whoever asks for that."""
    settings.latest_library = str(folder)
    elsewhere = folder.with_name("renamed")
    folder.rename(elsewhere)
    window = open_window(folder)
    entry = window.entry
    assert entry is not None
    page = entry.first_start
    assert window.screens.currentWidget() is page
    reported = "Connect its disk, or put its folder back. It then opens automatically."
    assert page.missing_lead.text() == f"It was in {folder} and is no longer there. {reported}"
    page.show_missing(str(folder), 2)
    assert "2 recordings stay on this computer until their library is back." in page.missing_lead.text()
    assert page.look_again.isVisible()
    assert not page.make.isVisible()
    assert page.look_again.hasFocus()
    page.look_again.click()
    assert page.banner.text == "The library is still missing. Connect its disk, or put its folder back."
    assert not folder.exists()
    page.make_another.click()
    assert page.make.isVisible()
    entry.begin()
    assert not page.make.isVisible()
    elsewhere.rename(folder)
    qtbot.waitUntil(lambda: window.screens.currentWidget() is entry.log_in)


def test_where_no_library_was_the_first_start_offers_one(open_window: Open, folder: Path, tmp_path: Path) -> None:
    page = first_start(open_window(tmp_path / "none"))
    assert page.make.isVisible()
    assert not page.look_again.isVisible()


@pytest.mark.endurance
def test_a_library_that_goes_is_stated_at_home_and_so_is_its_return(
    qtbot: QtBot, desk: Desk, settings: Settings, folder: Path
) -> None:
    window, home, entry = desk
    assert settings.latest_library == str(folder)
    elsewhere = folder.with_name("renamed")
    folder.rename(elsewhere)
    qtbot.waitUntil(lambda: home.banner.text.startswith(f"The library is no longer in {folder}."))
    window.lock()
    # home may have been refused its list before the library was missed
    qtbot.waitUntil(lambda: entry.log_in.banner.text == home.banner.text)
    elsewhere.rename(folder)
    qtbot.waitUntil(lambda: entry.log_in.banner.text.startswith("The library is available again."))
    assert entry.log_in.banner.text == home.banner.text


@pytest.fixture
def data_elsewhere(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What is kept on this computer is kept in the test's folder."""
    monkeypatch.setattr("app.storage.root.platformdirs.user_data_path", lambda *_, **__: tmp_path / "data")


def with_session(window: MainWindow) -> tuple[OpenedLibrary, Library, UUID]:
    """The library of a window, with a session of its patient."""
    state = window.controller.state
    assert state is not None
    library = state.library.library
    return state.library, library, library.sessions.create(library.patients.search()[0].id, Session(())).id


@pytest.mark.usefixtures("data_elsewhere")
@pytest.mark.endurance
def test_what_a_visit_that_was_left_recorded_while_it_was_gone_is_in_its_session(
    qtbot: QtBot, desk: Desk, folder: Path
) -> None:
    window, home, _ = desk
    opened, library, session_id = with_session(window)
    elsewhere = folder.with_name("renamed")
    with qtbot.waitSignal(window.controller.gone):
        folder.rename(elsewhere)
    reported = Recording("walk 1", RecordingKind.WALKING, "walk_1", {})
    writer = JournalWriter.create(opened.recordings, uuid7(), opened.data_key, room=ANY_ROOM, shelter=opened.shelter)
    writer.mark(Belonging(session_id, reported).text())
    writer.stop()
    with qtbot.waitSignal(home.recovering.recovered):
        elsewhere.rename(folder)
    assert home.banner.text == "The library is available again. 1 recording made meanwhile was added."
    home.banner.dismiss.click()
    assert home.banner.isHidden()
    assert [one.details.name for one in library.sessions.get(session_id).recordings] == ["walk 1"]


@pytest.mark.usefixtures("data_elsewhere")
@pytest.mark.endurance
def test_what_comes_home_under_the_cover_is_in_its_session_after_the_passphrase(
    qtbot: QtBot, desk: Desk, folder: Path
) -> None:
    """Its file comes home without the key; what it holds nobody can read until the key is there."""
    window, home, entry = desk
    opened, library, session_id = with_session(window)
    elsewhere, data_key, page = folder.with_name("renamed"), bytes(opened.data_key or b""), entry.log_in
    window.lock()
    qtbot.waitUntil(lambda: not opened.data_key)
    for name in ("walk 1", "walk 2"):  # a disk that comes and goes
        with qtbot.waitSignal(window.controller.gone):
            folder.rename(elsewhere)
        reported = Recording(name, RecordingKind.WALKING, name.replace(" ", "_"), {})
        with JournalWriter.create(
            opened.recordings, uuid7(), data_key, room=ANY_ROOM, shelter=opened.shelter
        ) as writer:
            writer.mark(Belonging(session_id, reported).text())
        with qtbot.waitSignal(window.controller.back):
            elsewhere.rename(folder)
        assert page.banner.text == "The library is available again. 1 recording made meanwhile was added."
    assert len(list(opened.recordings.glob("*.journal"))) == 2
    assert not opened.data_key
    with qtbot.waitSignal(home.recovering.recovered):
        enter(page)
    assert not window.is_covered
    assert home.banner.text == "The library is available again. 1 recording made meanwhile was added."
    assert sorted(one.details.name for one in library.sessions.get(session_id).recordings) == ["walk 1", "walk 2"]


def test_where_the_environment_names_no_server_that_answers_it_is_stated_and_tried_again(
    qtbot: QtBot, open_window: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(DATABASE_VARIABLE, "nowhere")
    window = open_window(tmp_path / "clinic")
    assert window.entry is not None
    page = window.entry.join
    qtbot.waitUntil(page.isVisible)
    assert "This is not the address of a PostgreSQL server" in page.lead.text()
    page.again.click()
    assert window.entry.waiting.isVisible()
    qtbot.waitUntil(page.isVisible)
    assert not (tmp_path / "clinic").exists()


def test_the_environment_leads_to_a_folder_of_its_own_unless_the_own_one_is_a_station(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.storage.layout.platformdirs.user_data_path", lambda *_, **__: tmp_path)
    assert default_folder() == tmp_path / "library"
    monkeypatch.setenv(DATABASE_VARIABLE, "postgresql://station@server/clinic")
    assert default_folder() == tmp_path / "clinic"
    (tmp_path / "library").mkdir()
    (tmp_path / "library" / STATION).touch()
    assert default_folder() == tmp_path / "library"


def test_the_live_output_follows_the_settings_and_ends_with_the_window(open_window: Open, settings: Settings) -> None:
    window = open_window(None)
    assert not live_output.is_on
    with socket.create_server(("127.0.0.1", 0)) as free:
        settings.live_port = free.getsockname()[1]
    settings.has_live_websocket = True
    assert live_output.port == settings.live_port
    window.close()
    assert not live_output.is_on
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", settings.live_port))
