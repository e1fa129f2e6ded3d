"""The cards of the settings about a clinic's stations."""

import pytest
from pytestqt.qtbot import QtBot

from app.home.settings.clinic_cards import MoreStationsCard, StationCard, StationView


@pytest.fixture
def station(qtbot: QtBot) -> StationCard:
    card = StationCard()
    qtbot.addWidget(card)
    with qtbot.waitExposed(card):
        card.show()
    card.show_may(may_copy=True, may_bring_back=True)
    return card


@pytest.mark.parametrize(
    ("waiting", "words"),
    [
        (0, "All recordings were transferred."),
        (1, "1 recording here is waiting to be transferred."),
        (2, "2 recordings here are waiting to be transferred."),
    ],
)
def test_it_states_what_waits_here(station: StationCard, waiting: int, words: str) -> None:
    station.show_station(StationView("postgresql://station@server/clinic", "/shared", waiting))
    assert station.waiting.text() == words


def test_what_is_not_known_to_wait_is_not_stated_to_be_handed_over(station: StationCard) -> None:
    station.show_station(StationView("postgresql://station@server/clinic", "/shared"))
    assert not station.waiting.isVisible()


def test_the_button_of_a_copy_stops_it_while_it_is_made(qtbot: QtBot, station: StationCard) -> None:
    with qtbot.waitSignal(station.copy_requested):
        station.copy.click()
    station.show_copy("Copying, 10 %", is_running=True)
    with qtbot.waitSignal(station.stop_requested), qtbot.assertNotEmitted(station.copy_requested):
        station.copy.click()


def test_nothing_is_brought_back_by_one_press(qtbot: QtBot, station: StationCard) -> None:
    with qtbot.assertNotEmitted(station.back_requested):
        station.back.click()
    assert not station.back.isVisible()
    station.keep.click()
    assert station.back.isVisible()
    station.back.click()
    with qtbot.waitSignal(station.back_requested):
        station.sure.click()


def test_who_may_not_bring_it_back_is_not_offered_it(station: StationCard) -> None:
    station.show_may(may_copy=True, may_bring_back=False)
    assert not any(button.isVisible() for button in (station.back, station.sure, station.keep))
    assert station.copy.isVisible()


def test_a_move_needs_an_address_and_a_place(qtbot: QtBot) -> None:
    card = MoreStationsCard()
    qtbot.addWidget(card)
    with qtbot.assertNotEmitted(card.move_requested):
        card.move_there.click()
    assert card.server.address.is_wrong
    assert card.server.place.is_wrong
    card.server.address.set_text("postgresql://owner@server/clinic")
    card.server.password.set_text("secret")
    card.show_place("/shared")
    with qtbot.waitSignal(card.move_requested) as requested:
        card.move_there.click()
    assert requested.args == ["postgresql://owner@server/clinic", "secret", "/shared"]
