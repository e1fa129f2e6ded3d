"""Streams are asked for on the network once somebody has read whom that asks, and wants it."""

from collections.abc import Iterator

import pytest
from pytestqt.qtbot import QtBot

from app.wizard.sensors.sources import SEARCH, STREAMS, Sources
from app.wizard.sensors.step import SensorsStep
from app.wizard.visit import Visit
from devices.search import SearchResult
from tests.app.wizard.begun_visit import shown

NETWORK = STREAMS + "192.0.2.9"
WARNING = "This asks every computer on the network of 192.0.2.9"


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    addresses: list[str] = []

    def search_streams(address: str) -> SearchResult:
        addresses.append(address)
        return SearchResult()

    monkeypatch.setattr("app.wizard.sensors.sources.search_streams", search_streams)
    return addresses


@pytest.fixture
def step(qtbot: QtBot, visit: Visit) -> Iterator[SensorsStep]:
    visit.known_choices = Sources(SearchResult, ("127.0.0.1", "192.0.2.9"))
    yield from shown(qtbot, visit)


def stated(step: SensorsStep) -> str:
    return step.page.nothing.notice.text


def test_it_is_stated_whom_it_asks_and_asked_when_it_is_chosen_once_more(
    qtbot: QtBot, visit: Visit, step: SensorsStep, asked: list[str]
) -> None:
    assert WARNING not in stated(step)
    step.page.source_chosen.emit(NETWORK)
    assert WARNING in stated(step)
    assert "Choose the source again to start the query." in stated(step)
    assert (asked, visit.sensors.is_searching) == ([], False)
    with qtbot.waitSignal(visit.refused) as refused:
        step.page.source_chosen.emit(NETWORK)
    assert asked == ["192.0.2.9"]
    assert refused.args[0] == "No stream with motion data found."
    assert WARNING not in stated(step)


@pytest.mark.parametrize("other", [SEARCH, STREAMS + "127.0.0.1"])
def test_another_choice_takes_it_back(
    qtbot: QtBot, visit: Visit, step: SensorsStep, asked: list[str], other: str
) -> None:
    step.page.source_chosen.emit(NETWORK)
    with qtbot.waitSignal(visit.refused):
        step.page.source_chosen.emit(other)
    assert WARNING not in stated(step)
    step.page.source_chosen.emit(NETWORK)
    assert WARNING in stated(step)
    assert "192.0.2.9" not in asked


def test_who_leaves_has_to_be_reported_again(step: SensorsStep, asked: list[str]) -> None:
    step.page.source_chosen.emit(NETWORK)
    step.leave()
    step.enter()
    assert WARNING not in stated(step)
    step.page.source_chosen.emit(NETWORK)
    assert (WARNING in stated(step), asked) == (True, [])
