"""Joining a clinic's library: what has to be typed, where trouble is stated, and what the environment does by
itself."""

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from app.home.login.first_start_page import FirstStartPage
from app.home.login.join_page import JoinPage
from app.home.login.log_in_page import LogInPage

ADDRESS = "postgresql://station@server/clinic"


def shown(qtbot: QtBot) -> JoinPage:
    page = JoinPage()
    qtbot.addWidget(page)
    with qtbot.waitExposed(page):
        page.show()
    return page


def test_the_first_start_offers_to_join_unless_a_library_is_missing(qtbot: QtBot) -> None:
    page = FirstStartPage(12, lambda _typed, _key: False)
    qtbot.addWidget(page)
    assert page.join.isVisibleTo(page)
    page.show_missing("/a/folder")
    assert page.join.isHidden()


def test_without_an_address_nothing_is_asked_of_any_server(qtbot: QtBot) -> None:
    page = shown(qtbot)
    with qtbot.assertNotEmitted(page.joined):
        page.join.click()
    assert page.server.address.is_wrong
    QTest.keyClicks(page.server.address.line_edit, ADDRESS)
    assert not page.server.address.is_wrong


def test_enter_joins_with_what_was_typed_once(qtbot: QtBot) -> None:
    page = shown(qtbot)
    QTest.keyClicks(page.server.address.line_edit, ADDRESS)
    QTest.keyClicks(page.server.password.line_edit, "pass word")
    with qtbot.waitSignal(page.joined) as joined:
        QTest.keyClick(page.server.password.line_edit, Qt.Key.Key_Return)
    assert joined.args == [ADDRESS, "pass word", ""]
    page.show_busy(True)
    with qtbot.assertNotEmitted(page.joined):
        page.join.click()


def test_a_refusal_is_at_the_field_it_is_about_and_what_was_typed_stays(qtbot: QtBot) -> None:
    page = shown(qtbot)
    page.server.address.set_text(ADDRESS)
    page.show_busy(True)
    page.refuse("The place is not there. Connect it.", is_place=True)
    assert [field.is_wrong for field in page.server.fields] == [False, False, True]
    page.refuse("The server does not answer. Try again.", is_place=False)
    assert page.server.address.is_wrong
    assert page.server.address.text == ADDRESS
    assert page.join.isEnabled()


def test_a_server_that_the_environment_names_is_tried_again_and_never_typed(qtbot: QtBot) -> None:
    page = shown(qtbot)
    page.show_trouble("The clinic's server does not respond. Try again when it is back.")
    assert not any(field.isVisible() for field in page.server.fields)
    assert "does not respond" in page.lead.text()
    with qtbot.waitSignal(page.again_requested):
        page.again.click()


def test_asking_again_keeps_no_password(qtbot: QtBot) -> None:
    page = shown(qtbot)
    page.server.password.set_text("secret")
    page.ask()
    assert page.server.reported == ("", "", "")


def test_the_log_in_states_which_library_it_is(qtbot: QtBot) -> None:
    page = LogInPage(12)
    qtbot.addWidget(page)
    with qtbot.waitExposed(page):
        page.show()
    page.show_library("The clinic's library on server")
    assert page.library.isVisible()
    page.show_library("")
    assert not page.library.isVisible()
