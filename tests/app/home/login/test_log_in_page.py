"""The way into a library: what is offered where a clinic's server does not answer, and where it does."""

from pytestqt.qtbot import QtBot

from app.home.login.log_in_page import LogInPage


def page_of(qtbot: QtBot) -> LogInPage:
    page = LogInPage(10)
    qtbot.addWidget(page)
    page.show_operators(("hk", "ab"), latest="ab")
    page.show()
    return page


def test_work_without_the_server_is_offered_only_where_it_does_not_answer(qtbot: QtBot) -> None:
    page = page_of(qtbot)
    assert not page.work_away.isVisible()
    page.passphrase.set_text("four short words here")
    page.refuse("The clinic's server does not answer. Try again when it is back.")
    page.offer_away()
    assert page.work_away.isVisible()
    with qtbot.waitSignal(page.away_requested) as requested:
        page.work_away.click()
    assert requested.args == ["ab", "four short words here"]
    page.forget_typed()
    assert not page.work_away.isVisible()


def test_while_it_is_tried_it_is_not_tried_twice(qtbot: QtBot) -> None:
    page = page_of(qtbot)
    page.offer_away()
    page.show_busy(True)
    with qtbot.assertNotEmitted(page.away_requested):
        page.work_away.click()


def test_the_cover_offers_no_other_library(qtbot: QtBot) -> None:
    page = page_of(qtbot)
    page.offer_away()
    page.show_cover("hk", is_recording=False)
    assert not page.work_away.isVisible()
