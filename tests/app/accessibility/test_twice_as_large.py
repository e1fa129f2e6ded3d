"""Tests at 200 %:

every word is whole, and every control can be brought into sight. They run in English and in German.
"""

import pytest
from PySide6.QtWidgets import QPushButton, QScrollArea, QWidget
from pytestqt.qtbot import QtBot

from app.theme.current import set_scale
from tests.app.accessibility.framed_pages import FRAMED, framed
from tests.app.accessibility.reach import out_of_reach
from tests.app.room import settle, words_cut

pytestmark = pytest.mark.endurance
WINDOWS = ((1920, 1200), (1280, 800))


@pytest.mark.usefixtures("language")
@pytest.mark.parametrize("size", WINDOWS)
@pytest.mark.parametrize("name", FRAMED)
def test_a_page_twice_as_large_has_all_its_words_and_controls(qtbot: QtBot, name: str, size: tuple[int, int]) -> None:
    set_scale(2.0)
    shell = framed(name)
    qtbot.addWidget(shell)
    shell.resize(*size)
    shell.show()
    settle()
    assert words_cut(shell) == []
    assert out_of_reach(shell) == []


def test_a_control_that_cannot_be_scrolled_to_is_named(qtbot: QtBot) -> None:
    area, content = QScrollArea(), QWidget()
    below = QPushButton("Go on", content)
    below.setAccessibleName("Go on")
    below.setGeometry(0, 900, 100, 40)
    content.setFixedSize(400, 1000)
    area.setWidget(content)
    qtbot.addWidget(area)
    area.resize(420, 300)
    area.show()
    settle()
    assert out_of_reach(area) == []
    below.move(0, 990)
    assert out_of_reach(area) == ["QPushButton “Go on”"]
