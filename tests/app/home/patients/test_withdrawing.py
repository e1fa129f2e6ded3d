"""Consent to video is taken back at home, where no camera is and no visit is open."""

from pathlib import Path

from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.storage.keys import KeySlots
from app.storage.layout import KEYS
from app.storage.library import Library
from tests.app.home.home_library import PASSPHRASE
from tests.app.home.test_home import sessions


def agree(folder: Path) -> None:
    with Library.open(folder, KeySlots(folder / KEYS).open("hk", PASSPHRASE)) as library:
        library.log_in("hk")
        (patient,) = library.patients.search("0163")
        library.clips.give_consent(patient.id)


def test_who_never_agreed_has_nothing_to_withdraw(qtbot: QtBot, home: Home) -> None:
    qtbot.waitUntil(lambda: len(sessions(home)) == 3)
    assert not home.page.panel.withdraw_video.isVisible()


def test_a_consent_is_withdrawn_once_it_was_asked(qtbot: QtBot, home: Home, folder: Path) -> None:
    qtbot.waitUntil(lambda: len(sessions(home)) == 3)
    agree(folder)
    home.patients.read()
    withdraw = home.page.panel.withdraw_video
    qtbot.waitUntil(withdraw.isVisible)
    withdraw.trigger()
    dialog = home.withdrawing.dialog
    assert dialog is not None
    dialog.cancel.click()
    home.patients.read()
    assert withdraw.isVisible()
    withdraw.trigger()
    dialog = home.withdrawing.dialog
    assert dialog is not None
    dialog.answers["withdraw"].click()
    qtbot.waitUntil(lambda: not withdraw.isVisible())
    with Library.open(folder, KeySlots(folder / KEYS).open("hk", PASSPHRASE)) as library:
        library.log_in("hk")
        (patient,) = library.patients.search("0163")
        assert not library.clips.consent(patient.id).is_given
