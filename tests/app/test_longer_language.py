"""Tests that every page has room for a language as long as German. At every size of window and letters."""

import pytest
from pytestqt.qtbot import QtBot

from app.theme.current import px, set_scale
from tests.app.results.filled_pages import BELOW_STRIP, PAGES
from tests.app.room import words_cut

# of the window: its size, the size of everything, and whether pages fold
WINDOWS = {
    "1280 x 800 at 100 %": (1280, 800, 1.0, False),
    "1280 x 800 at 80 %": (1280, 800, 0.8, False),
    "1920 x 1200 at 200 %": (1920, 1200, 2.0, True),
    "960 x 600 at 100 %": (960, 600, 1.0, True),
    "800 x 560 at 100 %": (800, 560, 1.0, True),
}
RAIL, COMPACT_RAIL = 216, 64
HEADER_AND_BAR = 128
STRIP, COMPACT_STRIP = 72, 44  # on the steps that show it


@pytest.mark.endurance
@pytest.mark.usefixtures("pseudo_language")
@pytest.mark.parametrize("window", WINDOWS)
@pytest.mark.parametrize("name", PAGES)
def test_every_word_of_a_longer_language_has_its_room(qtbot: QtBot, name: str, window: str) -> None:
    width, height, scale, is_compact = WINDOWS[window]
    width -= px(scale * (COMPACT_RAIL if is_compact else RAIL))
    height -= px(scale * HEADER_AND_BAR)
    if name in BELOW_STRIP:
        height -= px(scale * (COMPACT_STRIP if is_compact else STRIP))
    set_scale(scale)
    page = PAGES[name]()
    qtbot.addWidget(page)
    if hasattr(page, "set_compact"):
        page.set_compact(is_compact)
    if hasattr(page, "set_room"):
        page.set_room(width / scale)
    page.resize(width, height)
    page.show()
    assert words_cut(page) == []
