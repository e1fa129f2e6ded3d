"""Tests on a screen of 1280 x 800, and at 200 % of 1920 x 1200 and of 1280 x 800.

Every word has its room, every control can be brought into sight, and no page is wider than its own, but for the
narrowest.

In English and in German.
"""

import pytest
from PySide6.QtWidgets import QPushButton, QScrollArea, QWidget
from pytestqt.qtbot import QtBot

from app.theme.current import set_scale
from tests.app.accessibility.framed_pages import FRAMED, framed
from tests.app.accessibility.reach import out_of_reach
from tests.app.room import settle, words_cut

pytestmark = pytest.mark.endurance
NARROWEST = (2.0, (1280, 800))
WINDOWS = [(1.0, (1280, 800)), (2.0, (1920, 1200)), NARROWEST]


@pytest.mark.usefixtures("language")
@pytest.mark.parametrize(("scale", "size"), WINDOWS)
@pytest.mark.parametrize("name", FRAMED)
def test_a_page_has_all_its_words_and_controls_and_need_not_be_scrolled_sideways(
    qtbot: QtBot, name: str, scale: float, size: tuple[int, int]
) -> None:
    set_scale(scale)
    shell = framed(name)
    qtbot.addWidget(shell)
    shell.resize(*size)
    shell.show()
    settle()
    assert words_cut(shell) == []
    assert out_of_reach(shell) == []
    if (scale, size) != NARROWEST:
        areas = [one for one in shell.findChildren(QScrollArea) if one.isVisible()]
        assert areas
        assert [one.horizontalScrollBar().maximum() for one in areas] == [0] * len(areas)


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
