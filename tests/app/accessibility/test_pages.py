"""Every page by itself, as assistive technology gets it: names, roles and descriptions, and the order of Tab."""

import pytest
from pytestqt.qtbot import QtBot

from tests.app.accessibility.accessible_tree import complaints, wrong_hearing
from tests.app.results.filled_pages import PAGES


@pytest.mark.endurance
@pytest.mark.parametrize("name", PAGES)
def test_everything_on_a_page_has_a_name_and_a_role(qtbot: QtBot, name: str) -> None:
    page = PAGES[name]()
    qtbot.addWidget(page)
    page.resize(1064, 672)
    page.show()
    assert complaints(page) == []
    assert wrong_hearing(page) == []
