"""The view of a running test: what it shows and states, and that no figure moves as it counts."""

import math
from dataclasses import replace
from typing import Any

from pytestqt.qtbot import QtBot
from syrupy.assertion import SnapshotAssertion

from app.wizard.walking.timed_view import TimedView, TimedViewState, distance_words, status_words, time_text
from app.wording.translation import use_language
from core.body import Side, Site
from core.timed.found import NotMeasured
from core.timed.live import LiveReadout
from core.timed.protocols import PlannedTest, TimedProtocol
from tests.app.room import words_cut

TEN = PlannedTest(TimedProtocol.TEN_METRES)
WAITING = TimedViewState(LiveReadout(TEN, now_s=2.0), "Shoes, attempt 1", 2.0, math.nan)
TIMING = TimedViewState(LiveReadout(TEN, 8.0, 3.0, distance_m=6.12), "Shoes, attempt 1", 8.44, math.nan)


def test_the_time_is_cut_to_tenths_and_reported_in_minutes_from_100_s() -> None:
    texts = [time_text(elapsed_s) for elapsed_s in (0.0, 5.49, 99.94, 100.0, 214.9)]
    assert texts == ["0.0", "5.4", "99.9", "1:40", "3:34"]


def test_what_the_test_is_doing_is_a_word(snapshot: SnapshotAssertion) -> None:
    assert {
        "before a walk": status_words(WAITING),
        "still before a walk": status_words(replace(WAITING, readout=replace(WAITING.readout, is_still=True))),
        "on a chair": status_words(replace(WAITING, readout=LiveReadout(PlannedTest(TimedProtocol.UP_AND_GO)))),
        "timing": status_words(TIMING),
        "over": status_words(replace(TIMING, end_s=12.0)),
    } == snapshot


def test_a_distance_that_cannot_be_reported_is_a_dash_with_its_reason(snapshot: SnapshotAssertion) -> None:
    def timing(**changes: Any) -> tuple[str, str]:
        return distance_words(replace(TIMING, readout=replace(TIMING.readout, **changes)))

    use_language("de")
    in_german = distance_words(WAITING)
    use_language("en")
    assert {
        "before": distance_words(WAITING),
        "a comma in German also before the test": in_german,
        "timing": timing(),
        "a silent foot": timing(silent=(Site.LEFT_FOOT,)),
        "no feet": timing(distance_m=math.nan, reasons=(NotMeasured.NO_FEET,)),
        "far, without tenths": timing(distance_m=362.4),
    } == snapshot


def test_the_status_has_its_room_in_german(qtbot: QtBot) -> None:
    use_language("de")
    view = TimedView()
    qtbot.addWidget(view)
    view.resize(1016, 640)
    view.show()
    cut = []
    for state in (WAITING, replace(WAITING, readout=replace(WAITING.readout, is_still=True)), TIMING):
        view.show_state(state)
        cut += words_cut(view.status)
    use_language("en")
    assert cut == []


def test_every_digit_has_a_cell_of_its_own(qtbot: QtBot) -> None:
    view = TimedView()
    qtbot.addWidget(view)
    view.resize(1016, 600)
    view.show()
    places = set()
    for now_s in (4.1, 5.8, 10.7, 11.1):
        view.show_state(replace(TIMING, now_s=now_s))
        places.add(tuple(round(box.left(), 3) for _, box in view.time.cells()))
    assert len(places) == 1
    view.show_state(replace(TIMING, now_s=25.0))
    assert len(view.time.cells()) == 4
    assert view.time.text == "22.0"


def test_who_listens_is_reported_once_a_second_and_the_end(qtbot: QtBot) -> None:
    view = TimedView()
    qtbot.addWidget(view)
    view.show_state(replace(TIMING, now_s=4.2))
    first = view.accessibleDescription()
    assert first == "Clock runs. 1 s. 6.1 m."
    view.show_state(replace(TIMING, now_s=4.6, readout=replace(TIMING.readout, distance_m=6.6)))
    assert view.accessibleDescription() == first
    view.show_state(replace(TIMING, now_s=5.1, end_s=4.85, readout=replace(TIMING.readout, steps=((Side.LEFT, 0.5),))))
    assert view.accessibleDescription() == "Finished. 1.8 s. 6.1 m."
    view.show_state(replace(TIMING, end_s=123.0))  # minutes are no seconds
    assert view.accessibleDescription() == "Finished. 2:00. 6.1 m."
