"""Tests that the patients in sight are those that were asked for last, and none once the library was left."""

from PySide6.QtCore import QObject
from pytestqt.qtbot import QtBot

from app.home.home import Home
from app.widgets.line_list import PatientLine
from app.workers.library_controller import LibraryController


class Later(QObject):
    """Asks the library what is answered after all that was asked before."""

    def __init__(self, controller: LibraryController) -> None:
        super().__init__()
        self.is_answered = False
        controller.run(lambda _opened: None, self._on_answered, None, self)

    def _on_answered(self, _nothing: None) -> None:
        self.is_answered = True


def wait_for_answers(qtbot: QtBot, controller: LibraryController) -> None:
    """Until all is answered, and what was asked for with an answer."""
    laters = [Later(controller)]
    qtbot.waitUntil(lambda: laters[0].is_answered)
    laters.append(Later(controller))
    qtbot.waitUntil(lambda: laters[1].is_answered)


def test_who_is_requested_for_is_chosen_though_the_patients_are_read_again_meanwhile(
    qtbot: QtBot, home: Home, controller: LibraryController
) -> None:
    patients = [line.id for line in home.page.patients.lines if isinstance(line, PatientLine)]
    first, other = patients
    assert home.page.patient_id == first
    home.patients.read(other)
    home.patients.read()
    wait_for_answers(qtbot, controller)
    assert home.page.patient_id == other
    assert home.patients.patient is not None
    assert home.patients.patient.id == other


def test_what_was_being_read_when_the_library_was_left_is_not_kept(
    qtbot: QtBot, home: Home, controller: LibraryController
) -> None:
    shown = home.page.patient_id
    assert shown is not None
    home.patients.read()
    home.clear()
    wait_for_answers(qtbot, controller)
    assert home.patients.known(shown) is None
    assert home.page.patients.lines == ()
    assert home.page.panel.code.text() == ""
