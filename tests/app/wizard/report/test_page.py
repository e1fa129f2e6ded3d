"""The report's page: pictures of the pages are as fine as there is room for them."""

from collections.abc import Iterator
from uuid import UUID

import pytest
from PySide6.QtCore import QBuffer, QByteArray, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.widgets.sheets import PAPER_INCH
from app.wizard.report.comment_editor import REBUILT_AFTER_MS
from app.wizard.report.page import ReportPage
from app.wording.translation import use_language
from tests.app.room import settle, words_cut


@pytest.fixture
def page(qtbot: QtBot) -> ReportPage:
    page = ReportPage()
    qtbot.addWidget(page)
    page.resize(1000, 600)
    page.show()
    return page


def in_room(page: ReportPage, width: int, height: int) -> None:
    """Show it as a window of this size does."""
    page.resize(width, height)
    page.set_room(width, height)
    page.show()


def png(ppi: float) -> bytes:
    """A page of A4, blank."""
    image = QImage(round(ppi * PAPER_INCH), round(ppi * 11.69), QImage.Format.Format_RGB32)
    image.fill(0xFFFFFFFF)
    content = QByteArray()
    file = QBuffer(content)
    file.open(QBuffer.OpenModeFlag.WriteOnly)
    assert image.save(file, "PNG")  # type: ignore[call-overload]  # the stubs know no device here
    return bytes(content.data())


@pytest.mark.endurance
def test_pictures_that_come_too_coarse_are_asked_for_once_more(qtbot: QtBot, page: ReportPage) -> None:
    """They were asked for before the page had its size."""
    with qtbot.waitSignal(page.sharper_required, timeout=10 * REBUILT_AFTER_MS):
        page.show_pages([png(page.pages_ppi / 2)])
    with qtbot.assertNotEmitted(page.sharper_required, wait=2 * REBUILT_AFTER_MS):
        page.show_pages([png(page.pages_ppi)])


@pytest.mark.endurance
def test_more_room_asks_for_finer_pictures_and_less_for_none(qtbot: QtBot, page: ReportPage) -> None:
    page.show_pages([png(page.pages_ppi)])
    with qtbot.waitSignal(page.sharper_required, timeout=10 * REBUILT_AFTER_MS):
        page.resize(1400, 900)
    page.show_pages([png(page.pages_ppi)])
    with qtbot.assertNotEmitted(page.sharper_required, wait=2 * REBUILT_AFTER_MS):
        page.resize(1000, 600)


@pytest.mark.parametrize("number", [0, 1, 3])
def test_a_small_page_that_is_pressed_brings_that_page_into_sight(qtbot: QtBot, page: ReportPage, number: int) -> None:
    page.show_pages([png(40.0)] * 4)
    qtbot.waitUntil(lambda: page.reading.verticalScrollBar().maximum() > 0)
    page.small.mark(2)
    at = page.small.place_of(number).center().toPoint()
    QTest.mouseClick(page.small, Qt.MouseButton.LeftButton, pos=at)
    assert page.small.number == number
    seen = page.sheets.visibleRegion().boundingRect()
    top, bottom = page.sheets.top_of(number), page.sheets.top_of(number + 1)
    assert seen.top() <= top + 1
    assert min(seen.bottom(), bottom) - max(seen.top(), top) >= 0.5 * min(seen.height(), bottom - top)


@pytest.fixture(params=["en", "de"])
def language(request: pytest.FixtureRequest) -> Iterator[str]:
    use_language(request.param)
    yield request.param
    use_language("en")


@pytest.mark.usefixtures("language")
def test_the_card_beside_the_pages_is_as_wide_as_its_words_in_each_language(qtbot: QtBot) -> None:
    page = ReportPage()
    qtbot.addWidget(page)
    in_room(page, 1064, 640)
    assert words_cut(page) == []


def test_a_long_condition_of_an_earlier_visit_does_not_widen_the_card(qtbot: QtBot) -> None:
    page = ReportPage()
    qtbot.addWidget(page)
    in_room(page, 1064, 640)
    settle()
    before = page.editor.width()
    page.show_visits([(UUID(int=1), "14 Nov 2026, " + "shoes and orthosis with wedge, " * 3)])
    page.earlier.setCurrentIndex(1)
    settle()
    assert page.earlier.isVisible()
    assert page.editor.width() == page.earlier.width() == before
    assert page.earlier.is_cut
