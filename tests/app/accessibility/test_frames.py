"""The pages of a visit in their frame: names and roles, and Tab once round in the order of reading."""

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.app.accessibility.accessible_tree import complaints, wrong_hearing, wrong_order
from tests.app.accessibility.framed_pages import FRAMED, framed
from tests.app.room import settle


@pytest.mark.endurance
@pytest.mark.parametrize("name", FRAMED)
def test_a_page_of_a_visit_is_received_and_worked_by_tab_alone(qtbot: QtBot, name: str) -> None:
    shell = framed(name)
    qtbot.addWidget(shell)
    shell.resize(1280, 800)
    with qtbot.waitActive(shell):
        shell.show()
        shell.activateWindow()
    settle()
    assert complaints(shell) == []
    assert wrong_hearing(shell) == []
    shell.show_page(FRAMED[name][0])
    assert QApplication.focusWidget() is not None
    assert [one for one in wrong_order(shell) if not one.startswith("_Tile “R thigh")] == []  # words go L then R
