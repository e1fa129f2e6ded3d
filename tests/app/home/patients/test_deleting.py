"""A patient is deleted by somebody who was given what goes, is missed at other stations with a word, and comes back."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime, timedelta
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.storage.library import Library
from app.storage.patients import Patients
from app.storage.stored import Operator, PlacedSensor, Role, ServerSilentError
from app.wording.dates import date
from core.body import Site
from core.samples import SensorInfo
from core.session import Recording, RecordingKind, Session
from tests.app.home.home_library import PASSPHRASE, delete_patient, deletion_dialog
from tests.app.home.test_home import codes, restores, sessions


@contextmanager
def another_operator(folder: Path) -> Iterator[Library]:
    """The same library at another computer, where `ab` works."""
    with Library.open(folder, KeySlots(folder / KEYS).open("hk", PASSPHRASE)) as library:
        library.log_in("hk")
        if all(one.code != "ab" for one in library.operators.list()):
            library.operators.add(Operator("ab", "A. Berg", Role.CLINICIAN))
        library.log_in("ab")
        yield library


def test_before_a_patient_is_deleted_it_is_stated_what_goes_and_until_when_it_can_be_restored(
    qtbot: QtBot, home: Home
) -> None:
    dialog = deletion_dialog(qtbot, home)
    assert dialog.windowTitle() == "Delete patient P-0163?"
    assert dialog.goes.text() == "This also deletes 3 sessions and 0 recordings."
    day = date((datetime.now().astimezone() + timedelta(days=30)).date())
    assert f"restore the data in Settings until {day}" in dialog.until.text()
    assert "Earlier backups keep the data longer." in dialog.until.text()
    assert dialog.others.isHidden()  # nobody else was here
    QTest.keyClick(dialog, Qt.Key.Key_Return)
    QTest.keyClick(dialog, Qt.Key.Key_Escape)
    assert home.deleting.dialog is None
    home.patients.read()
    assert codes(home) == ["P-0163", "P-0147"]


def test_a_patient_whom_another_opened_today_is_deleted_with_a_warning_and_not_unseen(
    qtbot: QtBot, home: Home, folder: Path
) -> None:
    qtbot.waitUntil(lambda: len(sessions(home)) == 3)
    visits = [line.id for line in sessions(home)]
    with another_operator(folder) as elsewhere:
        elsewhere.sessions.view(visits[0])
        dialog = deletion_dialog(qtbot, home)
        assert dialog.others.text.startswith("Opened by another user: ab, today ")
        elsewhere.sessions.create(elsewhere.sessions.get(visits[0]).patient_id, Session(()))
        with qtbot.waitSignal(home.deleting.refused) as reported:
            dialog.delete.click()
        assert reported.args is not None
        assert reported.args[0] == "Someone else has changed this in the meantime."
    assert codes(home) == ["P-0163", "P-0147"]


def test_a_patient_who_is_being_recorded_is_deleted_with_a_warning(qtbot: QtBot, home: Home, folder: Path) -> None:
    qtbot.waitUntil(lambda: len(sessions(home)) == 3)
    with another_operator(folder) as elsewhere:
        visit = sessions(home)[0].id
        elsewhere.sessions.place(visit, {Site.LEFT_THIGH: PlacedSensor("A", SensorInfo())})
        elsewhere.recordings.start(visit, Recording("walk 1", RecordingKind.WALKING, "walk_1", {}), is_simulated=False)
    dialog = deletion_dialog(qtbot, home)
    assert dialog.goes.text() == "This also deletes 3 sessions and 1 recording."
    assert dialog.others.text == (
        "A recording of this patient is running or was not stopped. Ask the other users before you delete."
    )
    dialog.reject()


def test_a_patient_in_sight_whom_another_deletes_is_missed_with_a_word(qtbot: QtBot, home: Home, folder: Path) -> None:
    qtbot.waitUntil(lambda: len(sessions(home)) == 3)
    with another_operator(folder) as elsewhere:
        (patient,) = elsewhere.patients.search("0163")
        elsewhere.patients.delete(patient)
    with qtbot.waitSignal(home.patients.refused) as reported:
        home.patients.read()  # as the watch has it done
    assert reported.args == [
        "At another workstation, ab deleted P-0163.",
        "To continue, restore the deleted data in Settings within 30 days.",
    ]
    assert codes(home) == ["P-0147"]
    with qtbot.assertNotEmitted(home.patients.refused):
        home.patients.read()
        home.show_settings()
        qtbot.waitUntil(lambda: len(restores(home)) == 1)
    (restore,) = restores(home).values()
    assert restore.accessibleDescription().startswith("Deleted by: ab, today ")


def test_a_viewer_is_refused_before_anything_is_asked(qtbot: QtBot, home: Home, folder: Path) -> None:
    with Library.open(folder, KeySlots(folder / KEYS).open("hk", PASSPHRASE)) as library:
        library.log_in("hk")
        library.operators.add(Operator("ab", "A. Berg", Role.ADMINISTRATOR))
        library.log_in("ab")
        own = next(one for one in library.operators.list() if one.code == "hk")
        library.operators.change(replace(own, role=Role.VIEWER))
    with qtbot.waitSignal(home.deleting.refused) as reported:
        home.page.panel.delete_patient.trigger()
    assert reported.args is not None
    assert reported.args[0] == "This requires the role clinician."
    assert home.deleting.dialog is None


def test_what_is_deleted_comes_back_by_its_keys_also_without_a_focus(qtbot: QtBot, home: Home) -> None:
    delete_patient(qtbot, home)
    qtbot.waitUntil(lambda: codes(home) == ["P-0147"])
    assert home.toast.isVisible()
    if (focused := home.focusWidget()) is not None:
        focused.clearFocus()
    handle = home.windowHandle()
    assert handle is not None
    QTest.keyClick(handle, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: codes(home) == ["P-0163", "P-0147"])


def test_an_undo_that_is_refused_is_offered_again(qtbot: QtBot, home: Home, monkeypatch: pytest.MonkeyPatch) -> None:
    delete_patient(qtbot, home)
    qtbot.waitUntil(lambda: codes(home) == ["P-0147"])

    def refuse(_patients: object, _patient: object) -> None:
        raise ServerSilentError("The server does not respond", "Try again")

    with monkeypatch.context() as patched:
        patched.setattr(Patients, "restore", refuse)
        with qtbot.waitSignal(home.deleting.refused):
            home.toast.undo()
    assert home.toast.isVisible()
    home.toast.undo()
    qtbot.waitUntil(lambda: codes(home) == ["P-0163", "P-0147"])
