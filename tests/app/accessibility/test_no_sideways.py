"""Tests on a screen of 1280 x 800, and at 200 % of 1920 x 1200.

Every word has its room, and no page is wider than its own.

In English and in German.
"""

import pytest
from PySide6.QtWidgets import QScrollArea
from pytestqt.qtbot import QtBot

from app.theme.current import set_scale
from tests.app.accessibility.framed_pages import FRAMED, framed
from tests.app.room import settle, words_cut

pytestmark = pytest.mark.endurance


@pytest.mark.usefixtures("language")
@pytest.mark.parametrize(("scale", "size"), [(1.0, (1280, 800)), (2.0, (1920, 1200))])
@pytest.mark.parametrize("name", FRAMED)
def test_a_page_has_all_its_words_and_need_not_be_scrolled_sideways(
    qtbot: QtBot, name: str, scale: float, size: tuple[int, int]
) -> None:
    set_scale(scale)
    shell = framed(name)
    qtbot.addWidget(shell)
    shell.resize(*size)
    shell.show()
    settle()
    areas = [one for one in shell.findChildren(QScrollArea) if one.isVisible()]
    assert areas
    assert [one.horizontalScrollBar().maximum() for one in areas] == [0] * len(areas)
    assert words_cut(shell) == []
