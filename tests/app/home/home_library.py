"""Home with a library that is open."""

from pathlib import Path

from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.home.patients.deletion_dialog import DeletionDialog
from app.workers.library_controller import LibraryController
from app.workers.library_state import OpenedState

PASSPHRASE = "four short words here"


def open_library(qtbot: QtBot, controller: LibraryController, home: Home, folder: Path) -> None:
    with qtbot.waitSignal(controller.opened) as reported:
        controller.open(lambda holder: holder.open(folder, PASSPHRASE))
    (state,) = reported.args or []
    assert isinstance(state, OpenedState)
    home.show_library(state)
    qtbot.waitUntil(lambda: bool(home.page.patients.lines))


def deletion_dialog(qtbot: QtBot, home: Home) -> DeletionDialog:
    """What is asked before the patient in sight is deleted."""
    home.page.panel.delete_patient.trigger()
    qtbot.waitUntil(lambda: home.deleting.dialog is not None)
    assert home.deleting.dialog is not None
    return home.deleting.dialog


def delete_patient(qtbot: QtBot, home: Home) -> None:
    deletion_dialog(qtbot, home).delete.click()
