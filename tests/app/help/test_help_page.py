"""Tests of the manual: it is whole, it is found, and it lets go of the keys it borrows."""

import re
from pathlib import Path

import pytest
from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QColor, QTextDocument
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QWidget
from pytestqt.qtbot import QtBot

from app.help.help_page import HelpPage
from app.help.help_topics import Topic, TopicGroup, group_title, topic_title
from app.theme.current import current_theme, set_dark, set_scale
from tests.app.watchdog import Watchdog

FOLDER = Path(__file__).parents[3] / "resources" / "help"
WIZARD = Path(__file__).parents[3] / "app" / "wizard"
PICTURE = "pictures/walking.png"
FORBIDDEN = re.compile(
    r"\b(errors?|fail(s|ed|ure)?|invalid|please|disconnected|heel strikes?|you|your)\b|!", re.IGNORECASE
)


@pytest.fixture
def page(qtbot: QtBot) -> HelpPage:
    page = HelpPage()
    page.resize(1064, 672)
    qtbot.addWidget(page)
    with qtbot.waitActive(page):
        page.show()
        page.activateWindow()
    return page


def focused() -> QWidget:
    widget = QApplication.focusWidget()
    assert widget is not None
    return widget


def search(page: HelpPage, words: str) -> None:
    page.search.line_edit.setFocus()
    page.search.line_edit.selectAll()
    QTest.keyClicks(page.search.line_edit, words)


def test_every_topic_is_written_and_nothing_else_lies_there() -> None:
    assert {file.stem for file in FOLDER.glob("*.md")} == set(Topic)


def test_every_step_of_the_wizard_has_its_topic() -> None:
    found = re.compile(r"def topic\(self\) -> str:\n        return \"([\w-]+)\"")
    reported = [found.findall(file.read_text(encoding="utf-8")) for file in WIZARD.glob("*/step.py")]
    assert len(reported) == 7
    assert {topic for (topic,) in reported} <= set(Topic)


def test_a_topic_keeps_the_tone_of_the_house() -> None:
    for topic in Topic:
        text = (FOLDER / f"{topic}.md").read_text(encoding="utf-8").replace("![", "[")
        ours = re.sub(r"\*\*.+?\*\*|“[^”]+”|(?m:^\| [^|]+ \|)", "", text)  # less what is quoted from the screen
        assert FORBIDDEN.findall(re.sub(r"(?i)measurement error|standard errors", "", ours)) == [], topic


def test_a_topic_is_read_from_its_beginning(page: HelpPage, qapp: QApplication) -> None:
    for topic in Topic:
        page.show_topic(topic)
        qapp.processEvents()
        assert page.text.verticalScrollBar().value() == 0, topic
        assert page.text.toPlainText().startswith(topic_title(topic))
        assert page.text.horizontalScrollBar().maximum() == 0, topic


def test_a_topic_is_chosen_by_mouse_and_by_arrows(page: HelpPage) -> None:
    rows = page.topics.rows
    row = rows[list(Topic).index(Topic.STAND_STILL)]
    QTest.mouseClick(row, Qt.MouseButton.LeftButton)
    assert page.text.toPlainText().startswith("Stand still")
    row.setFocus()
    QTest.keyClick(focused(), Qt.Key.Key_Down)
    assert page.topic is Topic.FREE_MOTION
    assert page.text.toPlainText().startswith("Free motion")


def test_in_a_small_window_the_topics_fold_into_one_choice(page: HelpPage) -> None:
    page.set_compact(is_compact=True)
    assert not page.topics.isVisible()
    page.choice.setCurrentIndex(list(Topic).index(Topic.KEYS))
    assert page.topic is Topic.KEYS


def test_a_link_leads_to_another_page_and_nowhere_else(page: HelpPage) -> None:
    led_to = []
    for link in ("walking.md", "https://example.org/keys.md", "nowhere.md", "keys.html", "keys.md"):
        page.text.anchorClicked.emit(QUrl(link))
        led_to.append(page.topic)
    assert led_to == [*[Topic.WALKING] * 4, Topic.KEYS]


def test_groups_of_topics_have_titles(page: HelpPage) -> None:
    stated = [label.text() for label in page.topics.findChildren(QLabel)]
    assert stated == [group_title(group) for group in TopicGroup]


def test_what_is_searched_for_is_counted_in_every_topic_and_marked(page: HelpPage) -> None:
    page.show_topic(Topic.WALKING)
    search(page, "spAce")
    text = page.text.toPlainText().casefold()
    assert len(page.text.extraSelections()) == text.count("space") > 1
    named = {row.text(): row.accessibleName() for row in page.topics.rows}
    assert named["Walking"] == f"Walking, {text.count('space')} matches"
    assert named["Report"] == "Report, 0 matches"


def test_enter_goes_on_to_the_next_topic_and_round_again(page: HelpPage) -> None:
    search(page, "goniometer")
    places = [(FOLDER / f"{topic}.md").read_text(encoding="utf-8").casefold().count("goniometer") for topic in Topic]
    came_by = []
    for _ in range(sum(places) + 1):
        QTest.keyClick(page.search.line_edit, Qt.Key.Key_Return)
        came_by.append(page.topic)
    assert Topic.STAND_STILL in came_by
    assert page.text.textCursor().block().text().casefold().count("goniometer") > 0


def test_what_is_nowhere_is_stated(page: HelpPage) -> None:
    search(page, "xylophone")
    assert page.found.text() == "No matches. Try another word."
    assert page.text.extraSelections() == []
    search(page, " ")
    assert not page.found.isVisible()


@pytest.mark.parametrize("where", ["text", "search"])
def test_escape_leads_back_from_everywhere(qtbot: QtBot, page: HelpPage, where: str) -> None:
    (page.text if where == "text" else page.search.line_edit).setFocus()
    with qtbot.waitSignal(page.closed):
        QTest.keyClick(focused(), Qt.Key.Key_Escape)


def test_it_opens_on_the_text_so_that_keys_scroll(page: HelpPage) -> None:
    page.show_topic(Topic.MESSAGES)
    page.focus()
    QTest.keyClick(focused(), Qt.Key.Key_PageDown)
    assert page.text.verticalScrollBar().value() > 0


def test_everything_that_takes_the_focus_has_a_name_and_a_place_in_the_order(page: HelpPage) -> None:
    takers = [
        widget
        for widget in page.findChildren(QWidget)
        if widget.isVisible() and widget.focusPolicy() & Qt.FocusPolicy.TabFocus
    ]
    assert [widget for widget in takers if not widget.accessibleName()] == []
    assert set(takers) <= set(page.tab_order)


def test_size_and_theme_change_what_is_shown_and_not_where(page: HelpPage, qapp: QApplication) -> None:
    page.show_topic(Topic.KEYS)
    before = page.text.toPlainText()
    set_dark(True)
    set_scale(2.0)
    qapp.processEvents()
    assert page.text.toPlainText() == before
    assert page.text.document().defaultFont().pixelSize() == 2 * 16


@pytest.mark.endurance
def test_searching_holds_up_nobody(page: HelpPage, watchdog: Watchdog, qtbot: QtBot) -> None:
    for topic in Topic:
        page.show_topic(topic)
        search(page, "sensor")
        qtbot.wait(10)


def test_an_open_page_of_the_manual_follows_the_theme(page: HelpPage) -> None:
    page.show_topic(Topic.REPORT)
    page.show()
    for is_dark in (False, True, False):
        set_dark(is_dark)
        corner = page.text.grab().toImage().pixelColor(5, 5)
        assert corner.name() == QColor(current_theme().colours.surface).name()


def test_a_picture_is_as_wide_as_the_lines_and_follows_the_theme(page: HelpPage) -> None:
    page.show_topic(Topic.WALKING)
    pictures = []
    for is_dark in (False, True):
        set_dark(is_dark)
        image = page.text.document().resource(QTextDocument.ResourceType.ImageResource.value, QUrl(PICTURE))
        pictures.append(image.deviceIndependentSize().width())
        assert (image.pixelColor(4, 4).lightness() < 128) == is_dark
    column = page.text.lineWrapColumnOrWidth()
    assert all(column - 40 < width <= column for width in pictures)
