"""Small pages beside the report: they lead to a page, and report which one is read."""

import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QScrollBar
from pytestqt.qtbot import QtBot

from app.wizard.report.page import ReportPage
from tests.app.wizard.report.test_page import in_room, png


@pytest.fixture
def page(qtbot: QtBot) -> ReportPage:
    page = ReportPage()
    qtbot.addWidget(page)
    in_room(page, 1280, 620)
    page.show_pages([png(72)] * 4)
    qtbot.waitUntil(lambda: scrolled(page).maximum() > 0)
    return page


def scrolled(page: ReportPage) -> QScrollBar:
    return page.reading.verticalScrollBar()


def test_a_click_goes_to_its_page(page: ReportPage) -> None:
    middle: QPointF = page.small.place_of(2).center()
    QTest.mouseClick(page.small, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, middle.toPoint())
    assert scrolled(page).value() == round(page.sheets.top_of(2))
    assert page.small.accessibleDescription() == "Page 3 of 4"


def test_the_arrow_keys_go_from_page_to_page_and_no_further(page: ReportPage) -> None:
    page.small.setFocus()
    for key, expected in ((Qt.Key.Key_Up, 0), (Qt.Key.Key_Down, 1), (Qt.Key.Key_End, 3), (Qt.Key.Key_Down, 3)):
        QTest.keyClick(page.small, key)
        assert page.small.number == expected
    assert scrolled(page).value() > 0


def test_scrolling_marks_the_page_that_is_read(page: ReportPage) -> None:
    scrolled(page).setValue(round(page.sheets.top_of(1)))
    assert page.small.number == 1
    scrolled(page).setValue(0)
    assert page.small.number == 0


def test_fewer_pages_leave_none_marked_that_is_gone(page: ReportPage) -> None:
    page.small.mark(3)
    page.show_pages([png(72)] * 2)
    assert page.small.number == 1
